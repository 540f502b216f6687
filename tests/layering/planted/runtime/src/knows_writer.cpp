#include "sightcell/format/writer.h"
