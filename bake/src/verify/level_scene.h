#pragma once
// A scene with the coarser levels of detail of its objects, and which of them a host draws from a viewpoint
// (docs/levels.md).
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "file/stored_rules.h"
#include "sightcell/scene/object_levels.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

class level_scene {
 public:
  // Adds the coarser levels to a flattened scene. Objects without a draw of level 0 are left out.
  // s: the scene that was flattened; must outlive the object, as levels must.
  // world: with the overrides of the file.
  // rules: those of world.
  // fov: vertical field of view of the picture in degrees, which turns coverages into distances.
  level_scene(const scene::scene& s, const scene::world_geometry& world, const scene::object_levels& levels,
              const stored_rules& rules, double fov);

  // The polygons of the scene, which those of coarser levels follow.
  const scene::world_geometry& geometry() const { return geometry_; }
  std::uint32_t object_count() const { return static_cast<std::uint32_t>(objects_.size()); }
  std::uint32_t level_count() const { return level_count_; }                                // coarser ones
  std::uint32_t levels_without_switch() const { return without_switch_; }                   // of them; never drawn
  std::uint32_t object_of(std::uint32_t polygon) const { return places_[polygon].object; }  // or scene::no_index
  std::uint32_t level_of(std::uint32_t polygon) const { return places_[polygon].level; }    // 0: of the scene
  std::uint32_t first_draw(std::uint32_t object) const { return objects_[object].draw; }    // of level 0, in the scene

  // Returns whether a host draws a polygon from a viewpoint, provided that it draws its object. Levels of objects that
  // were left out are never drawn.
  bool is_drawn(std::uint32_t polygon, const glm::vec3& eye) const {
    const level_place& at = places_[polygon];
    return at.object == scene::no_index ? polygon < polygons_ : chosen(objects_[at.object], eye) == at.level;
  }

  // Finds the objects of which a set has a polygon of level 0.
  // has: by polygon of the scene, 0 or 1.
  // visible: overwritten; by object.
  void find_visible(std::span<const std::uint8_t> has, std::vector<std::uint8_t>& visible) const;

 private:
  struct level_place {
    std::uint32_t object = scene::no_index, level = 0;
  };

  struct switched_object {
    glm::vec3 center{0.0f};
    std::uint32_t draw = 0;
    float end = std::numeric_limits<float>::infinity();  // meters from the center; nothing is drawn from there on
    std::vector<float> begins;                           // of coarser levels, meters from the center
  };

  static std::uint32_t chosen(const switched_object& of, const glm::vec3& eye);
  void add(const scene::scene& s, const scene::leveled_object& object, double tangent);
  float place_sphere(const scene::scene& s, const std::vector<std::uint32_t>& draws, switched_object& out) const;

  scene::world_geometry geometry_;
  std::vector<switched_object> objects_;
  std::vector<level_place> places_;  // by polygon
  std::uint32_t polygons_ = 0, level_count_ = 0, without_switch_ = 0;
};

}  // namespace sightcell::bake
