#pragma once
#include "hemicube/gpu/gpu_source.h"
