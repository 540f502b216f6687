#define SDL_MAIN_HANDLED
#include "walk.h"

#include <SDL.h>
#include <SDL_vulkan.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "camera.h"
#include "device.h"
#include "measure.h"
#include "renderer.h"
#include "screenshot.h"
#include "sightcell/base/error.h"
#include "swapchain.h"

namespace vulkan_host {
namespace {

[[noreturn]] void fail(const char* call) {
  throw sightcell::error(sightcell::error_kind::failed, "vulkan.window", call, SDL_GetError(), "run without --window");
}

class window {
 public:
  window(std::uint32_t width, std::uint32_t height) {
    SDL_SetMainReady();
    if (SDL_Init(SDL_INIT_VIDEO) != 0) fail("SDL_Init");
    window_ =
        SDL_CreateWindow("sightcell-vulkan", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, static_cast<int>(width),
                         static_cast<int>(height), SDL_WINDOW_VULKAN | SDL_WINDOW_RESIZABLE);
    if (window_ == nullptr) {
      const std::string cause = SDL_GetError();
      SDL_Quit();
      SDL_SetError("%s", cause.c_str());
      fail("SDL_CreateWindow");
    }
    SDL_SetRelativeMouseMode(SDL_TRUE);
  }
  ~window() {
    SDL_DestroyWindow(window_);
    SDL_Quit();
  }
  window(const window&) = delete;
  window& operator=(const window&) = delete;

  std::vector<const char*> extensions() const {
    unsigned count = 0;
    if (SDL_Vulkan_GetInstanceExtensions(window_, &count, nullptr) != SDL_TRUE)
      fail("SDL_Vulkan_GetInstanceExtensions");
    std::vector<const char*> out(count);
    if (SDL_Vulkan_GetInstanceExtensions(window_, &count, out.data()) != SDL_TRUE)
      fail("SDL_Vulkan_GetInstanceExtensions");
    return out;
  }

  VkExtent2D size() const {
    int width = 0, height = 0;
    SDL_Vulkan_GetDrawableSize(window_, &width, &height);
    return {static_cast<std::uint32_t>(std::max(width, 1)), static_cast<std::uint32_t>(std::max(height, 1))};
  }

  bool is_minimized() const { return (SDL_GetWindowFlags(window_) & SDL_WINDOW_MINIMIZED) != 0; }
  void title(const std::string& text) { SDL_SetWindowTitle(window_, text.c_str()); }
  SDL_Window* get() const { return window_; }

 private:
  SDL_Window* window_ = nullptr;
};

struct surface {
  const instance& of;
  VkSurfaceKHR handle = VK_NULL_HANDLE;

  surface(const instance& made_of, const window& shown) : of(made_of) {
    if (SDL_Vulkan_CreateSurface(shown.get(), of.get(), &handle) != SDL_TRUE) fail("SDL_Vulkan_CreateSurface");
  }
  ~surface() { vkDestroySurfaceKHR(of.get(), handle, nullptr); }
  surface(const surface&) = delete;
  surface& operator=(const surface&) = delete;
};

// ---- input ----

class walker {
 public:
  walker(const sightcell::db& db, const std::string& file) {
    for (const camera& view : find_views(db, file, 64, 1, 1.0f)) eyes_.push_back(view.eye);
    eye_ = eyes_.front();
  }

  bool ended() const { return ended_; }
  draw_mode mode() const { return mode_; }
  camera view(VkExtent2D size) const {
    return look(eye_, yaw_, pitch_, static_cast<float>(size.width) / static_cast<float>(size.height));
  }

  void take_events() {
    SDL_Event event;
    while (SDL_PollEvent(&event) != 0) {
      if (event.type == SDL_QUIT) ended_ = true;
      if (event.type == SDL_KEYDOWN) press(event.key.keysym.sym);
      if (event.type != SDL_MOUSEMOTION) continue;
      constexpr float radians_per_pixel = 0.003f, most = 0.49f * std::numbers::pi_v<float>;
      yaw_ -= radians_per_pixel * static_cast<float>(event.motion.xrel);
      pitch_ = std::clamp(pitch_ - radians_per_pixel * static_cast<float>(event.motion.yrel), -most, most);
    }
  }

  void move(float seconds) {
    const Uint8* const held = SDL_GetKeyboardState(nullptr);
    const auto axis = [&](SDL_Scancode more, SDL_Scancode less) {
      return static_cast<float>(held[more]) - static_cast<float>(held[less]);
    };
    const float step = seconds * (held[SDL_SCANCODE_LSHIFT] != 0 ? 12.0f : 3.0f);
    const camera at = look(eye_, yaw_, pitch_, 1.0f);
    eye_ +=
        step * (axis(SDL_SCANCODE_W, SDL_SCANCODE_S) * at.forward + axis(SDL_SCANCODE_D, SDL_SCANCODE_A) * at.right +
                axis(SDL_SCANCODE_E, SDL_SCANCODE_Q) * glm::vec3(0.0f, 1.0f, 0.0f));
  }

 private:
  void press(SDL_Keycode key) {
    if (key == SDLK_ESCAPE) ended_ = true;
    if (key == SDLK_TAB) eye_ = eyes_[++at_ % eyes_.size()];
    if (key >= SDLK_1 && key <= SDLK_4) mode_ = static_cast<draw_mode>(key - SDLK_1);
  }

  std::vector<glm::vec3> eyes_;  // valid viewpoints
  std::size_t at_ = 0;
  glm::vec3 eye_{0.0f};
  float yaw_ = 0.0f, pitch_ = 0.0f;
  draw_mode mode_ = draw_mode::clusters;
  bool ended_ = false;
};

// ---- frames ----

void show_frame(window& shown, swapchain& chain, renderer& draws, const walker& who) {
  frame& f = draws.draw(who.view(chain.size()), who.mode());
  const std::optional<std::uint32_t> image = chain.acquire(f.acquired.get());
  bool is_current = image.has_value();
  if (image) {
    chain.record_copy(f.commands, draws.picture_target(), *image);
    draws.submit(f, f.acquired.get(), chain.drawn(*image));
    is_current = chain.present(*image);
  } else {
    draws.submit(f);
  }
  const VkExtent2D size = shown.size();  // not all drivers tell that the window has changed
  if (is_current && size.width == chain.size().width && size.height == chain.size().height) return;
  draws.finish();
  chain.recreate(size);
  draws.resize(chain.size());
}

void show_title(window& shown, draw_mode mode, const effort& sums) {
  const auto frames = static_cast<double>(std::max<std::uint64_t>(sums.frames, 1));
  shown.title(fmt::format("{} (1-4): {:.0f} draws, {:.0f} triangles, {:.3f} ms of the host per frame",
                          mode_names[static_cast<std::size_t>(mode)], static_cast<double>(sums.draws) / frames,
                          static_cast<double>(sums.triangles) / frames, sums.host_milliseconds / frames));
}

}  // namespace

std::uint32_t walk(const sightcell::scene::scene& s, const sightcell::db& db, const std::string& pvs_file,
                   const host_scene& host, visibility& visible, const walk_options& options) {
  window shown(options.width, options.height);
  const std::vector<const char*> extensions = shown.extensions();
  const instance vulkan(extensions, options.validates);
  {
    const surface on_screen(vulkan, shown);
    const device on(vulkan, on_screen.handle, options.may_count);
    swapchain chain(on, on_screen.handle, shown.size());
    renderer draws(on, s, host, visible, chain.size());
    walker who(db, pvs_file);
    using clock = std::chrono::steady_clock;
    clock::time_point last = clock::now(), titled = last;
    for (std::uint32_t drawn = 0; !who.ended() && (options.frames == 0 || drawn < options.frames); ++drawn) {
      who.take_events();
      const clock::time_point now = clock::now();
      who.move(std::chrono::duration<float>(now - last).count());
      last = now;
      if (shown.is_minimized()) {
        SDL_Delay(20);
        continue;
      }
      show_frame(shown, chain, draws, who);
      if (now - titled < std::chrono::milliseconds(500)) continue;
      show_title(shown, who.mode(), draws.take_effort());
      titled = now;
    }
    draws.finish();
    if (!options.screenshot.empty()) write_screenshot(options.screenshot, draws.picture_target().read_back(on));
    check(vkDeviceWaitIdle(on.get()), "vkDeviceWaitIdle");
  }
  return vulkan.validation_messages();
}

}  // namespace vulkan_host
