/* local.h - the mesh that libpccd has of an object in this rank.
 *
 * Threads: one.
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

/* Once for each ranks_local_make, in this rank alone: libpccd gets a mesh of object->own
 * and object->ghosts at x, of the local vertices, instead of the one that it had:
 * object->local_mesh, or none if that is 0. radii: of these vertices, or NULL. is_part:
 * libpccd leaves out what is another rank's. */
int ranks_local_register(struct pccd_mpi *world, struct ranks_object *object,
                         const double (*x)[3], const double *radii, bool is_part);
/* Collective: libpccd gets the mesh, at its registered positions, in each rank in which
 * it is not built. */
int ranks_local_put(struct pccd_mpi *world, struct ranks_object *object);
/* In this rank alone: something for the object to be made of while it has no leaf here.
 * It meets nothing. */
int ranks_local_put_nothing(struct pccd_mpi *world, uint32_t *mesh);
/* The object may meet what its settings say, or nothing. */
int ranks_local_show(struct pccd_mpi *world, struct ranks_object *object);

/* The place of a number in an ascending array; count: it is not there. */
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
