#include "sightcell/picture/gl_context.h"

#include <string>
#include <thread>

#include "gl_test.h"

namespace {

using sightcell::picture::gl_context;
class gl_context_test : public sightcell::test::gl_test {};

TEST_F(gl_context_test, says_what_it_found) {
  EXPECT_FALSE(context().renderer().empty());
  EXPECT_NE(context().choice().find("EGL"), std::string::npos) << context().choice();
  EXPECT_NE(context().choice().find(context().software() ? "software" : "hardware"), std::string::npos);
  const bool llvmpipe = context().renderer().find("llvmpipe") != std::string::npos;
  EXPECT_TRUE(context().software() || !llvmpipe);
  EXPECT_NO_THROW(context().check("nothing"));
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

}  // namespace
