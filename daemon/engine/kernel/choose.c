/* choose.c - which instruction set.
 *
 * Each x86-64 has SSE2; Intel's have SSE 4.2 since 2008, AVX2 since 2013 (small ones
 * since 2021), AVX-512 in servers since 2017; AMD's since 2011, 2015 and 2022. Each
 * AArch64 has NEON.
 */
#include <assert.h>
#include <float.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

/* Not those of the x87, which keep more bits than they say. */
static_assert(FLT_EVAL_METHOD == 0, "what is a double is rounded to one");

extern const struct eng_kernels eng_scalar_kernels;
#ifdef __x86_64__
extern const struct eng_kernels eng_sse2_kernels;
extern const struct eng_kernels eng_sse4_kernels;
extern const struct eng_kernels eng_avx2_kernels;
extern const struct eng_kernels eng_avx512_kernels;
#endif
#ifdef __aarch64__
extern const struct eng_kernels eng_neon_kernels;
#endif

#ifdef __x86_64__
/* See absent.c. */
static const struct eng_kernels *if_built(const struct eng_kernels *kernels)
{
    return kernels->name ? kernels : NULL;
}
#endif

/* The kernels that this processor can run. */
static const struct eng_kernels *kernels_here(enum eng_isa isa)
{
    switch (isa) {
    case ENG_ISA_SCALAR:
        return &eng_scalar_kernels;
#ifdef __x86_64__
    case ENG_ISA_SSE2:
        return if_built(&eng_sse2_kernels);
    /* The compiler's runtime asks the processor, and whether the system saves the
     * registers. */
    case ENG_ISA_SSE4:
        return __builtin_cpu_supports("sse4.2") ? if_built(&eng_sse4_kernels) : NULL;
    case ENG_ISA_AVX2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")
                   ? if_built(&eng_avx2_kernels)
                   : NULL;
    case ENG_ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                       __builtin_cpu_supports("avx512dq") &&
                       __builtin_cpu_supports("avx512bw") &&
                       __builtin_cpu_supports("bmi2")
                   ? if_built(&eng_avx512_kernels)
                   : NULL;
#endif
#ifdef __aarch64__
    case ENG_ISA_NEON:
        return &eng_neon_kernels;
#endif
    default:
        return NULL;
    }
}

/* Those of that name, or the best up to `last`. */
static const struct eng_kernels *find(const char *name, int last)
{
    bool any = !name || !*name;
    for (int isa = last; isa >= 0; isa--) {
        const struct eng_kernels *kernels = kernels_here((enum eng_isa)isa);
        if (kernels && (any || strcmp(kernels->name, name) == 0)) {
            return kernels;
        }
    }
    return NULL;
}

const struct eng_kernels *eng_kernels(void)
{
    static const struct eng_kernels *_Atomic chosen;
    const struct eng_kernels *kernels =
        atomic_load_explicit(&chosen, memory_order_relaxed);
    if (!kernels) {
        kernels = find(getenv("PCCD_CPU"), ENG_ISA_COUNT - 1);
        kernels = kernels ? kernels : find(NULL, ENG_ISA_COUNT - 1);
        atomic_store_explicit(&chosen, kernels, memory_order_relaxed);
    }
    return kernels;
}

const struct eng_kernels *eng_kernels_of(enum eng_isa isa)
{
    return isa <= eng_kernels()->isa ? kernels_here(isa) : NULL;
}

const struct eng_kernels *eng_kernels_named(const char *name)
{
    return find(name, (int)eng_kernels()->isa);
}

const char *eng_kernels_name(const struct eng_kernels *kernels)
{
    return kernels->name;
}
