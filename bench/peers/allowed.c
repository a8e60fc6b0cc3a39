/* allowed.c - how much of a step is safe at a distance, asked of us and of ipc-toolkit.
 *
 * The true share is the time at which the first pair is at r. Ours names that pair, and
 * exact arithmetic says when it is there: after our share, and when at the latest. That
 * no other pair is sooner is what tests of the engine show. What another method allows is
 * compared with that.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "families.h"
#include "near_ours.h"
#include "oracle_thick.h"

#define REPEATS_MAX 9u
#define BUDGET_NS   3000000000u /* for one quantity; it has one repeat at least */

static const char *const way_names[NEAR_WAYS] = {"additive", "tight inclusion"};
static const char *const usual[] = {"cloth-20k", "cloth-ball", "cloth-funnel", "n-body",
                                    NULL};
#define SHARE 1e-2 /* of the median edge: one r, unless a scene has its own */

struct run {
    char name[80]; /* of the scene, with r */
    struct bench_world *world;
    const struct bench_frames *frames;
    const struct peer_input *features;
    double r;
    void *theirs; /* NULL: there is no other library */
    struct eng_step_result found;
    struct near_quantity ours;
    struct near_quantity others[NEAR_WAYS];
    double allowed[NEAR_WAYS]; /* by the others */
};

static void ask_ours(struct run *run)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_FIRST);
    settings.method = PCCD_METHOD_WIDE;
    settings.distance = run->r;
    uint64_t begin_ns = common_now_ns();
    bench_world_step(run->world, run->frames, &settings, &run->found);
    near_keep(&run->ours, begin_ns, true);
    bench_check(run->found.incomplete == PCCD_COMPLETE, run->name, "incomplete");
}

static void ask_other(struct run *run, enum near_way way)
{
    uint64_t begin_ns = common_now_ns();
#ifdef PEERS_IPC_TOOLKIT
    run->allowed[way] = near_ipc_toolkit_allowed(
        run->theirs, (const double(*)[3])run->frames->x[1], run->r, way);
#endif
    near_keep(&run->others[way], begin_ns, true);
}

/* ---- the true share ---------------------------------------------------------------- */

/* The pair of `contact`: its points at both ends, as the oracle wants them. */
static void load(const struct run *run, const struct pccd_contact *contact,
                 struct oracle_thick *thick, double p[8][3])
{
    bool is_face = contact->kind == PCCD_VF;
    uint32_t points[2] = {is_face ? 1 : 2, is_face ? 3 : 2};
    const struct peer_features *tables[2] = {
        &run->features->groups[is_face ? PEER_VERTICES : PEER_EDGES],
        &run->features->groups[is_face ? PEER_FACES : PEER_EDGES]};
    uint32_t object[2] = {contact->object_a, contact->object_b};
    uint32_t feature[2] = {contact->feature_a, contact->feature_b};
    uint32_t n = 0;
    for (int side = 0; side < 2; side++) {
        uint32_t index =
            peers_index(run->world, points[side], object[side], feature[side]);
        for (uint32_t k = 0; k < points[side]; k++, n++) {
            uint32_t v = tables[side]->corners[index][k];
            memcpy(p[n], run->frames->x[0][v], sizeof p[n]);
            memcpy(p[4 + n], run->frames->x[1][v], sizeof p[n]);
        }
    }
    *thick = (struct oracle_thick){.points_a = (int)points[0],
                                   .points_b = (int)points[1],
                                   .p = (const double(*)[3])p,
                                   .radius = {0, 0, run->r}};
}

static const struct pccd_contact *first_of(const struct eng_step_result *found)
{
    const struct pccd_contact *contacts = found->records;
    for (uint64_t i = 0; i < found->count; i++) {
        if (contacts[i].toi == found->toi_first) {
            return &contacts[i];
        }
    }
    return NULL;
}

/* The true share is between what ours allows and *latest. */
static bool judge(const struct run *run, double *latest)
{
    const struct pccd_contact *contact = first_of(&run->found);
    *latest = 1;
    if (contact == NULL) {
        return bench_check(run->found.count == 0, run->name, "no record is the first");
    }
    double p[8][3];
    struct oracle_thick thick;
    load(run, contact, &thick, p);
    struct oracle_first *first = oracle_thick_first_new(&thick);
    *latest = contact->toi_hi;
    bool is_right = first != NULL && oracle_first_compare(first, contact->toi_hi) <= 0 &&
                    (run->found.safe_step == 0 ||
                     oracle_first_compare(first, run->found.safe_step) > 0);
    oracle_first_free(first);
    return bench_check(is_right, run->name, "the first pair is not where it is said");
}

/* ---- the report -------------------------------------------------------------------- */

static void print_share(const struct run *run, const char *who, double allowed,
                        double latest)
{
    char text[80];
    snprintf(text, sizeof text, "%s: allowed", who);
    bench_number(run->name, text, "", allowed);
    snprintf(text, sizeof text, "%s: below the true one", who);
    bench_number(run->name, text, "", latest - allowed);
}

static void print(const struct run *run, double latest)
{
    bench_number(run->name, "r", "", run->r);
    bench_number(run->name, "begin within r", "", (double)run->found.initial);
    print_share(run, "ours", run->found.safe_step, latest);
    for (unsigned i = 0; i < NEAR_WAYS && run->theirs != NULL; i++) {
        print_share(run, way_names[i], run->allowed[i], latest);
    }
    bench_row(run->name, "ours", "ms", &run->ours.ms, NULL, NULL);
    for (unsigned i = 0; i < NEAR_WAYS && run->theirs != NULL; i++) {
        bench_row(run->name, way_names[i], "ms", &run->others[i].ms, "ours",
                  &run->ours.ms);
    }
}

static void measure(struct run *run, unsigned repeats)
{
    double latest;
    for (unsigned r = 0; r < repeats; r++) {
        ask_ours(run);
        for (unsigned i = 0; i < NEAR_WAYS && run->theirs != NULL; i++) {
            if (r == 0 || run->others[i].spent_ns < BUDGET_NS) {
                ask_other(run, i);
            }
        }
    }
    if (judge(run, &latest)) {
        print(run, latest);
    }
    bench_free(&run->ours.ms);
    for (unsigned i = 0; i < NEAR_WAYS; i++) {
        bench_free(&run->others[i].ms);
    }
}

/* Return how near the two nearest features are at the start; INFINITY: farther apart than
 * d. */
static double least_distance(struct bench_world *world, const struct bench_frames *frames,
                             double d)
{
    struct eng_question settings = near_ours_settings(PCCD_NEAR_PAIRS, d, 1);
    struct eng_step_result result;
    bench_world_near(world, frames, true, &settings, &result);
    return result.count > 0 ? result.distance_min : INFINITY;
}

static void measure_at(const struct run *of_scene, const char *name, double r,
                       unsigned repeats)
{
    struct run run = *of_scene;
    run.r = r;
    snprintf(run.name, sizeof run.name, "%s, %.3g", name, r);
    measure(&run, repeats);
}

/* r > 0: at that distance; 0: at a share of the median edge, and, where pairs begin
 * within that, at half the least distance at the start. */
static void measure_distances(const struct run *of_scene, const char *name, double r,
                              unsigned repeats)
{
    double share = SHARE * bench_frames_median_edge(of_scene->frames);
    if (r > 0) {
        measure_at(of_scene, name, r, repeats);
        return;
    }
    measure_at(of_scene, name, share, repeats);
    double least = least_distance(of_scene->world, of_scene->frames, share);
    if (least == 0) {
        bench_number(name, "touches at the start", "", 1);
    } else if (least <= share) {
        measure_at(of_scene, name, 0.5 * least, repeats);
    }
}

static void measure_scene(const struct bench_scene *source, double r,
                          const struct bench_options *options)
{
    struct near_scene scene;
    near_scene_init(&scene, source);
    struct run run = {
        .world = &scene.world, .frames = &scene.frames, .features = &scene.features};
#ifdef PEERS_IPC_TOOLKIT
    run.theirs = near_ipc_toolkit.open(&scene.input);
#endif
    measure_distances(&run, source->name, r, options->smoke ? 1 : REPEATS_MAX);
#ifdef PEERS_IPC_TOOLKIT
    near_ipc_toolkit.close(run.theirs);
#endif
    near_scene_deinit(&scene);
}

void near_allowed(const struct bench_options *options)
{
    struct bench_scene scene;
    for (unsigned i = 0;
         bench_next_scene(options, options->wanted ? NULL : usual, &i, &scene);) {
        measure_scene(&scene, 0, options);
        bench_scene_free(&scene);
    }
    if (bench_is_wanted(options, "over-box")) {
        scene = (struct bench_scene){.name = "over-box"};
        bench_make_over_box(&scene);
        measure_scene(&scene, 1e-3, options);
        bench_scene_free(&scene);
    }
}
