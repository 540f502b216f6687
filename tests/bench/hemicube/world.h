#pragma once
// A scene as the hemicube sources want it, and the sources by name.
#include <memory>
#include <string>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bench {

struct world {
  world() = default;
  explicit world(const std::string& path);
  std::string name;
  scene::world_geometry geometry;
  float far_plane = 1.0f;  // the diagonal of the box, as in a bake
  std::uint32_t polygons() const { return static_cast<std::uint32_t>(geometry.kinds.size()); }
};

const std::vector<std::string>& source_names();
// The rasterizer with one instruction set, for example cpu-sse4. cpu is the fastest of them.
std::vector<std::string> kernel_names();

struct named_source {
  std::string name;
  std::unique_ptr<picture::gl_context> context;  // of gpu alone
  std::unique_ptr<bake::hemicube_source> source;
  bool software() const { return !context || context->software(); }
};

// w must outlive the source. culling: of gpu, "frustum" or "occlusion", or empty for the source's own choice. Throws
// sightcell::error where the device is not there.
named_source make_source(const std::string& name, const world& w, std::uint32_t resolution,
                         const std::string& culling = "");

}  // namespace sightcell::bench
