// The kernel for x86 processors with AVX2. kernel.inl has the rule for this file.
#define SIGHTCELL_KERNEL avx2_kernel
#define SIGHTCELL_KERNEL_NAME "AVX2"
#include "hemicube/cpu/kernel.inl"
static_assert(HWY_TARGET == HWY_AVX2);
