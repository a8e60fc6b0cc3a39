/* daemon/engine/kernel/absent.c - in the place of a set that was not built.
 *
 * Room:     engine.
 * Does:     name none: choose.c then takes the processor for one that lacks the set.
 * Threads:  [any].
 */
#include "kernel.h"

#define KERNELS2(isa) eng_##isa##_kernels
#define KERNELS(isa)  KERNELS2(isa)

extern const struct eng_kernels KERNELS(ENG_ISA);

const struct eng_kernels KERNELS(ENG_ISA) = {.name = NULL};
