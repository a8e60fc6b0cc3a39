/* client/ctl/mesh/meshread.c - tells what a file is, and has a mesh read from it. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "confined.h"
#include "meshfile.h"

#define LONG_BYTES (16u << 20) /* takes a part of a second to read */

static bool is_json(const struct ctl_file *file)
{
    const char *start = ctl_file_start(file);
    return start[strspn(start, " \t\r\n")] == '{';
}

/* Formats, each known by the file's first word or by its name. */
static const struct format {
    const char *word; /* NULL: its name alone tells */
    const char *ending;
    enum ctl_mesh_holds holds;
    bool makes_all; /* parse does, also of a part */
    int (*parse)(struct ctl_file *file, struct ctl_mesh *mesh);
    ctl_motion_reader *open_motion; /* NULL: it has one frame */
    /* Whether a file that neither a word nor its name tells begins so; or NULL. */
    bool (*begins)(const struct ctl_file *file);
} formats[] = {
    {"ply", ".ply", CTL_HOLDS_MESH, false, ctl_ply_parse, NULL, NULL},
    {"glTF", ".glb", CTL_HOLDS_BOTH, true, ctl_gltf_parse, ctl_gltf_open, NULL},
    {NULL, ".gltf", CTL_HOLDS_BOTH, true, ctl_gltf_parse, ctl_gltf_open, is_json},
    {NULL, ".obj", CTL_HOLDS_MESH, false, ctl_obj_parse, NULL, ctl_obj_begins},
    {NULL, ".stl", CTL_HOLDS_CORNERS, true, ctl_stl_parse, NULL, ctl_stl_begins},
    {"POINTCACHE2", ".pc2", CTL_HOLDS_POSITIONS, false, NULL, ctl_pc2_open, NULL},
    {NULL, ".mdd", CTL_HOLDS_POSITIONS, false, NULL, ctl_mdd_open, NULL},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

/* From the dot on; "" of a name without one. */
static const char *ending_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash != NULL ? slash : path, '.');
    return dot != NULL ? dot : "";
}

static const struct format *format_of_name(const char *path)
{
    for (int i = 0; i < FORMATS; i++) {
        if (strcasecmp(ending_of(path), formats[i].ending) == 0) {
            return &formats[i];
        }
    }
    return NULL;
}

bool ctl_mesh_is_named(const char *path)
{
    return format_of_name(path) != NULL;
}

/* By the first word of a file, its name, or how it begins; NULL: none that is known. */
static const struct format *find_format(const struct ctl_file *file)
{
    const char *at = ctl_file_start(file);
    size_t bytes = (size_t)(file->data + file->bytes - at);
    const struct format *named = format_of_name(file->path);
    /* The header of a binary STL file may begin with any word. */
    if (named != NULL && named->begins != NULL && bytes > 0 && named->begins(file)) {
        return named;
    }
    for (int i = 0; i < FORMATS; i++) {
        const char *word = formats[i].word;
        size_t length = word != NULL ? strlen(word) : bytes;
        if (bytes > length && memcmp(at, word, length) == 0 &&
            !isalnum((unsigned char)at[length])) {
            return &formats[i];
        }
    }
    const struct format *found = named;
    for (int i = 0; i < FORMATS && found == NULL && bytes > 0; i++) {
        bool is_it = formats[i].begins != NULL && formats[i].begins(file);
        found = is_it ? &formats[i] : NULL;
    }
    return found;
}

bool ctl_mesh_is_pipe(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISREG(info.st_mode);
}

/* Its first bytes, if it is no pipe, which has them once. */
static const struct format *format_of_path(const char *path)
{
    char begin[512];
    struct ctl_file file = {.path = path, .data = begin};
    struct stat info;
    int fd = ctl_mesh_is_pipe(path) ? -1 : tool_open(path);
    if (fd >= 0) {
        ssize_t got = read(fd, begin, sizeof begin - 1);
        file.bytes = got > 0 ? (size_t)got : 0;
        file.size = fstat(fd, &info) == 0 ? (uint64_t)info.st_size : 0;
        file.rest_bytes = file.size > file.bytes ? file.size - file.bytes : 0;
        (void)close(fd);
    }
    begin[file.bytes] = '\0';
    return find_format(&file);
}

enum ctl_mesh_holds ctl_mesh_holds(const char *path)
{
    const struct format *format = format_of_path(path);
    enum ctl_mesh_holds holds = format != NULL ? format->holds : CTL_HOLDS_MESH;
    /* A pipe is read once, and so has no frames to go back to. */
    return holds == CTL_HOLDS_BOTH && ctl_mesh_is_pipe(path) ? CTL_HOLDS_MESH : holds;
}

int ctl_mesh_open_motion(const char *path, const struct ctl_motion_wish *wish,
                         struct ctl_motion *motion, struct ctl_error *error)
{
    return ctl_motion_open(path, format_of_path(path)->open_motion, wish, motion, error);
}

int ctl_mesh_beside(const char *path, ctl_mesh_file_fn each, void *context,
                    struct ctl_error *error)
{
    const struct format *format = format_of_path(path);
    return format != NULL && format->parse == ctl_gltf_parse
               ? ctl_gltf_beside(path, each, context, error)
               : PCCD_OK;
}

/* Refuse a file that is no mesh; `format` is what it is, or NULL. */
static int refuse(const struct ctl_file *file, const struct format *format,
                  struct ctl_error *error)
{
    const char *ending = ending_of(file->path);
    if (format != NULL) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s has positions alone: name the mesh file with its faces "
                             "before it",
                             file->path);
    }
    return ctl_error_set(
        error, PCCD_E_FORMAT,
        "%s: neither PLY (first line \"ply\") nor glTF (first word \"glTF\") nor what "
        "begins as OBJ or STL, nor a name ending in .ply, .obj, .stl, .glb or .gltf%s%s; "
        "%s",
        file->path, ending[0] != '\0' ? ", but in " : "", ending,
        strcasecmp(ending, ".fbx") == 0
            ? "of FBX Blender makes glTF, animations included"
            : "python3 -m pccd check reads what meshio does, such as VTU and PVD");
}

/* ---- reading ----------------------------------------------------------------------- */

static int parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    if (file->bytes == 0) {
        return ctl_error_set(mesh->error, PCCD_E_FORMAT, "%s: the file is empty",
                             file->path);
    }
    const struct format *format = find_format(file);
    const struct ctl_part part = mesh->part;
    if (format == NULL || format->parse == NULL) {
        return refuse(file, format, mesh->error);
    }
    /* A pipe is read to its end, once it is known what it brings. */
    if (file->size == 0 && ctl_file_load(file, mesh->error) != PCCD_OK) {
        return file->status;
    }
    if (format->makes_all) {
        mesh->part = (struct ctl_part){.count = 0};
    }
    int status = format->parse(file, mesh);
    if (status == PCCD_OK && format->makes_all && part.count > 0) {
        ctl_mesh_keep_part(mesh, part.number, part.count);
    }
    return status;
}

/* Cut the polygons of a part: vertices that others keep are read once more. */
static int cut_part(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct ctl_others others = {0};
    struct ctl_mesh again = {.path = mesh->path, .error = mesh->error, .others = &others};
    int status = ctl_mesh_find_others(mesh, &others);
    if (status == PCCD_OK && others.count > 0) {
        status = parse(file, &again);
    }
    if (status == PCCD_OK) {
        mesh->others = &others;
        status = ctl_mesh_cut(mesh, mesh->error);
        mesh->others = NULL;
    }
    free(others.vertices);
    free(others.x);
    ctl_mesh_deinit(&again);
    return status;
}

/* Give away what was made, or free it. */
static int finish(struct ctl_mesh *made, int status, struct ctl_mesh *mesh)
{
    bool has_any = (made->points.total | made->edges.total | made->triangles.total) > 0;
    bool has_vertices = (made->vertex_count | made->part.vertex_total) > 0;
    if (status == PCCD_OK && !(has_any && has_vertices)) {
        status = ctl_error_set(made->error, PCCD_E_FORMAT, "%s: no %s", made->path,
                               has_vertices ? "faces, edges or points" : "vertices");
    }
    made->error = NULL;
    if (status == PCCD_OK) {
        *mesh = *made;
    } else {
        ctl_mesh_deinit(made);
    }
    return status;
}

int ctl_mesh_read_as(const char *path, const struct ctl_reading *reading,
                     struct ctl_mesh *mesh, struct ctl_error *error)
{
    const struct ctl_mesh *like = reading->like;
    struct ctl_mesh made = {.path = path,
                            .error = error,
                            .is_corners = reading->is_corners,
                            .part = {.number = reading->number, .count = reading->count}};
    struct ctl_file file;
    int status = ctl_file_open(path, &file, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (like != NULL) {
        made.part.number = like->part.number;
        made.part.count = like->part.count;
    }
    if (file.size >= LONG_BYTES && !progress_is_drawn()) { /* of many frames */
        progress_begin(&file.progress, "reading (MiB)", file.size >> 20);
    }
    status = parse(&file, &made);
    progress_clear(&file.progress);
    if (status == PCCD_OK && like != NULL) {
        status = ctl_mesh_cut_like(like, &made, error);
    } else if (status == PCCD_OK && !reading->is_uncut) {
        status =
            made.part.count > 0 ? cut_part(&file, &made) : ctl_mesh_cut(&made, error);
    }
    ctl_file_deinit(&file);
    return finish(&made, status, mesh);
}

int ctl_mesh_read(const char *path, struct ctl_mesh *mesh, struct ctl_error *error)
{
    return ctl_mesh_read_as(path, &(const struct ctl_reading){.count = 0}, mesh, error);
}

int ctl_motion_open(const char *path, ctl_motion_reader *reader,
                    const struct ctl_motion_wish *wish, struct ctl_motion *motion,
                    struct ctl_error *error)
{
    *motion = (struct ctl_motion){.state = NULL};
    int status = ctl_file_open(path, &motion->file, error);
    if (status == PCCD_OK && motion->file.size == 0) {
        status = ctl_file_load(&motion->file, error); /* a pipe */
    }
    if (status == PCCD_OK) {
        status = reader(motion, wish);
    }
    if (status != PCCD_OK) {
        ctl_motion_close(motion);
    }
    return status;
}

void ctl_motion_close(struct ctl_motion *motion)
{
    if (motion->close != NULL) {
        motion->close(motion);
    }
    free(motion->state);
    ctl_file_deinit(&motion->file);
    *motion = (struct ctl_motion){.state = NULL};
}

int ctl_mesh_read_shape(const struct ctl_motion *motion, const char *path,
                        struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct ctl_mesh made = {.path = path, .error = error};
    int status = motion->shape(motion, &made);
    return finish(&made, status, mesh);
}
