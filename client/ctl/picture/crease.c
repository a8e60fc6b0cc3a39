/* crease.c - directions of a surface at its triangles' corners.
 *
 * Source: union-find with path halving (Tarjan and van Leeuwen 1984).
 */
#include "picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FLAT_COSINE 0.643f /* 50 degrees between the normals of two triangles */

/* An edge of a triangle, and the corners at its ends: those of its lower vertex first. */
struct side {
    uint32_t low, high; /* vertices */
    uint32_t corners[2];
};

static int by_vertices(const void *left, const void *right)
{
    const struct side *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return a->corners[0] < b->corners[0] ? -1 : a->corners[0] > b->corners[0];
}

static uint32_t root_of(uint32_t *above, uint32_t corner)
{
    while (above[corner] != corner) {
        above[corner] = above[above[corner]];
        corner = above[corner];
    }
    return corner;
}

static void join(uint32_t *above, uint32_t a, uint32_t b)
{
    uint32_t root_a = root_of(above, a), root_b = root_of(above, b);
    above[root_a > root_b ? root_a : root_b] = root_a > root_b ? root_b : root_a;
}

/* Of a triangle, as long as its area; in units of 2^octave. */
static void area_normal(const struct picture_mesh *mesh, uint32_t t, int octave,
                        float normal[3])
{
    const uint32_t *v = mesh->triangles[t];
    float a[3], b[3];
    for (uint32_t k = 0; k < 3; k++) {
        a[k] = ldexpf(mesh->x[v[1]][k] - mesh->x[v[0]][k], -octave);
        b[k] = ldexpf(mesh->x[v[2]][k] - mesh->x[v[0]][k], -octave);
    }
    normal[0] = a[1] * b[2] - a[2] * b[1];
    normal[1] = a[2] * b[0] - a[0] * b[2];
    normal[2] = a[0] * b[1] - a[1] * b[0];
}

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalize(float x[3])
{
    float length = sqrtf(dot(x, x)) + 1e-30f;
    for (uint32_t k = 0; k < 3; k++) {
        x[k] /= length;
    }
}

/* Join the corners of triangles that share an edge and are nearly flat there. */
static void join_flat(struct side *sides, uint32_t count, const float (*faces)[3],
                      uint32_t *above)
{
    qsort(sides, count, sizeof *sides, by_vertices);
    for (uint32_t i = 1; i < count; i++) {
        const struct side *a = &sides[i - 1], *b = &sides[i];
        const float *face_a = faces[a->corners[0] / 3],
                    *face_b = faces[b->corners[0] / 3];
        float lengths = sqrtf(dot(face_a, face_a)) * sqrtf(dot(face_b, face_b));
        /* A triangle without area has no direction of its own, and parts nothing. */
        if (a->low == b->low && a->high == b->high &&
            dot(face_a, face_b) >= FLAT_COSINE * lengths) {
            join(above, a->corners[0], b->corners[0]);
            join(above, a->corners[1], b->corners[1]);
        }
    }
}

bool crease_normals(const struct picture_mesh *mesh, int octave, float (*normals)[3])
{
    const uint32_t count = 3 * mesh->triangle_count;
    struct side *sides = malloc((count + 1) * sizeof *sides);
    float(*faces)[3] = malloc((mesh->triangle_count + 1) * sizeof *faces);
    uint32_t *above = malloc((count + 1) * sizeof *above);
    bool has_memory = sides != NULL && faces != NULL && above != NULL;
    for (uint32_t i = 0; has_memory && i < count; i++) {
        const uint32_t *v = mesh->triangles[i / 3];
        uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
        bool is_up = v[i % 3] < v[next % 3];
        sides[i] = (struct side){.low = is_up ? v[i % 3] : v[next % 3],
                                 .high = is_up ? v[next % 3] : v[i % 3],
                                 .corners = {is_up ? i : next, is_up ? next : i}};
        above[i] = i;
        if (i % 3 == 0) {
            area_normal(mesh, i / 3, octave, faces[i / 3]);
        }
    }
    if (has_memory) {
        join_flat(sides, count, (const float(*)[3])faces, above);
        memset(normals, 0, count * sizeof *normals);
    }
    for (uint32_t i = 0; has_memory && i < count; i++) {
        uint32_t root = root_of(above, i);
        for (uint32_t k = 0; k < 3; k++) {
            normals[root][k] += faces[i / 3][k];
        }
    }
    for (uint32_t i = 0; has_memory && i < count; i++) {
        uint32_t root = root_of(above, i); /* not after i: it has its length already */
        if (root == i) {
            normalize(normals[i]);
        } else {
            memcpy(normals[i], normals[root], sizeof normals[i]);
        }
    }
    free(sides);
    free(faces);
    free(above);
    return has_memory;
}
