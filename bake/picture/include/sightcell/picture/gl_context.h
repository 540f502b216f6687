#pragma once
// A headless OpenGL 4.5 core context on EGL.
//
// DEVICES. EGL devices are enumerated. One without EGL_MESA_device_software is preferred, then any other device, then
// the surfaceless platform. Asking for the surfaceless platform first would give the software rasterizer on a machine
// with a GPU.
//
// THREADS. A context is current on one thread at a time. All members but renderer, choice and software need it current
// on the calling thread; make_current moves it there.
//
// FAILURES. Functions throw sightcell::error with an id gl.*.
#include <memory>
#include <string>

namespace sightcell::picture {

class gl_context {
 public:
  // Creates a context and makes it current on the calling thread.
  // debug: messages of KHR_debug with high severity fail at the next check().
  // Fails with gl.no-context, which lists what was tried, and gl.bind.
  explicit gl_context(bool debug = false);

  // As the constructor, on a hardware device only.
  // Returns null if there is none, or no EGL.
  // Cost: little without hardware: known software devices are not opened.
  static std::unique_ptr<gl_context> on_hardware(bool debug = false);

  ~gl_context();
  gl_context(const gl_context&) = delete;
  gl_context& operator=(const gl_context&) = delete;

  // Makes the context current on the calling thread. Fails with gl.bind.
  void make_current() const;
  // Unbinds the context from the calling thread, so that another one can make it current.
  void release() const;

  // Returns GL_RENDERER.
  const std::string& renderer() const;

  // Returns how the device was found, for logs: "EGL device 1 of 2, hardware".
  const std::string& choice() const;

  // Returns whether it is a software rasterizer such as llvmpipe.
  bool software() const;

  // Checks for errors of OpenGL since the last check.
  // where: for the message.
  // Fails with gl.error, and gl.lost when the device was reset.
  void check(const char* where) const;

  // Checks that the device of the current context was not reset: after a reset, data that was read back is undefined.
  // Fails with gl.lost.
  static void require_device(const char* where);

 private:
  struct state;
  explicit gl_context(std::unique_ptr<state> made);
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::picture
