/* metrics.c - the counters of `stats`.
 *
 * Room:     service. See metrics.h.
 * Does:     sums.
 * Does not: lock.
 * Threads:  [loop].
 */
#include "metrics.h"

void srv_metrics_add_step(struct srv_metrics *metrics,
                          const struct proto_FRAME_SUBMIT_result *answer)
{
    struct proto_STATS_result *counters = &metrics->counters;
    counters->steps++;
    counters->steps_incomplete += answer->incomplete != PCCD_COMPLETE;
    counters->contacts += answer->mode == PCCD_MODE_PAIRS ? 0 : answer->total;
    counters->possible += answer->possible;
    counters->candidates += answer->candidates_vf + answer->candidates_ee;
    counters->survivors += answer->survivors;
    counters->exact += answer->exact;
    counters->builds += answer->builds;
    counters->step_builds_last = answer->builds;
    counters->step_allocs_last = answer->allocs;
    counters->ns_ingest += answer->ns_ingest;
    counters->ns_refit += answer->ns_refit;
    counters->ns_traversal += answer->ns_traversal;
    counters->ns_tests += answer->ns_tests;
    counters->ns_merge += answer->ns_merge;
    counters->ns_step += answer->ns_step;
    counters->ns_low += answer->ns_low;
    counters->ns_high += answer->ns_high;
    counters->ns_rebuild += answer->ns_rebuild;
    counters->rebuilds += answer->rebuilds;
    counters->rebuilt_triangles += answer->rebuilt_triangles;
    counters->swaps += answer->swaps;
    counters->swapped_triangles += answer->swapped_triangles;
}

void srv_metrics_add_error(struct srv_metrics *metrics, int status)
{
    metrics->counters.errors++;
    metrics->counters.slots_stale += status == PCCD_E_SLOT_STALE;
    metrics->counters.slots_torn += status == PCCD_E_SLOT_TORN;
}
