#include "importer.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>

#include "host_error.h"

namespace ogre_host {
namespace {

void add_draws(const aiNode* node, imported_scene& out) {
  for (unsigned i = 0; i < node->mNumMeshes; ++i) {
    if (out.hashes[node->mMeshes[i]] != 0) out.draws.push_back({node, node->mMeshes[i]});
  }
  for (unsigned i = 0; i < node->mNumChildren; ++i) add_draws(node->mChildren[i], out);
}

imported_scene import(const std::string& file, unsigned flags) {
  imported_scene out;
  out.importer = std::make_unique<Assimp::Importer>();
  out.importer->SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  out.importer->SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 40.0f);  // degrees
  out.scene = out.importer->ReadFile(file, flags);
  if (out.scene == nullptr) {
    throw host_error("ogre.import", file, std::string("Assimp cannot read it: ") + out.importer->GetErrorString(),
                     "name a .glb or .gltf file");
  }
  out.indices.resize(out.scene->mNumMeshes);
  out.hashes.resize(out.scene->mNumMeshes);
  for (unsigned m = 0; m < out.scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *out.scene->mMeshes[m];
    for (const aiFace* f = mesh.mFaces; f != mesh.mFaces + mesh.mNumFaces; ++f) {
      if (f->mNumIndices == 3) out.indices[m].insert(out.indices[m].end(), f->mIndices, f->mIndices + 3);
    }
    if (!out.indices[m].empty()) out.hashes[m] = sightcell::hosts::geometry_hash(out.triangles(m)).value_or(0);
  }
  add_draws(out.scene->mRootNode, out);
  return out;
}

}  // namespace

sightcell::hosts::triangle_list imported_scene::triangles(std::uint32_t mesh) const {
  const aiMesh& m = *scene->mMeshes[mesh];
  return {{&m.mVertices->x, 3 * std::size_t{m.mNumVertices}}, 3, indices[mesh]};
}

imported_scene import_for_drawing(const std::string& file) {
  return import(file, (aiProcessPreset_TargetRealtime_Quality & ~aiProcess_CalcTangentSpace) | aiProcess_FlipUVs);
}

imported_scene import_as_stored(const std::string& file) {
  return import(file, 0);
}

}  // namespace ogre_host
