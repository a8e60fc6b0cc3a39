/* way.h - the ways to have a step computed that pccd-bench compares: in the engine, by
 * libpccd without a daemon, by a daemon.
 *
 * Threads: one.
 */
#ifndef RUN_WAY_H
#define RUN_WAY_H

#include <stdbool.h>

#include "bench_scene.h"
#include "frame.h"
#include "settings.h"

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

/* Of a process, from /proc; RUN_UNKNOWN where it is not to be had. */
uint64_t run_resident_bytes(uint32_t pid);

#endif
