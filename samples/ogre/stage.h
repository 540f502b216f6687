#pragma once
// OGRE without a window on screen: a hidden one for its OpenGL context, and a texture that is rendered into.
#include <Ogre.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ogre_host {

// What one picture took, as OGRE counts it.
struct effort {
  std::size_t batches = 0, triangles = 0;
};

class stage {
 public:
  // Throws host_error where there is no X display.
  stage(std::uint32_t width, std::uint32_t height);

  [[nodiscard]] Ogre::SceneManager& scene() { return *scene_; }
  [[nodiscard]] const Ogre::Camera& camera() const { return *camera_; }

  // near_plane: meters. The far plane is at infinity.
  void set_near_plane(float near_plane);
  // yaw: radians to the left of -Z.
  void look(const Ogre::Vector3& eye, float yaw);
  // Renders, and waits for the end of it.
  effort render(std::vector<std::uint8_t>& rgb);
  void save(const std::string& file) const;

 private:
  std::unique_ptr<Ogre::LogManager> log_;
  std::unique_ptr<Ogre::Root> root_;
  Ogre::SceneManager* scene_ = nullptr;
  Ogre::Camera* camera_ = nullptr;
  Ogre::SceneNode* eye_ = nullptr;
  Ogre::TexturePtr picture_;
  Ogre::RenderTarget* target_ = nullptr;
};

}  // namespace ogre_host
