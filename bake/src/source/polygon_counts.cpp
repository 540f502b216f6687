#include "source/polygon_counts.h"

#include <algorithm>
#include <bit>
#include <string>

#include "shaders/sources.h"
#include "shared/hemicube_layout.h"
#include "sightcell/scene/error.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t collect_groups = 64;

std::uint32_t checked(std::uint32_t polygon_count) {
  GLint64 limit = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
  // The largest buffer is the result with three words per polygon.
  if (std::uint64_t{polygon_count} * 12 + (1u << 20) > static_cast<std::uint64_t>(limit)) {
    throw error(error_kind::failed, "gpu.scene-too-large", "OpenGL source",
                "the device's storage buffers hold " + std::to_string(limit >> 20) + " MiB, too few for " +
                    std::to_string(polygon_count) + " polygons",
                "use another source");
  }
  return polygon_count;
}

gl_buffer zeros(std::size_t words) {
  const std::vector<std::uint32_t> data(words);
  return {words * 4, data.data(), GL_DYNAMIC_STORAGE_BIT};
}

}  // namespace

polygon_counts::polygon_counts(std::uint32_t polygon_count, std::uint32_t group_count)
    : group_count_(group_count),
      counts_(zeros(2 * std::size_t{checked(polygon_count)})),
      found_(zeros(1 + std::size_t{polygon_count})),
      result_(zeros(shaders::hemicube_result_header + 4 * std::size_t{group_count} + 3 * std::size_t{polygon_count})),
      collect_program_("hemicube/collect", {{GL_COMPUTE_SHADER, shaders::hemicube_collect_comp}}),
      words_(shaders::hemicube_result_header + 4 * std::size_t{group_count} + 3 * std::size_t{polygon_count}) {}

void polygon_counts::start() {
  const std::uint32_t none = 0;
  glNamedBufferSubData(found_.id(), 0, sizeof none, &none);
}

void polygon_counts::bind() const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_counts, counts_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_found, found_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_result, result_.id());
}

void polygon_counts::collect(std::vector<seen_polygon>& found, std::vector<float>& group_sums) {
  glUseProgram(collect_program_.id());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glDispatchCompute(collect_groups, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);

  const std::size_t list = shaders::hemicube_result_header + 4 * std::size_t{group_count_};
  const auto read = [this](std::size_t first, std::size_t last) {
    if (first >= last) return;
    glGetNamedBufferSubData(result_.id(), static_cast<GLintptr>(4 * first), static_cast<GLsizeiptr>(4 * (last - first)),
                            &words_[first]);
  };
  const std::size_t at_once = std::min(words_.size(), list + 3 * std::size_t{expected_});
  read(0, at_once);
  const std::uint32_t count = words_[0];
  const std::size_t end = std::min(words_.size(), list + 3 * std::size_t{count});
  read(at_once, end);
  expected_ = std::max<std::uint32_t>(1024, count + count / 4);

  found.clear();
  for (std::size_t at = list; at < end; at += 3) found.push_back({words_[at], words_[at + 1], words_[at + 2]});
  group_sums.resize(4 * std::size_t{group_count_});
  for (std::size_t i = 0; i < group_sums.size(); ++i) {
    group_sums[i] = std::bit_cast<float>(words_[shaders::hemicube_result_header + i]);
  }
}

}  // namespace sightcell::bake
