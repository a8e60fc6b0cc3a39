/* client/ctl/mesh/meshcut.c - polygons of a mesh.
 *
 * Room:     client/ctl.
 * Does:     keeps which triangles are one polygon. As it is read they are a fan, which
 *           tells its corners; of those that are cut otherwise the corners are kept.
 * Threads:  [any]; nothing is shared.
 * Source:   meshcut.h.
 */
#include "meshcut.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "polygon.h"

int ctl_mesh_end_polygon(struct ctl_mesh *mesh, uint64_t corner_count, uint64_t place,
                         const char *path, struct ctl_error *error)
{
    uint32_t total = mesh->polygon_count;
    if (corner_count < 4 || mesh->part.leaves_out) {
        return PCCD_OK;
    }
    int status =
        ctl_mesh_grow(&mesh->polygons, sizeof *mesh->polygons, mesh->polygon_count,
                      &mesh->polygon_capacity, &total, true, "polygons", path, error);
    if (status == PCCD_OK) {
        /* There are as many triangles, nearly, so it fits. */
        uint32_t count = (uint32_t)corner_count;
        mesh->polygons[mesh->polygon_count++] =
            (struct ctl_polygon){.triangle_first = mesh->triangle_count - (count - 2),
                                 .corner_count = count & INT32_MAX,
                                 .is_recut = false,
                                 .place = place};
    }
    return status;
}

/* Corner k of a polygon; `kept` is where its corners are kept, if they are. */
static uint32_t corner_of(const struct ctl_mesh *mesh, const struct ctl_polygon *polygon,
                          const uint32_t *kept, uint32_t k)
{
    const uint32_t(*fan)[3] =
        (const uint32_t(*)[3])mesh->triangles + polygon->triangle_first;
    return polygon->is_recut ? kept[k] : k < 2 ? fan[0][k] : fan[k - 2][2];
}

/* ---- cutting ----------------------------------------------------------------------- */

static void place_of(const struct ctl_mesh *mesh, const struct ctl_wanted *wanted,
                     uint32_t vertex, double x[3])
{
    uint32_t own = vertex - mesh->part.vertex_first;
    if (own < mesh->vertex_count) {
        for (int axis = 0; axis < 3; axis++) {
            size_t index = (size_t)own * 3 + (size_t)axis;
            x[axis] = mesh->format == PCCD_FORMAT_F32
                          ? (double)((const float *)mesh->x)[index]
                          : ((const double *)mesh->x)[index];
        }
        return;
    }
    uint32_t from = 0, to = wanted->count;
    while (to - from > 1) {
        uint32_t middle = from + (to - from) / 2;
        *(wanted->vertices[middle] <= vertex ? &from : &to) = middle;
    }
    memcpy(x, wanted->x[from], sizeof wanted->x[from]);
}

/* Where a polygon is in its file, for messages. */
static int no_cut(const struct ctl_mesh *mesh, const struct ctl_polygon *polygon,
                  const char *path, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_FORMAT,
                         mesh->has_lines ? "%s:%" PRIu64 ": a face of %" PRIu32
                                           " corners that touches or crosses itself"
                                         : "%s: face %" PRIu64 ": its %" PRIu32
                                           " corners make a polygon that touches or "
                                           "crosses itself",
                         path, polygon->place, (uint32_t)polygon->corner_count);
}

/* Write the cut of a polygon over its fan. If it is another one, keep its corners. */
static int write_cut(struct ctl_mesh *mesh, struct ctl_polygon *polygon,
                     const uint32_t *corners, uint32_t (*cut)[3], const char *path,
                     struct ctl_error *error)
{
    uint32_t(*to)[3] = mesh->triangles + polygon->triangle_first;
    uint32_t count = polygon->corner_count;
    bool is_fan = true;
    for (uint32_t i = 0; i + 2 < count && is_fan; i++) {
        is_fan = cut[i][0] == 0 && cut[i][1] == i + 1 && cut[i][2] == i + 2;
    }
    for (uint32_t k = 0; k < count && !is_fan && !polygon->is_recut; k++) {
        uint32_t total = mesh->corner_count;
        int status = ctl_mesh_grow(&mesh->corners, sizeof *mesh->corners,
                                   mesh->corner_count, &mesh->corner_capacity, &total,
                                   true, "corners of polygons", path, error);
        if (status != PCCD_OK) {
            mesh->corner_count -= k;
            return status;
        }
        mesh->corners[mesh->corner_count++] = corners[k];
    }
    polygon->is_recut = polygon->is_recut || !is_fan;
    for (uint32_t i = 0; i + 2 < count; i++) {
        for (int k = 0; k < 3; k++) {
            to[i][k] = corners[cut[i][k]];
        }
    }
    return PCCD_OK;
}

/* A mesh that is cut once more, where other positions are its first frame's, may have
 * more polygons whose corners are kept, between others: all are then written anew. */
int ctl_mesh_cut(struct ctl_mesh *mesh, const struct ctl_wanted *wanted, const char *path,
                 struct ctl_error *error)
{
    struct ctl_cutter cutter = {0};
    uint32_t *corners = NULL, *before = mesh->corners;
    uint32_t capacity = 0;
    const uint32_t *kept = before;
    int status = PCCD_OK;
    mesh->corners = NULL;
    mesh->corner_count = mesh->corner_capacity = 0;
    for (uint32_t i = 0; i < mesh->polygon_count && status == PCCD_OK; i++) {
        struct ctl_polygon *polygon = &mesh->polygons[i];
        uint32_t count = polygon->corner_count;
        if (count > capacity) {
            free(corners);
            capacity = count * 2;
            corners = malloc((size_t)capacity * sizeof *corners);
        }
        if (corners == NULL || !ctl_cutter_reserve(&cutter, count)) {
            status = ctl_error_set(error, PCCD_E_NOMEM,
                                   "%s: no memory for a polygon of %" PRIu32 " corners",
                                   path, count);
            break;
        }
        for (uint32_t k = 0; k < count; k++) {
            corners[k] = corner_of(mesh, polygon, kept, k);
            place_of(mesh, wanted, corners[k], cutter.x[k]);
        }
        kept += polygon->is_recut ? count : 0;
        polygon->is_recut = false;
        status = ctl_cutter_cut(&cutter, count)
                     ? write_cut(mesh, polygon, corners, cutter.cut, path, error)
                     : no_cut(mesh, polygon, path, error);
    }
    free(corners);
    free(before);
    ctl_cutter_deinit(&cutter);
    return status;
}

/* ---- parts ------------------------------------------------------------------------- */

static int compare_numbers(const void *a, const void *b)
{
    uint32_t first = *(const uint32_t *)a, second = *(const uint32_t *)b;
    return (first > second) - (first < second);
}

int ctl_mesh_want(const struct ctl_mesh *mesh, struct ctl_wanted *wanted,
                  const char *path, struct ctl_error *error)
{
    size_t corners = 0, count = 0;
    for (uint32_t i = 0; i < mesh->polygon_count; i++) {
        corners += mesh->polygons[i].corner_count;
    }
    *wanted = (struct ctl_wanted){.vertices = malloc((corners + 1) * sizeof(uint32_t))};
    for (uint32_t i = 0; i < mesh->polygon_count && wanted->vertices != NULL; i++) {
        const struct ctl_polygon *polygon = &mesh->polygons[i];
        for (uint32_t k = 0; k < polygon->corner_count; k++) {
            uint32_t vertex = corner_of(mesh, polygon, NULL, k);
            wanted->vertices[count] = vertex;
            count += vertex - mesh->part.vertex_first >= mesh->vertex_count;
        }
    }
    if (wanted->vertices != NULL) {
        qsort(wanted->vertices, count, sizeof(uint32_t), compare_numbers);
        for (size_t i = 0; i < count; i++) {
            if (i == 0 || wanted->vertices[i] != wanted->vertices[i - 1]) {
                wanted->vertices[wanted->count++] = wanted->vertices[i];
            }
        }
        wanted->x = calloc((size_t)wanted->count + 1, sizeof *wanted->x);
    }
    return wanted->x != NULL ? PCCD_OK
                             : ctl_error_set(error, PCCD_E_NOMEM,
                                             "%s: no memory for %zu corners of polygons",
                                             path, corners);
}

void ctl_wanted_set(struct ctl_wanted *wanted, size_t index, double value)
{
    size_t vertex = index / 3;
    while (wanted->next < wanted->count && wanted->vertices[wanted->next] < vertex) {
        wanted->next++;
    }
    if (wanted->next < wanted->count && wanted->vertices[wanted->next] == vertex) {
        wanted->x[wanted->next][index % 3] = value;
    }
}

void ctl_wanted_deinit(struct ctl_wanted *wanted)
{
    free(wanted->vertices);
    free(wanted->x);
    *wanted = (struct ctl_wanted){0};
}

/* ---- frames ------------------------------------------------------------------------ */

static int other_topology(const struct ctl_polygon *polygon, const char *path,
                          const char *other_path, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_INVAL,
                         "triangles %" PRIu32 " to %" PRIu32 " are one face of %" PRIu32
                         " corners in %s, and others in %s: two topologies, not two "
                         "frames of one mesh",
                         polygon->triangle_first,
                         polygon->triangle_first + polygon->corner_count - 3,
                         (uint32_t)polygon->corner_count, path, other_path);
}

/* The same polygon in both: the corners, and then the cut. */
static int cut_one_like(const struct ctl_mesh *first, const struct ctl_polygon *like,
                        const uint32_t *kept, const char *first_path,
                        struct ctl_mesh *mesh, const struct ctl_polygon *polygon,
                        const char *path, struct ctl_error *error)
{
    uint32_t count = polygon->corner_count;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t a = corner_of(first, like, kept, k);
        uint32_t b = corner_of(mesh, polygon, NULL, k);
        if (a != b) {
            return ctl_error_set(error, PCCD_E_INVAL,
                                 "%s %" PRIu64 " has %" PRIu32 " for corner %" PRIu32
                                 " in %s and %" PRIu32
                                 " in %s: not two frames of one mesh",
                                 first->has_lines ? "the face of line" : "face",
                                 like->place, a, k, first_path, b, path);
        }
    }
    memcpy(mesh->triangles + polygon->triangle_first,
           first->triangles + like->triangle_first,
           (count - 2) * sizeof *mesh->triangles);
    return PCCD_OK;
}

/* Whether the triangles of a polygon of one are the same in the other, or there. */
static bool are_same(const struct ctl_mesh *mesh, const struct ctl_polygon *polygon,
                     const struct ctl_mesh *other)
{
    uint32_t first = polygon->triangle_first, count = polygon->corner_count - 2;
    return (uint64_t)first + count <= other->triangle_count &&
           memcmp(mesh->triangles + first, other->triangles + first,
                  count * sizeof *mesh->triangles) == 0;
}

int ctl_mesh_cut_like(const struct ctl_mesh *first, const char *first_path,
                      struct ctl_mesh *mesh, const char *path, struct ctl_error *error)
{
    static const struct ctl_polygon none; /* where a mesh has no array of them */
    const struct ctl_polygon *a = first->polygons != NULL ? first->polygons : &none;
    const struct ctl_polygon *b = mesh->polygons != NULL ? mesh->polygons : &none;
    const struct ctl_polygon *a_end = a + first->polygon_count;
    const struct ctl_polygon *b_end = b + mesh->polygon_count;
    const uint32_t *kept = first->corners;
    int status = PCCD_OK;
    bool is_alike = first->vertex_count == mesh->vertex_count &&
                    first->triangle_count == mesh->triangle_count;
    while (is_alike && status == PCCD_OK && (a < a_end || b < b_end)) {
        bool is_a = b == b_end || (a < a_end && a->triangle_first <= b->triangle_first);
        bool is_b = a == a_end || (b < b_end && b->triangle_first <= a->triangle_first);
        if (is_a && is_b && a->corner_count == b->corner_count) {
            status = cut_one_like(first, a, kept, first_path, mesh, b, path, error);
        } else if (is_a && !are_same(first, a, mesh)) {
            status = other_topology(a, first_path, path, error);
        } else if (!is_a && !are_same(mesh, b, first)) {
            status = other_topology(b, path, first_path, error);
        }
        kept += is_a && a->is_recut ? a->corner_count : 0;
        a += is_a;
        b += is_b;
    }
    return status == PCCD_OK ? ctl_mesh_match(first, first_path, mesh, path, error)
                             : status;
}
