/* daemon/engine/schedule/relax.h - a moment's patience.
 *
 * Room:     engine. May include: nothing.
 * Does:     tell the processor that a loop waits for another thread, so that the other
 *           thread of its core gets the execution units.
 * Threads:  [any].
 */
#ifndef ENG_RELAX_H
#define ENG_RELAX_H

static inline void eng_relax(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

#endif
