/* client/ctl/mesh/meshfile.c - a mesh read from a file.
 *
 * Room:     client/ctl.
 * Does:     tells the format, holds the arrays, compares two frames.
 * Does not: parse; see ply.c, obj.c, stl.c and glb.c.
 * Threads:  [any]; nothing is shared.
 * Source:   meshfile.h.
 */
#include "meshfile.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool has_ending(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t ending_length = strlen(ending);
    return length >= ending_length &&
           strcasecmp(path + length - ending_length, ending) == 0;
}

static bool has_ply_magic(const struct ctl_file *file)
{
    return file->bytes >= 4 && memcmp(file->data, "ply", 3) == 0 &&
           (file->data[3] == '\n' || file->data[3] == '\r');
}

static bool has_glb_magic(const struct ctl_file *file)
{
    return file->bytes >= 4 && memcmp(file->data, "glTF", 4) == 0;
}

static int judge_obj(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    (void)begin;
    (void)error;
    *is_text = true;
    return PCCD_OK;
}

/* What a file is, by its first bytes or its name. */
static const struct format {
    const char *ending;
    bool (*has_magic)(const struct ctl_file *file); /* NULL: its name alone tells */
    ctl_file_judge judge;
    int (*parse)(const struct ctl_file *file, struct ctl_mesh *mesh,
                 struct ctl_error *error);
} formats[] = {
    {".ply", has_ply_magic, ctl_ply_judge, ctl_ply_parse},
    {".glb", has_glb_magic, ctl_glb_judge, ctl_glb_parse},
    {".obj", NULL, judge_obj, ctl_obj_parse},
    {".stl", NULL, ctl_stl_judge, ctl_stl_parse},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

bool ctl_mesh_is_named(const char *path)
{
    bool is_named = false;
    for (int i = 0; i < FORMATS; i++) {
        is_named = is_named || has_ending(path, formats[i].ending);
    }
    return is_named;
}

/* NULL, with an error: none that is known. */
static const struct format *format_of(const struct ctl_file *file,
                                      struct ctl_error *error)
{
    for (int i = 0; i < FORMATS; i++) {
        if (formats[i].has_magic != NULL && formats[i].has_magic(file)) {
            return &formats[i];
        }
    }
    for (int i = 0; i < FORMATS; i++) {
        if (has_ending(file->path, formats[i].ending)) {
            return &formats[i];
        }
    }
    ctl_error_set(error, PCCD_E_FORMAT,
                  "%s: neither PLY (first line \"ply\") nor glTF (first word \"glTF\") "
                  "nor a name ending in .ply, .obj, .stl or .glb",
                  file->path);
    return NULL;
}

/* Of a large file: whether it can be what its first bytes say. */
static int judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    const struct format *format = format_of(begin, error);
    return format != NULL ? format->judge(begin, is_text, error) : PCCD_E_FORMAT;
}

int ctl_mesh_read(const char *path, struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct ctl_file file = {.path = path, .data = NULL, .bytes = 0};
    struct ctl_mesh read = {0};
    int status = ctl_file_read(path, judge, &file, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (file.bytes == 0) {
        status = ctl_error_set(error, PCCD_E_FORMAT, "%s: the file is empty", path);
    } else {
        const struct format *format = format_of(&file, error);
        status = format != NULL ? format->parse(&file, &read, error) : PCCD_E_FORMAT;
    }
    if (status == PCCD_OK && read.vertex_count == 0) {
        status = ctl_error_set(error, PCCD_E_FORMAT, "%s: no vertices", path);
    }
    if (status == PCCD_OK &&
        read.triangle_count + read.edge_count + read.point_count == 0) {
        status =
            ctl_error_set(error, PCCD_E_FORMAT, "%s: no faces, edges or points", path);
    }
    ctl_file_deinit(&file);
    if (status == PCCD_OK) {
        *mesh = read;
    } else {
        ctl_mesh_deinit(&read);
    }
    return status;
}

void ctl_mesh_deinit(struct ctl_mesh *mesh)
{
    free(mesh->x);
    free(mesh->triangles);
    free(mesh->edges);
    free(mesh->points);
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
        const uint32_t *p = a->triangles[i];
        const uint32_t *q = b->triangles[i];
        if (p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) {
            return ctl_error_set(
                error, PCCD_E_INVAL,
                "triangle %u is (%u %u %u) in %s and (%u %u %u) in %s: not "
                "two frames of one mesh",
                i, p[0], p[1], p[2], path_a, q[0], q[1], q[2], path_b);
        }
    }
    int status = match_named((const uint32_t *)a->edges, a->edge_count, path_a,
                             (const uint32_t *)b->edges, b->edge_count, path_b, 2, error);
    return status == PCCD_OK ? match_named(a->points, a->point_count, path_a, b->points,
                                           b->point_count, path_b, 1, error)
                             : status;
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
    mesh->x = malloc((size_t)count * bytes);
    if (mesh->x == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %llu vertices", path,
                             (unsigned long long)count);
    }
    mesh->format = format;
    mesh->vertex_count = (uint32_t)count;
    return PCCD_OK;
}

bool ctl_mesh_coordinate_ok(double value)
{
    /* False for NaN as well. */
    return value >= -CTL_MESH_COORDINATE_MAX && value <= CTL_MESH_COORDINATE_MAX;
}

void ctl_mesh_set(struct ctl_mesh *mesh, size_t index, double value)
{
    if (mesh->format == PCCD_FORMAT_F32) {
        ((float *)mesh->x)[index] = (float)value;
    } else {
        ((double *)mesh->x)[index] = value;
    }
}

/* Room for one more item of `bytes` in *items, of which there are `count`. */
static int grow(void *items, size_t bytes, uint32_t count, uint32_t *capacity,
                const char *names, const char *path, struct ctl_error *error)
{
    void *before;
    if (count == CTL_MESH_COUNT_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: more than %llu %s", path,
                             (unsigned long long)CTL_MESH_COUNT_MAX, names);
    }
    if (count < *capacity) {
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
    int status = grow(&mesh->triangles, sizeof *mesh->triangles, mesh->triangle_count,
                      &mesh->triangle_capacity, "triangles", path, error);
    if (status == PCCD_OK) {
        memcpy(mesh->triangles[mesh->triangle_count++], corners, sizeof *mesh->triangles);
    }
    return status;
}

int ctl_mesh_add_edge(struct ctl_mesh *mesh, const uint32_t ends[2], const char *path,
                      struct ctl_error *error)
{
    int status = grow(&mesh->edges, sizeof *mesh->edges, mesh->edge_count,
                      &mesh->edge_capacity, "edges", path, error);
    if (status == PCCD_OK) {
        memcpy(mesh->edges[mesh->edge_count++], ends, sizeof *mesh->edges);
    }
    return status;
}

int ctl_mesh_add_point(struct ctl_mesh *mesh, uint32_t vertex, const char *path,
                       struct ctl_error *error)
{
    int status = grow(&mesh->points, sizeof *mesh->points, mesh->point_count,
                      &mesh->point_capacity, "points", path, error);
    if (status == PCCD_OK) {
        mesh->points[mesh->point_count++] = vertex;
    }
    return status;
}
