#include "sampler/face_sampler.h"

#include <gtest/gtest.h>

#include "errors/error_id.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

TEST(face_sampler, unknown_name_is_an_error) {
  EXPECT_EQ(test::error_id([] {
              make_face_sampler({.sampler = "best", .samples = 1}, {1, 1}, random_stream(1, 1, purpose::boundary));
            }),
            "settings.out-of-range");
}

}  // namespace
}  // namespace sightcell::bake
