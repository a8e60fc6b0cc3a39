/* median.c - split a list at its median along an axis.
 *
 * Quickselect, with a pivot near the median from a sample; a range that does not shrink
 * as it should is sorted instead, so that no arrangement of triangles, chance or malice,
 * costs quadratic time.
 */
#include "median.h"

#include <assert.h>
#include <string.h>

#include "aabb.h"

/* Items up to which a list is sorted: a pivot would not save anything. */
#define SORTED_MAX 16u

/* Among how many of the items the pivot is chosen, and how far from the middle of these,
 * a deviation and more; of so many and more items. */
#define MANY_MIN    32768u
#define MANY_SAMPLE 127u
#define MANY_BEYOND 8u
#define SOME_MIN    512u
#define SOME_SAMPLE 31u
#define SOME_BEYOND 3u
#define NINE_MIN    64u /* of nine the middle one; below that of three */

/* Items that are divided by means of a copy; of more, those that are on the wrong side
 * are found block by block from both ends. */
#define COPIED_MAX 256u
#define BLOCK      64u

/* Bounds found beside each other: each waits for the one before. */
#define WAYS 4u

/* Without a branch: which way it would go cannot be foreseen. */
static inline bool is_before(const struct eng_split_item *a,
                             const struct eng_split_item *b, int axis)
{
    float x = a->centroid[axis];
    float y = b->centroid[axis];
    return (x < y) | ((x == y) & (a->id < b->id));
}

static void swap_items(struct eng_split_item *a, struct eng_split_item *b)
{
    struct eng_split_item t = *a;
    *a = *b;
    *b = t;
}

/* Let items[root] sink to its place in the heap of `count` items. */
static void sift_down(struct eng_split_item *items, uint32_t root, uint32_t count,
                      int axis)
{
    for (;;) {
        uint64_t child = 2 * (uint64_t)root + 1;
        if (child >= count) {
            return;
        }
        uint32_t larger = (uint32_t)child;
        if (child + 1 < count && is_before(&items[child], &items[child + 1], axis)) {
            larger++;
        }
        if (!is_before(&items[root], &items[larger], axis)) {
            return;
        }
        swap_items(&items[root], &items[larger]);
        root = larger;
    }
}

static void heap_sort(struct eng_split_item *items, uint32_t count, int axis)
{
    for (uint32_t i = count / 2; i-- > 0;) {
        sift_down(items, i, count, axis);
    }
    for (uint32_t i = count; i-- > 1;) {
        swap_items(&items[0], &items[i]);
        sift_down(items, 0, i, axis);
    }
}

static void insertion_sort(struct eng_split_item *items, uint32_t count, int axis)
{
    for (uint32_t i = 1; i < count; i++) {
        struct eng_split_item item = items[i];
        uint32_t place = i;
        while (place > 0 && is_before(&item, &items[place - 1], axis)) {
            items[place] = items[place - 1];
            place--;
        }
        items[place] = item;
    }
}

/* Swap the median of three items with the last of them. */
static void median_last(struct eng_split_item *items, uint32_t a, uint32_t b,
                        uint32_t last, int axis)
{
    bool ab = is_before(&items[a], &items[b], axis);
    bool al = is_before(&items[a], &items[last], axis);
    bool bl = is_before(&items[b], &items[last], axis);
    swap_items(&items[ab == bl ? b : ab == al ? last : a], &items[last]);
}

/* Items from low up to the pivot's place come before it, up to high not: by a copy of the
 * latter. Returns the place. */
static uint32_t divide_few(struct eng_split_item *items, uint32_t low, uint32_t high,
                           const struct eng_split_item *pivot,
                           const struct eng_median *median)
{
    struct eng_split_item behind[COPIED_MAX];
    uint32_t place = low, count = 0;
    assert(high - low <= COPIED_MAX);
    for (uint32_t first = low; first < high; first += BLOCK) {
        uint32_t end = high - first < BLOCK ? high : first + BLOCK;
        uint64_t before = 0;
        if (end - first == BLOCK) {
            before = median->come_before(items + first, pivot, median->axis);
        }
        for (uint32_t i = first; i < end && end - first < BLOCK; i++) {
            before |= (uint64_t)is_before(&items[i], pivot, median->axis) << (i - first);
        }
        for (uint32_t i = first; i < end; i++, before >>= 1) {
            struct eng_split_item item = items[i];
            items[place] = item;
            behind[count] = item;
            place += (uint32_t)(before & 1);
            count += (uint32_t)(~before & 1);
        }
    }
    memcpy(items + place, behind, count * sizeof *items);
    return place;
}

/* The same of many: what is on the wrong side changes places with what is on the other
 * one. */
static uint32_t divide_many(struct eng_split_item *items, uint32_t low, uint32_t high,
                            const struct eng_split_item *pivot,
                            const struct eng_median *median)
{
    uint64_t left = 0, right = 0; /* bits of the wrong ones of a block at each end */
    bool has_left = false, has_right = false;
    while (high - low >= COPIED_MAX) {
        struct eng_split_item *last = items + high - BLOCK;
        left = has_left ? left : ~median->come_before(items + low, pivot, median->axis);
        right = has_right ? right : median->come_before(last, pivot, median->axis);
        for (; left != 0 && right != 0; left &= left - 1, right &= right - 1) {
            swap_items(&items[low + (uint32_t)__builtin_ctzll(left)],
                       &last[__builtin_ctzll(right)]);
        }
        has_left = left != 0;
        has_right = right != 0;
        low += has_left ? 0 : BLOCK;
        high -= has_right ? 0 : BLOCK;
    }
    return divide_few(items, low, high, pivot, median);
}

/* Bring an item to items[high] that is likely to be a little beyond the middle, seen from
 * the nearer end: what has to be looked at again is then little more than what is between
 * them. */
static void choose_pivot(struct eng_split_item *items, uint32_t low, uint32_t high,
                         uint32_t middle, int axis)
{
    struct eng_split_item sample[MANY_SAMPLE];
    uint32_t count = high - low + 1;
    uint32_t size = count >= MANY_MIN ? MANY_SAMPLE : SOME_SAMPLE;
    uint32_t beyond = count >= MANY_MIN ? MANY_BEYOND : SOME_BEYOND;
    uint32_t rank = (uint32_t)((uint64_t)(middle - low) * size / count);
    for (uint32_t i = 0; i < size; i++) {
        uint32_t at = low + i * (count / size);
        sample[i].centroid[0] = items[at].centroid[axis];
        memcpy(&sample[i].centroid[1], &at, sizeof at); /* it is not compared */
        sample[i].id = items[at].id;
    }
    insertion_sort(sample, size, 0);
    rank = rank < size / 2 ? rank + beyond : rank < beyond ? 0 : rank - beyond;
    uint32_t at;
    memcpy(&at, &sample[rank].centroid[1], sizeof at);
    swap_items(&items[at], &items[high]);
}

/* Divide items[low .. high] at one of them, and return its place then. */
static uint32_t divide(struct eng_split_item *items, const struct eng_median *median)
{
    uint32_t low = median->low, high = median->high;
    uint32_t count = high - low + 1;
    int axis = median->axis;
    if (count >= SOME_MIN) {
        choose_pivot(items, low, high, median->middle, axis);
    } else if (count >= NINE_MIN) {
        uint32_t part = count / 8;
        median_last(items, low, low + part, low + 2 * part, axis);
        median_last(items, low + 3 * part, low + 4 * part, low + 5 * part, axis);
        median_last(items, low + 6 * part, low + 7 * part, high, axis);
        median_last(items, low + 2 * part, low + 5 * part, high, axis);
    } else {
        median_last(items, low, low + count / 2, high, axis);
    }
    struct eng_split_item pivot = items[high];
    uint32_t place = count > COPIED_MAX ? divide_many(items, low, high, &pivot, median)
                                        : divide_few(items, low, high, &pivot, median);
    swap_items(&items[high], &items[place]);
    return place;
}

void eng_median_begin(struct eng_median *median, uint32_t count, uint32_t middle,
                      int axis, eng_come_before_fn *come_before)
{
    assert(count >= 1 && middle <= count && axis >= 0 && axis <= 2);
    *median = (struct eng_median){middle, axis, come_before, 0, count - 1, 16};
    for (uint32_t n = count; n > 0; n /= 2) {
        median->rounds_left += 2;
    }
}

bool eng_median_round(struct eng_median *median, struct eng_split_item *items)
{
    uint32_t low = median->low;
    uint32_t count = median->high - low + 1;
    if (count <= SORTED_MAX) {
        insertion_sort(items + low, count, median->axis);
        return true;
    }
    if (median->rounds_left-- == 0) {
        heap_sort(items + low, count, median->axis);
        return true;
    }
    /* Neither bound crosses the other: the median lies between them. */
    uint32_t place = divide(items, median);
    if (median->middle < place) {
        median->high = place - 1;
    } else {
        median->low = place + 1;
    }
    return median->middle == place;
}

void eng_median_split(struct eng_split_item *items, uint32_t count, uint32_t middle,
                      int axis, eng_come_before_fn *come_before)
{
    struct eng_median median;
    eng_median_begin(&median, count, middle, axis, come_before);
    while (!eng_median_round(&median, items)) {
    }
}

int eng_median_axis(const struct eng_split_item *items, uint32_t count)
{
    assert(count >= 1);
    eng_f4 lo[WAYS], hi[WAYS]; /* of the ids too, which are not looked at */
    for (uint32_t way = 0; way < WAYS; way++) {
        memcpy(&lo[way], &items[0], sizeof *lo);
        hi[way] = lo[way];
    }
    for (uint32_t i = 0; i + WAYS <= count; i += WAYS) {
        for (uint32_t way = 0; way < WAYS; way++) {
            eng_f4 item;
            memcpy(&item, &items[i + way], sizeof item);
            lo[way] = eng_min4(lo[way], item);
            hi[way] = eng_max4(hi[way], item);
        }
    }
    for (uint32_t i = count - count % WAYS; i < count; i++) {
        eng_f4 item;
        memcpy(&item, &items[i], sizeof item);
        lo[0] = eng_min4(lo[0], item);
        hi[0] = eng_max4(hi[0], item);
    }
    for (uint32_t way = 1; way < WAYS; way++) {
        lo[0] = eng_min4(lo[0], lo[way]);
        hi[0] = eng_max4(hi[0], hi[way]);
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (hi[0][k] - lo[0][k] > hi[0][axis] - lo[0][axis]) {
            axis = k;
        }
    }
    return axis;
}
