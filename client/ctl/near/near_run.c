/* near_run.c - meshes in a daemon, and what is near there. */
#include "near_run.h"

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
    struct question question = {near, page, context};
    const struct check_ask ask = {.once = ask_once,
                                  .page = page != NULL ? show_page : NULL,
                                  .failed = "it was not answered",
                                  .context = &question};
    struct pccd_near_settings touching;
    int status = check_run_repeat(&near->run, &ask, 1, &near->step, error);
    if (status == PCCD_OK && near_asks_touching(near, &touching)) {
        status = ask_touching(near, &ask, &touching, error);
    }
    if (status != PCCD_OK) {
        scene_name_objects(&near->scene, error);
    }
    return status;
}

void near_run_deinit(struct near_run *near)
{
    scene_close(&near->scene);
    check_run_deinit(&near->run);
}
