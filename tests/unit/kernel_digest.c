/* kernel_digest.c - what the kernels of every instruction set write, in short. */
#include <stdio.h>
#include <string.h>

#include "kernel.h"
#include "prng.h"

#define POINTS 512u
#define BLOCKS (POINTS / ENG_WIDE)
#define PAIRS  1024u
#define VALUES 67u /* more than four vectors of any set */
#define LIMIT  1e18

struct ground {
    struct eng_point points[POINTS];
    struct eng_extents boxes[POINTS];
    struct eng_extents around[BLOCKS];
    struct eng_wide_block blocks[BLOCKS];
    struct eng_quantised_block quantised[BLOCKS];
    struct eng_quantised_box quantised_around[BLOCKS];
    uint32_t farthest;
    uint32_t corner[3][POINTS]; /* of features */
    uint32_t quads[PAIRS][4];
    uint32_t all[PAIRS]; /* 0, 1, 2 .. */
    struct eng_mark marks[POINTS];
};

/* FNV-1a. */
static uint64_t digest(uint64_t before, const void *bytes, size_t count)
{
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < count; i++) {
        before = (before ^ byte[i]) * 0x100000001b3u;
    }
    return before;
}

#define DIGEST_BEGIN 0xcbf29ce484222325u

static void say(const struct eng_kernels *kernels, const char *what, uint64_t digest_now)
{
    printf("%s %s %016llx\n", kernels->name, what, (unsigned long long)digest_now);
}

/* Lattices, where much is coplanar and touches; a cloud; the same cloud far away, and
 * very large. A point is near those before it, so that boxes and features meet. */
static double some_coordinate(struct prng *prng, uint32_t family)
{
    double lattice = (double)prng_below(prng, 5) - 2;
    double unit = prng_between(prng, -1, 1);
    return family == 0   ? lattice
           : family == 1 ? unit
           : family == 2 ? 1e6 + unit
                         : unit * 0x1p50;
}

static void make(struct ground *ground)
{
    struct prng prng = {12};
    memset(ground, 0, sizeof *ground);
    for (uint32_t i = 0; i < POINTS; i++) {
        struct eng_point *point = &ground->points[i];
        uint32_t family = i / (POINTS / 4);
        for (int k = 0; k < 3; k++) {
            point->x0[k] = some_coordinate(&prng, family);
            point->x1[k] = some_coordinate(&prng, family);
        }
        for (int k = 0; k < 3; k++) {
            ground->corner[k][i] = i - i % ENG_WIDE + prng_u32(&prng, ENG_WIDE);
        }
    }
    for (uint32_t i = 0; i < PAIRS; i++) {
        uint32_t first = prng_u32(&prng, 4) * (POINTS / 4);
        for (int k = 0; k < 4; k++) {
            ground->quads[i][k] = first + prng_u32(&prng, POINTS / 4);
        }
        ground->all[i] = i;
    }
}

/* The fourth number of a side is nobody's. */
static uint64_t digest_boxes(uint64_t before, const struct eng_extents *boxes,
                             size_t count)
{
    for (size_t i = 0; i < count * ENG_SIDES; i++) {
        before =
            digest(before, boxes[i / ENG_SIDES].side[i % ENG_SIDES], 3 * sizeof(float));
    }
    return before;
}

static void run_within(const struct eng_kernels *kernels)
{
    struct prng prng = {5};
    double x[VALUES];
    float quantised[VALUES];
    double wide[VALUES];
    uint64_t within = DIGEST_BEGIN;
    uint64_t widen = DIGEST_BEGIN;
    for (uint32_t count = 0; count <= VALUES; count++) {
        for (uint32_t i = 0; i < VALUES; i++) {
            x[i] = prng_between(&prng, -1.01, 1) * LIMIT;
            quantised[i] = (float)(x[i] * (i % 3 ? 1 : 0x1p-190));
        }
        bool good[2] = {kernels->all_within(x, count, LIMIT)};
        memset(wide, 0, sizeof wide);
        good[1] = kernels->widen_within(wide, quantised, count, LIMIT);
        within = digest(within, &good[0], sizeof good[0]);
        widen =
            digest(digest(widen, &good[1], sizeof good[1]), wide, count * sizeof *wide);
    }
    say(kernels, "all_within", within);
    say(kernels, "widen_within", widen);
}

static void run_bounds(const struct eng_kernels *kernels, const struct ground *ground)
{
    static double x[POINTS][3];
    uint64_t all = DIGEST_BEGIN;
    for (uint32_t i = 0; i < POINTS; i++) {
        memcpy(x[i], ground->points[i].x0, sizeof x[i]);
    }
    for (uint32_t first = 0; first < POINTS; first += 7) {
        struct eng_bounds bounds = ENG_NO_BOUNDS;
        uint32_t count = first % VALUES;
        count = count < POINTS - first ? count : POINTS - first;
        kernels->bound_positions((const double(*)[3])x + first, count, &bounds);
        all = digest(all, &bounds, sizeof bounds);
    }
    say(kernels, "bound_positions", all);
}

/* 64 items at a time, many of which are as far as the pivot. */
static void run_come_before(const struct eng_kernels *kernels)
{
    struct prng prng = {8};
    uint64_t all = DIGEST_BEGIN;
    for (uint32_t round = 0; round < 300; round++) {
        struct eng_split_item items[64];
        for (uint32_t i = 0; i < 64; i++) {
            for (int k = 0; k < 3; k++) {
                items[i].centroid[k] = (float)some_coordinate(&prng, round % 2);
            }
            items[i].id = (i * 37 + round) % 64 + (i % 2 ? 1u << 31 : 0);
        }
        uint64_t bits = kernels->come_before(items, &items[round % 64], (int)(round % 3));
        all = digest(all, &bits, sizeof bits);
    }
    say(kernels, "come_before", all);
}

static void run_boxes(const struct eng_kernels *kernels, struct ground *ground)
{
    const uint32_t *const corner[3] = {ground->corner[0], ground->corner[1],
                                       ground->corner[2]};
    const uint32_t *const edge[3] = {ground->corner[0], ground->corner[1], NULL};
    uint64_t points = DIGEST_BEGIN;
    uint64_t unite = DIGEST_BEGIN;
    uint64_t fold = DIGEST_BEGIN;
    for (int swept = 1; swept >= 0; swept--) {
        /* Of swept boxes one end is written: the other is what was there before. */
        memset(ground->blocks, 0, sizeof ground->blocks);
        for (uint32_t count = POINTS - 17; count <= POINTS; count++) {
            kernels->box_points(ground->points, count, NULL, swept == 1, ground->boxes);
            points = digest_boxes(points, ground->boxes, count);
        }
        for (int k = 0; k < 2; k++) {
            kernels->box_unite(ground->boxes, k ? corner : edge, BLOCKS, swept == 1,
                               ground->blocks, ground->around);
            unite = digest(unite, ground->blocks, sizeof ground->blocks);
            unite = digest_boxes(unite, ground->around, BLOCKS);
        }
        kernels->box_fold(ground->boxes, BLOCKS, swept == 1, ground->blocks,
                          ground->around);
        fold = digest(fold, ground->blocks, sizeof ground->blocks);
        fold = digest_boxes(fold, ground->around, BLOCKS);
    }
    say(kernels, "box_points", points);
    say(kernels, "box_unite", unite);
    say(kernels, "box_fold", fold);
}

/* Every block and a box of every other, at both ends. */
static void run_gaps(const struct eng_kernels *kernels, const struct ground *ground)
{
    static const float limits[] = {0x1p-3f, 4, 0x1p90f};
    uint64_t all = DIGEST_BEGIN;
    for (uint32_t i = 0; i < 2 * BLOCKS * BLOCKS; i++) {
        uint32_t end = i % 2;
        const struct eng_wide_block *block = &ground->blocks[i / 2 % BLOCKS];
        const struct eng_wide_block *other = &ground->blocks[i / 2 / BLOCKS];
        float square[ENG_WIDE];
        float box[2][4] = {{0}};
        for (int k = 0; k < 3; k++) {
            box[0][k] = other->row[ENG_LOW0 + end][k][i % ENG_WIDE];
            box[1][k] = other->row[ENG_HIGH0 + end][k][i % ENG_WIDE];
        }
        uint32_t bits =
            kernels->box_gaps(block->row[ENG_LOW0 + end], block->row[ENG_HIGH0 + end],
                              (const float(*)[4])box, limits[i % 3], square);
        all = digest(digest(all, &bits, sizeof bits), square, sizeof square);
    }
    say(kernels, "box_gaps", all);
}

/* Cells in which the lattice and the cloud have much room and what is far away has none;
 * the joins below use what is written here. */
static void run_quantised(const struct eng_kernels *kernels, struct ground *ground)
{
    const struct eng_quantising quantising = {
        {0x1p12f, 0x1p12f, 0x1p11f, 0}, {3, -1000, 0.125f, 0}, {-1, 1002, 1, 0}};
    uint64_t all = DIGEST_BEGIN;
    ground->farthest = 0;
    for (uint32_t first = 0; first < BLOCKS; first += BLOCKS / 4) {
        bool fits = kernels->quantised_blocks(
            ground->blocks + first, ground->around + first, BLOCKS / 4, &quantising,
            &(struct eng_quantised_to){ground->quantised + first,
                                       ground->quantised_around + first,
                                       &ground->farthest});
        all = digest(all, &fits, sizeof fits);
    }
    all = digest(all, ground->quantised, sizeof ground->quantised);
    all = digest(all, ground->quantised_around, sizeof ground->quantised_around);
    all = digest(all, &ground->farthest, sizeof ground->farthest);
    say(kernels, "quantised_blocks", all);
}

/* Edges and faces, of points in all lanes of the ground's blocks. */
static void run_unite(const struct eng_kernels *kernels, struct ground *ground)
{
    static struct eng_quantised_block united[BLOCKS];
    static struct eng_quantised_box around[BLOCKS];
    static uint32_t corner[3][BLOCKS * ENG_WIDE];
    struct prng prng = {6};
    uint64_t all = DIGEST_BEGIN;
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < BLOCKS * ENG_WIDE; i++) {
            corner[k][i] = prng_u32(&prng, POINTS);
        }
    }
    for (uint32_t corners = 2; corners <= 3; corners++) {
        const uint32_t *const of[3] = {corner[0], corner[1],
                                       corners == 3 ? corner[2] : NULL};
        kernels->quantised_unite(ground->quantised, of, BLOCKS, united, around);
        all = digest(all, united, sizeof united);
        all = digest(all, around, sizeof around);
    }
    say(kernels, "quantised_unite", all);
}

typedef uint32_t join_fn(struct eng_join *job, struct eng_join_round *round,
                         uint32_t *out_a, uint32_t *out_b, uint32_t room);

/* The blocks as lists of points, edges or faces: every block with those after it. */
static uint64_t digest_join(uint64_t all, const struct ground *ground, join_fn *join,
                            uint32_t a_corners, uint32_t b_corners)
{
    static uint32_t out[2][ENG_JOIN_MAX];
    static struct eng_join_round round;
    for (uint32_t i = 0; i < 14 * BLOCKS * BLOCKS; i++) {
        bool is_quantised = i >= 7 * BLOCKS * BLOCKS;
        uint32_t way = i / BLOCKS / BLOCKS % 7;
        bool is_swept = way == 5 && !is_quantised;
        struct eng_join job = {.a = ground->blocks,
                               .b = ground->blocks,
                               .b_boxes = ground->around,
                               .a_quantised = is_quantised ? ground->quantised : NULL,
                               .b_quantised = is_quantised ? ground->quantised : NULL,
                               .b_quantised_boxes =
                                   is_quantised ? ground->quantised_around : NULL,
                               .farthest = ground->farthest,
                               .boxes = way < 4    ? ENG_JOIN_MOVING
                                        : way == 6 ? ENG_JOIN_AT
                                        : is_swept ? ENG_JOIN_SWEPT
                                                   : ENG_JOIN_NEAR,
                               .end = i % 2,
                               .growth = 0.0625f,
                               .cells = {256, 256, 128}, /* as much, see run_quantised */
                               .in_time = way / 2 == 1,
                               .t_end = way == 4   ? 0.046f
                                        : way == 5 ? 0x1p-20f
                                        : way % 2  ? 1
                                                   : 0.375f};
        uint32_t n = i / BLOCKS % BLOCKS;
        uint32_t m = i % BLOCKS;
        bool is_self_join = a_corners == b_corners;
        for (uint32_t k = 0; k < 3; k++) {
            job.a_corner[k] = k < a_corners ? ground->corner[k] : NULL;
            job.b_corner[k] = k < b_corners ? ground->corner[k] : NULL;
        }
        if (is_self_join && m < n) {
            continue;
        }
        eng_join_begin(&round, &n, &m, 1);
        uint32_t count = join(&job, &round, out[0], out[1], ENG_JOIN_MAX);
        all = digest(all, &count, sizeof count);
        all = digest(all, out[0], count * sizeof *out[0]);
        all = digest(all, out[1], count * sizeof *out[1]);
    }
    return all;
}

static void run_joins(const struct eng_kernels *kernels, const struct ground *ground)
{
    uint64_t all = DIGEST_BEGIN;
    say(kernels, "join_nodes", digest_join(all, ground, kernels->join_nodes, 0, 0));
    for (uint32_t kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        const uint32_t *points = common_kinds[kind].points;
        all = digest_join(all, ground, kernels->join_features[kind],
                          points[0] == 1 ? 0 : points[0], points[1] == 1 ? 0 : points[1]);
    }
    say(kernels, "join_features", all);
}

/* Digest what comes of advancing all kinds in turn, and its description. */
static void digest_advance(const struct eng_kernels *kernels, const struct ground *ground,
                           uint32_t i, const uint32_t *pairs, uint32_t count,
                           uint64_t *advanced, uint64_t *described)
{
    static struct eng_advance advance[PAIRS];
    static struct eng_hit hits[PAIRS];
    const struct eng_advance_limits limits = {i % 8 < 4 ? 0 : 0.5, i % 4 < 2 ? 1 : 0.25,
                                              i % 3 ? 30 : 40};
    memset(hits, 0, sizeof hits);
    for (uint32_t k = 0; k < count; k++) {
        advance[k] = (struct eng_advance){.lo = 0.25 * (pairs[k] % 8)};
    }
    kernels->advance((struct eng_quads){i % 4, ground->points, ground->quads}, pairs,
                     count, &limits, advance);
    for (uint32_t k = 0; k < count; k++) {
        const struct eng_advance *own = &advance[k];
        *advanced = digest(*advanced, &own->now, sizeof own->now);
        *advanced = digest(*advanced, &own->is_inside, sizeof own->is_inside);
        *advanced = digest(*advanced, &own->until, sizeof own->until);
        *advanced = digest(*advanced, &own->cell, sizeof own->cell);
        hits[k].toi = own->until < 1 ? own->until : 1;
    }
    kernels->describe((struct eng_quads){i % 4, ground->points, ground->quads}, pairs,
                      count, hits);
    for (uint32_t k = 0; k < count; k++) {
        *described = digest(*described, hits[k].param, sizeof hits[k].param);
        *described = digest(*described, hits[k].normal, sizeof hits[k].normal);
    }
}

static void run_tests(const struct eng_kernels *kernels, const struct ground *ground)
{
    static uint32_t kept[PAIRS];
    uint64_t apart = DIGEST_BEGIN;
    uint64_t filter = DIGEST_BEGIN;
    uint64_t reject_thick = DIGEST_BEGIN;
    uint64_t advance = DIGEST_BEGIN;
    uint64_t describe = DIGEST_BEGIN;
    double reach[PAIRS];
    for (uint32_t i = 0; i < PAIRS; i++) {
        reach[i] = 0.25 * (i % 8);
    }
    for (uint32_t i = 0; i < 2 * 40; i++) {
        enum pccd_kind kind = i % 2 ? PCCD_EE : PCCD_VF;
        uint32_t count = PAIRS - i / 2;
        uint32_t left = kernels->reject_axes(
            (struct eng_quads){kind, ground->points, ground->quads}, count, kept);
        apart = digest(digest(apart, &left, sizeof left), kept, left * sizeof *kept);
        left = kernels->filter((struct eng_quads){kind, ground->points, ground->quads},
                               ground->all, count, kept);
        filter = digest(digest(filter, &left, sizeof left), kept, left * sizeof *kept);
        left = kernels->reject_thick(
            (struct eng_quads){kind, ground->points, ground->quads}, count, reach, kept);
        reject_thick =
            digest(digest(reject_thick, &left, sizeof left), kept, left * sizeof *kept);
        digest_advance(kernels, ground, i, kept, left, &advance, &describe);
    }
    say(kernels, "reject_axes", apart);
    say(kernels, "filter", filter);
    say(kernels, "reject_thick", reject_thick);
    say(kernels, "advance", advance);
    say(kernels, "describe", describe);
}

static void set_numbers(const struct ground *ground, uint32_t part, uint32_t *a,
                        uint32_t *b, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        a[k] = ground->quads[k][0] % part;
        b[k] = ground->quads[k][1] % part;
    }
}

/* Grids that hold all but the last quarter of the points, or nothing. */
static void run_sieve(const struct eng_kernels *kernels, struct ground *ground)
{
    static const struct eng_grid grids[] = {
        {{0, 0, 0}, 0x1p27}, {{0.25, 0, 3}, 0x1p9}, {{1e6, 1e6, 1e6}, 0x1p20}};
    static uint32_t a[PAIRS + ENG_SIEVE_SPARE];
    static uint32_t b[PAIRS + ENG_SIEVE_SPARE];
    const uint32_t part = POINTS / 4;
    uint64_t place = DIGEST_BEGIN;
    uint64_t sift = DIGEST_BEGIN;
    uint64_t sift_near = DIGEST_BEGIN;
    uint64_t sift_thick = DIGEST_BEGIN;
    for (uint32_t i = 0; i < 3 * 40; i++) {
        const struct eng_grid *grid = &grids[i % 3];
        uint32_t first = i % 3 == 0 ? 0 : i % 3 == 1 ? part : 2 * part;
        bool good = kernels->place_points(ground->points + first, part, NULL, grid,
                                          ground->marks + first);
        place = digest(digest(place, &good, sizeof good), ground->marks + first,
                       part * sizeof *ground->marks);
        good = kernels->place_points(ground->points, POINTS, NULL, grid, ground->marks);
        place = digest(place, &good, sizeof good);
        struct eng_sieve sieve = {
            .marks = ground->marks + first,
            .a_corner = {ground->corner[0], ground->corner[1]},
            .b_corner = {ground->corner[2], ground->corner[1], ground->corner[0]},
            .t_end = i % 5 == 0 ? 0.375f : 1,
            .swept = i % 11 < 5,
            .in_time = i % 7 == 0,
            .cubic_first = i % 2 == 0,
            .prunes = i % 5 < 2,
            .end = i / 4 % 2};
        uint32_t count = PAIRS - i;
        set_numbers(ground, part, a, b, count);
        count = kernels->sift_near(i % 4 < 2    ? PCCD_VF
                                   : i % 4 == 2 ? PCCD_EE
                                                : PCCD_EF,
                                   &sieve, (float)(i * i), a, b, count);
        sift_near = digest(digest(sift_near, &count, sizeof count), a, count * sizeof *a);
        sift_near = digest(sift_near, b, count * sizeof *b);
        count = PAIRS - i;
        set_numbers(ground, part, a, b, count);
        count = kernels->sift_thick(i % 4 < 2 ? PCCD_VF : PCCD_EE, &sieve, (float)(i * i),
                                    a, b, count);
        sift_thick =
            digest(digest(sift_thick, &count, sizeof count), a, count * sizeof *a);
        sift_thick = digest(sift_thick, b, count * sizeof *b);
        count = PAIRS - i;
        set_numbers(ground, part, a, b, count);
        count = kernels->sift(i % 4 < 2 ? PCCD_VF : PCCD_EE, &sieve, a, b, count);
        sift = digest(digest(sift, &count, sizeof count), a, count * sizeof *a);
        sift = digest(sift, b, count * sizeof *b);
        sift = digest(sift, &sieve.cubic_first, sizeof sieve.cubic_first);
    }
    say(kernels, "place_points", place);
    say(kernels, "sift", sift);
    say(kernels, "sift_near", sift_near);
    say(kernels, "sift_thick", sift_thick);
}

/* Hits and what is unsure come in an order that is the set's own: one place a pair. */
static uint64_t digest_decided(uint64_t before, const struct eng_bracketed *out,
                               uint32_t count)
{
    static const struct eng_hit *hit_of[PAIRS];
    static bool is_unsure[PAIRS];
    memset(hit_of, 0, sizeof hit_of);
    memset(is_unsure, 0, sizeof is_unsure);
    for (uint32_t i = 0; i < out->hit_count; i++) {
        hit_of[out->index[i]] = &out->hits[i];
    }
    for (uint32_t i = 0; i < out->unsure_count; i++) {
        is_unsure[out->unsure[i]] = true;
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_hit *hit = hit_of[i];
        before = digest(before, &is_unsure[i], sizeof is_unsure[i]);
        if (hit) {
            before = digest(before, &hit->flags, sizeof hit->flags);
            before = digest(before, &hit->toi, sizeof hit->toi);
            before = digest(before, &hit->toi_hi, sizeof hit->toi_hi);
            before = digest(before, hit->param, sizeof hit->param);
            before = digest(before, hit->normal, sizeof hit->normal);
        }
    }
    return before;
}

static void run_bracket(const struct eng_kernels *kernels, const struct ground *ground)
{
    static uint32_t pairs[PAIRS];
    static uint32_t index[PAIRS];
    static uint32_t unsure[PAIRS];
    static struct eng_hit hits[PAIRS];
    uint64_t bracket = DIGEST_BEGIN;
    for (uint32_t i = 0; i < 4 * 20; i++) {
        struct eng_bracketed out = {0, 0, index, hits, unsure};
        enum pccd_kind kind = i % 2 ? PCCD_EE : PCCD_VF;
        uint32_t count = PAIRS - i / 4;
        memcpy(pairs, ground->all, sizeof pairs);
        kernels->bracket((struct eng_quads){kind, ground->points, ground->quads}, pairs,
                         count, 1e-6, i % 4 < 2 ? 1 : 0.375, &out);
        bracket = digest_decided(bracket, &out, count);
    }
    say(kernels, "bracket", bracket);
}

/* Pairs and what is said of them. */
static uint64_t digest_measured(uint64_t before, const struct eng_measured *out)
{
    before = digest(before, out->index, out->near_count * sizeof *out->index);
    before =
        digest(before, out->imprecise, out->imprecise_count * sizeof *out->imprecise);
    before =
        digest(before, out->undecided, out->undecided_count * sizeof *out->undecided);
    for (uint32_t i = 0; i < out->near_count && out->wanted != ENG_DISTANCE_WITHIN; i++) {
        const struct eng_distance *found = &out->found[i];
        before = digest(before, &found->lo, sizeof found->lo);
        before = digest(before, &found->hi, sizeof found->hi);
        if (out->wanted == ENG_DISTANCE_WHOLE) {
            before = digest(before, found->param, sizeof found->param);
            before = digest(before, found->direction, sizeof found->direction);
            before = digest(before, &found->points, sizeof found->points);
        }
    }
    return before;
}

static void run_distances(const struct eng_kernels *kernels, const struct ground *ground)
{
    static uint32_t kept[PAIRS];
    static uint32_t index[PAIRS];
    static uint32_t imprecise[PAIRS];
    static uint32_t undecided[PAIRS];
    static struct eng_distance found[PAIRS];
    uint64_t beyond = DIGEST_BEGIN;
    uint64_t measure = DIGEST_BEGIN;
    for (uint32_t i = 0; i < 12 * 4; i++) {
        enum pccd_kind kind = i % 2 ? PCCD_EE : PCCD_VF;
        uint32_t end = i / 2 % 2;
        uint32_t count = PAIRS - i / 12;
        struct eng_measured out = {.wanted = (enum eng_distance_wanted)(i / 4 % 3),
                                   .index = index,
                                   .found = found,
                                   .imprecise = imprecise,
                                   .undecided = undecided};
        double d = 0.25 * (1 + i / 12);
        uint32_t left = kernels->reject_at_end(
            (struct eng_quads){kind, ground->points, ground->quads}, count, end, d, kept);
        beyond = digest(digest(beyond, &left, sizeof left), kept, left * sizeof *kept);
        kernels->measure((struct eng_quads){kind, ground->points, ground->quads},
                         ground->all, count, end, d, &out);
        measure = digest_measured(measure, &out);
    }
    say(kernels, "reject_at_end", beyond);
    say(kernels, "measure", measure);
}

static void run_cross_faces(const struct eng_kernels *kernels,
                            const struct ground *ground)
{
    static uint32_t fives[PAIRS][5];
    static uint32_t index[PAIRS];
    static uint32_t undecided[PAIRS];
    uint64_t crossed = DIGEST_BEGIN;
    for (uint32_t i = 0; i < PAIRS; i++) {
        memcpy(fives[i], ground->quads[i], sizeof ground->quads[i]);
        fives[i][4] = ground->quads[(i + 4) % PAIRS][0];
    }
    for (uint32_t i = 0; i < 2 * 10; i++) {
        struct eng_crossed out = {.index = index, .undecided = undecided};
        kernels->cross_faces(ground->points, (const uint32_t(*)[5])fives, PAIRS - i / 2,
                             i % 2, &out);
        crossed = digest(crossed, index, out.count * sizeof *index);
        crossed = digest(crossed, undecided, out.undecided_count * sizeof *undecided);
    }
    say(kernels, "cross_faces", crossed);
}

/* One by one what `bracket` decides in chunks: of the scalar set, which is everywhere. */
static void run_decide(const struct eng_kernels *kernels, const struct ground *ground)
{
    uint64_t decide = DIGEST_BEGIN;
    for (uint32_t i = 0; i < 4 * PAIRS; i++) {
        struct eng_query query = {.kind = i % 2 ? PCCD_EE : PCCD_VF};
        uint32_t index = 0;
        uint32_t unsure = 0;
        struct eng_hit hit;
        for (int k = 0; k < 4; k++) {
            const struct eng_point *point = &ground->points[ground->quads[i / 4][k]];
            memcpy(query.x[0][k], point->x0, sizeof point->x0);
            memcpy(query.x[1][k], point->x1, sizeof point->x1);
        }
        enum eng_decision verdict = eng_decide(&query, 1e-6, i % 4 < 2 ? 1 : 0.375, &hit);
        struct eng_bracketed out = {verdict == ENG_MEETS, verdict == ENG_UNDECIDED,
                                    &index, &hit, &unsure};
        decide = digest_decided(decide, &out, 1);
    }
    say(kernels, "decide", decide);
}

int main(void)
{
    static struct ground ground;
    make(&ground);
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (!kernels) {
            continue;
        }
        run_within(kernels);
        run_bounds(kernels, &ground);
        run_come_before(kernels);
        run_boxes(kernels, &ground);
        run_quantised(kernels, &ground);
        run_unite(kernels, &ground);
        run_gaps(kernels, &ground);
        run_joins(kernels, &ground);
        run_sieve(kernels, &ground);
        run_tests(kernels, &ground);
        run_bracket(kernels, &ground);
        run_distances(kernels, &ground);
        run_cross_faces(kernels, &ground);
        if (isa == ENG_ISA_SCALAR) {
            run_decide(kernels, &ground);
        }
    }
    return 0;
}
