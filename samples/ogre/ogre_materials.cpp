#include "ogre_materials.h"

#include <assimp/GltfMaterial.h>

#include <string>

namespace ogre_host {
namespace {

// A texture of the .glb, or nothing where it is in a file of its own or OGRE cannot decode it.
Ogre::TexturePtr load_texture(const aiScene& scene, const std::string& name, bool mipmaps) {
  const aiTexture* const stored = scene.GetEmbeddedTexture(name.c_str());
  if (stored == nullptr || stored->mHeight != 0) return nullptr;
  const std::string own_name = name + (mipmaps ? "" : " without mipmaps");
  auto& textures = Ogre::TextureManager::getSingleton();
  if (auto loaded = textures.getByName(own_name, Ogre::RGN_DEFAULT)) return loaded;
  try {
    Ogre::Image image;
    image.load(Ogre::DataStreamPtr(new Ogre::MemoryDataStream(stored->pcData, stored->mWidth)), stored->achFormatHint);
    return textures.loadImage(own_name, Ogre::RGN_DEFAULT, image, Ogre::TEX_TYPE_2D, mipmaps ? Ogre::MIP_UNLIMITED : 0,
                              1.0f, false, Ogre::PF_UNKNOWN, true);  // sRGB
  } catch (const Ogre::Exception&) {
    return nullptr;
  }
}

Ogre::MaterialPtr make_material(const aiScene& scene, unsigned number) {
  const aiMaterial& from = *scene.mMaterials[number];
  const Ogre::MaterialPtr out =
      Ogre::MaterialManager::getSingleton().create("material " + std::to_string(number), Ogre::RGN_DEFAULT);
  Ogre::Pass& pass = *out->getTechnique(0)->getPass(0);
  aiColor4D color(1, 1, 1, 1);
  from.Get(AI_MATKEY_BASE_COLOR, color);
  pass.setDiffuse(color.r, color.g, color.b, color.a);
  pass.setAmbient(color.r, color.g, color.b);
  pass.setNormaliseNormals(true);
  int two_sided = 0;
  from.Get(AI_MATKEY_TWOSIDED, two_sided);
  if (two_sided != 0) pass.setCullingMode(Ogre::CULL_NONE);
  aiString alpha_mode("OPAQUE"), texture;
  from.Get(AI_MATKEY_GLTF_ALPHAMODE, alpha_mode);
  const bool masked = alpha_mode == aiString("MASK");
  if (masked) {
    float cutoff = 0.5f;
    from.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff);
    pass.setAlphaRejectSettings(Ogre::CMPF_GREATER_EQUAL, static_cast<unsigned char>(255.0f * cutoff));
  } else if (alpha_mode == aiString("BLEND")) {
    pass.setSceneBlending(Ogre::SBT_TRANSPARENT_ALPHA);
    pass.setDepthWriteEnabled(false);
  }
  if (from.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == aiReturn_SUCCESS) {
    // Smaller versions of a mask have fewer opaque texels: what is behind would show where the bake has it occluded.
    if (const auto loaded = load_texture(scene, texture.C_Str(), !masked)) {
      pass.createTextureUnitState()->setTexture(loaded);
    }
  }
  return out;
}

}  // namespace

std::vector<Ogre::MaterialPtr> make_materials(const aiScene& scene) {
  std::vector<Ogre::MaterialPtr> out;
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) out.push_back(make_material(scene, m));
  return out;
}

}  // namespace ogre_host
