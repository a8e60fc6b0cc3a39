/* table.c - the kernels of one instruction set, for kernel.h. */
#include "table.h"

#define TEXT2(x) #x
#define TEXT(x)  TEXT2(x)

extern const struct eng_kernels ENG_KERNEL(kernels);

const struct eng_kernels ENG_KERNEL(kernels) = {.isa = ENG_ISA_NUMBER,
                                                .name = TEXT(ENG_ISA),
#define ENTRY(name) .name = ENG_KERNEL(name),
                                                ENG_KERNEL_NAMES(ENTRY)
#undef ENTRY
#define JOIN_FEATURES(NAME, value, name, ...)                                            \
    .join_features[PCCD_##NAME] = ENG_KERNEL(join_##name),
                                                    PCCD_KIND_LIST(JOIN_FEATURES)
                                                        JOIN_FEATURES(EF, 4, ef, )
#undef JOIN_FEATURES
};
