/* step_result.h - what a step returns, or a question about what is near: the answer, its
 * counters, its times, and what each thread did.
 *
 * Threads: [any]; types only.
 */
#ifndef ENG_STEP_RESULT_H
#define ENG_STEP_RESULT_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

/* The work of one thread in a step. Times in nanoseconds of that thread. */
struct eng_thread_record {
    uint64_t task_units; /* self-CD task units */
    uint64_t pairs;      /* pairs of nodes refined */
    uint64_t box_tests;  /* pairs of nodes tested */
    uint64_t tests;      /* elementary tests: candidates it sent to the filter */
    uint64_t steals;     /* tasks taken from others; nodes received from others */
    uint64_t requests;   /* rounds over the victims; requests placed */
    uint64_t given;      /* nodes handed to others (the paper's scheduler) */
    uint64_t sleeps;     /* times it slept, or offered its processor, without work */
    uint64_t rebuilds;   /* subtrees reconstructed during traversal */
    uint64_t lock_waits; /* times it waited for another's reconstruction */
    uint64_t refit_ns;
    uint64_t low_ns; /* traversal and tests; of high-level nodes: high_ns */
    uint64_t high_ns;
    uint64_t tests_ns;   /* of the two above: filters and solver */
    uint64_t rebuild_ns; /* of the two above: reconstruction */
    uint64_t wait_ns;    /* without work, between the step's barriers */
    uint64_t merge_ns;   /* sort and gather */
};

/* Counts of the ways in which pairs of thick features were decided. */
struct eng_thick_counters {
    uint64_t candidates; /* that were tested */
    uint64_t survivors;  /* of these, asked one by one; the rest was rejected in lanes */
    uint64_t exact;      /* of these, that took integers */
};

/* The numbers of a step, or of a question about what is near: those of numbers.h. */
struct eng_step_result {
    enum pccd_mode mode;      /* of a step */
    enum pccd_near_what what; /* of a question */
    enum pccd_method method;
    enum pccd_incomplete incomplete;
    enum pccd_verdict verdict; /* mode ANY and CROSSINGS, else PCCD_VERDICT_NONE */
    /* pccd_contact[], (mode PAIRS) pccd_pair[], pccd_near[] or (VERTICES) double[]; valid
     * until the scene's next step or question, removal or free. */
    const void *records;
    uint32_t record_bytes;
    uint64_t count;                  /* of the whole answer */
    uint64_t counts[PCCD_KINDS_MAX]; /* by enum pccd_kind and enum pccd_near_kind */
    uint64_t possible;
    uint64_t initial;
    uint64_t inside;  /* records with PCCD_INSIDE that are not PCCD_INITIAL */
    double toi_first; /* smallest toi; 2 without any record */
    /* More than half of the records begin within the distance, of a thick object or by
     * the separation: mostly a radius is above the length of an edge. Or more than half
     * are coincident. Not in mode pairs or any. */
    bool crowded;
    /* Records that touch at t = 0 in a vertex of both features, as where a surface is
     * split; 0 if anything is thick. */
    uint64_t coincident;
    /* Thin pairs that touch at t = 0, if it was asked what becomes of them: kept or left
     * out. 0 in modes any and pairs. */
    uint64_t entering;
    uint64_t sliding;
    uint64_t leaving;
    /* VERTICES: the least and the greatest bound by a pair, in the whole scene. */
    double distance_min; /* least d_lo; 2e18 without any record */
    double distance_max; /* greatest d_hi; 0 without any record */
    /* Edges that pass through faces: of DEPTH, CROSSINGS, and where they were asked for.
     * Of a step that tells how it begins, at t = 0; with an approach also the pairs that
     * are within their distance then. If there are any, the verdict is not NO: it is
     * YES. */
    uint64_t crossings;
    uint64_t start_inside;
    /* On [0, safe_step] no pair meets, and each is farther apart than the distance at
     * which it would: 1 where none meets; else the double just below toi_first. 0 if that
     * is 0, if there are crossings, or not known: of an incomplete answer, or of mode any
     * or pairs that is not empty. Of a part of the step: its ends in the place of 0 and
     * 1. */
    double safe_step;
    uint64_t hash[2]; /* version 2 of the hash of the answer: result/hash.h; of VERTICES
                       * over struct eng_vertex_bound; zeros with a gap */
    uint32_t threads;
    const struct eng_thread_record *thread_records; /* [threads]; valid as records */
    struct pccd_step_counters counters; /* times.queue is not the engine's: 0 */
    struct eng_thick_counters thick;
    struct pccd_step_times times;
    /* Status PCCD_E_INVAL of DEPTH: the object whose mesh is not closed, an edge of it,
     * by vertices, and how often its faces run through it from the first to the second
     * and back. */
    uint32_t open_object;
    uint32_t open_edge[2];
    uint32_t open_runs[2];
};

#endif
