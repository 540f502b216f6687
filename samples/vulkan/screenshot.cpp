#include "screenshot.h"

#include "sightcell/base/error.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb_image_write.h>

namespace vulkan_host {

void write_screenshot(const std::string& file, picture shown) {
  for (std::size_t i = 3; i < shown.rgba.size(); i += 4) shown.rgba[i] = 255;  // else the sum of blended alphas
  const auto width = static_cast<int>(shown.size.width), height = static_cast<int>(shown.size.height);
  if (stbi_write_png(file.c_str(), width, height, 4, shown.rgba.data(), 4 * width) != 0) return;
  throw sightcell::error(sightcell::error_kind::failed, "vulkan.write", file, "cannot be written",
                         "name a file in a folder that exists");
}

}  // namespace vulkan_host
