/* near_run.c - meshes in a daemon, and what is near there. */
#include "near_run.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "shown.h"

int near_run_read(struct near_run *near, char *const *paths, uint32_t path_count,
                  struct ctl_error *error)
{
    int status = PCCD_OK;
    near->objects = calloc(path_count, sizeof *near->objects);
    if (near->objects == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for %" PRIu32 " files",
                             path_count);
    }
    near->object_count = path_count;
    for (uint32_t i = 0; i < path_count && status == PCCD_OK; i++) {
        struct near_object *object = &near->objects[i];
        object->path = paths[i];
        status = ctl_frames_read_one(paths[i], &near->run.ask->frames, &object->mesh,
                                     &object->welded, &object->frame_count, error);
    }
    return status;
}

static int fetch_edges(const struct near_run *near, struct near_object *object,
                       uint32_t mesh, struct ctl_error *error)
{
    uint32_t count = object->info.edge_count;
    object->edges = malloc(((size_t)count + 1) * sizeof *object->edges);
    if (object->edges == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for %" PRIu32 " edges",
                             count);
    }
    int status = pccd_mesh_edges(near->run.client, mesh, object->edges, count);
    return status == PCCD_OK ? status
                             : check_run_fail(&near->run, status, "edges", error);
}

static int add(struct near_run *near, struct near_object *object, bool with_edges,
               struct ctl_error *error)
{
    struct check_run *run = &near->run;
    struct ctl_mesh *mesh = &object->mesh;
    char what[512];
    uint32_t handle = 0;
    uint64_t begin_ns = common_now_ns();
    int status = check_run_put_mesh(run->client, mesh, &handle, &object->info);
    if (status == PCCD_OK) {
        status = pccd_scene_add(run->client, run->scene, handle, &object->handle);
    }
    if (status == PCCD_OK) {
        status = ask_set_object(run->ask, run->client, run->scene, object->handle);
    }
    if (status != PCCD_OK) {
        snprintf(what, sizeof what, "%s was not accepted", tool_shown(object->path));
        return check_run_fail(run, status, what, error);
    }
    run->mesh.build_ms += (double)(common_now_ns() - begin_ns) / 1e6;
    free(mesh->x);
    mesh->x = NULL;
    return with_edges ? fetch_edges(near, object, handle, error) : PCCD_OK;
}

int near_run_begin(struct near_run *near, bool with_edges, struct ctl_error *error)
{
    struct check_run *run = &near->run;
    int status = check_run_times(run, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = pccd_scene_create(run->client, NULL, &run->scene);
    if (status != PCCD_OK) {
        return check_run_fail(run, status, "no scene", error);
    }
    for (uint32_t i = 0; i < near->object_count && status == PCCD_OK; i++) {
        status = add(near, &near->objects[i], with_edges, error);
    }
    return status;
}

struct question {
    const struct near_run *near;
    void (*page)(void *context, const struct pccd_answer *page);
    void *context;
};

static int ask_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct question *question = context;
    const struct near_run *near = question->near;
    (void)is_again;
    return pccd_ask_near(near->run.client, near->run.scene, NULL, 0, &near->settings,
                         answer);
}

static void show_page(void *context, const struct pccd_answer *page)
{
    const struct question *question = context;
    question->page(question->context, page);
}

void near_run_name_files(const struct near_run *near, struct ctl_error *error)
{
    for (uint32_t i = 0; i < near->object_count; i++) {
        struct ctl_error named = {.text = ""};
        char word[32];
        int length =
            snprintf(word, sizeof word, "object 0x%" PRIx32, near->objects[i].handle);
        const char *at = strstr(error->text, word);
        if (at != NULL && !isxdigit((unsigned char)at[length])) {
            (void)ctl_error_set(&named, PCCD_OK, "%.*s%s%s", (int)(at - error->text),
                                error->text, near->objects[i].path, at + length);
            *error = named;
        }
    }
}

int near_run_ask(struct near_run *near,
                 void (*page)(void *context, const struct pccd_answer *page),
                 void *context, struct ctl_error *error)
{
    struct question question = {near, page, context};
    const struct check_ask ask = {.once = ask_once,
                                  .page = page != NULL ? show_page : NULL,
                                  .failed = "it was not answered",
                                  .context = &question};
    int status = check_run_repeat(&near->run, &ask, 1, &near->step, error);
    if (status != PCCD_OK) {
        near_run_name_files(near, error);
    }
    return status;
}

uint32_t near_run_place(const struct near_run *near, uint32_t handle)
{
    uint32_t i = 0;
    while (i < near->object_count && near->objects[i].handle != handle) {
        i++;
    }
    return i;
}

void near_run_deinit(struct near_run *near)
{
    for (uint32_t i = 0; i < near->object_count; i++) {
        ctl_mesh_deinit(&near->objects[i].mesh);
        free(near->objects[i].edges);
    }
    free(near->objects);
    check_run_deinit(&near->run);
    near->objects = NULL;
    near->object_count = 0;
}
