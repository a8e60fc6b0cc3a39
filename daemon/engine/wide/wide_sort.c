/* wide_sort.c - splits at medians, and of many items by lists that are sorted once.
 *
 * The order does not depend on how many threads made it: each split is of a list that
 * they do not change.
 *
 * To sort an item along three axes takes some 150 instructions, and 25 for each time that
 * its range is halved. To look for medians among items that are not sorted takes 75 for
 * each time, and less only in long ranges.
 */
#include "wide_sort.h"

#include <assert.h>
#include <omp.h>
#include <string.h>

#include "boxes.h"
#include "kernel.h"
#include "parallel.h"

/* Parts for each thread, so that they end together. */
#define PARTS_PER_THREAD 8u
#define PART_SPLIT_MIN   (4 * ENG_WIDE_LISTS_MIN)

/* Return whether a range is across a multiple of `step` slots, so that it is to be split
 * there; a power of two. */
static bool is_across(struct eng_wide_range range, uint64_t step)
{
    return (range.slot & (step - 1)) + range.count > step;
}

/* Return how many items of a range across a multiple of `least` come before the split,
 * which is at a multiple of the largest power of 16 at which there can be one. */
static uint32_t middle_of(struct eng_wide_range range, uint32_t least)
{
    uint64_t step = least;
    while (is_across(range, step * ENG_WIDE)) {
        step *= ENG_WIDE;
    }
    uint64_t middle = ((uint64_t)range.slot + range.count / 2 + step / 2) & -step;
    assert(middle > range.slot && middle - range.slot < range.count);
    return (uint32_t)(middle - range.slot);
}

static struct eng_wide_range behind(struct eng_wide_range range, uint32_t middle)
{
    return (struct eng_wide_range){range.first + middle, range.slot + middle,
                                   range.count - middle};
}

static void write_ids(const struct eng_split_item *items, struct eng_wide_range range,
                      uint32_t *ids)
{
    for (size_t i = range.first; i < range.first + range.count; i++) {
        ids[i] = items[i].id;
    }
}

/* ---- lists ------------------------------------------------------------------------- */

#define INDEX_BITS 16u
static_assert(ENG_WIDE_LISTS_MAX <= 1u << INDEX_BITS, "indices");

/* In the order of floats; both zeros are the same. */
static uint32_t key_of(float x)
{
    float sum = x + 0.0f;
    uint32_t bits;
    memcpy(&bits, &sum, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

/* Sort words, each a key above the index of an item: to indices[]. Keys differ in these
 * bits. */
static void sort_words(struct eng_wide_lists *lists, uint32_t count, uint32_t differ,
                       uint16_t *indices)
{
    const uint64_t *words = lists->words[0];
    if (differ != 0) {
        unsigned low = (unsigned)__builtin_ctz(differ);
        unsigned bits = 32 - (unsigned)__builtin_clz(differ) - low;
        words = eng_radix_sort_words(lists->words[0], lists->words[1], count,
                                     INDEX_BITS + low, bits);
    }
    for (uint32_t i = 0; i < count; i++) {
        indices[i] = (uint16_t)words[i];
    }
}

/* The indices of the items by their ids: which of two comes first that are beside each
 * other. */
static void sort_ids(struct eng_wide_lists *lists, const struct eng_split_item *items,
                     uint32_t count, uint16_t *indices)
{
    uint32_t differ = 0;
    bool is_sorted = true;
    for (uint32_t i = 0; i < count; i++) {
        is_sorted = is_sorted && (i == 0 || items[i - 1].id < items[i].id);
        differ |= items[i].id ^ items[0].id;
        lists->words[0][i] = (uint64_t)items[i].id << INDEX_BITS | i;
    }
    sort_words(lists, count, is_sorted ? 0 : differ, indices);
}

/* From the order of the ids to that along an axis. */
static void sort_axis(struct eng_wide_lists *lists, const struct eng_split_item *items,
                      uint32_t count, int axis, const uint16_t *by_id, uint16_t *indices)
{
    uint32_t differ = 0;
    uint32_t first = key_of(items[0].centroid[axis]);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t key = key_of(items[by_id[i]].centroid[axis]);
        differ |= key ^ first;
        lists->words[0][i] = (uint64_t)key << INDEX_BITS | by_id[i];
    }
    sort_words(lists, count, differ, indices);
}

/* The axis along which a range extends most, as eng_median_axis says. */
static int axis_of(const struct eng_wide_lists *lists, const struct eng_split_item *items,
                   size_t first, uint32_t count)
{
    int axis = 0;
    float most = 0;
    for (int k = 0; k < 3; k++) {
        const uint16_t *indices = lists->sorted[k] + first;
        float extent =
            items[indices[count - 1]].centroid[k] - items[indices[0]].centroid[k];
        if (k == 0 || extent > most) {
            axis = k;
            most = extent;
        }
    }
    return axis;
}

/* Those of the first half stay in front, in their order, the others go behind. */
static void divide(struct eng_wide_lists *lists, uint16_t *indices, uint32_t count)
{
    size_t behind = 0;
    for (size_t i = 0; i < count; i++) {
        uint16_t index = indices[i];
        indices[i - behind] = index;
        lists->second[behind] = index;
        behind += lists->is_second[index];
    }
    memcpy(indices + count - behind, lists->second, behind * sizeof *indices);
}

static void list_ids(struct eng_wide_lists *lists, const struct eng_split_item *items,
                     struct eng_wide_range range, int axis)
{
    const uint16_t *indices = lists->sorted[axis] + range.first;
    for (uint32_t i = 0; i < range.count; i++) {
        lists->id[range.first + i] = items[indices[i]].id;
    }
}

/* Split a range, whose first item is the first of the lists: the halves that are to be
 * split, too, go to halves[]; returns how many. */
static uint32_t halve(struct eng_wide_lists *lists, const struct eng_split_item *items,
                      struct eng_wide_range range, struct eng_wide_range halves[2])
{
    int axis = axis_of(lists, items, range.first, range.count);
    uint32_t middle = middle_of(range, ENG_WIDE);
    const uint16_t *along = lists->sorted[axis] + range.first;
    const struct eng_wide_range both[2] = {
        {range.first, range.slot, middle},
        {range.first + middle, range.slot + middle, range.count - middle}};
    uint32_t waiting = 0;
    for (int half = 0; half < 2; half++) {
        if (is_across(both[half], ENG_WIDE)) {
            halves[waiting++] = both[half];
        } else {
            list_ids(lists, items, both[half], axis);
        }
    }
    if (waiting > 0) {
        for (uint32_t i = 0; i < middle; i++) {
            lists->is_second[along[i]] = 0;
        }
        for (uint32_t i = middle; i < range.count; i++) {
            lists->is_second[along[i]] = 1;
        }
        for (int k = 1; k < 3; k++) {
            divide(lists, lists->sorted[(axis + k) % 3] + range.first, range.count);
        }
    }
    return waiting;
}

void eng_wide_lists_sort(struct eng_wide_lists *lists, const struct eng_split_item *items,
                         struct eng_wide_range range, uint32_t *ids)
{
    struct eng_wide_range stack[64]; /* as in struct eng_wide_sorter */
    uint32_t waiting = 1;
    assert(range.count > 0 && range.count <= ENG_WIDE_LISTS_MAX);
    if (!is_across(range, ENG_WIDE)) {
        write_ids(items, range, ids);
        return;
    }
    items += range.first;
    lists->id = ids + range.first;
    sort_ids(lists, items, range.count, lists->second);
    for (int k = 0; k < 3; k++) {
        sort_axis(lists, items, range.count, k, lists->second, lists->sorted[k]);
    }
    stack[0] = (struct eng_wide_range){0, range.slot, range.count};
    while (waiting > 0) {
        waiting--;
        struct eng_wide_range halves[2];
        uint32_t count = halve(lists, items, stack[waiting], halves);
        assert(waiting + count <= sizeof stack / sizeof *stack);
        memcpy(stack + waiting, halves, count * sizeof *halves);
        waiting += count;
    }
}

/* ---- ranges ------------------------------------------------------------------------ */

/* Split a part that is across a multiple of `least` in two; returns the second, or an
 * empty one. */
static struct eng_wide_range split(struct eng_split_item *items,
                                   struct eng_wide_range *part, uint32_t least)
{
    struct eng_wide_range second = behind(*part, part->count);
    if (is_across(*part, least)) {
        struct eng_split_item *first = items + part->first;
        uint32_t middle = middle_of(*part, least);
        eng_median_split(first, part->count, middle, eng_median_axis(first, part->count),
                         eng_kernels()->come_before);
        second = behind(*part, middle);
        part->count = middle;
    }
    return second;
}

void eng_wide_sorter_begin(struct eng_wide_sorter *sorter, struct eng_wide_range range,
                           uint32_t least)
{
    assert(least == 1 || least == 16);
    sorter->least = least;
    sorter->waiting = 1;
    sorter->stack[0] = range;
    sorter->is_splitting = false;
}

/* A range is split near its middle, so that of n < 2^32 items no more wait at a time than
 * there are levels, and one. */
static void push(struct eng_wide_sorter *sorter, struct eng_wide_range range)
{
    assert(sorter->waiting < sizeof sorter->stack / sizeof *sorter->stack);
    sorter->stack[sorter->waiting++] = range;
}

static void sort_range(struct eng_split_item *items, struct eng_wide_range all,
                       uint32_t least)
{
    struct eng_wide_sorter sorter;
    eng_wide_sorter_begin(&sorter, all, least);
    while (sorter.waiting > 0) {
        struct eng_wide_range range = sorter.stack[--sorter.waiting];
        if (is_across(range, least)) {
            struct eng_wide_range second = split(items, &range, least);
            push(&sorter, second);
            push(&sorter, range);
        }
    }
}

/* The same of a part whose places are not needed any more, to ids[]. */
static void sort_part(struct eng_split_item *items, struct eng_wide_range part,
                      struct eng_wide_lists *lists, uint32_t *ids)
{
    struct eng_wide_sorter sorter;
    eng_wide_sorter_begin(&sorter, part, ENG_WIDE);
    while (sorter.waiting > 0) {
        struct eng_wide_range range = sorter.stack[--sorter.waiting];
        if (range.count > ENG_WIDE_LISTS_MAX && lists) {
            struct eng_wide_range second = split(items, &range, ENG_WIDE);
            push(&sorter, second);
            push(&sorter, range);
        } else if (lists && range.count >= ENG_WIDE_LISTS_MIN) {
            eng_wide_lists_sort(lists, items, range, ids);
        } else {
            sort_range(items, range, ENG_WIDE);
            write_ids(items, range, ids);
        }
    }
}

/* One more pass over the range that is being split. */
static void pass(struct eng_wide_sorter *sorter, struct eng_split_item *items)
{
    struct eng_wide_range range = sorter->range;
    if (eng_median_round(&sorter->median, items + range.first)) {
        struct eng_wide_range second = behind(range, sorter->median.middle);
        range.count = sorter->median.middle;
        push(sorter, second);
        push(sorter, range);
        sorter->is_splitting = false;
    }
}

bool eng_wide_sorter_advance(struct eng_wide_sorter *sorter, struct eng_split_item *items,
                             uint32_t whole)
{
    if (sorter->is_splitting) {
        pass(sorter, items);
        return true;
    }
    if (sorter->waiting == 0) {
        return false;
    }
    struct eng_wide_range range = sorter->stack[--sorter->waiting];
    if (range.count <= whole) {
        sort_range(items, range, sorter->least);
    } else if (is_across(range, sorter->least)) {
        sorter->range = range;
        sorter->is_splitting = true;
        eng_median_begin(&sorter->median, range.count, middle_of(range, sorter->least),
                         eng_median_axis(items + range.first, range.count),
                         eng_kernels()->come_before);
    }
    return true;
}

void eng_wide_sort(struct eng_split_item *items, uint32_t count, uint32_t least)
{
    assert(least == 1 || least == 16);
    sort_range(items, (struct eng_wide_range){0, 0, count}, least);
}

/* No part is split here that has too few items for lists to take both halves: they alone
 * decide how the items of a group follow each other. */
void eng_wide_sort_parts(struct eng_split_item *items, struct eng_wide_range *parts,
                         uint32_t count, int threads, struct eng_wide_lists *lists,
                         uint32_t *ids)
{
    struct eng_parallel region = eng_parallel_open();
    while (threads > 1 && count < (uint32_t)threads * PARTS_PER_THREAD &&
           2 * count <= ENG_WIDE_PARTS_MAX) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (uint32_t i = 0; i < count; i++) {
            ENG_PARALLEL_JOIN(region);
            parts[count + i] = parts[i].count >= PART_SPLIT_MIN
                                   ? split(items, &parts[i], ENG_WIDE)
                                   : behind(parts[i], parts[i].count);
        }
        count *= 2;
    }
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++) {
        ENG_PARALLEL_JOIN(region);
        sort_part(items, parts[i], lists ? lists + omp_get_thread_num() : NULL, ids);
    }
    eng_parallel_close();
}
