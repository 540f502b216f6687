#include "bench/gpu_counters/counters.h"

#include <algorithm>
#include <chrono>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "hemicube/gpu/gpu_objects.h"
#include "sightcell/picture/gl_program.h"

namespace sightcell::bench {
namespace {

constexpr const char* vertex_text = R"(#version 450 core
layout(location = 0) in vec2 position;
layout(location = 0) uniform float depth;
void main() { gl_Position = vec4(position, depth, 1.0); }
)";

constexpr const char* fragment_text = R"(#version 450 core
layout(location = 0) out uint id;
void main() { id = uint(gl_PrimitiveID); }
)";

// An odd factor spreads neighbors over the whole buffer; mask 0 puts all on the first word.
constexpr const char* atomics_text = R"(#version 450 core
layout(local_size_x = 512) in;
layout(location = 0) uniform uint mask;
layout(std430, binding = 0) buffer words_buffer { uint words[]; };
void main() { atomicAdd(words[gl_GlobalInvocationID.x * 2654435761u & mask], 1u); }
)";

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Items per second of work(times), which stands for items * times; best of three.
template <class Work>
double rate(double items, double seconds, const Work& work) {
  const auto took = [&](int times) {
    const double start = seconds_now();
    work(times);
    glFinish();
    return seconds_now() - start;
  };
  took(1);
  int times = 1;
  double last = took(times);
  while (last < 0.3 * seconds && times < (1 << 24)) last = took(times *= 2);
  times = std::max(1, static_cast<int>(times * seconds / std::max(last, 1e-9)));
  double best = 0.0;
  for (int i = 0; i < 3; ++i) best = std::max(best, items * times / std::max(took(times), 1e-9));
  return best;
}

// A grid over clip space, two triangles per square.
struct grid {
  grid(std::uint32_t columns, std::uint32_t rows) {
    std::vector<glm::vec2> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y <= rows; ++y)
      for (std::uint32_t x = 0; x <= columns; ++x)
        positions.emplace_back(2.0f * static_cast<float>(x) / static_cast<float>(columns) - 1.0f,
                               2.0f * static_cast<float>(y) / static_cast<float>(rows) - 1.0f);
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < columns; ++x) {
        const std::uint32_t a = y * (columns + 1) + x, b = a + columns + 1;
        indices.insert(indices.end(), {a, a + 1, b, b, a + 1, b + 1});
      }
    count = static_cast<GLsizei>(indices.size());
    vertices.emplace(positions.size() * sizeof(glm::vec2), positions.data());
    index_buffer.emplace(indices.size() * sizeof(std::uint32_t), indices.data());
    glCreateVertexArrays(1, &array);
    glVertexArrayVertexBuffer(array, 0, vertices->id(), 0, sizeof(glm::vec2));
    glVertexArrayElementBuffer(array, index_buffer->id());
    glEnableVertexArrayAttrib(array, 0);
    glVertexArrayAttribFormat(array, 0, 2, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, 0, 0);
  }
  ~grid() { glDeleteVertexArrays(1, &array); }
  grid(const grid&) = delete;
  grid& operator=(const grid&) = delete;
  void draw(float depth) const {
    glBindVertexArray(array);
    glUniform1f(0, depth);
    glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, nullptr);
  }
  std::optional<bake::gl_buffer> vertices, index_buffer;
  GLuint array = 0;
  GLsizei count = 0;
};

void count_drawing(std::uint32_t resolution, double seconds, gpu_counters& counters) {
  const auto width = static_cast<GLsizei>(3 * resolution), height = static_cast<GLsizei>(resolution);
  const bake::gl_image ids(GL_R32UI, width, height), depths(GL_DEPTH_COMPONENT32F, width, height);
  const bake::gl_framebuffer framebuffer(ids.id(), depths.id());
  const picture::gl_program program("counters", {{GL_VERTEX_SHADER, vertex_text}, {GL_FRAGMENT_SHADER, fragment_text}});
  const grid whole(1, 1), fine(3 * resolution / 2, resolution / 2);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
  glViewport(0, 0, width, height);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GEQUAL);
  glUseProgram(program.id());
  const GLuint background[4] = {};
  const GLfloat farthest = 0.0f;
  glClearBufferuiv(GL_COLOR, 0, background);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  const auto repeated = [](const grid& drawn, float depth) {
    return [&drawn, depth](int times) {
      for (int i = 0; i < times; ++i) drawn.draw(depth);
    };
  };
  counters.pixels_per_second = rate(double(width) * height, seconds, repeated(whole, 0.25f));
  counters.triangles_per_second = rate(fine.count / 3, seconds, repeated(fine, 0.5f));
  whole.draw(0.75f);
  counters.hidden_triangles_per_second = rate(fine.count / 3, seconds, repeated(fine, 0.5f));
}

}  // namespace

gpu_counters count_gpu(const picture::gl_context& context, std::uint32_t resolution, double seconds) {
  gpu_counters counters;
  count_drawing(resolution, seconds, counters);

  const std::uint32_t words = seconds < 0.1 ? 1u << 18 : 1u << 24, groups = words / 512;
  const std::vector<std::uint32_t> zeros(words);
  const bake::gl_buffer buffer(zeros.size() * 4, zeros.data());
  const picture::gl_program program("atomics", {{GL_COMPUTE_SHADER, atomics_text}});
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.id());
  glUseProgram(program.id());
  for (const std::uint32_t mask : {words - 1, 0u}) {
    glUniform1ui(0, mask);
    (mask != 0 ? counters.atomics_per_second : counters.atomics_on_one_word_per_second) =
        rate(words, seconds, [&](int times) {
          for (int i = 0; i < times; ++i) glDispatchCompute(groups, 1, 1);
        });
  }
  context.check("counters");
  return counters;
}

}  // namespace sightcell::bench
