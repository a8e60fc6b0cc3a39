/* client/ctl/mesh/meshread.c - a mesh read from a file.
 *
 * Room:     client/ctl.
 * Does:     tells the format, has it parsed, and polygons cut.
 * Does not: parse (ply.c, obj.c, stl.c, gltf_motion.c); compare frames (meshmatch.c).
 * Threads:  [any]; nothing is shared.
 * Source:   meshfile.h.
 */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "meshcut.h"
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
    bool is_read_whole; /* parse wants all of the file in memory, and makes all */
    int (*parse)(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error);
    /* Of a kind that may have several frames; NULL: it has one. Without a parse, it has
     * positions alone, and leaves `mesh` as it is. */
    int (*open_motion)(const char *path, const struct ctl_motion_wish *wish,
                       struct ctl_mesh *mesh, struct ctl_motion *motion,
                       struct ctl_error *error);
} formats[] = {
    {".ply", has_ply_magic, ctl_ply_judge, false, ctl_ply_parse, NULL},
    {".glb", has_glb_magic, ctl_gltf_judge, true, ctl_gltf_parse, ctl_gltf_open},
    {".gltf", NULL, ctl_gltf_judge, true, ctl_gltf_parse, ctl_gltf_open},
    {".obj", NULL, judge_obj, false, ctl_obj_parse, NULL},
    {".stl", NULL, ctl_stl_judge, false, ctl_stl_parse, NULL},
    {".pc2", has_pc2_magic, NULL, false, NULL, ctl_pc2_open},
    {".mdd", NULL, NULL, false, NULL, ctl_mdd_open},
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
                         struct ctl_mesh *mesh, struct ctl_motion *motion,
                         struct ctl_error *error)
{
    return format_of_path(path)->open_motion(path, wish, mesh, motion, error);
}

int ctl_mesh_count_frames(const char *path, uint32_t *count, struct ctl_error *error)
{
    struct ctl_motion motion = {.frame_count = 1};
    bool moves = ctl_mesh_holds(path) == CTL_HOLDS_BOTH;
    int status = moves ? ctl_mesh_open_motion(path, NULL, NULL, &motion, error) : PCCD_OK;
    if (status == PCCD_OK) {
        *count = motion.frame_count;
    }
    if (motion.close != NULL) {
        motion.close(&motion);
    }
    return status;
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

static int parse(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error)
{
    if (file->bytes == 0) {
        return ctl_error_set(error, PCCD_E_FORMAT, "%s: the file is empty", file->path);
    }
    const struct format *format = format_of(file, error);
    if (format == NULL) {
        return PCCD_E_FORMAT;
    }
    if (!format->is_read_whole &&
        (mesh->part.count == 0 || format->parse != ctl_stl_parse)) {
        int status = format->parse(file, mesh, error);
        int reading = ctl_file_status(file, error);
        return reading != PCCD_OK ? reading : status;
    }
    const struct ctl_part part = mesh->part;
    mesh->part = (struct ctl_part){.count = 0};
    int status = format->is_read_whole ? ctl_file_load(file, error) : PCCD_OK;
    if (status == PCCD_OK) {
        status = format->parse(file, mesh, error);
        int reading = ctl_file_status(file, error);
        status = reading != PCCD_OK ? reading : status;
    }
    if (status == PCCD_OK && part.count > 0) {
        ctl_mesh_keep_part(mesh, part.number, part.count);
    }
    return status;
}

/* Of a mesh that was read without an error. */
static int judge_counts(const char *path, const struct ctl_mesh *mesh,
                        struct ctl_error *error)
{
    const struct ctl_part *part = &mesh->part;
    bool is_part = part->count > 0;
    uint32_t vertices = is_part ? part->vertex_total : mesh->vertex_count;
    bool has_any = mesh->triangle_count + mesh->edge_count + mesh->point_count > 0 ||
                   part->triangle_total + part->edge_total + part->point_total > 0;
    return vertices == 0 ? ctl_error_set(error, PCCD_E_FORMAT, "%s: no vertices", path)
           : !has_any    ? ctl_error_set(error, PCCD_E_FORMAT,
                                         "%s: no faces, edges or points", path)
                         : PCCD_OK;
}

/* Cut the polygons of a part: vertices that others keep are read once more. */
static int cut_part(struct ctl_file *file, struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct ctl_wanted wanted = {0};
    struct ctl_mesh others = {.part = {.number = mesh->part.number,
                                       .count = mesh->part.count,
                                       .wanted = &wanted}};
    int status = ctl_mesh_want(mesh, &wanted, file->path, error);
    if (status == PCCD_OK && wanted.count > 0) {
        status = parse(file, &others, error);
    }
    if (status == PCCD_OK) {
        status = ctl_mesh_cut(mesh, &wanted, file->path, error);
    }
    ctl_wanted_deinit(&wanted);
    ctl_mesh_deinit(&others);
    return status;
}

/* How a mesh is read. */
struct reading {
    uint32_t number, count; /* keep this piece; count 0: all */
    bool is_uncut, is_corners;
    const struct ctl_mesh *like; /* NULL: it is a first frame */
    const char *like_path;
};

static int read_mesh(const char *path, const struct reading *reading,
                     struct ctl_mesh *mesh, struct ctl_error *error)
{
    struct ctl_file file;
    struct ctl_mesh made = {.part = {.number = reading->number, .count = reading->count},
                            .is_corners = reading->is_corners};
    int status = ctl_file_open(path, judge, &file, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = parse(&file, &made, error);
    if (status == PCCD_OK) {
        status = judge_counts(path, &made, error);
    }
    if (status == PCCD_OK && reading->like != NULL) {
        status = ctl_mesh_cut_like(reading->like, reading->like_path, &made, path, error);
    } else if (status == PCCD_OK && !reading->is_uncut && made.polygon_count > 0) {
        status = reading->count > 0 ? cut_part(&file, &made, error)
                                    : ctl_mesh_cut(&made, NULL, path, error);
    }
    ctl_file_deinit(&file);
    if (status == PCCD_OK) {
        *mesh = made;
    } else {
        ctl_mesh_deinit(&made);
    }
    return status;
}

int ctl_mesh_read_part(const char *path, uint32_t number, uint32_t count,
                       struct ctl_mesh *mesh, struct ctl_error *error)
{
    const struct reading reading = {.number = number, .count = count};
    return read_mesh(path, &reading, mesh, error);
}

int ctl_mesh_read(const char *path, struct ctl_mesh *mesh, struct ctl_error *error)
{
    return ctl_mesh_read_part(path, 0, 0, mesh, error);
}

int ctl_mesh_read_uncut(const char *path, struct ctl_mesh *mesh, struct ctl_error *error)
{
    const struct reading reading = {.is_uncut = true};
    return read_mesh(path, &reading, mesh, error);
}

int ctl_mesh_read_corners(const char *path, struct ctl_mesh *mesh,
                          struct ctl_error *error)
{
    const struct reading reading = {.is_corners = true};
    return read_mesh(path, &reading, mesh, error);
}

int ctl_mesh_read_like(const char *path, const struct ctl_mesh *first,
                       const char *first_path, struct ctl_mesh *mesh,
                       struct ctl_error *error)
{
    const struct reading reading = {.number = first->part.number,
                                    .count = first->part.count,
                                    .like = first,
                                    .like_path = first_path};
    return read_mesh(path, &reading, mesh, error);
}
