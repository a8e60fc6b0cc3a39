/* daemon/engine/kernel/table.c - the kernels of one instruction set, for kernel.h.
 *
 * Room:     engine.
 * Does:     list them.
 * Threads:  [any].
 */
#include "table.h"

#define TEXT2(x) #x
#define TEXT(x)  TEXT2(x)

extern const struct eng_kernels ENG_KERNEL(kernels);

const struct eng_kernels ENG_KERNEL(kernels) = {
    .isa = ENG_ISA_NUMBER,
    .name = TEXT(ENG_ISA),
    .all_within = ENG_KERNEL(all_within),
    .widen_within = ENG_KERNEL(widen_within),
};
