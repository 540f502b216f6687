#include "sightcell/picture/gl_context.h"

// epoxy has its own EGL and GL headers and must be included before any other.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "bundled_driver.h"
#include "sightcell/base/error.h"

namespace sightcell::picture {
namespace {

bool has_word(const char* list, const char* word) {
  const std::size_t length = std::strlen(word);
  for (const char* at = list; at != nullptr && (at = std::strstr(at, word)) != nullptr; at += length) {
    const bool starts = at == list || at[-1] == ' ';
    if (starts && (at[length] == ' ' || at[length] == '\0')) return true;
  }
  return false;
}

bool is_software_renderer(const std::string& name) {
  for (const char* software : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software Rasterizer"}) {
    if (name.find(software) != std::string::npos) return true;
  }
  return false;
}

// A way to open a display; they are tried in order.
struct candidate {
  EGLenum platform = 0;
  void* native = nullptr;
  bool marked_software = false;
  std::string name;
};

std::vector<candidate> list_candidates() {
  std::vector<candidate> devices, software_devices;
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (has_word(client, "EGL_EXT_platform_device") &&
      (has_word(client, "EGL_EXT_device_enumeration") || has_word(client, "EGL_EXT_device_base"))) {
    std::array<EGLDeviceEXT, 64> found{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(found.size()), found.data(), &count) == EGL_FALSE) count = 0;
    for (EGLint i = 0; i < count; ++i) {
      EGLDeviceEXT device = found[static_cast<std::size_t>(i)];
      const bool software = has_word(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
      candidate c{EGL_PLATFORM_DEVICE_EXT, device, software,
                  "EGL device " + std::to_string(i + 1) + " of " + std::to_string(count)};
      (software ? software_devices : devices).push_back(c);
    }
  }
  std::vector<candidate> all = devices;
  all.insert(all.end(), software_devices.begin(), software_devices.end());
  if (has_word(client, "EGL_MESA_platform_surfaceless")) {
    all.push_back({EGL_PLATFORM_SURFACELESS_MESA, nullptr, true, "EGL surfaceless platform"});
  }
  return all;
}

struct made_context {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string renderer;
};

// Creates a context that reports a reset of its device, if the driver supports that. Without the report, data read
// back after a reset may be anything.
EGLContext create_context(EGLDisplay display, EGLConfig config, bool debug) {
  const std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                       4,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       5,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_CONTEXT_OPENGL_DEBUG,
                                       debug ? EGL_TRUE : EGL_FALSE,
                                       EGL_NONE};
  std::vector<EGLint> telling{EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET};
  telling.insert(telling.end(), attributes.begin(), attributes.end());
  const EGLContext made = eglCreateContext(display, config, EGL_NO_CONTEXT, telling.data());
  return made != EGL_NO_CONTEXT ? made : eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
}

// Tries one candidate; on success the context is current. The display stays initialized in any case: EGL returns the
// same display to all code in the process, and terminating it would end the contexts of other code.
bool try_candidate(const candidate& c, bool debug, made_context& made, std::string& why_not) {
  made.display = eglGetPlatformDisplayEXT(c.platform, c.native, nullptr);
  if (made.display == EGL_NO_DISPLAY || eglInitialize(made.display, nullptr, nullptr) == EGL_FALSE) {
    why_not = "cannot be opened";
    return false;
  }
  if (!epoxy_has_egl_extension(made.display, "EGL_KHR_surfaceless_context") ||
      eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
    why_not = "has no OpenGL without a window";
    return false;
  }
  EGLConfig config = EGL_NO_CONFIG_KHR;
  if (!epoxy_has_egl_extension(made.display, "EGL_KHR_no_config_context")) {
    const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLint count = 0;
    if (eglChooseConfig(made.display, wanted, &config, 1, &count) == EGL_FALSE || count < 1) {
      why_not = "has no configuration for OpenGL";
      return false;
    }
  }
  made.context = create_context(made.display, config, debug);
  if (made.context == EGL_NO_CONTEXT) {
    why_not = "has no OpenGL 4.5 core";
    return false;
  }
  if (eglMakeCurrent(made.display, EGL_NO_SURFACE, EGL_NO_SURFACE, made.context) == EGL_FALSE) {
    eglDestroyContext(made.display, made.context);
    why_not = "cannot be bound";
    return false;
  }
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  made.renderer = name != nullptr ? name : "unknown";
  return true;
}

void drop(const made_context& made) {
  eglMakeCurrent(made.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(made.display, made.context);
}

enum class devices { hardware, all };

// Chooses hardware first. A device that is not marked as software can still use a software rasterizer if its driver
// is missing. Such contexts are chosen only if there is no hardware.
bool choose(devices wanted, bool debug, made_context& made, candidate& chosen, std::string& tried) {
  const std::vector<candidate> all = list_candidates();
  for (const bool take_software : {false, true}) {
    if (take_software && wanted == devices::hardware) break;
    for (const candidate& c : all) {
      if (c.marked_software && !take_software) continue;
      std::string why_not;
      if (!try_candidate(c, debug, made, why_not)) {
        if (take_software) tried += (tried.empty() ? "" : ", ") + c.name + " " + why_not;
        continue;
      }
      if (take_software || !is_software_renderer(made.renderer)) {
        chosen = c;
        return true;
      }
      drop(made);
    }
  }
  if (all.empty()) tried = "EGL offers neither devices nor the surfaceless platform";
  return false;
}

}  // namespace

struct gl_context::state {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  std::string renderer, choice;
  bool software = false;
  std::string first_message;  // of high severity, since the last check

  static std::unique_ptr<state> make(devices wanted, bool debug, std::string& tried);
};

namespace {

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

void APIENTRY on_debug_message(GLenum, GLenum, GLuint, GLenum severity, GLsizei, const GLchar* text, const void* user) {
  if (severity != GL_DEBUG_SEVERITY_HIGH) return;
  auto* message = static_cast<std::string*>(const_cast<void*>(user));
  if (message->empty()) *message = text;
}

}  // namespace

// Returns null if there is no context on such a device; `tried` then lists the attempts.
std::unique_ptr<gl_context::state> gl_context::state::make(devices wanted, bool debug, std::string& tried) {
  offer_bundled_driver();
  tried = "libEGL is not installed";
  if (!epoxy_has_egl()) return nullptr;
  tried.clear();
  made_context made;
  candidate chosen;
  if (!choose(wanted, debug, made, chosen, tried)) {
    tried = "no headless context: " + tried;
    return nullptr;
  }
  auto state = std::make_unique<gl_context::state>();
  state->display = made.display;
  state->context = made.context;
  state->renderer = made.renderer;
  state->software = chosen.marked_software || is_software_renderer(made.renderer);
  state->choice = chosen.name + (state->software ? ", software" : ", hardware");
  if (debug) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_debug_message, &state->first_message);
  }
  return state;
}

gl_context::gl_context(bool debug) {
  std::string tried;
  state_ = state::make(devices::all, debug, tried);
  if (!state_)
    throw error(error_kind::failed, "gl.no-context", "OpenGL", tried,
                "install a driver with OpenGL 4.5 for EGL, for example Mesa's (libegl-mesa0, libgl1-mesa-dri)");
}

gl_context::gl_context(std::unique_ptr<state> made) : state_(std::move(made)) {}

std::unique_ptr<gl_context> gl_context::on_hardware(bool debug) {
  std::string tried;
  auto made = state::make(devices::hardware, debug, tried);
  if (!made) return nullptr;
  return std::unique_ptr<gl_context>(new gl_context(std::move(made)));
}

gl_context::~gl_context() {
  if (eglGetCurrentContext() == state_->context) {
    eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }
  eglDestroyContext(state_->display, state_->context);
}

void gl_context::make_current() const {
  // The API is chosen per thread.
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE ||
      eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->context) == EGL_FALSE) {
    throw error(error_kind::failed, "gl.bind", "OpenGL", "the context cannot be bound to this thread",
                "unbind it from the thread that holds it first");
  }
}

void gl_context::release() const {
  eglBindAPI(EGL_OPENGL_API);
  eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

const std::string& gl_context::renderer() const {
  return state_->renderer;
}

const std::string& gl_context::choice() const {
  return state_->choice;
}

bool gl_context::software() const {
  return state_->software;
}

namespace {

[[noreturn]] void fail_lost(const char* where, const char* why) {
  throw error(error_kind::failed, "gl.lost", std::string("OpenGL in ") + where,
              std::string("the graphics device was lost: ") + why,
              "run the same command again: a bake resumes; if the device is lost again, bake with --source cpu");
}

}  // namespace

void gl_context::require_device(const char* where) {
  const GLenum reset = glGetGraphicsResetStatus();
  if (reset == GL_GUILTY_CONTEXT_RESET) fail_lost(where, "it was reset because of what it was drawing");
  if (reset == GL_INNOCENT_CONTEXT_RESET) fail_lost(where, "it was reset because of another program");
  if (reset != GL_NO_ERROR) fail_lost(where, "it was reset");
}

void gl_context::check(const char* where) const {
  require_device(where);
  const GLenum code = glGetError();
  // Each kind of error has its own flag. The loop is limited because a lost context may report errors without end.
  for (int i = 0; code != GL_NO_ERROR && i < 16 && glGetError() != GL_NO_ERROR; ++i) {
  }
  std::string message;
  message.swap(state_->first_message);
  if (code == GL_NO_ERROR && message.empty()) return;
  if (code == GL_CONTEXT_LOST) fail_lost(where, "the context reports a loss");
  const char* name = code == GL_OUT_OF_MEMORY   ? "out of memory"
                     : code == GL_INVALID_ENUM  ? "invalid enum"
                     : code == GL_INVALID_VALUE ? "invalid value"
                     : code == GL_NO_ERROR      ? "driver message"
                                                : "invalid operation";
  throw error(error_kind::failed, "gl.error", std::string("OpenGL in ") + where,
              name + (message.empty() ? std::string() : ": " + one_line(message)),
              "report this with the renderer's name, " + state_->renderer);
}

}  // namespace sightcell::picture
