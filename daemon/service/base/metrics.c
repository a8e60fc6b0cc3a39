/* metrics.c - the counters of `stats`. */
#include "metrics.h"

#include <assert.h>
#include <stddef.h>

#define BUCKET_FIRST 10u /* of proto_STATS_HISTOGRAM_result: less than 2^10 ns */
#define BUCKET_COUNT 26u
static_assert(offsetof(struct proto_STATS_HISTOGRAM_result, above) ==
                  offsetof(struct proto_STATS_HISTOGRAM_result, b10) +
                      BUCKET_COUNT * sizeof(uint64_t),
              "the buckets follow one another, and `above` follows them");

void srv_metrics_add_duration(struct srv_metrics *metrics, enum pccd_histogram_kind kind,
                              uint64_t took_ns)
{
    struct proto_STATS_HISTOGRAM_result *histogram = &metrics->histograms[kind];
    /* The bits that the time takes say which power of two it is less than. */
    uint32_t bits = took_ns == 0 ? 0 : 64u - (uint32_t)__builtin_clzll(took_ns);
    uint32_t bucket = bits <= BUCKET_FIRST ? 0 : bits - BUCKET_FIRST;
    size_t at = offsetof(struct proto_STATS_HISTOGRAM_result, b10) +
                (bucket < BUCKET_COUNT ? bucket : BUCKET_COUNT) * sizeof(uint64_t);
    ++*(uint64_t *)(void *)((char *)histogram + at);
    histogram->count++;
    histogram->ns_sum += took_ns;
}

void srv_metrics_add_step(struct srv_metrics *metrics, const struct proto_answer *answer)
{
    struct proto_STATS_result *counters = &metrics->counters;
    counters->steps++;
    srv_metrics_add_duration(metrics, PCCD_HISTOGRAM_STEPS, answer->ns_step);
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
    counters->still_features += answer->still_features;
    counters->still_pairs += answer->still_pairs;
    counters->kept_records += answer->kept_records;
    counters->rigid_objects += answer->rigid_objects;
    counters->thick_candidates += answer->thick_candidates;
    counters->steps_crowded += answer->crowded;
}

void srv_stats_add_step(struct proto_LIST_SESSION_result *stats,
                        const struct proto_answer *answer)
{
    stats->steps++;
    stats->steps_incomplete += answer->incomplete != PCCD_COMPLETE;
    stats->contacts += answer->mode == PCCD_MODE_PAIRS ? 0 : answer->total;
    stats->ns_ingest += answer->ns_ingest;
    stats->ns_refit += answer->ns_refit;
    stats->ns_traversal += answer->ns_traversal;
    stats->ns_tests += answer->ns_tests;
    stats->ns_merge += answer->ns_merge;
    stats->ns_step += answer->ns_step;
}

/* Add the members of a result, all of them u64. */
static void add_members(int method, void *to, const void *more)
{
    const struct proto_fields *fields = &proto_messages[method].result;
    for (uint32_t i = 0; i < fields->count; i++) {
        size_t at = fields->items[i].offset;
        if (fields->items[i].type == PROTO_TYPE_u64) {
            *(uint64_t *)(void *)((char *)to + at) +=
                *(const uint64_t *)(const void *)((const char *)more + at);
        }
    }
}

void srv_metrics_add_all(struct srv_metrics *metrics, const struct srv_metrics *more)
{
    struct proto_STATS_result *counters = &metrics->counters;
    const bool has_steps = more->counters.steps > 0;
    const struct proto_STATS_result before = *counters;
    add_members(PROTO_METHOD_STATS, counters, &more->counters);
    counters->step_builds_last =
        has_steps ? more->counters.step_builds_last : before.step_builds_last;
    counters->step_allocs_last =
        has_steps ? more->counters.step_allocs_last : before.step_allocs_last;
    for (uint32_t kind = 0; kind < PCCD_HISTOGRAM_COUNT; kind++) {
        add_members(PROTO_METHOD_STATS_HISTOGRAM, &metrics->histograms[kind],
                    &more->histograms[kind]);
    }
}

void srv_stats_add_all(struct proto_LIST_SESSION_result *stats,
                       const struct proto_LIST_SESSION_result *more)
{
    add_members(PROTO_METHOD_LIST_SESSION, stats, more);
}

void srv_metrics_add_near(struct srv_metrics *metrics, const struct proto_answer *answer)
{
    struct proto_STATS_result *counters = &metrics->counters;
    counters->nears++;
    counters->nears_incomplete += answer->incomplete != PCCD_COMPLETE;
    counters->near_records += answer->total;
    counters->ns_near += answer->ns_step;
}

void srv_metrics_add_error(struct srv_metrics *metrics, int status)
{
    metrics->counters.errors++;
    metrics->counters.slots_stale += status == PCCD_E_SLOT_STALE;
    metrics->counters.slots_torn += status == PCCD_E_SLOT_TORN;
}
