/* test_eng_against_oracle.c - the engine's answers are the exact ones.
 *
 * Generated scenes of every kind, as one object, as several, and moved on over many
 * steps, each compared with brute force in exact arithmetic.
 *
 * Threads: one; the engine's steps by one to four, by every method and instruction set.
 */
#include "cases.h"

#include <time.h>

#include "judge.h"

#define ROUNDS 1

static struct judge_sums sums[SCENES_KINDS];

/* Everything moves close to everything else: brute force would take minutes. */
static bool is_dense(enum scenes_kind kind)
{
    return kind == SCENES_SNAPPED || kind == SCENES_STILL || kind == SCENES_FAST ||
           kind == SCENES_SLIDING;
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* One round after another with new seeds: ROUNDS, or until the test's share of
 * PCCD_PROPERTY_SECONDS is over. */
struct rounds {
    struct prng prng;
    uint32_t done;
    double end_s; /* 0: by count */
};

static struct rounds rounds_begin(void)
{
    const char *seconds = getenv("PCCD_PROPERTY_SECONDS");
    struct rounds rounds = {{prng_seed()}, 0, 0};
    if (seconds) {
        rounds.end_s = now_s() + strtod(seconds, NULL) / 4;
    }
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)rounds.prng.state);
    return rounds;
}

static bool rounds_next(struct rounds *rounds, uint32_t count)
{
    rounds->done++;
    return rounds->end_s != 0 ? now_s() < rounds->end_s : rounds->done <= count;
}

/* Seed, kind, size and format of one generated mesh. */
struct recipe {
    enum scenes_kind kind;
    uint32_t size;
    bool is_f32;
    uint64_t seed;
};

static void begin_judge(struct judge *judge, const struct recipe *recipe,
                        double tolerance)
{
    judge_init(judge, &sums[recipe->kind], tolerance);
    snprintf(judge->context, sizeof judge->context,
             "%s, %u triangles, %s, seed %llu, tolerance %g", scenes_name(recipe->kind),
             recipe->size, recipe->is_f32 ? "f32" : "f64",
             (unsigned long long)recipe->seed, tolerance);
}

static void make(struct scenes_mesh *mesh, const struct recipe *recipe)
{
    scenes_make(mesh, recipe->kind, recipe->size, recipe->is_f32, recipe->seed);
}

static double some_tolerance(struct prng *prng)
{
    static const double tolerances[] = {1e-6, 1e-6, 1e-3, 1e-12, 1};
    return tolerances[prng_below(prng, 5)];
}

/* If this failed, a contact would be missed, invented or mistimed, or modes would
 * disagree. */
CASE(engine__answers_exactly_for_one_object)
{
    static const uint32_t sizes[] = {2, 7, 20, 60, 120};
    struct rounds rounds = rounds_begin();
    while (rounds_next(&rounds, ROUNDS)) {
        for (unsigned i = 0; i < SCENES_KINDS * 10; i++) {
            struct recipe recipe = {i / 10, sizes[i % 5], i % 10 >= 5,
                                    prng_next(&rounds.prng)};
            if (is_dense(recipe.kind)) {
                recipe.size = recipe.size / 4 + 2;
            }
            struct scenes_mesh mesh;
            struct judge judge;
            make(&mesh, &recipe);
            begin_judge(&judge, &recipe, some_tolerance(&rounds.prng));
            judge_add(&judge, &mesh, 1 + prng_u32(&rounds.prng, 1000));
            judge_stage_whole(&judge);
            judge_everything(&judge);
            judge_deinit(&judge);
            scenes_deinit(&mesh);
        }
    }
}

/* The parts of a mesh, and where their features are in the whole. */
struct split {
    struct scenes_mesh parts[JUDGE_OBJECTS_MAX];
    uint32_t *edge_of[JUDGE_OBJECTS_MAX];
    uint32_t count;
};

static void split_init(struct split *split, const struct scenes_mesh *mesh,
                       uint32_t count, const struct judge *whole)
{
    const struct judge_object *object = &whole->objects[0];
    split->count = scenes_split(mesh, count, split->parts);
    for (uint32_t i = 0; i < split->count; i++) {
        const struct scenes_mesh *part = &split->parts[i];
        struct oracle_object view = {.object_id = 0,
                                     .vertex_count = part->vertex_count,
                                     .triangle_count = part->triangle_count,
                                     .x0 = (const double(*)[3])part->x0,
                                     .x1 = (const double(*)[3])part->x1,
                                     .triangles = (const uint32_t(*)[3])part->triangles};
        uint32_t edge_count;
        uint32_t(*edges)[2] = oracle_edges(&view, &edge_count);
        split->edge_of[i] = calloc((size_t)edge_count + 1, sizeof *split->edge_of[i]);
        assert_non_null(split->edge_of[i]);
        for (uint32_t k = 0, e = 0; k < edge_count; k++) {
            /* Both lists are sorted alike. */
            while (object->edges[e][0] != part->vertex_of[edges[k][0]] ||
                   object->edges[e][1] != part->vertex_of[edges[k][1]]) {
                e++;
                assert_true(e < object->edge_count);
            }
            split->edge_of[i][k] = e;
        }
        free(edges);
    }
}

static void split_deinit(struct split *split)
{
    for (uint32_t i = 0; i < split->count; i++) {
        scenes_deinit(&split->parts[i]);
        free(split->edge_of[i]);
    }
}

/* The pair's name in the whole; part i has object id i. */
static struct oracle_pair map_pair(const struct split *split,
                                   const struct oracle_pair *pair)
{
    uint32_t a = pair->object_a;
    uint32_t b = pair->object_b;
    if (pair->kind == PCCD_VF) {
        return (struct oracle_pair){PCCD_VF, 0,
                                    split->parts[a].vertex_of[pair->feature_a], 0,
                                    split->parts[b].triangle_of[pair->feature_b]};
    }
    uint32_t first = split->edge_of[a][pair->feature_a];
    uint32_t second = split->edge_of[b][pair->feature_b];
    return (struct oracle_pair){PCCD_EE, 0, first < second ? first : second, 0,
                                first < second ? second : first};
}

/* Names of the records in the whole, sorted. Freed by the caller. */
static struct oracle_pair *map_records(const struct split *split,
                                       const struct eng_step_result *result)
{
    struct oracle_pair *pairs = test_room((result->count + 1) * sizeof *pairs);
    for (uint64_t i = 0; i < result->count; i++) {
        struct oracle_pair pair;
        const char *record = (const char *)result->records + i * result->record_bytes;
        if (result->mode == PCCD_MODE_PAIRS) {
            memcpy(&pair, record, sizeof pair);
        } else {
            struct pccd_contact contact;
            memcpy(&contact, record, sizeof contact);
            pair = (struct oracle_pair){contact.kind, contact.object_a, contact.feature_a,
                                        contact.object_b, contact.feature_b};
        }
        pairs[i] = split ? map_pair(split, &pair) : pair;
        pairs[i].object_a = pairs[i].object_b = 0;
    }
    qsort(pairs, result->count, sizeof *pairs, oracle_pair_compare);
    return pairs;
}

static void compare_split(struct judge *whole, struct judge *parts,
                          const struct split *split, enum pccd_mode mode)
{
    struct eng_step_result one;
    struct eng_step_result many;
    judge_stage_whole(whole);
    judge_stage_whole(parts);
    judge_step(whole, mode, &one);
    judge_step(parts, mode, &many);
    struct oracle_pair *left = map_records(NULL, &one);
    struct oracle_pair *right = map_records(split, &many);
    if (one.count != many.count || memcmp(left, right, one.count * sizeof *left) != 0) {
        judge_fail(parts, "the parts have other pairs than the whole", NULL);
    }
    free(left);
    free(right);
}

/* If this failed, an answer would depend on how a scene is cut into objects, or on the
 * order in which they came. */
CASE(engine__does_not_depend_on_objects)
{
    static const enum scenes_kind kinds[] = {SCENES_SOUP,    SCENES_TWO_SPHERES,
                                             SCENES_SLIDING, SCENES_FAST,
                                             SCENES_SLIVERS, SCENES_FAR};
    struct rounds rounds = rounds_begin();
    while (rounds_next(&rounds, ROUNDS)) {
        for (unsigned i = 0; i < 12; i++) {
            enum scenes_kind kind = kinds[i % 6];
            struct recipe recipe = {kind, is_dense(kind) ? 16 : 50, i >= 6,
                                    prng_next(&rounds.prng)};
            struct scenes_mesh mesh;
            struct split split;
            struct judge whole;
            struct judge parts;
            struct judge turned;
            struct eng_step_result results[2];
            double tolerance = some_tolerance(&rounds.prng);
            make(&mesh, &recipe);
            begin_judge(&whole, &recipe, tolerance);
            begin_judge(&parts, &recipe, tolerance);
            begin_judge(&turned, &recipe, tolerance);
            judge_add(&whole, &mesh, 0);
            split_init(&split, &mesh, 2 + prng_u32(&rounds.prng, 6), &whole);
            assert_true(split.count > 1);
            for (uint32_t k = 0; k < split.count; k++) {
                judge_add(&parts, &split.parts[k], k);
                judge_add(&turned, &split.parts[split.count - 1 - k],
                          split.count - 1 - k);
            }
            judge_stage_whole(&parts);
            judge_everything(&parts);
            compare_split(&whole, &parts, &split, PCCD_MODE_ALL);
            compare_split(&whole, &parts, &split, PCCD_MODE_PAIRS);
            judge_stage_whole(&parts);
            judge_stage_whole(&turned);
            judge_step(&parts, PCCD_MODE_ALL, &results[0]);
            judge_step(&turned, PCCD_MODE_ALL, &results[1]);
            assert_int_equal(results[0].hash[0], results[1].hash[0]);
            assert_int_equal(results[0].hash[1], results[1].hash[1]);
            judge_deinit(&whole);
            judge_deinit(&parts);
            judge_deinit(&turned);
            split_deinit(&split);
            scenes_deinit(&mesh);
        }
    }
}

/* Place of a group of objects at both ends of a step. */
struct somewhere {
    double at[2][3];
};

static struct somewhere somewhere(struct prng *prng)
{
    static const double distances[] = {0, 0x1p10, 0x1p30, 0x1p40, -0x1p30, 3e7};
    struct somewhere place;
    bool jumps = prng_below(prng, 3) == 0;
    for (int k = 0; k < 3; k++) {
        place.at[0][k] = distances[prng_below(prng, 6)];
        place.at[1][k] = jumps ? distances[prng_below(prng, 6)] : place.at[0][k];
    }
    return place;
}

static void move_there(struct scenes_mesh *mesh, const struct somewhere *place,
                       double scale)
{
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++) {
        mesh->x0[i / 3][i % 3] = scale * (mesh->x0[i / 3][i % 3] + place->at[0][i % 3]);
        mesh->x1[i / 3][i % 3] = scale * (mesh->x1[i / 3][i % 3] + place->at[1][i % 3]);
    }
}

/* If this failed, objects that are far from the origin or from each other, that jump, or
 * whose coordinates are tiny would be measured so that a contact is missed. */
CASE(engine__answers_exactly_for_objects_far_apart)
{
    static const double scales[] = {1, 1, 0x1p-300, 0x1p-30, 0x1p15};
    struct rounds rounds = rounds_begin();
    while (rounds_next(&rounds, ROUNDS)) {
        for (unsigned i = 0; i < 40; i++) {
            struct recipe recipe = {i % 2 ? SCENES_SOUP : SCENES_TWO_SPHERES, 40, false,
                                    prng_next(&rounds.prng)};
            struct scenes_mesh mesh;
            struct scenes_mesh parts[JUDGE_OBJECTS_MAX];
            struct judge judge;
            struct somewhere places[2] = {somewhere(&rounds.prng),
                                          somewhere(&rounds.prng)};
            make(&mesh, &recipe);
            begin_judge(&judge, &recipe, 1e-6);
            uint32_t count = scenes_split(&mesh, 2 + prng_u32(&rounds.prng, 6), parts);
            for (uint32_t k = 0; k < count; k++) {
                move_there(&parts[k], &places[prng_below(&rounds.prng, 2)],
                           scales[i % 5]);
                judge_add(&judge, &parts[k], k);
                scenes_deinit(&parts[k]);
            }
            judge_stage_whole(&judge);
            judge_everything(&judge);
            judge_deinit(&judge);
            scenes_deinit(&mesh);
        }
    }
}

static void *to_floats(const double (*x)[3], uint32_t count)
{
    float(*floats)[3] = test_room((size_t)count * sizeof *floats);
    for (uint32_t i = 0; i < count * 3; i++) {
        floats[i / 3][i % 3] = (float)x[i / 3][i % 3];
    }
    return floats;
}

/* Stage first .. first + count - 1 of the object as its copy says, or its end alone. */
static void stage_range(struct judge *judge, const struct judge_object *object,
                        uint32_t first, uint32_t count, bool both_ends)
{
    const double(*x0)[3] = (const double(*)[3])object->mesh.x0 + first;
    const double(*x1)[3] = (const double(*)[3])object->mesh.x1 + first;
    enum pccd_format format = object->mesh.is_f32 ? PCCD_FORMAT_F32 : PCCD_FORMAT_F64;
    void *floats[2] = {NULL, NULL};
    const void *ends[2] = {x0, x1};
    int status;
    if (format == PCCD_FORMAT_F32) {
        ends[0] = floats[0] = to_floats(x0, count);
        ends[1] = floats[1] = to_floats(x1, count);
    }
    if (both_ends) {
        status = eng_stage_x0x1(judge->scene, object->object_idx, format, first, count,
                                ends[0], ends[1]);
    } else {
        status =
            eng_stage_x1(judge->scene, object->object_idx, format, first, count, ends[1]);
    }
    free(floats[0]);
    free(floats[1]);
    assert_ok(status);
}

/* A turn about z and a shift of about a unit; on a lattice it is exact. */
static void some_transform(struct prng *prng, bool is_lattice, double unit, double m[12])
{
    double angle = prng_between(prng, -0.4, 0.4);
    double c = is_lattice ? 0 : cos(angle);
    double s = is_lattice ? 1 : sin(angle);
    double rows[12] = {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0};
    for (int k = 0; k < 3; k++) {
        rows[4 * k + 3] = unit * (is_lattice ? 0.25 * (double)prng_below(prng, 5) - 0.5
                                             : prng_between(prng, -0.5, 0.5));
    }
    memcpy(m, rows, sizeof rows);
}

static void transform(const double m[12], const double from[3], double to[3])
{
    for (int k = 0; k < 3; k++) {
        const double *row = m + 4 * k;
        to[k] = ((row[0] * from[0] + row[1] * from[1]) + row[2] * from[2]) + row[3];
    }
}

static void stage_rigid(struct judge *judge, struct judge_object *object, uint32_t first,
                        uint32_t count, double unit, struct prng *prng)
{
    double m[2][12];
    bool is_lattice = prng_below(prng, 2) == 1;
    some_transform(prng, is_lattice, unit, m[0]);
    some_transform(prng, is_lattice, unit, m[1]);
    for (uint32_t i = first; i < first + count; i++) {
        transform(m[0], object->registered[i], object->mesh.x0[i]);
        transform(m[1], object->registered[i], object->mesh.x1[i]);
    }
    object->mesh.is_f32 = false; /* from now on */
    assert_ok(
        eng_stage_rigid(judge->scene, object->object_idx, first, count, m[0], m[1]));
}

/* The whole object, some of its ranges, or nothing; ends, both ends or transforms. */
static void stage_something(struct judge *judge, struct judge_object *object,
                            enum scenes_kind kind, struct prng *prng)
{
    struct scenes_mesh *mesh = &object->mesh;
    size_t bytes = mesh->vertex_count * sizeof *mesh->x1;
    double(*ends)[2][3] = malloc(mesh->vertex_count * sizeof *ends);
    assert_non_null(ends);
    scenes_move_on(mesh, kind, prng);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        memcpy(ends[i][0], mesh->x0[i], sizeof ends[i][0]);
        memcpy(ends[i][1], mesh->x1[i], sizeof ends[i][1]);
    }
    memcpy(mesh->x1, mesh->x0, bytes); /* what is not staged stands still */
    uint32_t what = prng_u32(prng, 5);
    bool in_ranges = prng_below(prng, 2) == 1;
    uint32_t first = 0;
    while (what != 0 && first < mesh->vertex_count) {
        uint32_t count = mesh->vertex_count - first;
        if (in_ranges) {
            count = 1 + prng_u32(prng, count);
        }
        for (uint32_t i = first; i < first + count; i++) {
            memcpy(mesh->x1[i], ends[i][1], sizeof mesh->x1[i]);
            if (what == 3) { /* a start of its own: where it was going, and then on */
                memcpy(mesh->x0[i], ends[i][1], sizeof mesh->x0[i]);
                memcpy(mesh->x1[i], ends[i][0], sizeof mesh->x1[i]);
            }
        }
        if (what == 4) {
            stage_rigid(judge, object, first, count, kind == SCENES_TINY ? 1e-30 : 1,
                        prng);
        } else {
            stage_range(judge, object, first, count, what == 3);
        }
        first += count;
        if (in_ranges && first < mesh->vertex_count) {
            first += prng_u32(prng, mesh->vertex_count - first);
        }
    }
    free(ends);
}

/* If this failed, resident state would drift from what the client sent: ranges,
 * transforms, objects that stand still, come and go. */
CASE(engine__keeps_answering_exactly_over_steps)
{
    struct rounds rounds = rounds_begin();
    while (rounds_next(&rounds, ROUNDS)) {
        for (unsigned i = 0; i < SCENES_KINDS; i++) {
            struct prng *prng = &rounds.prng;
            struct recipe recipe = {i, is_dense(i) ? 5 : 12, prng_below(prng, 2) == 1,
                                    prng_next(prng)};
            struct judge judge;
            uint32_t object_id = 7;
            begin_judge(&judge, &recipe, some_tolerance(prng));
            for (uint32_t step = 0; step < 10; step++) {
                if (judge.object_count > 0 && prng_below(prng, 4) == 0) {
                    judge_remove(&judge, prng_u32(prng, judge.object_count));
                }
                while (judge.object_count < 2 + step % 2) {
                    struct scenes_mesh mesh;
                    struct recipe part = recipe;
                    part.seed = prng_next(prng);
                    make(&mesh, &part);
                    memcpy(mesh.x1, mesh.x0, mesh.vertex_count * sizeof *mesh.x1);
                    judge_add(&judge, &mesh, object_id++);
                    scenes_deinit(&mesh);
                }
                if (prng_below(prng, 2) == 0) {
                    judge_draw_filters(&judge, prng);
                }
                eng_stage_begin(judge.scene);
                for (uint32_t k = 0; k < judge.object_count; k++) {
                    stage_something(&judge, &judge.objects[k], recipe.kind, prng);
                }
                judge_everything(&judge);
            }
            judge_deinit(&judge);
        }
    }
}

/* If this failed, a second scene with the same history would answer in other bytes. */
CASE(engine__gives_the_same_bytes_again)
{
    struct rounds rounds = rounds_begin();
    while (rounds_next(&rounds, 1)) {
        for (unsigned i = 0; i < SCENES_KINDS; i++) {
            struct recipe recipe = {i, 40, i % 2 == 1, prng_next(&rounds.prng)};
            struct scenes_mesh mesh;
            struct judge judges[2];
            struct eng_step_result results[2];
            make(&mesh, &recipe);
            for (int k = 0; k < 2; k++) {
                begin_judge(&judges[k], &recipe, 1e-6);
                judge_add(&judges[k], &mesh, 3);
                judge_stage_whole(&judges[k]);
                judge_step(&judges[k], PCCD_MODE_ALL, &results[k]);
            }
            assert_int_equal(results[0].count, results[1].count);
            assert_memory_equal(results[0].records, results[1].records,
                                results[0].count * sizeof(struct pccd_contact));
            assert_int_equal(results[0].hash[0], results[1].hash[0]);
            assert_int_equal(results[0].hash[1], results[1].hash[1]);
            judge_deinit(&judges[0]);
            judge_deinit(&judges[1]);
            scenes_deinit(&mesh);
        }
    }
}

static int report(void **state)
{
    (void)state;
    print_message("# %-12s %8s %8s %9s %9s %9s %9s %9s\n", "kind", "steps", "by team",
                  "true", "proved", "possible", "no touch", "initial");
    for (unsigned i = 0; i < SCENES_KINDS; i++) {
        const struct judge_sums *s = &sums[i];
        print_message("# %-12s %8llu %8llu %9llu %9llu %9llu %9llu %9llu\n",
                      scenes_name(i), (unsigned long long)s->steps,
                      (unsigned long long)s->team_steps, (unsigned long long)s->truths,
                      (unsigned long long)(s->records - s->possible),
                      (unsigned long long)s->possible, (unsigned long long)s->extra,
                      (unsigned long long)s->initial);
    }
    return 0;
}

CASES_WITH(NULL, report);
