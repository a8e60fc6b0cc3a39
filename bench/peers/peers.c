/* peers.c - candidate pairs: the libraries that are installed, in one run.
 *
 * Give every library, and the method `wide`, the same boxes, compare the sets of pairs
 * that come back, then time them by turns: refit or whatever the library has for boxes
 * that moved, and all pairs; and whole steps (steps.h).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"
#include "steps.h"

#define REPEATS_MAX 25u
#define THREADS_MAX 2u

static const struct peer *const installed[] = {
    &peers_ours, /* the others' ratios are to this one */
    &peers_ours_named,
#ifdef PEERS_EMBREE
    &peer_embree,
#endif
#ifdef PEERS_BULLET
    &peer_bullet,
#endif
#ifdef PEERS_FCL
    &peer_fcl,
#endif
#ifdef PEERS_CGAL
    &peer_cgal,
#endif
};
enum { INSTALLED = sizeof installed / sizeof installed[0], OURS = 2 };

/* Scenes that are measured when none is named: the paper's, told and recorded. */
static const char *const usual[] = {"cloth",        "breaking",     "bodies",
                                    "cloth-ball",   "n-body",       "cloth-ball-fifth",
                                    "n-body-fifth", "cloth-funnel", NULL};

struct contestant {
    const struct peer *peer;
    void *state;
    struct bench_samples update_ms;
    struct bench_samples whole_ms;
    struct bench_samples cpu_ms; /* of all threads */
    uint64_t spent_ns;
};

struct totals {
    uint64_t count[2];
    uint64_t sum[2];
};

static struct totals collide(const struct contestant *one, bool is_summed)
{
    static struct peer_sink sinks[PEER_SINK_MAX];
    struct totals totals = {{0, 0}, {0, 0}};
    for (unsigned i = 0; i < PEER_SINK_MAX; i++) {
        memset(&sinks[i], 0, offsetof(struct peer_sink, ring));
        sinks[i].is_summed = is_summed;
    }
    one->peer->collide(one->state, sinks);
    for (unsigned i = 0; i < PEER_SINK_MAX; i++) {
        for (int kind = 0; kind < 2; kind++) {
            totals.count[kind] += sinks[i].count[kind];
            totals.sum[kind] += sinks[i].sum[kind];
        }
    }
    return totals;
}

static uint64_t cpu_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void take_turn(struct contestant *one, bool counts)
{
    uint64_t cpu0 = cpu_ns();
    uint64_t t0 = common_now_ns();
    one->peer->update(one->state);
    uint64_t t1 = common_now_ns();
    collide(one, false);
    uint64_t t2 = common_now_ns();
    uint64_t update_ns =
        one->peer->update_ns ? one->peer->update_ns(one->state) : t1 - t0;
    uint64_t cpu1 = cpu_ns();
    one->spent_ns += t2 - t0;
    if (counts) {
        bench_add(&one->update_ms, 1e-6 * (double)update_ns);
        bench_add(&one->whole_ms, 1e-6 * (double)(t2 - t0));
        bench_add(&one->cpu_ms, 1e-6 * (double)(cpu1 - cpu0));
    }
}

/* All sets against the first one's. */
static bool agree(const char *scene, const struct contestant *all, unsigned count)
{
    struct totals first = {{0, 0}, {0, 0}};
    bool good = true;
    for (unsigned i = 0; i < count; i++) {
        char what[120];
        all[i].peer->update(all[i].state);
        struct totals totals = collide(&all[i], true);
        if (i == 0) {
            first = totals;
        }
        snprintf(what, sizeof what, "%s finds another set of pairs than %s",
                 all[i].peer->name, all[0].peer->name);
        good =
            bench_check(memcmp(&totals, &first, sizeof totals) == 0, scene, what) && good;
    }
    bench_number(scene, "VF pairs", "", (double)first.count[0]);
    bench_number(scene, "EE pairs", "", (double)first.count[1]);
    return good;
}

static void print_row(const struct bench_row *like, const char *name, const char *of,
                      const struct bench_samples *samples,
                      const struct bench_samples *base)
{
    char what[80];
    struct bench_row row = *like;
    snprintf(what, sizeof what, "%s%s, %u", name, of, like->threads);
    row.what = what;
    row.unit = "ms";
    row.samples = samples;
    row.base = base;
    row.base_name = base ? like->base_name : NULL;
    bench_row(&row);
}

static void print(const char *scene, const struct contestant *all, unsigned count,
                  uint32_t threads)
{
    for (unsigned i = 0; i < count; i++) {
        const char *name = all[i].peer->name;
        struct bench_row row = {
            .scene = scene, .threads = threads, .base_name = all[0].peer->name};
        print_row(&row, name, "", &all[i].whole_ms, &all[0].whole_ms);
        print_row(&row, name, " cpu", &all[i].cpu_ms, &all[0].cpu_ms);
        print_row(&row, name, " update", &all[i].update_ms, NULL);
    }
}

/* All that can use so many threads. */
static void measure(const char *scene, const struct peer_input *input, uint32_t threads,
                    unsigned repeats)
{
    struct contestant all[INSTALLED] = {{0}};
    unsigned count = 0;
    for (unsigned i = 0; i < INSTALLED; i++) {
        all[count].peer = installed[i];
        if (threads == 1 || installed[i]->is_parallel) {
            all[count].state = installed[i]->open(input, threads);
            count += all[count].state != NULL;
        }
    }
    if (count > 0 && agree(scene, all, count)) {
        for (unsigned r = 0; r <= repeats; r++) {
            for (unsigned i = 0; i < count; i++) {
                if (r <= 2 || all[i].spent_ns < PEERS_BUDGET_NS) {
                    take_turn(&all[i], r > 0);
                }
            }
        }
        print(scene, all, count, threads);
    }
    for (unsigned i = 0; i < count; i++) {
        all[i].peer->close(all[i].state);
        bench_free(&all[i].update_ms);
        bench_free(&all[i].whole_ms);
        bench_free(&all[i].cpu_ms);
    }
}

static void measure_scene(const struct bench_scene *source,
                          const struct bench_options *options)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ANY);
    struct eng_step_result result;
    struct bench_frames frames;
    struct bench_world world;
    struct peer_input input;
    bench_heading(source->name);
    bench_frames_init(&frames, source, source->hard_frame);
    bench_world_init(&world, &frames, NULL);
    bench_world_step(&world, &frames, &settings, &result);
    peers_swept_init(&input, &world);
    peers_ours_scene(&world);
    uint32_t most =
        options->number[BENCH_THREADS] ? options->number[BENCH_THREADS] : THREADS_MAX;
    for (uint32_t threads = 1; threads <= most; threads *= 2) {
        measure(source->name, &input, threads, options->smoke ? 2 : REPEATS_MAX);
        peers_steps(installed + OURS, INSTALLED - OURS, &world, &frames, &input, threads,
                    options->smoke ? 2 : REPEATS_MAX);
    }
    bench_frames_deinit(&frames);
    peers_swept_deinit(&input);
    bench_world_deinit(&world);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    int exit_status;
    bench_team_environment(argv);
    if (!bench_begin("peers", 1u << BENCH_THREADS, argc, argv, &options, &exit_status)) {
        return exit_status;
    }
    for (unsigned i = 1; i < INSTALLED; i++) {
        char text[80];
        installed[i]->version(text, sizeof text);
        fprintf(stderr, "peers: %s\n", text);
    }
    struct bench_scene scene;
    for (unsigned i = 0;
         bench_next_scene(&options, options.wanted ? NULL : usual, &i, &scene);) {
        measure_scene(&scene, &options);
        bench_scene_free(&scene);
    }
    return bench_end();
}
