/* test_eng_thick_truth.c - public scenes and queries with a thickness, against exact
 * arithmetic.
 */
#include "thick_trial.h"
#include "truth_engine.h"

#define LARGE 0.1  /* r of that size, beside .. */
#define FEW   150u /* triangles of a scene of which r is a large part */
static const double small_parts[] = {0x1p-20, 0x1p-10};

/* The share of pairs that is judged: one of so many; 0: as make check has time for. */
static uint32_t long_share(void)
{
    const char *text = getenv("PCCD_THICK_TRUTH");
    return text ? (uint32_t)strtoul(text, NULL, 10) : 0;
}

/* ---- one step ---------------------------------------------------------------------- */

static struct eng_scene *run(const struct trial *trial, struct eng_mesh *mesh,
                             uint32_t way, struct eng_step_result *result)
{
    const struct eng_object_thickness thickness = {.has_radius = true,
                                                   .radius = trial->radius[0]};
    struct eng_question settings = truth_way(way % truth_way_count());
    settings.tolerance = TRIAL_TOLERANCE;
    settings.distance = trial->radius[2];
    settings.approach = trial->approach;
    return truth_run(mesh, trial->object, &thickness, &settings, result);
}

/* Take the step in a way, and judge it. `more_ways`: so many others give the same. */
static void try(struct trial *trial, uint32_t way, uint32_t more_ways)
{
    struct eng_mesh *mesh = truth_mesh(trial->object);
    struct eng_step_result result;
    struct eng_scene *scene = run(trial, mesh, way, &result);
    trial->contacts = result.records;
    trial->count = result.count;
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    trial_judge(trial);
    for (uint32_t i = 1; i <= more_ways; i++) {
        struct eng_step_result other;
        eng_scene_free(run(trial, mesh, way + i, &other));
        assert_memory_equal(other.hash, result.hash, sizeof result.hash);
    }
    eng_scene_free(scene);
    eng_mesh_release(mesh);
}

static double size_of(const struct oracle_object *object)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY;
        double high = -INFINITY;
        for (uint32_t i = 0; i < object->vertex_count; i++) {
            low = fmin(low, fmin(object->x0[i][k], object->x1[i][k]));
            high = fmax(high, fmax(object->x0[i][k], object->x1[i][k]));
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

/* ---- hand-made queries ------------------------------------------------------------- */

struct handmade {
    struct fuzz_thick_run solver; /* both stages, one query at a time */
    uint64_t queries;
    uint64_t decided;
    uint64_t hits;
    uint64_t wrong;
    uint64_t pairs; /* of scenes: judged */
};

/* The query alone: by doubles first, and by integers alone. */
static void solve(struct handmade *tally, const struct trial *trial, bool is_vf)
{
    static const struct oracle_feature features[4] = {{.points = 1, .v = {0}},
                                                      {.points = 3, .v = {1, 2, 3}},
                                                      {.points = 2, .v = {0, 1}},
                                                      {.points = 2, .v = {2, 3}}};
    struct fuzz_thick_case made =
        trial_case(trial, &features[is_vf ? 0 : 2], &features[is_vf ? 1 : 3]);
    struct fuzz_thick_truth truth = fuzz_thick_truth_of(&made);
    for (int stage = 0; stage < ENG_THICK_STAGES; stage++) {
        struct eng_hit hit = {0};
        tally->solver.thick.first = (enum eng_thick_stage)stage;
        bool is_hit = eng_thick_solve(&tally->solver.thick, &tally->solver.contacts,
                                      &made.query, TRIAL_TOLERANCE, 1, &hit);
        const char *what = fuzz_thick_judge_hit(&made, &truth, is_hit ? &hit : NULL);
        tally->decided++;
        tally->hits += is_hit;
        if (what && tally->wrong++ < 10) {
            fuzz_thick_print(stdout, &made, &hit, what);
        }
    }
    oracle_first_free(truth.first);
}

static void try_handmade(void *context, bool is_vf, const char *path,
                         const struct data_queries *queries)
{
    struct handmade *tally = context;
    for (size_t i = 0; i < queries->count; i++, tally->queries++) {
        struct truth_two two;
        truth_two_init(&two, is_vf, (truth_points)queries->p[i]);
        double size = size_of(&two.object);
        for (uint32_t k = 0; k < 6; k++) {
            double part = k / 2 < 2 ? small_parts[k / 2] : LARGE;
            uint32_t each = long_share() ? long_share() : 16;
            struct trial trial = {.name = path,
                                  .object = &two.object,
                                  .approach = k % 2 ? 0.5 : 0,
                                  .each_found = each,
                                  .each_absent = each,
                                  .prng = {prng_next(&tally->solver.prng)}};
            trial_radius(&trial, part * size);
            if (long_share() || (tally->queries + k) % 2 == 0) {
                solve(tally, &trial, is_vf);
            }
            if (long_share() || tally->queries % 24 == k) {
                try(&trial, (uint32_t)tally->queries, 0);
                tally->pairs += trial.judged_found + trial.judged_absent;
            }
        }
    }
}

/* If this failed, a query that was made to be hard would be missed, invented or late at a
 * distance; or one of the pairs around it. */
CASE(engine__answers_every_handmade_query_at_a_distance)
{
    static struct handmade tally;
    fuzz_thick_init(&tally.solver, prng_seed(), stdout);
    if (data_handmade(try_handmade, &tally) == 0) {
        fuzz_thick_deinit(&tally.solver);
        test_skip("no hand-made queries in $PCCD_DATA");
    }
    fuzz_thick_deinit(&tally.solver);
    print_message("# %llu queries, decided %llu times: %llu meet, %llu wrong; "
                  "in scenes %llu pairs judged\n",
                  (unsigned long long)tally.queries, (unsigned long long)tally.decided,
                  (unsigned long long)tally.hits, (unsigned long long)tally.wrong,
                  (unsigned long long)tally.pairs);
    assert_int_equal(tally.queries, TRUTH_HANDMADE);
    assert_int_equal(tally.wrong, 0);
}

/* ---- scenes ------------------------------------------------------------------------ */

static int compare_doubles(const void *a, const void *b)
{
    double left = *(const double *)a;
    double right = *(const double *)b;
    return left < right ? -1 : left > right;
}

static double median_edge(const struct oracle_object *object)
{
    uint32_t count;
    uint32_t(*edges)[2] = oracle_edges(object, &count);
    double *lengths = test_room(count * sizeof *lengths);
    for (uint32_t i = 0; i < count; i++) {
        const double *a = object->x0[edges[i][0]];
        const double *b = object->x0[edges[i][1]];
        lengths[i] = hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
    }
    qsort(lengths, count, sizeof *lengths, compare_doubles);
    double median = lengths[count / 2];
    free(lengths);
    free(edges);
    return median;
}

/* Every so manyth triangle: what meets there meets in the whole scene. The caller frees
 * the triangles. */
static struct oracle_object thinned(const struct oracle_object *object, uint32_t each)
{
    struct oracle_object some = *object;
    some.triangle_count = object->triangle_count / each;
    uint32_t(*triangles)[3] = test_room((some.triangle_count + 1) * sizeof *triangles);
    for (uint32_t i = 0; i < some.triangle_count; i++) {
        memcpy(triangles[i], object->triangles[i * each], sizeof triangles[i]);
    }
    some.triangles = (const uint32_t(*)[3])triangles;
    return some;
}

static void try_distance(struct trial *trial, double part, const char *of, double size)
{
    uint32_t way = prng_u32(&trial->prng, truth_way_count());
    trial_radius(trial, part * size);
    try(trial, way, long_share() ? 2 : 0);
    print_message(
        "# %s, r = %g of %s, approach %g: %llu pairs, %llu answered; judged "
        "%llu of these, %llu of the others; %llu wrong\n",
        trial->name, part, of, trial->approach, (unsigned long long)trial->walked,
        (unsigned long long)trial->met, (unsigned long long)trial->judged_found,
        (unsigned long long)trial->judged_absent, (unsigned long long)trial->wrong);
    assert_true(trial->judged_absent > 0 && (trial->judged_found > 0 || long_share()));
}

/* With each distance: two small ones beside the scene, a large one beside its edges. One
 * that is large beside the scene takes everything in: so of some triangles alone. */
static void try_distances(const struct trial *trial, uint32_t number)
{
    struct trial one = *trial;
    if (number < 2) {
        try_distance(&one, small_parts[number], "its size", size_of(trial->object));
    } else if (number == 2) {
        try_distance(&one, LARGE, "the median edge", median_edge(trial->object));
    } else {
        struct oracle_object some =
            thinned(trial->object, trial->object->triangle_count / FEW);
        one.object = &some;
        one.each_found = one.each_absent = long_share() ? 1 : 64;
        try_distance(&one, LARGE, "its size, a few triangles", size_of(trial->object));
        free((void *)some.triangles);
    }
}

/* Where time is short, of the distances those of the bits `only`, and one answered pair
 * of `each_found`, one other of `each_absent`. */
static void try_scene(enum data_scene_name name, uint32_t only, uint32_t each_found,
                      uint32_t each_absent)
{
    const struct data_scene *scene = &data_scenes[name];
    struct ply frames[2];
    truth_read_frames(scene, frames);
    struct oracle_object object = truth_object(frames);
    struct prng prng = {prng_seed()};
    for (uint32_t k = 0; k < 8; k++) {
        bool is_quick = (k % 2 == 0 || k / 2 == 3) && (only >> k / 2 & 1);
        const struct trial trial = {
            .name = scene->name,
            .object = &object,
            .approach = k % 2 ? 0.25 : 0,
            .each_found = long_share() ? long_share() : each_found,
            .each_absent = long_share() ? long_share() : each_absent,
            .anywhere = long_share() ? 10000 : 100,
            .prng = {prng_next(&prng)}};
        if (long_share() || is_quick) {
            try_distances(&trial, k / 2);
        }
    }
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
}

/* If this failed, thick cloth would pass through a ball, or stop where it is free. */
CASE(engine__answers_cloth_ball_at_a_distance)
{
    try_scene(DATA_CLOTH_BALL, 2 + 8, 800, 2000);
}

/* If this failed, it would be so of bodies that slide along each other's planes. */
CASE(engine__answers_n_body_at_a_distance)
{
    try_scene(DATA_N_BODY, 4 + 8, 400, 8000);
}

/* If this failed, it would be so of cloth whose pairs are nearly degenerate. */
CASE(engine__answers_cloth_funnel_at_a_distance)
{
    try_scene(DATA_CLOTH_FUNNEL, 1 + 2 + 4 + 8, 40, 100);
}
