#include "metric_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "help.h"
#include "one_of.h"

namespace sightcell::cli {

void add_metric_options(CLI::App& verb, metric_options& options, const std::string& group) {
  add_option(verb, group, "--metric", options.metric, "NAME",
             "The error that bounds are about: pixel (rays in all directions, each miss counts), view (rays in the "
             "directions that a given camera shows; misses that are too small there do not count) or color (mean "
             "difference of colors, 0 to 1).")
      ->check(one_of(bake::metric_names));
  bake::metric_settings& s = options.settings;
  const std::vector<CLI::Option*> of_view{
      add_plain_option(verb, group, "--view-resolution", options.resolution, "WxH",
                       "With --metric view: pixels of the host's picture. Range: 16 to 65536.")
          ->delimiter('x')
          ->expected(2)
          ->default_str(fmt::format("{}x{}", s.view_width, s.view_height)),
      add_option(verb, group, "--view-fov", s.view_fov, "DEGREES",
                 "With --metric view: vertical field of view in degrees. Range: 1 to 170."),
      add_plain_option(verb, group, "--view-pitch", options.pitch, "MIN,MAX",
                       "With --metric view: how far the camera turns down and up, in degrees. It turns freely to the "
                       "sides and does not roll. Range: -90 to 90.")
          ->delimiter(',')
          ->expected(2)
          ->default_str(fmt::format("{},{}", s.view_pitch[0], s.view_pitch[1])),
      add_option(verb, group, "--view-least", s.view_least, "X",
                 "With --metric view: smallest polygon that counts. Its solid angle as a multiple of that of the "
                 "pixel in the middle of the picture. Range: 0 to 1e6.")};
  // A user who forgot --metric would take a pixel error for that of a view.
  verb.parse_complete_callback([of_view, &options] {
    for (const CLI::Option* option : of_view)
      if (option->count() > 0 && options.metric != "view")
        throw CLI::ValidationError(option->get_name(), "is for --metric view, and the metric is " + options.metric);
  });
}

bake::metric_settings metric_of(const metric_options& options) {
  bake::metric_settings how = options.settings;
  const auto& names = bake::metric_names;
  how.kind = static_cast<bake::metric_kind>(
      std::distance(names.begin(), std::find(names.begin(), names.end(), options.metric)));
  how.view_width = options.resolution.at(0);
  how.view_height = options.resolution.at(1);
  std::copy_n(options.pitch.begin(), how.view_pitch.size(), how.view_pitch.begin());
  bake::validate_metric(how);
  return how;
}

std::string error_name(std::string_view metric) {
  return fmt::format("{} error", metric);
}

std::string error_name(const bake::metric_settings& how) {
  return error_name(bake::metric_names[static_cast<std::size_t>(how.kind)]);
}

}  // namespace sightcell::cli
