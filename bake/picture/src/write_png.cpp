#include <unistd.h>

#include <fstream>
#include <string>
#include <system_error>

#include "sightcell/base/error.h"
#include "sightcell/picture/picture.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

namespace sightcell::picture {
namespace {

void append(void* stream, void* data, int size) {
  static_cast<std::ofstream*>(stream)->write(static_cast<const char*>(data), size);
}

}  // namespace

void write_png(const std::filesystem::path& path, const image_rgba& picture) {
  const auto fail = [&](const std::string& cause) {
    throw error(error_kind::failed, "picture.write", path.string(), cause, "check the folder and the free space");
  };
  if (picture.width == 0 || picture.height == 0 ||
      picture.pixels.size() != 4 * std::size_t{picture.width} * picture.height) {
    throw error(error_kind::wrong_use, "picture.empty", path.string(), "the picture has no or too few pixels",
                "write a picture that was drawn");
  }
  // Written beside the target, so that the rename stays on one file system and no other process reads an incomplete
  // picture.
  std::filesystem::path temporary = path;
  temporary += ".tmp-" + std::to_string(getpid());
  bool written = false;
  {
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    if (!stream) fail("cannot be written");
    const auto width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
    written = stbi_write_png_to_func(append, &stream, width, height, 4, picture.pixels.data(), 4 * width) != 0;
    stream.close();
    written = written && !stream.fail();
  }
  std::error_code failure;
  if (written) std::filesystem::rename(temporary, path, failure);
  if (!written || failure) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    fail(failure ? failure.message() : "could not be written to the end");
  }
}

}  // namespace sightcell::picture
