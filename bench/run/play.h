/* bench/run/play.h - the steps of a scene, pass after pass.
 *
 * Room:     bench/run. May include: bench, bench/scenes.
 * Does:     warm up, time every step, keep the pass that took the least; say which
 *           positions it was.
 * Does not: keep frames: each is made when it is wanted, outside of what is timed.
 * Threads:  one.
 */
#ifndef RUN_PLAY_H
#define RUN_PLAY_H

#include "bench_scene.h"
#include "frame.h"
#include "settings.h"

struct run_play {
    const struct run_settings *settings;
    const struct bench_scene *source;
    uint32_t count;           /* of steps that are kept */
    struct run_frame *frames; /* [count]; times of the least pass, counts of the first */
    const char *method;       /* that the steps used */
    const char *cpu;          /* their instruction set */
    char input[33];           /* XXH3-128 of the positions of all steps that are kept */
    char hash[33];            /* of the answers */
};

/* False: an answer was incomplete, or another one than in the first pass; said on
 * stderr. `play` is to be freed either way. */
bool run_play(struct run_play *play, const struct run_settings *settings,
              const struct bench_scene *source);
void run_play_deinit(struct run_play *play);

#endif
