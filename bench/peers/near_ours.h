/* near_ours.h - what the engine says is near, under the names of the libraries.
 *
 * Threads: one asks; a team answers.
 */
#ifndef NEAR_OURS_H
#define NEAR_OURS_H

#include "near_judge.h"
#include "swept.h"

/* A scene at its hard frame, which has made a step to the end of that by the method
 * `paper`; and its start, as other libraries take it. */
struct near_scene {
    struct bench_frames frames;
    struct bench_world world;
    struct peer_input features;
    struct near_input input;
};

void near_scene_init(struct near_scene *scene, const struct bench_scene *source);
void near_scene_deinit(struct near_scene *scene);

struct near_ours {
    struct near_answers answers;
    struct near_bracket *brackets; /* of each pair */
};

/* Settings of a question, by the method `wide`. */
struct eng_question near_ours_settings(enum pccd_near_what what, double d,
                                       uint32_t threads);

/* The world has made a step by the method `paper`, and stands at the start of `frames` or
 * at its end; it stands at the start afterwards. */
void near_ours_ask(struct near_ours *ours, struct bench_world *world,
                   const struct bench_frames *frames, double d);
void near_ours_free(struct near_ours *ours);

#endif
