/* daemon/engine/base/median.c - split a list at its median along an axis.
 *
 * Room:     engine.
 * Does:     quickselect with the median of three or nine as pivot; a range that does not
 *           shrink as it should is sorted instead, so that no arrangement of triangles,
 *           chance or malice, costs quadratic time.
 * Threads:  [any].
 */
#include "median.h"

#include <assert.h>
#include <string.h>

#include "aabb.h"

/* Items up to which a list is sorted: a pivot would not save anything. */
#define SORTED_MAX 16u

/* Items from which nine of them choose the pivot instead of three. */
#define NINE_MIN 64u

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

/* Divide items[low .. high] at one of them, and return its place then. */
static uint32_t divide(struct eng_split_item *items, uint32_t low, uint32_t high,
                       int axis)
{
    uint32_t count = high - low + 1;
    if (count >= NINE_MIN) {
        uint32_t part = count / 8;
        median_last(items, low, low + part, low + 2 * part, axis);
        median_last(items, low + 3 * part, low + 4 * part, low + 5 * part, axis);
        median_last(items, low + 6 * part, low + 7 * part, high, axis);
        median_last(items, low + 2 * part, low + 5 * part, high, axis);
    } else {
        median_last(items, low, low + count / 2, high, axis);
    }
    struct eng_split_item pivot = items[high];
    uint32_t place = low;
    for (uint32_t i = low; i < high; i++) {
        bool before = is_before(&items[i], &pivot, axis);
        swap_items(&items[i], &items[place]);
        place += before;
    }
    swap_items(&items[high], &items[place]);
    return place;
}

void eng_median_begin(struct eng_median *median, uint32_t count, uint32_t middle,
                      int axis)
{
    assert(count >= 1 && middle <= count && axis >= 0 && axis <= 2);
    *median = (struct eng_median){middle, axis, 0, count - 1, 16};
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
    uint32_t place = divide(items, low, median->high, median->axis);
    if (median->middle < place) {
        median->high = place - 1;
    } else {
        median->low = place + 1;
    }
    return median->middle == place;
}

void eng_median_split(struct eng_split_item *items, uint32_t count, uint32_t middle,
                      int axis)
{
    struct eng_median median;
    eng_median_begin(&median, count, middle, axis);
    while (!eng_median_round(&median, items)) {
    }
}

int eng_median_axis(const struct eng_split_item *items, uint32_t count)
{
    assert(count >= 1);
    eng_f4 lo; /* of the ids too, which are not looked at */
    memcpy(&lo, &items[0], sizeof lo);
    eng_f4 hi = lo;
    for (uint32_t i = 1; i < count; i++) {
        eng_f4 item;
        memcpy(&item, &items[i], sizeof item);
        lo = eng_min4(lo, item);
        hi = eng_max4(hi, item);
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (hi[k] - lo[k] > hi[axis] - lo[axis]) {
            axis = k;
        }
    }
    return axis;
}
