#pragma once
// A cell set while it grows: the polygons that were found visible, and for each its witness, a viewpoint from which
// much of it is visible.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "cell_set/cell_record.h"
#include "hemicube/hemicube_source.h"
#include "trace/duplicates.h"
#include "volumes/volume_set.h"

namespace sightcell::bake {

class cell_set {
 public:
  // Makes an empty set.
  // duplicates: a polygon that joins brings the others of its class with it; null: none. Must outlive the set.
  // own_polygons: polygons from this id on belong to the scene that only occludes (two_scenes.h). They count as known:
  //   the set contains them, and they are no members.
  explicit cell_set(std::uint32_t polygon_count, const duplicate_classes* duplicates = nullptr,
                    std::uint32_t own_polygons = 0xFFFFFFFFu, std::uint32_t volume_count = 0)
      : entries_(polygon_count), duplicates_(duplicates), volumes_(volume_count) {
    for (std::size_t i = own_polygons; i < entries_.size(); ++i) entries_[i].pixels = 0xFFFFFFFFu;
  }

  // Returns the memory of an empty set in bytes, without volumes.
  static constexpr std::size_t bytes_for(std::size_t polygon_count) { return polygon_count * sizeof(entry); }

  // Removes all members; storage is kept.
  void clear();

  bool contains(std::uint32_t polygon) const { return entries_[polygon].pixels != 0; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(members_.size()); }
  // In the order of joining.
  const std::vector<std::uint32_t>& members() const { return members_; }
  // Returns the viewpoint from which a member was found visible.
  const glm::vec3& witness(std::uint32_t polygon) const { return eyes_[entries_[polygon].eye]; }

  // Adds all polygons that are visible in the next hemicube of the cell. The witness of a polygon is the hemicube with
  // the most pixels of it.
  void add_view(const glm::vec3& eye, const std::vector<seen_polygon>& seen);
  // Adds a polygon that a ray from eye hit. Returns whether it is new. A later hemicube with more than one pixel of it
  // replaces the witness.
  bool add(std::uint32_t polygon, const glm::vec3& eye);

  // Adds members of a record that the set lacks, with their witnesses, each of which becomes one of eyes().
  // keep: for each polygon of record.set 1 if it joins.
  void add_members(const cell_record& record, const std::vector<std::uint8_t>& keep);

  // Polygons that join from now on are counted for this way of finding them.
  void find_by(found_by how) { how_ = how; }
  found_by how() const { return how_; }

  // Returns the members, ascending.
  std::vector<std::uint32_t> sorted() const;

  // The visible volumes. All other functions are about polygons.
  volume_set& volumes() { return volumes_; }
  const volume_set& volumes() const { return volumes_; }

  // Writes set and witnesses to a record, and reads them back. After load() the members are in ascending order,
  // eyes() is record.witnesses, and the next hemicube has the number record.samples + 1. Later hemicubes with more
  // pixels replace witnesses.
  void save(cell_record& record) const;
  void load(const cell_record& record);
  // Viewpoints in the cell from which something was found visible.
  const std::vector<glm::vec3>& eyes() const { return eyes_; }

 private:
  struct entry {
    std::uint32_t pixels = 0;  // of the witness; 0: not a member
    std::uint32_t eye = 0;     // into eyes_
  };
  // Returns how many polygons joined: this one and its duplicates.
  std::uint32_t join(std::uint32_t polygon, const entry& as);

  std::vector<entry> entries_;
  const duplicate_classes* duplicates_;
  std::vector<std::uint32_t> members_;
  std::vector<glm::vec3> eyes_;
  volume_set volumes_;
  find_counts found_{};
  growth_counts growth_{};
  std::uint32_t hemicubes_ = 0;  // of the cell so far
  found_by how_ = found_by::sampler;
};

// Counts the polygons that join during its life for one way of finding them.
class finding {
 public:
  // set must outlive the object.
  finding(cell_set& set, found_by how) : set_(set), before_(set.how()) { set.find_by(how); }
  ~finding() { set_.find_by(before_); }
  finding(const finding&) = delete;
  finding& operator=(const finding&) = delete;

 private:
  cell_set& set_;
  found_by before_;
};

}  // namespace sightcell::bake
