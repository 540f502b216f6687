#pragma once
// Which hemicube source a bake uses: --source.
#include <memory>
#include <string>

#include "hemicube/hemicube_source.h"
#include "sightcell/bake/settings.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// A source and what has to live as long as it does.
struct chosen_source {
  std::string name;     // gpu, cpu, rays or none; with the device's, it decides the bytes of a bake
  std::string because;  // why auto took it; empty where the user named it
  std::unique_ptr<scene::world_geometry> both_sides;  // with all_double_sided, what is drawn
  std::unique_ptr<picture::gl_context> context;       // of gpu alone, current on the calling thread
  std::unique_ptr<hemicube_source> source;
};

// Makes the source that settings ask for. auto is gpu where EGL has a hardware device, else cpu. cpu and rays do not
// touch EGL, nor does none, which is taken whatever was asked for where the sampler looks with rays alone: it holds
// nothing and must not be asked; auto makes no context on a software rasteriser, and takes a machine without EGL as one
// without a GPU. geometry and rays must outlive what is returned. Throws sightcell::error: "gl.no-context" where gpu
// was asked for and there is no OpenGL; what the sources throw.
chosen_source choose_source(const settings& how, const scene::world_geometry& geometry, const ray_scene& rays);

}  // namespace sightcell::bake
