/* client/ctl/mesh/meshframes.c - one mesh, frame by frame.
 *
 * Room:     client/ctl.
 * Does:     finds out how many frames each file has; joins vertices that are at one place
 *           in all of them.
 * Threads:  one at a time.
 * Source:   meshframes.h.
 */
#include "meshframes.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "coordinates.h"
#include "pccd.h"
#include "progress.h"

#define NAME_BYTES 64 /* of a frame within its file */

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the names of the frames");
}

/* ---- opening ----------------------------------------------------------------------- */

/* The next source, of a file or of a motion, which is its then. */
static struct ctl_frames_source *add_source(struct ctl_frames *frames, const char *path,
                                            const struct ctl_motion *motion)
{
    struct ctl_frames_source *source = &frames->sources[frames->source_count++];
    *source = (struct ctl_frames_source){.path = path, .frame_first = frames->count};
    if (motion != NULL) {
        source->motion = *motion;
    }
    source->frame_count = motion != NULL ? motion->frame_count : 1;
    frames->count += source->frame_count;
    return source;
}

/* A file of positions alone: the mesh file before it tells their shape. */
static int add_cache(struct ctl_frames *frames, const char *path, const char *mesh_path,
                     const struct ctl_frames_options *options, struct ctl_error *error)
{
    struct ctl_motion motion = {.read = NULL};
    if (mesh_path == NULL) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s has positions alone: name the mesh file with its faces "
                             "before it",
                             path);
    }
    int status = ctl_mesh_open_motion(path, &options->wish, &motion, error);
    if (status == PCCD_OK) {
        (void)add_source(frames, path, &motion);
    }
    return status;
}

/* Of a mesh file that moves by itself the shape is read when its first frame is. */
static int add_mesh_file(struct ctl_frames *frames, const char *path,
                         enum ctl_mesh_holds holds,
                         const struct ctl_frames_options *options,
                         struct ctl_error *error)
{
    struct ctl_motion motion = {.read = NULL};
    int status = PCCD_OK;
    if (holds == CTL_HOLDS_BOTH) {
        status = ctl_mesh_open_motion(path, &options->wish, &motion, error);
    }
    if (status == PCCD_OK && motion.read != NULL && motion.frame_count == 1) {
        motion.close(&motion);
        motion.read = NULL;
    }
    if (status == PCCD_OK) {
        add_source(frames, path, motion.read != NULL ? &motion : NULL)->is_stl =
            holds == CTL_HOLDS_CORNERS;
    }
    return status;
}

static int add_sources(struct ctl_frames *frames, char *const *paths, uint32_t path_count,
                       const struct ctl_frames_options *options, struct ctl_error *error)
{
    int status = PCCD_OK;
    const char *mesh_path = NULL; /* the last one */
    for (uint32_t i = 0; i < path_count && status == PCCD_OK; i++) {
        enum ctl_mesh_holds holds = ctl_mesh_holds(paths[i]);
        bool has_cache =
            i + 1 < path_count && ctl_mesh_holds(paths[i + 1]) == CTL_HOLDS_POSITIONS;
        if (holds == CTL_HOLDS_POSITIONS) {
            status = add_cache(frames, paths[i], mesh_path, options, error);
            continue;
        }
        mesh_path = paths[i];
        if (!has_cache) {
            status = add_mesh_file(frames, paths[i], holds, options, error);
        }
    }
    return status;
}

static int name_frames(struct ctl_frames *frames, struct ctl_error *error)
{
    frames->names = calloc(frames->count, sizeof *frames->names);
    if (frames->names == NULL) {
        return no_memory(error);
    }
    for (uint32_t s = 0; s < frames->source_count; s++) {
        const struct ctl_frames_source *source = &frames->sources[s];
        for (uint32_t i = 0; i < source->frame_count; i++) {
            size_t bytes = strlen(source->path) + NAME_BYTES + 2;
            char *name = malloc(bytes), within[NAME_BYTES] = "";
            if (name == NULL) {
                return no_memory(error);
            }
            if (source->motion.read != NULL) {
                source->motion.name(&source->motion, i, within, sizeof within);
            }
            (void)snprintf(name, bytes, "%s%s%s", source->path,
                           within[0] != '\0' ? " " : "", within);
            frames->names[source->frame_first + i] = name;
        }
    }
    return PCCD_OK;
}

/* ---- reading ----------------------------------------------------------------------- */

static struct ctl_frames_source *source_of(const struct ctl_frames *frames,
                                           uint32_t index)
{
    struct ctl_frames_source *source = frames->sources;
    while (index - source->frame_first >= source->frame_count) {
        source++;
    }
    return source;
}

static int other_count(const struct ctl_frames *frames, const char *path,
                       const char *what, uint32_t ours, uint32_t its,
                       struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_INVAL,
                         "%s has %" PRIu32 " %s and %s has %" PRIu32
                         ": not two frames of one mesh",
                         frames->shape_path, ours, what, path, its);
}

static void *room_for(const char *path, uint32_t count, enum pccd_format format,
                      struct ctl_error *error)
{
    void *x = malloc((size_t)count * common_vertex_bytes(format) + 1);
    if (x == NULL) {
        (void)ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for %" PRIu32 " vertices",
                            path, count);
    }
    return x;
}

static int read_motion(const struct ctl_frames *frames,
                       const struct ctl_frames_source *source, uint32_t index,
                       struct ctl_mesh *frame, struct ctl_error *error)
{
    const struct ctl_motion *motion = &source->motion;
    uint32_t count = frames->shape.vertex_count;
    if (motion->vertex_count != count) {
        return other_count(frames, source->path, "vertices", count, motion->vertex_count,
                           error);
    }
    void *x = room_for(source->path, count, motion->format, error);
    int status = x != NULL ? motion->read(motion, index - source->frame_first, x, error)
                           : PCCD_E_NOMEM;
    if (status != PCCD_OK) {
        free(x);
        return status;
    }
    free(frame->x);
    frame->x = x;
    frame->format = motion->format;
    frame->vertex_count = count;
    return PCCD_OK;
}

/* Hand over positions that are there already. */
static void take(struct ctl_mesh *from, struct ctl_mesh *frame)
{
    frame->x = from->x;
    frame->format = from->format;
    frame->vertex_count = from->vertex_count;
    from->x = NULL;
}

static bool is_pipe(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISREG(info.st_mode);
}

/* Three vertices of each triangle, as STL has them. */
static int read_corners(const struct ctl_frames *frames, struct ctl_frames_source *source,
                        struct ctl_mesh *corners, struct ctl_error *error)
{
    const char *path = source->path;
    if (source->corners.x != NULL) {
        take(&source->corners, corners);
        return PCCD_OK;
    }
    const struct ctl_reading reading = {.is_corners = true};
    int status = ctl_mesh_read_as(path, &reading, corners, error);
    uint32_t ours = frames->shape.triangles.count, its = corners->triangles.count;
    return status == PCCD_OK && its != ours
               ? other_count(frames, path, "triangles", ours, its, error)
               : status;
}

/* A frame from STL: each vertex is where its corners are. */
static int read_stl(const struct ctl_frames *frames, struct ctl_frames_source *source,
                    struct ctl_mesh *frame, struct ctl_error *error)
{
    const char *path = source->path;
    struct ctl_mesh corners = {0};
    uint32_t count = frames->shape.vertex_count;
    int status = read_corners(frames, source, &corners, error);
    float(*x)[3] =
        status == PCCD_OK ? room_for(path, count, PCCD_FORMAT_F32, error) : NULL;
    if (x == NULL) {
        ctl_mesh_deinit(&corners);
        return status != PCCD_OK ? status : PCCD_E_NOMEM;
    }
    const uint32_t *vertices = frames->shape.triangles.vertices;
    for (size_t i = 0; i < corners.vertex_count; i++) {
        memcpy(x[vertices[i]], ((const float(*)[3])corners.x)[i], sizeof *x);
    }
    ctl_mesh_deinit(&corners);
    frame->x = x;
    frame->format = PCCD_FORMAT_F32;
    frame->vertex_count = count;
    return PCCD_OK;
}

/* Positions of a frame that is not the first one's file, or is that once more. */
static int read_frame(const struct ctl_frames *frames, uint32_t index,
                      struct ctl_mesh *frame, struct ctl_error *error)
{
    struct ctl_frames_source *source = source_of(frames, index);
    const struct ctl_reading reading = {.like = &frames->shape};
    if (source->motion.read != NULL) {
        bool has_own_shape = index == source->frame_first &&
                             source->path != frames->shape_path &&
                             source->motion.shape != NULL;
        int status = has_own_shape
                         ? ctl_mesh_read_as(source->path, &reading, frame, error)
                         : PCCD_OK;
        ctl_mesh_drop_shape(frame);
        return status == PCCD_OK ? read_motion(frames, source, index, frame, error)
                                 : status;
    }
    if (source->is_stl && frames->sources[0].is_stl) {
        return read_stl(frames, source, frame, error);
    }
    int status = ctl_mesh_read_as(source->path, &reading, frame, error);
    ctl_mesh_drop_shape(frame);
    return status;
}

int ctl_frames_read(struct ctl_frames *frames, uint32_t index, struct ctl_mesh *frame,
                    struct ctl_error *error)
{
    struct ctl_frames_source *source = source_of(frames, index);
    ctl_mesh_deinit(frame);
    if (index == 0 && frames->mesh.x != NULL) {
        take(&frames->mesh, frame);
        return PCCD_OK;
    }
    if (source->held.x != NULL) {
        take(&source->held, frame);
        return PCCD_OK;
    }
    return read_frame(frames, index, frame, error);
}

/* The shape, and the first frame's positions. */
static int read_shape(struct ctl_frames *frames, struct ctl_error *error)
{
    const struct ctl_frames_source *first = frames->sources;
    if (first->motion.read == NULL) {
        return ctl_mesh_read(frames->shape_path, &frames->shape, error);
    }
    const struct ctl_reading reading = {.is_uncut = true};
    int status = ctl_mesh_read_as(frames->shape_path, &reading, &frames->shape, error);
    if (status == PCCD_OK) {
        status = read_motion(frames, first, 0, &frames->shape, error);
    }
    if (status == PCCD_OK) {
        status = ctl_mesh_cut(&frames->shape, error);
    }
    if (status == PCCD_E_FORMAT && first->path != frames->shape_path) {
        const struct ctl_error why = *error;
        return ctl_error_set(error, status, "%s, as %s places it", why.text, first->path);
    }
    return status;
}

/* Pipes are read now, as they can be once. */
static int hold_pipes(struct ctl_frames *frames, struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t s = 1; s < frames->source_count && status == PCCD_OK; s++) {
        struct ctl_frames_source *source = &frames->sources[s];
        if (source->motion.read == NULL && is_pipe(source->path)) {
            status = read_frame(frames, source->frame_first, &source->held, error);
        }
    }
    return status;
}

/* ---- vertices at one place --------------------------------------------------------- */

/* The shape of STL has a vertex for all corners that are at one place in each frame. */
static int renumber(struct ctl_frames *frames, const uint32_t *to, uint32_t count,
                    struct ctl_error *error)
{
    struct ctl_mesh *shape = &frames->shape;
    uint32_t *vertices = shape->triangles.vertices, made = 0;
    uint32_t *names = malloc((size_t)count * 3 * sizeof *names + 1);
    float(*x)[3] = room_for(frames->shape_path, count * 3, PCCD_FORMAT_F32, error);
    if (names == NULL || x == NULL) {
        free(names);
        free(x);
        return no_memory(error);
    }
    for (size_t i = 0; i < (size_t)count * 3; i++) {
        if (to[i] == i) {
            memcpy(x[made], ((const float(*)[3])shape->x)[vertices[i]], sizeof *x);
            names[i] = made++;
        }
        vertices[i] = names[to[i]]; /* the least one, which has its name */
    }
    free(names);
    free(shape->x);
    shape->x = x;
    shape->vertex_count = made;
    return PCCD_OK;
}

/* What the library has said of vertices at one place. */
static int welded(const struct ctl_frames *frames, int status, struct ctl_error *error)
{
    const char *path = frames->shape_path, *why = pccd_error_text(NULL);
    return status == PCCD_OK ? status : ctl_error_set(error, status, "%s: %s", path, why);
}

/* Where the corners of the shape's triangles are, as STL has them; NULL: no memory. */
static float (*corners_of(const struct ctl_mesh *shape))[3]
{
    size_t count = (size_t)shape->triangles.count * 3;
    const uint32_t *vertices = shape->triangles.vertices;
    float(*x)[3] = malloc(count * sizeof *x + 1);
    for (size_t i = 0; x != NULL && i < count; i++) {
        memcpy(x[i], ((const float(*)[3])shape->x)[vertices[i]], sizeof *x);
    }
    return x;
}

static int split_corners(struct ctl_frames *frames, struct ctl_error *error)
{
    const struct ctl_mesh *shape = &frames->shape;
    size_t corner_count = (size_t)shape->triangles.count * 3;
    const struct pccd_mesh_data all = {.vertex_count = (uint32_t)corner_count};
    struct pccd_weld_counts counts = {.joined = 0};
    struct pccd_weld *weld = NULL;
    float(*x)[3] = corner_count <= CTL_MESH_COUNT_MAX ? corners_of(shape) : NULL;
    if (x == NULL) {
        return no_memory(error);
    }
    int status = pccd_weld_begin(&all, 0, false, &weld);
    status = status == PCCD_OK ? pccd_weld_frame(weld, x, PCCD_FORMAT_F32) : status;
    status = welded(frames, status, error);
    free(x);
    for (uint32_t s = 1; s < frames->source_count && status == PCCD_OK; s++) {
        struct ctl_frames_source *source = &frames->sources[s];
        struct ctl_mesh corners = {0};
        if (!source->is_stl) {
            continue;
        }
        status = read_corners(frames, source, &corners, error);
        if (status == PCCD_OK) {
            status = pccd_weld_frame(weld, corners.x, corners.format);
            status = welded(frames, status, error);
        }
        if (status == PCCD_OK && is_pipe(source->path)) {
            take(&corners, &source->corners);
        }
        ctl_mesh_deinit(&corners);
    }
    const uint32_t *to = pccd_weld_read(weld, &counts);
    if (status == PCCD_OK && counts.apart > 0) {
        status = renumber(frames, to, shape->triangles.count, error);
    }
    pccd_weld_end(weld);
    return status;
}

/* Part what moves apart in a later frame. */
static int weld_frames(struct ctl_frames *frames, struct pccd_weld *weld,
                       struct pccd_weld_counts *counts, struct ctl_error *error)
{
    int status = PCCD_OK;
    struct progress progress;
    progress_begin(&progress, "frames", frames->count);
    for (uint32_t i = 1;
         i < frames->count && status == PCCD_OK && counts->joined + counts->more > 0;
         i++) {
        struct ctl_mesh frame = {0};
        const struct ctl_mesh *held = &source_of(frames, i)->held;
        status = held->x == NULL ? read_frame(frames, i, &frame, error) : PCCD_OK;
        held = held->x == NULL ? &frame : held;
        if (status == PCCD_OK) {
            status = welded(frames, pccd_weld_frame(weld, held->x, held->format), error);
        }
        (void)pccd_weld_read(weld, counts);
        ctl_mesh_deinit(&frame);
        progress_update(&progress, i + 1);
    }
    progress_clear(&progress);
    return status;
}

/* Objects that touch there cannot meet there any more, so that is told. */
static int count_between(const uint32_t *to, const struct ctl_mesh *shape,
                         uint32_t *between, struct ctl_error *error)
{
    uint32_t *objects = ctl_mesh_object_of_vertices(shape);
    if (objects == NULL) {
        return no_memory(error);
    }
    for (uint32_t i = 0; i < shape->vertex_count; i++) {
        *between += objects[i] != objects[to[i]];
    }
    free(objects);
    return PCCD_OK;
}

static bool is_flat(const uint32_t corners[3])
{
    return corners[0] == corners[1] || corners[1] == corners[2] ||
           corners[2] == corners[0];
}

/* The shape once more, with the vertices that stand for others. */
static int rename_shape(struct ctl_frames *frames, const uint32_t *to,
                        struct ctl_error *error)
{
    const struct ctl_mesh *shape = &frames->shape;
    for (uint32_t kind = 0; kind < CTL_KINDS; kind++) {
        const struct ctl_list *list = &shape->lists[kind];
        size_t count = (size_t)list->count * (kind + 1);
        uint32_t *vertices = malloc(count * sizeof *vertices + 1);
        if (vertices == NULL) {
            return no_memory(error);
        }
        for (size_t i = 0; i < count; i++) {
            vertices[i] = to[list->vertices[i]];
        }
        frames->mesh.lists[kind] = *list;
        frames->mesh.lists[kind].vertices = vertices;
    }
    for (size_t i = 0; i < (size_t)shape->triangles.count * 3; i += 3) {
        frames->welded.flat += is_flat(frames->mesh.triangles.vertices + i) &&
                               !is_flat(shape->triangles.vertices + i);
    }
    return PCCD_OK;
}

static int weld_shape(struct ctl_frames *frames, double distance, struct ctl_error *error)
{
    const struct ctl_mesh *shape = &frames->shape;
    const struct pccd_mesh_data named = {
        .vertex_count = shape->vertex_count,
        .triangles = shape->triangles.vertices,
        .triangle_count = shape->triangles.count,
        .edges = shape->edges.vertices,
        .edge_count = shape->edges.count,
        .points = shape->points.vertices,
        .point_count = shape->points.count,
    };
    struct pccd_weld_counts counts = {.joined = 0};
    struct pccd_weld *weld = NULL;
    int status = pccd_weld_begin(&named, distance, true, &weld);
    status = status == PCCD_OK ? pccd_weld_frame(weld, shape->x, shape->format) : status;
    const uint32_t *to = pccd_weld_read(weld, &counts);
    status = status == PCCD_OK ? weld_frames(frames, weld, &counts, error)
                               : welded(frames, status, error);
    if (status == PCCD_OK && counts.joined > 0 && shape->object_count > 1) {
        status = count_between(to, shape, &frames->welded.between, error);
    }
    if (status == PCCD_OK && counts.joined > 0) {
        status = rename_shape(frames, to, error);
    }
    frames->welded.joined = counts.joined;
    frames->welded.apart = counts.apart;
    frames->welded.more = counts.more;
    frames->welded.distance = distance > 0 ? distance : counts.more_distance;
    pccd_weld_end(weld);
    return status;
}

/* What is used of the shape: its own arrays, where none was joined. */
static void finish(struct ctl_frames *frames)
{
    struct ctl_mesh joined = frames->mesh;
    frames->mesh = frames->shape;
    frames->shape.x = NULL;
    for (int kind = 0; kind < CTL_KINDS; kind++) {
        if (joined.lists[kind].vertices != NULL) {
            frames->mesh.lists[kind] = joined.lists[kind];
        }
    }
}

int ctl_frames_open(struct ctl_frames *frames, char *const *paths, uint32_t path_count,
                    const struct ctl_frames_options *options, struct ctl_error *error)
{
    *frames = (struct ctl_frames){.count = 0};
    int status = ctl_sequence_expand(&frames->sequence, paths, path_count, error);
    if (status != PCCD_OK) {
        return status;
    }
    const struct ctl_sequence *files = &frames->sequence;
    frames->shape_path = files->paths[0];
    frames->sources = calloc(files->count, sizeof *frames->sources);
    if (frames->sources == NULL) {
        return no_memory(error);
    }
    status = add_sources(frames, files->paths, files->count, options, error);
    if (status == PCCD_OK) {
        status = name_frames(frames, error);
    }
    if (status == PCCD_OK) {
        status = read_shape(frames, error);
    }
    if (status == PCCD_OK && frames->sources[0].is_stl && frames->source_count > 1) {
        status = split_corners(frames, error);
    }
    if (status == PCCD_OK) {
        status = hold_pipes(frames, error);
    }
    if (status == PCCD_OK && options->weld >= 0) {
        status = weld_shape(frames, options->weld, error);
    }
    finish(frames);
    return status;
}

int ctl_frames_read_one(const char *path, const struct ctl_frames_options *options,
                        struct ctl_mesh *mesh, struct ctl_welded *welded,
                        uint32_t *frame_count, struct ctl_error *error)
{
    struct ctl_frames frames;
    char *const paths[1] = {(char *)(uintptr_t)path};
    int status = ctl_frames_open(&frames, paths, 1, options, error);
    if (status == PCCD_OK) {
        /* The shape is given away, or what stands for its arrays. */
        struct ctl_mesh *shape = &frames.shape;
        *mesh = frames.mesh;
        *welded = frames.welded;
        *frame_count = frames.count;
        for (int kind = 0; kind < CTL_KINDS; kind++) {
            if (mesh->lists[kind].vertices != shape->lists[kind].vertices) {
                free(shape->lists[kind].vertices);
            }
        }
        *shape = (struct ctl_mesh){.x = NULL};
        frames.mesh = (struct ctl_mesh){.x = NULL};
    }
    ctl_frames_close(&frames);
    return status;
}

void ctl_frames_close(struct ctl_frames *frames)
{
    for (uint32_t i = 0; i < frames->source_count; i++) {
        if (frames->sources[i].motion.read != NULL) {
            frames->sources[i].motion.close(&frames->sources[i].motion);
        }
        ctl_mesh_deinit(&frames->sources[i].held);
        ctl_mesh_deinit(&frames->sources[i].corners);
    }
    for (uint32_t i = 0; frames->names != NULL && i < frames->count; i++) {
        free(frames->names[i]);
    }
    free(frames->names);
    free(frames->sources);
    free(frames->mesh.x);
    for (int kind = 0; kind < CTL_KINDS; kind++) {
        if (frames->mesh.lists[kind].vertices != frames->shape.lists[kind].vertices) {
            free(frames->mesh.lists[kind].vertices);
        }
    }
    ctl_mesh_deinit(&frames->shape);
    ctl_sequence_deinit(&frames->sequence);
    *frames = (struct ctl_frames){.count = 0};
}
