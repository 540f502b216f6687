#include "cell_map.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "text.h"

namespace viewer {
namespace {

namespace picture = sightcell::picture;

constexpr float lowest_eye = 0.9f;      // meters: how far automatic cells begin above the floor
constexpr std::size_t some = 64;        // cells counted per frame
constexpr std::uint32_t widest = 2048;  // pixels of a plan on the device
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

// Meters of the plan to pixels of the window.
struct placement {
  ImVec2 origin;
  float scale = 1.0f;
  picture::plan_rectangle extent;
  ImVec2 at(float x, float z) const {
    return {origin.x + scale * (x - extent.min_x), origin.y + scale * (z - extent.min_z)};
  }
};

void draw_eye(ImDrawList& list, const placement& place, const fly_camera& camera, float aspect) {
  const ImVec2 eye = place.at(camera.eye.x, camera.eye.z);
  const float half = std::atan(std::tan(0.5f * camera.vertical_fov) * aspect);
  const auto toward = [&](float yaw) { return ImVec2(eye.x + 34.0f * std::sin(yaw), eye.y - 34.0f * std::cos(yaw)); };
  list.AddTriangleFilled(eye, toward(camera.yaw - half), toward(camera.yaw + half), IM_COL32(255, 255, 255, 90));
  list.AddCircleFilled(eye, 4.5f, IM_COL32(20, 20, 20, 255));
  list.AddCircleFilled(eye, 3.0f, IM_COL32(255, 255, 255, 255));
}

}  // namespace

cell_map::cell_map(const baked_scene& baked, const sightcell::scene::world_geometry& world)
    : baked_(baked), world_(world), floors_(floors_of(baked.cells)), floor_of_cell_(baked.cells.size()) {
  if (baked.cells.empty()) return;
  for (std::size_t f = 0; f < floors_.size(); ++f) {
    for (const std::uint32_t c : floors_[f].cells) floor_of_cell_[c] = f;
  }
  plans_.resize(floors_.size());
  frame_ = around(baked.cells);
  extent_ = picture::plan_extent(frame_);
  if (auto created = sightcell::view::create(*baked.db); created) view_ = std::move(*created);
}

cell_map::~cell_map() {
  for (plan& p : plans_) {
    if (p.texture != 0) glDeleteTextures(1, &p.texture);
  }
}

void cell_map::count_polygons(bool all) {
  const std::size_t end = all ? baked_.cells.size() : std::min(baked_.cells.size(), polygons_.size() + some);
  for (std::size_t c = polygons_.size(); c < end && view_; ++c) {
    const glm::vec3& eye = baked_.cells[c].eye;
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
    what.areas.push_back({rectangle_of(baked_.cells[c]), baked_.cells[c].min.y - lowest_eye, 0.0f});
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

std::optional<std::uint32_t> cell_map::draw(const fly_camera& camera, std::uint32_t here, std::uint32_t frozen,
                                            const glm::vec2& corner, const glm::vec2& size, bool wait) {
  if (floors_.empty()) return std::nullopt;
  if (here != last_here_ && here < floor_of_cell_.size()) floor_ = floor_of_cell_[here];
  last_here_ = here;
  count_polygons(wait);
  if (!plans_[floor_].begun) begin_plan(floor_);
  take_plan(plans_[floor_], wait);

  ImGui::SetNextWindowPos(ImVec2(corner.x, corner.y));
  ImGui::SetNextWindowSize(ImVec2(size.x, size.y));
  ImGui::SetNextWindowBgAlpha(0.82f);
  ImGui::Begin("map", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove);
  const map_floor& floor = floors_[floor_];
  ImGui::Text("Floor %zu of %zu: %zu cells", floor_ + 1, floors_.size(), floor.cells.size());
  if (floors_.size() > 1) {
    ImGui::SameLine(ImGui::GetWindowWidth() - 62.0f);
    if (ImGui::ArrowButton("lower", ImGuiDir_Down) && floor_ > 0) --floor_;
    ImGui::SameLine();
    if (ImGui::ArrowButton("higher", ImGuiDir_Up) && floor_ + 1 < floors_.size()) ++floor_;
  }
  const std::optional<std::uint32_t> clicked = draw_cells(camera, here, frozen);
  ImGui::End();
  return clicked;
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
  const ImVec2 low = place.at(extent_.min_x, extent_.min_z), top = place.at(extent_.max_x, extent_.max_z);
  const unsigned texture = plans_[floor_].texture;
  if (texture != 0) {
    list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), low, top, {0, 0}, {1, 1},
                  IM_COL32(255, 255, 255, 200));
  }
  ImGui::InvisibleButton("cells", area);
  const bool hovered = ImGui::IsItemHovered(), pressed = ImGui::IsItemClicked();
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  std::optional<std::uint32_t> under;
  list.PushClipRect(corner, ImVec2(corner.x + area.x, corner.y + area.y), true);
  for (const std::uint32_t c : floors_[floor_].cells) {
    const cell& one = baked_.cells[c];
    const ImVec2 a = place.at(one.min.x, one.min.z), b = place.at(one.max.x, one.max.z);
    const float share =
        c < polygons_.size() && most_ > 0 ? static_cast<float>(polygons_[c]) / static_cast<float>(most_) : 0.0f;
    const std::array<float, 3> color = heat_color(share);
    list.AddRectFilled(a, b, ImGui::GetColorU32(ImVec4(color[0], color[1], color[2], 0.62f)));
    if (b.x - a.x > 5.0f) list.AddRect(a, b, IM_COL32(0, 0, 0, 90));
    if (hovered && mouse.x >= a.x && mouse.x < b.x && mouse.y >= a.y && mouse.y < b.y) under = c;
  }
  const auto frame = [&](std::uint32_t c, ImU32 color) {
    if (c >= baked_.cells.size() || floor_of_cell_[c] != floor_) return;
    const cell& one = baked_.cells[c];
    list.AddRect(place.at(one.min.x, one.min.z), place.at(one.max.x, one.max.z), color, 0.0f, 0, 2.0f);
  };
  frame(here, map_here_color);
  if (frozen != here) frame(frozen, map_frozen_color);
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  draw_eye(list, place, camera, whole.x / std::max(whole.y, 1.0f));
  list.PopClipRect();
  if (under) {
    ImGui::SetTooltip("cell %u%s\n%s polygons\nclick to go there", *under,
                      baked_.cells[*under].name.empty() ? "" : (" \"" + baked_.cells[*under].name + "\"").c_str(),
                      with_commas(*under < polygons_.size() ? polygons_[*under] : 0).c_str());
  }
  // The legend: a strip of all colors between 0 and the most polygons.
  const std::string most = with_commas(most_) + " polygons";
  const ImVec2 strip(corner.x + 14.0f, corner.y + area.y + 6.0f);
  const float length = area.x - ImGui::CalcTextSize(most.c_str()).x - 28.0f;
  for (int i = 0; i < 32; ++i) {
    const std::array<float, 3> color = heat_color(static_cast<float>(i) / 31.0f);
    list.AddRectFilled({strip.x + length * static_cast<float>(i) / 32.0f, strip.y + 2.0f},
                       {strip.x + length * static_cast<float>(i + 1) / 32.0f, strip.y + 11.0f},
                       ImGui::GetColorU32(ImVec4(color[0], color[1], color[2], 1.0f)));
  }
  list.AddText({corner.x + 2.0f, strip.y}, IM_COL32(220, 225, 230, 255), "0");
  list.AddText({strip.x + length + 8.0f, strip.y}, IM_COL32(220, 225, 230, 255), most.c_str());
  return pressed ? under : std::nullopt;
}

}  // namespace viewer
