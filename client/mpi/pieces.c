/* pieces.c - pieces of the curve that are even in two ways.
 *
 * Halve the ranks, and the curve with them, until each rank is alone. The curve is taken
 * for a circle. One half of the ranks gets an arc of it, the other one the rest. Wherever
 * the arc begins, it can end so that it has half of the weight. It begins where the curve
 * does, unless a half would have too many leaves then: then as little away from there as
 * does. For as the begin goes round the circle the arc becomes the rest, and the rest the
 * arc; so somewhere on the way both have half of the leaves, too.
 *
 * Source: Stromquist and Woodall, "Sets on which several measures agree", J. Math. Anal.
 * Appl. 108 (1985).
 */
#include "cut.h"

#include <stdlib.h>
#include <string.h>

#include "rank_sort.h"

/* Slices of all ranks together, for each of them; of very many ranks fewer. */
#define SLICES_OF_RANK 1024u
#define SLICES_MAX     65536u

/* No rank is to have many more leaves than the mean, because memory goes by leaves: a
 * thirtieth more, or as many again where all of them are few. */
#define MEAN_FEW         65536u
#define LEAVES_MAX(mean) ((mean) < MEAN_FEW ? 2 * (mean) + 1 : (mean) / 30 * 31)

/* Weight and leaves of all slices, as each rank finds them out. */
struct table {
    uint64_t count;
    uint64_t *weights, *leaves; /* [count] */
    uint64_t *order;            /* [count] slices, those of a group one after the other */
    uint64_t *scratch;          /* [count] */
    uint64_t *sums[2];          /* [count + 1] weights and leaves before a place of it */
    uint64_t leaves_max;        /* of a rank */
};

/* Ranks, and places of `order` that are theirs together. */
struct group {
    uint64_t first, count;
    uint32_t rank, ranks;
};

void ranks_pieces_deinit(struct ranks_pieces *pieces)
{
    free(pieces->ends);
    free(pieces->rank);
    *pieces = (struct ranks_pieces){.count = 0};
}

static void table_deinit(struct table *table)
{
    free(table->weights);
    free(table->order);
    free(table->sums[0]);
}

/* ---- slices ----------------------------------------------------------------------- */

/* Find how much all leaves are, and how much a slice is to be at most, nearly: by weight,
 * and as much again by the number of leaves. */
static int measure(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                   uint64_t count, uint64_t totals[2], uint64_t *each, uint64_t *step)
{
    uint64_t size = (uint64_t)world->link.size;
    uint64_t slices = size * SLICES_OF_RANK;
    slices = slices > SLICES_MAX ? SLICES_MAX : slices;
    slices = slices < 16 * size ? 16 * size : slices;
    totals[0] = 0;
    totals[1] = count;
    for (uint64_t i = 0; i < count; i++) {
        totals[0] += leaves[i].weight;
    }
    int status = ranks_sum(&world->link, totals, 2);
    *each = totals[1] > 0 ? totals[0] / totals[1] + 1 : 1;
    *step = (totals[0] + *each * totals[1]) / slices + 1;
    return status;
}

/* The places at which slices begin, as far as this rank sees. Ranks begin at different
 * parts of a step, so that slices are short where all have leaves, too. */
static uint64_t sample(const struct pccd_mpi *world,
                       const struct ranks_leaf_in_transit *leaves, uint64_t count,
                       uint64_t each, uint64_t step, uint64_t *places)
{
    uint64_t found = 0;
    uint64_t at = step / (uint64_t)world->link.size * (uint64_t)world->link.rank;
    for (uint64_t i = 0; i < count; i++) {
        uint64_t next = at + leaves[i].weight + each;
        if (next / step > at / step) {
            if (places != NULL) {
                places[found] = leaves[i].place;
            }
            found++;
        }
        at = next;
    }
    return found;
}

/* In order, each once; the last slice has no end. */
static int sort_ends(struct pccd_mpi *world, const uint64_t *places, uint64_t count,
                     struct ranks_pieces *pieces)
{
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    pieces->ends = ranks_array(count + 1, sizeof *pieces->ends);
    if (keys == NULL || pieces->ends == NULL) {
        free(keys);
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] = (struct ranks_key){places[i], i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    for (uint64_t i = 0; i < count; i++) {
        if (pieces->count == 0 || sorted[i].key != pieces->ends[pieces->count - 1]) {
            pieces->ends[pieces->count++] = sorted[i].key;
        }
    }
    pieces->ends[pieces->count++] = UINT64_MAX;
    free(keys);
    return PCCD_OK;
}

static int slice(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                 uint64_t count, uint64_t totals[2], struct ranks_pieces *pieces)
{
    struct ranks_link *link = &world->link;
    uint64_t each, step;
    uint64_t *all = NULL;
    int status = measure(world, leaves, count, totals, &each, &step);
    if (status != PCCD_OK) {
        return status;
    }
    uint64_t found = sample(world, leaves, count, each, step, NULL);
    uint64_t *places = ranks_array(found, sizeof *places);
    uint64_t *first = ranks_array((uint64_t)link->size + 1, sizeof *first);
    status = ranks_agree_memory(world, places != NULL && first != NULL);
    if (status == PCCD_OK) {
        (void)sample(world, leaves, count, each, step, places);
        status = ranks_spread(link, sizeof *places, places, found, (void **)&all, first);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(link, sort_ends(world, all, first[link->size], pieces));
    }
    free(places);
    free(first);
    free(all);
    return status;
}

/* Fill the table with what each slice has, of all ranks. */
static int fill(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                uint64_t count, const struct ranks_pieces *pieces, struct table *table)
{
    uint64_t slices = pieces->count, at = 0;
    table->count = slices;
    table->weights = calloc(2 * slices, sizeof(uint64_t));
    table->order = ranks_array(2 * slices, sizeof(uint64_t));
    table->sums[0] = ranks_array(2 * (slices + 1), sizeof(uint64_t));
    int status = ranks_agree_memory(
        world, table->weights != NULL && table->order != NULL && table->sums[0] != NULL);
    if (status != PCCD_OK) {
        return status;
    }
    table->leaves = table->weights + slices;
    table->scratch = table->order + slices;
    table->sums[1] = table->sums[0] + slices + 1;
    for (uint64_t i = 0; i < count; i++) {
        while (leaves[i].place >= pieces->ends[at]) {
            at++;
        }
        table->weights[at] += leaves[i].weight;
        table->leaves[at]++;
    }
    for (uint64_t i = 0; i < slices; i++) {
        table->order[i] = i;
    }
    return ranks_sum(&world->link, table->weights, (int)(2 * slices));
}

/* ---- halves ----------------------------------------------------------------------- */

/* Return the weights or leaves from place `begin` of the group to `end`, which may be
 * behind its last one and goes on at its first one then. */
static uint64_t between(const uint64_t *sums, uint64_t count, uint64_t begin,
                        uint64_t end)
{
    return end <= count ? sums[end] - sums[begin]
                        : sums[count] - sums[begin] + sums[end - count];
}

/* By how many leaves the half that has more of them than it may has too many. */
static uint64_t excess(const struct table *table, const struct group *group, uint64_t arc,
                       uint32_t ranks)
{
    uint64_t rest = table->sums[1][group->count] - arc;
    uint64_t arc_max = table->leaves_max * ranks;
    uint64_t rest_max = table->leaves_max * (group->ranks - ranks);
    uint64_t more = arc > arc_max ? arc - arc_max : 0;
    return rest > rest_max && rest - rest_max > more ? rest - rest_max : more;
}

/* Where the arc of the first `ranks` of a group begins; *length: how many slices it is.
 */
static uint64_t find_arc(const struct table *table, const struct group *group,
                         uint32_t ranks, uint64_t *length)
{
    const uint64_t *weights = table->sums[0];
    uint64_t count = group->count, total = weights[count], end = 0;
    uint64_t wanted =
        total / group->ranks * ranks + total % group->ranks * ranks / group->ranks;
    uint64_t best = 0, best_excess = UINT64_MAX, best_way = UINT64_MAX;
    *length = 0;
    for (uint64_t begin = 0; begin < count; begin++) {
        end = end < begin ? begin : end;
        while (end < begin + count && between(weights, count, begin, end) < wanted) {
            end++;
        }
        /* Whether with the last slice or without, whichever is nearer. */
        uint64_t with = between(weights, count, begin, end);
        uint64_t without = end > begin ? between(weights, count, begin, end - 1) : with;
        uint64_t to = with - wanted > wanted - without ? end - 1 : end;
        uint64_t more =
            excess(table, group, between(table->sums[1], count, begin, to), ranks);
        uint64_t way = begin < count - begin ? begin : count - begin;
        if (more < best_excess || (more == best_excess && way < best_way)) {
            best = begin;
            best_excess = more;
            best_way = way;
            *length = to - begin;
        }
    }
    return best;
}

/* The arc to the front of the group's places. */
static void turn(struct table *table, const struct group *group, uint64_t begin)
{
    uint64_t *order = table->order + group->first;
    memcpy(table->scratch, order, begin * sizeof *order);
    memmove(order, order + begin, (group->count - begin) * sizeof *order);
    memcpy(order + group->count - begin, table->scratch, begin * sizeof *order);
}

static void sum_up(struct table *table, const struct group *group)
{
    table->sums[0][0] = table->sums[1][0] = 0;
    for (uint64_t i = 0; i < group->count; i++) {
        uint64_t at = table->order[group->first + i];
        table->sums[0][i + 1] = table->sums[0][i] + table->weights[at];
        table->sums[1][i + 1] = table->sums[1][i] + table->leaves[at];
    }
}

/* Whoever is alone has its slices; of others the second half waits in `waiting`, which
 * has a place for each rank. */
static void deal(struct table *table, struct group *waiting, uint32_t ranks,
                 struct ranks_pieces *pieces)
{
    uint32_t count = 1;
    waiting[0] = (struct group){0, table->count, 0, ranks};
    while (count > 0) {
        struct group group = waiting[--count];
        if (group.ranks == 1) {
            for (uint64_t i = 0; i < group.count; i++) {
                pieces->rank[table->order[group.first + i]] = group.rank;
            }
            continue;
        }
        uint32_t half = group.ranks / 2;
        uint64_t length;
        sum_up(table, &group);
        turn(table, &group, find_arc(table, &group, half, &length));
        waiting[count++] = (struct group){group.first + length, group.count - length,
                                          group.rank + half, group.ranks - half};
        waiting[count++] = (struct group){group.first, length, group.rank, half};
    }
}

int ranks_pieces_find(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                      uint64_t count, struct ranks_pieces *pieces)
{
    struct ranks_link *link = &world->link;
    struct table table = {.count = 0};
    struct group *waiting = NULL;
    uint64_t totals[2];
    *pieces = (struct ranks_pieces){.count = 0};
    int status = slice(world, leaves, count, totals, pieces);
    if (status == PCCD_OK) {
        status = fill(world, leaves, count, pieces, &table);
    }
    if (status == PCCD_OK) {
        table.leaves_max = LEAVES_MAX(totals[1] / (uint64_t)link->size);
        waiting = ranks_array((uint64_t)link->size, sizeof *waiting);
        pieces->rank = ranks_array(pieces->count, sizeof *pieces->rank);
        status = ranks_agree_memory(world, waiting != NULL && pieces->rank != NULL);
    }
    if (status == PCCD_OK) {
        deal(&table, waiting, (uint32_t)link->size, pieces);
    }
    free(waiting);
    table_deinit(&table);
    if (status != PCCD_OK) {
        ranks_pieces_deinit(pieces);
    }
    return status;
}
