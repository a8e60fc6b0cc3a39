/* near_run.c - meshes in a daemon, and what is near there. */
#include "near_run.h"

#include <math.h>
#include <stdlib.h>

struct question {
    const struct near_run *near;
    void (*page)(void *context, const struct pccd_answer *page); /* or NULL */
    void *context;
    struct pccd_near shown; /* the nearest record so far, or the deepest; .. */
    double distance;        /* .. its own, INFINITY before the first */
    uint64_t vertex;        /* of bounds in its place: the number among all objects' */
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
    struct question *question = context;
    bool is_depth = question->near->settings.what == PCCD_NEAR_DEPTH;
    for (uint64_t i = 0; page->near != NULL && i < page->count; i++) {
        double distance = is_depth ? -page->near[i].d_hi : page->near[i].d_lo;
        if (distance < question->distance) {
            question->distance = distance;
            question->shown = page->near[i];
        }
    }
    for (uint64_t i = 0; page->vertex_bounds != NULL && i < page->count; i++) {
        if (page->vertex_bounds[i] < question->distance) {
            question->distance = page->vertex_bounds[i];
            question->vertex = page->first + i;
        }
    }
    if (question->page != NULL) {
        question->page(question->context, page);
    }
}

/* Name the objects by themselves, so that a place can. */
static int name_objects(struct near_run *near, struct ctl_error *error)
{
    near->names = calloc(near->scene.object_count, sizeof *near->names);
    for (uint32_t i = 0; near->names != NULL && i < near->scene.object_count; i++) {
        near->names[i] = near->scene.objects[i].name;
    }
    near->run.told.names = near->names;
    return near->names != NULL ? PCCD_OK
                               : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
}

/* Return the vertex that has the least bound as a record of it with itself: bounds come
 * by increasing handle. */
static struct pccd_near vertex_of(const struct near_run *near, uint64_t vertex)
{
    struct pccd_near record = {.kind = PCCD_VV};
    for (uint32_t handle = 0;;) {
        const struct scene_object *next = NULL;
        for (uint32_t i = 0; i < near->scene.object_count; i++) {
            const struct scene_object *object = &near->scene.objects[i];
            if (object->handle > handle &&
                (next == NULL || object->handle < next->handle)) {
                next = object;
            }
        }
        if (next == NULL || vertex < next->info.vertex_count) {
            record.object_a = record.object_b = next != NULL ? next->handle : 0;
            record.feature_a = record.feature_b = (uint32_t)vertex;
            return record;
        }
        vertex -= next->info.vertex_count;
        handle = next->handle;
    }
}

/* Say where the record is that is shown. */
static int find_place(struct near_run *near, const struct question *question,
                      struct report_first *place, struct ctl_error *error)
{
    bool is_vertex = near->settings.what == PCCD_NEAR_VERTICES;
    const struct pccd_near vertex = vertex_of(near, question->vertex);
    const struct pccd_near *record = is_vertex ? &vertex : &question->shown;
    const struct pccd_contact contact = {.kind = record->kind,
                                         .object_a = record->object_a,
                                         .object_b = record->object_b,
                                         .feature_a = record->feature_a,
                                         .feature_b = record->feature_b,
                                         .param = {record->param[0], record->param[1]}};
    if (isinf(question->distance) ||
        (is_vertex && question->distance >= near->settings.distance)) {
        return PCCD_OK; /* there is none */
    }
    int status = near->names == NULL ? name_objects(near, error) : PCCD_OK;
    if (status == PCCD_OK) {
        status = check_run_place(&near->run, &near->scene, 0, &contact, place, error);
    }
    place->is_alone = is_vertex;
    place->part[0] = scene_place_of(&near->scene, record->object_a);
    place->part[1] = scene_place_of(&near->scene, record->object_b);
    return status;
}

bool near_asks_touching(const struct near_run *near, struct pccd_near_settings *settings)
{
    *settings = near->settings;
    settings->what = PCCD_NEAR_PAIRS;
    settings->distance = 0;
    return near->settings.what == PCCD_NEAR_CROSSINGS && near->step.is_complete &&
           near->step.answer.verdict == PCCD_VERDICT_YES;
}

const struct pccd_object_settings near_without_thickness = {
    .struct_bytes = sizeof near_without_thickness,
    .what = PCCD_OBJECT_RADIUS | PCCD_OBJECT_REST_DISTANCE | PCCD_OBJECT_REST_RINGS};

static int ask_touching(struct near_run *near, const struct check_ask *ask,
                        const struct pccd_near_settings *settings,
                        struct ctl_error *error)
{
    const struct pccd_near_settings asked = near->settings;
    const uint32_t repeats = near->run.repeats;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < near->scene.object_count && status == PCCD_OK; i++) {
        status = pccd_object_set(near->run.client, near->run.scene,
                                 near->scene.objects[i].handle, &near_without_thickness);
    }
    if (status != PCCD_OK) {
        return check_run_fail(&near->run, status, "no question about what touches",
                              error);
    }
    near->settings = *settings;
    near->run.repeats = 0;
    near->has_touching = true;
    status = check_run_repeat(&near->run, ask, 1, &near->touching, error);
    near->run.repeats = repeats;
    near->settings = asked;
    return status;
}

int near_run_ask(struct near_run *near,
                 void (*page)(void *context, const struct pccd_answer *page),
                 void *context, struct ctl_error *error)
{
    struct question question = {
        .near = near, .page = page, .context = context, .distance = INFINITY};
    const struct check_ask ask = {.once = ask_once,
                                  .page = show_page,
                                  .failed = "it was not answered",
                                  .context = &question};
    struct pccd_near_settings touching;
    int status = check_run_repeat(&near->run, &ask, 1, &near->step, error);
    if (status == PCCD_OK) {
        status = find_place(near, &question, &near->step.first, error);
    }
    if (status == PCCD_OK && near_asks_touching(near, &touching)) {
        question.distance = INFINITY;
        status = ask_touching(near, &ask, &touching, error);
        if (status == PCCD_OK) {
            status = find_place(near, &question, &near->touching.first, error);
        }
    }
    if (status != PCCD_OK) {
        scene_name_objects(&near->scene, error);
    }
    return status;
}

void near_run_deinit(struct near_run *near)
{
    scene_close(&near->scene);
    free(near->names);
    check_run_deinit(&near->run);
}
