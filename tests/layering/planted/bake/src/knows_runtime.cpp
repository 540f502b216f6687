#include <sightcell/sightcell.h>
