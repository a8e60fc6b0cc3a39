/* schedule_paper.h - the paper's schedulers, which decide which thread does which task of
 * a step.
 *
 * Threads: [team]: every thread of the region calls the same scheduler.
 * Source: paper sections 4.1 (serial) and 4.3.
 */
#ifndef ENG_SCHEDULE_PAPER_H
#define ENG_SCHEDULE_PAPER_H

#include "team.h"

/* Stealing: triangles below which a task is not split, of a node, of both nodes of a
 * pair. Triangles say little about the work where things touch: with 512 and 1024 the
 * largest task of recorded steps took up to 24 ms with its tests, more than a 64th of the
 * step; with these it takes 1.7 to 3.2 ms, and half of them gains nothing
 * (bench/model). A task costs about 0.1 us to push and pop. */
#define ENG_STEAL_UNIT_GRAIN 128u
#define ENG_STEAL_PAIR_GRAIN 128u

/* All task units from the root on, depth-first, by the only worker. */
void eng_schedule_serial(struct eng_worker *worker);

/* The paper's dynamic assignment, then its high-level nodes. */
void eng_schedule_paper(struct eng_team *team, struct eng_worker *worker);

/* Seats for that many threads. PCCD_E_NOMEM. [compute] */
int eng_schedule_paper_reserve(struct eng_scene *scene, uint32_t threads);

/* Inside the region, by one thread: choose low-level and high-level nodes. */
void eng_schedule_paper_begin(struct eng_team *team, struct eng_worker *worker);

#endif
