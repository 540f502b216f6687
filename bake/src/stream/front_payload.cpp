#include "stream/front_payload.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>

namespace sightcell::bake {
namespace {

constexpr std::uint32_t version = 1;
constexpr std::string_view magic = "SIGHTFRT";
enum draw_flag : std::uint32_t { host_moves = 1, in_every_cell = 2, in_no_cell = 4 };

struct bounds {
  std::array<double, 3> min, max;

  bounds() {
    min.fill(std::numeric_limits<double>::infinity());
    max.fill(-std::numeric_limits<double>::infinity());
  }
  void add(const glm::dvec3& p) {
    for (int k = 0; k < 3; ++k) {
      if (!std::isfinite(static_cast<float>(p[k]))) continue;
      const auto axis = static_cast<std::size_t>(k);
      min[axis] = std::min(min[axis], p[k]), max[axis] = std::max(max[axis], p[k]);
    }
  }
  void add(const bounds& other) {
    for (std::size_t k = 0; k < 3; ++k)
      min[k] = std::min(min[k], other.min[k]), max[k] = std::max(max[k], other.max[k]);
  }
};

bounds bounds_of(const scene::draw& d, const scene::streamed_geometry& g) {
  bounds out;
  if (g.polygon_count == 0) return out;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1u ? g.max.x : g.min.x, corner & 2u ? g.max.y : g.min.y,
                       corner & 4u ? g.max.z : g.min.z);
    out.add(glm::dvec3(d.to_world * glm::dvec4(p, 1.0)));
  }
  return out;
}

// Returns 0 for what no float is: polygons of a draw that is so far away are in no cell.
float finite_float(double value) {
  const auto out = static_cast<float>(value);
  return std::isfinite(out) ? out : 0.0f;
}

template <class List, class Get>
void put_varint_column(payload& out, const List& list, const Get& get) {
  for (const auto& item : list) out.put_varint(get(item));
}

template <class List, class Get>
void put_delta_column(payload& out, const List& list, const Get& get) {
  std::vector<std::uint32_t> column;
  for (const auto& item : list) column.push_back(get(item));
  out.put_deltas(column);
}

template <class List, class Get>
void put_float_column(payload& out, const List& list, const Get& get) {
  std::vector<float> column;
  for (const auto& item : list) column.push_back(finite_float(static_cast<double>(get(item))));
  out.put_floats(column);
}

class front_writer {
 public:
  explicit front_writer(const front_content& content)
      : content_(content), scene_(content.pager.content()), geometry_of_(content.pager.geometry_of_draw()) {
    of_geometry_.resize(content.pager.geometries().size());
    draws_of_.resize(of_geometry_.size());
    for (std::uint32_t i = 0; i < scene_.draws.size(); ++i) {
      draws_of_[geometry_of_[i]].push_back(i);
      of_geometry_[geometry_of_[i]].add(bounds_of(scene_.draws[i], content.pager.geometries()[geometry_of_[i]]));
    }
    for (const bounds& b : of_geometry_) whole_.add(b);
    if (whole_.min[0] > whole_.max[0]) whole_.min.fill(0.0), whole_.max.fill(0.0);
  }

  payload write() {
    put_head();
    put_geometries();
    put_draws();
    put_pages();
    put_images();
    put_chunks();
    put_everywhere();
    return std::move(out_);
  }

 private:
  void put_head() {
    std::uint32_t cells = 0;
    std::size_t image_files = 0;
    for (const listed_chunk& chunk : content_.chunks) cells += chunk.cells;
    for (const std::vector<listed_image>& files : content_.images) image_files += files.size();
    const std::string& json = content_.pager.materials();
    out_.put_bytes(scene_.fingerprint);
    for (const std::size_t count : {std::size_t{scene_.polygon_count}, of_geometry_.size(), scene_.draws.size(),
                                    content_.pages.size(), std::size_t{content_.pager.image_count()}, image_files,
                                    content_.chunks.size(), std::size_t{cells}, json.size()})
      out_.put_varint(static_cast<std::uint32_t>(count));
    std::array<float, 6> box;
    for (std::size_t k = 0; k < 3; ++k) {
      box[k] = finite_float(whole_.min[k]);
      box[3 + k] = finite_float(whole_.max[k]);
    }
    out_.put_floats(box);
    out_.put_bytes({reinterpret_cast<const std::uint8_t*>(json.data()), json.size()});
  }

  void put_geometries() {
    put_varint_column(out_, content_.pager.geometries(), [](const auto& g) { return g.polygon_count; });
  }

  static std::uint32_t flags_of(const scene::draw& d) {
    return (d.moves ? host_moves : 0u) | (is_in_every_cell(d) ? in_every_cell : 0u) | (d.tags.never ? in_no_cell : 0u);
  }

  void put_draws() {
    const std::vector<scene::draw>& list = scene_.draws;
    out_.put_deltas(geometry_of_);
    put_varint_column(out_, list, [](const auto& d) { return d.material + 1; });
    put_varint_column(out_, list, flags_of);
    put_varint_column(out_, list, [](const auto& d) { return d.lod_object + 1; });
    put_varint_column(out_, list, [](const auto& d) { return d.lod_level; });
    put_delta_column(out_, list, [](const auto& d) { return d.node; });
    put_delta_column(out_, list, [](const auto& d) { return d.mesh; });
    put_delta_column(out_, list, [](const auto& d) { return d.instance; });
    put_varint_column(out_, list, [](const auto& d) { return d.primitive; });
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 3; ++r) put_float_column(out_, list, [c, r](const auto& d) { return d.to_world[c][r]; });
  }

  // Returns a coordinate in steps of 1/255 of the box of the scene, rounded outward.
  std::uint8_t step_of(double value, std::size_t axis, bool up) const {
    const double size = whole_.max[axis] - whole_.min[axis];
    if (!(size > 0.0)) return up ? 255 : 0;
    const double step = (value - whole_.min[axis]) / size * 255.0;
    return static_cast<std::uint8_t>(std::clamp(up ? std::ceil(step) : std::floor(step), 0.0, 255.0));
  }

  void put_pages() {
    put_files(content_.pages);
    std::vector<bounds> boxes;
    for (const std::vector<scene::page_part>& page : content_.plan.pages) {
      bounds& box = boxes.emplace_back();
      for (const scene::page_part& part : page) box.add(of_part(part));
    }
    std::vector<std::uint8_t> column(boxes.size());
    for (const bool up : {false, true})
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < boxes.size(); ++i)
          column[i] = step_of((up ? boxes[i].max : boxes[i].min)[axis], axis, up);
        out_.put_bytes(column);
      }
  }

  // Returns the box of the polygons in all draws. That of a geometry with one draw is of these polygons alone.
  bounds of_part(const scene::page_part& part) const {
    const std::vector<std::uint32_t>& draws = draws_of_[part.geometry];
    if (draws.size() != 1) return of_geometry_[part.geometry];
    const scene::draw& d = scene_.draws[draws.front()];
    const scene::geometry& g = scene_.geometries[d.geometry];
    bounds out;
    for (const std::uint32_t polygon : part.polygons)
      for (std::size_t k = 0; k < 3; ++k)
        out.add(
            glm::dvec3(d.to_world * glm::dvec4(glm::dvec3(g.positions[g.indices[3 * std::size_t{polygon} + k]]), 1.0)));
    return out;
  }

  void put_images() {
    std::vector<std::uint32_t> counts(content_.pager.image_count());
    std::vector<listed_image> all;
    for (std::size_t i = 0; i < content_.images.size(); ++i) {
      counts[content_.pager.images()[i].number] = static_cast<std::uint32_t>(content_.images[i].size());
      all.insert(all.end(), content_.images[i].begin(), content_.images[i].end());
    }
    out_.put_varints(counts);
    put_varint_column(out_, all, [](const auto& i) { return i.width; });
    put_varint_column(out_, all, [](const auto& i) { return i.height; });
    put_varint_column(out_, all, [](const auto& i) { return i.file.bytes; });
    for (const listed_image& image : all) out_.put_bytes(std::array{static_cast<std::uint8_t>(image.type)});
    for (const listed_image& image : all) out_.put_bytes(image.file.name);
  }

  void put_chunks() {
    put_varint_column(out_, content_.chunks, [](const auto& c) { return c.file.bytes; });
    put_varint_column(out_, content_.chunks, [](const auto& c) { return c.cells; });
    for (const listed_chunk& chunk : content_.chunks) out_.put_bytes(chunk.file.name);
    for (std::size_t k = 0; k < 3; ++k)
      put_float_column(out_, content_.chunks, [k](const auto& c) { return c.box.min[k]; });
    for (std::size_t k = 0; k < 3; ++k)
      put_float_column(out_, content_.chunks, [k](const auto& c) { return c.box.max[k]; });
  }

  // What every cell needs.
  void put_everywhere() {
    std::set<std::uint32_t> images;
    for (const scene::draw& d : scene_.draws)
      if (is_in_every_cell(d))
        for (const std::uint32_t image : content_.pager.images_of(d.material)) images.insert(image);
    const std::vector<std::uint32_t> ascending(images.begin(), images.end());
    for (const std::vector<std::uint32_t>* list : {&content_.plan.always, &ascending}) {
      out_.put_varint(static_cast<std::uint32_t>(list->size()));
      out_.put_gaps(*list);
    }
  }

  void put_files(const std::vector<listed_file>& files) {
    put_varint_column(out_, files, [](const auto& f) { return f.bytes; });
    for (const listed_file& file : files) out_.put_bytes(file.name);
  }

  const front_content& content_;
  const scene::scene& scene_;
  const std::vector<std::uint32_t>& geometry_of_;
  std::vector<bounds> of_geometry_;
  std::vector<std::vector<std::uint32_t>> draws_of_;  // by geometry
  bounds whole_;
  payload out_;
};

}  // namespace

std::vector<std::byte> front_file(const front_content& content) {
  const payload inner = front_writer(content).write();
  payload file;
  file.put_bytes({reinterpret_cast<const std::uint8_t*>(magic.data()), magic.size()});
  file.put_u32(version);
  file.put_u32(static_cast<std::uint32_t>(inner.bytes().size()));
  file.put_bytes(deflated(inner.bytes()));
  const auto* const bytes = reinterpret_cast<const std::byte*>(file.bytes().data());
  return {bytes, bytes + file.bytes().size()};
}

}  // namespace sightcell::bake
