/* play.h - runs and times the steps of a scene, several passes over.
 *
 * Threads: one.
 */
#ifndef RUN_PLAY_H
#define RUN_PLAY_H

#include "bench_scene.h"
#include "frame.h"
#include "report.h"
#include "settings.h"

/* What the steps of one side were. */
struct run_sequence {
    const struct bench_scene *source; /* of which its steps are */
    struct bench_scene partial; /* that scene, where this side is the first of it and not
                                   all moves as it is told */
    struct run_frame *frames; /* [count]; times of the least pass, counts of the first */
    const char *method;       /* that the steps used */
    const char *cpu;          /* their instruction set */
    /* Of every step of every pass: how many times as long the first side took. */
    struct bench_samples speed[RUN_TIMES];
};

struct run_play {
    const struct run_settings *settings;
    const struct bench_scene *source;         /* as it is told */
    uint32_t count;                           /* of steps that are kept */
    struct run_sequence sides[RUN_SIDES_MAX]; /* [settings->side_count] */
    char input[33]; /* XXH3-128 of the positions of all steps that are kept */
    char hash[PROTO_HASH_BYTES]; /* of the first side's answers */
};

/* False: an answer was incomplete, or another one than in the first pass; said on
 * stderr. `play` is to be freed either way. */
bool run_play(struct run_play *play, const struct run_settings *settings,
              const struct bench_scene *source);
void run_play_deinit(struct run_play *play);

#endif
