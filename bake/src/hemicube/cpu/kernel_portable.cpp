// The kernel for every processor: Highway's scalar target, one lane per vector.
#define HWY_COMPILE_ONLY_SCALAR
#define SIGHTCELL_KERNEL portable_kernel
#define SIGHTCELL_KERNEL_NAME "portable"
#include "hemicube/cpu/kernel.inl"
static_assert(HWY_TARGET == HWY_SCALAR);
