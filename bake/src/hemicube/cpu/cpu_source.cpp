#include "hemicube/cpu/cpu_source.h"

#include <tbb/collaborative_call_once.h>
#include <tbb/concurrent_queue.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "hemicube/cpu/cluster_scene.h"
#include "hemicube/cpu/kernel.h"
#include "hemicube/hemicube_faces.h"
#include "sightcell/base/process_time.h"
#include "touched/touched_space.h"

namespace sightcell::bake {
namespace {

const cpu::kernel& kernel_of(cpu_instructions wanted) {
  switch (wanted) {
#if defined(SIGHTCELL_HAS_AVX2_KERNEL)
    case cpu_instructions::avx2:
      return cpu::avx2_kernel;
#endif
#if defined(SIGHTCELL_HAS_SSE4_KERNEL)
    case cpu_instructions::sse4:
      return cpu::sse4_kernel;
#endif
#if defined(SIGHTCELL_HAS_NEON_KERNEL)
    case cpu_instructions::neon:
      return cpu::neon_kernel;
#endif
    default:
      return cpu::portable_kernel;
  }
}

// Memory aligned for vectors of eight lanes. It is not initialized, so the memory of empty tiles is never touched.
template <class T>
class aligned_array {
 public:
  explicit aligned_array(std::size_t size)
      : data_(static_cast<T*>(::operator new (size * sizeof(T), std::align_val_t{64}))) {}
  ~aligned_array() { ::operator delete (data_, std::align_val_t{64}); }
  aligned_array(const aligned_array&) = delete;
  aligned_array& operator=(const aligned_array&) = delete;
  T* data() const { return data_; }

 private:
  T* data_;
};

constexpr std::uint32_t tiles_along(std::uint32_t pixels) {
  return (pixels + cpu::tile_size - 1) / cpu::tile_size;
}
constexpr std::uint32_t row_stride(std::uint32_t pixels) {
  return (tiles_along(pixels) + 7) / 8 * 8;
}

// Memory for drawing one hemicube. Its faces use it one after the other.
struct image_buffers {
  image_buffers(std::uint32_t resolution, std::uint32_t polygon_count)
      : inverse_depths(std::size_t{row_stride(resolution)} * tiles_along(resolution) * cpu::tile_pixels),
        ids(std::size_t{row_stride(resolution)} * tiles_along(resolution) * cpu::tile_pixels),
        farthest(std::size_t{row_stride(resolution)} * tiles_along(resolution)),
        states(std::size_t{row_stride(resolution)} * tiles_along(resolution)),
        row_below(2 * std::size_t{tiles_along(resolution)} * cpu::tile_size),
        pixels(polygon_count),
        found((std::size_t{polygon_count} + 63) / 64) {}

  cpu::tile_image image(const cpu::face_frame& face) const {
    return {tiles_along(face.width),
            tiles_along(face.height),
            row_stride(face.width),
            inverse_depths.data(),
            ids.data(),
            farthest.data(),
            states.data()};
  }
  cpu::polygon_counter counter() { return {pixels.data(), found.data()}; }

  // Lists the counted polygons by ascending id, and clears the counts for the next hemicube.
  void take_found(std::vector<seen_polygon>& seen) {
    seen.clear();
    for (std::size_t word = 0; word < found.size(); ++word) {
      for (std::uint64_t bits = found[word]; bits != 0; bits &= bits - 1) {
        const auto id = static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
        seen.push_back({id, pixels[id].pixels, pixels[id].first});
        pixels[id] = {};
      }
      found[word] = 0;
    }
  }

  aligned_array<float> inverse_depths;
  aligned_array<std::uint32_t> ids;
  aligned_array<float> farthest;
  aligned_array<cpu::tile_state> states;
  aligned_array<float> row_below;
  std::vector<cpu::polygon_pixels> pixels;
  std::vector<std::uint64_t> found;
};

cpu::face_frame frame_of(const glm::vec3& eye, const face_view& face, std::uint32_t resolution) {
  cpu::face_frame f{};
  for (int i = 0; i < 3; ++i) {
    f.eye[i] = eye[i];
    f.right[i] = face.right[i];
    f.up[i] = face.up[i];
    f.forward[i] = face.forward[i];
  }
  f.half = static_cast<float>(resolution) / 2.0f;
  const auto half = static_cast<std::int32_t>(resolution / 2);
  f.center_x = half - static_cast<std::int32_t>((face.min_x + 1.0f) * f.half);
  f.center_y = half - static_cast<std::int32_t>((face.min_y + 1.0f) * f.half);
  f.width = face.width;
  f.height = face.height;
  // The kept part grows to whole tiles.
  const auto reach = [&](std::uint32_t pixels, std::int32_t center) {
    return static_cast<float>(static_cast<std::int32_t>(tiles_along(pixels) * cpu::tile_size) - center) / f.half;
  };
  f.min_x = face.min_x;
  f.min_y = face.min_y;
  f.max_x = reach(face.width, f.center_x);
  f.max_y = reach(face.height, f.center_y);
  f.atlas_x = face.x;
  f.atlas_y = face.y;
  f.atlas_width = 3 * resolution;
  return f;
}

// Returns the smallest inverse depth of the pixels of a block of a tile.
float farthest_of(const float* inverse_depths, std::uint32_t x, std::uint32_t y, std::uint32_t block) {
  float least = std::numeric_limits<float>::infinity();
  for (std::uint32_t j = y; j < y + block; ++j)
    for (std::uint32_t i = x; i < x + block; ++i) least = std::min(least, inverse_depths[j * cpu::tile_size + i]);
  return least;
}

// The same for a whole tile, in a form that compilers turn into vector instructions.
float farthest_of_tile(const float* inverse_depths) {
  std::array<float, cpu::tile_size> least;
  std::copy_n(inverse_depths, cpu::tile_size, least.begin());
  for (std::uint32_t j = 1; j < cpu::tile_size; ++j)
    for (std::uint32_t i = 0; i < cpu::tile_size; ++i) {
      const float depth = inverse_depths[j * cpu::tile_size + i];
      least[i] = depth < least[i] ? depth : least[i];
    }
  return *std::min_element(least.begin(), least.end());
}

constexpr float pixel_rounding = 1.0f / 16.0f;  // pixels; more than the kernels round

// Records how far the pixels of a face see, block by block of pixels.
void record_face(const cpu::face_frame& f, const cpu::tile_image& tiles, std::uint32_t block, touched_space& space) {
  touched_face face;
  face.eye = {f.eye[0], f.eye[1], f.eye[2]};
  face.right = {f.right[0], f.right[1], f.right[2]};
  face.up = {f.up[0], f.up[1], f.up[2]};
  face.forward = {f.forward[0], f.forward[1], f.forward[2]};
  face.min_x = static_cast<float>(-f.center_x) / f.half;
  face.min_y = static_cast<float>(-f.center_y) / f.half;
  face.step = static_cast<float>(block) / f.half;
  face.reach = (0.5f * static_cast<float>(block - 1) + pixel_rounding) / f.half;
  face.columns = (f.width + block - 1) / block;
  face.rows = (f.height + block - 1) / block;
  std::uint8_t* code = space.mark_face(face).data();
  for (std::uint32_t y = 0; y < f.height; y += block)
    for (std::uint32_t x = 0; x < f.width; x += block, ++code) {
      const std::size_t tile = std::size_t{y / cpu::tile_size} * tiles.stride + x / cpu::tile_size;
      if (tiles.states[tile] == cpu::tile_state::empty) continue;
      const float* depths = tiles.inverse_depths + tile * cpu::tile_pixels;
      *code = touched_faces::code_of(block < cpu::tile_size
                                         ? farthest_of(depths, x % cpu::tile_size, y % cpu::tile_size, block)
                                     : tiles.states[tile] == cpu::tile_state::exact ? tiles.farthest[tile]
                                                                                    : farthest_of_tile(depths));
    }
}

cpu::tree_view view_of(const cpu::cluster_tree& tree) {
  return {tree.nodes.empty() ? nullptr : tree.nodes.data(), tree.clusters.data(), tree.blocks.data(), tree.marks.data(),
          tree.masked.empty() ? nullptr : tree.masked.data()};
}

class cpu_source final : public hemicube_source {
 public:
  cpu_source(const scene::world_geometry& geometry, const cpu_source_options& options)
      : resolution_(options.resolution),
        far_plane_(options.far_plane),
        importance_(options.importance),
        polygon_count_(static_cast<std::uint32_t>(geometry.kinds.size())),
        kernel_(kernel_of(options.instructions)),
        geometry_(&geometry) {
    if (!options.when_needed) build();
  }

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override {
    if (poses.size() == 1) return with_buffers([&](image_buffers& at) { render_one(at, poses[0], views[0]); });
    tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
      with_buffers([&](image_buffers& at) { render_one(at, poses[i], views[i]); });
    });
  }

  std::optional<sample_split> render_split(const pose& where, hemicube_view& view) override {
    sample_split spent;
    with_buffers([&](image_buffers& at) { render_one(at, where, view, &spent); });
    return spent;
  }

  void render_image(const pose& where, hemicube_image& image) override {
    with_buffers([&](image_buffers& at) {
      const std::size_t width = 3 * std::size_t{resolution_};
      image.resolution = resolution_;
      image.ids.assign(width * resolution_, scene::no_index);
      image.inverse_depths.assign(width * resolution_, 0.0f);
      for (const face_view& face : hemicube_faces(where, resolution_)) {
        const cpu::face_frame frame = frame_of(where.eye, face, resolution_);
        const cpu::tile_image tiles = at.image(frame);
        kernel_.draw(view_, frame, tiles, at.counter());
        if (recorded_space) record_face(frame, tiles, touched_space::block_of(resolution_), *recorded_space);
        for (std::uint32_t y = 0; y < face.height; ++y)
          for (std::uint32_t x = 0; x < face.width; ++x) {
            const std::size_t tile = std::size_t{y / cpu::tile_size} * tiles.stride + x / cpu::tile_size;
            if (tiles.states[tile] == cpu::tile_state::empty) continue;
            const std::size_t from = tile * cpu::tile_pixels + y % cpu::tile_size * cpu::tile_size + x % cpu::tile_size;
            image.ids[(face.y + y) * width + face.x + x] = tiles.ids[from];
            image.inverse_depths[(face.y + y) * width + face.x + x] = tiles.inverse_depths[from];
          }
      }
      std::vector<seen_polygon> see_through;
      at.take_found(see_through);
    });
  }

  std::uint32_t resolution() const override { return resolution_; }
  // Part of the settings text of every file, so its spelling cannot change without changing bytes.
  std::string device() const override { return std::string("CPU rasterizer (") + kernel_.name + ")"; }

 private:
  // spent: if not null, the CPU seconds of the parts are added to it.
  void render_one(image_buffers& at, const pose& where, hemicube_view& view, sample_split* spent = nullptr) {
    const auto now = [&] { return spent != nullptr ? thread_cpu_seconds() : 0.0; };
    sample_split none;
    sample_split& sum = spent != nullptr ? *spent : none;
    cpu::importance_sums sums;
    sums.row_below = at.row_below.data();
    double began = now();
    const auto lap = [&](double& part) {
      const double ended = now();
      part += ended - began;
      began = ended;
    };
    for (const face_view& face : hemicube_faces(where, resolution_)) {
      const cpu::face_frame frame = frame_of(where.eye, face, resolution_);
      const cpu::tile_image tiles = at.image(frame);
      kernel_.draw(view_, frame, tiles, at.counter());
      lap(sum.draw);
      if (recorded_space) record_face(frame, tiles, touched_space::block_of(resolution_), *recorded_space);
      kernel_.gather(frame, tiles, at.counter());
      lap(sum.gather);
      if (importance_) kernel_.add_importance(frame, tiles, far_plane_, sums);
      lap(sum.statistics);
    }
    at.take_found(view.seen);
    lap(sum.gather);
    view.importance[toward_right] = sums.right;
    view.importance[toward_up] = sums.up;
    view.importance[toward_left] = sums.left;
    view.importance[toward_down] = sums.down;
  }

  // Threads that come while the clusters are built help with it.
  void build() {
    tbb::collaborative_call_once(built_, [this] {
      scene_.emplace(*geometry_);
      view_ = {view_of(scene_->opaque),        view_of(scene_->masked),    view_of(scene_->see_through),
               scene_->alpha.triangles.data(), scene_->alpha.tests.data(), scene_->alpha.texels.data(),
               scene_->alpha.counts.data()};
      geometry_ = nullptr;
    });
  }

  // Calls work with buffers that no other call uses. Makes new buffers if all are in use.
  template <class Work>
  void with_buffers(const Work& work) {
    build();
    std::unique_ptr<image_buffers> at;
    if (!free_.try_pop(at)) at = std::make_unique<image_buffers>(resolution_, polygon_count_);
    work(*at);
    free_.push(std::move(at));
  }

  std::uint32_t resolution_;
  float far_plane_;
  bool importance_;
  std::uint32_t polygon_count_;
  const cpu::kernel& kernel_;
  tbb::collaborative_once_flag built_;
  const scene::world_geometry* geometry_;  // until the clusters are built
  std::optional<cpu::cluster_scene> scene_;
  cpu::scene_view view_{};
  tbb::concurrent_queue<std::unique_ptr<image_buffers>> free_;
};

}  // namespace

std::vector<cpu_instructions> available_instructions() {
  std::vector<cpu_instructions> sets;
#if defined(SIGHTCELL_HAS_AVX2_KERNEL)
  if (__builtin_cpu_supports("avx2")) sets.push_back(cpu_instructions::avx2);
#endif
#if defined(SIGHTCELL_HAS_SSE4_KERNEL)
  // -msse4.2 lets the compiler use popcnt too.
  if (__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt")) sets.push_back(cpu_instructions::sse4);
#endif
#if defined(SIGHTCELL_HAS_NEON_KERNEL)
  sets.push_back(cpu_instructions::neon);  // every ARM64 processor has it
#endif
  sets.push_back(cpu_instructions::portable);
  return sets;
}

std::unique_ptr<hemicube_source> make_cpu_source(const scene::world_geometry& geometry,
                                                 const cpu_source_options& options) {
  check_hemicube(options.resolution, options.far_plane);
  return std::make_unique<cpu_source>(geometry, options);
}

}  // namespace sightcell::bake
