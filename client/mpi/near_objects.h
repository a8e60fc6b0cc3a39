/* near_objects.h - what is asked of objects two by two, over ranks. */
#ifndef RANKS_NEAR_OBJECTS_H
#define RANKS_NEAR_OBJECTS_H

#include "boxes.h"
#include "world.h"

/* ---- A question about some leaves alone, in a scene of their own.
 *
 * The meshes of such a scene are parts of the whole ones, numbered in the same order. So
 * of equally near pairs the first one is the same, and so is all that a record says. */

/* A leaf of an object, by its place in world->objects, and where its corners are. */
struct ranks_remote_leaf {
    uint32_t object;
    bool is_ghost; /* no feature of it is this rank's, whatever leaf.owns says */
    struct ranks_leaf leaf;
    double x[3][3];
};

struct ranks_side_scene {
    struct ranks_object *objects; /* [object_count]: mesh, leaves and local numbers */
    double (**x)[3];              /* [object_count]: of local vertices */
    struct pccd_near *records;    /* sorted; with handles and numbers of the whole */
    uint64_t count;
    struct pccd_answer answer; /* without records */
};

/* Collective. Ask about leaves in a scene of their own; each rank has its own leaves: in
 * any order, some twice perhaps. A vertex or edge is this rank's if any of its leaves
 * that is no ghost owns it. `near` says what is asked, with handles of the world; `end`
 * is not looked at. Objects are as thick as in the world, where that matters. */
int ranks_side_scene_ask(struct pccd_mpi *world, const struct ranks_remote_leaf *leaves,
                         uint64_t count, const struct pccd_near_settings *near,
                         struct ranks_side_scene *side);
/* Add to the last of several answers the work of an earlier one, and whether that was cut
 * short. */
void ranks_side_scene_add(struct ranks_side_scene *last,
                          const struct ranks_side_scene *earlier);
void ranks_side_scene_deinit(const struct pccd_mpi *world, struct ranks_side_scene *side);

/* Find a leaf of the answer's scene that has a feature of `points` vertices. */
void ranks_side_scene_find(const struct ranks_side_scene *side, uint32_t object,
                           uint32_t points, uint32_t feature,
                           struct ranks_remote_leaf *remote);
/* Find where a vertex of an object, by its handle, is in the answer's scene. */
void ranks_side_scene_vertex(const struct pccd_mpi *world,
                             const struct ranks_side_scene *side, uint32_t handle,
                             uint32_t vertex, double x[3]);
/* Refuse meshes that have more than triangles, down which searches go: of several the one
 * of the object with the lowest handle is named. PCCD_E_INVAL. */
int ranks_check_triangles(struct pccd_mpi *world, const struct pccd_near_settings *near);

/* Collective. Answer for where objects begin or end by object->from and object->to, to
 * world->records and *answer. Errors: those of pccd_ask_near. */
int ranks_near_of_objects(struct pccd_mpi *world, const struct pccd_near_settings *near,
                          struct pccd_answer *answer);

/* ---- for nearest.c and depth.c ----------------------------------------------------- */

/* A question and where everything is. */
struct ranks_pairing {
    struct pccd_mpi *world;
    const struct pccd_near_settings *near;
    double (**x)[3];          /* [object_count]: of local vertices */
    struct ranks_boxes boxes; /* around own leaves */
};

/* Return whether the question is about these two objects, by their places. */
bool ranks_is_asked(const struct ranks_pairing *pairing, uint32_t a, uint32_t b);
bool ranks_is_asked_with_any(const struct ranks_pairing *pairing, uint32_t a);
/* Set *near to the question as it is asked of a part of the scene, with the time that is
 * left. */
void ranks_ask_rest(const struct ranks_pairing *pairing, struct pccd_near_settings *near);

/* Leaves that a question is asked of. */
struct ranks_wanted {
    struct ranks_remote_leaf *leaves;
    uint64_t leaf_count, leaf_capacity;
    struct ranks_block *boxes; /* leaves of box.object that meet it are wanted, too */
    uint64_t box_count, box_capacity;
};
/* Add own leaves of a block, in this rank alone. PCCD_E_NOMEM. */
int ranks_want_own(const struct ranks_pairing *pairing, const struct ranks_block *block,
                   struct ranks_wanted *wanted);
/* Add a box, in this rank alone. PCCD_E_NOMEM. */
int ranks_want(struct pccd_mpi *world, const float box[6], uint32_t object,
               struct ranks_wanted *wanted);
/* Collective. Add what meets the boxes, of all ranks; then there are no boxes. */
int ranks_want_all(const struct ranks_pairing *pairing, bool are_ghosts,
                   struct ranks_wanted *wanted);
void ranks_wanted_deinit(struct ranks_wanted *wanted);

/* Collective. Set *side to the answer, each record on one rank: of DEPTH the one that has
 * its vertex. */
int ranks_nearest(const struct ranks_pairing *pairing, struct ranks_side_scene *side);
int ranks_depth(const struct ranks_pairing *pairing, struct ranks_side_scene *side);

#endif
