/* eng_stir.h - what may happen to a scene in which most things stand.
 *
 * Make scenes with contacts at rest, within objects and between them, near the origin and
 * far from it; change them at random between steps; stage motions of nothing, of a few
 * vertices, of some objects, of the same once more, of everything. Every coordinate is a
 * multiple of PLAY_UNIT.
 */
#ifndef TEST_ENG_STIR_H
#define TEST_ENG_STIR_H

#include "eng_player.h"
#include "prng.h"

#define STIR_OBJECTS_MAX 6u
#define STIR_TINY        12u /* triangles of an object: few enough for exact arithmetic */

struct stir {
    struct player player;
    struct prng prng;
    double far[2][3];        /* where objects are: around the one or the other */
    uint32_t triangle_count; /* of an object, at most about */
    uint32_t failures;       /* attempts that had to fail, and did */
    bool is_closed;          /* objects that come are closed surfaces */
};

/* Draw how the trees of a scene are kept. */
struct eng_scene_settings stir_draw_scene(struct prng *prng);
/* Triangles of its objects: STIR_TINY in most scenes; in so many of 100 enough for trees
 * of several levels in the method `wide`. */
uint32_t stir_draw_size(struct prng *prng, uint32_t large_percent);

/* A scene of a few objects; nothing is staged. */
void stir_init(struct stir *stir, const struct eng_scene_settings *settings,
               uint32_t triangle_count, uint64_t seed);
void stir_deinit(struct stir *stir);

/* Objects come, go and are replaced, other ones may meet; often nothing of this. */
void stir_change(struct stir *stir);

/* Attempts that fail after some of them has been done: the scene is as it was. Nothing
 * may be staged. */
void stir_fail(struct stir *stir);

/* Stage the next motion. */
void stir_move(struct stir *stir);

/* Parts of these, for who wants one thing alone. */

/* Another object, of a kind drawn at random. */
void stir_add(struct stir *stir);
void stir_remove(struct stir *stir, uint32_t at);
void stir_replace(struct stir *stir, uint32_t at);

#endif
