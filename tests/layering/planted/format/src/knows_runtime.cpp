#include <cstdint>
#include "sightcell/sightcell.h"
