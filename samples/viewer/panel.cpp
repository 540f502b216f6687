#include "panel.h"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <tuple>

#include "text.h"

namespace viewer {
namespace {

constexpr float degrees = 180.0f / std::numbers::pi_v<float>;
constexpr float margin = 10.0f;
const ImVec4 warm(1.0f, 0.85f, 0.35f, 1.0f), dim(0.75f, 0.78f, 0.82f, 1.0f), bad(1.0f, 0.42f, 0.36f, 1.0f);

void line(const std::string& text) {
  ImGui::TextUnformatted(text.c_str());
}

void colored_line(const ImVec4& color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + 430.0f);
  line(text);
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

std::string cell_text(const baked_scene& baked, std::uint32_t number) {
  if (number >= baked.cells.size()) return "no cell";
  const std::string& name = baked.cells[number].name;
  return fmt::format("cell {}{} of {}", number, name.empty() ? "" : " \"" + name + "\"", baked.cells.size());
}

void write_place(const baked_scene& baked, const controls& state, const visible_lists& lists) {
  if (!baked.db) {
    colored_line(warm, "no .pvs file: everything is drawn");
    return;
  }
  const std::uint32_t flags = lists.here().flags & ~SIGHTCELL_FRAME_CHANGED;
  line(cell_text(baked, lists.here().cell) + (flags != 0 ? "   " + flags_text(flags) : ""));
  if (state.frozen) colored_line(warm, "frozen: set of " + cell_text(baked, lists.shown().cell));
}

std::string time_left_text(double seconds) {
  if (seconds <= 0.0) return "";
  return seconds < 90.0 ? fmt::format(", {:.0f} s left", seconds) : fmt::format(", {:.0f} min left", seconds / 60.0);
}

void write_running_bake(const background_bake& bake, controls& state) {
  const bool counts = bake.cells_total() > 0 && bake.phase() != "merging cells";
  const double done = counts ? bake.cells() / static_cast<double>(bake.cells_total()) : bake.prepared();
  const std::string text = counts ? fmt::format("{} of {} cells{}", with_commas(bake.cells()),
                                                with_commas(bake.cells_total()), time_left_text(bake.seconds_left()))
                                  : fmt::format("{:.0f} %", 100.0 * done);
  line(fmt::format("bake ({}): {}", bake.quality(), bake.phase()));
  ImGui::ProgressBar(static_cast<float>(done), ImVec2(350.0f, 0.0f), text.c_str());
  ImGui::SameLine();
  if (ImGui::Button("Stop")) state.stop_bake = true;
}

// Offers a bake, or shows the one that runs.
void write_bake(const frame_facts& facts, controls& state) {
  using step = background_bake::step;
  const background_bake& bake = *facts.bake;
  if (bake.now() == step::running) return write_running_bake(bake, state);
  if (bake.now() == step::failed) colored_line(bad, bake.error());
  if (bake.now() == step::stopped) colored_line(warm, "the bake was stopped; Bake resumes it");
  const std::string name = std::filesystem::path(bake.output()).filename().string();
  if (facts.file_beside && bake.now() != step::done) {
    if (ImGui::Button(("Open " + name).c_str())) state.open_file = true;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Opens the .pvs file beside the scene.");
    return;
  }
  for (const auto& [label, quality, hint] :
       {std::tuple("Bake a draft", "draft",
                   "Bakes %s with a bound of 1e-3, in the background.\nCells appear on the map."),
        {"Bake", "normal", "Bakes %s with a bound of 1e-4, in the background.\nCells appear on the map."}}) {
    if (ImGui::Button(label)) state.bake_quality = quality;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip(hint, name.c_str());
    ImGui::SameLine();
  }
  ImGui::NewLine();
}

// Two columns of switches, each with its key.
void write_switches(const baked_scene& baked, controls& state) {
  struct one {
    const char* label;
    bool* value;
    bool needs_file;
  };
  const one all[] = {{"PVS (P)", &state.pvs, true},
                     {"whole objects (R)", &state.objects, true},
                     {"frustum culling (U)", &state.frustum, false},
                     {"freeze (F)", &state.frozen, true},
                     {"left out in red (V)", &state.tint, true},
                     {"wrong pixels (K)", &state.count_wrong, true},
                     {"box of the cell (O)", &state.box, true},
                     {"all cells (C)", &state.all_cells, true},
                     {"map (M)", &state.map, true},
                     {"wireframe (X)", &state.wireframe, false},
                     {"walk (G)", &state.walking, false},
                     {"mouse look (L)", &state.mouse_look, false}};
  int shown = 0;
  for (const one& s : all) {
    if (s.needs_file && !baked.db) continue;
    if (shown++ % 2 == 1) ImGui::SameLine(225.0f * ImGui::GetIO().FontGlobalScale);
    ImGui::Checkbox(s.label, s.value);
  }
  float fov = state.camera.vertical_fov * degrees;
  ImGui::SetNextItemWidth(110.0f);
  ImGui::SliderFloat("brightness", &state.brightness, 0.3f, 5.0f, "%.1f", ImGuiSliderFlags_Logarithmic);
  ImGui::SameLine(225.0f * ImGui::GetIO().FontGlobalScale);
  ImGui::SetNextItemWidth(110.0f);
  if (ImGui::SliderFloat("field of view", &fov, 20.0f, 110.0f, "%.0f degrees"))
    state.camera.vertical_fov = fov / degrees;
}

void write_numbers(const baked_scene& baked, const controls& state, const visible_lists& lists,
                   const frame_facts& facts) {
  const double share = 100.0 * static_cast<double>(facts.polygons_drawn) / std::max(baked.polygon_count, 1u);
  colored_line(warm, fmt::format("{} of {} polygons ({:.2f} %)", with_commas(facts.polygons_drawn),
                                 with_commas(baked.polygon_count), share));
  line(fmt::format("{} ranges in {} calls   {} cell changes", with_commas(facts.ranges_drawn), facts.calls,
                   facts.cell_changes));
  if (baked.db) {
    line(fmt::format("move {:.1f} us   last change of the list {:.2f} ms", 1e3 * lists.move_milliseconds(),
                     lists.change_milliseconds()));
  }
  if (facts.wrong_pixels) {
    const std::string text = fmt::format("{} of {} pixels differ from the full draw", with_commas(*facts.wrong_pixels),
                                         with_commas(facts.pixels));
    colored_line(*facts.wrong_pixels > 0 ? bad : dim, text);
  }
  const fly_camera& c = state.camera;
  line(fmt::format("eye {:.2f} {:.2f} {:.2f}   yaw {:.0f} pitch {:.0f}   {:.1f} m/s", c.eye.x, c.eye.y, c.eye.z,
                   c.yaw * degrees, c.pitch * degrees, state.speed));
  line(fmt::format("{:.0f} frames/s   GPU {:.1f} ms", facts.frames_per_second, facts.gpu_milliseconds));
  colored_line(dim, facts.renderer);
}

void plot(const char* name, const std::array<float, frame_history::length>& values, const frame_history& history,
          const std::string& newest) {
  const float top = 1.9f * std::max(*std::max_element(values.begin(), values.end()), 1e-3f);
  const ImVec2 corner = ImGui::GetCursorScreenPos(), size(430.0f, 38.0f);  // the text is above the highest value
  ImGui::PushID(name);
  ImGui::PlotLines("", values.data(), static_cast<int>(values.size()), static_cast<int>(history.next), newest.c_str(),
                   0.0f, top, size);
  ImGui::PopID();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!history.changed[(history.next + i) % values.size()]) continue;
    const float x = corner.x + 4.0f + (size.x - 8.0f) * static_cast<float>(i) / static_cast<float>(values.size() - 1);
    ImGui::GetWindowDrawList()->AddLine({x, corner.y + size.y - 6.0f}, {x, corner.y + size.y - 1.0f},
                                        IM_COL32(255, 217, 90, 200));
  }
}

void write_graphs(const frame_history& history, const frame_facts& facts) {
  plot("ms", history.milliseconds, history, fmt::format("frame {:.1f} ms", facts.frame_milliseconds));
  plot("polygons", history.polygons, history, with_commas(facts.polygons_drawn) + " polygons");
  plot("calls", history.calls, history, fmt::format("{} draw calls (ticks: cell changes)", facts.calls));
}

void write_keys() {
  if (!ImGui::CollapsingHeader("Keys")) return;
  std::string text;
  for (const key_binding& b : key_bindings()) {
    if (b.key == 344) continue;  // the other Shift
    const std::string one = fmt::format("{} {}", b.name, b.help);
    const std::size_t begin = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (!text.empty()) text += text.size() - begin + one.size() > 58 ? "\n" : "  |  ";
    text += one;
  }
  colored_line(dim, text + "\ndrag: turn  |  wheel: speed");
}

glm::vec4 rectangle_of_window() {
  const ImVec2 at = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  return {at.x, at.y, at.x + size.x, at.y + size.y};
}

bool is_in(const glm::vec4& rectangle, const glm::vec2& p) {
  return p.x >= rectangle.x && p.y >= rectangle.y && p.x < rectangle.z && p.y < rectangle.w;
}

}  // namespace

void frame_history::add(const frame_facts& facts, bool cell_changed) {
  milliseconds[next] = static_cast<float>(facts.frame_milliseconds);
  polygons[next] = static_cast<float>(facts.polygons_drawn);
  calls[next] = static_cast<float>(facts.calls);
  changed[next] = cell_changed;
  next = (next + 1) % length;
}

panel::panel(float scale) : scale_(scale) {
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // leaves no file behind
  io.FontGlobalScale = scale;
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 6.0f;
  style.FrameRounding = 3.0f;
  style.WindowBorderSize = 0.0f;
  style.FramePadding = ImVec2(4.0f, 2.0f);
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

panel::~panel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void panel::take_input(const input& in) {
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = ImVec2(in.mouse.x, in.mouse.y);
  io.MouseDown[0] = in.mouse_down;
}

bool panel::covers(const glm::vec2& pixel) const {
  return is_in(rectangles_[0], pixel) || is_in(rectangles_[1], pixel);
}

std::optional<std::uint32_t> panel::draw(const baked_scene& baked, controls& state, const visible_lists& lists,
                                         const frame_facts& facts, const frame_history& history, cell_map* map,
                                         std::uint32_t width, std::uint32_t height, bool wait) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = 1.0f / 60.0f;  // nothing here moves with time
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  rectangles_ = {};
  if (state.hud) {
    ImGui::SetNextWindowPos(ImVec2(margin, margin));
    ImGui::SetNextWindowBgAlpha(0.82f);
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
    line(baked.scene_name + (baked.pvs_name.empty() ? "" : " + " + baked.pvs_name));
    write_place(baked, state, lists);
    if (!facts.message.empty()) colored_line(bad, facts.message);
    const bool offers_bake = !baked.db || (facts.bake != nullptr && facts.bake->now() != background_bake::step::idle);
    if (facts.bake != nullptr && offers_bake) write_bake(facts, state);
    ImGui::Separator();
    write_switches(baked, state);
    ImGui::Separator();
    write_numbers(baked, state, lists, facts);
    write_graphs(history, facts);
    write_keys();
    rectangles_[0] = rectangle_of_window();
    ImGui::End();
  }
  std::optional<std::uint32_t> clicked;
  if (state.map && map != nullptr) {
    const float side = std::clamp(0.42f * std::min(io.DisplaySize.x, io.DisplaySize.y), 160.0f, 420.0f * scale_);
    const glm::vec2 corner(io.DisplaySize.x - side - margin, margin);
    clicked = map->draw(state.camera, lists.here().cell, state.frozen ? lists.shown().cell : lists.here().cell, corner,
                        {side, side + 30.0f}, wait);
    rectangles_[1] = {corner.x, corner.y, corner.x + side, corner.y + side + 30.0f};
  }
  ImGui::Render();
  if (!measured_) {
    // A window that fits itself to its text is measured in its first frame and shown from the second on.
    measured_ = true;
    return draw(baked, state, lists, facts, history, map, width, height, wait);
  }
  glDisable(GL_FRAMEBUFFER_SRGB);  // its colors are sRGB already
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  return clicked;
}

}  // namespace viewer
