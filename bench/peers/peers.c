/* peers.c - candidate pairs and whole steps by the libraries that are installed.
 *
 * All get the same boxes, and must find the same pairs. Of a whole step the pairs go to
 * our elementary tests, and the engine's own step stands beside it.
 */
#include <stdio.h>
#include <string.h>

#include "report.h"
#include "steps.h"

#define REPEATS_MAX 25u
#define THREADS_MAX 2u
#define BUDGET_NS   4000000000u /* for one library; it has two repeats at least */

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

struct options {
    struct bench_options bench;
    uint32_t threads;
};

enum { WHOLE, CPU, UPDATE, SIDES };

struct contestant {
    const struct peer *peer; /* NULL: the engine's own step */
    void *state;
    double ms[SIDES]; /* of its last turn; CPU: of all threads */
    uint64_t contacts;
    uint64_t spent_ns;
};

struct run {
    struct bench_world *world;
    const struct bench_frames *frames;
    struct peer_input input;
    struct peers_tests *tests; /* NULL: pairs alone are asked for */
    uint32_t threads;
    struct contestant all[INSTALLED + 1]; /* ratios are to the first */
    struct bench_side sides[INSTALLED + 1][SIDES];
    unsigned count;
};

struct totals {
    uint64_t count[2];
    uint64_t sum[2];
};

/* Pairs alone; `is_summed`: to be compared. */
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

/* Positions are staged, copied and checked within the engine's time. */
static void step_engine(struct run *run, struct contestant *one)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    struct eng_step_result result;
    settings.method = PCCD_METHOD_WIDE;
    settings.threads = run->threads;
    bench_world_step(run->world, run->frames, &settings, &result);
    one->contacts = result.count;
}

static void ask_library(struct run *run, struct contestant *one)
{
    static struct peer_sink sinks[PEER_SINK_MAX];
    if (run->tests) {
        peers_tests_begin(run->tests, sinks);
        one->peer->collide(one->state, sinks);
        one->contacts = peers_tests_end(run->tests, sinks);
    } else {
        collide(one, false);
    }
}

static void take_turn(struct run *run, struct contestant *one)
{
    uint64_t cpu0 = cpu_ns();
    uint64_t t0 = common_now_ns();
    uint64_t update_ns = 0;
    if (one->peer) {
        one->peer->update(one->state);
        update_ns = common_now_ns() - t0;
        ask_library(run, one);
        update_ns = one->peer->update_ns ? one->peer->update_ns(one->state) : update_ns;
    } else {
        step_engine(run, one);
    }
    uint64_t ns = common_now_ns() - t0;
    one->spent_ns += ns;
    one->ms[WHOLE] = 1e-6 * (double)ns;
    one->ms[CPU] = 1e-6 * (double)(cpu_ns() - cpu0);
    one->ms[UPDATE] = 1e-6 * (double)update_ns;
}

/* All sets against the first one's. */
static bool pairs_agree(const char *scene, const struct contestant *all, unsigned count)
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

static bool contacts_agree(const struct run *run)
{
    bool good = true;
    for (unsigned i = 1; i < run->count; i++) {
        char what[120];
        snprintf(what, sizeof what, "with the pairs of %s there are other contacts",
                 run->all[i].peer->name);
        good = bench_check(run->all[i].contacts == run->all[0].contacts,
                           run->world->source->name, what) &&
               good;
    }
    return good;
}

/* The contestant that comes next, if it can use so many threads. */
static void enter(struct run *run, const struct peer *peer)
{
    static const char *const of[SIDES] = {"", " cpu", " update"};
    struct contestant *one = &run->all[run->count];
    bool is_whole = run->tests != NULL;
    *one = (struct contestant){.peer = peer};
    if (peer && run->threads > 1 && !peer->is_parallel) {
        return;
    }
    if (peer && !(one->state = peer->open(&run->input, run->threads))) {
        return;
    }
    for (unsigned k = 0; k < SIDES; k++) {
        struct bench_side *side = &run->sides[run->count][k];
        *side = (struct bench_side){.unit = "ms", .threads = run->threads};
        side->base_name = k == UPDATE ? NULL : is_whole ? "ours, whole step" : "ours";
        snprintf(side->what, sizeof side->what, "%s%s, %u", peer ? peer->name : "ours",
                 is_whole ? ", whole step" : of[k], run->threads);
    }
    run->count++;
}

/* The sides of each, which are compared with the same sides of the first. */
static void print(struct run *run, bool are_right)
{
    for (unsigned i = 0; i < run->count && are_right; i++) {
        for (unsigned k = 0; k < (run->tests ? 1u : SIDES); k++) {
            bench_side_row(run->world->source->name, &run->sides[i][k],
                           &run->sides[0][k].samples);
        }
    }
    bench_sides_end("", run->sides[0], run->count * SIDES, false);
}

/* By turns; the first turn does not count. */
static void take_turns(struct run *run, unsigned repeats)
{
    for (unsigned r = 0; r <= repeats; r++) {
        for (unsigned i = 0; i < run->count; i++) {
            if (r > 2 && run->all[i].spent_ns >= BUDGET_NS) {
                continue;
            }
            take_turn(run, &run->all[i]);
            for (unsigned k = 0; k < SIDES && r > 0; k++) {
                bench_add(&run->sides[i][k].samples, run->all[i].ms[k]);
            }
        }
    }
}

static void measure(struct run *run, bool is_whole, unsigned repeats)
{
    run->count = 0;
    run->tests = is_whole ? peers_tests_new(&run->input, run->world) : NULL;
    if (is_whole) {
        enter(run, NULL);
    }
    for (unsigned i = is_whole ? OURS : 0; i < INSTALLED; i++) {
        enter(run, installed[i]);
    }
    bool are_right =
        is_whole || pairs_agree(run->world->source->name, run->all, run->count);
    if (are_right) {
        take_turns(run, repeats);
    }
    print(run, are_right && (!is_whole || contacts_agree(run)));
    for (unsigned i = 0; i < run->count; i++) {
        if (run->all[i].peer) {
            run->all[i].peer->close(run->all[i].state);
        }
    }
    if (is_whole) {
        peers_tests_free(run->tests);
    }
}

static void measure_scene(const struct bench_scene *source, const struct options *options)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ANY);
    struct eng_step_result result;
    struct bench_frames frames;
    struct bench_world world;
    struct run run = {.world = &world, .frames = &frames};
    unsigned repeats = options->bench.smoke ? 2 : REPEATS_MAX;
    bench_heading(source->name);
    bench_frames_init(&frames, source, source->hard_frame);
    bench_world_init(&world, &frames, NULL);
    bench_world_step(&world, &frames, &settings, &result);
    peers_swept_init(&run.input, &world);
    peers_ours_scene(&world);
    for (run.threads = 1; run.threads <= options->threads; run.threads *= 2) {
        measure(&run, false, repeats);
        measure(&run, true, repeats);
    }
    bench_frames_deinit(&frames);
    peers_swept_deinit(&run.input);
    bench_world_deinit(&world);
}

int main(int argc, char **argv)
{
    static const struct option_row rows[] = {
        {"threads", 0, "N", "at most so many (default 2)", OPTION_U32,
         .at = offsetof(struct options, threads), .min = 2, .max = PEER_SINK_MAX},
        {0}};
    struct options options = {.threads = THREADS_MAX};
    bench_team_environment(argv);
    bench_begin("peers", rows, argc, argv, &options.bench);
    for (unsigned i = 1; i < INSTALLED; i++) {
        char text[80];
        installed[i]->version(text, sizeof text);
        fprintf(stderr, "peers: %s\n", text);
    }
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(
             &options.bench, options.bench.wanted ? NULL : usual, &i, &scene);) {
        measure_scene(&scene, &options);
        bench_scene_free(&scene);
    }
    return bench_end();
}
