/* tests.c - the elementary tests of a library's pairs. */
#include "steps.h"

#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "exact.h"
#include "kernel.h"
#include "report.h"
#include "world.h"

/* One thread's. */
struct tester {
    const struct peers_tests *tests;
    uint64_t contacts;
    struct eng_exact exact;
    struct eng_batch batch;
    uint32_t quads[PEER_RING][4];
};

struct peers_tests {
    const struct peer_input *input;
    struct eng_point *points; /* by vertex */
    struct tester testers[PEER_SINK_MAX];
};

static void test(void *context, enum peer_kind kind, const uint32_t (*pairs)[2],
                 uint32_t count)
{
    struct tester *tester = context;
    const struct peer_features *groups = tester->tests->input->groups;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t *quad = tester->quads[i];
        if (kind == PEER_VF) {
            quad[0] = pairs[i][0];
            memcpy(quad + 1, groups[PEER_FACES].corners[pairs[i][1]], 3 * sizeof *quad);
        } else {
            memcpy(quad, groups[PEER_EDGES].corners[pairs[i][0]], 2 * sizeof *quad);
            memcpy(quad + 2, groups[PEER_EDGES].corners[pairs[i][1]], 2 * sizeof *quad);
        }
    }
    const struct eng_question question = ENG_QUESTION_DEFAULT;
    const struct eng_pairs asked = {.question = &question,
                                    .kind = (uint32_t)kind,
                                    .count = count,
                                    .points = tester->tests->points,
                                    .quads = (const uint32_t(*)[4])tester->quads,
                                    .t_end = 1};
    tester->contacts += eng_batch_test(&tester->batch, &asked);
}

struct peers_tests *peers_tests_new(const struct peer_input *input,
                                    const struct bench_world *world)
{
    struct peers_tests *tests = bench_alloc(1, sizeof *tests);
    const struct eng_scene *scene = world->scene;
    size_t bytes = input->groups[PEER_VERTICES].count * sizeof *tests->points;
    memset(tests, 0, sizeof *tests);
    tests->input = input;
    tests->points = aligned_alloc(_Alignof(struct eng_point), bytes);
    if (!tests->points) {
        exit(2);
    }
    memset(tests->points, 0, bytes);
    for (uint32_t i = 0; i < input->groups[PEER_VERTICES].count; i++) {
        struct eng_point *point = &tests->points[i];
        memcpy(point->x0, scene->x[1 - scene->now][i], sizeof point->x0);
        memcpy(point->x1, scene->x[scene->now][i], sizeof point->x1);
    }
    for (unsigned i = 0; i < PEER_SINK_MAX; i++) {
        tests->testers[i].tests = tests;
        if (eng_exact_init(&tests->testers[i].exact) != PCCD_OK) {
            abort();
        }
    }
    return tests;
}

void peers_tests_free(struct peers_tests *tests)
{
    for (unsigned i = 0; i < PEER_SINK_MAX; i++) {
        eng_exact_deinit(&tests->testers[i].exact);
    }
    free(tests->points);
    free(tests);
}

void peers_tests_begin(struct peers_tests *tests, struct peer_sink sinks[PEER_SINK_MAX])
{
    for (unsigned i = 0; i < PEER_SINK_MAX; i++) {
        memset(&sinks[i], 0, offsetof(struct peer_sink, ring));
        tests->testers[i].contacts = 0;
        /* Nothing is known of the pairs, and nothing that would stop the tests. */
        tests->testers[i].batch.should_stop = NULL;
        tests->testers[i].batch.kernels = eng_kernels();
        tests->testers[i].batch.contacts = &tests->testers[i].exact;
        sinks[i].test = test;
        sinks[i].tester = &tests->testers[i];
    }
}

uint64_t peers_tests_end(struct peers_tests *tests, struct peer_sink sinks[PEER_SINK_MAX])
{
    uint64_t contacts = 0;
    for (unsigned i = 0; i < PEER_SINK_MAX; i++) {
        for (int kind = 0; kind < 2; kind++) {
            test(&tests->testers[i], (enum peer_kind)kind, sinks[i].ring[kind],
                 (uint32_t)(sinks[i].count[kind] % PEER_RING));
        }
        contacts += tests->testers[i].contacts;
    }
    return contacts;
}
