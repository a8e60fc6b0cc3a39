/* local.h - the mesh that libpccd has of an object in this rank.
 *
 * Room:     client/mpi. May include: world.h.
 * Does:     number the own leaves and the ghosts of an object by themselves, in the order
 *           of the whole; give that to libpccd.
 * Threads:  one.
 */
#ifndef RANKS_LOCAL_H
#define RANKS_LOCAL_H

#include "world.h"

/* object->local from own and ghosts. In this rank alone. PCCD_E_NOMEM. */
int ranks_local_make(struct pccd_mpi *world, struct ranks_object *object);

/* The local vertices of leaves' corners, to at[count]. In this rank alone. */
int ranks_local_corners(struct pccd_mpi *world, const struct ranks_local *local,
                        const struct ranks_leaf *leaves, uint32_t count,
                        uint32_t (*at)[3]);

/* Collective: libpccd gets the mesh, at its registered positions. */
int ranks_local_put(struct pccd_mpi *world, struct ranks_object *object);
/* In this rank alone: something for the object to be made of while it has no leaf here.
 * It meets nothing. */
int ranks_local_put_nothing(struct pccd_mpi *world, uint32_t *mesh);
/* The object may meet what its settings say, or nothing. */
int ranks_local_show(struct pccd_mpi *world, struct ranks_object *object);

#endif
