/* relax.h - the pause instruction, for a loop that waits for another thread. */
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
