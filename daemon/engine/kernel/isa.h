/* isa.h - the instruction sets that the engine can use, from `scalar` to `avx512`, and
 * which one it uses. `scalar` is what the others are compared with, and computes one pair
 * by itself: each processor has a better one for many.
 */
#ifndef ENG_ISA_H
#define ENG_ISA_H

struct eng_kernels;

enum eng_isa {
    ENG_ISA_SCALAR, /* everywhere */
    ENG_ISA_SSE2,   /* x86-64, any */
    ENG_ISA_SSE4,   /* x86-64: SSE 4.2 */
    ENG_ISA_AVX2,   /* x86-64: AVX2, BMI2 */
    ENG_ISA_AVX512, /* x86-64: AVX-512 F, VL, DQ, BW, BMI2 */
    ENG_ISA_NEON,   /* AArch64 */
    ENG_ISA_COUNT
};

/* Return the kernels of a set; NULL: this processor or build has none, or it is beyond
 * PCCD_CPU. */
const struct eng_kernels *eng_kernels_of(enum eng_isa isa);

/* Return the set of that name, "scalar", "sse2", "sse4", "avx2", "avx512" or "neon"; of
 * no name, NULL or "", the best up to PCCD_CPU. NULL: there is no such set here, or it is
 * beyond PCCD_CPU. */
const struct eng_kernels *eng_kernels_named(const char *name);

/* Return the kernels that PCCD_CPU names, or the best; they are chosen at the first call
 * and kept. Later sets are used as little as if the processor had none. A name that it
 * cannot follow counts as none: programs check it first, with eng_kernels_named, and say
 * so. */
const struct eng_kernels *eng_kernels(void);

/* Return the name of a set, as in PCCD_CPU. */
const char *eng_kernels_name(const struct eng_kernels *kernels);

#endif
