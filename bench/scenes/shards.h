/* shards.h - cuts a surface into pieces, for scenes in which something breaks.
 *
 * Grow connected pieces from random triangles; give each piece vertices of its own and,
 * on request, an inner side and walls, so that it is a closed shard.
 *
 * Threads: one.
 */
#ifndef BENCH_SHARDS_H
#define BENCH_SHARDS_H

#include "prng.h"
#include "surface.h"

struct shards {
    struct surface surface; /* triangles of a piece stand together; x: filled in */
    uint32_t count;         /* pieces */
    uint32_t *piece_of;     /* [surface.vertex_count] */
    uint32_t *vertex_of;    /* [surface.vertex_count]: in the surface that was cut */
    double (*centre)[3];    /* [count]: mean of a piece's vertices */
    double *radius;         /* [count]: of its vertices about the centre, root mean
                             * square */
};

/* Cut `whole` into `count` pieces. inner[whole.vertex_count]: where the inner side is;
 * NULL: pieces are open patches. Vertices move towards the centre of their piece, to
 * `shrink` < 1 of their distance or half as far, so that neighbours stand apart by
 * a hair. */
void shards_init(struct shards *shards, const struct surface *whole, uint32_t count,
                 const double (*inner)[3], double shrink, struct prng *prng);
void shards_deinit(struct shards *shards);

#endif
