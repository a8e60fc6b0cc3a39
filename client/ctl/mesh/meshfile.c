/* client/ctl/mesh/meshfile.c - the arrays of a mesh.
 *
 * Room:     client/ctl.
 * Does:     holds the arrays or a part of them.
 * Does not: read files (meshread.c); compare frames (meshmatch.c).
 * Threads:  [any]; nothing is shared.
 * Source:   meshfile.h.
 */
#include "meshfile.h"

#include <stdlib.h>
#include <string.h>

#include "coordinates.h"

/* ---- parts ------------------------------------------------------------------------- */

/* Of `count` things, the first of piece `number`. */
static uint64_t piece_first(const struct ctl_part *part, uint64_t count, uint32_t number)
{
    uint64_t each = count / part->count, more = count % part->count;
    return each * number + more * number / part->count;
}

void ctl_mesh_begin_row(struct ctl_mesh *mesh, uint64_t row, uint64_t count)
{
    struct ctl_part *part = &mesh->part;
    if (part->count == 0 || part->wanted != NULL) {
        part->leaves_out = part->wanted != NULL;
        return;
    }
    /* What an OBJ file has beyond what was counted is the last one's. */
    bool is_last = part->number + 1 == part->count;
    part->leaves_out = row < piece_first(part, count, part->number) ||
                       (!is_last && row >= piece_first(part, count, part->number + 1));
}

/* Of array[*count] the piece; *total is its number of items. The memory is given back by
 * a smaller copy, as an array that shrinks in its place may leave a hole behind it. */
static void *keep(const struct ctl_part *part, void *array, uint32_t *count,
                  uint32_t *total, size_t item_bytes)
{
    uint64_t first = piece_first(part, *count, part->number);
    uint64_t kept = piece_first(part, *count, part->number + 1) - first;
    *total = *count;
    *count = (uint32_t)kept;
    if (array == NULL) {
        return NULL;
    }
    const char *from = (const char *)array + first * item_bytes;
    void *copy = malloc(kept * item_bytes + 1);
    if (copy == NULL) {
        memmove(array, from, kept * item_bytes);
        return array;
    }
    memcpy(copy, from, kept * item_bytes);
    free(array);
    return copy;
}

void ctl_mesh_keep_part(struct ctl_mesh *mesh, uint32_t number, uint32_t count)
{
    struct ctl_part *part = &mesh->part;
    *part = (struct ctl_part){.number = number, .count = count};
    part->vertex_first = (uint32_t)piece_first(part, mesh->vertex_count, number);
    mesh->x = keep(part, mesh->x, &mesh->vertex_count, &part->vertex_total,
                   common_vertex_bytes(mesh->format));
    mesh->triangles = keep(part, mesh->triangles, &mesh->triangle_count,
                           &part->triangle_total, sizeof *mesh->triangles);
    mesh->edges = keep(part, mesh->edges, &mesh->edge_count, &part->edge_total,
                       sizeof *mesh->edges);
    mesh->points = keep(part, mesh->points, &mesh->point_count, &part->point_total,
                        sizeof *mesh->points);
    mesh->triangle_capacity = mesh->triangle_count;
    mesh->edge_capacity = mesh->edge_count;
    mesh->point_capacity = mesh->point_count;
}
/* ---- arrays ------------------------------------------------------------------------ */

void ctl_mesh_drop_shape(struct ctl_mesh *mesh)
{
    free(mesh->triangles);
    free(mesh->edges);
    free(mesh->points);
    free(mesh->polygons);
    free(mesh->corners);
    mesh->polygons = NULL;
    mesh->corners = NULL;
    mesh->polygon_count = mesh->polygon_capacity = 0;
    mesh->corner_count = mesh->corner_capacity = 0;
    mesh->triangles = NULL;
    mesh->edges = NULL;
    mesh->points = NULL;
    mesh->triangle_count = mesh->triangle_capacity = 0;
    mesh->edge_count = mesh->edge_capacity = 0;
    mesh->point_count = mesh->point_capacity = 0;
    for (uint32_t i = 0; i < mesh->object_count; i++) {
        free(mesh->objects[i].name);
    }
    free(mesh->objects);
    mesh->objects = NULL;
    mesh->object_count = mesh->object_capacity = 0;
}

void ctl_mesh_deinit(struct ctl_mesh *mesh)
{
    free(mesh->x);
    ctl_mesh_drop_shape(mesh);
    *mesh = (struct ctl_mesh){0};
}

int ctl_mesh_promote(struct ctl_mesh *mesh, struct ctl_error *error)
{
    if (mesh->format == PCCD_FORMAT_F64) {
        return PCCD_OK;
    }
    size_t count = (size_t)mesh->vertex_count * 3;
    const float *narrow = mesh->x;
    double *wide = malloc(count * sizeof *wide);
    if (wide == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for %u vertices",
                             mesh->vertex_count);
    }
    for (size_t i = 0; i < count; i++) {
        wide[i] = (double)narrow[i];
    }
    free(mesh->x);
    mesh->x = wide;
    mesh->format = PCCD_FORMAT_F64;
    return PCCD_OK;
}

int ctl_mesh_alloc_vertices(struct ctl_mesh *mesh, enum pccd_format format,
                            uint64_t count, const char *path, struct ctl_error *error)
{
    size_t bytes = format == PCCD_FORMAT_F32 ? sizeof(float[3]) : sizeof(double[3]);
    if (count == 0) {
        return ctl_error_set(error, PCCD_E_FORMAT, "%s: no vertices", path);
    }
    if (count > CTL_MESH_COUNT_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: %llu vertices, at most %llu", path,
                             (unsigned long long)count,
                             (unsigned long long)CTL_MESH_COUNT_MAX);
    }
    struct ctl_part *part = &mesh->part;
    uint64_t first = 0, kept = count;
    if (part->count > 0) {
        first = piece_first(part, count, part->number);
        kept = piece_first(part, count, part->number + 1) - first;
    }
    if (part->wanted != NULL) {
        first = kept = 0;
    }
    mesh->x = malloc((size_t)kept * bytes + 1);
    if (mesh->x == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %llu vertices", path,
                             (unsigned long long)kept);
    }
    mesh->format = format;
    mesh->vertex_count = (uint32_t)kept;
    part->vertex_first = (uint32_t)first;
    part->vertex_total = (uint32_t)count;
    return PCCD_OK;
}

bool ctl_mesh_coordinate_ok(double value)
{
    /* False for NaN as well. */
    return value >= -CTL_MESH_COORDINATE_MAX && value <= CTL_MESH_COORDINATE_MAX;
}

void ctl_mesh_set(struct ctl_mesh *mesh, size_t index, double value)
{
    index -= (size_t)mesh->part.vertex_first * 3; /* beyond all if it is before them */
    if (index >= (size_t)mesh->vertex_count * 3) {
        if (mesh->part.wanted != NULL) {
            ctl_wanted_set(mesh->part.wanted, index, value);
        }
        return;
    }
    if (mesh->format == PCCD_FORMAT_F32) {
        ((float *)mesh->x)[index] = (float)value;
    } else {
        ((double *)mesh->x)[index] = value;
    }
}

int ctl_mesh_grow(void *items, size_t bytes, uint32_t count, uint32_t *capacity,
                  uint32_t *total, bool is_kept, const char *names, const char *path,
                  struct ctl_error *error)
{
    void *before;
    if (*total == CTL_MESH_COUNT_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: more than %llu %s", path,
                             (unsigned long long)CTL_MESH_COUNT_MAX, names);
    }
    ++*total;
    if (!is_kept || count < *capacity) {
        return PCCD_OK;
    }
    uint64_t wanted = (uint64_t)*capacity * 2 + 1024;
    wanted = wanted > CTL_MESH_COUNT_MAX ? CTL_MESH_COUNT_MAX : wanted;
    memcpy(&before, items, sizeof before);
    void *grown = realloc(before, (size_t)wanted * bytes);
    if (grown == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %llu %s", path,
                             (unsigned long long)wanted, names);
    }
    memcpy(items, &grown, sizeof grown);
    *capacity = (uint32_t)wanted;
    return PCCD_OK;
}

int ctl_mesh_add_triangle(struct ctl_mesh *mesh, const uint32_t corners[3],
                          const char *path, struct ctl_error *error)
{
    int status =
        ctl_mesh_grow(&mesh->triangles, sizeof *mesh->triangles, mesh->triangle_count,
                      &mesh->triangle_capacity, &mesh->part.triangle_total,
                      !mesh->part.leaves_out, "triangles", path, error);
    if (status == PCCD_OK && !mesh->part.leaves_out) {
        memcpy(mesh->triangles[mesh->triangle_count++], corners, sizeof *mesh->triangles);
    }
    return status;
}

int ctl_mesh_add_edge(struct ctl_mesh *mesh, const uint32_t ends[2], const char *path,
                      struct ctl_error *error)
{
    int status = ctl_mesh_grow(&mesh->edges, sizeof *mesh->edges, mesh->edge_count,
                               &mesh->edge_capacity, &mesh->part.edge_total,
                               !mesh->part.leaves_out, "edges", path, error);
    if (status == PCCD_OK && !mesh->part.leaves_out) {
        memcpy(mesh->edges[mesh->edge_count++], ends, sizeof *mesh->edges);
    }
    return status;
}

int ctl_mesh_add_point(struct ctl_mesh *mesh, uint32_t vertex, const char *path,
                       struct ctl_error *error)
{
    int status = ctl_mesh_grow(&mesh->points, sizeof *mesh->points, mesh->point_count,
                               &mesh->point_capacity, &mesh->part.point_total,
                               !mesh->part.leaves_out, "points", path, error);
    if (status == PCCD_OK && !mesh->part.leaves_out) {
        mesh->points[mesh->point_count++] = vertex;
    }
    return status;
}

int ctl_mesh_add_object(struct ctl_mesh *mesh, const char *name, size_t name_bytes,
                        const char *path, struct ctl_error *error)
{
    const struct ctl_part *part = &mesh->part;
    struct ctl_mesh_object object = {
        .name = strndup(name, name_bytes),
        .triangle_first = part->triangle_total,
        .edge_first = part->edge_total,
        .point_first = part->point_total,
    };
    struct ctl_mesh_object *last =
        mesh->object_count > 0 ? &mesh->objects[mesh->object_count - 1] : NULL;
    if (object.name == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for a name of %zu bytes",
                             path, name_bytes);
    }
    if (last != NULL && last->triangle_first == object.triangle_first &&
        last->edge_first == object.edge_first &&
        last->point_first == object.point_first) {
        free(last->name);
        *last = object;
        return PCCD_OK;
    }
    uint32_t total = mesh->object_count;
    int status =
        ctl_mesh_grow(&mesh->objects, sizeof *mesh->objects, mesh->object_count,
                      &mesh->object_capacity, &total, true, "objects", path, error);
    if (status != PCCD_OK) {
        free(object.name);
        return status;
    }
    mesh->objects[mesh->object_count++] = object;
    return PCCD_OK;
}

uint32_t ctl_mesh_object_at(const struct ctl_mesh *mesh, uint32_t points, uint32_t number)
{
    uint32_t low = 0, high = mesh->object_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        const struct ctl_mesh_object *object = &mesh->objects[middle];
        uint32_t first = points == 3   ? object->triangle_first
                         : points == 2 ? object->edge_first
                                       : object->point_first;
        if (first <= number) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low > 0 ? low - 1 : CTL_NO_OBJECT;
}

uint32_t *ctl_mesh_object_of_vertices(const struct ctl_mesh *mesh)
{
    const uint32_t *named[4] = {NULL, mesh->points, (const uint32_t *)mesh->edges,
                                (const uint32_t *)mesh->triangles};
    const uint32_t counts[4] = {0, mesh->point_count, mesh->edge_count,
                                mesh->triangle_count};
    const size_t bytes = ((size_t)mesh->vertex_count + 1) * sizeof(uint32_t);
    uint32_t *objects = malloc(bytes);
    if (objects == NULL) {
        return NULL;
    }
    memset(objects, 0xff, bytes);
    for (uint32_t points = 3; points > 0; points--) {
        for (uint32_t i = 0; i < counts[points]; i++) {
            uint32_t object = ctl_mesh_object_at(mesh, points, i);
            for (uint32_t k = 0; k < points; k++) {
                uint32_t vertex = named[points][(size_t)i * points + k];
                objects[vertex] =
                    objects[vertex] == CTL_NO_OBJECT ? object : objects[vertex];
            }
        }
    }
    return objects;
}
