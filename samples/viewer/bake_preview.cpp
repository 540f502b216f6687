#include "bake_preview.h"

namespace viewer {

void bake_preview::update(std::span<const finished_cell> finished, const glm::vec3& eye, bool complete) {
  if (coming_) {
    if (!coming_->prepare(eye)) return;
    if (shown_) coming_->color_as(*shown_);
    shown_ = std::move(coming_);
    return;
  }
  const std::size_t before = shown_ ? shown_->size() : 0, now = finished.size();
  const bool enough = now >= before + before / 4 + 1 || (complete && now > before);
  if (!enough || clock::now() - made_ < std::chrono::seconds(1)) return;
  made_ = clock::now();
  coming_ = std::make_unique<cell_map>(finished, world_);
}

}  // namespace viewer
