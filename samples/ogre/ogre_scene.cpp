#include "ogre_scene.h"

#include <string>

#include "ogre_materials.h"

namespace ogre_host {

ogre_scene::ogre_scene(Ogre::SceneManager& manager, const imported_scene& from)
    : manager_(manager), from_(from), materials_(make_materials(*from.scene)) {
  for (unsigned m = 0; m < from.scene->mNumMeshes; ++m) add_mesh(*from.scene->mMeshes[m], from.indices[m]);
  add_node(from.scene->mRootNode, manager.getRootSceneNode());
  for (const imported_draw& d : from.draws) add_entity(d);
}

void ogre_scene::add_mesh(const aiMesh& mesh, const std::vector<std::uint32_t>& indices) {
  shared_mesh& out = meshes_.emplace_back();
  if (indices.empty()) return;
  std::vector<float> vertices;
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D position = mesh.mVertices[v];
    const aiVector3D normal = mesh.HasNormals() ? mesh.mNormals[v] : aiVector3D(0, 1, 0);
    const aiVector3D uv = mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][v] : aiVector3D();
    vertices.insert(vertices.end(), {position.x, position.y, position.z, normal.x, normal.y, normal.z, uv.x, uv.y});
    out.box.merge(Ogre::Vector3(position.x, position.y, position.z));
  }
  auto& buffers = Ogre::HardwareBufferManager::getSingleton();
  out.vertices = std::make_unique<Ogre::VertexData>();
  out.vertices->vertexCount = mesh.mNumVertices;
  std::size_t offset = 0;
  Ogre::VertexDeclaration& format = *out.vertices->vertexDeclaration;
  offset += format.addElement(0, offset, Ogre::VET_FLOAT3, Ogre::VES_POSITION).getSize();
  offset += format.addElement(0, offset, Ogre::VET_FLOAT3, Ogre::VES_NORMAL).getSize();
  offset += format.addElement(0, offset, Ogre::VET_FLOAT2, Ogre::VES_TEXTURE_COORDINATES).getSize();
  const auto vertex_buffer = buffers.createVertexBuffer(offset, mesh.mNumVertices, Ogre::HBU_GPU_ONLY);
  vertex_buffer->writeData(0, vertex_buffer->getSizeInBytes(), vertices.data(), true);
  out.vertices->vertexBufferBinding->setBinding(0, vertex_buffer);
  out.indices = buffers.createIndexBuffer(Ogre::HardwareIndexBuffer::IT_32BIT, indices.size(), Ogre::HBU_GPU_ONLY);
  out.indices->writeData(0, out.indices->getSizeInBytes(), indices.data(), true);
  out.material = materials_[mesh.mMaterialIndex];
}

void ogre_scene::add_node(const aiNode* node, Ogre::SceneNode* parent) {
  aiVector3D scale, position;
  aiQuaternion rotation;
  node->mTransformation.Decompose(scale, rotation, position);
  Ogre::SceneNode* const own =
      parent->createChildSceneNode(Ogre::Vector3(position.x, position.y, position.z),
                                   Ogre::Quaternion(rotation.w, rotation.x, rotation.y, rotation.z));
  own->setScale(scale.x, scale.y, scale.z);
  nodes_[node] = own;
  for (unsigned i = 0; i < node->mNumChildren; ++i) add_node(node->mChildren[i], own);
}

void ogre_scene::add_entity(const imported_draw& draw) {
  const shared_mesh& shared = meshes_[draw.mesh];
  const std::string name = "draw " + std::to_string(entities_.size());
  const Ogre::MeshPtr own = Ogre::MeshManager::getSingleton().createManual(name, Ogre::RGN_DEFAULT);
  own->setAutoBuildEdgeLists(false);
  own->_setBounds(shared.box, false);
  own->_setBoundingSphereRadius(Ogre::Math::boundingRadiusFromAABB(shared.box));
  Ogre::SubMesh* const part = own->createSubMesh();
  part->useSharedVertices = false;
  part->vertexData = shared.vertices->clone(false);  // the same buffers
  part->setMaterialName(shared.material->getName(), shared.material->getGroup());
  part->indexData->indexBuffer = shared.indices;
  part->indexData->indexCount = shared.indices->getNumIndexes();
  own->load();
  entities_.push_back(manager_.createEntity(own));
  nodes_[draw.node]->attachObject(entities_.back());
}

void ogre_scene::draw_whole(std::size_t entity) const {
  const Ogre::HardwareIndexBufferSharedPtr& all = meshes_[from_.draws[entity].mesh].indices;
  draw_part(entity, all, 0, all->getNumIndexes());
}

void ogre_scene::draw_part(std::size_t entity, const Ogre::HardwareIndexBufferSharedPtr& buffer,
                           std::size_t first_index, std::size_t index_count) const {
  Ogre::IndexData& drawn = *entities_[entity]->getMesh()->getSubMesh(0)->indexData;
  drawn.indexBuffer = buffer;
  drawn.indexStart = first_index;
  drawn.indexCount = index_count;
  entities_[entity]->setVisible(index_count > 0);
}

void ogre_scene::draw_everything() const {
  for (std::size_t i = 0; i < entities_.size(); ++i) draw_whole(i);
}

}  // namespace ogre_host
