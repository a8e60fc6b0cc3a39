/* gather.h - collects the work of a real step for benchmarks of single parts. */
#ifndef BENCH_GATHER_H
#define BENCH_GATHER_H

#include "query.h"
#include "resident.h"
#include "result.h"
#include "world.h"

/* Candidates of one kind as global indices, evenly taken from all; the queries are loaded
 * when they are measured, as in a step. */
struct bench_candidates {
    enum pccd_kind kind;
    uint32_t count;
    uint32_t *a;
    uint32_t *b;
};

struct bench_work {
    struct bench_world world;
    struct bench_candidates vf;
    struct bench_candidates ee;
    struct eng_pool pool;   /* of `found` */
    struct eng_found found; /* candidate pairs, unsorted; a copy */
};

/* At most `query_max` candidates of each kind. */
void bench_work_init(struct bench_work *work, const struct bench_scene *source,
                     uint32_t query_max);
void bench_work_deinit(struct bench_work *work);

/* The engine's sort of records beside qsort: `repeats` of each, the first not counted;
 * the records as pairs and, of the first of them, as contacts. */
void bench_sorting_measure(const struct bench_work *work, unsigned repeats);

#endif
