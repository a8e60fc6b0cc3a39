/* absent.c - in the place of a set that was not built. */
#include "kernel.h"

#define KERNELS2(isa) eng_##isa##_kernels
#define KERNELS(isa)  KERNELS2(isa)

extern const struct eng_kernels KERNELS(ENG_ISA);

const struct eng_kernels KERNELS(ENG_ISA) = {.name = NULL};
