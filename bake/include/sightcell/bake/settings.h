#pragma once
// What a bake computes: each option once, with its unit, range and default. The command line, its help, the key of the
// checkpoint and the settings text in the file are made from this struct. bake.h has the conventions; ranges are
// inclusive, and validate() checks them.
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
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// ---- View cells -----------------------------------------------------------------------------------------------------

// An explicit view cell. min < max on each axis.
struct cell_box {
  std::string name;            // for messages; may be empty
  std::array<float, 3> min{};  // meters
  std::array<float, 3> max{};  // meters
};

// ---- Player ---------------------------------------------------------------------------------------------------------

// Where automatic cells are.
enum class reach_kind : std::uint8_t {
  walk,        // over floors that a player gets to from the starts
  everywhere,  // over all floors with head room, roofs included
  none         // over none: only where settings::fly and the paths are
};
inline constexpr std::array<std::string_view, 3> reach_names{"walk", "everywhere", "none"};  // as --reach calls them

// Where a camera was, as points in meters; straight between them. One point or more, within 1e7 m of the origin.
using camera_path = std::vector<std::array<float, 3>>;

// How a player moves and where the eyes are, in meters. The default is a person.
struct player_settings {
  float height = 1.8f;       // --player-height: what must be empty above a floor, 0.1 .. 100
  float step = 0.45f;        // --player-step: steps that are climbed without a jump, 0 .. 100
  float jump = 1.2f;         // --player-jump: up with a jump, 0 .. 100
  float gap = 3.0f;          // --player-gap: the widest gap that a jump crosses, 0 .. 100
  float slope = 45.0f;       // --player-slope: the steepest floor to stand on, degrees, 0 .. 89
  float lowest_eye = 0.9f;   // --eye-heights LOW,HIGH: above the floor, when crouching, 0 .. 100
  float highest_eye = 2.1f;  // --eye-heights LOW,HIGH: when jumping, 0 .. 100
};

// ---- Sun ------------------------------------------------------------------------------------------------------------

// A sun whose shadows a host draws: one direction, or the way from one to another that the sun moves along. Degrees:
// azimuth, clockwise from north (-z) as seen from above, then elevation above the horizon.
struct sun_setting {
  std::array<double, 2> from{};  // azimuth -360 .. 360, elevation -90 .. 90
  std::array<double, 2> to{};    // equal to from where the sun does not move; at most 90 degrees from there
};
inline constexpr std::size_t most_suns = 64;  // of one bake

// ---- Metric ---------------------------------------------------------------------------------------------------------

// What the error of a cell is, and so what its upper bound bounds.
enum class metric_kind : std::uint8_t {
  pixel,  // miss probability: rays in all directions, each miss counts
  view,   // rays in directions that pictures of a given camera show; a polygon that is too small there does not count
  color   // mean difference of the colors with and without the set, 0 .. 1: rays in all directions
};

// As the command line and the settings text call them, in the order of the values.
inline constexpr std::array<std::string_view, 3> metric_names{"pixel", "view", "color"};

struct metric_settings {
  metric_kind kind = metric_kind::pixel;  // --metric

  // The pictures of metric_kind::view; not used by others.
  std::uint32_t view_width = 1920;   // --view-resolution WxH: pixels, 16 .. 65536
  std::uint32_t view_height = 1080;  // --view-resolution WxH: pixels, 16 .. 65536
  double view_fov = 60.0;            // --view-fov: vertical field of view, degrees, 1 .. 170
  // --view-pitch MIN,MAX: how far the camera turns down and up, degrees, -90 .. 90. It does not roll.
  std::array<double, 2> view_pitch{-90.0, 90.0};
  // --view-least: a polygon counts if its solid angle is at least this multiple of the solid angle of the pixel in the
  // middle of the picture, 0 .. 1e6.
  double view_least = 0.25;
};

// Checks ranges. Fails with settings.out-of-range; the line names the option.
void validate_metric(const metric_settings& s);

// ---- Quality --------------------------------------------------------------------------------------------------------

// --quality: names for values of settings::max_pixel_error.
enum class quality : std::uint8_t {
  draft,   // trials while a level changes
  normal,  // the default
  final    // releases
};
inline constexpr std::array<std::string_view, 3> quality_names = {"draft", "normal", "final"};

// The bound of each cell. Nothing else follows from the quality: rays and hemicubes are taken until the bound is met.
inline constexpr std::array<double, 3> max_pixel_error_of_quality = {1e-3, 1e-4, 1e-5};

// ---- Settings -------------------------------------------------------------------------------------------------------

struct settings {
  // --scene: number of the glTF scene, -1 for the default scene of the file. bake() takes the scene that it is given;
  // the number goes into the settings text, so that verify loads the same scene.
  std::int32_t scene = -1;

  // ---- Cells. At most one of cells_file, cells and cells_grid. Without them, cells are those that the scene contains
  // (scene::cells); else automatic cells: at eye height over floors with enough head room (reach), in the boxes of fly
  // and near the paths. With fly or a path, those of the scene are left out.
  std::optional<std::filesystem::path> cells_file;  // --cells-file: explicit cells, JSON
  std::vector<cell_box> cells;                      // explicit cells of a host
  std::optional<std::array<float, 6>> cells_grid;   // --cells-grid x0,y0,z0,x1,y1,z1: all lattice cells of this box
  // --fly x0,y0,z0,x1,y1,z1: a camera flies in these boxes, lower corners first, meters within 1e7 of the origin. All
  // lattice cells of a box are cells.
  std::vector<std::array<float, 6>> fly;
  std::optional<std::filesystem::path> path_file;  // --path: paths of cameras, JSON
  std::vector<camera_path> paths;                  // likewise, of a host or of --path-camera
  // --path-radius: lattice cells that are this near to a path, on each axis, are cells; meters, 0 .. 100
  float path_radius = 0.5f;
  float cell_size = 4.0f;  // --cell-size: width of the smallest lattice cells, meters, 0.25 .. 1000
  // --most-cells: where automatic cells of cell_size would be more than this, before any is merged, they are twice as
  // wide, and so on. 64 .. 1,000,000
  std::uint32_t most_cells = 20'000;
  // --merge-cells: automatic cells are merged with neighbors while the polygons that a player draws grow by at most
  // this part, in the mean over all floor; an estimate. 0 .. 10; 0: none is. Samplers of rays alone merge none.
  double merge_cells = 0.1;
  std::uint32_t cell_limit = 0;  // --cell-limit: bake this many cells, spread evenly; 0 for all
  // --near: with cell_limit, the cells nearest to this point instead, meters; without, it has no effect.
  std::optional<std::array<float, 3>> near;
  reach_kind reach = reach_kind::walk;       // --reach, of automatic cells
  std::vector<std::array<float, 3>> starts;  // --start x,y,z: on or above a floor, meters; none: those of the scene
  player_settings player;                    // of automatic cells
  float margin = 0.25f;                      // --margin: each cell is grown by this for the bake, meters, 0 .. 10
  float player_radius = 0.05f;  // --player-radius: distance of viewpoints from surfaces, meters, 0.001 .. 1

  // --cells-from: a second scene in the same world. Cells are those of this scene, and its polygons are visible and
  // occlude, but sets have only polygons of the scene that is baked. Null for one scene. The caller keeps it during the
  // bake.
  const scene::scene* cells_from = nullptr;

  // ---- Quality
  double max_pixel_error = 1e-4;  // --max-pixel-error: 1e-7 .. 0.5, or 0 for no rays: the sampler alone, without bounds
  metric_settings metric = {};    // --metric: the error that max_pixel_error bounds
  std::uint64_t seed = 1;         // --seed of the random numbers

  // --time-budget, sampler guided only: wall-clock seconds for the whole bake, 0 .. 1e7, 0 for none. Spent on the cells
  // with the largest bounds, until all are at most max_pixel_error. The result then depends on the machine.
  double time_budget = 0.0;
  double time_spent = 0.0;  // of the time budget: seconds that were spent before the call, for example on loading

  // ---- Sampler. sampler_options.h has meanings, ranges, and which sampler uses which option.
  std::string sampler = "guided";           // --sampler
  std::uint32_t samples = 24;               // --samples
  double seconds_per_cell = 0.0;            // --seconds-per-cell
  double interior_share = 0.5;              // --interior-share
  bool jitter = false;                      // --jitter
  double reliability = 0.995;               // --reliability
  std::uint32_t start_grid = 0;             // --start-grid
  double difference = 0.0;                  // --difference
  std::uint32_t part_polygons = 0;          // --part-polygons
  std::uint64_t sampling_rays = 1'000'000;  // --sampling-rays
  std::uint32_t rays_per_round = 65536;     // --rays-per-round
  std::uint32_t fewest_new = 0;             // --fewest-new
  std::uint32_t border_depth = 3;           // --border-depth
  std::uint32_t border_samples = 6;         // --border-samples
  double border_offset = 1e-3;              // --border-offset
  double filter = 0.0;                      // --filter

  // --source of hemicubes: "gpu" (OpenGL), "cpu" (our rasterizer), "rays" (Embree, slow) or "auto": gpu on a machine
  // with a hardware GPU, else cpu. Sources differ in a few pixels; the file names the one that was used.
  std::string source = "auto";
  std::uint32_t resolution = 512;  // --resolution: pixels along an edge of a hemicube face, even, 16 .. 4096

  // ---- Rules of visibility
  bool all_double_sided = false;  // --all-double-sided: back faces are visible and occlude too
  float smallest_gap = 0.002f;    // --smallest-gap: narrower gaps let no line of sight through, meters, 0 .. 0.1
  scene::animated_as animated = scene::animated_as::always;  // --animated: draws that an animation or a skin moves
  // --closed: named groups of the scene that occlude, as if they had no such mark. The file is for hosts while these
  // doors are closed; it has no named group of these names. Names of the scene, or of cells_from.
  std::vector<std::string> closed;
  bake::safety_ring safety_ring = bake::safety_ring::none;  // --safety-ring: conservative dilation of finished sets

  // --misses: misses that a host reported, JSON: {"misses": [{"eye": [x, y, z], "polygon": 1234}]}. A polygon joins the
  // sets of the cells that the eye may be in if a ray from there hits it.
  std::optional<std::filesystem::path> misses_file;

  // --volumes: width of visibility volumes, meters, 0.25 .. 1000, or 0 for none. Needs a max_pixel_error above 0.
  double volumes = 0.0;

  // --sun: for each sun, the polygons whose shadow falls into the view of a cell (docs/shadows.md). At most most_suns.
  // Needs a max_pixel_error above 0.
  std::vector<sun_setting> suns;

  // --lights: for each point and spot light of the scene, the polygons that it reaches, and the cells that see one of
  // them (docs/lights.md). Needs a max_pixel_error above 0 and the sampler guided.
  bool lights = false;

  // ---- File
  file_settings file;  // --profile, --order, --layout, --importance, --names

  // ---- Machine. None of these changes a byte of the file.
  std::uint32_t threads = 0;  // --threads: 0 for all cores
  std::uint64_t memory = 0;   // --memory: limit of the resident memory of the process, bytes; 0 for none

  // --scratch: a folder on a local disk for the unfinished bake. A copy is left beside the output every few minutes and
  // when the bake ends early. Empty: the unfinished bake is beside the output.
  std::filesystem::path scratch;

  // --keep-records: writes the records of all cells beside the output (output + ".records"), for a later `since`. Works
  // with the sampler guided, the source cpu and the metrics pixel and view, without --misses, --cells-from,
  // --time-budget, --seconds-per-cell and shards.
  bool keep_records = false;
  // --since: a .pvs file with kept records. Cells that an edit of the scene since then cannot have changed are taken
  // from there. Includes keep_records. Empty: none are taken.
  std::filesystem::path since;
  // --keep-found, with since (with keep_records alone it has no effect): cells that the edit can have changed start
  // from the polygons that they had. Those that may be hidden now are tried with rays, rays at the edit find what is
  // new, and verification rays prove the bound of the cell again. Much faster than baking these cells anew. The bounds
  // are those of any bake; the sets are not those of a full bake, and may have polygons that the edit occludes. Not
  // with volumes. A later bake without it bakes these cells anew.
  bool keep_found = false;
  // --keep-order, with since: a .pvs file of the version of the scene that since is of, such as since itself, or of the
  // scene as it is now.
  // Polygons and draws are stored in its order as far as they are still there, and not in one that is computed from the
  // sets. Ignored, with a warning, if the file cannot be read or is of another version. Not with clusters. Empty:
  // computed.
  std::filesystem::path order_from;
};

// Returns whether cells are where a camera flies: in boxes or near paths.
bool flies(const settings& s);

// Checks ranges and combinations.
// Fails with settings.out-of-range, settings.two-kinds-of-cells, settings.time-budget, settings.volumes,
//   settings.two-scenes, settings.records, settings.suns, settings.lights; the line names the option.
void validate(const settings& s);

// Returns the settings text: one line of JSON with all settings that can change a byte of the file, in fixed order. It
// is part of the checkpoint's key and is stored in the file.
std::string describe(const settings& s);

}  // namespace sightcell::bake
