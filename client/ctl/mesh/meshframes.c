/* client/ctl/mesh/meshframes.c - one mesh, frame by frame. */
#include "meshframes.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pccd.h"
#include "terminal.h"

static int no_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the frames");
}

/* ---- reading ----------------------------------------------------------------------- */

static struct ctl_frames_source *source_of(const struct ctl_frames *frames,
                                           uint32_t index)
{
    uint32_t low = 0, high = frames->source_count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        *(frames->sources[middle].frame_first <= index ? &low : &high) = middle;
    }
    return &frames->sources[low];
}

/* Positions that a file has without a shape. */
static int read_positions(const struct ctl_frames *frames,
                          const struct ctl_frames_source *source, uint32_t frame,
                          struct ctl_mesh *mesh, struct ctl_error *error)
{
    const struct ctl_motion *motion = &source->motion;
    uint32_t count = frames->shape.vertex_count;
    if (motion->vertex_count != count) {
        return ctl_mesh_other_count(frames->shape.path, count, "vertices", source->path,
                                    motion->vertex_count, error);
    }
    free(mesh->x);
    mesh->x = malloc(count * common_vertex_bytes(motion->format) + 1);
    mesh->format = motion->format;
    mesh->vertex_count = count;
    return mesh->x != NULL ? motion->read(motion, frame, mesh->x, error)
                           : ctl_error_set(error, PCCD_E_NOMEM,
                                           "%s: no memory for %" PRIu32 " vertices",
                                           source->path, count);
}

/* Three vertices of each triangle, as STL has them. */
static int read_corners(const struct ctl_frames *frames,
                        const struct ctl_frames_source *source, struct ctl_mesh *corners,
                        struct ctl_error *error)
{
    const struct ctl_reading reading = {.is_corners = true};
    int status = ctl_mesh_read_as(source->path, &reading, corners, error);
    uint32_t ours = frames->shape.triangles.count, its = corners->triangles.count;
    return status == PCCD_OK && its != ours
               ? ctl_mesh_other_count(frames->shape.path, ours, "triangles", source->path,
                                      its, error)
               : status;
}

/* Move the three vertices of each triangle to where the shape has them: none of these is
 * before the first of its corners, so all move down. */
static void place_corners(const struct ctl_frames *frames, struct ctl_mesh *corners)
{
    const uint32_t *vertices = frames->shape.triangles.vertices;
    float(*x)[3] = corners->x;
    for (size_t i = 0; i < corners->vertex_count; i++) {
        memmove(x[vertices[i]], x[i], sizeof *x);
    }
    corners->vertex_count = frames->shape.vertex_count;
    void *less = realloc(x, (size_t)corners->vertex_count * sizeof *x + 1);
    corners->x = less != NULL ? less : x;
}

/* A frame from its file. */
static int read_frame(const struct ctl_frames *frames, uint32_t index,
                      struct ctl_mesh *frame, struct ctl_error *error)
{
    struct ctl_frames_source *source = source_of(frames, index);
    const struct ctl_motion *motion = &source->motion;
    const struct ctl_reading reading = {.like = &frames->shape};
    bool is_first = index == source->frame_first && source != frames->sources;
    int status;
    if (source->held.x != NULL) {
        *frame = source->held;
        source->held.x = NULL;
        return PCCD_OK;
    }
    if (motion->read != NULL && (motion->shape == NULL || !is_first)) {
        return read_positions(frames, source, index - source->frame_first, frame, error);
    }
    if (motion->read != NULL) { /* it has a shape of its own */
        status = ctl_mesh_read_shape(motion, source->path, frame, error);
        status =
            status == PCCD_OK ? ctl_mesh_match(&frames->shape, frame, error) : status;
    } else if (source->is_stl && frames->sources->is_stl) {
        status = read_corners(frames, source, frame, error);
        if (status == PCCD_OK) {
            place_corners(frames, frame);
        }
    } else {
        status = ctl_mesh_read_as(source->path, &reading, frame, error);
    }
    ctl_mesh_drop_shape(frame);
    return status;
}

int ctl_frames_read(struct ctl_frames *frames, uint32_t index, struct ctl_mesh *frame,
                    struct ctl_error *error)
{
    ctl_mesh_deinit(frame);
    if (index == 0 && frames->mesh.x != NULL) {
        frame->x = frames->mesh.x;
        frame->format = frames->mesh.format;
        frame->vertex_count = frames->mesh.vertex_count;
        frames->mesh.x = NULL;
        return PCCD_OK;
    }
    return read_frame(frames, index, frame, error);
}

/* ---- opening ----------------------------------------------------------------------- */

static int open_file(struct ctl_frames *frames, uint32_t i,
                     const struct ctl_motion_wish *wish, struct ctl_error *error)
{
    const struct ctl_sequence *files = &frames->sequence;
    const char *path = files->paths[i];
    enum ctl_mesh_holds holds = ctl_mesh_holds(path);
    bool has_cache = i + 1 < files->count &&
                     ctl_mesh_holds(files->paths[i + 1]) == CTL_HOLDS_POSITIONS;
    bool is_shape = holds == CTL_HOLDS_POSITIONS ? i == 0 : has_cache;
    const struct ctl_reading reading = {.is_uncut = is_shape,
                                        .is_corners = holds == CTL_HOLDS_CORNERS &&
                                                      files->count > 1 && !is_shape};
    struct ctl_frames_source *source = &frames->sources[frames->source_count];
    struct ctl_motion *motion = &source->motion;
    int status = PCCD_OK;
    *source = (struct ctl_frames_source){.path = path,
                                         .frame_first = frames->count,
                                         .frame_count = 1,
                                         .is_stl = holds == CTL_HOLDS_CORNERS};
    if (!is_shape && (holds == CTL_HOLDS_BOTH || holds == CTL_HOLDS_POSITIONS)) {
        status = ctl_mesh_open_motion(path, wish, motion, error);
        source->frame_count = motion->frame_count;
    }
    if (status == PCCD_OK && i == 0) {
        status = motion->shape != NULL
                     ? ctl_mesh_read_shape(motion, path, &frames->mesh, error)
                     : ctl_mesh_read_as(path, &reading, &frames->mesh, error);
        frames->shape = frames->mesh;
    }
    if (motion->shape != NULL && source->frame_count == 1) { /* read as others are */
        ctl_motion_close(motion);
    }
    frames->source_count += !is_shape;
    frames->count += is_shape ? 0 : source->frame_count;
    return status;
}

/* The first frame's positions, where another file has them. */
static int place_shape(struct ctl_frames *frames, struct ctl_error *error)
{
    const struct ctl_frames_source *first = frames->sources;
    if (first->path == frames->mesh.path) {
        return PCCD_OK;
    }
    int status = read_positions(frames, first, 0, &frames->mesh, error);
    if (status == PCCD_OK) {
        status = ctl_mesh_cut(&frames->mesh, error);
    }
    if (status == PCCD_E_FORMAT) {
        const struct ctl_error why = *error;
        (void)ctl_error_set(error, status, "%s, as %s places it", why.text, first->path);
    }
    return status;
}

static int name_frames(struct ctl_frames *frames, struct ctl_error *error)
{
    frames->names = calloc(frames->count, sizeof *frames->names);
    for (uint32_t i = 0; frames->names != NULL && i < frames->count; i++) {
        const struct ctl_frames_source *source = source_of(frames, i);
        const struct ctl_motion *motion = &source->motion;
        char within[64] = "";
        if (motion->read != NULL) {
            motion->name(motion, i - source->frame_first, within, sizeof within);
        }
        if (asprintf(&frames->names[i], "%s%s%s", source->path,
                     within[0] != '\0' ? " " : "", within) < 0) {
            frames->names[i] = NULL;
            return no_memory(error);
        }
    }
    return frames->names != NULL ? PCCD_OK : no_memory(error);
}

/* ---- vertices at one place --------------------------------------------------------- */

/* Set the error to what the library has said of the frames. Return `status`. */
static int told(const struct ctl_frames *frames, int status, struct ctl_error *error)
{
    return status == PCCD_OK ? status
                             : ctl_error_set(error, status, "%s: %s", frames->mesh.path,
                                             pccd_error_text(NULL));
}

/* Hold a frame that was read of a pipe, which can be read once, until it is asked for;
 * let go of any other. */
static void hold(struct ctl_frames_source *source, struct ctl_mesh *frame)
{
    if (ctl_mesh_is_pipe(source->path)) {
        source->held = *frame;
        *frame = (struct ctl_mesh){.x = NULL};
    }
    ctl_mesh_deinit(frame);
}

/* Join what is at one place in the first frame, and part what moves apart in a later one.
 * Of corners those of STL alone are looked at. */
static int weld_frames(struct ctl_frames *frames, const struct pccd_mesh_data *shape,
                       double within, bool are_corners, struct pccd_weld **weld,
                       struct ctl_error *error)
{
    const struct ctl_mesh *mesh = &frames->mesh;
    struct pccd_weld_counts counts = {.joined = 0};
    struct progress progress;
    uint32_t count = frames->welded.frame_count;
    int status = pccd_weld_begin(shape, within, !are_corners, weld);
    status = status == PCCD_OK ? pccd_weld_frame(*weld, mesh->x, mesh->format) : status;
    status = told(frames, status, error);
    (void)pccd_weld_read(*weld, &counts);
    progress_begin(&progress, "frames", count);
    for (uint32_t i = 1; i < count && status == PCCD_OK; i++) {
        struct ctl_frames_source *source = source_of(frames, i);
        struct ctl_mesh frame = {0};
        if (are_corners ? !source->is_stl : counts.joined + counts.more == 0) {
            continue;
        }
        status = read_frame(frames, i, &frame, error);
        if (status != PCCD_OK && !ctl_mesh_is_pipe(source->path)) {
            ctl_mesh_deinit(&frame);
            error->text[0] = '\0';
            frames->welded.frame_count = i; /* those before it are told of */
            status = PCCD_OK;
            break; /* who reads that frame is told why he cannot */
        }
        if (status == PCCD_OK) {
            status = told(frames, pccd_weld_frame(*weld, frame.x, frame.format), error);
            (void)pccd_weld_read(*weld, &counts);
        }
        hold(source, &frame);
        progress_update(&progress, i + 1);
    }
    progress_clear(&progress);
    return status;
}

/* The shape of STL has a vertex for all corners that are at one place in each frame. It
 * has three of each triangle still, and gets them in the order of their first corners. */
static int join_corners(struct ctl_frames *frames, struct ctl_error *error)
{
    struct ctl_mesh *mesh = &frames->mesh;
    const struct pccd_mesh_data all = {.vertex_count = mesh->vertex_count};
    uint32_t *vertices = mesh->triangles.vertices, made = 0;
    struct pccd_weld *weld = NULL;
    int status = weld_frames(frames, &all, 0, true, &weld, error);
    const uint32_t *to = pccd_weld_read(weld, NULL);
    for (uint32_t i = 0; status == PCCD_OK && i < mesh->vertex_count; i++) {
        vertices[i] = to[i] == i ? made++ : vertices[to[i]];
    }
    pccd_weld_end(weld);
    if (status == PCCD_OK) {
        frames->shape.vertex_count = made;
        place_corners(frames, mesh);
    }
    for (uint32_t s = 1; s < frames->source_count && status == PCCD_OK; s++) {
        if (frames->sources[s].held.x != NULL) {
            place_corners(frames, &frames->sources[s].held);
        }
    }
    return status;
}

/* Objects that touch there cannot meet there any more, so that is told. */
static int count_between(struct ctl_frames *frames, const uint32_t *to,
                         struct ctl_error *error)
{
    uint32_t *objects = ctl_mesh_object_of_vertices(&frames->shape);
    for (uint32_t i = 0; objects != NULL && i < frames->shape.vertex_count; i++) {
        frames->welded.between += objects[i] != objects[to[i]];
    }
    free(objects);
    return objects != NULL ? PCCD_OK : no_memory(error);
}

int ctl_frames_rename(struct ctl_frames *frames, const uint32_t *to,
                      struct ctl_error *error)
{
    for (size_t kind = 0; kind < CTL_KINDS; kind++) {
        struct ctl_list *list = &frames->mesh.lists[kind];
        const size_t count = list->count * (kind + 1);
        uint32_t *renamed = malloc(count * sizeof *renamed + 1);
        if (renamed == NULL) {
            return no_memory(error);
        }
        for (size_t i = 0; i < count; i++) {
            renamed[i] = to[list->vertices[i]];
        }
        list->vertices = renamed;
    }
    for (size_t i = 0; i < (size_t)frames->mesh.triangles.count * 3; i += 3) {
        frames->welded.flat += ctl_is_flat(frames->mesh.triangles.vertices + i) &&
                               !ctl_is_flat(frames->shape.triangles.vertices + i);
    }
    return PCCD_OK;
}

static int weld_shape(struct ctl_frames *frames, const struct ctl_frames_options *options,
                      struct ctl_error *error)
{
    const struct ctl_mesh *mesh = &frames->mesh;
    const struct pccd_mesh_data named = {
        .vertex_count = mesh->vertex_count,
        .triangles = mesh->triangles.vertices,
        .triangle_count = mesh->triangles.count,
        .edges = mesh->edges.vertices,
        .edge_count = mesh->edges.count,
        .points = mesh->points.vertices,
        .point_count = mesh->points.count,
    };
    struct pccd_weld_counts counts = {.joined = 0};
    struct pccd_weld *weld = NULL;
    int status = weld_frames(frames, &named, options->weld, false, &weld, error);
    const uint32_t *to = pccd_weld_read(weld, &counts);
    if (status == PCCD_OK && counts.joined > 0 && mesh->object_count > 1) {
        status = count_between(frames, to, error);
    }
    if (status == PCCD_OK && counts.joined > 0) {
        status = ctl_frames_rename(frames, to, error);
    }
    frames->welded.joined = counts.joined;
    frames->welded.apart = counts.apart;
    frames->welded.more = counts.more;
    frames->welded.distance = counts.more_distance;
    pccd_weld_end(weld);
    return status;
}

int ctl_frames_open(struct ctl_frames *frames, char *const *paths, uint32_t path_count,
                    const struct ctl_frames_options *options, struct ctl_error *error)
{
    *frames = (struct ctl_frames){.count = 0};
    int status = ctl_sequence_expand(&frames->sequence, paths, path_count, error);
    if (status != PCCD_OK) {
        return status;
    }
    frames->sources = calloc(frames->sequence.count, sizeof *frames->sources);
    status = frames->sources != NULL ? PCCD_OK : no_memory(error);
    for (uint32_t i = 0; i < frames->sequence.count && status == PCCD_OK; i++) {
        status = open_file(frames, i, &options->wish, error);
    }
    if (status == PCCD_OK) {
        status = name_frames(frames, error);
    }
    if (status == PCCD_OK) {
        status = place_shape(frames, error);
    }
    frames->welded.within = options->weld;
    frames->welded.frame_count = options->first_alone ? 1 : frames->count;
    if (status == PCCD_OK && frames->mesh.is_corners) {
        status = join_corners(frames, error);
    }
    if (status == PCCD_OK && options->weld >= 0) {
        status = weld_shape(frames, options, error);
    }
    return status;
}

/* The shape has its own lists where vertices of the mesh were renamed. */
static void drop_shape(struct ctl_frames *frames)
{
    for (int kind = 0; kind < CTL_KINDS; kind++) {
        uint32_t *vertices = frames->shape.lists[kind].vertices;
        if (vertices != frames->mesh.lists[kind].vertices) {
            free(vertices);
        }
    }
    frames->shape = (struct ctl_mesh){.x = NULL};
}

void ctl_frames_close(struct ctl_frames *frames)
{
    for (uint32_t i = 0; i < frames->source_count; i++) {
        ctl_motion_close(&frames->sources[i].motion);
        ctl_mesh_deinit(&frames->sources[i].held);
    }
    for (uint32_t i = 0; frames->names != NULL && i < frames->count; i++) {
        free(frames->names[i]);
    }
    free(frames->names);
    free(frames->sources);
    drop_shape(frames);
    ctl_mesh_deinit(&frames->mesh);
    ctl_sequence_deinit(&frames->sequence);
    *frames = (struct ctl_frames){.count = 0};
}
