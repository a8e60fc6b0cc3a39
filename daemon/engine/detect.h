/* detect.h - has a team of threads search the trees of a method: for the contacts of a
 * step, or for what is near.
 *
 * Threads: [compute]; run opens one parallel region.
 */
#ifndef ENG_DETECT_H
#define ENG_DETECT_H

#include "method.h"
#include "step_memory.h"

/* Do everything that can fail for want of memory, before anything moves: the answer will
 * be in `out`. `effort` says whether a team pays. PCCD_E_NOMEM. */
int eng_detect_prepare(struct eng_scene *scene, const struct eng_question *question,
                       struct eng_effort *effort, struct eng_records *out,
                       struct eng_stop *stop, struct eng_team *team);

/* Refit, unless team->has_boxes, and search; by more than one thread, merge. Returns the
 * time at which the search ended, ns. */
uint64_t eng_detect_run(struct eng_team *team, struct pccd_step_times *times);

/* Divide, when the answer is there, the time into traversal and tests, add up what the
 * workers counted, copy their records[count]. Returns the time of all of them, ns,
 * without waiting. */
uint64_t eng_detect_count(struct eng_team *team, struct eng_thread_record *records,
                          struct pccd_step_times *times,
                          struct pccd_step_counters *counters);

/* Count the same for the pairs of a step that meet at a distance. */
void eng_detect_count_thick(const struct eng_team *team, struct eng_thick_counters *sum);

/* Return how many leaves (topology.h) the scene has, 2^32 - 1 if there are more. */
uint32_t eng_detect_size(const struct eng_scene *scene);

#endif
