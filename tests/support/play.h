/* play.h - fixed sequences of what a client does: objects come, go, move and break. */
#ifndef TESTS_PLAY_H
#define TESTS_PLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "prng.h"

enum play_kind {
    PLAY_SOUP,    /* unconnected triangles, some of them duplicates or degenerate */
    PLAY_TEAR,    /* a sheet that bursts into patches, which fly through each other */
    PLAY_CROWD,   /* many objects, rigid, deforming and standing */
    PLAY_BREAK,   /* an object whose mesh is replaced three times while others move */
    PLAY_TRAFFIC, /* objects come and go beside two that stay */
    PLAY_KINDS
};

enum play_what {
    PLAY_ADD, /* triangles and x0: an object at its registered positions */
    PLAY_REMOVE,
    PLAY_REPLACE, /* triangles and x0, as for PLAY_ADD */
    PLAY_X1,      /* x1 of a range: moves on from where it is */
    PLAY_X0X1,    /* x0 and x1 of a range */
    PLAY_RIGID,   /* m: of a range as registered, rows of [R | t], at both ends */
    PLAY_STEP     /* whoever has not moved since the last one stands still */
};

struct play_act {
    enum play_what what;
    uint32_t object_id;
    bool is_f32;    /* positions are to be sent as floats; they are floats then */
    uint32_t first; /* of what moves: vertices first .. first + vertex_count - 1 */
    uint32_t vertex_count;
    uint32_t triangle_count;
    double (*x0)[3];
    double (*x1)[3];
    uint32_t (*triangles)[3];
    double m[2][12];
};

struct play {
    struct play_act *acts;
    uint32_t act_count;
    uint32_t step_count;
};

const char *play_name(enum play_kind kind);

/* About `triangle_count` triangles at the start. Ends the process where memory ends. */
void play_make(struct play *play, enum play_kind kind, uint32_t triangle_count,
               uint64_t seed);
void play_deinit(struct play *play);

/* A play of up to eight objects at a time in which anything may happen; objects of at
 * most about `triangle_count` triangles. At most 24 steps. */
void play_wild(struct play *play, uint32_t step_count, uint32_t triangle_count,
               uint64_t seed);

#endif
