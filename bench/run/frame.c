/* frame.c - what is kept of one step. */
#include "frame.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "report.h"

#define TIME(member)    offsetof(struct pccd_step_times, member)
#define COUNTER(member) offsetof(struct pccd_step_counters, member)

const struct run_quantity run_times[RUN_TIMES] = {
    [RUN_STEP] = {"step", TIME(step)},
    [RUN_INGEST] = {"ingest", TIME(ingest)},
    [RUN_REFIT] = {"refit", TIME(refit)},
    [RUN_TRAVERSAL] = {"traversal", TIME(traversal)},
    [RUN_TESTS] = {"tests", TIME(tests)},
    [RUN_MERGE] = {"merge", TIME(merge)},
    [RUN_REST] = {"rest", RUN_OWN},
    [RUN_LOW] = {"low", TIME(low)},
    [RUN_HIGH] = {"high", TIME(high)},
    [RUN_REBUILD] = {"rebuild", TIME(rebuild)},
    [RUN_REFIT_WORK] = {"refit_work", RUN_OWN},
    [RUN_LOW_WORK] = {"low_work", RUN_OWN},
    [RUN_HIGH_WORK] = {"high_work", RUN_OWN},
    [RUN_MERGE_WORK] = {"merge_work", RUN_OWN},
    [RUN_WAIT] = {"wait", RUN_OWN},
    [RUN_WALL] = {"wall", RUN_OWN},
};

const struct run_quantity run_counts[RUN_COUNTS] = {
    [RUN_TASK_UNITS] = {"task_units", COUNTER(task_units)},
    [RUN_BOX_TESTS] = {"box_tests", COUNTER(box_tests)},
    [RUN_LEAF_PAIRS] = {"leaf_pairs", COUNTER(leaf_pairs)},
    [RUN_CANDIDATES] = {"candidates", RUN_OWN},
    [RUN_ELEMENTARY] = {"elementary_tests", RUN_OWN},
    [RUN_SURVIVORS] = {"survivors", COUNTER(survivors)},
    [RUN_EXACT] = {"exact_queries", COUNTER(exact)},
    [RUN_RECONSTRUCTIONS] = {"reconstructions", COUNTER(rebuilds)},
    [RUN_RECONSTRUCTED_TRIANGLES] = {"reconstructed_triangles",
                                     COUNTER(rebuilt_triangles)},
    [RUN_SWAPS] = {"swaps", COUNTER(swaps)},
    [RUN_SWAPPED_TRIANGLES] = {"swapped_triangles", COUNTER(swapped_triangles)},
    [RUN_STILL_FEATURES] = {"still_features", COUNTER(still_features)},
    [RUN_STILL_PAIRS] = {"still_pairs", COUNTER(still_pairs)},
    [RUN_KEPT_RECORDS] = {"kept_records", COUNTER(kept_records)},
    [RUN_RIGID_OBJECTS] = {"rigid_objects", COUNTER(rigid_objects)},
    [RUN_THICK_CANDIDATES] = {"thick_candidates", COUNTER(thick_candidates)},
    [RUN_THICK_SURVIVORS] = {"thick_survivors", COUNTER(thick_survivors)},
    [RUN_THICK_EXACT] = {"thick_exact", COUNTER(thick_exact)},
    [RUN_CONTACTS] = {"contacts", RUN_OWN},
    [RUN_ALLOCS] = {"allocations", COUNTER(allocs)},
    [RUN_SCENE_BYTES] = {"scene_bytes", RUN_OWN},
    [RUN_PROCESS_BYTES] = {"process_bytes", RUN_OWN},
};

static void take(uint64_t *to, const struct run_quantity *quantity, const void *from)
{
    if (quantity->from != RUN_OWN) {
        memcpy(to, (const char *)from + quantity->from, sizeof *to);
    }
}

void run_frame_keep(struct run_frame *frame, const struct pccd_step_times *times,
                    const struct pccd_step_counters *counters)
{
    uint64_t phases = 0;
    for (enum run_time t = 0; t < RUN_TIMES; t++) {
        take(&frame->ns[t], &run_times[t], times);
        phases += t >= RUN_INGEST && t <= RUN_MERGE ? frame->ns[t] : 0;
    }
    frame->ns[RUN_REST] = frame->ns[RUN_STEP] > phases ? frame->ns[RUN_STEP] - phases : 0;
    for (enum run_count c = 0; c < RUN_COUNTS; c++) {
        take(&frame->counts[c], &run_counts[c], counters);
    }
    frame->counts[RUN_CANDIDATES] = 0;
    for (int kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        frame->counts[RUN_CANDIDATES] += counters->candidates[kind];
    }
}

void run_frames_hash(const struct run_frame *frames, uint32_t count,
                     char text[PROTO_HASH_BYTES])
{
    uint64_t(*words)[3] = bench_alloc(count, sizeof *words);
    for (uint32_t i = 0; i < count; i++) {
        words[i][0] = frames[i].number;
        words[i][1] = frames[i].hash[0];
        words[i][2] = frames[i].hash[1];
    }
    XXH128_hash_t hash = XXH3_128bits(words, count * sizeof *words);
    proto_hash_text(PCCD_HASH_VERSION, (const uint64_t[2]){hash.high64, hash.low64},
                    text);
    free(words);
}
