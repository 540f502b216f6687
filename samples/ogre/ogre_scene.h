#pragma once
// An imported scene in OGRE: what an engine has before it uses visibility. Nothing here is about Sightcell, but that
// each entity has a mesh of its own, so that entities of one mesh can draw different triangles.
#include <Ogre.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "importer.h"

namespace ogre_host {

class ogre_scene {
 public:
  ogre_scene(Ogre::SceneManager& manager, const imported_scene& from);

  // By draw of the imported scene.
  [[nodiscard]] const std::vector<Ogre::Entity*>& entities() const { return entities_; }

  // Lets an entity draw all triangles of its mesh, from the static index buffer that instances share.
  void draw_whole(std::size_t entity) const;
  // Lets an entity draw a part of another index buffer. Hides it if the part is empty.
  void draw_part(std::size_t entity, const Ogre::HardwareIndexBufferSharedPtr& buffer, std::size_t first_index,
                 std::size_t index_count) const;
  void draw_everything() const;

 private:
  void add_mesh(const aiMesh& mesh, const std::vector<std::uint32_t>& indices);
  void add_node(const aiNode* node, Ogre::SceneNode* parent);
  void add_entity(const imported_draw& draw);

  struct shared_mesh {
    std::unique_ptr<Ogre::VertexData> vertices;
    Ogre::HardwareIndexBufferSharedPtr indices;
    Ogre::AxisAlignedBox box;
    Ogre::MaterialPtr material;
  };

  Ogre::SceneManager& manager_;
  const imported_scene& from_;
  std::vector<Ogre::MaterialPtr> materials_;
  std::vector<shared_mesh> meshes_;
  std::map<const aiNode*, Ogre::SceneNode*> nodes_;
  std::vector<Ogre::Entity*> entities_;
};

}  // namespace ogre_host
