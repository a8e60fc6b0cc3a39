/* eng_kit.c - what the engine's unit tests share. */
#include "eng_kit.h"

#include "eng_way.h"
#include "topology.h"

struct eng_mesh *kit_mesh(const void *x, uint32_t vertex_count, const void *triangles,
                          uint32_t triangle_count)
{
    return kit_mesh_thick(x, vertex_count, triangles, triangle_count, NULL);
}

struct eng_mesh *kit_mesh_thick(const void *x, uint32_t vertex_count,
                                const void *triangles, uint32_t triangle_count,
                                const double *radii)
{
    return kit_mesh_of(&(struct kit_shape){.counts = {vertex_count, triangle_count, 0, 0},
                                           .x = x,
                                           .triangles = triangles,
                                           .radii = radii});
}

struct eng_mesh *kit_mesh_of(const struct kit_shape *shape)
{
    const struct eng_mesh_counts *counts = &shape->counts;
    struct eng_mesh *mesh = NULL;
    uint32_t bad = 0;
    assert_ok(eng_mesh_make(counts, &mesh));
    assert_ok(
        eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, counts->vertices, shape->x));
    if (counts->triangles > 0) {
        assert_ok(
            eng_mesh_write_triangles(mesh, 0, counts->triangles, shape->triangles, &bad));
    }
    if (counts->edges > 0) {
        assert_ok(eng_mesh_write_edges(mesh, 0, counts->edges, shape->edges, &bad));
    }
    if (counts->points > 0) {
        assert_ok(eng_mesh_write_points(mesh, 0, counts->points, shape->points, &bad));
    }
    if (shape->radii) {
        assert_ok(eng_mesh_write_radii(mesh, 0, counts->vertices, shape->radii));
    }
    assert_ok(eng_mesh_commit(mesh, 1));
    assert_true(eng_feature_validate(mesh));
    return mesh;
}

struct eng_mesh *kit_sheet(uint32_t side, double z)
{
    uint32_t row = side + 1;
    double(*x)[3] = test_room(row * row * sizeof *x);
    uint32_t(*triangles)[3] = test_room((size_t)2 * side * side * sizeof *triangles);
    for (uint32_t i = 0; i < row * row; i++) {
        x[i][0] = (double)(i % row) / side;
        x[i][1] = (double)(i / row) / side;
        x[i][2] = z;
    }
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t corner = i / side * row + i % side;
        uint32_t square[2][3] = {{corner, corner + 1, corner + row},
                                 {corner + 1, corner + row + 1, corner + row}};
        memcpy(triangles[(size_t)2 * i], square, sizeof square);
    }
    struct eng_mesh *mesh = kit_mesh(x, row * row, triangles, 2 * side * side);
    free(x);
    free(triangles);
    return mesh;
}

struct eng_mesh *kit_box(const double low[3], const double high[3], bool inward)
{
    static const uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    double x[8][3];
    uint32_t triangles[12][3];
    for (uint32_t i = 0; i < 8; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            x[i][k] = (i >> k & 1u) != 0 ? high[k] : low[k];
        }
    }
    for (uint32_t i = 0; i < 12; i++) {
        const uint32_t *side = sides[i / 2];
        triangles[i][0] = side[0];
        triangles[i][1] = inward ? side[2 + i % 2] : side[1 + i % 2];
        triangles[i][2] = inward ? side[1 + i % 2] : side[2 + i % 2];
    }
    return kit_mesh(x, 8, triangles, 12);
}

struct eng_mesh *kit_soup(struct prng *random, uint32_t count)
{
    double(*x)[3] = test_room((size_t)3 * count * sizeof *x);
    uint32_t(*triangles)[3] = test_room(count * sizeof *triangles);
    double size = 1 / cbrt((double)count);
    for (uint32_t t = 0; t < count; t++) {
        double middle[3];
        for (int k = 0; k < 3; k++) {
            middle[k] = prng_between(random, 0, 1);
        }
        for (uint32_t i = 3 * t; i < 3 * t + 3; i++) {
            for (int k = 0; k < 3; k++) {
                x[i][k] = middle[k] + prng_between(random, -size, size);
            }
            triangles[t][i - 3 * t] = i;
        }
    }
    struct eng_mesh *mesh = kit_mesh(x, 3 * count, triangles, count);
    free(x);
    free(triangles);
    return mesh;
}

struct eng_scene *kit_scene(void)
{
    struct eng_scene *scene = NULL;
    assert_ok(eng_scene_new(NULL, &scene));
    return scene;
}

uint32_t kit_add(struct eng_scene *scene, struct eng_mesh *mesh, uint32_t id)
{
    uint32_t idx = UINT32_MAX;
    assert_ok(eng_scene_add(scene, mesh, id, &idx));
    eng_mesh_release(mesh);
    return idx;
}

struct eng_question kit_contacts(enum pccd_mode mode, enum pccd_method method)
{
    struct eng_question question = ENG_QUESTION_DEFAULT;
    question.mode = mode;
    question.method = method;
    return question;
}

struct eng_step_result kit_step(struct eng_scene *scene,
                                const struct eng_question *settings)
{
    struct eng_step_result result;
    assert_ok(eng_step(scene, settings, &result));
    return result;
}

struct eng_step_result kit_near(struct eng_scene *scene,
                                const struct eng_question *settings)
{
    struct eng_step_result result;
    assert_ok(eng_near(scene, settings, &result));
    return result;
}

struct kit kit;

void kit_begin(void)
{
    eng_scene_free(kit.scene);
    kit = (struct kit){.scene = kit_scene()};
}

void kit_put(struct eng_mesh *mesh)
{
    uint32_t i = kit.count++;
    assert_true(i < KIT_OBJECTS_MAX);
    kit.idx[i] = kit_add(kit.scene, mesh, i + 1);
}

void kit_begin_with(struct eng_mesh *a, struct eng_mesh *b)
{
    kit_begin();
    kit_put(a);
    kit_put(b);
}

struct eng_question kit_question(enum pccd_near_what what)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.verb = what;
    settings.end = 1;
    settings.distance = what == PCCD_NEAR_NEAREST ? INFINITY : 0;
    return settings;
}

struct eng_step_result kit_ask(const struct eng_question *settings)
{
    struct eng_question way = *settings;
    struct eng_step_result result = {0};
    void *kept = NULL;
    uint64_t count = 0;
    static uint32_t turn; /* the set of the teams, another one in each question */
    uint32_t sets = way_kernels_count();
    turn++;
    for (uint32_t i = 0; i < WAY_METHODS * (sets + 2); i++) {
        uint32_t k = i / WAY_METHODS; /* each set by one thread, then teams of 2 and 3 */
        way.method = way_methods[i % WAY_METHODS];
        way.threads = k < sets ? 1 : k - sets + 2;
        way.kernels = way_kernels(k < sets ? k : turn % sets);
        way.team_always = true;
        result = kit_near(kit.scene, &way);
        assert_int_equal(result.incomplete, PCCD_COMPLETE);
        if (i == 0) {
            count = result.count;
            kept = test_copy(result.records, (size_t)count * result.record_bytes);
        }
        assert_int_equal(result.count, count);
        if (settings->gap == 0 && count > 0) {
            assert_memory_equal(result.records, kept,
                                (size_t)count * result.record_bytes);
        }
    }
    free(kept);
    return result;
}

struct eng_step_result kit_ask_for(enum pccd_near_what what)
{
    struct eng_question settings = kit_question(what);
    return kit_ask(&settings);
}

void kit_check_names(const struct pccd_near *record, uint32_t kind, uint32_t object_a,
                     uint32_t feature_a, uint32_t object_b, uint32_t feature_b)
{
    assert_int_equal(record->kind, kind);
    assert_int_equal(record->object_a, object_a);
    assert_int_equal(record->feature_a, feature_a);
    assert_int_equal(record->object_b, object_b);
    assert_int_equal(record->feature_b, feature_b);
}

/* Let a point be at `at` at time t and move by `way` during the step. */
static void pass_through(struct eng_query *query, int point, const double at[3],
                         const double way[3], double t)
{
    for (int k = 0; k < 3; k++) {
        query->x[0][point][k] = at[k] - t * way[k];
        query->x[1][point][k] = at[k] + (1 - t) * way[k];
    }
}

static void random_vector(struct prng *random, uint32_t bound, double v[3])
{
    for (int k = 0; k < 3; k++) {
        v[k] = prng_integer(random, bound);
    }
}

void kit_plant(struct prng *random, enum pccd_kind kind, unsigned numerator,
               struct eng_query *query)
{
    double t = numerator / 8.0;
    double at[4][3];
    double way[4][3];
    unsigned beta = prng_u32(random, 9);
    unsigned gamma = prng_u32(random, kind == PCCD_VF ? 9 - beta : 9);
    for (int i = 0; i < 4; i++) {
        random_vector(random, 60, at[i]);
        random_vector(random, 60, way[i]);
    }
    query->kind = kind;
    for (int k = 0; k < 3; k++) {
        if (kind == PCCD_VF) {
            at[0][k] = at[1][k] + beta / 8.0 * (at[2][k] - at[1][k]) +
                       gamma / 8.0 * (at[3][k] - at[1][k]);
        } else {
            double on_a = at[0][k] + beta / 8.0 * (at[1][k] - at[0][k]);
            double along_b = at[3][k];
            at[2][k] = on_a - gamma / 8.0 * along_b;
            at[3][k] = on_a + (1 - gamma / 8.0) * along_b;
        }
    }
    for (int i = 0; i < 4; i++) {
        pass_through(query, i, at[i], way[i], t);
    }
}

void kit_place(struct eng_query *query, double factor, double offset)
{
    for (int i = 0; i < 24; i++) {
        double *x = &query->x[i / 12][i / 3 % 4][i % 3];
        *x = *x * factor + offset;
    }
}

uint32_t kit_word(struct prng *random)
{
    switch (prng_u32(random, 4)) {
    case 0:
        return prng_u32(random, 3);
    case 1:
        return UINT32_MAX - prng_u32(random, 3); /* the high bit */
    case 2:
        return 0x80000000u;
    default:
        return (uint32_t)prng_next(random);
    }
}

void kit_poly_init(struct eng_poly *poly)
{
    poly->degree = -1;
    for (int i = 0; i < ENG_POLY_TERMS; i++) {
        mpz_inits(poly->c[i], poly->scratch[i], NULL);
    }
}

void kit_poly_deinit(struct eng_poly *poly)
{
    for (int i = 0; i < ENG_POLY_TERMS; i++) {
        mpz_clears(poly->c[i], poly->scratch[i], NULL);
    }
}
