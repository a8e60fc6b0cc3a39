/* parts.h - takes a mesh in parts.
 *
 * Threads: one.
 */
#ifndef RANKS_PARTS_H
#define RANKS_PARTS_H

#include "world.h"

/* Collective, after ranks_part_check. *mesh is new, without handle. */
int ranks_mesh_make(struct pccd_mpi *world, const struct pccd_mpi_part *part,
                    struct ranks_mesh **mesh);

/* In this rank alone: is the part possible by itself? */
int ranks_part_check(struct pccd_mpi *world, const struct pccd_mpi_part *part);

/* The rank whose directory has the vertex. */
static inline int ranks_directory(const struct ranks_mesh *mesh, uint32_t vertex)
{
    return (int)(vertex / mesh->span);
}

/* Sides, ownership and counts of the leaves (sides.c). named: triangles, then edges, then
 * points, of this rank, with their numbers; sides and owns are written. Leaves that are
 * nothing by themselves, as an edge that a triangle has, are taken out. */
struct ranks_named {
    struct ranks_leaf *leaves;
    uint32_t triangle_count, edge_count, point_count;
};
int ranks_sides_find(struct pccd_mpi *world, struct ranks_mesh *mesh,
                     struct ranks_named *named);

#endif
