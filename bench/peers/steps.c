/* steps.c - whole steps: a library's pairs, then elementary tests, against the engine. */
#include "steps.h"

#include <stdio.h>
#include <stdlib.h>

#include "report.h"

#define PEERS_MAX 8u

struct stepper {
    const struct peer *peer; /* NULL: the engine */
    void *state;
    uint64_t contacts; /* of the last step */
    uint64_t spent_ns;
    struct bench_samples ms;
};

struct run {
    struct bench_world *world;
    const struct bench_frames *frames;
    struct eng_question settings;
    struct peers_tests *tests;
    struct stepper steppers[1 + PEERS_MAX]; /* the engine first */
    unsigned count;
};

/* Positions are staged, copied and checked within the engine's time. */
static uint64_t step_engine(struct run *run, struct stepper *stepper)
{
    struct eng_step_result result;
    uint64_t begin_ns = common_now_ns();
    bench_world_step(run->world, run->frames, &run->settings, &result);
    stepper->contacts = result.count;
    return common_now_ns() - begin_ns;
}

static uint64_t step_library(struct run *run, struct stepper *stepper)
{
    static struct peer_sink sinks[PEER_SINK_MAX];
    uint64_t begin_ns = common_now_ns();
    stepper->peer->update(stepper->state);
    peers_tests_begin(run->tests, sinks);
    stepper->peer->collide(stepper->state, sinks);
    stepper->contacts = peers_tests_end(run->tests, sinks);
    return common_now_ns() - begin_ns;
}

static void take_turn(struct run *run, struct stepper *stepper, bool counts)
{
    uint64_t ns = stepper->peer ? step_library(run, stepper) : step_engine(run, stepper);
    stepper->spent_ns += ns;
    if (counts) {
        bench_add(&stepper->ms, 1e-6 * (double)ns);
    }
}

static bool agree(const struct run *run)
{
    bool good = true;
    for (unsigned i = 1; i < run->count; i++) {
        char what[120];
        snprintf(what, sizeof what, "with the pairs of %s there are other contacts",
                 run->steppers[i].peer->name);
        good = bench_check(run->steppers[i].contacts == run->steppers[0].contacts,
                           run->world->source->name, what) &&
               good;
    }
    return good;
}

static void print(const struct run *run, uint32_t threads)
{
    for (unsigned i = 0; i < run->count; i++) {
        char what[80];
        snprintf(what, sizeof what, "%s, whole step, %u",
                 i == 0 ? "ours" : run->steppers[i].peer->name, threads);
        struct bench_row row = {.scene = run->world->source->name,
                                .what = what,
                                .unit = "ms",
                                .samples = &run->steppers[i].ms,
                                .base_name = "ours, whole step",
                                .base = &run->steppers[0].ms,
                                .threads = threads};
        bench_row(&row);
    }
}

void peers_steps(const struct peer *const *peers, unsigned peer_count,
                 struct bench_world *world, const struct bench_frames *frames,
                 const struct peer_input *input, uint32_t threads, unsigned repeats)
{
    struct run run = {.world = world, .frames = frames, .count = 1};
    run.settings = bench_step_settings(PCCD_MODE_ALL);
    run.settings.method = PCCD_METHOD_WIDE;
    run.settings.threads = threads;
    run.tests = peers_tests_new(input, world);
    for (unsigned i = 0; i < peer_count && run.count <= PEERS_MAX; i++) {
        if (threads == 1 || peers[i]->is_parallel) {
            struct stepper *stepper = &run.steppers[run.count];
            stepper->peer = peers[i];
            stepper->state = peers[i]->open(input, threads);
            run.count += stepper->state != NULL;
        }
    }
    for (unsigned r = 0; r <= repeats; r++) {
        for (unsigned i = 0; i < run.count; i++) {
            if (r <= 2 || run.steppers[i].spent_ns < PEERS_BUDGET_NS) {
                take_turn(&run, &run.steppers[i], r > 0);
            }
        }
    }
    if (agree(&run)) {
        print(&run, threads);
    }
    for (unsigned i = 0; i < run.count; i++) {
        if (run.steppers[i].peer) {
            run.steppers[i].peer->close(run.steppers[i].state);
        }
        bench_free(&run.steppers[i].ms);
    }
    peers_tests_free(run.tests);
}
