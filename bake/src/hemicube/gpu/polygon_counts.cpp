#include "hemicube/gpu/polygon_counts.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

#include "shaders/sources.h"
#include "shared/hemicube_layout.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_context.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t collect_groups = 64;
constexpr std::size_t header = shaders::hemicube_result_header;

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

void clear(const gl_buffer& words) {
  glClearNamedBufferData(words.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
}

// Memory that stays mapped: shaders write into it, and the program reads it.
class mapped_words {
 public:
  explicit mapped_words(std::size_t words)
      : size_(words), buffer_(4 * words, nullptr, flags | GL_CLIENT_STORAGE_BIT), data_(map(buffer_, 4 * words)) {}
  GLuint id() const { return buffer_.id(); }
  std::size_t size() const { return size_; }
  const std::uint32_t* data() const { return data_; }

 private:
  static constexpr GLbitfield flags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  static const std::uint32_t* map(const gl_buffer& buffer, std::size_t bytes) {
    const void* data = glMapNamedBufferRange(buffer.id(), 0, static_cast<GLsizeiptr>(bytes), flags);
    if (data == nullptr)
      throw error(error_kind::failed, "gl.error", "OpenGL source", "the device's memory cannot be read",
                  "use another source");
    return static_cast<const std::uint32_t*>(data);
  }
  std::size_t size_;
  gl_buffer buffer_;  // unmapped when it is deleted
  const std::uint32_t* data_;
};

}  // namespace

// The result of one hemicube in flight.
struct polygon_counts::slot {
  explicit slot(std::size_t words) : result(4 * words, nullptr), room(words) {}
  ~slot() { glDeleteSync(sent); }  // 0 is ignored
  gl_buffer result;
  std::size_t room;                     // words of result
  std::optional<mapped_words> arrived;  // the beginning of the result, usually all of it
  GLsync sent = nullptr;
};

polygon_counts::polygon_counts(std::uint32_t polygon_count, std::uint32_t group_count, std::uint32_t most_seen,
                               std::uint32_t slots)
    : most_seen_(std::min(checked(polygon_count), most_seen)),
      counts_(8 * std::size_t{polygon_count}, nullptr),
      found_(4 * (shaders::hemicube_found_header + std::size_t{most_seen_}), nullptr),
      sums_(16 * std::size_t{group_count}, nullptr),
      collect_program_("hemicube/collect", {{GL_COMPUTE_SHADER, shaders::hemicube_collect_comp}}) {
  clear(counts_);
  clear(found_);
  for (std::uint32_t i = 0; i < slots; ++i)
    slots_.push_back(std::make_unique<slot>(header + 3 * std::size_t{most_seen_}));
}

polygon_counts::~polygon_counts() = default;

void polygon_counts::bind() const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_counts, counts_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_found, found_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_sums, sums_.id());
}

void polygon_counts::send(std::uint32_t number) {
  list(number);
  mark_end(number);
}

void polygon_counts::list(std::uint32_t number) {
  slot& s = *slots_[number];
  if (!s.arrived) s.arrived.emplace(std::min<std::size_t>(s.room, header + 3 * 4096));
  glUseProgram(collect_program_.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_result, s.result.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shaders::hemicube_buffer_arrived, s.arrived->id());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glDispatchCompute(collect_groups, 1, 1);
  glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void polygon_counts::mark_end(std::uint32_t number) {
  slot& s = *slots_[number];
  glDeleteSync(s.sent);
  s.sent = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
}

void polygon_counts::receive(std::uint32_t number, std::vector<seen_polygon>& found, std::array<float, 4>& sums) {
  slot& s = *slots_[number];
  constexpr GLuint64 ten_minutes = 600'000'000'000u;
  const GLenum answer = glClientWaitSync(s.sent, GL_SYNC_FLUSH_COMMANDS_BIT, ten_minutes);
  if (answer != GL_ALREADY_SIGNALED && answer != GL_CONDITION_SATISFIED) {
    picture::gl_context::require_device("hemicube");
    throw error(error_kind::failed, "gl.error", "OpenGL source", "the device does not answer", "use another source");
  }

  const std::uint32_t* words = s.arrived->data();
  const std::uint32_t count = std::min(words[0], most_seen_);
  for (std::size_t i = 0; i < 4; ++i) sums[i] = std::bit_cast<float>(words[shaders::hemicube_result_sums + i]);
  found.clear();
  const auto take = [&](const std::uint32_t* from, std::size_t polygons) {
    for (std::size_t i = 0; i < polygons; ++i, from += 3) found.push_back({from[0], from[1], from[2]});
  };
  const std::size_t here = std::min<std::size_t>(count, (s.arrived->size() - header) / 3);
  take(words + header, here);
  if (here == count) return;
  // The list is longer than all before: the rest is still on the device. The next lists get more memory.
  std::vector<std::uint32_t> rest(3 * (count - here));
  glGetNamedBufferSubData(s.result.id(), static_cast<GLintptr>(4 * (header + 3 * here)),
                          static_cast<GLsizeiptr>(4 * rest.size()), rest.data());
  take(rest.data(), count - here);
  s.arrived.emplace(std::min<std::size_t>(s.room, header + 3 * (std::size_t{count} + count / 2)));
}

void polygon_counts::collect(std::vector<seen_polygon>& found, std::vector<float>& sums) {
  std::array<float, 4> four{};
  send(0);
  receive(0, found, four);
  sums.assign(four.begin(), four.end());
}

}  // namespace sightcell::bake
