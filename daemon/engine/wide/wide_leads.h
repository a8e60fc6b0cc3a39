/* wide_leads.h - the pairs that bounded vertices in the last answer, asked first in the
 * next one.
 *
 * A pair does not matter for bounds that is farther apart than the bound of each of its
 * points (question.h, eng_near_prunes). The sooner these are small, the fewer pairs are
 * left; where positions have moved little, they are at once those of the pairs that set
 * them last time. Which pairs are asked first changes no bound.
 *
 * Threads: reserve, begin: [compute]; take, learn: [team].
 */
#ifndef ENG_WIDE_LEADS_H
#define ENG_WIDE_LEADS_H

#include "wide_join.h"

struct eng_wide_leads {
    _Atomic uint64_t *of; /* [capacity] by slot of a vertex */
    uint32_t capacity;
    uint32_t assembled;     /* the trees whose slots they are, .. */
    uint32_t masks_version; /* .. and by what these pairs may meet */
    atomic_uint next;       /* slot that nobody has taken */
};

void eng_wide_leads_deinit(struct eng_wide_leads *leads);
uint64_t eng_wide_leads_bytes(const struct eng_wide_leads *leads);

/* Make room for those of trees that are put together. PCCD_E_NOMEM: there are none. */
int eng_wide_leads_reserve(struct eng_wide_leads *leads, const struct eng_wide *wide);

/* Get ready to take them, or forget all if pairs of other slots were learned, or what may
 * meet has changed since. */
void eng_wide_leads_begin(struct eng_wide_leads *leads, const struct eng_wide *wide,
                          uint32_t masks_version);

/* Put the pairs of some vertices, each once, into chunks by kind, which are empty and
 * have room for them. False: others have taken all. */
bool eng_wide_leads_take(struct eng_wide_leads *leads, const struct eng_wide *wide,
                         struct eng_wide_chunk *chunks);

/* Note that slots a and b of a kind are the nearest pair so far of a vertex. */
static inline void eng_wide_leads_learn(struct eng_wide_leads *leads, uint32_t vertex,
                                        enum pccd_kind kind, uint32_t a, uint32_t b)
{
    if ((kind == PCCD_VF || kind == PCCD_EE) && (a | b) >> 31 == 0) {
        uint64_t is_ee = kind == PCCD_EE;
        atomic_store_explicit(&leads->of[vertex],
                              (uint64_t)1 << 63 | is_ee << 62 | (uint64_t)a << 31 | b,
                              memory_order_relaxed);
    }
}

#endif
