/* test_eng_wide.c - the trees of the method wide. */
#include "aabb.h"
#include "eng_kit.h"
#include "wide.h"
#include "wide_cells.h"
#include "wide_sweep.h"
#include "world.h"

#define SHEET_SIDE   24u
#define SHEETS       5u
#define SOUP_COUNT   150u
#define MODES        4
#define PAIRS_MAX    400000u
#define OBJECTS_MAX  8u
#define VERTICES_MAX 1024u
#define SHAKEN_BY    0.15
#define NEEDLES      1600u

struct fixture {
    struct eng_scene *scene;
    struct prng random;
    uint32_t objects[OBJECTS_MAX];
    uint32_t count;
    double thrown; /* how far a vertex of the first object is thrown in the next step */
};

static void add(struct fixture *f, struct eng_mesh *mesh)
{
    uint32_t id = 1000 - 7 * f->count; /* not in the order of arrival */
    f->objects[f->count] = kit_add(f->scene, mesh, id);
    f->count++;
}

static int setup(void **state)
{
    static struct fixture f;
    memset(&f, 0, sizeof f);
    f.random.state = 77;
    f.scene = kit_scene();
    for (uint32_t i = 0; i < SHEETS; i++) {
        add(&f, kit_sheet(i == 0 ? SHEET_SIDE : i, 0.2 * i));
    }
    add(&f, kit_soup(&f.random, SOUP_COUNT));
    *state = &f;
    return 0;
}

static int teardown(void **state)
{
    eng_scene_free(((struct fixture *)*state)->scene);
    return 0;
}

/* Stage the next step: every vertex shaken, from where it was registered. */
static void shake(struct fixture *f, double by)
{
    static double x0[VERTICES_MAX][3];
    static double x1[VERTICES_MAX][3];
    eng_stage_begin(f->scene);
    for (uint32_t i = 0; i < f->count; i++) {
        const struct eng_object *object = eng_scene_object(f->scene, f->objects[i]);
        if (!object) {
            continue;
        }
        uint32_t count = object->vertices.count;
        assert_true(count <= VERTICES_MAX);
        for (uint32_t k = 0; k < 3 * count; k++) {
            double x = object->mesh->x[k / 3][k % 3];
            x0[k / 3][k % 3] = x + prng_between(&f->random, -by, by) / 8;
            x1[k / 3][k % 3] = x + prng_between(&f->random, -by, by);
        }
        x1[0][0] += i == 0 ? f->thrown : 0;
        assert_ok(
            eng_stage_x0x1(f->scene, f->objects[i], PCCD_FORMAT_F64, 0, count, x0, x1));
    }
}

static struct eng_step_result step_by(struct fixture *f, enum pccd_mode mode,
                                      enum pccd_method method, uint32_t threads,
                                      enum eng_scheduler scheduler)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.threads = threads;
    settings.tuning.scheduler = scheduler;
    settings.team_always = true;
    settings.mode = mode;
    settings.method = method;
    struct eng_step_result result = kit_step(f->scene, &settings);
    assert_int_equal(result.method, method);
    return result;
}

static struct eng_step_result step(struct fixture *f, enum pccd_mode mode,
                                   enum pccd_method method)
{
    return step_by(f, mode, method, 1, ENG_SCHEDULER_STEAL);
}

/* Every slot of a tree is one feature of one object, with its own vertices. */
static uint32_t check_slots(const struct fixture *f, enum pccd_tree kind)
{
    const struct eng_wide *wide = eng_wide_of(f->scene);
    const struct eng_wide_tree *tree = &wide->trees[kind];
    uint32_t taken = 0;
    for (uint32_t slot = 0; slot < tree->slot_count; slot++) {
        uint32_t vertex = kind == PCCD_TREE_VERTICES ? slot : tree->corner[0][slot];
        if (wide->points[vertex].word0 == ENG_WIDE_NOBODY) {
            continue;
        }
        uint64_t key = eng_wide_key_of(wide, kind, slot);
        taken++;
        const struct eng_object *object = NULL;
        for (uint32_t i = 0; i < f->count; i++) {
            const struct eng_object *o = eng_scene_object(f->scene, f->objects[i]);
            object = o && o->id == (uint32_t)(key >> 32) ? o : object;
        }
        assert_non_null(object);
        uint32_t local = (uint32_t)key;
        if (kind == PCCD_TREE_VERTICES) {
            assert_int_equal((uint32_t)wide->points[slot].word0,
                             object->vertices.first + local);
            continue;
        }
        for (uint32_t k = 0; k < (kind == PCCD_TREE_EDGES ? 2u : 3u); k++) {
            uint32_t v = kind == PCCD_TREE_EDGES ? object->mesh->edges[local][k]
                                                 : object->mesh->leaves[local].v[k];
            assert_int_equal((uint32_t)wide->points[tree->corner[k][slot]].word0,
                             object->vertices.first + v);
        }
    }
    return taken;
}

/* A bound of a feature's box or a node's. */
static float bound_of(const struct eng_wide *wide, const struct eng_wide_tree *tree,
                      uint32_t level, uint32_t box, uint32_t side, uint32_t axis)
{
    uint32_t lane = box % ENG_WIDE;
    if (!wide->has_quantised) {
        return eng_wide_blocks(tree, level)[box / ENG_WIDE].row[side][axis][lane];
    }
    const struct eng_quantising *quantising = &wide->quantising;
    const struct eng_quantised_block *blocks = tree->quantised + tree->first[level];
    uint32_t both = blocks[box / ENG_WIDE].row[side % 2][axis][lane];
    bool is_low = side == ENG_LOW0 || side == ENG_LOW1;
    int16_t cells = (int16_t)(uint16_t)(is_low ? both & 0xffff : both >> 16);
    eng_wide_side back = {
        eng_wide_back_by((is_low ? quantising->below : quantising->above)[axis])};
    eng_wide_side distance = (eng_wide_side)eng_wide_distances(
        (eng_wide_bits){cells}, (eng_wide_side){1 / quantising->scale[axis]}, back);
    return cells == INT16_MIN ? ENG_NOWHERE : distance[0];
}

/* Return whether the box of a vertex holds where it is at both ends. Objects have no
 * frames here. */
static bool holds_vertex(const struct eng_wide *wide, uint32_t slot, uint32_t side,
                         uint32_t axis)
{
    const struct eng_point *point = &wide->points[slot];
    double x = (side % 2 == 0 ? point->x0 : point->x1)[axis];
    bool is_low = side == ENG_LOW0 || side == ENG_LOW1;
    float bound =
        bound_of(wide, &wide->trees[PCCD_TREE_VERTICES], 0, slot, side, axis);
    return point->word0 == ENG_WIDE_NOBODY || (double)bound >= (is_low ? -x : x);
}

static void check_boxes(const struct eng_wide *wide, enum pccd_tree kind)
{
    const struct eng_wide_tree *tree = &wide->trees[kind];
    assert_int_equal(tree->block_count[wide->level_count - 1], 1);
    for (uint32_t level = 0; level < wide->level_count; level++) {
        for (uint32_t i = 0; i < 12 * ENG_WIDE * tree->block_count[level]; i++) {
            uint32_t box = i / 12;
            uint32_t side = i % 4;
            uint32_t axis = i / 4 % 3;
            float bound = bound_of(wide, tree, level, box, side, axis);
            struct eng_extents around =
                eng_wide_box(wide, tree, level, box / ENG_WIDE);
            assert_true(around.side[side][axis] >= bound);
            assert_true(level > 0 || kind != PCCD_TREE_VERTICES ||
                        holds_vertex(wide, box, side, axis));
            for (uint32_t k = 0; level == 0 && k < 3; k++) {
                if (tree->corner[k]) {
                    float of_vertex = bound_of(wide, &wide->trees[PCCD_TREE_VERTICES], 0,
                                               tree->corner[k][box], side, axis);
                    assert_true(of_vertex <= bound);
                }
            }
            if (level > 0 && box < tree->block_count[level - 1]) {
                around = eng_wide_box(wide, tree, level - 1, box);
                assert_true(around.side[side][axis] == bound);
            }
        }
    }
}

/* If a slot kept what an object left there, a contact would name a ghost; if a box did
 * not hold what is below it, a contact would be missed. */
CASE_WITH(wide__trees_follow_objects_that_come_and_go, setup, teardown)
{
    struct fixture *f = *state;
    for (uint32_t round = 0; round < 4; round++) {
        if (round == 1) {
            assert_ok(eng_scene_remove(f->scene, f->objects[0]));
            f->objects[0] = UINT32_MAX;
        } else if (round == 2) {
            add(f, kit_sheet(9, 0.7));
        } else if (round == 3) {
            struct eng_mesh *mesh = kit_sheet(3, 0.1);
            assert_ok(eng_scene_replace(f->scene, f->objects[5], mesh));
            eng_mesh_release(mesh);
        }
        shake(f, SHAKEN_BY);
        step(f, PCCD_MODE_ALL, PCCD_METHOD_WIDE);
        uint32_t counts[ENG_WIDE_TREES] = {0};
        for (uint32_t i = 0; i < f->count; i++) {
            const struct eng_object *o = eng_scene_object(f->scene, f->objects[i]);
            counts[PCCD_TREE_VERTICES] += o ? o->vertices.count : 0;
            counts[PCCD_TREE_EDGES] += o ? o->mesh->info.edge_count : 0;
            counts[PCCD_TREE_FACES] += o ? o->mesh->info.triangle_count : 0;
        }
        for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
            assert_int_equal(check_slots(f, kind), counts[kind]);
            check_boxes(eng_wide_of(f->scene), kind);
        }
    }
}

/* The pairs that a sweep has found. */
struct found {
    uint64_t (*pairs)[3];
    uint32_t count;
};

static void visit(void *context, enum pccd_kind kind, const uint64_t *a,
                  const uint64_t *b, uint32_t count)
{
    struct found *found = context;
    for (uint32_t i = 0; i < count; i++) {
        assert_true(found->count < PAIRS_MAX);
        found->pairs[found->count][0] = kind;
        found->pairs[found->count][1] = a[i];
        found->pairs[found->count++][2] = b[i];
    }
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(uint64_t));
}

/* A feature by its vertices in the scene's arrays. */
struct feature {
    uint64_t key;
    uint32_t v[3];
    uint32_t count;
    struct eng_box box; /* around both ends */
};

static struct feature feature_of(const struct fixture *f, const struct eng_object *object,
                                 uint32_t local, const uint32_t *v, uint32_t count)
{
    struct feature feature = {.key = (uint64_t)object->id << 32 | local, .count = count};
    for (uint32_t i = 0; i < count; i++) {
        feature.v[i] = object->vertices.first + v[i];
        for (int end = 0; end < 2; end++) {
            const double *x = f->scene->x[end][feature.v[i]];
            struct eng_box box;
            memset(&box, 0, sizeof box);
            eng_box_of_point(&box, NULL, x, x);
            if (i == 0 && end == 0) {
                feature.box = box;
            }
            eng_box_unite(&feature.box, &feature.box, &box);
        }
    }
    return feature;
}

static uint32_t list_features(const struct fixture *f, enum pccd_tree kind,
                              struct feature *features)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        const struct eng_object *o = eng_scene_object(f->scene, f->objects[i]);
        const uint32_t n[ENG_WIDE_TREES] = {o->vertices.count, o->mesh->info.edge_count,
                                            o->mesh->info.triangle_count};
        for (uint32_t local = 0; local < n[kind]; local++) {
            const uint32_t *v = kind == PCCD_TREE_VERTICES ? &local
                                : kind == PCCD_TREE_EDGES  ? o->mesh->edges[local]
                                                           : o->mesh->leaves[local].v;
            features[count++] = feature_of(f, o, local, v, (uint32_t)kind + 1);
        }
    }
    return count;
}

static bool share_vertex(const struct feature *a, const struct feature *b)
{
    for (uint32_t i = 0; i < a->count * b->count; i++) {
        if (a->v[i % a->count] == b->v[i / a->count]) {
            return true;
        }
    }
    return false;
}

/* All pairs, one by one. */
static void brute_force(const struct fixture *f, enum pccd_kind kind, struct found *found)
{
    static struct feature a[4096];
    static struct feature b[4096];
    uint32_t a_count =
        list_features(f, kind == PCCD_VF ? PCCD_TREE_VERTICES : PCCD_TREE_EDGES, a);
    uint32_t b_count =
        list_features(f, kind == PCCD_VF ? PCCD_TREE_FACES : PCCD_TREE_EDGES, b);
    for (uint32_t i = 0; i < a_count; i++) {
        for (uint32_t j = 0; j < b_count; j++) {
            bool is_wanted = kind == PCCD_VF || a[i].key < b[j].key;
            if (is_wanted && eng_box_overlap(&a[i].box, &b[j].box) &&
                !share_vertex(&a[i], &b[j])) {
                visit(found, kind, &a[i].key, &b[j].key, 1);
            }
        }
    }
}

/* If a pair were lost on the way down, found twice, or by one number of threads only, the
 * comparison with other libraries would be of something else. */
CASE_WITH(wide__sweep_finds_the_pairs_of_brute_force, setup, teardown)
{
    struct fixture *f = *state;
    struct found expected = {calloc(PAIRS_MAX, sizeof *expected.pairs), 0};
    struct found found = {calloc(PAIRS_MAX, sizeof *found.pairs), 0};
    assert_true(expected.pairs && found.pairs);
    struct eng_wide_sweep one;
    struct eng_wide_sweep two;
    shake(f, SHAKEN_BY);
    step(f, PCCD_MODE_PAIRS, PCCD_METHOD_WIDE);
    assert_ok(eng_wide_sweep(f->scene, 1, visit, &found, &one));
    assert_ok(eng_wide_sweep(f->scene, 2, NULL, NULL, &two));
    brute_force(f, PCCD_VF, &expected);
    assert_int_equal(one.counts[PCCD_VF], expected.count);
    brute_force(f, PCCD_EE, &expected);
    assert_int_equal(one.counts[PCCD_VF] + one.counts[PCCD_EE], expected.count);
    assert_true(one.counts[PCCD_VF] > 1000 && one.counts[PCCD_EE] > 1000);
    assert_int_equal(found.count, expected.count);
    qsort(found.pairs, found.count, sizeof *found.pairs, compare);
    qsort(expected.pairs, expected.count, sizeof *expected.pairs, compare);
    assert_memory_equal(found.pairs, expected.pairs, found.count * sizeof *found.pairs);
    assert_true(two.counts[PCCD_VF] == one.counts[PCCD_VF] &&
                two.counts[PCCD_EE] == one.counts[PCCD_EE]);
    free(expected.pairs);
    free(found.pairs);
}

/* Have the next step of mode all look at the times of nodes, or not; otherwise the steps
 * before it decide. */
static void look_at_times(struct fixture *f, bool yes)
{
    eng_wide_of(f->scene)->steps_without_times[PCCD_VF] = !yes;
    eng_wide_of(f->scene)->steps_without_times[PCCD_EE] = !yes;
}

/* Candidates of the method wide, which may leave out nodes, or be off by the rounding of
 * boxes to whole numbers, against those of the method paper. */
static void check_candidates(const struct eng_wide *wide, bool in_time, uint64_t found,
                             uint64_t expected)
{
    uint64_t more = wide->has_quantised ? expected / 20 : 0;
    assert_true(found <= expected + more);
    assert_true(found >= expected || in_time);
}

/* If an answer depended on the method, it would not be the answer; if a counter did, but
 * for nodes left out for their times and for rounding, one of the two would miss pairs or
 * test them twice. */
CASE_WITH(wide__answers_as_paper_does, setup, teardown)
{
    struct fixture *f = *state;
    uint64_t records = 0;
    uint32_t quantised = 0;
    uint32_t floats = 0;
    for (uint32_t round = 0; round < 5 * MODES; round++) {
        enum pccd_mode mode = (enum pccd_mode)(round % MODES);
        bool in_time = round / MODES % 2;
        struct prng random = f->random;
        look_at_times(f, in_time);
        /* No boxes in whole numbers: it goes so far that features are small in cells. */
        f->thrown = round % 3 == 1 ? 12000 : 0;
        shake(f, round < MODES ? 0.01 : SHAKEN_BY);
        struct eng_step_result wide = step(f, mode, PCCD_METHOD_WIDE);
        bool is_quantised = eng_wide_of(f->scene)->has_quantised;
        quantised += is_quantised;
        floats += !is_quantised && mode == PCCD_MODE_ALL;
        f->random = random;
        shake(f, round < MODES ? 0.01 : SHAKEN_BY);
        struct eng_step_result paper = step(f, mode, PCCD_METHOD_PAPER);
        assert_int_equal(wide.count, paper.count);
        assert_true(wide.hash[0] == paper.hash[0] && wide.hash[1] == paper.hash[1]);
        assert_int_equal(wide.verdict, paper.verdict);
        if (mode == PCCD_MODE_PAIRS) {
            assert_int_equal(wide.counters.candidates[PCCD_VF],
                             paper.counters.candidates[PCCD_VF]);
            assert_int_equal(wide.counters.candidates[PCCD_EE],
                             paper.counters.candidates[PCCD_EE]);
        } else if (mode == PCCD_MODE_ALL) {
            check_candidates(eng_wide_of(f->scene), in_time,
                             wide.counters.candidates[PCCD_VF],
                             paper.counters.candidates[PCCD_VF]);
            check_candidates(eng_wide_of(f->scene), in_time,
                             wide.counters.candidates[PCCD_EE],
                             paper.counters.candidates[PCCD_EE]);
        }
        records += wide.count;
    }
    assert_true(records > 10000);
    assert_true(quantised >= 5 && floats >= 1);
}

/* If a task were lost or done twice, or a box read before it was made, the answer would
 * depend on the number of threads. */
CASE_WITH(wide__answers_alike_by_any_number_of_threads, setup, teardown)
{
    struct fixture *f = *state;
    for (uint32_t round = 0; round < 24; round++) {
        enum pccd_mode mode = (enum pccd_mode)(round % MODES);
        struct prng random = f->random;
        shake(f, SHAKEN_BY); /* a step before both, so that both follow the same one */
        (void)step(f, mode, PCCD_METHOD_WIDE);
        f->random = random;
        shake(f, SHAKEN_BY);
        look_at_times(f, true);
        struct eng_step_result one = step(f, mode, PCCD_METHOD_WIDE);
        f->random = random;
        shake(f, SHAKEN_BY);
        look_at_times(f, true);
        struct eng_step_result many =
            step_by(f, mode, PCCD_METHOD_WIDE, 2 + round % 3,
                    round / 4 % 2 ? ENG_SCHEDULER_PAPER : ENG_SCHEDULER_STEAL);
        assert_int_equal(many.count, one.count);
        assert_true(many.hash[0] == one.hash[0] && many.hash[1] == one.hash[1]);
        if (mode == PCCD_MODE_ALL || mode == PCCD_MODE_PAIRS) {
            assert_int_equal(many.counters.box_tests, one.counters.box_tests);
            assert_int_equal(many.counters.candidates[PCCD_EE],
                             one.counters.candidates[PCCD_EE]);
        }
    }
}

/* If a scene without objects, or an object of one triangle, were not a tree, the first
 * step of many clients would fail. */
CASE(wide__small_scenes_are_trees_too)
{
    struct fixture f = {.random = {3}};
    f.scene = kit_scene();
    assert_int_equal(step(&f, PCCD_MODE_ALL, PCCD_METHOD_WIDE).count, 0);
    add(&f, kit_soup(&f.random, 1));
    assert_int_equal(step(&f, PCCD_MODE_ALL, PCCD_METHOD_WIDE).count, 0);
    add(&f, kit_soup(&f.random, 1));
    shake(&f, 2);
    assert_true(step(&f, PCCD_MODE_PAIRS, PCCD_METHOD_WIDE).count > 0);
    assert_ok(eng_scene_remove(f.scene, f.objects[0]));
    assert_ok(eng_scene_remove(f.scene, f.objects[1]));
    assert_int_equal(step(&f, PCCD_MODE_ALL, PCCD_METHOD_WIDE).count, 0);
    eng_scene_free(f.scene);
}

/* If zeros with a sign were two places, features that touch there would be missed: two
 * triangles that reach to z = 0 from below and from above, crossing each other there. */
CASE(wide__zeros_of_both_signs_are_one_place)
{
    static const double low[3][3] = {{-1, 0, -0.0}, {1, 0, -0.0}, {0, 0, -1}};
    static const double high[3][3] = {{0, -1, 0.0}, {0, 1, 0.0}, {0, 0, 1}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    for (uint32_t round = 0; round < 2; round++) { /* either may be the first object */
        struct fixture f = {.random = {3}};
        f.scene = kit_scene();
        add(&f, kit_mesh(round ? high : low, 3, triangle, 1));
        add(&f, kit_mesh(round ? low : high, 3, triangle, 1));
        assert_int_equal(step(&f, PCCD_MODE_ALL, PCCD_METHOD_PAPER).count, 1);
        assert_int_equal(step(&f, PCCD_MODE_ALL, PCCD_METHOD_WIDE).count, 1);
        assert_int_equal(step(&f, PCCD_MODE_FIRST, PCCD_METHOD_WIDE).count, 1);
        eng_scene_free(f.scene);
    }
}

/* Needles beside each other, with corners anywhere along z: those of a chunk of faces lie
 * in more chunks of vertices than are listed. */
static void add_needles(struct fixture *f)
{
    static double x[3 * NEEDLES][3];
    static uint32_t triangles[NEEDLES][3];
    for (uint32_t i = 0; i < 3 * NEEDLES; i++) {
        x[i][0] = i / 3 % 40 + 0.3 * (i % 3 == 1);
        x[i][1] = i / 120 + 0.3 * (i % 3 == 2);
        x[i][2] = prng_between(&f->random, 0, 20);
        triangles[i / 3][i % 3] = i;
    }
    add(f, kit_mesh(x, 3 * NEEDLES, triangles, NEEDLES));
}

static bool has_more_chunks_than_listed(const struct eng_wide *wide)
{
    const struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_FACES];
    bool has = false;
    for (uint32_t i = 0; i < eng_wide_chunks(tree->slot_count); i++) {
        has |= tree->chunks[i].vertex_chunks > ENG_WIDE_CHUNK_VERTICES;
    }
    return has;
}

/* If it failed, a feature whose vertices lie far from each other would not move with
 * them; a sanitizer would see a read beyond the list of their chunks. */
CASE(wide__features_move_with_vertices_from_many_chunks)
{
    uint64_t records = 0;
    struct fixture f[2] = {{.random = {9}}, {.random = {9}}};
    for (uint32_t i = 0; i < 2; i++) {
        f[i].scene = kit_scene();
        add_needles(&f[i]);
    }
    for (uint32_t round = 0; round < 12; round++) {
        struct eng_step_result results[2];
        for (uint32_t i = 0; i < 2; i++) {
            uint32_t vertex = round * 397 % (3 * NEEDLES);
            const struct eng_object *object =
                eng_scene_object(f[i].scene, f[i].objects[0]);
            const double *x = object->mesh->x[vertex];
            const double x1[3] = {x[0] + 9.5, x[1] + 6.5, x[2]};
            eng_stage_begin(f[i].scene);
            assert_ok(eng_stage_x1(f[i].scene, f[i].objects[0], PCCD_FORMAT_F64, vertex,
                                   1, x1));
            results[i] =
                step(&f[i], PCCD_MODE_ALL, i == 0 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER);
        }
        assert_true(has_more_chunks_than_listed(eng_wide_of(f[0].scene)));
        assert_int_equal(results[0].count, results[1].count);
        assert_true(results[0].hash[0] == results[1].hash[0]);
        records += results[0].count;
    }
    assert_true(records > 12);
    eng_scene_free(f[0].scene);
    eng_scene_free(f[1].scene);
}

/* If a cancelled step went on, a client could not stop it; if it said that it was
 * complete, the client would believe it. */
CASE_WITH(wide__stops_when_cancelled, setup, teardown)
{
    struct fixture *f = *state;
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    atomic_bool cancel;
    atomic_init(&cancel, true);
    settings.method = PCCD_METHOD_WIDE;
    settings.cancel = &cancel;
    shake(f, SHAKEN_BY);
    struct eng_step_result result = kit_step(f->scene, &settings);
    assert_int_equal(result.incomplete, PCCD_INCOMPLETE_CANCELLED);
    assert_int_equal(result.counters.survivors, 0);
}
