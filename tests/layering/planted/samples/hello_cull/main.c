#include <stdint.h>
#include "sightcell/scene/scene.h"
