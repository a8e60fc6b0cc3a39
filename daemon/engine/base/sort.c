/* sort.c - two ways to sort. */
#include "sort.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

#include "aabb.h"

/* ---- at a median -------------------------------------------------------------------
 *
 * Quickselect, with a pivot near the median from a sample; a range that does not shrink
 * as it should is sorted instead, so that no arrangement of triangles, chance or malice,
 * costs quadratic time. */

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

/* ---- a stable radix sort ----------------------------------------------------------- */

/* Bits of a digit: of more items wider ones, as a pass costs more than its counters. */
#define DIGIT_MAX 9u
#define DIGIT_FEW 8u
#define FEW_ITEMS 512u

/* Items that are sorted sooner by insertion than by passes. */
#define INSERTION_MAX 24u

/* So many items, of keys that differ in few enough bits, are sorted as words of these
 * bits and the item's place: half as many bytes for each pass, which stay in the first
 * cache, so that wider digits pay, too. */
#define PLACE_BITS     12u
#define WORDS_MAX      (1u << PLACE_BITS)
#define WORD_DIGIT_MAX 11u
#define WORD_DIGIT_FEW 9u
#define FEW_WORDS      1024u

static void insert_all(struct eng_radix_key *items, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        struct eng_radix_key item = items[i];
        size_t at = i;
        while (at > 0 && items[at - 1].key > item.key) {
            items[at] = items[at - 1];
            at--;
        }
        items[at] = item;
    }
}

/* Turn the counts of items by digit into the places where the first of each belongs. */
static void begin_digits(uint32_t *offset, uint64_t mask)
{
    uint32_t sum = 0;
    for (size_t d = 0; d <= mask; d++) {
        uint32_t n = offset[d];
        offset[d] = sum;
        sum += n;
    }
}

static void pass(const struct eng_radix_key *from, struct eng_radix_key *to, size_t count,
                 unsigned shift, unsigned bits)
{
    uint32_t offset[1u << DIGIT_MAX];
    uint64_t mask = ((uint64_t)1 << bits) - 1;
    memset(offset, 0, (mask + 1) * sizeof *offset);
    for (size_t i = 0; i < count; i++) {
        offset[from[i].key >> shift & mask]++;
    }
    begin_digits(offset, mask);
    for (size_t i = 0; i < count; i++) {
        to[offset[from[i].key >> shift & mask]++] = from[i];
    }
}

static void word_pass(const uint64_t *from, uint64_t *to, size_t count, unsigned shift,
                      unsigned bits)
{
    uint32_t offset[1u << WORD_DIGIT_MAX];
    uint64_t mask = ((uint64_t)1 << bits) - 1;
    memset(offset, 0, (mask + 1) * sizeof *offset);
    for (size_t i = 0; i < count; i++) {
        offset[from[i] >> shift & mask]++;
    }
    begin_digits(offset, mask);
    for (size_t i = 0; i < count; i++) {
        to[offset[from[i] >> shift & mask]++] = from[i];
    }
}

/* The passes that words of such keys take. */
static unsigned word_digits(size_t count, unsigned bits)
{
    unsigned most = count < FEW_WORDS ? WORD_DIGIT_FEW : WORD_DIGIT_MAX;
    return (bits + most - 1) / most;
}

uint64_t *eng_radix_sort_words(uint64_t *words, uint64_t *spare, size_t count,
                               unsigned low, unsigned bits)
{
    unsigned digits = word_digits(count, bits);
    unsigned size = digits > 0 ? (bits + digits - 1) / digits : 0;
    for (unsigned digit = 0; digit < digits; digit++) {
        word_pass(words, spare, count, low + digit * size, size);
        uint64_t *swap = words;
        words = spare;
        spare = swap;
    }
    return words;
}

/* Keys differ in `bits` bits from bit `low` on, at most 64 - PLACE_BITS. The words are in
 * two halves of spare; sorted they are in the second one, so that items can be written
 * over them from the front: item i ends where word i does, at most. */
static void sort_words(const struct eng_radix_key *items, struct eng_radix_key *spare,
                       size_t count, unsigned low, unsigned bits)
{
    uint64_t *first = (uint64_t *)(void *)spare;
    uint64_t *second = first + count;
    bool is_even = word_digits(count, bits) % 2 == 0;
    uint64_t *from = is_even ? second : first;
    for (size_t i = 0; i < count; i++) {
        from[i] = items[i].key >> low << PLACE_BITS | i;
    }
    (void)eng_radix_sort_words(from, is_even ? first : second, count, PLACE_BITS, bits);
    for (size_t i = 0; i < count; i++) {
        spare[i] = items[second[i] & (WORDS_MAX - 1)];
    }
}

struct eng_radix_key *eng_radix_sort(struct eng_radix_key *items,
                                     struct eng_radix_key *spare, size_t count)
{
    uint64_t differ = 0;
    if (count <= INSERTION_MAX) {
        insert_all(items, count);
        return items;
    }
    for (size_t i = 1; i < count; i++) {
        differ |= items[i].key ^ items[0].key;
    }
    if (differ == 0) {
        return items;
    }
    /* Digits of one size between the first and the last bit that differ. */
    unsigned low = (unsigned)__builtin_ctzll(differ);
    unsigned bits = 64 - (unsigned)__builtin_clzll(differ) - low;
    if (count <= WORDS_MAX && bits <= 64 - PLACE_BITS) {
        sort_words(items, spare, count, low, bits);
        return spare;
    }
    unsigned most = count < FEW_ITEMS ? DIGIT_FEW : DIGIT_MAX;
    unsigned digits = (bits + most - 1) / most;
    unsigned size = (bits + digits - 1) / digits;
    for (unsigned digit = 0; digit < digits; digit++) {
        unsigned shift = low + digit * size;
        if ((differ >> shift & (((uint64_t)1 << size) - 1)) == 0) {
            continue;
        }
        pass(items, spare, count, shift, size);
        struct eng_radix_key *swap = items;
        items = spare;
        spare = swap;
    }
    return items;
}
