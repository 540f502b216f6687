#pragma once

namespace sightcell::picture {

// Lets libEGL find the software OpenGL of an installed bundle, with lower priority than the drivers of the machine.
// Does nothing outside a bundle, and does not override environment variables of the user. Call before EGL is used.
void offer_bundled_driver();

}  // namespace sightcell::picture
