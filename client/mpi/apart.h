/* apart.h - a question about some leaves alone, in a scene of their own.
 *
 * Threads: one.
 *
 * The meshes of such a scene are parts of the whole ones, numbered in the same order. So
 * of equally near pairs the first one is the same, and so is all that a record says.
 */
#ifndef RANKS_APART_H
#define RANKS_APART_H

#include "world.h"

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

#endif
