#pragma once
// Contents of a .pvs file with the size and shape of a small city, made with whole numbers only: the same contents with
// every compiler and library. Streets cross in a grid; from a cell one sees the houses around it, those along its
// streets and some roofs.
#include "unit/format/sample_contents.h"

namespace sightcell::test {

sample_contents generated_city();

}  // namespace sightcell::test
