/* eng_crew.h - a scene for several threads, and the team settings to try on it.
 *
 * Threads: up to sixteen, whatever the machine has.
 */
#ifndef TEST_ENG_CREW_H
#define TEST_ENG_CREW_H

#include "eng_kit.h"

#include "step.h"
#include "world.h"

#define CREW_SOUP_TRIANGLES 1500u
#define CREW_SOUP_VERTICES  (3 * CREW_SOUP_TRIANGLES)

struct crew {
    struct eng_scene *scene;
    uint32_t sheet; /* indices of the objects: the one that stands still, */
    uint32_t soup;  /* the one that moves */
    double x0[CREW_SOUP_VERTICES][3];
    double x1[CREW_SOUP_VERTICES][3];
};

int crew_setup(void **state);
int crew_teardown(void **state);

/* Stage the step and run it, by as many threads as the settings say, whether it pays or
 * not; the tree must be a tree afterwards. */
struct eng_step_result crew_run(struct crew *crew, struct eng_question settings);

/* One thread. */
struct eng_question crew_alone(enum pccd_mode mode);

/* Team `i` of crew_count(): every number of threads by every scheduler, method of
 * high-level nodes and scheme of the refit. */
struct eng_question crew_team(enum pccd_mode mode, size_t i);
size_t crew_count(void);

#endif
