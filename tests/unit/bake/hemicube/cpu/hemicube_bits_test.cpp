// Hemicubes have the same bits with every instruction set and on every machine: those that are written down here.
#include <gtest/gtest.h>

#include <bit>

#include "hemicube/cpu/cpu_source.h"
#include "platforms/fnv_hash.h"
#include "unit/bake/hemicube/cpu/rubble.h"

namespace {

namespace bake = sightcell::bake;
using sightcell::test::fnv_hash;

void add(fnv_hash& hash, const bake::hemicube_view& view) {
  for (const bake::seen_polygon& p : view.seen)
    for (const std::uint32_t number : {p.id, p.pixels, p.pixel}) hash.add(number);
  for (const double sum : view.importance) {
    const auto bits = std::bit_cast<std::uint64_t>(sum);
    hash.add(static_cast<std::uint32_t>(bits));
    hash.add(static_cast<std::uint32_t>(bits >> 32));
  }
}

void add(fnv_hash& hash, const bake::hemicube_image& image) {
  for (const std::uint32_t id : image.ids) hash.add(id);
  for (const float depth : image.inverse_depths) hash.add(std::bit_cast<std::uint32_t>(depth));
}

struct pinned {
  std::uint32_t resolution;
  std::uint64_t views, images;
};

TEST(hemicube_bits, are_the_same_everywhere) {
  const auto world = sightcell::test::rubble();
  for (const bake::cpu_instructions set : bake::available_instructions())
    for (const pinned& wanted :
         {pinned{16, 0x4FE2EEA6CCA29C0C, 0x113FF23559048B9E}, pinned{50, 0x13BFD8EC0CA1EACB, 0xF4F458498546FC5F},
          pinned{202, 0xDF8AB9767603A29B, 0x96301EA14D06129C}}) {
      const auto source = bake::make_cpu_source(world, {wanted.resolution, 70.0f, set});
      fnv_hash views, images;
      for (const bake::pose& where : sightcell::test::rubble_poses()) {
        bake::hemicube_view view;
        source->render(where, view);
        add(views, view);
        bake::hemicube_image image;
        source->render_image(where, image);
        add(images, image);
      }
      EXPECT_EQ(views.value(), wanted.views) << source->device() << ", " << wanted.resolution;
      EXPECT_EQ(images.value(), wanted.images) << source->device() << ", " << wanted.resolution;
    }
}

}  // namespace
