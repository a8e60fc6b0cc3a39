/* stats_threads.h - prints what each thread of the daemon did in its last step.
 *
 * Threads: one.
 */
#ifndef CTL_STATS_THREADS_H
#define CTL_STATS_THREADS_H

#include <stdbool.h>
#include <stdio.h>

#include "pccd.h"

/* Returns a status; pccd_error_text says more. E_BUSY: steps come so fast that no step's
 * threads could be read as a whole. */
int stats_threads_print(struct pccd_client *client, FILE *to, bool is_json);

#endif
