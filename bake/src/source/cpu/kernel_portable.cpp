// For every processor; gives the same bits as the others.
#define SIGHTCELL_KERNEL portable_kernel
#define SIGHTCELL_KERNEL_NAME "portable"
#include "source/cpu/kernel.inl"
