#pragma once

namespace sightcell::picture {

// Makes the software OpenGL that a bundle carries known to libEGL, behind every driver that the machine has itself.
// Does nothing outside a bundle, and nothing to what the user chose by environment variable. Call before EGL is used.
void offer_bundled_driver();

}  // namespace sightcell::picture
