/* client/ctl/mesh/meshfile.c - the arrays of a mesh, or of a part of it. */
#include "meshfile.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"

static const char *const names[CTL_KINDS] = {"points", "edges", "triangles"};

static int no_memory(const struct ctl_mesh *mesh, uint64_t count, const char *what)
{
    return ctl_error_set(mesh->error, PCCD_E_NOMEM, "%s: no memory for %" PRIu64 " %s",
                         mesh->path, count, what);
}

/* ---- parts ------------------------------------------------------------------------- */

/* Return the first of `count` things that is in piece `number`. */
static uint64_t piece_first(const struct ctl_part *part, uint64_t count, uint32_t number)
{
    uint64_t each = count / part->count, more = count % part->count;
    return each * number + more * number / part->count;
}

void ctl_mesh_begin_row(struct ctl_mesh *mesh, uint64_t row, uint64_t count)
{
    const struct ctl_part *part = &mesh->part;
    mesh->leaves_out = mesh->others != NULL;
    if (part->count > 0 && !mesh->leaves_out) {
        /* What an OBJ file has beyond what was counted is the last one's. */
        bool is_last = part->number + 1 == part->count;
        mesh->leaves_out =
            row < piece_first(part, count, part->number) ||
            (!is_last && row >= piece_first(part, count, part->number + 1));
    }
}

/* Keep the piece of array[*count], and give back the memory of the rest. */
static void *keep(const struct ctl_part *part, void *array, uint32_t *count,
                  size_t item_bytes)
{
    uint64_t first = piece_first(part, *count, part->number);
    uint64_t kept = piece_first(part, *count, part->number + 1) - first;
    if (array != NULL) {
        memmove(array, (const char *)array + first * item_bytes, kept * item_bytes);
    }
    *count = (uint32_t)kept;
    void *less = realloc(array, kept * item_bytes + 1);
    return less != NULL ? less : array;
}

void ctl_mesh_keep_part(struct ctl_mesh *mesh, uint32_t number, uint32_t count)
{
    struct ctl_part *part = &mesh->part;
    *part = (struct ctl_part){
        .number = number, .count = count, .vertex_total = mesh->vertex_count};
    part->vertex_first = (uint32_t)piece_first(part, mesh->vertex_count, number);
    mesh->x = keep(part, mesh->x, &mesh->vertex_count, common_vertex_bytes(mesh->format));
    for (size_t kind = 0; kind < CTL_KINDS; kind++) {
        struct ctl_list *list = &mesh->lists[kind];
        list->vertices =
            keep(part, list->vertices, &list->count, (kind + 1) * sizeof *list->vertices);
        list->capacity = list->count;
    }
}

/* ---- arrays ------------------------------------------------------------------------ */

void ctl_mesh_drop_shape(struct ctl_mesh *mesh)
{
    struct ctl_mesh vertices = {.path = mesh->path,
                                .format = mesh->format,
                                .vertex_count = mesh->vertex_count,
                                .x = mesh->x,
                                .part = mesh->part};
    mesh->x = NULL;
    ctl_mesh_deinit(mesh);
    *mesh = vertices;
}

void ctl_mesh_deinit(struct ctl_mesh *mesh)
{
    free(mesh->x);
    for (int kind = 0; kind < CTL_KINDS; kind++) {
        free(mesh->lists[kind].vertices);
    }
    for (uint32_t i = 0; i < mesh->object_count; i++) {
        free(mesh->objects[i].name);
    }
    free(mesh->objects);
    free(mesh->polygons);
    free(mesh->corners);
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
                            uint64_t count)
{
    struct ctl_part *part = &mesh->part;
    uint64_t first = 0, kept = mesh->others != NULL ? 0 : count;
    if (count == 0) {
        return ctl_error_set(mesh->error, PCCD_E_FORMAT, "%s: no vertices", mesh->path);
    }
    if (count > CTL_MESH_COUNT_MAX) {
        return ctl_error_set(mesh->error, PCCD_E_LIMIT,
                             "%s: %" PRIu64 " vertices, at most %" PRIu64, mesh->path,
                             count, CTL_MESH_COUNT_MAX);
    }
    if (part->count > 0 && mesh->others == NULL) {
        first = piece_first(part, count, part->number);
        kept = piece_first(part, count, part->number + 1) - first;
    }
    mesh->x = malloc(kept * common_vertex_bytes(format) + 1);
    if (mesh->x == NULL) {
        return no_memory(mesh, kept, "vertices");
    }
    mesh->format = format;
    mesh->vertex_count = (uint32_t)kept;
    part->vertex_first = (uint32_t)first;
    part->vertex_total = (uint32_t)count;
    return PCCD_OK;
}

void ctl_mesh_set(struct ctl_mesh *mesh, size_t index, double value)
{
    struct ctl_others *others = mesh->others;
    index -= (size_t)mesh->part.vertex_first * 3; /* beyond all if it is before them */
    if (index < (size_t)mesh->vertex_count * 3) {
        if (mesh->format == PCCD_FORMAT_F32) {
            ((float *)mesh->x)[index] = (float)value;
        } else {
            ((double *)mesh->x)[index] = value;
        }
    } else if (others != NULL) { /* they come in order */
        while (others->next < others->count &&
               others->vertices[others->next] < index / 3) {
            others->next++;
        }
        if (others->next < others->count && others->vertices[others->next] == index / 3) {
            others->x[others->next][index % 3] = value;
        }
    }
}

/* Room for one more item of `bytes` behind `count` of them in *items, a pointer. */
static int grow(struct ctl_mesh *mesh, void *items, size_t bytes, size_t count,
                size_t *capacity, const char *what)
{
    void *array;
    memcpy(&array, items, sizeof array);
    bool has_room = array_reserve(&array, count, capacity, bytes);
    memcpy(items, &array, sizeof array);
    return has_room ? PCCD_OK : no_memory(mesh, count, what);
}

int ctl_mesh_add(struct ctl_mesh *mesh, enum ctl_kind kind, const uint32_t *vertices)
{
    struct ctl_list *list = &mesh->lists[kind];
    const size_t each = (size_t)kind + 1;
    if (list->total == CTL_MESH_COUNT_MAX) {
        return ctl_error_set(mesh->error, PCCD_E_LIMIT, "%s: more than %" PRIu64 " %s",
                             mesh->path, CTL_MESH_COUNT_MAX, names[kind]);
    }
    list->total++;
    if (mesh->leaves_out) {
        return PCCD_OK;
    }
    int status = grow(mesh, &list->vertices, each * sizeof *vertices, list->count,
                      &list->capacity, names[kind]);
    if (status == PCCD_OK) {
        memcpy(list->vertices + each * list->count++, vertices, each * sizeof *vertices);
    }
    return status;
}

int ctl_mesh_add_corner(struct ctl_mesh *mesh, uint32_t vertex)
{
    int status = grow(mesh, &mesh->corners, sizeof *mesh->corners, mesh->corner_count,
                      &mesh->corner_capacity, "corners of polygons");
    if (status == PCCD_OK) {
        mesh->corners[mesh->corner_count++] = vertex;
    }
    return status;
}

int ctl_mesh_end_face(struct ctl_mesh *mesh, uint64_t place)
{
    const uint32_t *corners = mesh->corners + mesh->face_corner;
    size_t count = mesh->corner_count - mesh->face_corner;
    const struct ctl_polygon polygon = {.triangle_first = mesh->triangles.count,
                                        .corner_count = (uint32_t)count,
                                        .place = place};
    int status = PCCD_OK;
    for (size_t i = 2; i < count && status == PCCD_OK; i++) {
        const uint32_t triangle[3] = {corners[0], corners[i - 1], corners[i]};
        status = ctl_mesh_add(mesh, CTL_TRIANGLES, triangle);
    }
    if (count == 3 || mesh->leaves_out) {
        mesh->corner_count = mesh->face_corner;
    } else if (status == PCCD_OK) {
        status = grow(mesh, &mesh->polygons, sizeof polygon, mesh->polygon_count,
                      &mesh->polygon_capacity, "polygons");
        if (status == PCCD_OK) {
            mesh->polygons[mesh->polygon_count++] = polygon;
        }
    }
    mesh->face_corner = mesh->corner_count;
    return status;
}

/* ---- objects ----------------------------------------------------------------------- */

int ctl_mesh_add_object(struct ctl_mesh *mesh, const char *name, size_t name_bytes)
{
    struct ctl_mesh_object object = {.name = strndup(name, name_bytes)};
    uint32_t count = mesh->object_count;
    if (object.name == NULL) {
        return no_memory(mesh, name_bytes, "characters of a name");
    }
    for (int kind = 0; kind < CTL_KINDS; kind++) {
        object.first[kind] = mesh->lists[kind].total;
    }
    if (count > 0 &&
        memcmp(mesh->objects[count - 1].first, object.first, sizeof object.first) == 0) {
        free(mesh->objects[--mesh->object_count].name);
    }
    object.whole = mesh->object_count;
    int status = grow(mesh, &mesh->objects, sizeof object, mesh->object_count,
                      &mesh->object_capacity, "objects");
    if (status == PCCD_OK) {
        mesh->objects[mesh->object_count++] = object;
    } else {
        free(object.name);
    }
    return status;
}

uint32_t ctl_mesh_object_at(const struct ctl_mesh *mesh, enum ctl_kind kind,
                            uint32_t number)
{
    uint32_t low = 0, high = mesh->object_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (mesh->objects[middle].first[kind] <= number) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low > 0 ? mesh->objects[low - 1].whole : CTL_NO_OBJECT;
}

uint32_t *ctl_mesh_object_of_vertices(const struct ctl_mesh *mesh)
{
    const size_t bytes = ((size_t)mesh->vertex_count + 1) * sizeof(uint32_t);
    uint32_t *objects = malloc(bytes);
    if (objects == NULL) {
        return NULL;
    }
    memset(objects, 0xff, bytes);
    for (uint32_t each = CTL_KINDS; each > 0; each--) {
        const struct ctl_list *list = &mesh->lists[each - 1];
        for (size_t i = 0; i < (size_t)list->count * each; i++) {
            uint32_t *object = &objects[list->vertices[i]];
            if (*object == CTL_NO_OBJECT) {
                *object = ctl_mesh_object_at(mesh, each - 1, (uint32_t)(i / each));
            }
        }
    }
    return objects;
}
