/* frame.h - the times and counts of one measured step. */
#ifndef RUN_FRAME_H
#define RUN_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"
#include "printable.h"

#define RUN_UNKNOWN UINT64_MAX /* this way to ask does not tell */

enum run_time {
    RUN_STEP, /* as who computes it says: ingest to the finished result */
    RUN_INGEST,
    RUN_REFIT,
    RUN_TRAVERSAL,
    RUN_TESTS, /* elementary tests */
    RUN_MERGE,
    RUN_REST,       /* of the step: what is none of the five */
    RUN_LOW,        /* traversal and tests once more, by low-level nodes */
    RUN_HIGH,       /* and by high-level ones (the paper's scheduler, several threads) */
    RUN_REBUILD,    /* within these, the sum over the threads: reconstruction */
    RUN_REFIT_WORK, /* of all threads, as far as who is asked tells: engine only */
    RUN_LOW_WORK,
    RUN_HIGH_WORK,
    RUN_MERGE_WORK,
    RUN_WAIT, /* for other threads */
    RUN_WALL, /* by the clock of who asks: from the first position handed over */
    RUN_TIMES
};

enum run_count {
    RUN_TASK_UNITS,
    RUN_BOX_TESTS,
    RUN_LEAF_PAIRS,
    RUN_CANDIDATES,      /* pairs of features whose boxes overlap */
    RUN_ELEMENTARY,      /* of these, given to the elementary tests */
    RUN_SURVIVORS,       /* of these, not rejected by filters */
    RUN_EXACT,           /* of these, decided by exact arithmetic */
    RUN_RECONSTRUCTIONS, /* of subtrees, while traversing */
    RUN_RECONSTRUCTED_TRIANGLES,
    RUN_SWAPS, /* made in the background, as far as time allows, and put in place */
    RUN_SWAPPED_TRIANGLES,
    RUN_STILL_FEATURES,
    RUN_STILL_PAIRS,
    RUN_KEPT_RECORDS,
    RUN_RIGID_OBJECTS,
    RUN_THICK_CANDIDATES, /* that meet at a distance */
    RUN_THICK_SURVIVORS,  /* of these, asked one by one */
    RUN_THICK_EXACT,      /* of these, decided by exact arithmetic */
    RUN_CONTACTS,         /* records: pairs in mode pairs, none in mode any */
    RUN_ALLOCS,
    RUN_SCENE_BYTES,   /* resident: the scene and its meshes; from here on no sums */
    RUN_PROCESS_BYTES, /* resident: the process that computes */
    RUN_COUNTS
};

/* Name of a quantity, and where it lies in the times or the counters of an answer. */
struct run_quantity {
    const char *name;
    size_t from; /* RUN_OWN: who asks sets it */
};
#define RUN_OWN SIZE_MAX

extern const struct run_quantity run_times[RUN_TIMES];
extern const struct run_quantity run_counts[RUN_COUNTS];

struct run_frame {
    uint32_t number;  /* the step goes from frame `number` to the next */
    uint32_t threads; /* that took part */
    uint64_t ns[RUN_TIMES];
    uint64_t counts[RUN_COUNTS];
    uint64_t hash[2]; /* of the answer: high, low */
};

/* Take what an answer says of a step. */
void run_frame_keep(struct run_frame *frame, const struct pccd_step_times *times,
                    const struct pccd_step_counters *counters);

/* XXH3-128 of all numbers and hashes, and in front the version of these hashes. */
void run_frames_hash(const struct run_frame *frames, uint32_t count,
                     char text[PROTO_HASH_BYTES]);

#endif
