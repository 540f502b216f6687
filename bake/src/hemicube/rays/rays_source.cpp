#include "hemicube/rays/rays_source.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <string>

#include "hemicube/hemicube_faces.h"
#include "hemicube/image_gather.h"
#include "sightcell/base/process_time.h"
#include "trace/duplicates.h"
#include "trace/embree_scene.h"

namespace sightcell::bake {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t tile = 8;  // pixels along a side of the tiles that Embree traces in one call

// The packets of one tile: blocks of 4 x 2 or 4 x 4 pixels. Nearly square blocks visit fewer nodes of the tree.
template <class RayHit, unsigned Lanes>
struct packet_tile {
  using packet = RayHit;
  static constexpr unsigned lanes = Lanes, columns = 4, rows = lanes / columns;
  static constexpr unsigned packets = tile * tile / lanes;

  // Position of a lane in the tile.
  static constexpr std::uint32_t x_of(unsigned number, unsigned lane) {
    return number % (tile / columns) * columns + lane % columns;
  }
  static constexpr std::uint32_t y_of(unsigned number, unsigned lane) {
    return number / (tile / columns) * rows + lane / columns;
  }

  std::array<packet, packets> rays;
};

using tile_of_8 = packet_tile<RTCRayHit8, 8>;
using tile_of_16 = packet_tile<RTCRayHit16, 16>;

void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* rays) {
  rtcIntersect8(valid, scene, context, rays);
}
void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16* rays) {
  rtcIntersect16(valid, scene, context, rays);
}

struct scratch {
  explicit scratch(std::uint32_t polygon_count) : gather(polygon_count) {}

  hemicube_image image;
  image_gather gather;
  alignas(64) tile_of_8 of_8;
  alignas(64) tile_of_16 of_16;
};

// Context of the filter that counts non-occluders along a ray. The id of a ray is the number of its pixel. Embree's
// part has to be the first member.
struct see_through_context {
  RTCIntersectContext base{};
  const embree_scene* scene;
  image_gather* gather;
  const float* inverse_depths;  // of the occluders, by pixel
};

// True if a hit is in front of the occluder, or behind it within the reach of coincident surfaces.
bool before(const RTCFilterFunctionNArguments& a, unsigned i, float inverse_depth) {
  const float depth = RTCRayN_tfar(a.ray, a.N, i);
  if (depth * inverse_depth <= 1.0f) return true;
  const glm::vec3 along{RTCRayN_dir_x(a.ray, a.N, i), RTCRayN_dir_y(a.ray, a.N, i), RTCRayN_dir_z(a.ray, a.N, i)};
  const float front = 1.0f / inverse_depth, length = glm::length(along);
  return depth <= front + coincidence_reach(front * length) / length;
}

void count_see_through(const RTCFilterFunctionNArguments* arguments) {
  const RTCFilterFunctionNArguments& a = *arguments;
  const auto* context = reinterpret_cast<const see_through_context*>(a.context);
  const embree_scene& scene = *context->scene;
  for (unsigned i = 0; i < a.N; ++i) {
    if (a.valid[i] != -1) continue;
    a.valid[i] = 0;  // the ray continues
    const std::uint32_t polygon = scene.polygon_of(a, i);
    if (scene.geometry.kinds[polygon].always) continue;  // in every set anyway
    const unsigned pixel = RTCRayN_id(a.ray, a.N, i);
    if (before(a, i, context->inverse_depths[pixel]) && scene.is_there(a, i, scene.all_double_sided))
      context->gather->add(polygon, 1, pixel);
  }
}

class rays_source final : public hemicube_source {
 public:
  rays_source(std::unique_ptr<embree_scene> own, const embree_scene& shared, const rays_source_options& options)
      : own_(std::move(own)),
        embree_(shared),
        resolution_(options.resolution),
        at_far_plane_(1.0f / options.far_plane),
        importance_(options.importance),
        polygon_count_(static_cast<std::uint32_t>(shared.geometry.kinds.size())),
        wide_(rtcGetDeviceProperty(shared.device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0),
        scratch_([this] { return scratch(polygon_count_); }) {
    check_hemicube(options.resolution, options.far_plane);
    const duplicate_classes classes(embree_.geometry, embree_.all_double_sided);
    for (const unsigned g : {opaque_standing, tested_standing}) {
      lowest_[g] = embree_.ids[g];
      for (std::uint32_t& id : lowest_[g])
        if (const auto members = classes.class_of(id); !members.empty()) id = members.front();
    }
    make_see_through();
  }
  ~rays_source() override {
    if (see_through_) rtcReleaseScene(see_through_);
  }
  rays_source(const rays_source&) = delete;
  rays_source& operator=(const rays_source&) = delete;

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override {
    tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
      scratch& own = scratch_.local();
      const auto faces = trace(poses[i], own, own.image);
      own.gather.list(own.image.ids, views[i].seen);
      views[i].importance = {};
      if (importance_) own.gather.sum(faces, own.image.inverse_depths, at_far_plane_, views[i].importance);
    });
  }

  void render_image(const pose& where, hemicube_image& image) override {
    scratch& own = scratch_.local();
    trace(where, own, image);
    std::vector<seen_polygon> unused;  // empties the scratch
    own.gather.list(image.ids, unused);
  }

  std::optional<sample_split> render_split(const pose& where, hemicube_view& view) override {
    scratch& own = scratch_.local();
    const double start = thread_cpu_seconds();
    const auto faces = trace(where, own, own.image);
    const double traced = thread_cpu_seconds();
    own.gather.list(own.image.ids, view.seen);
    const double listed = thread_cpu_seconds();
    own.gather.sum(faces, own.image.inverse_depths, at_far_plane_, view.importance);
    return sample_split{traced - start, listed - traced, thread_cpu_seconds() - listed};
  }

  std::uint32_t resolution() const override { return resolution_; }
  std::string device() const override {
    const auto version = [&](RTCDeviceProperty part) {
      return std::to_string(rtcGetDeviceProperty(embree_.device, part));
    };
    // Without AVX2, Embree builds another tree and splits the packets, so rays along edges may hit other polygons.
    const bool native = rtcGetDeviceProperty(embree_.device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
    return "Embree " + version(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." + version(RTC_DEVICE_PROPERTY_VERSION_MINOR) +
           "." + version(RTC_DEVICE_PROPERTY_VERSION_PATCH) +
           (wide_    ? ", packets of 16 (AVX-512)"
            : native ? ", packets of 8 (AVX2)"
                     : ", packets of 8 (without AVX2)");
  }

 private:
  // Builds a tree over the non-occluders. Their geometries are those of the ray scene.
  void make_see_through() {
    for (unsigned g = 0; g < embree_geometry_count; ++g) {
      if (occludes(g) || embree_.ids[g].empty()) continue;
      if (!see_through_) see_through_ = embree_.make_scene();
      rtcAttachGeometryByID(see_through_, rtcGetGeometry(embree_.all, g), g);
    }
    if (see_through_) rtcCommitScene(see_through_);
    embree_.check("building the see-through part of the ray scene");
  }

  std::array<face_view, face_count> trace(const pose& where, scratch& own, hemicube_image& image) const {
    image.resolution = resolution_;
    image.ids.resize(3 * std::size_t{resolution_} * resolution_);
    image.inverse_depths.resize(image.ids.size());
    const auto faces = hemicube_faces(where, resolution_);
    const auto trace_all = [&](auto& rays) {
      start(where.eye, rays);
      for (const face_view& face : faces)
        for (std::uint32_t y = 0; y < face.height; y += tile)
          for (std::uint32_t x = 0; x < face.width; x += tile) trace_tile(face, x, y, rays, own.gather, image);
    };
    if (wide_)
      trace_all(own.of_16);
    else
      trace_all(own.of_8);
    return faces;
  }

  // Sets what is the same for all tiles of a hemicube. Embree does not change it.
  template <class Tile>
  static void start(const glm::vec3& eye, Tile& t) {
    for (auto& p : t.rays) {
      p = {};
      for (unsigned i = 0; i < Tile::lanes; ++i) {
        p.ray.org_x[i] = eye.x, p.ray.org_y[i] = eye.y, p.ray.org_z[i] = eye.z;
        p.ray.mask[i] = ~0u;
      }
    }
  }

  // Directions have length 1 along the axis of the face, so that Embree's distance is the depth.
  template <class Tile>
  static void aim(const face_view& face, std::uint32_t x, std::uint32_t y, Tile& t) {
    const float step_x = (face.max_x - face.min_x) / static_cast<float>(face.width);
    const float step_y = (face.max_y - face.min_y) / static_cast<float>(face.height);
    for (unsigned k = 0; k < Tile::packets; ++k) {
      auto& p = t.rays[k];
      for (unsigned i = 0; i < Tile::lanes; ++i) {
        const std::uint32_t px = x + Tile::x_of(k, i), py = y + Tile::y_of(k, i);
        const float a = face.min_x + (static_cast<float>(px) + 0.5f) * step_x;
        const float b = face.min_y + (static_cast<float>(py) + 0.5f) * step_y;
        p.ray.dir_x[i] = face.forward.x + a * face.right.x + b * face.up.x;
        p.ray.dir_y[i] = face.forward.y + a * face.right.y + b * face.up.y;
        p.ray.dir_z[i] = face.forward.z + a * face.right.z + b * face.up.z;
        p.ray.id[i] = ray_tests_masks;
        // Pixels beyond the end of the face: rays without length, which Embree skips.
        p.ray.tfar[i] = px < face.width && py < face.height ? infinity : -infinity;
        p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
    }
  }

  template <class Tile>
  void trace_tile(const face_view& face, std::uint32_t x, std::uint32_t y, Tile& t, image_gather& gather,
                  hemicube_image& image) const {
    aim(face, x, y, t);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    stream(embree_.solid, context, t);
    for (auto& p : t.rays) retrace_back_hits(p, Tile::lanes);
    const std::size_t stride = 3 * std::size_t{resolution_}, corner = (face.y + y) * stride + face.x + x;
    for (unsigned k = 0; k < Tile::packets; ++k) {
      const auto& p = t.rays[k];
      for (unsigned i = 0; i < Tile::lanes; ++i) {
        if (p.ray.tfar[i] < 0.0f) continue;
        const std::size_t pixel = corner + Tile::y_of(k, i) * stride + Tile::x_of(k, i);
        const unsigned geometry = p.hit.geomID[i], primitive = p.hit.primID[i];
        if (geometry == RTC_INVALID_GEOMETRY_ID) {
          image.ids[pixel] = scene::no_index;
          image.inverse_depths[pixel] = 0.0f;
        } else {
          image.ids[pixel] = lowest_[geometry][primitive];
          image.inverse_depths[pixel] = 1.0f / p.ray.tfar[i];
        }
      }
    }
    if (see_through_) trace_see_through(corner, t, gather, image);
  }

  template <class Tile>
  static void stream(RTCScene scene, RTCIntersectContext& context, Tile& t) {
    using packet = typename Tile::packet;
    rtcIntersectNM(scene, &context, reinterpret_cast<RTCRayHitN*>(t.rays.data()), Tile::lanes, Tile::packets,
                   sizeof(packet));
  }

  // Opaque polygons have no filter for their sides, because nearly all rays hit a front side first. A ray that hits a
  // back side is traced again, with the filter of all other rays.
  template <class Packet>
  void retrace_back_hits(Packet& p, unsigned lanes) const {
    if (embree_.all_double_sided) return;
    alignas(64) int again[16];
    bool any = false;
    for (unsigned i = 0; i < lanes; ++i) {
      const bool back =
          p.hit.geomID[i] == opaque_standing &&
          p.hit.Ng_x[i] * p.ray.dir_x[i] + p.hit.Ng_y[i] * p.ray.dir_y[i] + p.hit.Ng_z[i] * p.ray.dir_z[i] > 0.0f &&
          !embree_.geometry.kinds[embree_.ids[opaque_standing][p.hit.primID[i]]].double_sided;
      again[i] = back ? -1 : 0;
      if (!back) continue;
      any = true;
      p.ray.tfar[i] = infinity;
      p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    if (!any) return;
    trace_context context(embree_);
    context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    intersect(again, embree_.solid, &context.base, &p);
  }

  template <class Tile>
  void trace_see_through(std::size_t corner, Tile& t, image_gather& gather, const hemicube_image& image) const {
    const std::size_t stride = 3 * std::size_t{resolution_};
    for (unsigned k = 0; k < Tile::packets; ++k) {
      auto& p = t.rays[k];
      // Slightly too far for oblique rays; the filter tests the exact distance. Rays without a hit stay infinite.
      for (unsigned i = 0; i < Tile::lanes; ++i) p.ray.tfar[i] += coincidence_reach(p.ray.tfar[i]);
      for (unsigned i = 0; i < Tile::lanes; ++i) {
        p.ray.id[i] = static_cast<unsigned>(corner + Tile::y_of(k, i) * stride + Tile::x_of(k, i));
        p.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
    }
    see_through_context context{.scene = &embree_, .gather = &gather, .inverse_depths = image.inverse_depths.data()};
    rtcInitIntersectContext(&context.base);
    context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    context.base.filter = count_see_through;
    stream(see_through_, context.base, t);
  }

  std::unique_ptr<embree_scene> own_;
  const embree_scene& embree_;
  std::uint32_t resolution_;
  float at_far_plane_;
  bool importance_;
  std::uint32_t polygon_count_;
  bool wide_;
  // For each geometry with occluders and each primitive: the lowest source id among its exact duplicates.
  std::array<std::vector<std::uint32_t>, 2> lowest_;
  RTCScene see_through_ = nullptr;  // the non-occluders; null where there are none
  tbb::enumerable_thread_specific<scratch> scratch_;
};

}  // namespace

std::unique_ptr<hemicube_source> make_rays_source(const scene::world_geometry& geometry,
                                                  const rays_source_options& options) {
  check_hemicube(options.resolution, options.far_plane);  // before the tree is built
  auto own =
      std::make_unique<embree_scene>(geometry, false, options.widest ? embree_width::widest : embree_width::avx2);
  const embree_scene& shared = *own;
  return std::make_unique<rays_source>(std::move(own), shared, options);
}

std::unique_ptr<hemicube_source> make_rays_source(const ray_scene& rays, const rays_source_options& options) {
  return std::make_unique<rays_source>(nullptr, rays.embree(), options);
}

}  // namespace sightcell::bake
