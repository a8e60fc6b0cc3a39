/* laststep.c - what the threads of the last step did.
 *
 * Room:     service. See laststep.h.
 * Does:     one block a step, counted by those who keep it.
 * Does not: keep more than one for each session.
 * Threads:  as marked.
 */
#include "laststep.h"

#include <stdlib.h>
#include <string.h>

#include "invariant.h"

struct srv_laststep *srv_laststep_new(const struct eng_step_result *step)
{
    size_t bytes = step->threads * sizeof step->thread_records[0];
    struct srv_laststep *last = malloc(sizeof *last + bytes);
    if (last != NULL) {
        *last = (struct srv_laststep){.thread_count = step->threads};
        memcpy(last->threads, step->thread_records, bytes);
    }
    return last;
}

void srv_laststep_set(struct srv_laststep **slot, struct srv_laststep *last)
{
    srv_assert_loop();
    if (last != NULL) {
        last->refs++;
    }
    if (*slot != NULL && --(*slot)->refs == 0) {
        free(*slot);
    }
    *slot = last;
}
