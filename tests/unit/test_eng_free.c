/* test_eng_free.c - edges and points of meshes that no triangle has. */
#include "distance.h"
#include "eng_kit.h"
#include "eng_way.h"
#include "kinds.h"
#include "near.h"
#include "thick.h"
#include "topology.h"

/* ---- meshes ------------------------------------------------------------------------ */

static const double line[9][3] = {{0}, {1}, {2}, {3}, {4}, {5}, {6}, {7}, {8}};

/* If it failed: what is named twice, or is a side or a corner anyway, would be tested
 * twice; an edge without length would be lost; a vertex that nothing names would be
 * tested. */
CASE(mesh__has_free_what_nothing_else_has)
{
    static const uint32_t triangles[1][3] = {{0, 1, 2}};
    static const uint32_t edges[6][2] = {{2, 1}, {4, 3}, {3, 4}, {5, 5}, {3, 2}, {3, 3}};
    static const uint32_t points[5] = {0, 4, 6, 6, 5};
    const struct kit_shape shape = {{9, 1, 6, 5}, line, triangles, edges, points, NULL};
    struct eng_mesh *mesh = kit_mesh_of(&shape);
    struct eng_mesh_info info;
    uint32_t ends[2][2];
    uint32_t alone[2];
    eng_mesh_get_info(mesh, &info);
    assert_int_equal(info.edge_count, 5); /* those of the triangle, 3-4 and 3-2 */
    assert_int_equal(info.free_edge_count, 2);
    assert_int_equal(info.free_point_count, 2); /* 5 and 6 */
    assert_int_equal(info.isolated_count, 2);   /* 7 and 8 */
    assert_int_equal(info.duplicate_count, 0);
    eng_mesh_get_free(mesh, ends, alone);
    assert_true(ends[0][0] + ends[0][1] + ends[1][0] + ends[1][1] == 4 + 3 + 3 + 2);
    assert_true(alone[0] + alone[1] == 5 + 6 && alone[0] != alone[1]);
    for (uint32_t v = 0; v < 9; v++) {
        assert_int_equal(eng_mesh_is_free(mesh, PCCD_TREE_VERTICES, v), v == 5 || v == 6);
    }
    for (uint32_t e = 0; e < info.edge_count; e++) {
        assert_int_equal(eng_mesh_is_free(mesh, PCCD_TREE_EDGES, e),
                         eng_mesh_edges(mesh)[e][1] >= 3);
    }
    eng_mesh_release(mesh);
}

/* If it failed: an edge or a point that names no vertex would be taken, or a mesh be
 * committed of which something has not arrived. */
CASE(mesh__takes_edges_and_points_whole_and_checked)
{
    static const struct eng_mesh_counts counts = {9, 0, 3, 2};
    static const struct eng_mesh_counts empty = {9, 0, 0, 0};
    static const uint32_t edges[3][2] = {{0, 1}, {1, 9}, {2, 3}};
    static const uint32_t points[2] = {8, 9};
    struct eng_mesh *mesh;
    uint32_t bad = 77;
    assert_int_equal(eng_mesh_make(&empty, &mesh), PCCD_E_INVAL);
    assert_ok(eng_mesh_make(&counts, &mesh));
    assert_int_equal(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, 9, line), 0);
    assert_int_equal(eng_mesh_write_edges(mesh, 0, 3, edges, &bad), PCCD_E_INDEX);
    assert_int_equal(bad, 1);
    assert_int_equal(eng_mesh_write_points(mesh, 0, 2, points, &bad), PCCD_E_INDEX);
    assert_int_equal(bad, 1);
    assert_int_equal(eng_mesh_write_edges(mesh, 1, 1, edges, &bad), PCCD_E_STATE);
    assert_int_equal(eng_mesh_write_edges(mesh, 0, 4, edges, &bad), PCCD_E_INVAL);
    assert_int_equal(eng_mesh_write_edges(mesh, 0, 1, edges, &bad), 0);
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_int_equal(eng_mesh_write_edges(mesh, 1, 1, edges, &bad), 0);
    assert_int_equal(eng_mesh_write_edges(mesh, 2, 1, edges, &bad), 0);
    assert_int_equal(eng_mesh_write_points(mesh, 0, 1, points, &bad), 0);
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_int_equal(eng_mesh_write_points(mesh, 1, 1, points, &bad), 0);
    assert_ok(eng_mesh_commit(mesh, 1));
    eng_mesh_release(mesh);
}

/* If it failed: a contact would be shown, and verified, at another place of its edge. */
CASE(kinds__place_contacts_by_their_parameters)
{
    const float param[2] = {0, 0.25F};
    const float of_face[2] = {0.5F, 0.25F};
    double w[2][3];
    common_contact_weights(PCCD_VE, param, w);
    assert_true(w[0][0] == 1 && w[1][0] == 0.75 && w[1][1] == 0.25 && w[1][2] == 0);
    common_contact_weights(PCCD_VV, (const float[2]){0, 0}, w);
    assert_true(w[0][0] == 1 && w[1][0] == 1 && w[1][1] == 0);
    common_contact_weights(PCCD_VF, of_face, w);
    assert_true(w[1][0] == 0.25 && w[1][1] == 0.5 && w[1][2] == 0.25);
    common_contact_weights(PCCD_EE, of_face, w);
    assert_true(w[0][1] == 0.5 && w[1][1] == 0.25);
}

/* ---- a scene ----------------------------------------------------------------------- */

/* Object 1 is a cloud; object 2 a sheet with rods and points, which are spread over its
 * vertices so that no block of features has one sort alone. */
#define CLOUD     700u
#define SIDE      10u
#define SHEET     ((SIDE + 1) * (SIDE + 1))
#define RODS      60u
#define SEGMENTS  4u
#define POINTS    200u
#define MIXED     (SHEET + RODS * (SEGMENTS + 1) + POINTS)
#define TRIANGLES (2 * SIDE * SIDE)

struct body {
    uint32_t id;
    uint32_t vertex_count;
    struct eng_mesh *mesh;
    double (*x[2])[3]; /* at both ends */
};

struct play {
    struct prng random;
    struct body bodies[2];
    struct eng_scene *scenes[32];
    struct eng_thick thick;
    struct eng_exact exact;
    double radius;
};

static void draw(struct play *play, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = prng_between(&play->random, 0, 1);
    }
}

static void make_body(struct play *play, struct body *body, const struct kit_shape *shape,
                      uint32_t id)
{
    double(*x)[3] = test_room(shape->counts.vertices * sizeof *x);
    struct kit_shape placed = *shape;
    *body =
        (struct body){.id = id, .vertex_count = shape->counts.vertices, .x = {NULL, x}};
    body->x[0] = malloc(shape->counts.vertices * sizeof *x);
    assert_non_null(body->x[0]);
    for (uint32_t v = 0; v < shape->counts.vertices; v++) {
        draw(play, x[v]);
        memcpy(body->x[0][v], x[v], sizeof x[v]);
    }
    placed.x = x;
    body->mesh = kit_mesh_of(&placed);
}

static void make_cloud(struct play *play)
{
    uint32_t points[CLOUD];
    for (uint32_t i = 0; i < CLOUD; i++) {
        points[i] = i;
    }
    const struct kit_shape shape = {.counts = {CLOUD, 0, 0, CLOUD}, .points = points};
    make_body(play, &play->bodies[0], &shape, 1);
}

static void make_mixed(struct play *play)
{
    uint32_t name[MIXED];
    uint32_t triangles[TRIANGLES][3];
    uint32_t edges[RODS * SEGMENTS][2];
    uint32_t points[POINTS];
    for (uint32_t i = 0; i < MIXED; i++) { /* in any order */
        uint32_t k = prng_u32(&play->random, i + 1);
        name[i] = name[k];
        name[k] = i;
    }
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        uint32_t corner = i / 2 / SIDE * (SIDE + 1) + i / 2 % SIDE;
        triangles[i][0] = name[corner + (i % 2)];
        triangles[i][1] = name[corner + (i % 2 ? SIDE + 2 : 1)];
        triangles[i][2] = name[corner + SIDE + 1];
    }
    for (uint32_t i = 0; i < RODS * SEGMENTS; i++) {
        uint32_t first = SHEET + i / SEGMENTS * (SEGMENTS + 1) + i % SEGMENTS;
        edges[i][0] = name[first];
        edges[i][1] = name[first + 1];
    }
    for (uint32_t i = 0; i < POINTS; i++) {
        points[i] = name[MIXED - POINTS + i];
    }
    const struct kit_shape shape = {{MIXED, TRIANGLES, RODS * SEGMENTS, POINTS},
                                    NULL,
                                    triangles,
                                    edges,
                                    points,
                                    NULL};
    make_body(play, &play->bodies[1], &shape, 2);
}

static void set_radius(struct play *play, double radius)
{
    const struct eng_object_thickness thickness = {.has_radius = true, .radius = radius};
    play->radius = radius;
    for (uint32_t i = 0; i < way_count(); i++) {
        for (uint32_t idx = 0; idx < 2; idx++) {
            assert_ok(eng_scene_set_thickness(play->scenes[i], idx, &thickness));
        }
    }
}

static void begin(struct play *play, uint64_t seed)
{
    memset(play, 0, sizeof *play);
    play->random.state = seed;
    assert_ok(eng_thick_init(&play->thick));
    assert_ok(eng_exact_init(&play->exact));
    make_cloud(play);
    make_mixed(play);
    assert_true(way_count() <= 32);
    for (uint32_t i = 0; i < way_count(); i++) {
        play->scenes[i] = kit_scene();
        for (uint32_t k = 0; k < 2; k++) {
            uint32_t idx;
            assert_ok(eng_scene_add(play->scenes[i], play->bodies[k].mesh,
                                    play->bodies[k].id, &idx));
            assert_int_equal(idx, k);
        }
    }
    set_radius(play, 0x1p-6);
}

static void end(struct play *play)
{
    for (uint32_t i = 0; i < way_count(); i++) {
        eng_scene_free(play->scenes[i]);
    }
    for (uint32_t k = 0; k < 2; k++) {
        eng_mesh_release(play->bodies[k].mesh);
        free(play->bodies[k].x[0]);
        free(play->bodies[k].x[1]);
    }
    eng_thick_deinit(&play->thick);
    eng_exact_deinit(&play->exact);
}

/* Move one vertex of `part`, by a little. */
static void move(struct play *play, uint32_t part)
{
    for (uint32_t i = 0; i < way_count(); i++) {
        eng_stage_begin(play->scenes[i]);
    }
    for (uint32_t k = 0; k < 2; k++) {
        struct body *body = &play->bodies[k];
        memcpy(body->x[0], body->x[1], body->vertex_count * sizeof *body->x[0]);
        for (uint32_t v = 0; v < body->vertex_count; v++) {
            if (prng_u32(&play->random, part) > 0) {
                continue;
            }
            for (int axis = 0; axis < 3; axis++) {
                body->x[1][v][axis] += prng_between(&play->random, -0.02, 0.02);
            }
            for (uint32_t i = 0; i < way_count(); i++) {
                assert_ok(eng_stage_x1(play->scenes[i], k, PCCD_FORMAT_F64, v, 1,
                                       body->x[1][v]));
            }
        }
    }
}

/* ---- all pairs --------------------------------------------------------------------- */

struct feature {
    const struct body *body;
    uint32_t index;
    uint32_t count;
    uint32_t v[3];
    double low[3];
    double high[3];
};

struct features {
    uint32_t count;
    struct feature items[3000];
};

static void add_feature(struct features *features, const struct body *body,
                        uint32_t index, const uint32_t *v, uint32_t count)
{
    struct feature *feature = &features->items[features->count++];
    assert_true(features->count <= 3000);
    *feature = (struct feature){.body = body, .index = index, .count = count};
    for (int k = 0; k < 3; k++) {
        feature->low[k] = INFINITY;
        feature->high[k] = -INFINITY;
        for (uint32_t i = 0; i < 2 * count; i++) {
            double x = body->x[i / count][v[i % count]][k];
            feature->low[k] = fmin(feature->low[k], x);
            feature->high[k] = fmax(feature->high[k], x);
        }
    }
    memcpy(feature->v, v, count * sizeof *v);
}

/* All features of a number of points; `free`: of those only. */
static void list(const struct play *play, uint32_t points, bool is_free,
                 struct features *features)
{
    features->count = 0;
    for (uint32_t k = 0; k < 2; k++) {
        const struct body *body = &play->bodies[k];
        const struct eng_mesh_info *info = &body->mesh->info;
        uint32_t all = points == 1   ? info->vertex_count
                       : points == 2 ? info->edge_count
                                     : info->triangle_count;
        for (uint32_t i = 0; i < all; i++) {
            const uint32_t *v = points == 1   ? &i
                                : points == 2 ? eng_mesh_edges(body->mesh)[i]
                                              : body->mesh->leaves[i].v;
            if (!is_free ||
                eng_mesh_is_free(body->mesh, (enum pccd_tree)(points - 1), i)) {
                add_feature(features, body, i, v, points);
            }
        }
    }
}

static bool may_meet(const struct feature *a, const struct feature *b, double reach)
{
    for (int k = 0; k < 3; k++) {
        if (a->low[k] > b->high[k] + reach || b->low[k] > a->high[k] + reach) {
            return false;
        }
    }
    for (uint32_t i = 0; i < a->count; i++) {
        for (uint32_t j = 0; j < b->count; j++) {
            if (a->body == b->body && a->v[i] == b->v[j]) {
                return false;
            }
        }
    }
    return true;
}

static void load(const struct feature *a, const struct feature *b, enum pccd_kind kind,
                 struct eng_query *query)
{
    query->kind = kind;
    for (uint32_t i = 0; i < 8; i++) {
        const struct feature *of = i % 4 < a->count ? a : b;
        uint32_t at = i % 4 < a->count ? i % 4 : i % 4 - a->count;
        at = at < of->count ? at : of->count - 1;
        memcpy(query->x[i / 4][i % 4], of->body->x[i / 4][of->v[at]],
               sizeof query->x[0][0]);
    }
}

/* Say something of a pair; its answer is the next of those that are compared. */
typedef void (*pair_fn)(struct play *play, enum pccd_kind kind, const struct feature *a,
                        const struct feature *b, void *context);

static void for_all_pairs(struct play *play, double reach, pair_fn say, void *context)
{
    static const struct {
        enum pccd_kind kind;
        uint32_t points[2];
        bool is_free;
    } kinds[4] = {{PCCD_VF, {1, 3}, false},
                  {PCCD_EE, {2, 2}, false},
                  {PCCD_VE, {1, 2}, true},
                  {PCCD_VV, {1, 1}, true}};
    static struct features sides[2];
    for (uint32_t i = 0; i < 4; i++) {
        bool is_one = kinds[i].points[0] == kinds[i].points[1];
        list(play, kinds[i].points[0], kinds[i].is_free, &sides[0]);
        list(play, kinds[i].points[1], kinds[i].is_free, &sides[1]);
        for (uint32_t a = 0; a < sides[0].count; a++) {
            for (uint32_t b = is_one ? a + 1 : 0; b < sides[1].count; b++) {
                if (may_meet(&sides[0].items[a], &sides[1].items[b], reach)) {
                    say(play, kinds[i].kind, &sides[0].items[a], &sides[1].items[b],
                        context);
                }
            }
        }
    }
}

static bool is_named(enum pccd_kind kind, const struct feature *a,
                     const struct feature *b, const struct pccd_contact *record)
{
    return record->kind == kind && record->object_a == a->body->id &&
           record->feature_a == a->index && record->object_b == b->body->id &&
           record->feature_b == b->index;
}

/* ---- steps ------------------------------------------------------------------------- */

struct contacts {
    const struct pccd_contact *records;
    uint64_t count;
    uint64_t at;
    uint64_t by_kind[PCCD_KIND_COUNT];
};

static void check_contact(struct play *play, enum pccd_kind kind, const struct feature *a,
                          const struct feature *b, void *context)
{
    struct contacts *contacts = context;
    struct eng_thick_query query = {.radius = {play->radius, play->radius, 0}};
    struct eng_hit hit;
    if (play->radius == 0 && (kind == PCCD_VE || kind == PCCD_VV)) {
        return;
    }
    load(a, b, kind, &query.query);
    if (eng_thick_solve(&play->thick, &play->exact, &query, 1e-6, 1, &hit)) {
        const struct pccd_contact *record = &contacts->records[contacts->at++];
        assert_true(contacts->at <= contacts->count);
        assert_true(is_named(kind, a, b, record));
        assert_true(record->flags == hit.flags && record->toi == hit.toi &&
                    record->toi_hi == hit.toi_hi);
        contacts->by_kind[kind]++;
    }
}

static struct eng_question way(uint32_t i, enum pccd_mode mode)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_DEFAULT);
    way_choose(i, &settings);
    return settings;
}

/* Take a step in every way; the first answer is compared with all pairs. */
static void step(struct play *play, enum pccd_mode mode,
                 uint64_t by_kind[PCCD_KIND_COUNT])
{
    uint64_t hash[2] = {0, 0};
    for (uint32_t i = 0; i < way_count(); i++) {
        struct eng_question settings = way(i, mode);
        struct eng_step_result result = kit_step(play->scenes[i], &settings);
        assert_true(way_tree_is_sound(play->scenes[i], &result));
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        if (i == 0) {
            memcpy(hash, result.hash, sizeof hash);
        }
        assert_memory_equal(result.hash, hash, sizeof hash);
        if (i == 0 && mode == PCCD_MODE_ALL) {
            struct contacts contacts = {.records = result.records, .count = result.count};
            for_all_pairs(play, 2 * play->radius, check_contact, &contacts);
            assert_int_equal(contacts.at, contacts.count);
            memcpy(by_kind, contacts.by_kind, sizeof contacts.by_kind);
            assert_memory_equal(result.counts, by_kind, sizeof contacts.by_kind);
        }
    }
}

/* If it failed: where there are more features than fit into one node, those that are free
 * would be missed among others, or others be taken for free; or boxes and records of what
 * stands be kept wrongly. */
CASE(step__finds_what_is_free_among_many)
{
    static const uint32_t parts[6] = {1, 1, 60, 1000, 60, 1};
    static struct play play;
    uint64_t by_kind[PCCD_KIND_COUNT];
    begin(&play, prng_seed());
    for (uint32_t i = 0; i < 6; i++) {
        move(&play, parts[i]);
        step(&play, PCCD_MODE_ALL, by_kind);
        assert_true(by_kind[PCCD_VF] > 10 && by_kind[PCCD_EE] > 10 &&
                    by_kind[PCCD_VE] > 10 && by_kind[PCCD_VV] > 10);
    }
    for (uint32_t mode = 1; mode < PCCD_MODE_COUNT; mode++) {
        move(&play, 1);
        step(&play, (enum pccd_mode)mode, by_kind);
    }
    end(&play);
}

/* If it failed: points that only touch points or edges would be found, which nothing can
 * keep apart. */
CASE(step__does_not_test_points_without_a_distance)
{
    static struct play play;
    uint64_t by_kind[PCCD_KIND_COUNT];
    begin(&play, prng_seed() + 1);
    set_radius(&play, 0);
    move(&play, 1);
    step(&play, PCCD_MODE_ALL, by_kind);
    assert_true(by_kind[PCCD_VF] > 10 && by_kind[PCCD_EE] > 10);
    assert_true(by_kind[PCCD_VE] == 0 && by_kind[PCCD_VV] == 0);
    end(&play);
}

/* ---- what is near ------------------------------------------------------------------ */

#define NEAR 0.03

struct near {
    struct eng_distances distances;
    const struct pccd_near *records;
    uint64_t count;
    uint64_t at;
    double bounds[2][MIXED > CLOUD ? MIXED : CLOUD];
};

static void check_near(struct play *play, enum pccd_kind kind, const struct feature *a,
                       const struct feature *b, void *context)
{
    struct near *near = context;
    uint8_t rank[4];
    struct eng_query query;
    struct eng_distance distance;
    load(a, b, kind, &query);
    if (!eng_distance_within(&near->distances, kind, (const double(*)[3])query.x[1],
                             NEAR)) {
        return;
    }
    for (uint8_t i = 0; i < 4; i++) { /* no distances are equal here */
        rank[i] = i;
    }
    eng_distance_find(&near->distances, kind, (const double(*)[3])query.x[1], rank,
                      &distance);
    const struct pccd_near *record = &near->records[near->at++];
    assert_true(near->at <= near->count);
    assert_true(is_named(kind, a, b, (const struct pccd_contact *)(const void *)record));
    assert_true(record->d_lo == distance.lo && record->d_hi == distance.hi &&
                PCCD_NEAR_TYPE(record->flags) == (uint32_t)distance.type);
    assert_true(record->param[0] == (float)distance.param[0] &&
                record->param[1] == (float)distance.param[1]);
    if (kind == PCCD_VE || kind == PCCD_VV) { /* the nearest point is where it is said */
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double at = query.x[1][1][k] +
                        distance.param[1] * (query.x[1][2][k] - query.x[1][1][k]);
            square += (query.x[1][0][k] - at) * (query.x[1][0][k] - at);
        }
        assert_true(distance.param[0] == 0 && fabs(sqrt(square) - distance.lo) < 1e-8);
    }
    for (int side = 0; side < 2; side++) {
        const struct feature *of = side == 0 ? a : b;
        for (uint32_t i = 0; i < of->count; i++) {
            double *bound = &near->bounds[of->body->id - 1][of->v[i]];
            *bound = fmin(*bound, distance.lo);
        }
    }
    (void)play;
}

static struct eng_step_result ask(struct play *play, enum pccd_near_what what, uint32_t i)
{
    struct eng_question settings = way(i, PCCD_MODE_ALL);
    settings.verb = what;
    settings.distance = NEAR;
    settings.end = 1;
    struct eng_step_result result = kit_near(play->scenes[i], &settings);
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    return result;
}

/* Features that are closest are those of the pairs, each once; bounds the least of
 * them. */
static void check_merged(struct play *play, struct near *near, uint32_t i, uint64_t pairs)
{
    struct eng_step_result result = ask(play, PCCD_NEAR_FEATURES, i);
    const struct pccd_near *records = result.records;
    uint64_t sum = 0;
    for (uint64_t k = 0; k < result.count; k++) {
        sum += records[k].count;
        assert_true(k == 0 || memcmp(&records[k - 1], &records[k], sizeof *records) != 0);
    }
    assert_int_equal(sum, pairs);
    result = ask(play, PCCD_NEAR_VERTICES, i);
    assert_int_equal(result.count, CLOUD + MIXED);
    assert_memory_equal(result.records, near->bounds[0], CLOUD * sizeof(double));
    assert_memory_equal((const double *)result.records + CLOUD, near->bounds[1],
                        MIXED * sizeof(double));
}

/* If it failed: points and rods that are near would be missed, or have another distance,
 * place or bound than theirs. */
CASE(near__has_free_points_and_edges)
{
    static struct play play;
    static struct near near;
    uint64_t hash[2][2] = {{0}};
    begin(&play, prng_seed() + 2);
    set_radius(&play, 0);
    move(&play, 1);
    for (uint32_t i = 0; i < way_count(); i++) {
        struct eng_question settings = way(i, PCCD_MODE_ANY);
        kit_step(play.scenes[i], &settings);
    }
    assert_ok(eng_distances_init(&near.distances));
    for (uint32_t i = 0; i < way_count(); i++) {
        struct eng_step_result result = ask(&play, PCCD_NEAR_PAIRS, i);
        if (i == 0) {
            near.records = result.records;
            near.count = result.count;
            for (uint32_t v = 0; v < sizeof near.bounds[0] / sizeof(double); v++) {
                near.bounds[0][v] = NEAR;
                near.bounds[1][v] = NEAR;
            }
            for_all_pairs(&play, NEAR, check_near, &near);
            assert_int_equal(near.at, near.count);
            assert_true(result.counts[PCCD_VE] > 10 && result.counts[PCCD_VV] > 10);
            memcpy(hash[0], result.hash, sizeof hash[0]);
        }
        assert_memory_equal(result.hash, hash[0], sizeof hash[0]);
        check_merged(&play, &near, i, result.count);
        result = ask(&play, PCCD_NEAR_FEATURES, i);
        if (i == 0) {
            memcpy(hash[1], result.hash, sizeof hash[1]);
        }
        assert_memory_equal(result.hash, hash[1], sizeof hash[1]);
    }
    eng_distances_deinit(&near.distances);
    end(&play);
}
