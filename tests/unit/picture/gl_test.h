#pragma once
// Tests that draw: skipped, with the reason, where no context can be made.
#include <gtest/gtest.h>

#include <memory>

#include "sightcell/base/error.h"
#include "sightcell/picture/gl_context.h"

namespace sightcell::test {

class gl_test : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = std::make_unique<picture::gl_context>(true);
    } catch (const error& e) {
      GTEST_SKIP() << e.what();
    }
    RecordProperty("renderer", context_->renderer());  // for tests/gl_drivers
  }
  const picture::gl_context& context() const { return *context_; }

 private:
  std::unique_ptr<picture::gl_context> context_;
};

}  // namespace sightcell::test
