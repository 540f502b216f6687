#include "sightcell/picture/gl_program.h"

#include <epoxy/gl.h>

#include <string>

#include "sightcell/base/error.h"

namespace sightcell::picture {
namespace {

[[noreturn]] void fail(const char* name, std::string log) {
  for (char& c : log) {
    if (c == '\n' || c == '\r' || c == '\0') c = ' ';
  }
  throw error(error_kind::failed, "gl.shader", std::string("shader ") + name, "the driver rejected it: " + log,
              "report this with the name of your graphics driver");
}

std::string shader_log(GLuint shader) {
  char text[500] = {};
  glGetShaderInfoLog(shader, sizeof text - 1, nullptr, text);
  return text;
}

std::string program_log(GLuint program) {
  char text[500] = {};
  glGetProgramInfoLog(program, sizeof text - 1, nullptr, text);
  return text;
}

}  // namespace

gl_program::gl_program(const char* name, std::initializer_list<stage> stages) : id_(glCreateProgram()) {
  for (const stage& s : stages) {
    const GLuint shader = glCreateShader(s.type);
    glShaderSource(shader, 1, &s.text, nullptr);
    glCompileShader(shader);
    glAttachShader(id_, shader);
    glDeleteShader(shader);  // deleted with the program
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled != GL_TRUE) {
      const std::string log = shader_log(shader);
      glDeleteProgram(id_);
      fail(name, log);
    }
  }
  glLinkProgram(id_);
  GLint linked = GL_FALSE;
  glGetProgramiv(id_, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    const std::string log = program_log(id_);
    glDeleteProgram(id_);
    fail(name, log);
  }
}

gl_program::~gl_program() {
  glDeleteProgram(id_);
}

}  // namespace sightcell::picture
