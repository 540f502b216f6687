#pragma once
// A linked GLSL program. For the rooms that draw on a gl_context of their own: no OpenGL header is needed to hold one.
#include <initializer_list>

namespace sightcell::picture {

class gl_program {
 public:
  struct stage {
    unsigned type;     // GL_VERTEX_SHADER, ...
    const char* text;  // GLSL, must outlive the call only
  };

  // Compiles and links on the current context. Throws sightcell::error "gl.shader" with the compiler's first lines.
  gl_program(const char* name, std::initializer_list<stage> stages);
  ~gl_program();
  gl_program(const gl_program&) = delete;
  gl_program& operator=(const gl_program&) = delete;

  unsigned id() const { return id_; }

 private:
  unsigned id_ = 0;
};

}  // namespace sightcell::picture
