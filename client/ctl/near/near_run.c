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
        scene_name_objects(&near->scene, error);
    }
    return status;
}

void near_run_deinit(struct near_run *near)
{
    scene_close(&near->scene);
    check_run_deinit(&near->run);
}
