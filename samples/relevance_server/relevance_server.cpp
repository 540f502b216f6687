// A game server that tells each player only of those it may see. See README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "crowd.h"
#include "sightcell/base/error.h"
#include "sightcell/sightcell.h"

namespace relevance_server {
namespace {

using sightcell::error;
using sightcell::error_kind;

constexpr float seconds_per_frame = 1.0f / 30.0f;

constexpr std::size_t most_doors = 32;

struct arguments {
  std::string pvs_file, record_file;
  std::vector<std::string> closed;  // DOOR[,DOOR]=FILE
  std::uint32_t players = 64, frames = 600;
  std::uint64_t seed = 1;
  float speed = 4.0f, lag = 0.0f, door_period = 2.0f;
};

struct close_db {
  void operator()(sightcell_db* db) const { sightcell_db_close(db); }
};
struct destroy_view {
  void operator()(sightcell_view* view) const { sightcell_view_destroy(view); }
};
using db_handle = std::unique_ptr<sightcell_db, close_db>;
using view_handle = std::unique_ptr<sightcell_view, destroy_view>;

void require(sightcell_status status, const std::string& subject) {
  if (status == SIGHTCELL_OK) return;
  const bool bad_file = status >= SIGHTCELL_ERR_IO;
  throw error(bad_file ? error_kind::bad_input : error_kind::failed, "relevance.runtime", subject,
              sightcell_status_text(status), bad_file ? "bake the scene again" : "report this");
}

// ---- what a server does ----

// A file, and a view of it for each player.
class visibility {
 public:
  visibility(const std::string& pvs_file, std::uint32_t players) {
    sightcell_db* opened = nullptr;
    require(sightcell_db_open_file(pvs_file.c_str(), nullptr, &opened), pvs_file);
    db_.reset(opened);
    if (sightcell_db_volume_count(opened) == 0 || sightcell_db_cell_count(opened) == 0) {
      throw error(error_kind::bad_input, "relevance.no-volumes", pvs_file,
                  "does not say where things that move can be seen", "bake it with --volumes 1");
    }
    for (std::uint32_t p = 0; p < players; ++p) {
      sightcell_view* made = nullptr;
      require(sightcell_view_create(opened, &made), pvs_file);
      views_.emplace_back(made);
    }
  }

  const sightcell_db* db() const { return db_.get(); }

  // Moves the view of a player to its eye or, with a box, to where the eye may be.
  sightcell_frame move(std::size_t player, const place& eye, const box* around) {
    sightcell_frame frame{};
    (void)(around != nullptr
               ? sightcell_view_move_box(views_[player].get(), around->min.data(), around->max.data(), &frame)
               : sightcell_view_move(views_[player].get(), eye.data(), &frame));
    return frame;
  }

  bool may_see(std::size_t viewer, const box& body) const {
    std::uint32_t visible = 1;
    (void)sightcell_view_box_visible(views_[viewer].get(), body.min.data(), body.max.data(), &visible);
    return visible != 0;
  }

 private:
  db_handle db_;
  std::vector<view_handle> views_;  // closed before the db
};

class server {
 public:
  // closed: DOOR[,DOOR]=FILE: a file that was baked with --closed for these doors.
  server(const std::string& pvs_file, const std::vector<std::string>& closed, std::uint32_t players)
      : open_(pvs_file, players), players_(players), visible_(std::size_t{players} * players) {
    for (const std::string& given : closed) add_closed(given);
  }

  const sightcell_db* db() const { return open_.db(); }
  const std::vector<std::string>& doors() const { return doors_; }

  // Where each player's eye is, or may be by now: within reach meters to the sides of where it was heard of last.
  // Outside all cells the view shows all, so nobody is kept from the player.
  void move(std::span<const place> eyes, float reach) {
    for (std::size_t p = 0; p < eyes.size(); ++p) {
      const box around = grown({eyes[p], eyes[p]}, reach);
      const box* const given = reach > 0.0f ? &around : nullptr;
      const sightcell_frame frame = open_.move(p, eyes[p], given);
      outside_ += (frame.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0 ? 1 : 0;
      changes_ += (frame.flags & SIGHTCELL_FRAME_CHANGED) != 0 ? 1 : 0;
      for (closed_file& one : closed_) one.seen.move(p, eyes[p], given);
    }
  }

  // Finds which players may be visible to which. A file of closed doors applies while all of these are closed, and a
  // player that is invisible in it is invisible then: closing more doors makes nothing visible.
  // closed: a bit for each of doors(). A door that opens must be open here before the first player can look through.
  void find_relevant(std::span<const place> eyes, float reach, std::uint32_t closed) {
    for (std::size_t viewer = 0; viewer < eyes.size(); ++viewer) {
      for (std::size_t other = 0; other < eyes.size(); ++other) {
        if (viewer == other) continue;
        const box body = grown(body_of(eyes[other]), reach);
        bool visible = open_.may_see(viewer, body);
        for (const closed_file& one : closed_)
          if (visible && (one.doors & ~closed) == 0) visible = one.seen.may_see(viewer, body);
        visible_[viewer * eyes.size() + other] = visible ? 1 : 0;
      }
    }
  }

  bool visible(std::size_t viewer, std::size_t other) const {
    return visible_[viewer * std::size_t{players_} + other] != 0;
  }
  std::uint64_t moves_outside() const { return outside_; }
  std::uint64_t changes() const { return changes_; }

 private:
  struct closed_file {
    visibility seen;
    std::uint32_t doors = 0;  // a bit for each
  };

  void add_closed(const std::string& given) {
    const std::size_t sign = given.find('=');
    if (sign == 0 || sign == std::string::npos)
      throw error(error_kind::wrong_use, "relevance.closed", "--closed", "is \"" + given + "\"",
                  "give DOOR=FILE.pvs, or DOOR,DOOR=FILE.pvs");
    const std::string file = given.substr(sign + 1);
    closed_file made{visibility(file, players_)};
    sightcell_info info{};
    info.struct_size = sizeof info;
    require(sightcell_db_info(made.seen.db(), &info), file);
    require(sightcell_db_same_scene(db(), info.scene_fingerprint), file);
    for (std::size_t begin = 0; begin < sign;) {
      const std::size_t end = std::min(given.find(',', begin), sign);
      made.doors |= 1u << door(given.substr(begin, end - begin), made.seen.db(), file);
      begin = end + 1;
    }
    closed_.push_back(std::move(made));
  }

  // Returns the number of a door. The open file has a named group for it, and one that was baked with --closed has
  // none.
  std::size_t door(const std::string& name, const sightcell_db* closed, const std::string& file) {
    std::uint32_t here = SIGHTCELL_NO_NAMED_GROUP, there = SIGHTCELL_NO_NAMED_GROUP;
    require(sightcell_db_find_named_group(db(), name.c_str(), &here), file);
    require(sightcell_db_find_named_group(closed, name.c_str(), &there), file);
    if (here == SIGHTCELL_NO_NAMED_GROUP || there != SIGHTCELL_NO_NAMED_GROUP)
      throw error(error_kind::bad_input, "relevance.not-closed", file, "was not baked with --closed \"" + name + "\"",
                  "bake it with this option, and the other file without");
    const auto found = std::find(doors_.begin(), doors_.end(), name);
    if (found != doors_.end()) return static_cast<std::size_t>(found - doors_.begin());
    if (doors_.size() == most_doors)
      throw error(error_kind::wrong_use, "relevance.closed", "--closed", "names more than 32 doors", "name fewer");
    doors_.push_back(name);
    return doors_.size() - 1;
  }

  static box grown(box b, float reach) {
    for (const std::size_t axis : {std::size_t{0}, std::size_t{2}}) {
      b.min[axis] -= reach;
      b.max[axis] += reach;
    }
    return b;
  }

  visibility open_;
  std::vector<closed_file> closed_;
  std::vector<std::string> doors_;
  std::uint32_t players_;
  std::vector<std::uint8_t> visible_;
  std::uint64_t outside_ = 0, changes_ = 0;
};

// ---- the game around it ----

std::vector<box> cells_of(const sightcell_db* db, const std::string& pvs_file) {
  std::vector<box> cells(sightcell_db_cell_count(db));
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    require(sightcell_db_cell_box(db, i, cells[i].min.data(), cells[i].max.data()), pvs_file);
  }
  return cells;
}

// Doors that open and close by themselves: each as often as the others, and at another time.
std::uint32_t closed_doors(std::size_t count, float seconds, float period) {
  std::uint32_t closed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = static_cast<double>(seconds / period) + static_cast<double>(i) / static_cast<double>(count);
    if (static_cast<std::uint64_t>(at) % 2 == 0) closed |= 1u << i;
  }
  return closed;
}

// Writes a line for each pair, for tests: frame, viewer, other; the eye of the viewer; the box of the other; which
// doors are closed, a bit for each; 1 if the other is sent.
class recorder {
 public:
  explicit recorder(const std::string& path) : path_(path) {
    if (path.empty()) return;
    file_.reset(std::fopen(path.c_str(), "w"));
    require_written(file_ != nullptr);
    fmt::print(file_.get(),
               "frame,viewer,other,eye_x,eye_y,eye_z,min_x,min_y,min_z,max_x,max_y,max_z,closed,visible\n");
  }
  void add(std::uint32_t frame, std::span<const place> eyes, std::uint32_t closed, const server& s) {
    if (!file_) return;
    for (std::size_t viewer = 0; viewer < eyes.size(); ++viewer) {
      for (std::size_t other = 0; other < eyes.size(); ++other) {
        if (viewer == other) continue;
        const box b = body_of(eyes[other]);
        const place& e = eyes[viewer];
        fmt::print(file_.get(), "{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", frame, viewer, other, e[0], e[1], e[2],
                   b.min[0], b.min[1], b.min[2], b.max[0], b.max[1], b.max[2], closed,
                   s.visible(viewer, other) ? 1 : 0);
      }
    }
  }
  void close() {
    if (file_) require_written(std::fclose(file_.release()) == 0);
  }

 private:
  void require_written(bool done) const {
    if (!done) throw error(error_kind::failed, "relevance.record", path_, "cannot be written", "name another file");
  }
  struct close_file {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, close_file> file_;
};

// Of this process, so that whatever else the machine does is not counted.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void run(const arguments& args) {
  server relevance(args.pvs_file, args.closed, args.players);
  crowd players(cells_of(relevance.db(), args.pvs_file), args.players, args.speed, args.seed);
  recorder record(args.record_file);
  const float reach = args.speed * args.lag;
  const std::uint64_t pairs_per_frame = std::uint64_t{args.players} * (args.players - 1);
  std::uint64_t hidden = 0;
  double moving = 0.0, asking = 0.0;
  for (std::uint32_t f = 0; f < args.frames; ++f) {
    const double start = cpu_seconds();
    relevance.move(players.eyes(), reach);
    const double moved = cpu_seconds();
    const std::uint32_t closed =
        closed_doors(relevance.doors().size(), static_cast<float>(f) * seconds_per_frame, args.door_period);
    relevance.find_relevant(players.eyes(), reach, closed);
    asking += cpu_seconds() - moved;
    moving += moved - start;
    for (std::size_t viewer = 0; viewer < args.players; ++viewer) {
      for (std::size_t other = 0; other < args.players; ++other) {
        if (viewer != other && !relevance.visible(viewer, other)) ++hidden;
      }
    }
    record.add(f, players.eyes(), closed, relevance);
    players.walk(seconds_per_frame);
  }
  record.close();

  const auto pairs = static_cast<double>(pairs_per_frame) * args.frames;
  const auto moves = static_cast<double>(args.players) * args.frames;
  fmt::print("{}: {} cells, {} volumes; {} players, {} frames\n", args.pvs_file,
             sightcell_db_cell_count(relevance.db()), sightcell_db_volume_count(relevance.db()), args.players,
             args.frames);
  fmt::print("{} pairs per frame, {:.2f} % hidden; {:.2f} % of moves into another cell, {:.2f} % outside all cells\n",
             pairs_per_frame, 100.0 * static_cast<double>(hidden) / pairs,
             100.0 * static_cast<double>(relevance.changes()) / moves,
             100.0 * static_cast<double>(relevance.moves_outside()) / moves);
  fmt::print("{:.1f} ns of CPU time per test, {:.0f} ns per move\n", 1e9 * asking / pairs, 1e9 * moving / moves);
}

}  // namespace
}  // namespace relevance_server

int main(int argc, char** argv) {
  relevance_server::arguments args;
  CLI::App app{"Lets players walk through a baked scene and asks, for all pairs, who may see whom"};
  app.add_option("pvs", args.pvs_file, "the file, baked with --volumes")->required();
  app.add_option("--players", args.players, "that walk about")->check(CLI::Range(2, 10000))->capture_default_str();
  app.add_option("--frames", args.frames, "of a thirtieth of a second")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--seed", args.seed, "of the ways they go")->capture_default_str();
  app.add_option("--speed", args.speed, "meters per second")->check(CLI::Range(0.0, 100.0))->capture_default_str();
  app.add_option("--lag", args.lag, "seconds by which the server knows less than the players")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--closed", args.closed,
                 "DOOR[,DOOR]=FILE: a file that was baked with --closed for these doors; may be repeated");
  app.add_option("--door-period", args.door_period, "seconds that each of these doors is closed, then open")
      ->check(CLI::Range(0.05, 1000.0))
      ->capture_default_str();
  app.add_option("--record", args.record_file, "a file for all pairs, as comma-separated values");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    relevance_server::run(args);
    return 0;
  } catch (const sightcell::error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == sightcell::error_kind::wrong_use ? 2 : e.kind() == sightcell::error_kind::bad_input ? 4 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
