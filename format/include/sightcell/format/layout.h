#pragma once
// The constants of the .pvs file, versions 1 and 0: magic, section ids, record sizes and limits. SPEC.md defines their
// meaning.
#include <array>
#include <cstdint>

namespace sightcell::format::layout {

// 89 "PVS" CR LF 1A LF: the first byte is not ASCII, and the line ends reveal a transfer that changed line endings.
inline constexpr std::array<std::uint8_t, 8> magic{0x89, 0x50, 0x56, 0x53, 0x0D, 0x0A, 0x1A, 0x0A};
inline constexpr std::uint32_t version = 1;  // version that the writer writes
// Oldest version that the reader reads. The module for pages is built without version 0, to be smaller.
#ifdef SIGHTCELL_WITHOUT_VERSION_0
inline constexpr std::uint32_t oldest_version = 1;
#else
inline constexpr std::uint32_t oldest_version = 0;
#endif
// Whether files whose sets are of clusters are read. The module for pages rejects them, to be smaller.
#ifdef SIGHTCELL_WITHOUT_CLUSTERS
inline constexpr bool reads_clusters = false;
#else
inline constexpr bool reads_clusters = true;
#endif

// Sizes of the fixed records, in bytes.
inline constexpr std::uint64_t header_size = 96;
inline constexpr std::uint64_t section_record_size = 32;
inline constexpr std::uint64_t cell_record_size = 24;
inline constexpr std::uint64_t chunk_record_size = 16;
// Numbers of columns of the packed tables.
inline constexpr std::uint32_t draw_columns = 13;
inline constexpr std::uint32_t certificate_columns = 8;
inline constexpr std::uint32_t volume_columns = 3;
inline constexpr std::uint32_t viewpoint_columns = 3;
// Sizes of further fixed records of version 0.
inline constexpr std::uint64_t v0_draw_record_size = 48;
inline constexpr std::uint64_t v0_row_record_size = 8;
inline constexpr std::uint64_t v0_certificate_record_size = 40;

// Offsets inside the header.
inline constexpr std::uint64_t header_version = 8;
inline constexpr std::uint64_t header_section_count = 12;
inline constexpr std::uint64_t header_total_size = 16;
inline constexpr std::uint64_t header_fingerprint = 24;
inline constexpr std::uint64_t header_polygon_count = 40;
inline constexpr std::uint64_t header_layout = 44;
inline constexpr std::uint64_t header_margin = 48;
inline constexpr std::uint64_t header_max_pixel_error = 52;
inline constexpr std::uint64_t header_confidence = 56;
inline constexpr std::uint64_t header_flags = 60;
inline constexpr std::uint64_t header_cell_count = 64;
inline constexpr std::uint64_t header_draw_count = 68;
inline constexpr std::uint64_t header_run_bound = 72;
inline constexpr std::uint64_t header_range_bound = 76;
inline constexpr std::uint64_t header_list_bound = 80;  // from version 1 on, reserved before; the next too
inline constexpr std::uint64_t header_slack = 84;
inline constexpr std::uint64_t header_table_checksum = 88;
inline constexpr std::uint64_t header_checksum = 92;

// header_flags
inline constexpr std::uint32_t flag_not_repeatable = 1;

// Section ids.
inline constexpr std::uint32_t section_draws = 1;
inline constexpr std::uint32_t section_cells = 2;
inline constexpr std::uint32_t section_rows = 3;
inline constexpr std::uint32_t section_row_directory = 4;
inline constexpr std::uint32_t section_certificate = 5;
inline constexpr std::uint32_t section_settings = 6;
inline constexpr std::uint32_t section_orders = 7;         // since version 1
inline constexpr std::uint32_t section_codes = 8;          // since version 1
inline constexpr std::uint32_t section_importance = 9;     // since version 1; optional
inline constexpr std::uint32_t section_volumes = 10;       // since version 1; a file with volumes requires it
inline constexpr std::uint32_t section_named_groups = 11;  // since version 1; optional
inline constexpr std::uint32_t section_viewpoints = 12;    // since version 1; optional
inline constexpr std::uint32_t section_eyes = 13;          // since version 1; optional, and open skips it
inline constexpr std::uint32_t section_borders = 14;       // since version 1; a file with smaller chunks requires it
inline constexpr std::uint32_t section_identity = 15;      // since version 1; optional, and open skips it
inline constexpr std::uint32_t section_clusters = 16;      // since version 1; a file with clusters requires it
inline constexpr std::uint32_t section_casters = 17;       // since version 1; optional, and open skips it
inline constexpr std::uint32_t section_residency = 18;     // since version 1; optional, and open skips it
inline constexpr std::uint32_t section_lights = 19;        // since version 1; optional, and open skips it

// Whether a section comes after all that a reader checks when it opens a file. It is checked when it is used, and may
// be kept elsewhere until then.
[[nodiscard]] constexpr bool is_bulk(std::uint32_t section) noexcept {
  return section == section_rows || section == section_importance || section == section_casters ||
         section == section_lights;
}

// Section flags.
inline constexpr std::uint32_t section_required = 1;

// The volumes section begins with two f64 and a u32.
inline constexpr std::uint64_t volumes_head_size = 20;

// The named groups section begins with two u32.
inline constexpr std::uint64_t named_groups_head_size = 8;

// The viewpoints section begins with an f32.
inline constexpr std::uint64_t viewpoints_head_size = 4;

// The identity section begins with four u32.
inline constexpr std::uint64_t identity_head_size = 16;

// The casters section begins with three u32, then has six f32 for each sun.
inline constexpr std::uint64_t casters_head_size = 12;
inline constexpr std::uint64_t sun_record_size = 24;

// The lights section begins with three u32, then has a u32 and eight f32 for each light.
inline constexpr std::uint64_t lights_head_size = 12;
inline constexpr std::uint64_t light_record_size = 36;

// The texture residency section begins with a u32 and two f32.
inline constexpr std::uint64_t residency_head_size = 12;

// The cells section of version 1 begins with one of these.
inline constexpr std::uint32_t cells_are_boxes = 0;
inline constexpr std::uint32_t cells_are_on_lattice = 1;
inline constexpr std::uint32_t cells_are_on_grid = 2;  // boxes of whole steps

// Limits. The reader and the writer reject a file beyond one of them with status::limit.
inline constexpr std::uint32_t max_polygons = 0xFFFFFFFEu;  // including the volumes
inline constexpr std::uint32_t max_volumes = 1u << 24;
inline constexpr std::uint32_t max_cells = 1u << 24;
inline constexpr std::uint32_t max_draws = 1u << 26;
inline constexpr std::uint32_t max_sections = 64;
inline constexpr std::uint64_t max_settings_size = 1u << 24;
inline constexpr std::uint64_t max_names_size = 1u << 24;       // all named groups together
inline constexpr std::uint32_t max_region_size = 1u << 16;      // bytes of the region of a cell
inline constexpr std::uint64_t max_regions_size = 0xFFFFFFFFu;  // of all cells together
inline constexpr std::uint64_t max_chunk_size = 0xFFFFFFFFu;
inline constexpr float max_margin = 1.0e6f;  // meters

inline constexpr std::uint32_t max_draw_name = 255;  // bytes of the name of a node or mesh

// Rows.
inline constexpr std::uint32_t cells_per_block = 64;     // consecutive cells, aligned; a chunk is all of them, or some
inline constexpr std::uint32_t max_reference_depth = 2;  // row -> reference -> reference

// Regions of viewpoints.
inline constexpr std::uint32_t max_region_depth = 18;  // of a leaf; the root has 0

// Clusters.
inline constexpr std::uint32_t max_cluster_polygons = 256;
inline constexpr std::uint32_t max_order_run = 64;  // polygons of a run of an order, in a file with clusters
// Shadow casters.
inline constexpr std::uint32_t max_suns = 64;
inline constexpr std::uint32_t max_caster_sets = 1u << 24;  // cells times suns

// Lights.
inline constexpr std::uint32_t max_lights = 1u << 16;
inline constexpr float widest_cone = 1.5708f;  // radians: a little above pi / 2

// Texture residency.
inline constexpr std::uint32_t cells_per_residency_chunk = 16;
inline constexpr std::uint32_t max_textures = 1u << 16;
inline constexpr std::uint32_t max_texture_side = 1u << 16;  // texels
inline constexpr float max_pixels_per_radian = 1048576.0f;   // 2^20
inline constexpr float max_anisotropy = 16.0f;

// Eyes.
inline constexpr std::uint32_t max_eyes = 8;               // of a cell
inline constexpr std::uint32_t eye_steps_per_side = 4096;  // of the box of the cell

}  // namespace sightcell::format::layout
