/* client/ctl/mesh/meshmatch.c - whether two meshes are two frames of one.
 *
 * Room:     client/ctl.
 * Does:     compare counts and numbers of vertices; name what differs first.
 * Threads:  [any]; nothing is shared.
 * Source:   meshfile.h.
 */
#include <string.h>

#include "meshfile.h"

/* Four vertices of two triangles, ascending; false: they have others. */
static bool quad_of(const uint32_t (*triangles)[3], uint32_t quad[4])
{
    uint32_t count = 0;
    for (int i = 0; i < 6; i++) {
        uint32_t vertex = triangles[i / 3][i % 3], k = 0;
        while (k < count && quad[k] < vertex) {
            k++;
        }
        if (k < count && quad[k] == vertex) {
            continue;
        }
        if (count == 4) {
            return false;
        }
        memmove(quad + k + 1, quad + k, (count - k) * sizeof *quad);
        quad[k] = vertex;
        count++;
    }
    return count == 4;
}

static bool has_vertex(const uint32_t triangle[3], uint32_t vertex)
{
    return triangle[0] == vertex || triangle[1] == vertex || triangle[2] == vertex;
}

/* Whether two triangles of both are one quad, cut by two diagonals. */
static bool is_recut_at(const struct ctl_mesh *a, const struct ctl_mesh *b, uint32_t i)
{
    uint32_t quads[2][4];
    const uint32_t(*p)[3] = (const uint32_t(*)[3])a->triangles + i;
    const uint32_t(*q)[3] = (const uint32_t(*)[3])b->triangles + i;
    return i + 1 < a->triangle_count && quad_of(p, quads[0]) && quad_of(q, quads[1]) &&
           memcmp(quads[0], quads[1], sizeof quads[0]) == 0 &&
           !(has_vertex(p[0], q[0][0]) && has_vertex(p[0], q[0][1]) &&
             has_vertex(p[0], q[0][2]));
}

/* The object that a triangle belongs to; "": none has a name. */
static const char *object_of(const struct ctl_mesh *mesh, uint32_t triangle)
{
    const char *name = "";
    for (uint32_t i = 0; i < mesh->object_count; i++) {
        name = mesh->objects[i].triangle_first <= triangle ? mesh->objects[i].name : name;
    }
    return name;
}

static int other_triangle(const struct ctl_mesh *a, const char *path_a,
                          const struct ctl_mesh *b, const char *path_b, uint32_t i,
                          struct ctl_error *error)
{
    const uint32_t *p = a->triangles[i], *q = b->triangles[i];
    const char *name = object_of(a, i);
    const char *of = name[0] != '\0' ? " of " : "";
    for (uint32_t from = i > 0 ? i - 1 : 0; from <= i; from++) {
        if (is_recut_at(a, b, from)) {
            return ctl_error_set(error, PCCD_E_INVAL,
                                 "triangles %u and %u%s%.100s are a quad that %s and %s "
                                 "cut by two diagonals: two topologies, not two frames "
                                 "of one mesh",
                                 from, from + 1, of, name, path_a, path_b);
        }
    }
    return ctl_error_set(error, PCCD_E_INVAL,
                         "triangle %u%s%.100s is (%u %u %u) in %s and (%u %u %u) in %s: "
                         "not two frames of one mesh",
                         i, of, name, p[0], p[1], p[2], path_a, q[0], q[1], q[2], path_b);
}

/* The same of what is named by itself, `points` vertices each. */
static int match_named(const uint32_t *a, uint32_t count_a, const char *path_a,
                       const uint32_t *b, uint32_t count_b, const char *path_b,
                       uint32_t points, struct ctl_error *error)
{
    static const char *const names[3][2] = {{""}, {"point", "points"}, {"edge", "edges"}};
    if (count_a != count_b) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s has %u %s and %s has %u: not two frames of one mesh",
                             path_a, count_a, names[points][1], path_b, count_b);
    }
    for (size_t i = 0; i < (size_t)count_a * points; i++) {
        if (a[i] != b[i]) {
            return ctl_error_set(
                error, PCCD_E_INVAL,
                "%s %zu has vertex %u in %s and %u in %s: not two frames "
                "of one mesh",
                names[points][0], i / points, a[i], path_a, b[i], path_b);
        }
    }
    return PCCD_OK;
}

int ctl_mesh_match(const struct ctl_mesh *a, const char *path_a, const struct ctl_mesh *b,
                   const char *path_b, struct ctl_error *error)
{
    if (a->vertex_count != b->vertex_count) {
        return ctl_error_set(
            error, PCCD_E_INVAL,
            "%s has %u vertices and %s has %u: not two frames of one mesh", path_a,
            a->vertex_count, path_b, b->vertex_count);
    }
    if (a->triangle_count != b->triangle_count) {
        return ctl_error_set(
            error, PCCD_E_INVAL,
            "%s has %u triangles and %s has %u: not two frames of one mesh", path_a,
            a->triangle_count, path_b, b->triangle_count);
    }
    for (uint32_t i = 0; i < a->triangle_count; i++) {
        if (memcmp(a->triangles[i], b->triangles[i], sizeof *a->triangles) != 0) {
            return other_triangle(a, path_a, b, path_b, i, error);
        }
    }
    int status = match_named((const uint32_t *)a->edges, a->edge_count, path_a,
                             (const uint32_t *)b->edges, b->edge_count, path_b, 2, error);
    return status == PCCD_OK ? match_named(a->points, a->point_count, path_a, b->points,
                                           b->point_count, path_b, 1, error)
                             : status;
}
