/* sweep_sets.c - which of the sets for which sweep.c, straight.c and passage.c are
 * compiled. */
#include "kernel.h"
#include "passage.h"
#include "straight.h"
#include "sweep.h"

const struct eng_sweep_calls *eng_sweep_of(enum eng_isa isa)
{
    static const struct eng_sweep_calls *const calls[ENG_ISA_COUNT] = {
        [ENG_ISA_SCALAR] = &eng_scalar_sweep,
#ifdef __x86_64__
        [ENG_ISA_SSE2] = &eng_sse2_sweep,     [ENG_ISA_SSE4] = &eng_sse4_sweep,
        [ENG_ISA_AVX2] = &eng_avx2_sweep,     [ENG_ISA_AVX512] = &eng_avx512_sweep,
#endif
#ifdef __aarch64__
        [ENG_ISA_NEON] = &eng_neon_sweep,
#endif
    };
    return calls[isa];
}

const struct eng_sweep_calls *eng_sweep(void)
{
    return eng_sweep_of(eng_kernels()->isa);
}

const struct eng_straight_calls *eng_straight(void)
{
    static const struct eng_straight_calls *const calls[ENG_ISA_COUNT] = {
        [ENG_ISA_SCALAR] = &eng_scalar_straight,
#ifdef __x86_64__
        [ENG_ISA_SSE2] = &eng_sse2_straight,     [ENG_ISA_SSE4] = &eng_sse4_straight,
        [ENG_ISA_AVX2] = &eng_avx2_straight,     [ENG_ISA_AVX512] = &eng_avx512_straight,
#endif
#ifdef __aarch64__
        [ENG_ISA_NEON] = &eng_neon_straight,
#endif
    };
    return calls[eng_kernels()->isa];
}

const struct eng_passage_calls *eng_passage(void)
{
    static const struct eng_passage_calls *const calls[ENG_ISA_COUNT] = {
        [ENG_ISA_SCALAR] = &eng_scalar_passage,
#ifdef __x86_64__
        [ENG_ISA_SSE2] = &eng_sse2_passage,     [ENG_ISA_SSE4] = &eng_sse4_passage,
        [ENG_ISA_AVX2] = &eng_avx2_passage,     [ENG_ISA_AVX512] = &eng_avx512_passage,
#endif
#ifdef __aarch64__
        [ENG_ISA_NEON] = &eng_neon_passage,
#endif
    };
    return calls[eng_kernels()->isa];
}
