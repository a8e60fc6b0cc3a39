/* fuzz_sieve.c - the sieve rejects only what has no contact. */
#include "fuzz_sieve.h"

#include <math.h>
#include <string.h>

/* As the engine: neither a side of the grid nor its scale leaves the numbers. */
#define EXPONENT_MIN (-900)

/* As far as the query reaches, or up to 2^28 times. */
static struct eng_grid grid_of(struct prng *prng, const struct eng_query *query)
{
    struct eng_grid grid;
    double far = 0;
    int exponent;
    const double *near = query->x[prng_below(prng, 2)][prng_below(prng, 4)];
    for (int k = 0; k < 3; k++) {
        double other = query->x[prng_below(prng, 2)][prng_below(prng, 4)][k];
        grid.origin[k] = near[k] + prng_between(prng, 0, 1) * (other - near[k]);
        for (int i = 0; i < 8; i++) {
            far = fmax(far, fabs(query->x[i / 4][i % 4][k] - grid.origin[k]));
        }
    }
    frexp(far * 1.001, &exponent);
    exponent += (int)prng_below(prng, prng_below(prng, 4) ? 6 : 29);
    grid.scale = ldexp(1, 30 - (exponent > EXPONENT_MIN ? exponent : EXPONENT_MIN));
    return grid;
}

/* Marks of a query by every set, which must be the same. False: it is beyond the grid.
 * *differ: a set has others. */
static bool place(struct prng *prng, const struct eng_query *query,
                  struct eng_mark marks[4], bool *differ)
{
    struct eng_point points[4];
    struct eng_grid grid = grid_of(prng, query);
    bool fits = false;
    bool is_first = true;
    for (int i = 0; i < 4; i++) {
        memcpy(points[i].x0, query->x[0][i], sizeof points[i].x0);
        memcpy(points[i].x1, query->x[1][i], sizeof points[i].x1);
        points[i].word0 = points[i].word1 = prng_next(prng);
    }
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        struct eng_mark others[4];
        if (kernels && is_first) {
            fits = kernels->place_points(points, 4, NULL, &grid, marks);
            is_first = false;
        } else if (kernels) {
            bool also = kernels->place_points(points, 4, NULL, &grid, others);
            *differ |=
                also != fits || (fits && memcmp(others, marks, sizeof others) != 0);
        }
    }
    return fits;
}

static uint32_t sift(struct fuzz_sieve *sieve, const struct eng_kernels *kernels,
                     enum pccd_kind kind, struct eng_sieve *job)
{
    for (uint32_t i = 0; i < sieve->count; i++) {
        sieve->a[i] = kind == PCCD_VF ? sieve->corner[0][i] : i;
        sieve->b[i] = i;
    }
    return kernels->sift(kind, job, sieve->a, sieve->b, sieve->count);
}

/* Check that every query that is not among those kept is one without a contact up to
 * t_end. They are in their order. */
static const char *check_kept(const struct fuzz_sieve *sieve,
                              const struct fuzz_answered *chunk, uint32_t kept,
                              double t_end, uint32_t *wrong)
{
    uint32_t at = 0;
    for (uint32_t i = 0; i < sieve->count; i++) {
        uint32_t pair = sieve->pair[i];
        *wrong = pair;
        if (at < kept && sieve->b[at] == i) {
            uint32_t a = chunk->kind == PCCD_VF ? sieve->corner[0][i] : i;
            if (sieve->a[at++] != a) {
                return "the sieve keeps another pair";
            }
        } else if (chunk->found[pair] && chunk->hits[pair].toi_hi <= t_end) {
            return "the sieve rejects a contact";
        }
    }
    return at == kept ? NULL : "the sieve keeps a pair twice, or none";
}

const char *fuzz_sieve_check(struct fuzz_sieve *sieve, struct prng *prng,
                             const struct fuzz_answered *chunk, uint32_t *wrong)
{
    bool is_vf = chunk->kind == PCCD_VF;
    bool differ = false;
    sieve->count = 0;
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t n = sieve->count;
        *wrong = i;
        if (place(prng, &chunk->queries[i], &sieve->marks[4 * (size_t)n], &differ)) {
            sieve->pair[n] = i;
            for (uint32_t k = 0; k < 4; k++) {
                sieve->corner[k][n] = 4 * n + k;
            }
            sieve->count++;
        }
        if (differ) {
            return "sets mark a point differently";
        }
    }
    float t_end = chunk->t_end < 1 ? nextafterf((float)chunk->t_end, 1) : 1;
    bool in_time = prng_below(prng, 4) == 0;
    bool cubic_first = prng_below(prng, 2);
    bool swept = prng_below(prng, 2);
    uint32_t first = UINT32_MAX;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (!kernels) {
            continue;
        }
        struct eng_sieve job = {.marks = sieve->marks,
                                .a_corner = {sieve->corner[0], sieve->corner[1]},
                                .b_corner = {sieve->corner[is_vf ? 1 : 2],
                                             sieve->corner[is_vf ? 2 : 3],
                                             is_vf ? sieve->corner[3] : NULL},
                                .t_end = t_end,
                                .swept = swept,
                                .in_time = in_time,
                                .cubic_first = cubic_first};
        uint32_t kept = sift(sieve, kernels, chunk->kind, &job);
        const char *what = check_kept(sieve, chunk, kept, (double)t_end, wrong);
        if (what) {
            return what;
        }
        if (first == UINT32_MAX) {
            first = kept;
            memcpy(sieve->first_b, sieve->b, kept * sizeof *sieve->b);
            sieve->looked_at += sieve->count;
            sieve->kept += kept;
            continue;
        }
        for (uint32_t i = 0; i < kept || i < first; i++) {
            if (i >= kept || i >= first || sieve->b[i] != sieve->first_b[i]) {
                *wrong = sieve->pair[i < kept ? sieve->b[i] : sieve->first_b[i]];
                return "sets sift a chunk differently, here or at an earlier query";
            }
        }
    }
    return NULL;
}
