// sightcell pack SCENE FILE.pvs -o PACKED.glb, sightcell pack --stream SCENE FILE.pvs -o FOLDER,
// sightcell pack --meshlets SCENE -o PACKED.glb
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <system_error>

#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "one_of.h"
#include "pvs_file.h"
#include "sightcell/bake/file_settings.h"
#include "sightcell/bake/meshlets.h"
#include "sightcell/bake/pack.h"
#include "sightcell/bake/stream.h"
#include "sightcell/base/error.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

struct pack_options {
  std::filesystem::path scene, file, output;
  bool json = false;
  bool stream = false, no_textures = false, meshlets = false, levels = false;
  bake::stream_settings streamed;
  std::string compress = std::string(bake::stream_copies_names[static_cast<std::size_t>(streamed.copies)]);
};

void refuse_overwriting(const pack_options& options) {
  std::error_code ignored;
  for (const auto& [input, what] :
       {std::pair(options.scene, "is the scene itself"), {options.file, "is the .pvs file"}})
    if (std::filesystem::equivalent(input, options.output, ignored))
      throw error(error_kind::wrong_use, "cli.output-is-input", options.output.string(), what, "choose another name");
}

void print_json(const nlohmann::ordered_json& text) {
  fmt::print("{}\n", text.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

// A line on standard error every ten seconds.
class slow_progress {
 public:
  void operator()(bake::stream_phase phase, std::uint64_t done, std::uint64_t total) {
    (*this)(name_of(phase), done, total);
  }

  // phase: a text with static storage.
  void operator()(const char* phase, std::uint64_t done, std::uint64_t total) {
    const clock::time_point now = clock::now();
    if (phase != phase_ || !began_) began_ = now, phase_ = phase;
    if (now - shown_ < std::chrono::seconds(10)) return;
    shown_ = now;
    const double seconds = std::chrono::duration<double>(now - *began_).count();
    const double left = done == 0 ? 0.0 : seconds / static_cast<double>(done) * static_cast<double>(total - done);
    say_line(fmt::format("{}: {} of {}, {} left", phase, grouped(done), grouped(total), duration_text(left)));
  }

 private:
  using clock = std::chrono::steady_clock;

  static const char* name_of(bake::stream_phase phase) {
    switch (phase) {
      case bake::stream_phase::reading_sets:
        return "reading cells";
      case bake::stream_phase::grouping_polygons:
        return "grouping polygons of geometries";
      case bake::stream_phase::writing_pages:
        return "writing pages";
      case bake::stream_phase::writing_images:
        return "writing images";
      case bake::stream_phase::writing_cells:
        break;
    }
    return "writing cells";
  }

  const char* phase_ = nullptr;
  std::optional<clock::time_point> began_;
  clock::time_point shown_ = clock::now();
};

nlohmann::ordered_json json_of(const pack_options& options, const bake::stream_result& r) {
  return {{"output", options.output.string()},
          {"polygons", r.polygons},
          {"polygons_left_out", r.polygons_left_out},
          {"draws", r.draws},
          {"geometries", r.geometries},
          {"cells", r.cells},
          {"pages", r.pages},
          {"chunks", r.chunks},
          {"images", r.images},
          {"front_bytes", r.front_bytes},
          {"page_bytes", r.page_bytes},
          {"chunk_bytes", r.chunk_bytes},
          {"image_bytes", r.image_bytes},
          {"first_image_bytes", r.first_image_bytes},
          {"page_gzip_bytes", r.sent_pages.gzip},
          {"page_brotli_bytes", r.sent_pages.brotli},
          {"mean_cell_bytes", r.mean_cell_bytes},
          {"mean_cell_gzip_bytes", r.mean_cell_gzip_bytes},
          {"tiles", r.tiles},
          {"tile_bytes", r.tile_bytes},
          {"tile_gzip_bytes", r.sent_tiles.gzip},
          {"tile_brotli_bytes", r.sent_tiles.brotli},
          {"tileset_bytes", r.tileset_bytes},
          {"files_written", r.files_written},
          {"files_kept", r.files_kept}};
}

void print_streamed(const pack_options& options, bake::stream_copies copies, const bake::stream_result& r) {
  fmt::print(
      "{}: {} polygons of {} geometries in {} pages ({}), {} cells in {} chunks ({}), {} images ({}, at first {}), "
      "front {}\n",
      options.output.string(), grouped(r.polygons - r.polygons_left_out), grouped(r.geometries), grouped(r.pages),
      size_text(static_cast<double>(r.page_bytes)), grouped(r.cells), grouped(r.chunks),
      size_text(static_cast<double>(r.chunk_bytes)), grouped(r.images), size_text(static_cast<double>(r.image_bytes)),
      size_text(static_cast<double>(r.first_image_bytes)), size_text(static_cast<double>(r.front_bytes)));
  if (options.streamed.tileset)
    fmt::print("tileset.json {}, {} tiles ({})\n", size_text(static_cast<double>(r.tileset_bytes)), grouped(r.tiles),
               size_text(static_cast<double>(r.tile_bytes)));
  const auto with_gzip = [&](double bytes) {
    return copies == bake::stream_copies::none ? "" : fmt::format(" ({} with gzip)", size_text(bytes));
  };
  if (copies != bake::stream_copies::none)
    fmt::print("pages are sent as {} with gzip{}\n", size_text(static_cast<double>(r.sent_pages.gzip)),
               copies == bake::stream_copies::gzip
                   ? ""
                   : fmt::format(", {} with brotli", size_text(static_cast<double>(r.sent_pages.brotli))));
  fmt::print("a cell needs {} of pages in the mean{}; {} files written, {} kept\n", size_text(r.mean_cell_bytes),
             with_gzip(r.mean_cell_gzip_bytes), grouped(r.files_written), grouped(r.files_kept));
}

int run_stream(const pack_options& options) {
  std::error_code ignored;
  if (std::filesystem::exists(options.output, ignored) && !std::filesystem::is_directory(options.output, ignored))
    throw error(error_kind::wrong_use, "pack.not-folder", options.output.string(),
                "is a file, and --stream writes a folder", "choose another name");
  const pvs_file file = pvs_file::open(options.file);
  bake::stream_settings how = options.streamed;
  how.textures = !options.no_textures;
  how.copies = bake::kind_of<bake::stream_copies>(bake::stream_copies_names, options.compress).value_or(how.copies);
  slow_progress progress;
  const bake::stream_result result = bake::pack_stream(
      options.scene, file.scene(), file.bytes(), options.file.string(), options.output, how,
      [&](bake::stream_phase phase, std::uint64_t done, std::uint64_t total) { progress(phase, done, total); });
  for (const std::string& warning : result.warnings) say_line("warning: " + warning);
  if (options.json)
    print_json(json_of(options, result));
  else
    print_streamed(options, how.copies, result);
  return exit_done;
}

int run_merged(const pack_options& options) {
  refuse_overwriting(options);
  const pvs_file file = pvs_file::open(options.file);
  const bake::pack_result result =
      bake::pack(options.scene, file.scene(), file.bytes(), options.file.string(), options.output);
  for (const std::string& warning : result.warnings) say_line("warning: " + warning);
  if (options.json) {
    print_json({{"output", options.output.string()},
                {"polygons", result.polygons},
                {"vertices", result.vertices},
                {"groups", result.groups},
                {"moving", result.moving},
                {"bytes", result.bytes}});
    return exit_done;
  }
  fmt::print("{}: {} polygons, {} vertices, {} draw groups ({} that move), {} bytes\n", options.output.string(),
             grouped(result.polygons), grouped(result.vertices), grouped(result.groups), grouped(result.moving),
             grouped(result.bytes));
  return exit_done;
}

int run_meshlets(const pack_options& options) {
  refuse_overwriting(options);
  slow_progress progress;
  const bake::meshlet_result result = bake::pack_meshlets(
      options.scene, -1, options.output, options.levels,
      [&](std::uint64_t done, std::uint64_t total) { progress("triangles in meshlets", done, total); });
  for (const std::string& warning : result.warnings) say_line("warning: " + warning);
  if (options.json) {
    print_json({{"output", options.output.string()},
                {"polygons", result.polygons},
                {"triangles", result.triangles},
                {"primitives", result.primitives},
                {"meshlets", result.meshlets},
                {"coarse_meshlets", result.coarse_meshlets},
                {"drawn_meshlets", result.drawn_meshlets},
                {"table_bytes", result.table_bytes},
                {"bytes", result.bytes}});
    return exit_done;
  }
  const std::string levels =
      options.levels ? fmt::format(", {} coarser ones", grouped(result.coarse_meshlets)) : std::string();
  fmt::print("{}: {} triangles of {} primitives in {} meshlets ({} with all instances){}, table {}, {} bytes\n",
             options.output.string(), grouped(result.triangles), grouped(result.primitives), grouped(result.meshlets),
             grouped(result.drawn_meshlets), levels, size_text(static_cast<double>(result.table_bytes)),
             grouped(result.bytes));
  return exit_done;
}

int run_pack(const pack_options& options) {
  outlive_failed_writes();
  if (options.meshlets) return run_meshlets(options);
  return options.stream ? run_stream(options) : run_merged(options);
}

}  // namespace

void add_pack_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<pack_options>();
  CLI::App& verb = add_verb(
      program, "pack",
      {.summary = "Writes the scene for hosts that load it with a .pvs file: one mesh, or files to stream",
       .usage = "SCENE [FILE.pvs] -o PACKED.glb|FOLDER [options]",
       .description = "Writes the scene as one mesh in world space, with its triangles in the stored order of a .pvs "
                      "file of the merged layout: one vertex buffer, one index buffer, one node for each draw group. "
                      "With --stream, writes a folder of small files for a static web server instead: pages of "
                      "polygons, and for each cell the list of its pages, the most visible ones first. "
                      "With --meshlets, writes the scene in clusters of up to 128 triangles and a table of them, for "
                      "a bake with --granularity cluster.",
       .examples = {"sightcell bake level.glb -o level.pvs --layout merged",
                    "sightcell pack level.glb level.pvs -o packed.glb",
                    "sightcell bake level.glb -o level.pvs --importance",
                    "sightcell pack --stream level.glb level.pvs -o site --compress brotli",
                    "sightcell pack --meshlets level.glb -o meshlets.glb"}});
  verb.add_option("SCENE", options->scene, "The scene that was baked: a .glb or .gltf file.")->required();
  CLI::Option* const file = verb.add_option(
      "FILE", options->file,
      "The .pvs file that was baked from it: with --layout merged, or for --stream with --importance. --meshlets "
      "needs none.");
  verb.add_option("-o", options->output, "The .glb file to write; for --stream the folder.")
      ->type_name("OUTPUT")
      ->required();
  CLI::Option* const stream =
      verb.add_flag("--stream", options->stream, "Writes a streamed scene: docs/streaming.md describes the files.");
  CLI::Option* const meshlets =
      verb.add_flag("--meshlets", options->meshlets,
                    "Writes the scene in meshlets: docs/meshlets.md describes the file. Bake that one.")
          ->excludes(stream)
          ->excludes(file);
  verb.add_flag("--levels", options->levels,
                "Adds levels of detail to the table of meshlets, in clusters as in Nanite.")
      ->needs(meshlets);
  verb.add_option("--page-size", options->streamed.page_bytes,
                  "Bytes of a page in the mean. Larger ones take fewer requests and contain more that is "
                  "not visible.")
      ->check(CLI::Range(2048, 4 << 20))
      ->type_name("BYTES")
      ->capture_default_str()
      ->needs(stream);
  verb.add_option("--grid", options->streamed.grid,
                  "Positions are rounded to steps of at most this length. Default: 1/4096 m.")
      ->check(CLI::Range(1e-6, 1e3))
      ->type_name("METERS")
      ->needs(stream);
  verb.add_flag("--no-textures", options->no_textures, "Leaves out the images.")->needs(stream);
  verb.add_flag("--all-attributes", options->streamed.all_attributes,
                "Keeps texture coordinates and tangents that no texture of the materials needs: for hosts with "
                "textures of their own, such as light maps.")
      ->needs(stream);
  verb.add_flag("--tileset", options->streamed.tileset,
                "Also writes tileset.json: 3D Tiles 1.1 over the pages, for CesiumJS, 3d-tiles-renderer and others.")
      ->needs(stream);
  verb.add_option("--compress", options->compress,
                  "Compressed copies of pages and tiles, which static servers send in their place: none, gzip "
                  "(.gz) or brotli (.br and .gz).")
      ->check(one_of(bake::stream_copies_names))
      ->type_name("NAME")
      ->capture_default_str()
      ->needs(stream);
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] {
    if (!options->meshlets && options->file.empty()) throw CLI::RequiredError("FILE");
    chosen = [options] { return run_pack(*options); };
  });
}

}  // namespace sightcell::cli
