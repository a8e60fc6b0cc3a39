/* near.c - what is near, asked of us and of ipc-toolkit by turns; exact integers decide
 * who is right. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "families.h"
#include "near_ours.h"

#define REPEATS_MAX 15u
#define THREADS_MAX 2u
#define BUDGET_NS   4000000000u /* for one quantity; it has two repeats at least */

static const struct near_peer *const peer =
#ifdef PEERS_IPC_TOOLKIT
    &near_ipc_toolkit;
#else
    NULL;
#endif

/* Scenes that are measured when none is named. */
static const char *const usual[] = {"cloth-20k",    "bodies", "cloth-ball",
                                    "cloth-funnel", "n-body", NULL};

/* Questions to ours; those that do not move anything are asked where the scene stands. */
static const struct {
    const char *name;
    enum pccd_near_what what;
    bool moves;
} asked[] = {{"pairs", PCCD_NEAR_PAIRS, true},
             {"features", PCCD_NEAR_FEATURES, true},
             {"features, at rest", PCCD_NEAR_FEATURES, false},
             {"vertices", PCCD_NEAR_VERTICES, true},
             {"crossings", PCCD_NEAR_CROSSINGS, true}};
enum { ASKED = sizeof asked / sizeof asked[0] };

/* Questions to the other library, and for each the one of ours that it is compared
 * with. */
enum { THEIR_PAIRS, THEIR_FEATURES, THEIR_VERTICES, THEIRS };
static const char *const their_name[THEIRS] = {"pairs", "features", "vertices"};
static const unsigned beside[THEIRS] = {0, 1, 3};

struct run {
    const char *name; /* of the scene, with the distance */
    struct bench_world *world;
    const struct bench_frames *frames;
    const struct near_input *input;
    double d;
    void *theirs; /* NULL: there is no other library */
    struct near_quantity step[THREADS_MAX];
    struct near_quantity ours[THREADS_MAX][ASKED];
    struct near_quantity others[THEIRS];
};

/* ---- sets -------------------------------------------------------------------------- */

static void count(const char *scene, const char *who, const char *what, double value)
{
    char text[100];
    snprintf(text, sizeof text, "%s: %s", who, what);
    bench_number(scene, text, "", value);
}

static void ask_theirs(const struct run *run, struct near_answers *answers,
                       uint64_t *relabelled)
{
    answers->pair_count = peer->pairs(run->theirs, run->d);
    answers->pairs = bench_alloc(answers->pair_count, sizeof *answers->pairs);
    peer->take_pairs(run->theirs, answers->pairs);
    answers->feature_count = peer->features(run->theirs, run->d);
    answers->features = bench_alloc(answers->feature_count, sizeof *answers->features);
    peer->take_features(run->theirs, answers->features, relabelled);
    answers->bounds = bench_alloc(run->input->vertex_count, sizeof *answers->bounds);
    peer->vertices(run->theirs, run->d, answers->bounds);
}

/* Print where the library differs from exact integers. */
static void print_theirs(const char *scene, const struct near_verdict *verdict,
                         uint64_t relabelled)
{
    count(scene, "theirs", "pairs missing", (double)verdict->missing);
    count(scene, "theirs", "missing at d itself", (double)verdict->at_bound);
    count(scene, "theirs", "pairs too many", (double)verdict->surplus);
    count(scene, "theirs", "squares off 1e-6", (double)verdict->distances);
    count(scene, "theirs", "other closest", (double)verdict->closest);
    count(scene, "theirs", "merged differ", (double)verdict->merged);
    count(scene, "theirs", "near-parallel", (double)relabelled);
    count(scene, "theirs", "bounds too far", (double)verdict->bounds);
    count(scene, "theirs", "too far by, most", verdict->most);
}

static bool judge(struct run *run)
{
    struct near_ours ours;
    struct near_answers theirs = {0};
    struct near_verdict of_ours;
    struct near_verdict of_theirs;
    uint64_t relabelled = 0;
    near_ours_ask(&ours, run->world, run->frames, run->d);
    if (run->theirs) {
        ask_theirs(run, &theirs, &relabelled);
    }
    near_judge(run->input, run->d, &ours, run->theirs ? &theirs : NULL, &of_ours,
               &of_theirs);
    uint64_t wrong = of_ours.missing + of_ours.surplus + of_ours.distances +
                     of_ours.closest + of_ours.merged + of_ours.bounds;
    bench_number(run->name, "distance", "", run->d);
    bench_number(run->name, "pairs", "", (double)of_ours.pairs);
    bench_number(run->name, "closest features", "", (double)of_ours.features);
    count(run->name, "ours", "wrong", (double)wrong);
    if (run->theirs) {
        print_theirs(run->name, &of_theirs, relabelled);
    }
    near_ours_free(&ours);
    free(theirs.pairs);
    free(theirs.features);
    free(theirs.bounds);
    return bench_check(wrong == 0, run->name, "ours is not what exact integers say");
}

/* ---- times ------------------------------------------------------------------------- */

/* A step to the end of the frames, so that a question that moves goes back from there. */
static void take_step(struct run *run, uint32_t threads, bool counts)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    struct eng_step_result result;
    settings.method = PCCD_METHOD_WIDE;
    settings.threads = threads;
    uint64_t begin_ns = common_now_ns();
    bench_world_step(run->world, run->frames, &settings, &result);
    near_keep(&run->step[threads - 1], begin_ns, counts);
}

static void ask_ours(struct run *run, uint32_t threads, unsigned i, bool counts)
{
    struct eng_question settings = near_ours_settings(asked[i].what, run->d, threads);
    struct eng_step_result result;
    if (asked[i].moves) {
        take_step(run, threads, counts);
    }
    uint64_t begin_ns = common_now_ns();
    bench_world_near(run->world, run->frames, asked[i].moves, &settings, &result);
    near_keep(&run->ours[threads - 1][i], begin_ns, counts);
    bench_check(result.incomplete == PCCD_COMPLETE, run->name, "incomplete");
}

static void ask_other(struct run *run, unsigned i, double *bounds, bool counts)
{
    uint64_t begin_ns = common_now_ns();
    if (i == THEIR_PAIRS) {
        peer->pairs(run->theirs, run->d);
    } else if (i == THEIR_FEATURES) {
        peer->features(run->theirs, run->d);
    } else {
        peer->vertices(run->theirs, run->d, bounds);
    }
    near_keep(&run->others[i], begin_ns, counts);
}

static bool has_turn(const struct near_quantity *quantity, unsigned r)
{
    return r <= 2 || quantity->spent_ns < BUDGET_NS;
}

static void take_turns(struct run *run, uint32_t most, unsigned repeats)
{
    double *bounds = bench_alloc(run->input->vertex_count, sizeof *bounds);
    for (unsigned r = 0; r <= repeats; r++) {
        for (uint32_t threads = 1; threads <= most; threads++) {
            for (unsigned i = 0; i < ASKED; i++) {
                if (has_turn(&run->ours[threads - 1][i], r)) {
                    ask_ours(run, threads, i, r > 0);
                }
            }
        }
        for (unsigned i = 0; i < THEIRS && run->theirs; i++) {
            if (has_turn(&run->others[i], r)) {
                ask_other(run, i, bounds, r > 0);
            }
        }
    }
    free(bounds);
}

static struct bench_side side_of(const char *who, const char *what, uint32_t threads,
                                 const struct near_quantity *quantity)
{
    struct bench_side side = {.unit = "ms", .threads = threads, .samples = quantity->ms};
    snprintf(side.what, sizeof side.what, "%s, %s, %u", who, what, threads);
    return side;
}

static void print_row(const char *scene, struct bench_side side, const char *base_name,
                      const struct near_quantity *base)
{
    side.base_name = base_name;
    bench_side_row(scene, &side, base ? &base->ms : NULL);
}

static void print(const struct run *run, uint32_t most)
{
    for (uint32_t threads = 1; threads <= most; threads++) {
        const struct near_quantity *step = &run->step[threads - 1];
        print_row(run->name, side_of("ours", "contact step", threads, step), NULL, NULL);
        for (unsigned i = 0; i < ASKED; i++) {
            print_row(run->name,
                      side_of("ours", asked[i].name, threads, &run->ours[threads - 1][i]),
                      "contact step", step);
        }
    }
    for (unsigned i = 0; i < THEIRS && run->theirs; i++) {
        print_row(run->name, side_of(peer->name, their_name[i], 1, &run->others[i]),
                  "ours", &run->ours[0][beside[i]]);
    }
    for (uint32_t threads = 2; threads <= most; threads++) {
        for (unsigned i = 0; i < ASKED; i++) {
            print_row(run->name,
                      side_of("one thread", asked[i].name, threads, &run->ours[0][i]),
                      "so many", &run->ours[threads - 1][i]);
        }
    }
}

static void run_free(struct run *run)
{
    for (unsigned t = 0; t < THREADS_MAX; t++) {
        bench_free(&run->step[t].ms);
        for (unsigned i = 0; i < ASKED; i++) {
            bench_free(&run->ours[t][i].ms);
        }
    }
    for (unsigned i = 0; i < THEIRS; i++) {
        bench_free(&run->others[i].ms);
    }
}

/* ---- scenes ------------------------------------------------------------------------ */

static void measure(const char *name, struct bench_world *world,
                    const struct bench_frames *frames, const struct near_input *input,
                    double d, const struct bench_options *options)
{
    struct run run = {.name = name,
                      .world = world,
                      .frames = frames,
                      .input = input,
                      .d = d,
                      .theirs = peer ? peer->open(input) : NULL};
    if (judge(&run)) {
        take_turns(&run, THREADS_MAX, options->smoke ? 1 : REPEATS_MAX);
        print(&run, THREADS_MAX);
    }
    if (run.theirs) {
        peer->close(run.theirs);
    }
    run_free(&run);
}

static void measure_shares(const struct bench_scene *source, struct bench_world *world,
                           const struct bench_frames *frames,
                           const struct near_input *input,
                           const struct bench_options *options)
{
    static const double shares[] = {1e-3, 2.5e-3};
    bool is_told = strcmp(source->name, "cloth-ball") == 0;
    for (unsigned i = 0; i < (is_told ? 2 : 1); i++) {
        char name[80];
        double share = options->smoke ? 5e-3 : shares[i];
        snprintf(name, sizeof name, "%s, %g", source->name, share);
        measure(name, world, frames, input, share * bench_frames_diagonal(frames),
                options);
    }
}

static void measure_scene(const struct bench_scene *source, double d,
                          const struct bench_options *options)
{
    struct near_scene scene;
    near_scene_init(&scene, source);
    if (d > 0) {
        measure(source->name, &scene.world, &scene.frames, &scene.input, d, options);
    } else {
        measure_shares(source, &scene.world, &scene.frames, &scene.input, options);
    }
    near_scene_deinit(&scene);
}

/* ---- two bodies -------------------------------------------------------------------- */

/* Questions about two bodies after each step that moves both; by one thread. */
static const struct {
    const char *name;
    enum pccd_near_what what;
} of_two[] = {{"nearest, warm", PCCD_NEAR_NEAREST}, {"depth", PCCD_NEAR_DEPTH}};
enum { OF_TWO = sizeof of_two / sizeof of_two[0] };

static void ask_of_two(struct bench_world *world, const struct bench_frames *frames,
                       enum pccd_near_what what, struct near_quantity *quantity)
{
    struct eng_question settings = near_ours_settings(what, 0, 1);
    struct eng_step_result result;
    settings.distance = what == PCCD_NEAR_NEAREST ? INFINITY : 0;
    uint64_t begin_ns = common_now_ns();
    bench_world_near(world, frames, false, &settings, &result);
    near_keep(quantity, begin_ns, true);
    bench_check(result.incomplete == PCCD_COMPLETE, "passing", "incomplete");
}

static void measure_passing(const struct bench_options *options)
{
    struct bench_scene scene = {.name = "passing"};
    struct bench_frames frames;
    struct bench_world world;
    struct near_quantity step = {0};
    struct near_quantity asked_of[OF_TWO] = {0};
    bench_make_passing(&scene, options->smoke);
    bench_frames_init(&frames, &scene, 0);
    bench_world_init(&world, &frames, NULL);
    for (uint32_t i = 0; i + 1 < scene.frame_count; i++) {
        struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
        struct eng_step_result result;
        settings.method = PCCD_METHOD_WIDE;
        bench_frames_seek(&frames, i);
        uint64_t begin_ns = common_now_ns();
        bench_world_step(&world, &frames, &settings, &result);
        near_keep(&step, begin_ns, true);
        for (unsigned k = 0; k < OF_TWO; k++) {
            ask_of_two(&world, &frames, of_two[k].what, &asked_of[k]);
        }
    }
    print_row(scene.name, side_of("ours", "contact step", 1, &step), NULL, NULL);
    bench_free(&step.ms);
    for (unsigned k = 0; k < OF_TWO; k++) {
        print_row(scene.name, side_of("ours", of_two[k].name, 1, &asked_of[k]), NULL,
                  NULL);
        bench_free(&asked_of[k].ms);
    }
    bench_world_deinit(&world);
    bench_frames_deinit(&frames);
    bench_scene_free(&scene);
}

static void measure_near(const struct bench_options *options)
{
    struct bench_scene scene;
    for (unsigned i = 0;
         bench_next_scene(options, options->wanted ? NULL : usual, &i, &scene);) {
        measure_scene(&scene, 0, options);
        bench_scene_free(&scene);
    }
    if (bench_is_wanted(options, "needles")) {
        scene = (struct bench_scene){.name = "needles"};
        bench_make_needles(&scene, options->smoke);
        measure_scene(&scene, 2, options);
        bench_scene_free(&scene);
    }
    if (bench_is_wanted(options, "passing")) {
        measure_passing(options);
    }
}

/* With "allowed" as the first argument: how much of a step is safe. */
int main(int argc, char **argv)
{
    struct bench_options options = {.smoke = false};
    bench_team_environment(argv);
    bool is_allowed = argc > 1 && strcmp(argv[1], "allowed") == 0;
    bench_begin(is_allowed ? "allowed" : "near", NULL, argc - is_allowed,
                argv + is_allowed, &options);
    if (!peer) {
        bench_skip("ipc-toolkit", "configure was not told where it is");
    }
    (is_allowed ? near_allowed : measure_near)(&options);
    return bench_end();
}
