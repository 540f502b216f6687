#pragma once
#include "job/bake.h"
