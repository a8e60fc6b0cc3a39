/* bench/story.h - a scene from its first frame to its last, in several worlds at once.
 *
 * Room:     bench; engine headers.
 * Does:     make each frame once for all worlds; change the topology where the scene
 *           breaks.
 * Does not: step the worlds: what is compared there is the caller's.
 * Threads:  one.
 */
#ifndef BENCH_STORY_H
#define BENCH_STORY_H

#include "resident.h"

/* What is told. With `before`, that scene up to scene->break_frame, when its object 1 is
 * replaced by the one of `scene`. */
struct bench_story {
    const char *name;
    const struct bench_scene *scene;
    const struct bench_scene *before; /* NULL: none */
};

struct bench_telling {
    const struct bench_story *story;
    const struct bench_scene *source; /* that is told at the moment */
    struct bench_frames frames;       /* the step that is told */
    struct bench_world *worlds;       /* [world_count] */
    uint32_t world_count;
};

uint32_t bench_story_steps(const struct bench_story *story);

/* Every world with its own settings; it and the story must outlive the telling. */
void bench_telling_init(struct bench_telling *telling, const struct bench_story *story,
                        struct bench_world *worlds,
                        const struct eng_scene_settings *settings, uint32_t world_count);
void bench_telling_deinit(struct bench_telling *telling);

/* To step 0 .. bench_story_steps - 1, the same as before or the next one. */
void bench_telling_seek(struct bench_telling *telling, uint32_t step);

#endif
