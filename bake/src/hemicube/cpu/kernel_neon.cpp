// The kernel for ARM64 processors, all of which have NEON.
#define SIGHTCELL_KERNEL neon_kernel
#define SIGHTCELL_KERNEL_NAME "NEON"
#include "hemicube/cpu/kernel.inl"
static_assert(HWY_TARGET == HWY_NEON);
