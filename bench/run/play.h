/* play.h - the ways to have a step computed, and a run of timed steps by one of them. */
#ifndef RUN_PLAY_H
#define RUN_PLAY_H

#include <stdbool.h>

#include "bench_scene.h"
#include "frame.h"
#include "report.h"
#include "settings.h"

/* ---- The ways to have a step computed that pccd-bench compares: in the engine, by
 * libpccd without a daemon, by a daemon. */

struct run_asked; /* of one way */

struct run_way {
    /* A new scene with all objects, where `frames` begins. What fails ends the program
     * with 2. */
    struct run_asked *(*open)(const struct run_side *side,
                              const struct bench_frames *frames);
    /* From the start to the end of `frames`; by end positions alone where the scene
     * stands there. Sets everything of *frame but its number. False: incomplete. */
    bool (*step)(struct run_asked *asked, const struct bench_frames *frames,
                 struct run_frame *frame);
    /* Which method steps use, and which instruction set; "" as long as that is not
     * known. Live as long as the program. */
    const char *(*method)(const struct run_asked *asked);
    const char *(*cpu)(const struct run_asked *asked);
    void (*close)(struct run_asked *asked);
};

extern const struct run_way run_way_engine;
extern const struct run_way run_way_client; /* daemon and direct */

/* Return the resident memory of a process, from /proc; RUN_UNKNOWN where it is not to be
 * had. */
uint64_t run_resident_bytes(uint32_t pid);

/* The length that is added to all radii. */
double run_separation(const struct run_side *side, const struct bench_frames *frames);

/* Steps of one side. */
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
