#pragma once
// Every knob of a bake once: name, unit, default, range. The command line, its help, the checkpoint's key and the
// settings text in the file are made from this struct.
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/bake/file_settings.h"
#include "sightcell/bake/safety_ring.h"
#include "sightcell/scene/animated_as.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h, for who loads glTF
}  // namespace sightcell::scene

namespace sightcell::bake {

// A view cell given by hand: metres, min below max on every axis.
struct cell_box {
  std::string name;  // for people; may be empty
  std::array<float, 3> min{}, max{};
};

// What the error of a cell is: the share of its rays that count as a miss, of which an upper bound is proved.
enum class metric_kind : std::uint8_t {
  pixel,  // a ray from a free place in any direction is wrong
  view,   // the same where pictures look, and what is missing is not too small for a picture
  color   // by how much a ray's color differs, in the mean
};
inline constexpr std::array<std::string_view, 3> metric_names{"pixel", "view", "color"};

struct metric_settings {
  metric_kind kind = metric_kind::pixel;  // --metric
  // --- of view alone: the pictures of the host
  std::uint32_t view_width = 1920, view_height = 1080;  // --view-resolution WxH, pixels, 16..65536
  double view_fov = 60.0;                               // --view-fov, of the whole height, degrees, 1..170
  // --view-pitch MIN,MAX: how far the camera looks up or down, degrees, -90..90; it does not roll
  std::array<double, 2> view_pitch{-90.0, 90.0};
  // --view-least, 0..1e6: what covers less than this part of the pixel in the picture's middle does not count
  double view_least = 0.25;
};

// Throws sightcell::error (wrong_use) naming the option when a value is out of its range.
void validate_metric(const metric_settings& s);

struct settings {
  // --scene, which scene of a glTF file; -1: the file's default. bake() takes the scene it is given: this is written
  // into the file, so that verify can load the same one.
  std::int32_t scene = -1;

  // --- cells
  std::optional<std::filesystem::path> cells_file;  // --cells-file: explicit boxes
  std::vector<cell_box> cells;                      // the host's own boxes; of these three, one at most
  std::optional<std::array<float, 6>> cells_grid;   // --cells-grid x0,y0,z0,x1,y1,z1: every lattice cell of this box
  float cell_size = 4.0f;                           // --cell-size, metres, 0.25..1000; cells are half as high
  std::uint32_t cell_limit = 0;                     // --cell-limit, bake only so many, spread evenly; 0: all
  float margin = 0.25f;                             // --margin, metres, 0..10: boxes are grown by it for the bake
  float player_radius = 0.05f;                      // --player-radius, metres, 0.001..1: eyes keep off surfaces by it
  // --cells-from: cells are those of this scene, which stands in the same world, is seen, hides, and is in no set; of
  // the scene that is baked (--polygons-from) come the polygons. Null: cells and polygons are of one scene. Outlives
  // the bake.
  const scene::scene* cells_from = nullptr;

  // --- sampling
  // --sampler, by name. What these settings mean, their ranges and which samplers have them: sampler_options.h.
  std::string sampler = "guided";
  std::uint32_t samples = 24;               // --samples, hemicubes per cell
  double seconds_per_cell = 0.0;            // --seconds-per-cell, 0: no limit
  double interior_share = 0.5;              // --interior-share
  bool jitter = false;                      // --jitter
  double reliability = 0.995;               // --reliability
  std::uint32_t start_grid = 0;             // --start-grid, 0: by the number of samples
  double difference = 0.0;                  // --difference
  std::uint32_t part_polygons = 0;          // --part-polygons, 0: a cell is never cut
  std::uint64_t sampling_rays = 1'000'000;  // --sampling-rays, rays per cell
  std::uint32_t rays_per_round = 65536;     // --rays-per-round
  std::uint32_t fewest_new = 0;             // --fewest-new, 0: until the rays are spent
  std::uint32_t border_depth = 3;           // --border-depth
  std::uint32_t border_samples = 6;         // --border-samples
  double border_offset = 1e-3;              // --border-offset, of the distance
  double filter = 0.0;                      // --filter, metres
  // --source, of hemicubes: gpu (OpenGL), cpu (our rasteriser), rays (Embree, slow) or auto: gpu where there is a
  // hardware one, else cpu. Sources differ in a few pixels: which one it was stands in the file.
  std::string source = "auto";
  std::uint32_t resolution = 512;  // --resolution, pixels along a hemicube face, even, 16..4096
  // --time-budget, of guided: seconds on the clock for the whole bake, spent where the bound is largest, down to
  // max_pixel_error; 0: none. What is found then depends on the machine.
  double time_budget = 0.0;
  double max_pixel_error = 1e-3;  // --max-pixel-error, 0 or 1e-7..0.5; 0: no rays, the sampler alone
  metric_settings metric = {};    // of what error that is the bound; a host's scene has no colors for color
  std::uint64_t seed = 1;         // --seed

  // --- seeing
  bool all_double_sided = false;  // --all-double-sided
  float smallest_gap = 0.002f;    // --smallest-gap, metres, 0..0.1: narrower cracks let nothing through; 0: all do
  // --animated: what animations or skins move and no mark speaks for.
  scene::animated_as animated = scene::animated_as::always;
  // --safety-ring none|edge|vertex: what shares an edge or a vertex with a polygon of a finished set joins it unseen.
  bake::safety_ring safety_ring = bake::safety_ring::none;

  // --misses: polygons that a host found missing, {"misses":[{"eye":[x,y,z],"polygon":1234}]}. In the cells that such
  // an eye can be in they join the set where a ray sees them.
  std::optional<std::filesystem::path> misses_file;

  // --volumes, metres, 0 or 0.25..1000: boxes this wide are told from each other where things that move may be, and for
  // each cell which of them can be seen; 0: none. Takes rays: not with a max_pixel_error of 0.
  double volumes = 0.0;

  file_settings file;  // --profile, --order, --layout

  // --- running; none of these changes a byte of the file
  std::uint32_t threads = 0;  // --threads, 0: all
  // Of the time budget, what was spent before bake() is called: on loading.
  double time_spent = 0.0;
  // --scratch: a folder on a local disk where the unfinished bake is kept; a copy is left beside the output when the
  // bake ends early, and every few minutes. Empty: it is kept beside the output.
  std::filesystem::path scratch;
  // --memory, bytes of resident memory that the process keeps under, 0: no limit. Refused before anything of the scene
  // is built where that alone takes more; else fewer cells are in work at once. Includes what the host has.
  std::uint64_t memory = 0;
};

// Throws sightcell::error (wrong_use) naming the option when a value is out of its range.
void validate(const settings& s);

// One line of JSON with every setting that can change a byte of the file, in fixed order. Part of the checkpoint's key,
// and stored in the file.
std::string describe(const settings& s);

}  // namespace sightcell::bake
