#pragma once
// Contents of a .pvs file with the size and shape of a small city, made with integers only, so that they are the same
// with every compiler and library. Streets cross in a grid. Visible from a cell are the houses around it, those along
// its streets, and some roofs.
#include "unit/format/sample_contents.h"

namespace sightcell::test {

sample_contents generated_city();

}  // namespace sightcell::test
