#pragma once
// The cell set while it grows: which polygons were seen, and for each its witness, an eye that sees much of it.
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
  // duplicates: whoever joins brings the others of its class with it; null: nobody. Must outlive the set. Of polygons
  // from own_polygons on, which are of another scene (two_scenes.h), all is known: the set contains them, and they are
  // no members.
  explicit cell_set(std::uint32_t polygon_count, const duplicate_classes* duplicates = nullptr,
                    std::uint32_t own_polygons = 0xFFFFFFFFu, std::uint32_t volume_count = 0)
      : entries_(polygon_count), duplicates_(duplicates), volumes_(volume_count) {
    for (std::size_t i = own_polygons; i < entries_.size(); ++i) entries_[i].pixels = 0xFFFFFFFFu;
  }

  // What an empty set of so many polygons takes, without volumes.
  static constexpr std::size_t bytes_for(std::size_t polygon_count) { return polygon_count * sizeof(entry); }

  // Forgets everything; storage stays.
  void clear();

  bool contains(std::uint32_t polygon) const { return entries_[polygon].pixels != 0; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(members_.size()); }
  // In the order in which they joined.
  const std::vector<std::uint32_t>& members() const { return members_; }
  const glm::vec3& witness(std::uint32_t polygon) const { return eyes_[entries_[polygon].eye]; }

  // All that a hemicube saw joins; a polygon's witness is the sample that saw most pixels of it.
  void add_view(const glm::vec3& eye, const std::vector<seen_polygon>& seen);
  // A ray from eye saw the polygon: true if it is new. Later views with more pixels take over as witness.
  bool add(std::uint32_t polygon, const glm::vec3& eye);

  std::vector<std::uint32_t> sorted() const;

  // Those that are seen; all else here is of polygons.
  volume_set& volumes() { return volumes_; }
  const volume_set& volumes() const { return volumes_; }

  // Set and witnesses to and from a record. What is loaded is what was saved: the members in ascending order, and
  // record.witnesses as eyes(), of which later views with more pixels take over.
  void save(cell_record& record) const;
  void load(const cell_record& record);
  // Places in the cell from where something was seen.
  const std::vector<glm::vec3>& eyes() const { return eyes_; }

 private:
  struct entry {
    std::uint32_t pixels = 0;  // 0: not a member
    std::uint32_t eye = 0;     // into eyes_
  };
  void join(std::uint32_t polygon, const entry& as);

  std::vector<entry> entries_;
  const duplicate_classes* duplicates_;
  std::vector<std::uint32_t> members_;
  std::vector<glm::vec3> eyes_;
  volume_set volumes_;
};

}  // namespace sightcell::bake
