/* daemon/engine/team/relax.h - the pause instruction, for a loop that waits for another
 * thread.
 *
 * Room:     engine. May include: nothing.
 * Does:     tell the processor that the loop only waits, so that the other hardware
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
