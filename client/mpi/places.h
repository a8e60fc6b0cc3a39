/* places.h - who was given which vertices, and how their positions come to where they are
 * needed.
 *
 * Threads: one.
 */
#ifndef RANKS_PLACES_H
#define RANKS_PLACES_H

#include "world.h"

/* Collective: where each of vertices[count], ascending, was given, to places[count]. */
int ranks_places(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                 const uint32_t *vertices, uint32_t count, struct ranks_place *places);

/* Collective: their registered positions, and radii unless `radii` is NULL or the mesh
 * has none; both are allocated. */
int ranks_fetch_registered(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                           const uint32_t *vertices, uint32_t count, double (**x)[3],
                           double **radii);

/* Collective: who needs what, for objects[i]->local. */
int ranks_plan_make(struct pccd_mpi *world);

/* Collective: from given[i], of each given vertex of object i, to local[i], of each local
 * vertex. Objects whose `given` is NULL are left out, the same ones on every rank. */
int ranks_plan_send(struct pccd_mpi *world, const double (*const *given)[3],
                    double (*const *local)[3]);

#endif
