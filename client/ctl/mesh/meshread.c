/* client/ctl/mesh/meshread.c - a mesh read from a file.
 *
 * Room:     client/ctl.
 * Does:     tells the format, has it parsed, and polygons cut.
 * Does not: parse (ply.c, obj.c, stl.c, gltf_motion.c); compare frames (meshcut.c).
 */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "meshfile.h"

static bool has_ending(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t ending_length = strlen(ending);
    return length >= ending_length &&
           strcasecmp(path + length - ending_length, ending) == 0;
}

static bool has_ply_magic(const struct ctl_file *file)
{
    const char *at = ctl_file_start(file);
    return file->data + file->bytes - at >= 4 && memcmp(at, "ply", 3) == 0 &&
           (at[3] == '\n' || at[3] == '\r' || at[3] == ' ' || at[3] == '\t');
}

static bool has_glb_magic(const struct ctl_file *file)
{
    return file->bytes >= 4 && memcmp(file->data, "glTF", 4) == 0;
}

static bool has_pc2_magic(const struct ctl_file *file)
{
    return file->bytes >= 12 && memcmp(file->data, "POINTCACHE2", 12) == 0;
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
    int (*parse)(struct ctl_file *file, struct ctl_mesh *mesh);
    bool makes_all; /* parse does, also of a part */
    /* Of a kind that may have several frames; NULL: it has one. Without a parse, it has
     * positions alone. */
    int (*open_motion)(const char *path, const struct ctl_motion_wish *wish,
                       struct ctl_motion *motion, struct ctl_error *error);
} formats[] = {
    {".ply", has_ply_magic, ctl_ply_judge, ctl_ply_parse, false, NULL},
    {".glb", has_glb_magic, ctl_gltf_judge, ctl_gltf_parse, true, ctl_gltf_open},
    {".gltf", NULL, ctl_gltf_judge, ctl_gltf_parse, true, ctl_gltf_open},
    {".obj", NULL, judge_obj, ctl_obj_parse, false, NULL},
    {".stl", NULL, ctl_stl_judge, ctl_stl_parse, true, NULL},
    {".pc2", has_pc2_magic, NULL, NULL, false, ctl_pc2_open},
    {".mdd", NULL, NULL, NULL, false, ctl_mdd_open},
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

/* By the first bytes of a file, whose path ends as it does; NULL: none that is known. */
static const struct format *find_format(const struct ctl_file *file)
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
    return NULL;
}

/* Its first bytes, if it is no pipe, which has them once. */
static const struct format *format_of_path(const char *path)
{
    char begin[16];
    struct ctl_file file = {.path = path, .data = begin};
    struct stat info;
    int fd = stat(path, &info) == 0 && S_ISREG(info.st_mode)
                 ? open(path, O_RDONLY | O_CLOEXEC)
                 : -1;
    if (fd >= 0) {
        ssize_t got = read(fd, begin, sizeof begin);
        file.bytes = got > 0 ? (size_t)got : 0;
        (void)close(fd);
    }
    return find_format(&file);
}

enum ctl_mesh_holds ctl_mesh_holds(const char *path)
{
    const struct format *format = format_of_path(path);
    struct stat info;
    /* A pipe is read once, and so has no frames to go back to. */
    bool is_pipe = stat(path, &info) == 0 && !S_ISREG(info.st_mode);
    return format != NULL && format->parse == ctl_stl_parse ? CTL_HOLDS_CORNERS
           : format == NULL || format->open_motion == NULL  ? CTL_HOLDS_MESH
           : format->parse == NULL                          ? CTL_HOLDS_POSITIONS
           : is_pipe                                        ? CTL_HOLDS_MESH
                                                            : CTL_HOLDS_BOTH;
}

int ctl_mesh_open_motion(const char *path, const struct ctl_motion_wish *wish,
                         struct ctl_motion *motion, struct ctl_error *error)
{
    return format_of_path(path)->open_motion(path, wish, motion, error);
}

/* From the dot on; "" of a name without one. */
static const char *ending_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *dot = strrchr(slash != NULL ? slash : path, '.');
    return dot != NULL ? dot : "";
}

/* NULL, with an error: none that is known. */
static const struct format *format_of(const struct ctl_file *file,
                                      struct ctl_error *error)
{
    const struct format *format = find_format(file);
    if (format == NULL) {
        const char *ending = ending_of(file->path);
        (void)ctl_error_set(
            error, PCCD_E_FORMAT,
            "%s: neither PLY (first line \"ply\") nor glTF (first word "
            "\"glTF\") nor a name ending in .ply, .obj, .stl, .glb or .gltf%s%s; %s",
            file->path, ending[0] != '\0' ? ", but in " : "", ending,
            has_ending(file->path, ".fbx")
                ? "of FBX Blender makes glTF, animations included"
                : "python3 -m pccd check reads what meshio does, such as VTU and PVD");
    } else if (format->parse == NULL) {
        (void)ctl_error_set(error, PCCD_E_FORMAT,
                            "%s has positions alone: name the mesh file with its faces "
                            "before it",
                            file->path);
        format = NULL;
    }
    return format;
}

/* Of a large file: whether it can be what its first bytes say. Of a pipe nobody knows how
 * long it is: only whether that is anything. */
static int judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    const struct format *format = format_of(begin, error);
    if (format == NULL) {
        return PCCD_E_FORMAT;
    }
    return begin->size > 0 ? format->judge(begin, is_text, error) : PCCD_OK;
}

/* ---- reading ----------------------------------------------------------------------- */

static int parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    if (file->bytes == 0) {
        return ctl_error_set(mesh->error, PCCD_E_FORMAT, "%s: the file is empty",
                             file->path);
    }
    const struct format *format = format_of(file, mesh->error);
    const struct ctl_part part = mesh->part;
    if (format == NULL) {
        return PCCD_E_FORMAT;
    }
    if (format->makes_all) {
        mesh->part = (struct ctl_part){.count = 0};
    }
    int status = format->parse(file, mesh);
    int reading = ctl_file_status(file, mesh->error);
    status = reading != PCCD_OK ? reading : status;
    if (status == PCCD_OK && format->makes_all && part.count > 0) {
        ctl_mesh_keep_part(mesh, part.number, part.count);
    }
    return status;
}

/* Of a mesh that was read without an error. */
static int judge_counts(const struct ctl_mesh *mesh)
{
    bool has_any = (mesh->points.total | mesh->edges.total | mesh->triangles.total) > 0;
    bool has_vertices = (mesh->vertex_count | mesh->part.vertex_total) > 0;
    return has_any && has_vertices
               ? PCCD_OK
               : ctl_error_set(mesh->error, PCCD_E_FORMAT, "%s: no %s", mesh->path,
                               has_vertices ? "faces, edges or points" : "vertices");
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

int ctl_mesh_read_as(const char *path, const struct ctl_reading *reading,
                     struct ctl_mesh *mesh, struct ctl_error *error)
{
    const struct ctl_mesh *like = reading->like;
    struct ctl_mesh made = {.path = path,
                            .error = error,
                            .is_corners = reading->is_corners,
                            .part = {.number = reading->number, .count = reading->count}};
    struct ctl_file file;
    int status = ctl_file_open(path, judge, &file, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (like != NULL) {
        made.part.number = like->part.number;
        made.part.count = like->part.count;
    }
    status = parse(&file, &made);
    if (status == PCCD_OK) {
        status = judge_counts(&made);
    }
    if (status == PCCD_OK && like != NULL) {
        status = ctl_mesh_cut_like(like, &made, error);
    } else if (status == PCCD_OK && !reading->is_uncut) {
        status =
            made.part.count > 0 ? cut_part(&file, &made) : ctl_mesh_cut(&made, error);
    }
    ctl_file_deinit(&file);
    made.error = NULL;
    if (status == PCCD_OK) {
        *mesh = made;
    } else {
        ctl_mesh_deinit(&made);
    }
    return status;
}

int ctl_mesh_read(const char *path, struct ctl_mesh *mesh, struct ctl_error *error)
{
    return ctl_mesh_read_as(path, &(const struct ctl_reading){.count = 0}, mesh, error);
}

int ctl_mesh_read_shape(const struct ctl_motion *motion, const char *path,
                        struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct ctl_mesh made = {.path = path, .error = error};
    int status = motion->shape(motion, &made);
    if (status == PCCD_OK) {
        status = judge_counts(&made);
    }
    made.error = NULL;
    if (status == PCCD_OK) {
        *mesh = made;
    } else {
        ctl_mesh_deinit(&made);
    }
    return status;
}
