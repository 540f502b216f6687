#pragma once
// Chooses the hemicube source of a bake (option --source).
#include <memory>
#include <string>

#include "hemicube/hemicube_source.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// A source and the objects that it refers to.
struct chosen_source {
  std::string name;     // gpu, cpu, rays or none; the bytes of a bake depend on it and on the device
  std::string because;  // the reason for the choice of auto; empty where the user named the source
  std::unique_ptr<scene::world_geometry> both_sides;  // the geometry that is drawn, with all_double_sided
  std::unique_ptr<hemicube_source> source;
};

// Makes the source that the settings name. auto is gpu where EGL has a hardware device, otherwise cpu; it makes no
// context on a software rasterizer, and treats a machine without EGL as one without a GPU. A sampler that uses rays
// only gets the source none whatever the settings name, and must not render with it. cpu, rays and none do not use EGL.
// geometry and rays must outlive the result. Throws sightcell::error: "gl.no-context" where gpu is named and there is
// no OpenGL; the errors of the sources.
chosen_source choose_source(const settings& how, const scene::world_geometry& geometry, const ray_scene& rays);

}  // namespace sightcell::bake
