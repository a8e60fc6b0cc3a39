/* eng_kit.h - small meshes, queries and random numbers for the engine's unit tests.
 *
 * Threads: one per generator.
 */
#ifndef TEST_ENG_KIT_H
#define TEST_ENG_KIT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mesh.h"
#include "query.h"

struct kit_random {
    uint64_t state;
};

static inline uint64_t kit_u64(struct kit_random *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline uint32_t kit_below(struct kit_random *random, uint32_t bound)
{
    return (uint32_t)(kit_u64(random) % bound);
}

/* lo .. hi, with all 53 bits in use. */
static inline double kit_between(struct kit_random *random, double lo, double hi)
{
    return lo + (hi - lo) * ((double)(kit_u64(random) >> 11) * 0x1p-53);
}

/* An integer in -bound .. bound: arithmetic on a few of them is exact. */
static inline double kit_integer(struct kit_random *random, uint32_t bound)
{
    return (double)kit_below(random, 2 * bound + 1) - (double)bound;
}

/* A committed mesh; fails the test if it cannot be made. The caller releases it. */
struct eng_mesh *kit_mesh(const double (*x)[3], uint32_t vertex_count,
                          const uint32_t (*triangles)[3], uint32_t triangle_count);
/* The same with radii of its vertices; NULL: none. */
struct eng_mesh *kit_mesh_thick(const double (*x)[3], uint32_t vertex_count,
                                const uint32_t (*triangles)[3], uint32_t triangle_count,
                                const double *radii);

/* `side` x `side` squares of two triangles over 0 .. 1 in x and y, at height z. */
struct eng_mesh *kit_sheet(uint32_t side, double z);

/* `count` triangles of about the size 1 / count^(1/3) in the unit cube, no vertex
 * shared. */
struct eng_mesh *kit_soup(struct kit_random *random, uint32_t count);

/* A query whose features meet at exactly `t` = numerator / 8, and maybe before: every
 * coordinate is a multiple of 2^-9 below 2^9, so no rounding took part in its making. */
void kit_plant(struct kit_random *random, enum pccd_kind kind, unsigned numerator,
               struct eng_query *query);

/* Times a power of two, then plus an offset along each axis. */
void kit_place(struct eng_query *query, double factor, double offset);

#endif
