// A packed scene looks like the scene.
#include "sightcell/scene/pack.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "gl_test.h"
#include "sightcell/picture/picture.h"
#include "unit/scene/gltf_sketch.h"
#include "unit/scene/packed_file.h"

namespace {

namespace picture = sightcell::picture;
namespace scene = sightcell::scene;
using nlohmann::json;

class pack_picture_test : public sightcell::test::gl_test {
 protected:
  picture::image_rgba draw(const scene::scene& s, const picture::camera& from) {
    const scene::world_geometry world = scene::flatten(s);
    return picture::renderer(context(), s, world).draw(from, 160, 120);
  }
};

// A quarter of each color, in four texels.
std::vector<std::uint8_t> checkered(const temporary_folder& folder) {
  picture::image_rgba pixels{2, 2, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0}};
  const std::filesystem::path path = folder.path() / "checkered.png";
  picture::write_png(path, pixels);
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(pack_picture_test, packed_scenes_look_like_the_scene) {
  const temporary_folder folder;
  gltf_sketch g;
  const std::vector<std::uint8_t> png = checkered(folder);
  const int image = g.add_accessor(png, "SCALAR", 5121, png.size());
  g.json["images"] = {{{"bufferView", g.json["accessors"][static_cast<std::size_t>(image)]["bufferView"]}}};
  g.json["textures"] = {{{"source", 0}}};
  const json texture = {{"index", 0},
                        {"texCoord", 1},
                        {"extensions", {{"KHR_texture_transform", {{"scale", {3, 2}}, {"rotation", 0.4}}}}}};
  g.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}, {"alphaMode", "MASK"}},
                         {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.6, 0.2, 1}}}}}};
  g.json["extensionsUsed"] = {"KHR_texture_transform"};
  const int positions = g.add_positions({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});
  const int uvs = g.add_accessor(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 5126, 4);
  const int colors = g.add_accessor(std::vector<float>{1, 1, 1, .2f, .2f, 1, 1, 1, 1, 1, .5f, 1}, "VEC3", 5126, 4);
  const int indices = g.add_accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 5123, 6);
  for (const int material : {0, 1}) {
    json& primitive = g.json["meshes"][static_cast<std::size_t>(g.add_mesh(positions, indices))]["primitives"][0];
    primitive["material"] = material;
    primitive["attributes"]["COLOR_0"] = colors;
    if (material == 0) primitive["attributes"]["TEXCOORD_1"] = uvs;
  }
  g.add_node({{"mesh", 0}, {"translation", {-1.2, 0, -4}}, {"rotation", {0, 0.3, 0, 0.95}}});
  g.add_node({{"mesh", 0}, {"translation", {1.2, 0, -5}}, {"scale", {-1, 1.5, 1}}});
  g.add_node({{"mesh", 1}, {"translation", {0, 0.5, -7}}, {"scale", {3, 1, 1}}, {"name", "wheel"}});
  g.json["animations"] = {{{"channels", {{{"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
  scene::gltf_packer packer(folder.write("sketch.glb", g.glb()));
  std::vector<std::string> warnings;
  const scene::packed_file file(packer.pack(scene::some_order(packer.content()), warnings));
  const scene::scene again = file.loaded();
  const picture::camera away{.eye = {0, 0, -20}, .forward = {0, 0, 1}};
  for (const picture::camera& from : {picture::camera{}, away}) {
    const picture::image_rgba before = draw(packer.content(), from), after = draw(again, from);
    EXPECT_EQ(picture::compare(before, after).differing_pixels, 0u);
  }
  // The picture shows something: sky, and many colors.
  const picture::image_rgba shown = draw(again, {});
  std::set<std::array<std::uint8_t, 3>> seen;
  for (std::size_t i = 0; i < shown.pixels.size(); i += 4)
    seen.insert({shown.pixels[i], shown.pixels[i + 1], shown.pixels[i + 2]});
  EXPECT_GT(seen.size(), 50u);
}

}  // namespace
