/* test_reg_positions.c - where the objects of a registry are. */
#include "cases.h"
#include "pccd_types.h"
#include "prng.h"
#include "registry.h"

#define VERTICES 13u

static double draw(struct prng *prng)
{
    return (double)prng_below(prng, 1u << 20) / 1000.0 - 500.0;
}

/* Positions or matrices of a motion, in bytes that are not aligned. */
struct payload {
    uint8_t start[1 + sizeof(double[VERTICES][3])];
    uint8_t end[1 + sizeof(double[VERTICES][3])];
};

static void fill(struct prng *prng, const struct registry_motion *motion, uint8_t *to)
{
    size_t count = motion->is_rigid ? 12 : 3 * motion->count;

    for (size_t i = 0; i < count; i++) {
        double wide = draw(prng);
        float narrow = (float)wide;

        if (motion->is_rigid || motion->format == PCCD_FORMAT_F64) {
            memcpy(to + i * sizeof wide, &wide, sizeof wide);
        } else {
            memcpy(to + i * sizeof narrow, &narrow, sizeof narrow);
        }
    }
}

static struct registry_motion draw_motion(struct prng *prng, struct payload *payload)
{
    struct registry_motion motion = {.is_rigid = prng_below(prng, 3) == 0,
                                     .format = prng_u32(prng, 2),
                                     .count = VERTICES};

    if (prng_below(prng, 2) == 0) {
        motion.first = prng_u32(prng, VERTICES);
        motion.count = prng_u32(prng, VERTICES - motion.first + 1);
    }
    fill(prng, &motion, payload->start + 1);
    fill(prng, &motion, payload->end + 1);
    motion.start =
        prng_below(prng, 2) == 0 || motion.is_rigid ? payload->start + 1 : NULL;
    motion.end = payload->end + 1;
    return motion;
}

static struct registry_object *make(struct prng *prng, struct registry *registry,
                                    uint32_t format)
{
    const struct registry_settings plain = {.name = ""};
    static const uint32_t faces[1][3] = {{0, 1, 2}};
    const struct registry_motion whole = {.format = format, .count = VERTICES};
    uint8_t x[sizeof(double[VERTICES][3])];
    struct registry_scene *scene = registry_add_scene(registry, 1, &plain);
    struct registry_mesh *mesh;
    struct registry_object *object;

    fill(prng, &whole, x);
    mesh = registry_mesh_copy(&(struct registry_shape){.format = format,
                                                       .vertex_count = VERTICES,
                                                       .triangle_count = 1,
                                                       .x = x,
                                                       .triangles = faces});
    assert_true(scene != NULL && mesh != NULL);
    assert_int_equal(registry_put_mesh(registry, 2, mesh, 1), 0);
    object = registry_add_object(scene, mesh, 3, 1);
    assert_non_null(object);
    return object;
}

/* One vertex of an object whose end alone is followed. */
static void end_of(const struct registry_object *object, uint32_t vertex, double to[3])
{
    const struct registry_mesh *mesh = object->mesh;
    bool own = object->placing == REGISTRY_FREELY;
    const void *from = own ? object->x : mesh->x;
    double x[3];

    for (uint32_t k = 0; k < 3; k++) {
        x[k] = (own ? object->format : mesh->format) == PCCD_FORMAT_F64
                   ? ((const double *)from)[3 * vertex + k]
                   : (double)((const float *)from)[3 * vertex + k];
    }
    for (uint32_t k = 0; k < 3; k++) {
        const double *r = object->m + 4 * k;

        to[k] = object->placing == REGISTRY_RIGID
                    ? ((r[0] * x[0] + r[1] * x[1]) + r[2] * x[2]) + r[3]
                    : x[k];
    }
}

/* If it failed, another daemon would be told of other positions than a recording of the
 * same client is repeated with, or than the last daemon has computed with. */
CASE(ends__are_the_same_in_both_ways)
{
    struct prng prng = {prng_seed()};

    for (uint32_t round = 0; round < 400; round++) {
        struct registry compact = {.meshes = NULL};
        struct registry both = {.meshes = NULL};
        struct prng again = prng;
        struct registry_object *a = make(&prng, &compact, round % 2);
        struct registry_object *b = make(&again, &both, round % 2);
        double last[VERTICES][3];

        assert_int_equal(registry_follow(b), 0);
        for (uint32_t step = 0; step < 8; step++) {
            struct payload payload;
            const struct registry_motion motion = draw_motion(&prng, &payload);

            memcpy(last, b->x1, sizeof last);
            assert_int_equal(registry_place(a, &motion), 0);
            registry_begin_step(both.scenes);
            registry_move(b, &motion);
            for (uint32_t v = 0; v < VERTICES; v++) {
                bool moves = v >= motion.first && v - motion.first < motion.count;
                double end[3];

                end_of(a, v, end);
                assert_memory_equal(end, b->x1[v], sizeof end);
                if (motion.start == NULL || !moves) {
                    assert_memory_equal(last[v], b->x0[v], sizeof last[v]);
                }
            }
        }
        registry_deinit(&compact);
        registry_deinit(&both);
    }
}

/* If it failed, a rigid body would cost as much as its vertices do, for each client. */
CASE(rigid_bodies__are_kept_as_transforms)
{
    struct prng prng = {prng_seed()};
    struct registry registry = {.meshes = NULL};
    struct registry_object *object = make(&prng, &registry, PCCD_FORMAT_F32);
    struct payload payload;
    const struct registry_motion motion = {.is_rigid = true,
                                           .format = PCCD_FORMAT_F64,
                                           .count = VERTICES,
                                           .end = payload.end + 1};

    fill(&prng, &motion, payload.end + 1);
    assert_int_equal(registry_place(object, &motion), 0);
    assert_int_equal(object->placing, REGISTRY_RIGID);
    assert_null(object->x);
    registry_deinit(&registry);
}
