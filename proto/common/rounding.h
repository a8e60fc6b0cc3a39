/* rounding.h - how the processor computes with floats on the calling thread, and how pccd
 * needs it.
 *
 * Set what everything is proved and tested for: to nearest, subnormal numbers kept, no
 * traps; give back what a caller had. A program may compute otherwise (fesetround; a
 * library linked with -ffast-math by gcc 12, which flushes subnormal numbers of the
 * thread that loads it), and a thread of OpenMP may keep for ever what the thread that
 * made it had (libgomp).
 *
 * Threads: [any], of itself. Two registers are read and compared, 10 ns.
 */
#ifndef COMMON_ROUNDING_H
#define COMMON_ROUNDING_H

#include <stdint.h>

#if defined(__x86_64__)

/* The control registers: of SSE, which all doubles are computed with, and of the x87,
 * which the C library asks how to round a text (printf, strtod). */
struct common_rounding {
    uint32_t sse;
    uint16_t x87;
};

#define COMMON_ROUNDING_SSE        UINT32_C(0x1f80) /* nearest, all exceptions masked */
#define COMMON_ROUNDING_X87        UINT16_C(0x037f)
#define COMMON_ROUNDING_EXCEPTIONS UINT32_C(0x003f) /* that were raised; in `sse` */

static inline struct common_rounding common_rounding_now(void)
{
    struct common_rounding now;
    __asm__ volatile("stmxcsr %0" : "=m"(now.sse));
    __asm__ volatile("fnstcw %0" : "=m"(now.x87));
    return now;
}

static inline void common_rounding_set(const struct common_rounding *to)
{
    struct common_rounding now = common_rounding_now();
    if (((now.sse ^ to->sse) & ~COMMON_ROUNDING_EXCEPTIONS) != 0) {
        __asm__ volatile("ldmxcsr %0" : : "m"(to->sse) : "memory");
    }
    if (now.x87 != to->x87) { /* without fnclex what was raised before might trap now */
        __asm__ volatile("fnclex\n\tfldcw %0" : : "m"(to->x87) : "memory");
    }
}

static inline struct common_rounding common_rounding_needed(void)
{
    return (struct common_rounding){COMMON_ROUNDING_SSE, COMMON_ROUNDING_X87};
}

#elif defined(__aarch64__)

/* FPCR. */
struct common_rounding {
    uint64_t control;
};

static inline struct common_rounding common_rounding_now(void)
{
    struct common_rounding now;
    __asm__ volatile("mrs %0, fpcr" : "=r"(now.control));
    return now;
}

static inline void common_rounding_set(const struct common_rounding *to)
{
    if (common_rounding_now().control != to->control) {
        __asm__ volatile("msr fpcr, %0" : : "r"(to->control) : "memory");
    }
}

static inline struct common_rounding common_rounding_needed(void)
{
    return (struct common_rounding){0};
}

#else

#include <fenv.h>

struct common_rounding {
    fenv_t all;
};

static inline struct common_rounding common_rounding_now(void)
{
    struct common_rounding now;
    (void)fegetenv(&now.all);
    return now;
}

static inline void common_rounding_set(const struct common_rounding *to)
{
    (void)fesetenv(&to->all);
}

static inline struct common_rounding common_rounding_needed(void)
{
    struct common_rounding callers = common_rounding_now(), needed;
    (void)fesetenv(FE_DFL_ENV);
    needed = common_rounding_now();
    (void)fesetenv(&callers.all);
    return needed;
}

#endif

/* Compute as pccd needs it from here on. Returns how it was. */
static inline struct common_rounding common_rounding_enter(void)
{
    struct common_rounding callers = common_rounding_now();
    struct common_rounding needed = common_rounding_needed();
    common_rounding_set(&needed);
    return callers;
}

/* As pccd needs it until the block is left, which gives back what it was. */
#define COMMON_ROUNDING_HERE                                                             \
    const struct common_rounding callers_rounding                                        \
        __attribute__((cleanup(common_rounding_set), unused)) = common_rounding_enter()

#endif
