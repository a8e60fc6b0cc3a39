/* client/ctl/mesh/meshframes.c - one mesh, frame by frame.
 *
 * Room:     client/ctl.
 * Does:     finds out how many frames each file has; compares shapes.
 * Threads:  one at a time.
 * Source:   meshframes.h.
 */
#include "meshframes.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "meshcut.h"

#define NAME_BYTES 64 /* of a frame within its file */

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the names of the frames");
}

/* ---- opening ----------------------------------------------------------------------- */

/* The next source, of a file or of a motion, which is its then. */
static void add_source(struct ctl_frames *frames, const char *path,
                       const struct ctl_motion *motion)
{
    struct ctl_frames_source *source = &frames->sources[frames->source_count++];
    *source = (struct ctl_frames_source){.path = path, .frame_first = frames->count};
    if (motion != NULL) {
        source->motion = *motion;
    }
    source->frame_count = motion != NULL ? motion->frame_count : 1;
    frames->count += source->frame_count;
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
    int status = ctl_mesh_open_motion(path, &options->wish, NULL, &motion, error);
    if (status == PCCD_OK) {
        add_source(frames, path, &motion);
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
        status = ctl_mesh_open_motion(path, &options->wish, NULL, &motion, error);
    }
    if (status == PCCD_OK && motion.read != NULL && motion.frame_count == 1) {
        motion.close(&motion);
        motion.read = NULL;
    }
    if (status == PCCD_OK) {
        add_source(frames, path, motion.read != NULL ? &motion : NULL);
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

static const struct ctl_frames_source *source_of(const struct ctl_frames *frames,
                                                 uint32_t index)
{
    const struct ctl_frames_source *source = frames->sources;
    while (index - source->frame_first >= source->frame_count) {
        source++;
    }
    return source;
}

static int read_motion(const struct ctl_frames *frames,
                       const struct ctl_frames_source *source, uint32_t index,
                       struct ctl_mesh *frame, struct ctl_error *error)
{
    const struct ctl_motion *motion = &source->motion;
    if (motion->vertex_count != frames->mesh.vertex_count) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s has %" PRIu32 " vertices and %s has %" PRIu32
                             ": not two frames of one mesh",
                             frames->shape_path, frames->mesh.vertex_count, source->path,
                             motion->vertex_count);
    }
    void *x = malloc((size_t)motion->vertex_count * common_vertex_bytes(motion->format));
    if (x == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM,
                             "%s: no memory for %" PRIu32 " vertices", source->path,
                             motion->vertex_count);
    }
    int status = motion->read(motion, index - source->frame_first, x, error);
    if (status != PCCD_OK) {
        free(x);
        return status;
    }
    free(frame->x);
    frame->x = x;
    frame->format = motion->format;
    frame->vertex_count = motion->vertex_count;
    return PCCD_OK;
}

/* The first frame's positions are there already, the first time. */
static void take_first(struct ctl_frames *frames, struct ctl_mesh *frame)
{
    frame->x = frames->mesh.x;
    frame->format = frames->mesh.format;
    frame->vertex_count = frames->mesh.vertex_count;
    frames->mesh.x = NULL;
}

int ctl_frames_read(struct ctl_frames *frames, uint32_t index, struct ctl_mesh *frame,
                    struct ctl_error *error)
{
    const struct ctl_frames_source *source = source_of(frames, index);
    ctl_mesh_deinit(frame);
    if (index == 0 && frames->mesh.x != NULL) {
        take_first(frames, frame);
        return PCCD_OK;
    }
    bool moves = source->motion.read != NULL;
    bool has_own_shape =
        !moves || (index == source->frame_first && source->path != frames->shape_path &&
                   ctl_mesh_holds(source->path) == CTL_HOLDS_BOTH);
    int status = PCCD_OK;
    if (has_own_shape) {
        status = ctl_mesh_read_like(source->path, &frames->mesh, frames->shape_path,
                                    frame, error);
        ctl_mesh_drop_shape(frame);
    }
    return status == PCCD_OK && moves ? read_motion(frames, source, index, frame, error)
                                      : status;
}

/* The shape, and the first frame's positions. */
static int read_shape(struct ctl_frames *frames, struct ctl_error *error)
{
    const struct ctl_frames_source *first = frames->sources;
    if (first->motion.read == NULL) {
        return ctl_mesh_read(frames->shape_path, &frames->mesh, error);
    }
    int status = ctl_mesh_read_uncut(frames->shape_path, &frames->mesh, error);
    if (status == PCCD_OK) {
        status = read_motion(frames, first, 0, &frames->mesh, error);
    }
    return status == PCCD_OK
               ? ctl_mesh_cut(&frames->mesh, NULL, frames->shape_path, error)
               : status;
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
    return status == PCCD_OK ? read_shape(frames, error) : status;
}

void ctl_frames_close(struct ctl_frames *frames)
{
    for (uint32_t i = 0; i < frames->source_count; i++) {
        if (frames->sources[i].motion.read != NULL) {
            frames->sources[i].motion.close(&frames->sources[i].motion);
        }
    }
    for (uint32_t i = 0; frames->names != NULL && i < frames->count; i++) {
        free(frames->names[i]);
    }
    free(frames->names);
    free(frames->sources);
    ctl_mesh_deinit(&frames->mesh);
    ctl_sequence_deinit(&frames->sequence);
    *frames = (struct ctl_frames){.count = 0};
}
