#pragma once
// The materials of an imported scene in OGRE: base color, alpha mask or blending, sides.
#include <Ogre.h>
#include <assimp/scene.h>

#include <vector>

namespace ogre_host {

std::vector<Ogre::MaterialPtr> make_materials(const aiScene& scene);

}  // namespace ogre_host
