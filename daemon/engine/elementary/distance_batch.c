/* distance_batch.c - distances of many pairs. */
#include "distance_batch.h"

#include <assert.h>
#include <string.h>

/* Pairs one by one between two looks at the clock: some 50 us. */
#define PAIRS_PER_LOOK 16u

static void load(const struct eng_point *points, const uint32_t *indices, int point_count,
                 uint32_t end, double (*x)[3])
{
    for (int i = 0; i < point_count; i++) {
        const struct eng_point *point = &points[indices[i]];
        memcpy(x[i], end == 0 ? point->x0 : point->x1, sizeof x[i]);
    }
}

/* A point that a face or an edge names twice comes after itself. */
static void rank(const struct eng_point *points, const uint32_t quad[4], uint8_t rank[4])
{
    for (int i = 0; i < 4; i++) {
        rank[i] = 0;
        for (int k = 0; k < 4; k++) {
            uint64_t mine = points[quad[i]].word1;
            uint64_t other = points[quad[k]].word1;
            rank[i] = (uint8_t)(rank[i] + (other < mine || (other == mine && k < i)));
        }
    }
}

/* After the pair that is number `asked` among those: is the rest to be left out? */
static bool stops(struct eng_distance_batch *batch, uint32_t asked, uint64_t integers)
{
    batch->exact += integers;
    return batch->should_stop && (integers > 0 || asked % PAIRS_PER_LOOK == 0) &&
           batch->should_stop(batch->owner);
}

/* One of the pairs that the kernels were not sure of. */
static void ask(const struct eng_distance_question *question,
                const struct eng_point *points, const uint32_t (*quads)[4], uint32_t pair,
                bool is_near, struct eng_distances *distances,
                struct eng_distance_batch *batch, uint32_t *found)
{
    double x[4][3];
    load(points, quads[pair], 4, question->end, x);
    if (!is_near && !eng_distance_within(distances, question->kind, (const double(*)[3])x,
                                         question->distance)) {
        return;
    }
    if (question->wanted != ENG_DISTANCE_WITHIN) {
        uint8_t ranks[4];
        rank(points, quads[pair], ranks);
        eng_distance_find(distances, question->kind, (const double(*)[3])x, ranks,
                          &batch->found[*found]);
    }
    batch->index[(*found)++] = pair;
}

static uint32_t all_of(uint32_t count, uint32_t *pairs)
{
    for (uint32_t i = 0; i < count; i++) {
        pairs[i] = i;
    }
    return count;
}

uint32_t eng_distance_batch_test(const struct eng_kernels *kernels,
                                 const struct eng_distance_question *question,
                                 const struct eng_point *points,
                                 const uint32_t (*quads)[4], uint32_t count,
                                 struct eng_distances *distances,
                                 struct eng_distance_batch *batch)
{
    assert(count <= ENG_CHUNK_MAX && question->end <= 1);
    enum pccd_kind form = eng_distance_form(question->kind);
    struct eng_measured out = {.wanted = question->wanted,
                               .index = batch->index,
                               .found = batch->found,
                               .imprecise = batch->imprecise,
                               .undecided = batch->undecided};
    uint32_t left =
        question->is_sifted
            ? all_of(count, batch->left)
            : kernels->reject_at_end(form, points, quads, count, question->end,
                                     question->distance, batch->left);
    kernels->measure(form, points, quads, batch->left, left, question->end,
                     question->distance, &out);
    uint32_t found = out.near_count;
    bool is_placed = question->wanted == ENG_DISTANCE_WHOLE;
    for (uint32_t i = 0; i < found && is_placed; i++) {
        eng_distance_place(question->kind, &batch->found[i]);
    }
    for (uint32_t i = 0; i < out.imprecise_count + out.undecided_count; i++) {
        uint64_t before = distances->decided[ENG_DISTANCE_BY_INTEGERS];
        bool is_near = i < out.imprecise_count;
        ask(question, points, quads,
            is_near ? batch->imprecise[i] : batch->undecided[i - out.imprecise_count],
            is_near, distances, batch, &found);
        if (stops(batch, i, distances->decided[ENG_DISTANCE_BY_INTEGERS] - before)) {
            break;
        }
    }
    return found;
}

uint32_t eng_distance_batch_cross(const struct eng_kernels *kernels, uint32_t end,
                                  const struct eng_point *points,
                                  const uint32_t (*fives)[5], uint32_t count,
                                  struct eng_distances *distances,
                                  struct eng_distance_batch *batch)
{
    assert(count <= ENG_CHUNK_MAX && end <= 1);
    struct eng_crossed out = {.index = batch->index, .undecided = batch->undecided};
    kernels->cross_faces(points, fives, count, end, &out);
    for (uint32_t i = 0; i < out.undecided_count; i++) {
        uint64_t before = distances->decided[ENG_DISTANCE_BY_INTEGERS];
        double x[5][3];
        load(points, fives[out.undecided[i]], 5, end, x);
        if (eng_distance_crosses(distances, (const double(*)[3])x)) {
            out.index[out.count++] = out.undecided[i];
        }
        if (stops(batch, i, distances->decided[ENG_DISTANCE_BY_INTEGERS] - before)) {
            break;
        }
    }
    return out.count;
}
