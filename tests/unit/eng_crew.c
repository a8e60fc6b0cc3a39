/* eng_crew.c - a scene for more than one thread, and the teams to try on it. */
#include "eng_crew.h"

#include "trees.h"

#define SHEET_SIDE 30u

static const uint32_t sizes[] = {2, 3, 4, 8, 16};
#define SIZE_COUNT (sizeof sizes / sizeof *sizes)

static const struct {
    enum eng_scheduler scheduler;
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
} ways[] = {
    {ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN},
    {ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_PAPER},
    {ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN},
    {ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_PAPER},
    {ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_DISJOINT, ENG_REFIT_EVEN},
    {ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_DISJOINT, ENG_REFIT_PAPER},
};
#define WAY_COUNT (sizeof ways / sizeof *ways)

int crew_setup(void **state)
{
    struct crew *crew = test_room(sizeof *crew);
    struct prng random = {97};
    crew->scene = kit_scene();
    struct eng_mesh *mesh = kit_sheet(SHEET_SIDE, 0.5);
    crew->sheet = kit_add(crew->scene, mesh, 2);
    mesh = kit_soup(&random, CREW_SOUP_TRIANGLES);
    crew->soup = kit_add(crew->scene, mesh, 1);
    const struct eng_object *object = eng_scene_object(crew->scene, crew->soup);
    for (uint32_t i = 0; i < CREW_SOUP_VERTICES; i++) {
        for (int k = 0; k < 3; k++) {
            double x = crew->scene->x[crew->scene->now][object->vertices.first + i][k];
            crew->x0[i][k] = x;
            crew->x1[i][k] = x + prng_between(&random, -0.05, 0.05);
        }
    }
    *state = crew;
    return 0;
}

int crew_teardown(void **state)
{
    struct crew *crew = *state;
    eng_scene_free(crew->scene);
    free(crew);
    return 0;
}

struct eng_step_result crew_run(struct crew *crew, struct eng_question settings)
{
    settings.team_always = true;
    eng_stage_begin(crew->scene);
    assert_ok(eng_stage_x0x1(crew->scene, crew->soup, PCCD_FORMAT_F64, 0,
                             CREW_SOUP_VERTICES, crew->x0, crew->x1));
    struct eng_step_result result = kit_step(crew->scene, &settings);
    assert_true(eng_tree_validate(crew->scene));
    return result;
}

struct eng_question crew_alone(enum pccd_mode mode)
{
    struct eng_question settings = kit_contacts(mode, PCCD_METHOD_DEFAULT);
    settings.method = PCCD_METHOD_PAPER;    /* whose schedulers are compared */
    settings.tuning.still = ENG_STILL_ANEW; /* steps of a scene at rest are whole */
    return settings;
}

size_t crew_count(void)
{
    return SIZE_COUNT * WAY_COUNT;
}

struct eng_question crew_team(enum pccd_mode mode, size_t i)
{
    struct eng_question settings = crew_alone(mode);
    settings.threads = sizes[i % SIZE_COUNT];
    settings.tuning.scheduler = ways[i / SIZE_COUNT].scheduler;
    settings.tuning.high_level = ways[i / SIZE_COUNT].high_level;
    settings.tuning.refit = ways[i / SIZE_COUNT].refit;
    return settings;
}
