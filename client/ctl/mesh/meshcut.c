/* client/ctl/mesh/meshcut.c - polygons of a mesh, and what two frames of it share. */
#include "meshfile.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "polygon.h"

/* ---- cutting ----------------------------------------------------------------------- */

static int no_memory(const struct ctl_mesh *mesh, size_t corners, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %zu corners of polygons",
                         mesh->path, corners);
}

static int compare_numbers(const void *a, const void *b)
{
    uint32_t first = *(const uint32_t *)a, second = *(const uint32_t *)b;
    return (first > second) - (first < second);
}

static void place_of(const struct ctl_mesh *mesh, uint32_t vertex, double x[3])
{
    const struct ctl_others *others = mesh->others;
    uint32_t own = vertex - mesh->part.vertex_first;
    if (own < mesh->vertex_count) {
        for (size_t axis = 0; axis < 3; axis++) {
            x[axis] = common_coordinate(mesh->x, mesh->format, (size_t)own * 3 + axis);
        }
    } else {
        const uint32_t *found = bsearch(&vertex, others->vertices, others->count,
                                        sizeof vertex, compare_numbers);
        memcpy(x, others->x[found - others->vertices], sizeof *others->x);
    }
}

int ctl_mesh_cut(struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct ctl_cutter cutter = {0};
    const uint32_t *corners = mesh->corners;
    int status = PCCD_OK;
    for (size_t i = 0; i < mesh->polygon_count && status == PCCD_OK; i++) {
        const struct ctl_polygon *polygon = &mesh->polygons[i];
        uint32_t count = polygon->corner_count;
        if (!ctl_cutter_reserve(&cutter, count)) {
            status = no_memory(mesh, count, error);
            break;
        }
        for (uint32_t k = 0; k < count; k++) {
            place_of(mesh, corners[k], cutter.x[k]);
        }
        if (!ctl_cutter_cut(&cutter, count)) {
            status = ctl_error_set(
                error, PCCD_E_FORMAT,
                mesh->has_lines
                    ? "%s:%" PRIu64 ": a face of %" PRIu32
                      " corners that touches or crosses itself"
                    : "%s: face %" PRIu64 ": its %" PRIu32
                      " corners make a polygon that touches or crosses itself",
                mesh->path, polygon->place, count);
        }
        uint32_t *to = mesh->triangles.vertices + (size_t)polygon->triangle_first * 3;
        for (size_t k = 0; status == PCCD_OK && k < ((size_t)count - 2) * 3; k++) {
            to[k] = corners[cutter.cut[k / 3][k % 3]];
        }
        corners += count;
    }
    ctl_cutter_deinit(&cutter);
    return status;
}

int ctl_mesh_find_others(const struct ctl_mesh *mesh, struct ctl_others *others)
{
    size_t count = 0;
    others->vertices = malloc((mesh->corner_count + 1) * sizeof *others->vertices);
    for (size_t i = 0; i < mesh->corner_count && others->vertices != NULL; i++) {
        uint32_t own = mesh->corners[i] - mesh->part.vertex_first;
        if (own >= mesh->vertex_count) {
            others->vertices[count++] = mesh->corners[i];
        }
    }
    if (others->vertices != NULL) {
        qsort(others->vertices, count, sizeof *others->vertices, compare_numbers);
        for (size_t i = 0; i < count; i++) {
            if (i == 0 || others->vertices[i] != others->vertices[i - 1]) {
                others->vertices[others->count++] = others->vertices[i];
            }
        }
        others->x = calloc(others->count + 1, sizeof *others->x);
    }
    return others->x != NULL ? PCCD_OK : no_memory(mesh, mesh->corner_count, mesh->error);
}

/* ---- two frames -------------------------------------------------------------------- */

int ctl_mesh_other_count(const char *path_a, uint32_t a, const char *names,
                         const char *path_b, uint32_t b, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_INVAL,
                         "%s has %" PRIu32 " %s and %s has %" PRIu32
                         ": not two frames of one mesh",
                         path_a, a, names, path_b, b);
}

/* Return how many of `count` vertices are none of some others. */
static uint32_t count_new(const uint32_t *vertices, uint32_t count,
                          const uint32_t *others, uint32_t other_count)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool is_new = true;
        for (uint32_t k = 0; k < other_count; k++) {
            is_new = is_new && vertices[i] != others[k];
        }
        found += is_new;
    }
    return found;
}

/* Return whether both are two triangles of the same quad, cut by its two diagonals. */
static bool is_recut(const uint32_t a[6], const uint32_t b[6])
{
    uint32_t corners = 0;
    for (uint32_t i = 0; i < 6; i++) {
        corners += count_new(a + i, 1, a, i);
    }
    return corners == 4 && count_new(a, 6, b, 6) == 0 && count_new(b, 6, a, 6) == 0 &&
           count_new(b, 3, a, 3) > 0;
}

/* The polygon that a triangle is of, and its corners; NULL: it is of none. */
static const struct ctl_polygon *polygon_at(const struct ctl_mesh *mesh,
                                            uint32_t triangle, const uint32_t **corners)
{
    *corners = mesh->corners;
    for (size_t i = 0; i < mesh->polygon_count; i++) {
        const struct ctl_polygon *polygon = &mesh->polygons[i];
        if (triangle - polygon->triangle_first < polygon->corner_count - 2) {
            return polygon;
        }
        *corners += polygon->corner_count;
    }
    return NULL;
}

/* Triangle i is another one. */
static int other_triangle(const struct ctl_mesh *a, const struct ctl_mesh *b, uint32_t i,
                          struct ctl_error *error)
{
    const uint32_t *p = a->triangles.vertices, *q = b->triangles.vertices;
    const uint32_t *corners_a, *corners_b;
    const struct ctl_polygon *of_a = polygon_at(a, i, &corners_a);
    const struct ctl_polygon *of_b = polygon_at(b, i, &corners_b);
    if (of_a != NULL && of_b != NULL && of_a->triangle_first == of_b->triangle_first &&
        of_a->corner_count == of_b->corner_count) {
        uint32_t k = 0;
        while (k + 1 < of_a->corner_count && corners_a[k] == corners_b[k]) {
            k++;
        }
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s %" PRIu64
                             " has %u for corner %u in %s and %u in %s: not "
                             "two frames of one mesh",
                             a->has_lines ? "the face of line" : "face", of_a->place,
                             corners_a[k], k, a->path, corners_b[k], b->path);
    }
    if (of_a != NULL) {
        uint32_t first = of_a->triangle_first, count = of_a->corner_count;
        return ctl_error_set(error, PCCD_E_INVAL,
                             "triangles %u to %u are one face of %u corners in %s, and "
                             "others in %s: two topologies, not two frames of one mesh",
                             first, first + count - 3, count, a->path, b->path);
    }
    if (of_b != NULL) {
        return other_triangle(b, a, i, error);
    }
    uint32_t object = ctl_mesh_object_at(a, CTL_TRIANGLES, i);
    const char *name = object != CTL_NO_OBJECT ? a->objects[object].name : "";
    const char *of = name[0] != '\0' ? " of " : "";
    for (size_t from = i > 0 ? i - 1 : 0; from <= i; from++) {
        if (from + 1 < a->triangles.count && is_recut(p + 3 * from, q + 3 * from)) {
            return ctl_error_set(error, PCCD_E_INVAL,
                                 "triangles %zu and %zu%s%.100s are a quad that %s and "
                                 "%s cut by two diagonals: two topologies, not two "
                                 "frames of one mesh",
                                 from, from + 1, of, name, a->path, b->path);
        }
    }
    p += 3 * (size_t)i;
    q += 3 * (size_t)i;
    return ctl_error_set(error, PCCD_E_INVAL,
                         "triangle %u%s%.100s is (%u %u %u) in %s and (%u %u %u) in %s: "
                         "not two frames of one mesh",
                         i, of, name, p[0], p[1], p[2], a->path, q[0], q[1], q[2],
                         b->path);
}

int ctl_mesh_match(const struct ctl_mesh *a, const struct ctl_mesh *b,
                   struct ctl_error *error)
{
    static const char *const names[CTL_KINDS][2] = {
        {"point", "points"}, {"edge", "edges"}, {"triangle", "triangles"}};
    if (a->vertex_count != b->vertex_count) {
        return ctl_mesh_other_count(a->path, a->vertex_count, "vertices", b->path,
                                    b->vertex_count, error);
    }
    for (size_t kind = CTL_KINDS; kind-- > 0;) {
        const struct ctl_list *of_a = &a->lists[kind], *of_b = &b->lists[kind];
        if (of_a->count != of_b->count) {
            return ctl_mesh_other_count(a->path, of_a->count, names[kind][1], b->path,
                                        of_b->count, error);
        }
        for (size_t i = 0; i < of_a->count * (kind + 1); i++) {
            uint32_t p = of_a->vertices[i], q = of_b->vertices[i];
            uint32_t number = (uint32_t)(i / (kind + 1));
            if (p != q) {
                return kind == CTL_TRIANGLES
                           ? other_triangle(a, b, number, error)
                           : ctl_error_set(error, PCCD_E_INVAL,
                                           "%s %u has vertex %u in %s and %u in %s: not "
                                           "two frames of one mesh",
                                           names[kind][0], number, p, a->path, q,
                                           b->path);
            }
        }
    }
    return PCCD_OK;
}

int ctl_mesh_cut_like(const struct ctl_mesh *first, struct ctl_mesh *mesh,
                      struct ctl_error *error)
{
    const uint32_t *corners_a = first->corners, *corners_b = mesh->corners;
    const struct ctl_polygon *b = mesh->polygons;
    size_t left = mesh->polygon_count;
    for (size_t i = 0; i < first->polygon_count; i++) {
        const struct ctl_polygon *a = &first->polygons[i];
        const uint32_t count = a->corner_count;
        for (; left > 0 && b->triangle_first < a->triangle_first; left--, b++) {
            corners_b += b->corner_count;
        }
        if (left > 0 && b->triangle_first == a->triangle_first &&
            b->corner_count == count &&
            memcmp(corners_a, corners_b, count * sizeof *corners_a) == 0) {
            const size_t from = (size_t)a->triangle_first * 3;
            memcpy(mesh->triangles.vertices + from, first->triangles.vertices + from,
                   ((size_t)count - 2) * sizeof(uint32_t[3]));
        }
        corners_a += count;
    }
    return ctl_mesh_match(first, mesh, error);
}
