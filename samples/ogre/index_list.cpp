#include "index_list.h"

namespace ogre_host {

void index_list::clear() {
  indices_.clear();
  parts_.clear();
}

void index_list::add(std::size_t entity, std::span<const std::uint32_t> indices) {
  if (parts_.empty() || parts_.back().entity != entity) parts_.push_back({entity, indices_.size(), 0});
  indices_.insert(indices_.end(), indices.begin(), indices.end());
  parts_.back().count += indices.size();
}

void index_list::draw(const ogre_scene& scene) {
  for (Ogre::Entity* e : scene.entities()) e->setVisible(false);
  if (indices_.empty()) return;
  if (!buffer_ || buffer_->getNumIndexes() < indices_.size()) {
    buffer_ = Ogre::HardwareBufferManager::getSingleton().createIndexBuffer(
        Ogre::HardwareIndexBuffer::IT_32BIT, indices_.size() + indices_.size() / 2, Ogre::HBU_CPU_TO_GPU);
  }
  buffer_->writeData(0, indices_.size() * sizeof(std::uint32_t), indices_.data(), true);
  for (const part& p : parts_) scene.draw_part(p.entity, buffer_, p.first, p.count);
}

}  // namespace ogre_host
