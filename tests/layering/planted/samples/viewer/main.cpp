#include "sightcell/bake/bake.h"
