/* bench/story.c - a scene from its first frame to its last, in several worlds at once.
 *
 * Room:     bench; engine headers.
 * Does:     see story.h.
 * Threads:  one.
 */
#include "story.h"

#define BREAKS 1u /* the object that does */

uint32_t bench_story_steps(const struct bench_story *story)
{
    return story->scene->frame_count - 1;
}

static void begin(struct bench_telling *telling, const struct bench_scene *source,
                  uint32_t step)
{
    telling->source = source;
    bench_frames_init(&telling->frames, source, step);
}

void bench_telling_init(struct bench_telling *telling, const struct bench_story *story,
                        struct bench_world *worlds,
                        const struct eng_scene_settings *settings, uint32_t world_count)
{
    *telling = (struct bench_telling){
        .story = story, .worlds = worlds, .world_count = world_count};
    begin(telling, story->before ? story->before : story->scene, 0);
    for (uint32_t i = 0; i < world_count; i++) {
        bench_world_init(&worlds[i], &telling->frames, &settings[i]);
    }
}

void bench_telling_deinit(struct bench_telling *telling)
{
    for (uint32_t i = 0; i < telling->world_count; i++) {
        bench_world_deinit(&telling->worlds[i]);
    }
    bench_frames_deinit(&telling->frames);
}

void bench_telling_seek(struct bench_telling *telling, uint32_t step)
{
    const struct bench_scene *scene = telling->story->scene;
    if (telling->source != scene && step == scene->break_frame) {
        bench_frames_deinit(&telling->frames);
        begin(telling, scene, step);
        for (uint32_t i = 0; i < telling->world_count; i++) {
            bench_world_replace(&telling->worlds[i], &telling->frames, BREAKS);
        }
    }
    bench_frames_seek(&telling->frames, step);
}
