#include "sightcell/picture/gl_context.h"

#include <epoxy/gl.h>

#include <string>
#include <thread>

#include "errors/error_id.h"
#include "gl_test.h"
#include "sightcell/picture/gl_program.h"

namespace {

using sightcell::picture::gl_context;
using sightcell::test::error_id;
class gl_context_test : public sightcell::test::gl_test {};

TEST_F(gl_context_test, says_what_it_found) {
  EXPECT_FALSE(context().renderer().empty());
  EXPECT_NE(context().choice().find("EGL"), std::string::npos) << context().choice();
  EXPECT_NE(context().choice().find(context().software() ? "software" : "hardware"), std::string::npos);
  const bool llvmpipe = context().renderer().find("llvmpipe") != std::string::npos;
  EXPECT_TRUE(context().software() || !llvmpipe);
  EXPECT_NO_THROW(context().check("nothing"));
}

TEST_F(gl_context_test, is_made_on_hardware_only_when_asked_so) {
  const auto hardware = gl_context::on_hardware(true);
  EXPECT_EQ(hardware == nullptr, context().software()) << "hardware is preferred anyway";
  if (!hardware) return;
  EXPECT_FALSE(hardware->software());
  EXPECT_EQ(hardware->renderer(), context().renderer());
}

TEST_F(gl_context_test, lives_beside_another_and_after_it) {
  {
    const gl_context other;
    EXPECT_EQ(other.renderer(), context().renderer());
    EXPECT_NO_THROW(other.check("other"));
  }
  context().make_current();
  EXPECT_NO_THROW(context().check("after the other"));
}

TEST_F(gl_context_test, can_be_made_and_used_on_another_thread) {
  std::string renderer, problem;
  std::thread([&] {
    try {
      const gl_context own;
      own.make_current();
      own.check("thread");
      renderer = own.renderer();
    } catch (const std::exception& e) {
      problem = e.what();
    }
  }).join();
  EXPECT_EQ(problem, "");
  EXPECT_EQ(renderer, context().renderer());
}

TEST_F(gl_context_test, cannot_be_bound_where_another_thread_holds_it) {
  std::string id;
  context().make_current();
  std::thread([&] { id = error_id([&] { context().make_current(); }); }).join();
  EXPECT_EQ(id, "gl.bind");
}

TEST_F(gl_context_test, what_opengl_refuses_is_told_once) {
  context().make_current();
  glEnable(0xFFFF);
  EXPECT_EQ(error_id([&] { context().check("a test"); }), "gl.error");
  EXPECT_EQ(error_id([&] { context().check("a test"); }), "");
}

// A context can hardly be lost on purpose; the driver's word for it can be played.
TEST_F(gl_context_test, a_device_that_was_reset_is_told_by_name) {
  context().make_current();
  EXPECT_NO_THROW(gl_context::require_device("a test"));
  const auto driver = epoxy_glGetGraphicsResetStatus;
  epoxy_glGetGraphicsResetStatus = []() -> GLenum { return GL_UNKNOWN_CONTEXT_RESET; };
  EXPECT_EQ(error_id([&] { gl_context::require_device("a test"); }), "gl.lost");
  glEnable(0xFFFF);
  EXPECT_EQ(error_id([&] { context().check("a test"); }), "gl.lost") << "before anything else that is wrong";
  epoxy_glGetGraphicsResetStatus = driver;
  EXPECT_EQ(error_id([&] { context().check("a test"); }), "gl.error");
  EXPECT_NO_THROW(context().check("a test"));
}

TEST_F(gl_context_test, a_program_that_does_not_compile_or_link_is_refused) {
  context().make_current();
  const auto make = [](const char* text) {
    return error_id([&] { const sightcell::picture::gl_program program("test", {{GL_VERTEX_SHADER, text}}); });
  };
  EXPECT_EQ(make("#version 450\nvoid main() { gl_Position = vec4(0); }"), "");
  EXPECT_EQ(make("#version 450\nvoid main() { nonsense; }"), "gl.shader");
  EXPECT_EQ(make("#version 450\nvoid other(); void main() { other(); }"), "gl.shader");
}

}  // namespace
