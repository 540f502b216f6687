#pragma once
// A linked GLSL program, for code that draws on a gl_context. No OpenGL header is needed to hold one.
#include <initializer_list>

namespace sightcell::picture {

class gl_program {
 public:
  struct stage {
    unsigned type;     // GL_VERTEX_SHADER, ...
    const char* text;  // GLSL; read during the constructor
  };

  // Compiles and links on the current context.
  // name: for messages.
  // Fails with gl.shader; the line has the first lines of the compiler.
  gl_program(const char* name, std::initializer_list<stage> stages);

  // Deletes the program; the same context must be current.
  ~gl_program();
  gl_program(const gl_program&) = delete;
  gl_program& operator=(const gl_program&) = delete;

  // Returns the OpenGL name of the program.
  unsigned id() const { return id_; }

 private:
  unsigned id_ = 0;
};

}  // namespace sightcell::picture
