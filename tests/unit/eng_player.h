/* eng_player.h - performs a play (tests/support/play.h) in the engine. */
#ifndef TEST_ENG_PLAYER_H
#define TEST_ENG_PLAYER_H

#include "eng_filters.h"
#include "eng_kit.h"
#include "play.h"
#include "step.h"

#define PLAYER_OBJECTS_MAX 32u
#define PLAYER_JOINTS      3u

struct player_object {
    uint32_t id;
    uint32_t idx; /* in the scene */
    uint32_t vertex_count;
    uint32_t triangle_count;
    struct eng_mesh *mesh;
    double (*registered)[3];
    double (*x0)[3]; /* the motion of the step that is being staged or was last taken */
    double (*x1)[3];
    uint32_t (*triangles)[3];
    double *radii; /* of vertices: as the mesh has them, or the object's own */
    struct eng_object_thickness thickness;
    uint32_t joint; /* on which it turns in the step; PCCD_NO_JOINT: it goes straight */
};

struct player {
    struct eng_scene *scene;
    struct player_object objects[PLAYER_OBJECTS_MAX];
    uint32_t object_count;
    struct filters filters;
    bool is_staging;
    struct prng *radii_from; /* meshes that come have radii from it; NULL: none */
    struct prng *turns_from; /* what moves rigidly turns on joints from it; NULL: none */
    struct pccd_joint joints[PLAYER_JOINTS]; /* of the step */
    bool has_joints;
    uint32_t joint_base; /* of what is staged */
};

/* An empty scene; `settings` NULL: the defaults. */
void player_init(struct player *player, const struct eng_scene_settings *settings);
void player_deinit(struct player *player);

/* Perform any act but PLAY_STEP; the first motion of a step opens the staging. */
void player_act(struct player *player, const struct play_act *act);

/* Change groups, masks, ignored pairs and self-collision at random. */
void player_draw_filters(struct player *player, struct prng *prng);

/* Some object becomes thicker or thinner, or other pairs of it are left thin. */
void player_draw_thickness(struct player *player, struct prng *prng);

/* Open the staging if it is not yet: what does not move from here on stands still. */
void player_open(struct player *player);

/* Step with what is staged. Returns what eng_step returns. */
int player_step(struct player *player, const struct eng_question *settings,
                struct eng_step_result *result);

/* Stage both ends of everything, in place of what is staged: the motion of the copies. */
void player_stage_copies(struct player *player);

/* Forget what is staged; the copies keep it. The scene stays where it was. */
void player_drop(struct player *player);

/* Another scene with the same objects, added in another order, and the same motion
 * staged. */
void player_copy(const struct player *player, const struct eng_scene_settings *settings,
                 struct player *copy);

/* Other steps before the one that is being staged, which has to be staged again
 * (player_stage_copies): all the way back from its end to its start; or every object's
 * vertices to each other's places, which tears any hierarchy apart and may take long:
 * give it a deadline. */
void player_go_back(struct player *player, const struct eng_question *settings);
void player_scramble(struct player *player, const struct eng_question *settings);

#endif
