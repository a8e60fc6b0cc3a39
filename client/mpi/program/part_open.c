/* part_open.c - opens the files of a mesh on all ranks. */
#include "part.h"

#include <stdlib.h>
#include <sys/stat.h>

#include "check_run.h"
#include "scene.h"
#include "together.h"

#define COMPARED 6u /* numbers */

/* ---- the same files on all ranks --------------------------------------------------- */

/* Collective: whether numbers of files or meshes are the same on all ranks. */
static int compare(const uint32_t numbers[COMPARED], const char *path,
                   struct ctl_error *error)
{
    return together_compare(numbers, COMPARED * sizeof *numbers, path,
                            " and what follows: other files", error);
}

static int compare_meshes(const struct ctl_frames *files, uint32_t vertex_total,
                          struct ctl_error *error)
{
    const struct ctl_mesh *shape = &files->mesh;
    const uint32_t numbers[COMPARED] = {files->count,           vertex_total,
                                        shape->points.total,    shape->edges.total,
                                        shape->triangles.total, shape->object_count};
    return compare(numbers, shape->path, error);
}

static int judge_file(const char *path, bool *is_whole, struct ctl_error *error)
{
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s is a pipe, which can be read once, and each rank reads "
                             "it; pccdctl reads it",
                             path);
    }
    *is_whole = *is_whole || ctl_mesh_holds(path) != CTL_HOLDS_MESH;
    return PCCD_OK;
}

/* The files, to part->files.sequence, and how they are read. */
static int list_files(struct part *part, char *const *paths, uint32_t path_count,
                      struct ctl_error *error)
{
    struct ctl_sequence *files = &part->files.sequence;
    int status = ctl_sequence_expand(files, paths, path_count, error);
    for (uint32_t i = 0; i < files->count && status == PCCD_OK; i++) {
        status = judge_file(files->paths[i], &part->is_whole, error);
    }
    status = together_agree(status, error);
    const uint32_t numbers[COMPARED] = {files->count, part->is_whole};
    return status == PCCD_OK ? compare(numbers, paths[0], error) : status;
}

/* ---- what names features ----------------------------------------------------------- */

static int find_edges(struct part *part, const struct ctl_mesh *mesh,
                      struct ctl_error *error)
{
    const struct pccd_options options = {
        .struct_bytes = sizeof options, .url = "direct:", .no_keep = true};
    struct pccd_client *client = NULL;
    uint32_t handle = 0;
    struct pccd_mesh_info info;
    int status = pccd_connect(&options, &client);
    if (status == PCCD_OK) {
        status = scene_put_mesh(client, mesh, &handle, &info);
    }
    if (status == PCCD_OK) {
        part->edge_count = info.edge_count;
        part->edges = malloc(((size_t)info.edge_count + 1) * sizeof *part->edges);
        status = part->edges == NULL
                     ? PCCD_E_NOMEM
                     : pccd_mesh_edges(client, handle, part->edges, info.edge_count);
    }
    if (status != PCCD_OK) {
        (void)ctl_error_set(error, status, "edges: %s", pccd_status_text(status));
    }
    pccd_close(client);
    return status;
}

/* On the root: the first file, all of it; `to` as part_weld has it. */
static int read_named(struct part *part, const uint32_t *to, struct ctl_error *error)
{
    struct ctl_frames whole = {.count = 0};
    uint32_t *objects = NULL;
    int status = ctl_mesh_read(part->files.mesh.path, &whole.mesh, error);
    if (status == PCCD_OK && to != NULL) {
        whole.shape = whole.mesh;
        objects = ctl_mesh_object_of_vertices(&whole.mesh);
        status = objects != NULL ? ctl_frames_rename(&whole, to, error)
                                 : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    for (uint32_t i = 0; objects != NULL && i < whole.mesh.vertex_count; i++) {
        part->files.welded.between += objects[i] != objects[to[i]];
    }
    free(objects);
    if (status == PCCD_OK) {
        part->named = whole.mesh;
        whole.mesh = (struct ctl_mesh){.x = NULL};
    }
    ctl_frames_close(&whole);
    return status;
}

/* ---- opening ----------------------------------------------------------------------- */

static bool names_features(const struct part *part, const struct part_options *options)
{
    const struct ctl_mesh *shape = &part->files.mesh;
    return options->names_features ||
           (options->names_objects && shape->object_count > 0 && !objects_are_one(shape));
}

/* All of the files, as pccdctl opens them. */
static int open_whole(struct part *part, char *const *paths, uint32_t path_count,
                      const struct part_options *options, struct ctl_error *error)
{
    struct ctl_frames *files = &part->files;
    ctl_sequence_deinit(&files->sequence);
    int status = ctl_frames_open(files, paths, path_count, &options->frames, error);
    if (status == PCCD_OK && together_is_root() && names_features(part, options)) {
        part->named = files->mesh;
        status = find_edges(part, &files->mesh, error);
    }
    status = together_agree(status, error);
    return status == PCCD_OK ? compare_meshes(files, files->mesh.vertex_count, error)
                             : status;
}

/* The parts that ranks have of a shape are joined, and on the root all of it. */
static int join(struct part *part, const struct part_options *options,
                struct ctl_error *error)
{
    struct ctl_frames *files = &part->files;
    struct ctl_welded *welded = &files->welded;
    uint32_t *to = NULL;
    welded->within = options->frames.weld;
    welded->frame_count = options->frames.first_alone ? 1 : files->count;
    int status = options->frames.weld >= 0
                     ? part_weld(part, options->frames.weld, &to, error)
                     : PCCD_OK;
    if (status == PCCD_OK && to != NULL) {
        status = ctl_frames_rename(files, to, error);
        together_add(&welded->flat);
    }
    bool has_names = names_features(part, options);
    bool is_named = has_names || (welded->joined > 0 && files->mesh.object_count > 1);
    if (status == PCCD_OK && together_is_root() && is_named) {
        status = read_named(part, to, error);
    }
    if (status == PCCD_OK && together_is_root() && has_names) {
        status = find_edges(part, &part->named, error);
    }
    free(part->named.x);
    part->named.x = NULL;
    free(to);
    return together_agree(status, error);
}

/* Open a part of each file, by the rank's number. */
static int open_parts(struct part *part, const struct part_options *options,
                      struct ctl_error *error)
{
    struct ctl_frames *files = &part->files;
    files->count = files->sequence.count;
    files->names = files->sequence.paths;
    const struct ctl_reading reading = {.number = (uint32_t)together_rank(),
                                        .count = (uint32_t)together_size()};
    int status = together_agree(
        ctl_mesh_read_as(files->names[0], &reading, &files->mesh, error), error);
    files->shape = files->mesh;
    if (status == PCCD_OK) {
        status = compare_meshes(files, files->mesh.part.vertex_total, error);
    }
    return status == PCCD_OK ? join(part, options, error) : status;
}

int part_open(struct part *part, char *const *paths, uint32_t path_count,
              const struct part_options *options, struct ctl_error *error)
{
    *part = (struct part){.is_whole = false};
    int status = list_files(part, paths, path_count, error);
    if (status != PCCD_OK) {
        return status;
    }
    return part->is_whole ? open_whole(part, paths, path_count, options, error)
                          : open_parts(part, options, error);
}
