/* oracle_objects.h - the nearest features of objects, and how deep objects are in each
 * other, by brute force and exact arithmetic.
 *
 * `asked`: two objects by id; or one, or none (0), with all others; of them those that
 * may meet. All functions end the process where memory ends.
 */
#ifndef ORACLE_ORACLE_OBJECTS_H
#define ORACLE_ORACLE_OBJECTS_H

#include "oracle_near.h"

/* Of each two the pair whose surfaces are nearest, its distance less its radii, the first
 * of equals; an edge that passes through a face is a pair at distance 0. None where that
 * is more than `distance`, which may be INFINITY. false, and nothing is found: it would
 * take more than `queries_max` exact decisions. */
bool oracle_objects_nearest(const struct oracle_moment *moment, const uint32_t asked[2],
                            double distance, uint64_t queries_max,
                            struct oracle_nears *nears);

/* Of each vertex that is inside the surface of another object the nearest of its faces,
 * the first of equals; and how many edges pass through faces of another object. As
 * above. */
bool oracle_objects_depth(const struct oracle_moment *moment, const uint32_t asked[2],
                          uint64_t queries_max, struct oracle_nears *nears,
                          uint64_t *crossings);

/* The numbers of a VF or EE pair of two objects that `named` names, or of an edge that
 * passes through a face. false: it names nothing that there is. */
bool oracle_objects_measure(const struct oracle_moment *moment,
                            const struct pccd_near *named, struct oracle_near *near);

#endif
