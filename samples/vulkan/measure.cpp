#include "measure.h"

#include <algorithm>
#include <numbers>

#include "compare.h"
#include "cpu_time.h"
#include "sightcell/base/error.h"

namespace vulkan_host {
namespace {

constexpr std::array all_modes = {draw_mode::everything, draw_mode::frustum, draw_mode::commands, draw_mode::clusters};

// All views as frames one behind the other.
result time_mode(renderer& draws, const std::vector<camera>& views, draw_mode mode) {
  draws.submit(draws.draw(views.front(), mode));  // drivers compile at the first use
  draws.finish();
  static_cast<void>(draws.take_effort());
  const double begin = process_milliseconds();
  for (const camera& view : views) draws.submit(draws.draw(view, mode));
  draws.finish();
  return {.mode = mode, .sums = draws.take_effort(), .cpu_milliseconds = process_milliseconds() - begin};
}

picture draw_picture(const device& on, renderer& draws, const camera& view, draw_mode mode) {
  draws.submit(draws.draw(view, mode));
  draws.finish();
  return draws.picture_target().read_back(on);
}

}  // namespace

std::vector<camera> find_views(const sightcell::db& db, const std::string& file, std::uint32_t cells,
                               std::uint32_t headings, float aspect) {
  std::vector<camera> out;
  const std::uint64_t all = db.cell_count(), wanted = std::min<std::uint64_t>(cells, all);
  for (std::uint64_t i = 0; i < wanted; ++i) {
    const auto eye = db.cell_eye(static_cast<std::uint32_t>(i * all / wanted));
    if (!eye) continue;
    for (std::uint32_t h = 0; h < headings; ++h) {
      const float yaw = 2.0f * std::numbers::pi_v<float> * static_cast<float>(h) / static_cast<float>(headings);
      out.push_back(look({(*eye)[0], (*eye)[1], (*eye)[2]}, yaw, 0.0f, aspect));
    }
  }
  if (!out.empty()) return out;
  throw sightcell::error(sightcell::error_kind::bad_input, "vulkan.no-viewpoint", file, "has no valid viewpoints",
                         "bake it again");
}

std::vector<result> measure(const device& on, renderer& draws, const std::vector<camera>& views) {
  std::vector<result> out;
  for (const draw_mode mode : all_modes) out.push_back(time_mode(draws, views, mode));
  for (const camera& view : views) {
    const picture reference = draw_picture(on, draws, view, draw_mode::everything);
    for (result& r : out) {
      const difference d = compare(reference, draw_picture(on, draws, view, r.mode));
      r.wrong += d.wrong;
      r.ties += d.ties;
      r.pixels += reference.depths.size();
    }
  }
  return out;
}

}  // namespace vulkan_host
