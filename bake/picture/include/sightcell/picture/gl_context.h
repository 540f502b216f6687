#pragma once
// A headless OpenGL 4.5 core context on EGL. Device choice: EGL devices are enumerated and one without
// EGL_MESA_device_software is preferred, then any other device, then the surfaceless platform, then a clear error.
// (Surfaceless first would silently pick the software rasteriser on a machine with a GPU.)
#include <memory>
#include <string>

namespace sightcell::picture {

class gl_context {
 public:
  // Makes the context and binds it to the calling thread. debug: KHR_debug messages of high severity throw at the next
  // check(). Throws sightcell::error "gl.no-context" saying what was tried.
  explicit gl_context(bool debug = false);
  // The same on hardware; null where there is none, or no EGL at all. A device that is known to be software is not
  // opened for this, so asking costs little.
  static std::unique_ptr<gl_context> on_hardware(bool debug = false);
  ~gl_context();
  gl_context(const gl_context&) = delete;
  gl_context& operator=(const gl_context&) = delete;

  void make_current() const;            // binds to the calling thread
  const std::string& renderer() const;  // GL_RENDERER
  const std::string& choice() const;    // how it was found, for logs: "EGL device 1 of 2, hardware"
  bool software() const;                // true on a software rasteriser such as llvmpipe
  // Throws sightcell::error when GL reported an error since the last check, "gl.lost" when the device was reset.
  void check(const char* where) const;
  // The second half of it, for the current context: what was read back from a device that was reset may be anything.
  static void require_device(const char* where);

 private:
  struct state;
  explicit gl_context(std::unique_ptr<state> made);
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::picture
