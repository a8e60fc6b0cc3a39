/* frame.c - what is kept of one step. */
#include "frame.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <xxhash.h>

#include "report.h"

const char *const run_time_names[RUN_TIMES] = {
    [RUN_STEP] = "step",
    [RUN_INGEST] = "ingest",
    [RUN_REFIT] = "refit",
    [RUN_TRAVERSAL] = "traversal",
    [RUN_TESTS] = "tests",
    [RUN_MERGE] = "merge",
    [RUN_REST] = "rest",
    [RUN_LOW] = "low",
    [RUN_HIGH] = "high",
    [RUN_REBUILD] = "rebuild",
    [RUN_REFIT_WORK] = "refit_work",
    [RUN_LOW_WORK] = "low_work",
    [RUN_HIGH_WORK] = "high_work",
    [RUN_MERGE_WORK] = "merge_work",
    [RUN_WAIT] = "wait",
    [RUN_WALL] = "wall",
};

const char *const run_count_names[RUN_COUNTS] = {
    [RUN_TASK_UNITS] = "task_units",
    [RUN_BOX_TESTS] = "box_tests",
    [RUN_LEAF_PAIRS] = "leaf_pairs",
    [RUN_CANDIDATES] = "candidates",
    [RUN_ELEMENTARY] = "elementary_tests",
    [RUN_SURVIVORS] = "survivors",
    [RUN_EXACT] = "exact_queries",
    [RUN_RECONSTRUCTIONS] = "reconstructions",
    [RUN_RECONSTRUCTED_TRIANGLES] = "reconstructed_triangles",
    [RUN_SWAPS] = "swaps",
    [RUN_SWAPPED_TRIANGLES] = "swapped_triangles",
    [RUN_STILL_FEATURES] = "still_features",
    [RUN_STILL_PAIRS] = "still_pairs",
    [RUN_KEPT_RECORDS] = "kept_records",
    [RUN_RIGID_OBJECTS] = "rigid_objects",
    [RUN_THICK_CANDIDATES] = "thick_candidates",
    [RUN_THICK_SURVIVORS] = "thick_survivors",
    [RUN_THICK_EXACT] = "thick_exact",
    [RUN_CONTACTS] = "contacts",
    [RUN_ALLOCS] = "allocations",
    [RUN_SCENE_BYTES] = "scene_bytes",
    [RUN_PROCESS_BYTES] = "process_bytes",
};

void run_frame_set_rest(struct run_frame *frame)
{
    uint64_t phases = 0;
    for (int t = RUN_INGEST; t <= RUN_MERGE; t++) {
        phases += frame->ns[t];
    }
    frame->ns[RUN_REST] = frame->ns[RUN_STEP] > phases ? frame->ns[RUN_STEP] - phases : 0;
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
