// Compiled with -mavx2 and chosen at run time. No function of this file may be one that others could share, or a
// processor without AVX2 would come to run it: tests/unit/bake looks at the object file.
#define SIGHTCELL_KERNEL avx2_kernel
#define SIGHTCELL_KERNEL_NAME "AVX2"
#include "source/cpu/kernel.inl"
