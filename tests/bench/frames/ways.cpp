#include "bench/frames/ways.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

namespace sightcell::bench {
namespace {

const void* byte_offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // as OpenGL wants it
}

const void* polygon_offset(std::size_t polygon) {
  return byte_offset(3 * sizeof(std::uint32_t) * polygon);
}

void require(bool ok, const char* what) {
  if (!ok) throw std::runtime_error(what);
}

// ---- everything ----

class full_way final : public way {
 public:
  full_way(const baked_world& world, const stage& on) : world_(world) {
    std::vector<std::uint32_t> stored(world.polygons());
    std::iota(stored.begin(), stored.end(), 0u);
    for (const surface_group& g : world.groups) {  // as the source has them
      const auto first = stored.begin() + std::ptrdiff_t{g.first};
      std::sort(first, first + std::ptrdiff_t{g.count}, [&](std::uint32_t a, std::uint32_t b) {
        return world.source_of_stored[a] < world.source_of_stored[b];
      });
    }
    on.upload_polygons(stored, indices_);
    polygons = world.polygons();
  }

  void cull(const frame_camera&) override {}

  void issue(stage& on) override {
    on.use_indices(indices_);
    draws = 0;
    for (const std::uint32_t g : world_.draw_order) {
      const surface_group& group = world_.groups[g];
      if (group.count == 0) continue;
      on.use_group(g);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * group.count), GL_UNSIGNED_INT, polygon_offset(group.first));
      ++draws;
    }
    calls = draws;
  }

 private:
  const baked_world& world_;
  gl_buffer indices_;
};

// ---- clusters in the frustum ----

// Pieces of an index buffer, group by group, as glMultiDrawElements takes them.
struct pieces {
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_group;  // begin, end

  void clear(std::size_t groups) {
    counts.clear();
    offsets.clear();
    of_group.assign(groups, {0, 0});
  }

  // Clusters one behind the other are one piece. begin: of each cluster's polygons, and the end of the last.
  std::uint64_t add(std::uint32_t group, std::span<const std::uint8_t> visible, const std::uint32_t* begin) {
    std::uint64_t polygons = 0;
    of_group[group].first = static_cast<std::uint32_t>(counts.size());
    for (std::size_t i = 0; i < visible.size(); ++i) {
      if (visible[i] == 0) continue;
      const std::size_t from = i;
      while (i + 1 < visible.size() && visible[i + 1] != 0) ++i;
      counts.push_back(static_cast<GLsizei>(3 * (begin[i + 1] - begin[from])));
      offsets.push_back(polygon_offset(begin[from]));
      polygons += begin[i + 1] - begin[from];
    }
    of_group[group].second = static_cast<std::uint32_t>(counts.size());
    return polygons;
  }
};

std::uint64_t issue_pieces(stage& on, const baked_world& world, const pieces& list) {
  std::uint64_t calls = 0;
  for (const std::uint32_t g : world.draw_order) {
    const auto [begin, end] = list.of_group[g];
    if (begin == end) continue;
    on.use_group(g);
    glMultiDrawElements(GL_TRIANGLES, &list.counts[begin], GL_UNSIGNED_INT, &list.offsets[begin],
                        static_cast<GLsizei>(end - begin));
    ++calls;
  }
  return calls;
}

class frustum_way final : public way {
 public:
  frustum_way(const baked_world& world, const stage& on, std::uint32_t most) : world_(world), clusters_(world, most) {
    on.upload_polygons(clusters_.stored, indices_);
  }

  void cull(const frame_camera& camera) override {
    clusters_.boxes.find_visible(camera.seen, visible_);
    list_.clear(world_.groups.size());
    polygons = 0;
    for (std::uint32_t g = 0; g < world_.groups.size(); ++g) {
      const std::uint32_t first = clusters_.group_begin[g], end = clusters_.group_begin[g + 1];
      polygons += list_.add(g, std::span(visible_).subspan(first, end - first), &clusters_.begin[first]);
    }
    draws = list_.counts.size();
  }

  void issue(stage& on) override {
    on.use_indices(indices_);
    calls = issue_pieces(on, world_, list_);
  }

 private:
  const baked_world& world_;
  cluster_set clusters_;
  gl_buffer indices_;
  std::vector<std::uint8_t> visible_;
  pieces list_;
};

// ---- cell sets ----

class set_way : public way {
 public:
  void cull(const frame_camera& camera) override {
    sightcell_frame frame{};
    const std::array<float, 3> eye{camera.eye.x, camera.eye.y, camera.eye.z};
    require(view_.move(eye, frame) == SIGHTCELL_OK, "a move failed");
    changed = (frame.flags & SIGHTCELL_FRAME_CHANGED) != 0;
    flags = frame.flags;
    cell = frame.cell;
    if (changed) follow(frame);
    cull_set(camera);
  }

 protected:
  explicit set_way(const baked_world& world) : world_(world) {
    auto made = sightcell::view::create(world.db);
    require(static_cast<bool>(made), "a view cannot be made");
    view_ = std::move(*made);
  }
  virtual void follow(const sightcell_frame& frame) = 0;
  virtual void cull_set(const frame_camera&) {}

  const baked_world& world_;
  sightcell::view view_;
};

class commands_way final : public set_way {
 public:
  commands_way(const baked_world& world, const stage& on) : set_way(world), commands_(world.info.range_bound) {
    std::vector<std::uint32_t> stored(world.polygons());
    std::iota(stored.begin(), stored.end(), 0u);
    on.upload_polygons(stored, indices_);
  }

  void issue(stage& on) override {
    on.use_indices(indices_);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, buffer_.id());
    calls = 0;
    for (const std::uint32_t g : world_.draw_order) {
      const auto [begin, end] = of_group_[g];
      if (begin == end) continue;
      on.use_group(g);
      glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, byte_offset(sizeof(sightcell_command) * begin),
                                  static_cast<GLsizei>(end - begin), sizeof(sightcell_command));
      ++calls;
    }
  }

 private:
  void follow(const sightcell_frame& frame) override {
    const list_result got = view_.commands(0, commands_);
    require(static_cast<bool>(got), "commands failed");
    of_group_.assign(world_.groups.size(), {0, 0});
    for (std::uint32_t i = 0; i < got.count; ++i) {
      auto& [begin, end] = of_group_[commands_[i].first_instance];
      if (begin == end) begin = i;
      end = i + 1;
      commands_[i].first_instance = 0;  // instances have no data here
    }
    buffer_.upload(std::span<const sightcell_command>(commands_).first(got.count), GL_STREAM_DRAW);
    draws = got.count;
    polygons = frame.polygon_count;
  }

  std::vector<sightcell_command> commands_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_group_;
  gl_buffer indices_, buffer_;
};

class indices_way final : public set_way {
 public:
  explicit indices_way(const baked_world& world) : set_way(world), ranges_(world.info.range_bound) {}

  void issue(stage& on) override {
    on.use_indices(list_);
    draws = 0;
    for (const std::uint32_t g : world_.draw_order) {
      const auto [begin, end] = of_group_[g];
      if (begin == end) continue;
      on.use_group(g);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * (end - begin)), GL_UNSIGNED_INT, polygon_offset(begin));
      ++draws;
    }
    calls = draws;
  }

 private:
  void follow(const sightcell_frame& frame) override {
    const std::size_t words = 3 * std::size_t{frame.polygon_count};
    if (std::uint32_t* const memory = list_.map(std::max<std::size_t>(words, 1))) {
      require(static_cast<bool>(view_.indices(world_.stored_corners, {memory, words})), "an index list failed");
      list_.unmap();
    }
    const list_result got = view_.ranges(ranges_);
    require(static_cast<bool>(got), "ranges failed");
    of_group_.assign(world_.groups.size(), {0, 0});
    std::uint32_t at = 0;
    for (const sightcell_range& r : std::span(ranges_).first(got.count)) {
      auto& [begin, end] = of_group_[r.draw];
      if (begin == end) begin = at;
      at += r.count;
      end = at;
    }
    polygons = frame.polygon_count;
  }

  std::vector<sightcell_range> ranges_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_group_;
  gl_buffer list_;
};

class culled_set_way final : public set_way {
 public:
  culled_set_way(const baked_world& world, std::uint32_t most)
      : set_way(world), clusters_(world, most), ranges_(world.info.range_bound), counts_(clusters_.count() + 1) {
    cluster_of_.resize(world.polygons());
    for (std::uint32_t c = 0; c < clusters_.count(); ++c) {
      for (std::uint32_t i = clusters_.begin[c]; i < clusters_.begin[c + 1]; ++i) cluster_of_[clusters_.stored[i]] = c;
    }
  }

  void issue(stage& on) override {
    on.use_indices(list_);
    calls = issue_pieces(on, world_, pieces_);
  }

 private:
  // Counts the set's polygons by cluster, then copies their indices there: in one list, cluster by cluster.
  void follow(const sightcell_frame& frame) override {
    const list_result got = view_.ranges(ranges_);
    require(static_cast<bool>(got), "ranges failed");
    const auto each = [&](const auto& work) {
      for (const sightcell_range& r : std::span(ranges_).first(got.count)) {
        const std::uint32_t first = world_.groups[r.draw].first + r.first;
        for (std::uint32_t p = first; p < first + r.count; ++p) work(p);
      }
    };
    std::fill(counts_.begin(), counts_.end(), 0u);
    each([&](std::uint32_t p) { ++counts_[cluster_of_[p]]; });
    keep_seen_clusters();
    indices_.resize(3 * std::size_t{frame.polygon_count});
    each([&](std::uint32_t p) {
      std::memcpy(&indices_[3 * std::size_t{counts_[cluster_of_[p]]++}], &world_.stored_corners[3 * std::size_t{p}],
                  3 * sizeof(std::uint32_t));
    });
    list_.upload(std::span<const std::uint32_t>(indices_), GL_STREAM_DRAW);
  }

  // Boxes and places of the clusters that have polygons of the set; counts_ become places.
  void keep_seen_clusters() {
    boxes_.clear();
    begin_.clear();
    group_begin_.clear();
    std::uint32_t at = 0;
    for (std::uint32_t g = 0; g < world_.groups.size(); ++g) {
      group_begin_.push_back(static_cast<std::uint32_t>(begin_.size()));
      for (std::uint32_t c = clusters_.group_begin[g]; c < clusters_.group_begin[g + 1]; ++c) {
        if (counts_[c] == 0) continue;
        boxes_.add(clusters_.boxes, c);
        begin_.push_back(at);
        at += std::exchange(counts_[c], at);
      }
    }
    group_begin_.push_back(static_cast<std::uint32_t>(begin_.size()));
    begin_.push_back(at);
  }

  void cull_set(const frame_camera& camera) override {
    boxes_.find_visible(camera.seen, visible_);
    pieces_.clear(world_.groups.size());
    polygons = 0;
    for (std::uint32_t g = 0; g < world_.groups.size(); ++g) {
      const std::uint32_t first = group_begin_[g], end = group_begin_[g + 1];
      polygons += pieces_.add(g, std::span(visible_).subspan(first, end - first), &begin_[first]);
    }
    draws = pieces_.counts.size();
  }

  cluster_set clusters_;
  std::vector<std::uint32_t> cluster_of_;  // by stored polygon
  std::vector<sightcell_range> ranges_;
  std::vector<std::uint32_t> counts_, indices_, begin_, group_begin_;
  box_lanes boxes_;
  std::vector<std::uint8_t> visible_;
  pieces pieces_;
  gl_buffer list_;
};

}  // namespace

std::vector<named_way> make_ways(const baked_world& world, const stage& on, const cluster_sizes& sizes) {
  std::vector<named_way> ways;
  ways.push_back({"full", std::make_unique<full_way>(world, on)});
  ways.push_back({"frustum", std::make_unique<frustum_way>(world, on, sizes.frustum)});
  ways.push_back({"pvs_commands", std::make_unique<commands_way>(world, on)});
  ways.push_back({"pvs_indices", std::make_unique<indices_way>(world)});
  ways.push_back({"pvs_frustum", std::make_unique<culled_set_way>(world, sizes.sets)});
  return ways;
}

}  // namespace sightcell::bench
