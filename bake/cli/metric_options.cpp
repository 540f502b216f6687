#include "metric_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace sightcell::cli {

void add_metric_options(CLI::App& verb, metric_options& options, const std::string& group) {
  const auto& names = bake::metric_names;
  verb.add_option("--metric", options.metric,
                  "what the error means: pixel (a ray from a free place, in any direction, is wrong), view (the same "
                  "where a picture looks, and what is missing is not too small for it) or color (by how much colors "
                  "differ)")
      ->type_name("NAME")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())))
      ->capture_default_str()
      ->group(group);
  bake::metric_settings& s = options.settings;
  const std::vector<CLI::Option*> of_view{
      verb.add_option("--view-resolution", options.resolution, "of view: pixels of the host's picture")
          ->delimiter('x')
          ->expected(2)
          ->type_name("WxH")
          ->default_str(fmt::format("{}x{}", s.view_width, s.view_height)),
      verb.add_option("--view-fov", s.view_fov, "of view: degrees from the picture's lower border to its upper one")
          ->type_name("DEGREES")
          ->capture_default_str(),
      verb.add_option("--view-pitch", options.pitch, "of view: degrees by which the camera looks down and up, at most")
          ->delimiter(',')
          ->expected(2)
          ->type_name("MIN,MAX")
          ->default_str(fmt::format("{},{}", s.view_pitch[0], s.view_pitch[1])),
      verb.add_option("--view-least", s.view_least,
                      "of view: a polygon counts from this part of the pixel in the picture's middle on")
          ->type_name("PART")
          ->capture_default_str()};
  for (CLI::Option* option : of_view) option->group(group);
  // Or who forgot --metric would take a pixel error for that of a view.
  verb.parse_complete_callback([of_view, &options] {
    for (const CLI::Option* option : of_view)
      if (option->count() > 0 && options.metric != "view")
        throw CLI::ValidationError(option->get_name(), "is of --metric view alone, and this is " + options.metric);
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
