#pragma once
#include <string>

#include "target.h"

namespace vulkan_host {

// Writes the colors of a picture as a PNG. Throws vulkan.write.
void write_screenshot(const std::string& file, picture shown);

}  // namespace vulkan_host
