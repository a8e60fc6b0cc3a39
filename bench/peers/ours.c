/* ours.c - the method `wide`, asked as the libraries are. */
#include "steps.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "kernel.h"
#include "report.h"
#include "wide.h"
#include "wide_sweep.h"

struct ours {
    const struct bench_world *world;
    uint32_t threads;
    bool is_named;
    struct peer_sink *sinks;
    uint64_t refit_ns;
};

static const struct bench_world *next_world;

void peers_ours_scene(const struct bench_world *world)
{
    next_world = world;
}

/* Keys begin with an object's id; features of the libraries have the scene's indices. */
static uint32_t index_of(const struct bench_world *world, enum pccd_tree kind,
                         uint64_t key)
{
    uint32_t points = kind == PCCD_TREE_VERTICES ? 1 : kind == PCCD_TREE_EDGES ? 2 : 3;
    return peers_index(world, points, (uint32_t)(key >> 32), (uint32_t)key);
}

static void visit(void *context, enum pccd_kind kind, const uint64_t *a,
                  const uint64_t *b, uint32_t count)
{
    const struct ours *self = context;
    struct peer_sink *sink = &self->sinks[omp_get_thread_num()];
    for (uint32_t i = 0; i < count; i++) {
        peer_take(sink, (enum peer_kind)kind,
                  index_of(self->world, eng_wide_tree_of(kind, 0), a[i]),
                  index_of(self->world, eng_wide_tree_of(kind, 1), b[i]));
    }
}

static void version(char *text, size_t capacity)
{
    snprintf(text, capacity, "ours, instruction set %s", eng_kernels()->name);
}

static void *open_as(uint32_t threads, bool is_named)
{
    struct ours *self = bench_alloc(1, sizeof *self);
    *self = (struct ours){.world = next_world, .threads = threads, .is_named = is_named};
    return self;
}

static void *open_slots(const struct peer_input *input, uint32_t threads)
{
    (void)input;
    return open_as(threads, false);
}

static void *open_named(const struct peer_input *input, uint32_t threads)
{
    (void)input;
    return open_as(threads, true);
}

/* The trees are refitted and searched in one call. */
static void update(void *state)
{
    (void)state;
}

static void collide(void *state, struct peer_sink *sinks)
{
    struct ours *self = state;
    struct eng_wide_sweep sweep;
    self->sinks = sinks;
    bool is_visited = self->is_named || sinks[0].is_summed;
    bench_need(eng_wide_sweep(self->world->scene, self->threads,
                              is_visited ? visit : NULL, self, &sweep) == PCCD_OK,
               "the engine has no memory");
    if (!is_visited) {
        sinks[0].count[PEER_VF] += sweep.counts[PCCD_VF];
        sinks[0].count[PEER_EE] += sweep.counts[PCCD_EE];
    }
    self->refit_ns = sweep.refit_ns;
}

static uint64_t update_ns(void *state)
{
    return ((const struct ours *)state)->refit_ns;
}

const struct peer peers_ours = {.name = "ours",
                                .is_parallel = true,
                                .version = version,
                                .open = open_slots,
                                .update = update,
                                .collide = collide,
                                .close = free,
                                .update_ns = update_ns};

const struct peer peers_ours_named = {.name = "ours, named",
                                      .is_parallel = true,
                                      .version = version,
                                      .open = open_named,
                                      .update = update,
                                      .collide = collide,
                                      .close = free,
                                      .update_ns = update_ns};
