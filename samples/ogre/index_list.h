#pragma once
// A dynamic index buffer that entities draw parts of.
#include <Ogre.h>

#include <cstdint>
#include <span>
#include <vector>

#include "ogre_scene.h"

namespace ogre_host {

class index_list {
 public:
  // Begins a new list.
  void clear();
  // Adds indices of an entity. All those of an entity follow each other.
  void add(std::size_t entity, std::span<const std::uint32_t> indices);
  // Lets each entity draw its part, and hides those that have none.
  void draw(const ogre_scene& scene);

 private:
  struct part {
    std::size_t entity, first, count;  // of indices
  };
  std::vector<std::uint32_t> indices_;
  std::vector<part> parts_;
  Ogre::HardwareIndexBufferSharedPtr buffer_;  // grows
};

}  // namespace ogre_host
