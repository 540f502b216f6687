// The kernel for x86 processors with SSE4.2. kernel.inl has the rule for this file.
#define SIGHTCELL_KERNEL sse4_kernel
#define SIGHTCELL_KERNEL_NAME "SSE4"
#include "hemicube/cpu/kernel.inl"
static_assert(HWY_TARGET == HWY_SSE4);
