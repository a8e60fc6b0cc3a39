/* play_actor.h - the objects of a play: meshes of integers, and what may happen to
 * them. */
#ifndef TESTS_PLAY_ACTOR_H
#define TESTS_PLAY_ACTOR_H

#include <stddef.h>

#include "play.h"

#define PLAY_UNIT 0x1p-10 /* of every coordinate; below 2^13 a float holds them all */
#define PLAY_ONE  1024    /* units in a length of 1 */
#define PLAY_ACTS 512u    /* of one play, at most */

/* Piece that a sheet bursts into: squares along a side, vertices, triangles. */
#define PATCH           3u
#define PATCH_CORNERS   ((PATCH + 1) * (PATCH + 1))
#define PATCH_TRIANGLES (2 * PATCH * PATCH)

/* An object as the play knows it. */
struct actor {
    uint32_t id;
    uint32_t vertex_count;
    uint32_t triangle_count;
    double (*x)[3]; /* where it is, or where it was registered */
    uint32_t (*triangles)[3];
    double m[12]; /* of rigid ones: where they are */
};

extern const double play_nowhere[3]; /* 0, 0, 0 */

/* Zeros; ends the process where memory ends. */
void *play_get(size_t count, size_t bytes);

/* A multiple of PLAY_UNIT in -reach .. reach, which is in units; three of them. */
double play_some(struct prng *prng, uint32_t reach);
void play_somewhere(struct prng *prng, uint32_t reach, double x[3]);

/* The least n with n^power >= count; power is 2 or 3. */
uint32_t play_root(uint32_t count, uint32_t power);

/* ---- acts -------------------- */

void play_begin(struct play *play);
struct play_act *play_push(struct play *play, enum play_what what, uint32_t object_id);
/* It comes, or takes another shape. */
void play_push_mesh(struct play *play, enum play_what what, const struct actor *actor);
/* It has come to actor->x. */
void play_push_x1(struct play *play, const struct actor *actor, bool is_f32);
/* From actor->m to m1, which actor->m becomes. */
void play_push_rigid(struct play *play, struct actor *actor, const double m1[12]);
/* It starts somewhere else than where it was, up to `reach` units away. */
void play_push_jump(struct play *play, struct actor *actor, uint32_t reach,
                    struct prng *prng);

/* ---- actors -------------------- */

void actor_init(struct actor *actor, uint32_t id, uint32_t vertex_count,
                uint32_t triangle_count);
void actor_deinit(struct actor *actor);

/* A bumpy sheet of about `count` triangles around `centre`; squares of `cell` units, a
 * multiple of 4. It rises by a quarter along x, so that sheets cross in lines. */
void actor_sheet(struct actor *actor, uint32_t id, uint32_t count, uint32_t cell,
                 const double centre[3], struct prng *prng);
/* Unconnected triangles around 0, some of them duplicates, repeated or degenerate. */
void actor_soup(struct actor *actor, uint32_t id, uint32_t count, struct prng *prng);
/* A flat sheet of at least `count` triangles in patches, a sixty-fourth apart. */
void actor_patches(struct actor *actor, uint32_t id, uint32_t count, struct prng *prng);

/* Move every vertex by up to `reach` units along each axis, and all of them by `way`. */
void actor_shake(struct actor *actor, const double way[3], uint32_t reach,
                 struct prng *prng);
/* A quarter turn of a patch about z (spin 1) or x (2) around its first corner. */
void actor_turn_patch(struct actor *actor, uint32_t patch, uint32_t spin);
/* The same positions, but `share` of 8 triangles get vertices of their own, a little off
 * where they were. */
void actor_crack(struct actor *actor, uint32_t share, struct prng *prng);
/* Every second triangle is lost; its vertices stay, some of them in no triangle. */
void actor_crumble(struct actor *actor);

/* A quarter turn about any axis or none, then to `to`. */
void play_some_matrix(double m[12], const double to[3], struct prng *prng);
/* A rigid step about `home`, sheared by sixteenths: products of so few bits that a double
 * holds them. */
void play_move_rigid(struct play *play, struct actor *actor, const double home[3],
                     struct prng *prng);

#endif
