#pragma once
#include "hemicube/source.h"
