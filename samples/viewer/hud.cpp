#include "hud.h"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <numbers>

namespace viewer {
namespace {

constexpr float degrees = 180.0f / std::numbers::pi_v<float>;
const ImVec4 warm(1.0f, 0.85f, 0.35f, 1.0f), dim(0.75f, 0.78f, 0.82f, 1.0f);

void line(const std::string& text) {
  ImGui::TextUnformatted(text.c_str());
}

void colored_line(const ImVec4& color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  line(text);
  ImGui::PopStyleColor();
}

std::string cell_text(const baked_scene& baked, std::uint32_t number) {
  if (number >= baked.cells.size()) return "no cell";
  const std::string& name = baked.cells[number].name;
  return fmt::format("cell {}{} of {}", number, name.empty() ? "" : " \"" + name + "\"", baked.cells.size());
}

void write_mode(const baked_scene& baked, const controls& state, const visible_lists& lists) {
  if (!baked.db) {
    line("no .pvs file: everything is drawn");
    return;
  }
  const char* mode = !state.pvs   ? "PVS off: everything is drawn"
                     : state.tint ? "PVS on, what it leaves out is red"
                                  : "PVS on";
  colored_line(warm, mode);
  if (state.frozen) colored_line(warm, "frozen: set of " + cell_text(baked, lists.shown().cell));
  line(fmt::format("{}   flags: {}", cell_text(baked, lists.here().cell), flags_text(lists.here().flags)));
}

void write_numbers(const baked_scene& baked, const controls& state, const visible_lists& lists,
                   const frame_facts& facts) {
  const double share = 100.0 * static_cast<double>(facts.polygons_drawn) / std::max(baked.polygon_count, 1u);
  line(fmt::format("{} of {} polygons ({:.2f} %)", with_commas(facts.polygons_drawn), with_commas(baked.polygon_count),
                   share));
  if (baked.db) {
    line(fmt::format("{} ranges   move {:.1f} us   last change of the list: {:.2f} ms",
                     with_commas(lists.range_count()), 1e3 * lists.move_milliseconds(), lists.change_milliseconds()));
  }
  line(fmt::format("{:.0f} frames/s   GPU {:.1f} ms   {}", facts.frames_per_second, facts.gpu_milliseconds,
                   facts.renderer));
  const fly_camera& c = state.camera;
  line(fmt::format("eye {:.2f} {:.2f} {:.2f}   yaw {:.0f} pitch {:.0f}   {:.1f} m/s", c.eye.x, c.eye.y, c.eye.z,
                   c.yaw * degrees, c.pitch * degrees, state.speed));
}

void write_keys() {
  std::string text;
  for (const key_binding& b : key_bindings()) {
    if (b.key == 344) continue;  // the other Shift
    const std::string one = fmt::format("{} {}", b.name, b.help);
    const std::size_t begin = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    if (!text.empty()) text += text.size() - begin + one.size() > 66 ? "\n" : "  |  ";
    text += one;
  }
  colored_line(dim, text + "  |  drag: look  |  wheel: speed");
}

}  // namespace

hud::hud(float scale) {
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // leaves no file behind
  io.FontGlobalScale = scale;
  ImGui::StyleColorsDark();
  ImGui_ImplOpenGL3_Init("#version 450 core");
}

hud::~hud() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void hud::draw(const baked_scene& baked, const controls& state, const visible_lists& lists, const frame_facts& facts,
               std::uint32_t width, std::uint32_t height) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
  io.DeltaTime = 1.0f / 60.0f;  // nothing here moves with time
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  ImGui::SetNextWindowPos(ImVec2(10.0f, 10.0f));
  ImGui::SetNextWindowBgAlpha(0.82f);
  ImGui::Begin("hud", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  line(baked.scene_name + (baked.pvs_name.empty() ? "" : " + " + baked.pvs_name));
  write_mode(baked, state, lists);
  ImGui::Separator();
  write_numbers(baked, state, lists, facts);
  ImGui::Separator();
  write_keys();
  ImGui::End();
  ImGui::Render();
  if (!measured_) {
    // A window that fits itself to its text is measured in its first frame and shown from the second on.
    measured_ = true;
    draw(baked, state, lists, facts, width, height);
    return;
  }
  glDisable(GL_FRAMEBUFFER_SRGB);  // its colors are sRGB already
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

std::string with_commas(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) {
    at -= 3;
    text.insert(at, 1, ',');
  }
  return text;
}

}  // namespace viewer
