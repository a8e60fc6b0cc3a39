/* eng_kit.c - what the engine's unit tests share. */
#include "eng_kit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "topology.h"

struct eng_mesh *kit_mesh(const double (*x)[3], uint32_t vertex_count,
                          const uint32_t (*triangles)[3], uint32_t triangle_count)
{
    return kit_mesh_thick(x, vertex_count, triangles, triangle_count, NULL);
}

struct eng_mesh *kit_mesh_thick(const double (*x)[3], uint32_t vertex_count,
                                const uint32_t (*triangles)[3], uint32_t triangle_count,
                                const double *radii)
{
    struct eng_mesh *mesh = NULL;
    uint32_t bad = 0;
    assert_int_equal(eng_mesh_new(vertex_count, triangle_count, &mesh), PCCD_OK);
    assert_int_equal(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, vertex_count, x),
                     PCCD_OK);
    assert_int_equal(eng_mesh_write_triangles(mesh, 0, triangle_count, triangles, &bad),
                     PCCD_OK);
    if (radii) {
        assert_int_equal(eng_mesh_write_radii(mesh, 0, vertex_count, radii), PCCD_OK);
    }
    assert_int_equal(eng_mesh_commit(mesh), PCCD_OK);
    assert_true(eng_feature_validate(mesh));
    return mesh;
}

struct eng_mesh *kit_sheet(uint32_t side, double z)
{
    uint32_t row = side + 1;
    double(*x)[3] = malloc(row * row * sizeof *x);
    uint32_t(*triangles)[3] = malloc((size_t)2 * side * side * sizeof *triangles);
    assert_non_null(x);
    assert_non_null(triangles);
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
    struct eng_mesh *mesh = kit_mesh((const double(*)[3])x, row * row,
                                     (const uint32_t(*)[3])triangles, 2 * side * side);
    free(x);
    free(triangles);
    return mesh;
}

struct eng_mesh *kit_soup(struct kit_random *random, uint32_t count)
{
    double(*x)[3] = malloc((size_t)3 * count * sizeof *x);
    uint32_t(*triangles)[3] = malloc(count * sizeof *triangles);
    double size = 1 / cbrt((double)count);
    assert_non_null(x);
    assert_non_null(triangles);
    for (uint32_t t = 0; t < count; t++) {
        double middle[3];
        for (int k = 0; k < 3; k++) {
            middle[k] = kit_between(random, 0, 1);
        }
        for (uint32_t i = 3 * t; i < 3 * t + 3; i++) {
            for (int k = 0; k < 3; k++) {
                x[i][k] = middle[k] + kit_between(random, -size, size);
            }
            triangles[t][i - 3 * t] = i;
        }
    }
    struct eng_mesh *mesh = kit_mesh((const double(*)[3])x, 3 * count,
                                     (const uint32_t(*)[3])triangles, count);
    free(x);
    free(triangles);
    return mesh;
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

static void random_vector(struct kit_random *random, uint32_t bound, double v[3])
{
    for (int k = 0; k < 3; k++) {
        v[k] = kit_integer(random, bound);
    }
}

void kit_plant(struct kit_random *random, enum pccd_kind kind, unsigned numerator,
               struct eng_query *query)
{
    double t = numerator / 8.0;
    double at[4][3];
    double way[4][3];
    unsigned beta = kit_below(random, 9);
    unsigned gamma = kit_below(random, kind == PCCD_VF ? 9 - beta : 9);
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
