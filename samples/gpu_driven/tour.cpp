#include "tour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <random>
#include <span>

#include "clearance.h"
#include "sightcell/base/error.h"

namespace gpu_driven {
namespace {

constexpr float full_turn = 2.0f * std::numbers::pi_v<float>;
constexpr float step_length = 0.1f;              // meters per frame: 6 m/s at 60 frames per second
constexpr float slow_turn = full_turn / 120.0f;  // per frame: 3 degrees
constexpr float fast_turn = full_turn / 24.0f;   // 15 degrees
constexpr float longest_way = 12.0f;             // meters between viewpoints
constexpr std::size_t most_ways = 12;            // that are tried from a viewpoint
constexpr std::uint32_t most_eyes = 4;           // of a cell

// The same numbers with all standard libraries.
class random_numbers {
 public:
  explicit random_numbers(std::uint64_t seed) : engine_(seed) {}
  float unit() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }

 private:
  std::mt19937_64 engine_;
};

std::vector<glm::vec3> find_eyes(const sightcell::db& db, const std::string& file) {
  std::vector<glm::vec3> out;
  for (std::uint32_t cell = 0; cell < db.cell_count(); ++cell) {
    for (std::uint32_t number = 0; number < most_eyes; ++number) {
      const auto eye = db.cell_eye(cell, number);
      if (!eye) break;
      out.emplace_back((*eye)[0], (*eye)[1], (*eye)[2]);
    }
  }
  if (!out.empty()) return out;
  throw sightcell::error(sightcell::error_kind::bad_input, "gpu-driven.no-viewpoint", file, "has no valid viewpoints",
                         "bake it again");
}

float turned(float from, float to) {
  return std::remainder(to - from, full_turn);
}

// Makes the frames of a walk, viewpoint by viewpoint.
class walker {
 public:
  walker(const sightcell::db& db, const std::string& file, const sightcell::scene::world_geometry& world,
         std::uint32_t frames, std::uint64_t seed)
      : eyes_(find_eyes(db, file)),
        visits_(eyes_.size(), 0),
        clear_(world, db.info() ? db.info()->player_radius : 0.0f),
        frames_(frames),
        random_(seed) {
    auto view = sightcell::view::create(db);
    if (view) view_ = std::move(*view);
  }

  std::vector<tour_frame> walk(std::uint32_t& jumps) {
    jumps = 0;
    std::size_t at = random_.below(eyes_.size());
    jump_to(eyes_[at]);
    while (measured_ < frames_) {
      ++visits_[at];
      const std::optional<std::size_t> next = choose(at);
      if (next) {
        go_to(eyes_[*next]);
        at = *next;
        if (random_.below(3) == 0) turn_around();
      } else {
        turn_around();
        at = random_.below(eyes_.size());
        jump_to(eyes_[at]);
        ++jumps;
      }
    }
    return std::move(out_);
  }

 private:
  void add(frame_kind kind) {
    if (measured_ == frames_) return;
    out_.push_back({{eye_, yaw_, 0.0f}, kind});
    if (kind != frame_kind::unmeasured) ++measured_;
  }

  // A cut. After three frames, modes with a history have one.
  void jump_to(const glm::vec3& eye) {
    eye_ = eye;
    for (int i = 0; i < 3; ++i) add(frame_kind::unmeasured);
  }

  // One of the three least visited viewpoints near by that a straight way goes to.
  std::optional<std::size_t> choose(std::size_t from) {
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < eyes_.size(); ++i) {
      if (i != from && glm::length(eyes_[i] - eyes_[from]) <= longest_way) near.push_back(i);
    }
    std::sort(near.begin(), near.end(), [&](std::size_t a, std::size_t b) {
      if (visits_[a] != visits_[b]) return visits_[a] < visits_[b];
      return glm::length(eyes_[a] - eyes_[from]) < glm::length(eyes_[b] - eyes_[from]);
    });
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < std::min(near.size(), most_ways) && open.size() < 3; ++i) {
      if (is_open(eyes_[from], eyes_[near[i]])) open.push_back(near[i]);
    }
    if (open.empty()) return std::nullopt;
    return open[random_.below(open.size())];
  }

  bool is_open(const glm::vec3& from, const glm::vec3& to) {
    const int steps = static_cast<int>(glm::length(to - from) / step_length) + 1;
    for (int i = 0; i <= steps; ++i) {
      const glm::vec3 at = from + static_cast<float>(i) / static_cast<float>(steps) * (to - from);
      sightcell_frame frame{};
      static_cast<void>(view_.move(std::array<float, 3>{at.x, at.y, at.z}, frame));
      if ((frame.flags & (SIGHTCELL_FRAME_OUTSIDE | SIGHTCELL_FRAME_DRAW_ALL)) != 0) return false;
    }
    return clear_.is_clear(from, to);
  }

  void go_to(const glm::vec3& to) {
    const glm::vec3 from = eye_, along = to - from;
    const int steps = static_cast<int>(glm::length(along) / step_length) + 1;
    const float ahead = along.x * along.x + along.z * along.z > 1e-6f ? std::atan2(-along.x, -along.z) : yaw_;
    for (int i = 1; i <= steps; ++i) {
      eye_ = i == steps ? to : from + static_cast<float>(i) / static_cast<float>(steps) * along;
      yaw_ += std::clamp(turned(yaw_, ahead), -slow_turn, slow_turn);
      add(frame_kind::walk);
    }
  }

  void turn_around() {
    const float step = random_.below(2) == 0 ? fast_turn : -fast_turn;
    const std::size_t count = 6 + random_.below(7);
    for (std::size_t i = 0; i < count; ++i) {
      yaw_ += step;
      add(frame_kind::turn);
    }
  }

  std::vector<glm::vec3> eyes_;
  std::vector<std::uint32_t> visits_;
  clearance clear_;
  std::uint32_t frames_, measured_ = 0;
  random_numbers random_;
  sightcell::view view_;
  glm::vec3 eye_{0.0f};
  float yaw_ = 0.0f;
  std::vector<tour_frame> out_;
};

}  // namespace

std::vector<tour_frame> make_cuts(const sightcell::db& db, const std::string& file, std::uint32_t cuts,
                                  std::uint64_t seed) {
  std::vector<tour_frame> out;
  const std::vector<glm::vec3> eyes = find_eyes(db, file);
  random_numbers random(seed);
  for (std::uint32_t i = 0; i < cuts; ++i) {
    const glm::vec3& eye = eyes[random.below(eyes.size())];
    const float yaw = full_turn * random.unit();
    const camera view{eye, yaw, 0.6f * (random.unit() - 0.5f)};
    for (const frame_kind kind : {frame_kind::cut, frame_kind::unmeasured, frame_kind::settled})
      out.push_back({view, kind});
  }
  return out;
}

std::vector<tour_frame> make_walk(const sightcell::db& db, const std::string& file,
                                  const sightcell::scene::world_geometry& world, std::uint32_t frames,
                                  std::uint64_t seed, std::uint32_t& jumps) {
  return walker(db, file, world, frames, seed).walk(jumps);
}

}  // namespace gpu_driven
