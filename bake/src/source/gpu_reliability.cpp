#include "source/gpu_reliability.h"

#include <algorithm>

#include "shaders/sources.h"
#include "shared/reliability_layout.h"

namespace sightcell::bake {
namespace {

static_assert(shaders::reliability_map_size == reliability_map::map_size);

constexpr std::size_t texels = std::size_t{shaders::reliability_map_size} * shaders::reliability_map_size;
constexpr GLuint groups_along = shaders::reliability_map_size / shaders::reliability_group_side;

void bind(GLuint binding, const gl_buffer& buffer) {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.id());
}

}  // namespace

gpu_reliability_map::gpu_reliability_map(const glm::vec2& face_size)
    : aspect_(face_size / std::max({face_size.x, face_size.y, 1e-6f})),
      raise_("reliability/reliability", {{GL_COMPUTE_SHADER, shaders::reliability_reliability_comp}}),
      lowest_("reliability/lowest", {{GL_COMPUTE_SHADER, shaders::reliability_lowest_comp}}),
      values_(texels * sizeof(float), nullptr),
      lowest_of_groups_(shaders::reliability_groups * sizeof(shaders::reliability_texel), nullptr),
      result_(sizeof(shaders::reliability_texel), nullptr),
      change_(sizeof(shaders::reliability_change), nullptr, GL_DYNAMIC_STORAGE_BIT) {}

void gpu_reliability_map::add_sample(const glm::vec2& place, const std::array<double, 4>& importance) {
  samples_.push_back({place, importance});
  const double largest = *std::max_element(importance.begin(), importance.end());
  if (largest > largest_) {
    largest_ = largest;
    drawn_samples_ = 0;  // all sums are divided by it
  }
  changed_ = true;
}

void gpu_reliability_map::exclude(const glm::vec2& place) {
  excluded_.push_back(reliability_map::excluded_texels(place));
  changed_ = true;
}

// One dispatch for whatever has come since the last one.
void gpu_reliability_map::update() {
  if (!changed_) return;
  std::vector<shaders::reliability_sample> samples;
  for (const sample& s : samples_) {
    const auto variance = [&](direction k) { return static_cast<float>(sample_variance(s.importance[k], largest_)); };
    samples.push_back({{s.place.x, s.place.y, 0.0f, 0.0f},
                       {variance(toward_right), variance(toward_up), variance(toward_left), variance(toward_down)}});
  }
  sample_buffer_.emplace(samples.size() * sizeof(samples[0]), samples.data());
  excluded_buffer_.emplace(excluded_.size() * sizeof(excluded_[0]), excluded_.data());
  const shaders::reliability_change change{{aspect_.x, aspect_.y, 0.0f, 0.0f},
                                           static_cast<std::uint32_t>(drawn_samples_),
                                           static_cast<std::uint32_t>(samples.size()),
                                           static_cast<std::uint32_t>(excluded_.size()),
                                           0};
  glNamedBufferSubData(change_.id(), 0, sizeof change, &change);

  glBindBufferBase(GL_UNIFORM_BUFFER, shaders::reliability_block, change_.id());
  bind(shaders::reliability_buffer_samples, *sample_buffer_);
  bind(shaders::reliability_buffer_excluded, *excluded_buffer_);
  bind(shaders::reliability_buffer_values, values_);
  bind(shaders::reliability_buffer_lowest, lowest_of_groups_);
  bind(shaders::reliability_buffer_result, result_);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glUseProgram(raise_.id());
  glDispatchCompute(groups_along, groups_along, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glUseProgram(lowest_.id());
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  drawn_samples_ = samples_.size();
  changed_ = false;
}

reliability_map::lowest_place gpu_reliability_map::lowest() {
  update();
  shaders::reliability_texel found{};
  glGetNamedBufferSubData(result_.id(), 0, sizeof found, &found);
  return {found.reliability, reliability_map::center_of(found.number)};
}

std::vector<float> gpu_reliability_map::values() {
  update();
  std::vector<float> all(texels);
  glGetNamedBufferSubData(values_.id(), 0, static_cast<GLsizeiptr>(all.size() * sizeof(float)), all.data());
  return all;
}

}  // namespace sightcell::bake
