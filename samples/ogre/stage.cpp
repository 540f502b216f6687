#include "stage.h"

#include "host_error.h"

namespace ogre_host {

stage::stage(std::uint32_t width, std::uint32_t height) : log_(std::make_unique<Ogre::LogManager>()) {
  log_->createLog("", true, false, true);  // writes nothing
  root_ = std::make_unique<Ogre::Root>("", "", "");
  try {
    root_->loadPlugin(SIGHTCELL_OGRE_PLUGINS "/RenderSystem_GL");
    root_->loadPlugin(SIGHTCELL_OGRE_PLUGINS "/Codec_STBI");
    root_->setRenderSystem(root_->getRenderSystemByName("OpenGL Rendering Subsystem"));
    root_->initialise(false);
    const Ogre::NameValuePairList hidden{{"hidden", "true"}};
    root_->createRenderWindow("sightcell-ogre", 64, 64, false, &hidden);
  } catch (const Ogre::Exception& e) {
    throw host_error("ogre.no-display", "OGRE", e.getDescription(), "run it on an X display, such as that of xvfb-run");
  }
  Ogre::ResourceGroupManager::getSingleton().initialiseAllResourceGroups();
  scene_ = root_->createSceneManager();
  scene_->setAmbientLight(Ogre::ColourValue(0.30f, 0.33f, 0.40f));
  Ogre::Light* const sun = scene_->createLight();
  sun->setType(Ogre::Light::LT_DIRECTIONAL);
  sun->setDiffuseColour(0.90f, 0.84f, 0.72f);
  Ogre::SceneNode* const sky = scene_->getRootSceneNode()->createChildSceneNode();
  sky->setDirection(-0.5f, -1.0f, -0.3f, Ogre::Node::TS_WORLD);
  sky->attachObject(sun);

  camera_ = scene_->createCamera("eye");
  camera_->setFOVy(Ogre::Degree(60));
  camera_->setAspectRatio(static_cast<float>(width) / static_cast<float>(height));
  camera_->setFarClipDistance(0);
  eye_ = scene_->getRootSceneNode()->createChildSceneNode();
  eye_->attachObject(camera_);
  picture_ = Ogre::TextureManager::getSingleton().createManual("picture", Ogre::RGN_DEFAULT, Ogre::TEX_TYPE_2D, width,
                                                               height, 0, Ogre::PF_BYTE_RGB, Ogre::TU_RENDERTARGET,
                                                               nullptr, true);  // sRGB, as colors of glTF are linear
  target_ = picture_->getBuffer()->getRenderTarget();
  target_->setAutoUpdated(false);
  target_->addViewport(camera_)->setBackgroundColour(Ogre::ColourValue(0.35f, 0.52f, 0.76f));
}

void stage::set_near_plane(float near_plane) {
  camera_->setNearClipDistance(near_plane);
}

void stage::look(const Ogre::Vector3& eye, float yaw) {
  eye_->setPosition(eye);
  eye_->setOrientation(Ogre::Quaternion(Ogre::Radian(yaw), Ogre::Vector3::UNIT_Y));
}

effort stage::render(std::vector<std::uint8_t>& rgb) {
  target_->update();
  rgb.resize(3 * std::size_t{target_->getWidth()} * target_->getHeight());
  const Ogre::Box all(0, 0, target_->getWidth(), target_->getHeight());
  target_->copyContentsToMemory(all, Ogre::PixelBox(all, Ogre::PF_BYTE_RGB, rgb.data()));
  return {target_->getStatistics().batchCount, target_->getStatistics().triangleCount};
}

void stage::save(const std::string& file) const {
  target_->writeContentsToFile(file);
}

}  // namespace ogre_host
