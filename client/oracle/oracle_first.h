/* oracle_first.h - the first of several times, each an exact root.
 *
 * Threads: one thread for one struct oracle_first.
 */
#ifndef ORACLE_ORACLE_FIRST_H
#define ORACLE_ORACLE_FIRST_H

#include "oracle.h"
#include "oracle_root.h"

#define FIRST_MAX 9 /* features of four points have as many pairs of parts, at most */

/* The first contact time is the least of these. */
struct oracle_first {
    struct root roots[FIRST_MAX];
    int count;
};

void first_init(struct oracle_first *first); /* all roots are exactly 0 */
void first_clear(struct oracle_first *first);

/* On the heap, initialised. Ends the process where there is no memory: no answer is
 * better than a wrong one. */
struct oracle_first *first_new(void);
/* `first`, or NULL, and freed, if it has no roots. */
struct oracle_first *first_or_null(struct oracle_first *first);

#endif
