/* parts.h - a mesh in parts: who was given which vertices, and what of it is here. */
#ifndef RANKS_PARTS_H
#define RANKS_PARTS_H

#include "world.h"

/* Collective. Make a mesh, after ranks_part_check. *mesh is new, without handle. */
int ranks_mesh_make(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                    struct ranks_mesh **mesh);

/* Check in this rank alone whether the part is possible by itself. */
int ranks_part_check(struct pccd_mpi *world, const struct pccd_mpi_part *part);

/* Return the rank whose directory has the vertex. */
static inline int ranks_directory(const struct ranks_mesh *mesh, uint32_t vertex)
{
    return (int)(vertex / mesh->span);
}

/* Triangles, then edges, then points that this rank has named, with their numbers. */
struct ranks_named {
    struct ranks_leaf *leaves;
    uint32_t triangle_count, edge_count, point_count;
};
/* Collective. Find sides, ownership and counts of the leaves (sides.c): sides and owns of
 * those of `named` are written. Leaves that are nothing by themselves, as an edge that a
 * triangle has, are taken out. */
int ranks_sides_find(struct pccd_mpi *world, struct ranks_mesh *mesh,
                     struct ranks_named *named);

/* ---- Who was given which vertices, and how their positions come to where they are
 * needed. */

/* Collective. Fetch the registered positions of vertices, and radii unless `radii` is
 * NULL or the mesh has none; both are allocated. */
int ranks_fetch_registered(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                           const uint32_t *vertices, uint32_t count, double (**x)[3],
                           double **radii);

/* Collective. Make world->plan: who needs what, for objects[i]->local. */
int ranks_plan_make(struct pccd_mpi *world);

/* Collective. Send positions from given[i], of each given vertex of object i, to
 * local[i], of each local vertex. Objects whose `given` is NULL are left out, the same
 * ones on every rank. */
int ranks_plan_send(struct pccd_mpi *world, const double (*const *given)[3],
                    double (*const *local)[3]);

/* Collective. Send them so to (*x)[i], which are allocated: where objects begin or end by
 * object->from and object->to, or where they ended in the last step. */
enum ranks_when { RANKS_BEGIN, RANKS_END, RANKS_LAST_END };
int ranks_positions_fetch(struct pccd_mpi *world, enum ranks_when when, double (***x)[3]);
/* Free positions; NULL is allowed. */
void ranks_positions_free(const struct pccd_mpi *world, double (**x)[3]);

/* ---- The mesh that libpccd has of an object in this rank. */

/* Make object->local from own and ghosts, in this rank alone. PCCD_E_NOMEM. */
int ranks_local_make(struct pccd_mpi *world, struct ranks_object *object);

/* Find the local vertices of leaves' corners, to at[count], in this rank alone.
 * PCCD_E_NOMEM. */
int ranks_local_corners(struct pccd_mpi *world, const struct ranks_local *local,
                        const struct ranks_leaf *leaves, uint32_t count,
                        uint32_t (*at)[3]);

/* Give libpccd, once for each ranks_local_make, in this rank alone, a mesh of object->own
 * and object->ghosts at x, of the local vertices, instead of the one that it had:
 * object->local_mesh, or none if that is 0. radii: of these vertices, or NULL. is_part:
 * libpccd leaves out what is another rank's. */
int ranks_local_register(struct pccd_mpi *world, struct ranks_object *object,
                         const double (*x)[3], const double *radii, bool is_part);
/* Collective. Give libpccd the mesh, at its registered positions, in each rank in which
 * it is not built. */
int ranks_local_put(struct pccd_mpi *world, struct ranks_object *object);
/* Make something, in this rank alone, for the object to be made of while it has no leaf
 * here. It meets nothing. */
int ranks_local_put_nothing(struct pccd_mpi *world, uint32_t *mesh);
/* Let the object meet what its settings say, or nothing where it has no leaf or is not
 * built. */
int ranks_local_show(struct pccd_mpi *world, struct ranks_object *object);

/* Return the place of a number in an ascending array; count: it is not there. */
static inline uint32_t ranks_place_of(const uint32_t *numbers, uint32_t count,
                                      uint32_t number)
{
    uint32_t from = 0, end = count;
    while (from < end) {
        uint32_t middle = from + (end - from) / 2;
        if (numbers[middle] < number) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from < count && numbers[from] == number ? from : count;
}

#endif
