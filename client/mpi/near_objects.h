/* near_objects.h - what is asked of objects two by two, over ranks.
 *
 * Threads: one.
 */
#ifndef RANKS_NEAR_OBJECTS_H
#define RANKS_NEAR_OBJECTS_H

#include <math.h>

#include "world.h"

/* ---- A question about some leaves alone, in a scene of their own.
 *
 * The meshes of such a scene are parts of the whole ones, numbered in the same order. So
 * of equally near pairs the first one is the same, and so is all that a record says. */

/* A leaf of an object, by its place in world->objects, and where its corners are. */
struct ranks_visitor {
    uint32_t object;
    bool is_ghost; /* no feature of it is this rank's, whatever leaf.owns says */
    struct ranks_leaf leaf;
    double x[3][3];
};

struct ranks_apart {
    struct ranks_object *objects; /* [object_count]: mesh, leaves and local numbers */
    double (**x)[3];              /* [object_count]: of local vertices */
    struct pccd_near *records;    /* sorted; with handles and numbers of the whole */
    uint64_t count;
    struct pccd_answer answer; /* without records */
};

/* Collective, but each rank has its own leaves: in any order, some twice perhaps. A
 * vertex or edge is this rank's if any of its leaves that is no ghost owns it. `near`
 * says what is asked, with handles of the world; `end` is not looked at. Objects are as
 * thick as in the world, where that matters. */
int ranks_apart_ask(struct pccd_mpi *world, const struct ranks_visitor *leaves,
                    uint64_t count, const struct pccd_near_settings *near,
                    struct ranks_apart *apart);
/* To the last of several answers, the work of an earlier one, and whether that was cut
 * short. */
void ranks_apart_add(struct ranks_apart *last, const struct ranks_apart *earlier);
void ranks_apart_deinit(const struct pccd_mpi *world, struct ranks_apart *apart);

/* A leaf of the answer's scene that has a feature of `points` vertices. */
void ranks_apart_find(const struct ranks_apart *apart, uint32_t object, uint32_t points,
                      uint32_t feature, struct ranks_visitor *visitor);
/* Where a vertex of an object, by its handle, is in the answer's scene. */
void ranks_apart_vertex(const struct pccd_mpi *world, const struct ranks_apart *apart,
                        uint32_t handle, uint32_t vertex, double x[3]);
/* The place of an object in world->objects, by its handle. */
uint32_t ranks_place_of_object(const struct pccd_mpi *world, uint32_t handle);

static inline bool ranks_near_is_by_objects(const struct pccd_near_settings *near)
{
    return near->what == PCCD_NEAR_NEAREST || near->what == PCCD_NEAR_DEPTH;
}

/* Collective: for where objects begin or end by object->from and object->to, to
 * world->records and *answer. Errors: those of pccd_ask_near. */
int ranks_near_of_objects(struct pccd_mpi *world, const struct pccd_near_settings *near,
                          struct pccd_answer *answer);

/* ---- for nearest.c and depth.c ----------------------------------------------------- */

/* A question and where everything is. */
struct ranks_pairing {
    struct pccd_mpi *world;
    const struct pccd_near_settings *near;
    double (**x)[3]; /* [object_count]: of local vertices */
};

/* Is it asked of these two, by their places? */
bool ranks_is_asked(const struct ranks_pairing *pairing, uint32_t a, uint32_t b);
bool ranks_is_asked_with_any(const struct ranks_pairing *pairing, uint32_t a);
/* Is `a` before `b` in the order of handles? */
static inline bool ranks_is_lower(const struct pccd_mpi *world, uint32_t a, uint32_t b)
{
    return world->objects[a]->handle < world->objects[b]->handle;
}
/* The question as it is asked of a part of the scene, with the time that is left. */
void ranks_ask_rest(const struct ranks_pairing *pairing, struct pccd_near_settings *near);
/* An own leaf with its corners. */
void ranks_visitor_make(const struct ranks_pairing *pairing, uint32_t object,
                        uint32_t leaf, struct ranks_visitor *visitor);

/* Collective: the answer is in *apart, each record on one rank: of DEPTH the one that
 * has its vertex. */
int ranks_nearest(const struct ranks_pairing *pairing, struct ranks_apart *apart);
int ranks_depth(const struct ranks_pairing *pairing, struct ranks_apart *apart);

/* ---- Where the leaves of objects are at one moment, some at a time. */

/* Own leaves of one object that lie one behind the other on the curve. */
struct ranks_spot {
    double low[3], high[3];
    double x[3]; /* of one of their vertices */
    uint32_t object;
    uint32_t begin, count;
};

/* In this rank alone: of all objects that are asked about; *spots is allocated.
 * PCCD_E_NOMEM. */
int ranks_spots_make(const struct ranks_pairing *pairing, struct ranks_spot **spots,
                     uint32_t *count);

static inline void ranks_leaf_bounds(const struct ranks_visitor *leaf, double low[3],
                                     double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(leaf->x[0][k], fmin(leaf->x[1][k], leaf->x[2][k]));
        high[k] = fmax(leaf->x[0][k], fmax(leaf->x[1][k], leaf->x[2][k]));
    }
}

#endif
