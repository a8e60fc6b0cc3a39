/* schedule_paper.h - the paper's scheduler: which thread performs which task unit.
 *
 * Source: paper sections 4.2, 4.3 and 5.1.
 */
#ifndef ENG_SCHEDULE_PAPER_H
#define ENG_SCHEDULE_PAPER_H

#include "team.h"

/* Choose low-level and high-level nodes, and deal out the former. [team], one thread */
void eng_schedule_paper_begin(struct eng_team *team, struct eng_worker *worker);

/* Dynamic assignment of the low-level nodes, then the high-level ones. [team], each
 * thread */
void eng_schedule_paper(struct eng_team *team, struct eng_worker *worker);

#endif
