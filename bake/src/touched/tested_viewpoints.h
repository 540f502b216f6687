#pragma once
// The viewpoints that a step of a cell tested, with the results. A test takes up to 64 rays, so a step that starts from
// what it had before an edit repeats only those tests whose result the edit can have changed
// (docs/method/incremental.md).
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/base/box.h"

namespace sightcell::bake {

// Where a scene was edited.
struct edited_boxes {
  box all;                 // around all parts
  std::vector<box> parts;  // empty: too many to look at each
};

// Used by one thread at a time.
class tested_viewpoints {
 public:
  tested_viewpoints() = default;

  // From now on find() knows the results of an earlier step. edit: since that step; must outlive the object.
  void know(tested_viewpoints earlier, const edited_boxes& edit);
  // Returns the result of the earlier step at exactly this point, 1 or 0; nothing if it tested none there.
  std::optional<std::uint8_t> find(const glm::vec3& point) const;
  // Null before know().
  const edited_boxes* edit() const { return edit_; }
  // valid: 1 or 0.
  void add(const glm::vec3& point, std::uint8_t valid);

  // Returns the bytes of what was added: 13 per point.
  std::vector<std::uint8_t> encode();
  // The reverse. The bytes may be arbitrary; those that encode() does not return give other points.
  static tested_viewpoints decode(std::span<const std::uint8_t> bytes);

 private:
  struct result {
    std::array<std::uint32_t, 3> point;  // the bits of its coordinates
    std::uint8_t valid;
    auto operator<=>(const result&) const = default;
  };
  static std::array<std::uint32_t, 3> bits_of(const glm::vec3& point);

  std::vector<result> added_, known_;  // known_ is sorted
  const edited_boxes* edit_ = nullptr;
};

// The tests of this thread; null: they are not recorded.
inline thread_local tested_viewpoints* recorded_viewpoints = nullptr;

// Records the tests of this thread while it exists.
class recording_viewpoints {
 public:
  explicit recording_viewpoints(tested_viewpoints* to) : before_(recorded_viewpoints) { recorded_viewpoints = to; }
  ~recording_viewpoints() { recorded_viewpoints = before_; }
  recording_viewpoints(const recording_viewpoints&) = delete;
  recording_viewpoints& operator=(const recording_viewpoints&) = delete;

 private:
  tested_viewpoints* before_;
};

}  // namespace sightcell::bake
