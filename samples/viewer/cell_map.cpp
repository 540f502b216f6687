#include "cell_map.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "text.h"

namespace viewer {
namespace {

namespace picture = sightcell::picture;

constexpr float lowest_eye = 0.9f;        // meters: how far automatic cells begin above the floor
constexpr float far_outside = 10.0f;      // meters
constexpr float smallest_window = 0.01f;  // of the scene
constexpr std::size_t some = 64;          // cells counted per frame
constexpr float longest_cell = 1e30f;     // seconds
constexpr float same_box = 0.01f;         // of its shortest side: how far corners may be apart
constexpr std::uint32_t widest = 2048;    // pixels of a plan on the device
constexpr std::array<float, 3> no_heat{0.5f, 0.5f, 0.5f};
const ImU32 map_here_color = IM_COL32(255, 226, 60, 255), map_frozen_color = IM_COL32(30, 240, 255, 255);

picture::plan_rectangle rectangle_of(const cell& c) {
  return {c.min.x, c.min.z, c.max.x, c.max.z};
}

picture::plan_rectangle around(std::span<const cell> cells) {
  picture::plan_rectangle frame = rectangle_of(cells.front());
  for (const cell& c : cells) {
    frame = {std::min(frame.min_x, c.min.x), std::min(frame.min_z, c.min.z), std::max(frame.max_x, c.max.x),
             std::max(frame.max_z, c.max.z)};
  }
  // A few cells in a corner of a town are no map: some of what is around them too.
  const float border = std::max(4.0f, 0.1f * std::max(frame.max_x - frame.min_x, frame.max_z - frame.min_z));
  return {frame.min_x - border, frame.min_z - border, frame.max_x + border, frame.max_z + border};
}

// The smallest of the windows with a half, a quarter, an eighth ... of a whole that contains a part: while cells come,
// the map seldom moves. Windows of one size overlap by half.
picture::plan_rectangle window_around(const picture::plan_rectangle& whole, const picture::plan_rectangle& part) {
  picture::plan_rectangle window = whole;
  for (float share = 0.5f; share > smallest_window; share *= 0.5f) {
    const float wide = share * (whole.max_x - whole.min_x), high = share * (whole.max_z - whole.min_z);
    const float x = whole.min_x + 0.5f * wide * std::floor((part.min_x - whole.min_x) / (0.5f * wide));
    const float z = whole.min_z + 0.5f * high * std::floor((part.min_z - whole.min_z) / (0.5f * high));
    if (!(part.max_x <= x + wide && part.max_z <= z + high)) break;
    window = {x, z, x + wide, z + high};
  }
  return window;
}

// Every second pixel of every second row until it is small.
picture::image_rgba thinned(picture::image_rgba image) {
  while (std::max(image.width, image.height) > widest) {
    picture::image_rgba half;
    half.width = image.width / 2;
    half.height = image.height / 2;
    half.pixels.resize(4 * std::size_t{half.width} * half.height);
    for (std::size_t y = 0; y < half.height; ++y) {
      for (std::size_t x = 0; x < half.width; ++x) {
        const auto from = image.pixels.begin() + static_cast<std::ptrdiff_t>(4 * (2 * y * image.width + 2 * x));
        std::copy_n(from, 4, half.pixels.begin() + static_cast<std::ptrdiff_t>(4 * (y * half.width + x)));
      }
    }
    image = std::move(half);
  }
  return image;
}

}  // namespace

struct cell_map::placement {
  ImVec2 origin;
  float scale = 1.0f;
  picture::plan_rectangle extent;
  ImVec2 at(float x, float z) const {
    return {origin.x + scale * (x - extent.min_x), origin.y + scale * (z - extent.min_z)};
  }
  ImVec2 low(const cell& c) const { return at(c.min.x, c.min.z); }
  ImVec2 high(const cell& c) const { return at(c.max.x, c.max.z); }
};

namespace {

// at: in pixels.
void draw_eye(ImDrawList& list, const ImVec2& at, const fly_camera& camera, float aspect) {
  const float half = std::atan(std::tan(0.5f * camera.vertical_fov) * aspect);
  const auto toward = [&](float yaw) { return ImVec2(at.x + 34.0f * std::sin(yaw), at.y - 34.0f * std::cos(yaw)); };
  list.AddTriangleFilled(at, toward(camera.yaw - half), toward(camera.yaw + half), IM_COL32(255, 255, 255, 90));
  list.AddCircleFilled(at, 4.5f, IM_COL32(20, 20, 20, 255));
  list.AddCircleFilled(at, 3.0f, IM_COL32(255, 255, 255, 255));
}

std::string bound_text(float bound) {
  return fmt::format("{:.1e}", bound);
}

std::string seconds_text(float seconds) {
  return fmt::format("{:.2g} s", seconds);
}

}  // namespace

known_values::known_values(std::vector<float> of_cell, float below) : of_cell_(std::move(of_cell)), below_(below) {
  for (std::uint32_t c = 0; c < of_cell_.size(); ++c) {
    const std::optional<float> value = of(c);
    if (!value) continue;
    lowest_ = any() ? std::min(lowest_, *value) : *value;
    highest_ = std::max(highest_, *value);
    ++count_;
  }
}

std::optional<float> known_values::of(std::uint32_t cell) const {
  if (cell >= of_cell_.size() || !(of_cell_[cell] > 0.0f && of_cell_[cell] < below_)) return std::nullopt;
  return of_cell_[cell];
}

std::optional<float> known_values::heat(std::uint32_t cell) const {
  const std::optional<float> value = of(cell);
  if (!value) return std::nullopt;
  const float range = std::log(highest_ / lowest_);
  return range > 0.0f ? std::log(*value / lowest_) / range : 0.5f;
}

cell_map::cell_map(const baked_scene& baked, const sightcell::scene::world_geometry& world)
    : cells_(baked.cells), world_(world), bounds_(baked.bounds, 1.0f) {
  make_floors();
  if (cells_.empty()) return;
  if (auto created = sightcell::view::create(*baked.db); created) view_ = std::move(*created);
}

cell_map::cell_map(std::span<const finished_cell> finished, const sightcell::scene::world_geometry& world)
    : world_(world) {
  std::vector<float> bounds, seconds;
  for (const finished_cell& c : finished) {
    cells_.push_back({c.min, c.max, {}, c.middle()});
    polygons_.push_back(c.polygons);
    bounds.push_back(c.bound);
    seconds.push_back(c.seconds);
    most_ = std::max(most_, c.polygons);
  }
  bounds_ = known_values(std::move(bounds), 1.0f);
  seconds_ = known_values(std::move(seconds), longest_cell);
  make_floors();
  frame_ = window_around({world.min.x, world.min.z, world.max.x, world.max.z}, frame_);
  extent_ = picture::plan_extent(frame_);
}

cell_map::~cell_map() {
  for (plan& p : plans_) {
    if (p.texture != 0) glDeleteTextures(1, &p.texture);
  }
}

void cell_map::make_floors() {
  if (cells_.empty()) return;
  floors_ = floors_of(cells_);
  floor_of_cell_.resize(cells_.size());
  for (std::size_t f = 0; f < floors_.size(); ++f) {
    for (const std::uint32_t c : floors_[f].cells) floor_of_cell_[c] = f;
  }
  plans_.resize(floors_.size());
  frame_ = around(cells_);
  extent_ = picture::plan_extent(frame_);
}

void cell_map::take_seconds(std::span<const finished_cell> finished) {
  std::vector<const finished_cell*> by_x;
  for (const finished_cell& c : finished) by_x.push_back(&c);
  const auto left_of = [](const finished_cell* c, float x) { return c->min.x < x; };
  std::sort(by_x.begin(), by_x.end(),
            [](const finished_cell* a, const finished_cell* b) { return a->min.x < b->min.x; });
  std::vector<float> seconds(cells_.size(), -1.0f);
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const cell& box = cells_[c];
    const glm::vec3 sides = box.max - box.min;
    const float apart = same_box * std::min({sides.x, sides.y, sides.z});
    auto at = std::lower_bound(by_x.begin(), by_x.end(), box.min.x - apart, left_of);
    for (; at != by_x.end() && (*at)->min.x <= box.min.x + apart; ++at) {
      if (glm::distance((*at)->min, box.min) + glm::distance((*at)->max, box.max) < apart) seconds[c] = (*at)->seconds;
    }
  }
  seconds_ = known_values(std::move(seconds), longest_cell);
}

// That of the nearest cell; for an eye far outside, the one with the most cells.
void cell_map::choose_floor(const glm::vec3& eye) {
  const auto distance_to = [&](const cell& c) { return glm::distance(eye, glm::clamp(eye, c.min, c.max)); };
  const auto nearest = std::min_element(cells_.begin(), cells_.end(),
                                        [&](const cell& a, const cell& b) { return distance_to(a) < distance_to(b); });
  floor_ = floor_of_cell_[static_cast<std::size_t>(nearest - cells_.begin())];
  if (distance_to(*nearest) < far_outside) return;
  const auto most = std::max_element(floors_.begin(), floors_.end(), [](const map_floor& a, const map_floor& b) {
    return a.cells.size() < b.cells.size();
  });
  floor_ = static_cast<std::size_t>(most - floors_.begin());
}

bool cell_map::prepare(const glm::vec3& eye) {
  if (cells_.empty()) return true;
  if (!floor_) choose_floor(eye);
  if (!plans_[*floor_].begun) begin_plan(*floor_);
  take_plan(plans_[*floor_], false);
  return plans_[*floor_].texture != 0;
}

void cell_map::count_polygons(bool all) {
  const std::size_t end = all ? cells_.size() : std::min(cells_.size(), polygons_.size() + some);
  for (std::size_t c = polygons_.size(); c < end && view_; ++c) {
    const glm::vec3& eye = cells_[c].eye;
    sightcell_frame frame{};
    const bool found = view_->move(std::array<float, 3>{eye.x, eye.y, eye.z}, frame) == SIGHTCELL_OK &&
                       (frame.flags & SIGHTCELL_FRAME_DRAW_ALL) == 0;
    polygons_.push_back(found ? frame.polygon_count : 0);
    most_ = std::max(most_, polygons_.back());
  }
}

void cell_map::begin_plan(std::size_t floor) {
  picture::floor_plan what;
  what.frame = frame_;
  what.bare = true;
  for (const std::uint32_t c : floors_[floor].cells) {
    what.areas.push_back({rectangle_of(cells_[c]), cells_[c].min.y - lowest_eye, 0.0f});
  }
  plans_[floor].begun = true;
  plans_[floor].coming = std::async(std::launch::async,
                                    [&world = world_, what] { return thinned(picture::draw_floor_plan(world, what)); });
}

void cell_map::take_plan(plan& p, bool wait) {
  if (!p.coming.valid()) return;
  if (!wait && p.coming.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const picture::image_rgba image = p.coming.get();
  glCreateTextures(GL_TEXTURE_2D, 1, &p.texture);
  const auto width = static_cast<GLsizei>(image.width), height = static_cast<GLsizei>(image.height);
  glTextureStorage2D(p.texture, 1, GL_RGBA8, width, height);
  glTextureSubImage2D(p.texture, 0, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
  glTextureParameteri(p.texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

// The button that shows what colors mean, and changes it.
void cell_map::draw_choice() {
  static constexpr std::array names{"polygons", "bound", "seconds"};
  if (!bounds_.any() && !seconds_.any()) return;
  ImGui::SameLine();
  if (ImGui::SmallButton(names[static_cast<std::size_t>(coloring_)])) {
    do {
      coloring_ = static_cast<coloring>((static_cast<std::size_t>(coloring_) + 1) % names.size());
    } while (coloring_ != coloring::polygons && !values().any());
  }
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("color of a cell: its polygons, the bound of its miss probability, or the seconds of its bake");
}

void cell_map::draw_title() {
  const map_floor& floor = floors_[*floor_];
  ImGui::Text("Floor %zu of %zu: %zu cells", *floor_ + 1, floors_.size(), floor.cells.size());
  draw_choice();
  if (floors_.size() <= 1) return;
  ImGui::SameLine(ImGui::GetWindowWidth() - 62.0f);
  if (ImGui::ArrowButton("lower", ImGuiDir_Down) && *floor_ > 0) --*floor_;
  ImGui::SameLine();
  if (ImGui::ArrowButton("higher", ImGuiDir_Up) && *floor_ + 1 < floors_.size()) ++*floor_;
}

std::optional<std::uint32_t> cell_map::draw(const fly_camera& camera, std::uint32_t here, std::uint32_t frozen,
                                            const glm::vec2& corner, const glm::vec2& size, bool wait) {
  if (floors_.empty()) return std::nullopt;
  if (!floor_) choose_floor(camera.eye);
  if (here != last_here_ && here < floor_of_cell_.size()) floor_ = floor_of_cell_[here];
  last_here_ = here;
  count_polygons(wait);
  if (coloring_ != coloring::polygons && !values().any()) coloring_ = coloring::polygons;
  if (!plans_[*floor_].begun) begin_plan(*floor_);
  take_plan(plans_[*floor_], wait);

  ImGui::SetNextWindowPos(ImVec2(corner.x, corner.y));
  ImGui::SetNextWindowSize(ImVec2(size.x, size.y));
  ImGui::SetNextWindowBgAlpha(0.82f);
  ImGui::Begin("map", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove);
  draw_title();
  const std::optional<std::uint32_t> clicked = draw_cells(camera, here, frozen);
  ImGui::End();
  return clicked;
}

// The share of the color ramp. A cell without a bound is as red as the worst one.
std::optional<float> cell_map::heat_of(std::uint32_t cell) const {
  if (coloring_ == coloring::polygons) {
    return cell < polygons_.size() && most_ > 0 ? static_cast<float>(polygons_[cell]) / static_cast<float>(most_)
                                                : 0.0f;
  }
  const std::optional<float> heat = values().heat(cell);
  return heat || coloring_ == coloring::seconds ? heat : 1.0f;
}

// Returns the cell under the mouse.
std::optional<std::uint32_t> cell_map::draw_boxes(const placement& place, bool hovered) const {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  std::optional<std::uint32_t> under;
  for (const std::uint32_t c : floors_[*floor_].cells) {
    const ImVec2 a = place.low(cells_[c]), b = place.high(cells_[c]);
    const std::optional<float> heat = heat_of(c);
    const std::array<float, 3> color = heat ? heat_color(*heat) : no_heat;
    list.AddRectFilled(a, b, ImGui::GetColorU32(ImVec4(color[0], color[1], color[2], 0.62f)));
    if (b.x - a.x > 5.0f) list.AddRect(a, b, IM_COL32(0, 0, 0, 90));
    if (hovered && mouse.x >= a.x && mouse.x < b.x && mouse.y >= a.y && mouse.y < b.y) under = c;
  }
  return under;
}

void cell_map::write_tooltip(std::uint32_t cell) const {
  std::string text = fmt::format("cell {}", cell);
  if (!cells_[cell].name.empty()) text += fmt::format(" \"{}\"", cells_[cell].name);
  text += fmt::format("\n{} polygons", with_commas(cell < polygons_.size() ? polygons_[cell] : 0));
  if (bounds_.any()) text += "\n" + (bounds_.of(cell) ? "bound " + bound_text(*bounds_.of(cell)) : "no bound");
  if (seconds_.of(cell)) text += "\nbaked in " + seconds_text(*seconds_.of(cell));
  ImGui::SetTooltip("%s\nclick to go there", text.c_str());
}

// A strip of all colors between the two ends of the ramp.
void cell_map::draw_legend(const glm::vec2& corner, float length) {
  std::string low = "0", high = with_commas(most_) + " polygons";
  if (coloring_ != coloring::polygons) {
    const auto text = coloring_ == coloring::bound ? bound_text : seconds_text;
    low = text(values().lowest());
    high = text(values().highest());
  }
  const float left = ImGui::CalcTextSize(low.c_str()).x + 8.0f, right = ImGui::CalcTextSize(high.c_str()).x + 8.0f;
  const ImVec2 strip(corner.x + left, corner.y);
  const float wide = length - left - right;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (int i = 0; i < 32; ++i) {
    const std::array<float, 3> color = heat_color(static_cast<float>(i) / 31.0f);
    list.AddRectFilled({strip.x + wide * static_cast<float>(i) / 32.0f, strip.y + 2.0f},
                       {strip.x + wide * static_cast<float>(i + 1) / 32.0f, strip.y + 11.0f},
                       ImGui::GetColorU32(ImVec4(color[0], color[1], color[2], 1.0f)));
  }
  list.AddText({corner.x + 2.0f, strip.y}, IM_COL32(220, 225, 230, 255), low.c_str());
  list.AddText({strip.x + wide + 8.0f, strip.y}, IM_COL32(220, 225, 230, 255), high.c_str());
}

std::optional<std::uint32_t> cell_map::draw_cells(const fly_camera& camera, std::uint32_t here, std::uint32_t frozen) {
  const float legend = ImGui::GetTextLineHeightWithSpacing() + 4.0f;
  const ImVec2 corner = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  const ImVec2 area(std::max(room.x, 1.0f), std::max(room.y - legend, 1.0f));
  const float wide = extent_.max_x - extent_.min_x, high = extent_.max_z - extent_.min_z;
  placement place{corner, std::min(area.x / wide, area.y / high), extent_};
  place.origin.x += 0.5f * (area.x - place.scale * wide);
  place.origin.y += 0.5f * (area.y - place.scale * high);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (const unsigned texture = plans_[*floor_].texture; texture != 0) {
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                  place.at(extent_.min_x, extent_.min_z), place.at(extent_.max_x, extent_.max_z), {0, 0}, {1, 1},
                  IM_COL32(255, 255, 255, 200));
  }
  ImGui::InvisibleButton("cells", area);
  const bool hovered = ImGui::IsItemHovered(), pressed = ImGui::IsItemClicked();
  list.PushClipRect(corner, ImVec2(corner.x + area.x, corner.y + area.y), true);
  const std::optional<std::uint32_t> under = draw_boxes(place, hovered);
  const auto frame = [&](std::uint32_t c, ImU32 color) {
    if (c >= cells_.size() || floor_of_cell_[c] != *floor_) return;
    list.AddRect(place.low(cells_[c]), place.high(cells_[c]), color, 0.0f, 0, 2.0f);
  };
  frame(here, map_here_color);
  if (frozen != here) frame(frozen, map_frozen_color);
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  draw_eye(list, place.at(camera.eye.x, camera.eye.z), camera, whole.x / std::max(whole.y, 1.0f));
  list.PopClipRect();
  if (under) write_tooltip(*under);
  draw_legend({corner.x, corner.y + area.y + 6.0f}, area.x);
  return pressed ? under : std::nullopt;
}

}  // namespace viewer
