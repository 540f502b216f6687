#include "bundled_driver.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace sightcell::picture {
namespace {

// Where drivers tell libEGL (libglvnd) that they are there: its own two folders, then those of local installs, of
// containers and of NixOS.
constexpr const char* machine_vendors =
    "/etc/glvnd/egl_vendor.d:/usr/share/glvnd/egl_vendor.d:/usr/local/share/glvnd/egl_vendor.d:"
    "/usr/local/nvidia/share/glvnd/egl_vendor.d:/run/opengl-driver/share/glvnd/egl_vendor.d";

}  // namespace

void offer_bundled_driver() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (failure) return;
  const std::filesystem::path vendors = program.parent_path().parent_path() / "lib/sightcell/mesa/egl_vendor.d";
  if (!std::filesystem::is_directory(vendors, failure)) return;
  // The loader reads $ORIGIN as the folder of the library that asks, so this suits the bundle's Mesa and, where
  // distributions put it, the machine's own.
  setenv("LIBGL_DRIVERS_PATH", "$ORIGIN/dri", 0);
  if (std::getenv("__EGL_VENDOR_LIBRARY_FILENAMES") != nullptr) return;
  setenv("__EGL_VENDOR_LIBRARY_DIRS", (std::string(machine_vendors) + ':' + vendors.string()).c_str(), 0);
}

}  // namespace sightcell::picture
