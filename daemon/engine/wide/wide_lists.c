/* wide_lists.c - splits of lists that are sorted along each axis.
 *
 * To sort an item along three axes takes some 150 instructions, and 25 for each time that
 * its range is halved. To look for medians among items that are not sorted takes 75 for
 * each time, and less only in long ranges.
 */
#include "wide_lists.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

#include "radix.h"

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

static void write_ids(struct eng_wide_lists *lists, const struct eng_split_item *items,
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
                      struct eng_wide_range range, uint32_t least,
                      struct eng_wide_range halves[2])
{
    int axis = axis_of(lists, items, range.first, range.count);
    uint32_t middle = eng_wide_middle_of(range, least);
    const uint16_t *along = lists->sorted[axis] + range.first;
    const struct eng_wide_range both[2] = {
        {range.first, range.slot, middle},
        {range.first + middle, range.slot + middle, range.count - middle}};
    uint32_t waiting = 0;
    for (int half = 0; half < 2; half++) {
        if (eng_wide_is_across(both[half], least)) {
            halves[waiting++] = both[half];
        } else {
            write_ids(lists, items, both[half], axis);
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

void eng_wide_lists_sort(struct eng_wide_lists *lists, struct eng_split_item *items,
                         struct eng_wide_range range, uint32_t least)
{
    struct eng_wide_range stack[64]; /* as in struct eng_wide_sorter */
    uint32_t waiting = 1;
    assert(range.count > 0 && range.count <= ENG_WIDE_LISTS_MAX);
    if (!eng_wide_is_across(range, least)) {
        return;
    }
    items += range.first;
    sort_ids(lists, items, range.count, lists->second);
    for (int k = 0; k < 3; k++) {
        sort_axis(lists, items, range.count, k, lists->second, lists->sorted[k]);
    }
    stack[0] = (struct eng_wide_range){0, range.slot, range.count};
    while (waiting > 0) {
        waiting--;
        struct eng_wide_range halves[2];
        uint32_t count = halve(lists, items, stack[waiting], least, halves);
        assert(waiting + count <= sizeof stack / sizeof *stack);
        memcpy(stack + waiting, halves, count * sizeof *halves);
        waiting += count;
    }
    for (uint32_t i = 0; i < range.count; i++) {
        items[i].id = lists->id[i];
    }
}
