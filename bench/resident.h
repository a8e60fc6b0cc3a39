/* resident.h - puts a benchmark scene into the engine. */
#ifndef BENCH_RESIDENT_H
#define BENCH_RESIDENT_H

#include "near.h"
#include "step.h"
#include "workload.h"

/* Call first, with main's argv: waiting threads of a team spin 2000 times and then sleep,
 * as in the daemon. The runtime reads its environment before main, so the program starts
 * anew with it; a GOMP_SPINCOUNT that is set already stands. */
void bench_team_environment(char **argv);

struct bench_world {
    const struct bench_scene *source;
    struct eng_scene *scene;
    uint32_t *object_idx; /* [source->object_count] */
    uint32_t frame;       /* where it stands */
};

/* Register and add everything at the start positions of `frames`; objects get the ids
 * BENCH_OBJECT_ID(0), .. `settings` NULL: the
 * defaults. Exits with 2 when the engine refuses: there is
 * nothing to measure then. */
void bench_world_init(struct bench_world *world, const struct bench_frames *frames,
                      const struct eng_scene_settings *settings);
void bench_world_deinit(struct bench_world *world);

/* Give the object that has broken since the last step its new mesh, at the start
 * positions of `frames`, where the scene that is told has one. A step does so if nobody
 * has. */
void bench_world_follow(struct bench_world *world, const struct bench_frames *frames);

/* All contacts or what the mode says, of one thread, none left out, by the
 * method paper. */
struct eng_question bench_step_settings(enum pccd_mode mode);

/* Step from the start to the end of `frames`: by end positions alone where the scene
 * stands there, by both ends otherwise. */
void bench_world_step(struct bench_world *world, const struct bench_frames *frames,
                      const struct eng_question *settings,
                      struct eng_step_result *result);

/* Ask what is near where the scene stands; with `moves` at the start of `frames`, to
 * which this very request moves it. */
void bench_world_near(struct bench_world *world, const struct bench_frames *frames,
                      bool moves, const struct eng_question *settings,
                      struct eng_step_result *result);

#endif
