#include "bundled_driver.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace sightcell::picture {
namespace {

// The folders where drivers register with libEGL (libglvnd): its own two, then those of local installations, of
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
  // The loader replaces $ORIGIN by the folder of the library that loads a driver. So this is right for the bundle's
  // Mesa and, with the layout of distributions, for that of the machine.
  setenv("LIBGL_DRIVERS_PATH", "$ORIGIN/dri", 0);
  if (std::getenv("__EGL_VENDOR_LIBRARY_FILENAMES") != nullptr) return;
  setenv("__EGL_VENDOR_LIBRARY_DIRS", (std::string(machine_vendors) + ':' + vendors.string()).c_str(), 0);
}

}  // namespace sightcell::picture
