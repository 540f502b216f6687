#include "sightcell/format/reader.h"
#include "sightcell/bake/bake.h"
