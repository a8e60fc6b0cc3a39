/* daemon/engine/tree/median.c - split a list at its median along an axis.
 *
 * Room:     engine.
 * Does:     quickselect with the median of three as pivot; a range that does not shrink
 *           as it should is sorted instead, so that no arrangement of triangles, chance
 *           or malice, costs quadratic time.
 * Threads:  [any].
 */
#include "median.h"

#include <string.h>

static bool is_before(const struct eng_split_item *a, const struct eng_split_item *b,
                      int axis)
{
    return a->centroid[axis] != b->centroid[axis] ? a->centroid[axis] < b->centroid[axis]
                                                  : a->id < b->id;
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

/* Median of the first, middle and last item, which are put in order on the way. */
static struct eng_split_item pivot_of(struct eng_split_item *items, uint32_t low,
                                      uint32_t high, int axis)
{
    uint32_t m = low + (high - low) / 2;
    if (is_before(&items[m], &items[low], axis)) {
        swap_items(&items[m], &items[low]);
    }
    if (is_before(&items[high], &items[low], axis)) {
        swap_items(&items[high], &items[low]);
    }
    if (is_before(&items[high], &items[m], axis)) {
        swap_items(&items[high], &items[m]);
    }
    return items[m];
}

/* Divide items[low .. high] at a pivot: those up to *left are none after it, those from
 * *right on none before it. */
static void divide(struct eng_split_item *items, uint32_t low, uint32_t high, int axis,
                   uint32_t *left, uint32_t *right)
{
    struct eng_split_item pivot = pivot_of(items, low, high, axis);
    uint32_t i = low;
    uint32_t j = high;
    while (i <= j) {
        while (is_before(&items[i], &pivot, axis)) {
            i++;
        }
        while (is_before(&pivot, &items[j], axis)) {
            j--;
        }
        if (i <= j) {
            swap_items(&items[i], &items[j]);
            i++;
            if (j == 0) {
                break;
            }
            j--;
        }
    }
    *left = j;
    *right = i;
}

void eng_median_begin(struct eng_median *median, uint32_t count, uint32_t middle,
                      int axis)
{
    *median = (struct eng_median){middle, axis, 0, count - 1, 16};
    for (uint32_t n = count; n > 0; n /= 2) {
        median->rounds_left += 2;
    }
}

bool eng_median_round(struct eng_median *median, struct eng_split_item *items)
{
    uint32_t low = median->low;
    uint32_t high = median->high;
    if (low >= high) {
        return true;
    }
    if (median->rounds_left-- == 0) {
        heap_sort(items + low, high - low + 1, median->axis);
        return true;
    }
    uint32_t left;
    uint32_t right;
    divide(items, low, high, median->axis, &left, &right);
    if (median->middle <= left) {
        median->high = left;
    } else if (median->middle >= right) {
        median->low = right;
    } else {
        return true;
    }
    return false;
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
    float lo[3];
    float hi[3];
    memcpy(lo, items[0].centroid, sizeof lo);
    memcpy(hi, items[0].centroid, sizeof hi);
    for (uint32_t i = 1; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            lo[k] = items[i].centroid[k] < lo[k] ? items[i].centroid[k] : lo[k];
            hi[k] = items[i].centroid[k] > hi[k] ? items[i].centroid[k] : hi[k];
        }
    }
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (hi[k] - lo[k] > hi[axis] - lo[axis]) {
            axis = k;
        }
    }
    return axis;
}
