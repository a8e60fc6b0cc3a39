/* wide_sort.c - splits at medians, of items or of words in their place.
 *
 * The order does not depend on how many threads made it: each split is of a list that
 * they do not change.
 *
 * To halve the range of a word takes some 20 instructions: its key is counted, and the
 * word goes to where those of its bin are. To look for medians among items takes 75, and
 * less only in long ranges.
 */
#include "wide_sort.h"

#include <assert.h>
#include <float.h>
#include <omp.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "aabb.h"
#include "boxes.h"
#include "kernel.h"
#include "parallel.h"

/* Parts for each thread, so that they end together. */
#define PARTS_PER_THREAD 8u
#define PART_SPLIT_MIN   (ENG_WIDE_WORDS_MAX + 1)

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

/* ---- words ------------------------------------------------------------------------- */

/* A word is an item of a range: where it is along each axis, in 0 .. STEPS of the longest
 * extent, below its index. */
#define KEY_BITS    16u
#define STEPS       32767
#define INDEX_SHIFT (3 * KEY_BITS)
static_assert(ENG_WIDE_WORDS_MAX <= STEPS + 1, "indices");
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "lanes of words");

/* An extent that a float can divide STEPS by; items that extend less are in one bin. */
#define EXTENT_MIN (2 * STEPS / FLT_MAX)

/* Ranges that extend over fewer steps are measured anew. */
#define STEPS_MIN 512u

/* So many steps may be one of two rounded extents, of which the other one is longer. */
#define STEPS_UNSURE 2u

/* Bins in which words are counted: as many as there are words, divided by BIN_WORDS. */
#define BINS_MIN  32u
#define BINS_MAX  512u
#define BIN_WORDS 4u

/* Two words. */
typedef int16_t keys8 __attribute__((vector_size(16)));

static inline keys8 min8(keys8 a, keys8 b)
{
#ifdef __SSE2__
    return (keys8)_mm_min_epi16((__m128i)a, (__m128i)b); /* the same, one instruction */
#else
    return (a & (a < b)) | (b & ~(a < b));
#endif
}

static inline keys8 max8(keys8 a, keys8 b)
{
#ifdef __SSE2__
    return (keys8)_mm_max_epi16((__m128i)a, (__m128i)b);
#else
    return (a & (a > b)) | (b & ~(a > b));
#endif
}

struct bounds {
    eng_f4 low, high; /* of the ids too, which are not looked at */
};

static struct bounds bounds_of(const struct eng_split_item *items, const uint64_t *words,
                               uint32_t count)
{
    eng_f4 low, high;
    memcpy(&low, &items[words[0] >> INDEX_SHIFT], sizeof low);
    high = low;
    for (uint32_t i = 1; i < count; i++) {
        eng_f4 item;
        memcpy(&item, &items[words[i] >> INDEX_SHIFT], sizeof item);
        low = eng_min4(low, item);
        high = eng_max4(high, item);
    }
    return (struct bounds){low, high};
}

/* Return the axis along which items extend most, as eng_median_axis does. */
static int axis_of(const struct bounds *bounds)
{
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if (bounds->high[k] - bounds->low[k] > bounds->high[axis] - bounds->low[axis]) {
            axis = k;
        }
    }
    return axis;
}

/* Return the word of whole numbers 0 .. STEPS along three axes, and 0. */
static inline uint64_t word_of(eng_f4 steps, uint64_t index)
{
#ifdef __SSE2__
    __m128i whole = _mm_cvttps_epi32((__m128)steps);
    uint64_t word = (uint64_t)_mm_cvtsi128_si64(_mm_packs_epi32(whole, whole));
#else
    uint64_t word = (uint64_t)steps[0] | (uint64_t)steps[1] << KEY_BITS |
                    (uint64_t)steps[2] << 2 * KEY_BITS;
#endif
    return word | index << INDEX_SHIFT;
}

/* Make words of the items whose indices they have. */
static void measure(const struct eng_split_item *items, uint64_t *words, uint32_t count)
{
    const struct bounds bounds = bounds_of(items, words, count);
    const int axis = axis_of(&bounds);
    const float longest = bounds.high[axis] - bounds.low[axis];
    const float scale = longest > EXTENT_MIN ? STEPS / longest : 0;
    for (uint32_t i = 0; i < count; i++) {
        uint64_t index = words[i] >> INDEX_SHIFT;
        eng_f4 item;
        memcpy(&item, &items[index], sizeof item);
        item = (eng_f4)((eng_i4)(item - bounds.low) & ENG_IS_BOUND);
        words[i] = word_of(item * scale, index);
    }
}

/* Along an axis keys begin at `low`, and extend so many steps. */
struct extent {
    int axis;
    uint32_t low;
    uint32_t steps;
};

/* Fill extents[3] by the keys of words. Returns the axis of the longest. */
static int extents_of(const uint64_t *words, uint32_t count, struct extent *extents)
{
    keys8 low, high, two; /* the last two may be looked at again */
    int axis = 0;
    assert(count >= 2);
    memcpy(&two, words + count - 2, sizeof two);
    low = high = two;
    for (uint32_t i = 0; i + 2 <= count; i += 2) {
        memcpy(&two, words + i, sizeof two);
        low = min8(low, two);
        high = max8(high, two);
    }
    for (int k = 0; k < 3; k++) { /* lane 3 is the index */
        int from = low[k] < low[k + 4] ? low[k] : low[k + 4];
        int to = high[k] > high[k + 4] ? high[k] : high[k + 4];
        extents[k] = (struct extent){k, (uint32_t)from, (uint32_t)(to - from)};
        axis = extents[k].steps > extents[axis].steps ? k : axis;
    }
    return axis;
}

/* Return the longest extent: by the keys if they tell, which may be set anew. */
static struct extent longest_of(const struct eng_split_item *items, uint64_t *words,
                                uint32_t count)
{
    struct extent extents[3];
    int axis = extents_of(words, count, extents);
    if (extents[axis].steps < STEPS_MIN) {
        measure(items, words, count);
        axis = extents_of(words, count, extents);
    }
    for (int k = 0; k < 3; k++) {
        if (k != axis && extents[k].steps + STEPS_UNSURE >= extents[axis].steps) {
            const struct bounds bounds = bounds_of(items, words, count);
            return extents[axis_of(&bounds)];
        }
    }
    return extents[axis];
}

static inline uint32_t key_of(uint64_t word, unsigned shift, uint32_t mask)
{
    return (uint32_t)(word >> shift) & mask;
}

/* Sort the words of a bin along an axis, and by ids where items are equal there. Few are
 * in one as a rule, all where a few others are far away. */
static void sort_bin(const struct eng_split_item *items, uint64_t *words, uint32_t count,
                     int axis)
{
    static const uint32_t gaps[] = {16577, 4193, 1073, 281, 77, 23, 8, 1};
    for (uint32_t g = 0; g < sizeof gaps / sizeof *gaps; g++) {
        const uint32_t gap = gaps[g];
        for (uint32_t i = gap; i < count; i++) {
            const uint64_t word = words[i];
            const struct eng_split_item *item = &items[word >> INDEX_SHIFT];
            uint32_t at = i;
            for (; at >= gap; at -= gap) {
                const struct eng_split_item *other =
                    &items[words[at - gap] >> INDEX_SHIFT];
                float x = other->centroid[axis], y = item->centroid[axis];
                if (x < y || (x == y && other->id < item->id)) {
                    break;
                }
                words[at] = words[at - gap];
            }
            words[at] = word;
        }
    }
}

/* Split words: none of the first `middle` of to[] comes after any of the rest along the
 * longest extent. They are dealt to bins of some keys each, of which one is across the
 * middle. */
static void halve(const struct eng_split_item *items, const uint64_t *from, uint64_t *to,
                  uint32_t count, uint32_t middle, struct extent extent)
{
    uint32_t end[BINS_MAX]; /* of each bin; at first how many words are in it */
    uint32_t bins = BINS_MIN;
    while (bins < BINS_MAX && bins * BIN_WORDS < count) {
        bins *= 2;
    }
    unsigned fold = 0; /* bits of keys in one bin */
    while (((extent.low + extent.steps) >> fold) - (extent.low >> fold) >= bins) {
        fold++;
    }
    const unsigned shift = (unsigned)extent.axis * KEY_BITS + fold;
    const uint32_t mask = STEPS >> fold, first = extent.low >> fold;
    memset(end, 0, bins * sizeof *end);
    for (uint32_t i = 0; i < count; i++) {
        end[key_of(from[i], shift, mask) - first]++;
    }
    for (uint32_t bin = 0, sum = 0; bin < bins; bin++) {
        uint32_t in_bin = end[bin];
        end[bin] = sum;
        sum += in_bin;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint64_t word = from[i];
        to[end[key_of(word, shift, mask) - first]++] = word;
    }
    uint32_t bin = key_of(to[middle], shift, mask) - first;
    uint32_t begin = bin > 0 ? end[bin - 1] : 0;
    if (begin < middle) {
        sort_bin(items, to + begin, end[bin] - begin, extent.axis);
    }
}

void eng_wide_words_sort(uint64_t *words, const struct eng_split_item *items,
                         struct eng_wide_range range, uint32_t *ids)
{
    struct {
        struct eng_wide_range range; /* its first word is .first of sides[.side] */
        int side;
    } stack[32]; /* as in struct eng_wide_sorter */
    uint64_t *const sides[2] = {words, words + range.count};
    uint32_t waiting = 0;
    assert(range.count > 0 && range.count <= ENG_WIDE_WORDS_MAX);
    if (!is_across(range, ENG_WIDE)) {
        write_ids(items, range, ids);
        return;
    }
    items += range.first;
    ids += range.first;
    range.first = 0;
    for (uint32_t i = 0; i < range.count; i++) {
        words[i] = (uint64_t)i << INDEX_SHIFT;
    }
    measure(items, words, range.count);
    stack[waiting].range = range;
    stack[waiting++].side = 0;
    while (waiting > 0) {
        range = stack[--waiting].range;
        const int side = stack[waiting].side;
        uint64_t *from = sides[side] + range.first;
        uint64_t *to = sides[1 - side] + range.first;
        uint32_t middle = middle_of(range, ENG_WIDE);
        halve(items, from, to, range.count, middle, longest_of(items, from, range.count));
        struct eng_wide_range halves[2] = {range, behind(range, middle)};
        halves[0].count = middle;
        for (int half = 0; half < 2; half++) {
            range = halves[half];
            if (is_across(range, ENG_WIDE)) {
                assert(waiting < sizeof stack / sizeof *stack);
                stack[waiting].range = range;
                stack[waiting++].side = 1 - side;
                continue;
            }
            for (size_t i = range.first; i < range.first + range.count; i++) {
                ids[i] = items[sides[1 - side][i] >> INDEX_SHIFT].id;
            }
        }
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
                      uint64_t *words, uint32_t *ids)
{
    struct eng_wide_sorter sorter;
    eng_wide_sorter_begin(&sorter, part, ENG_WIDE);
    while (sorter.waiting > 0) {
        struct eng_wide_range range = sorter.stack[--sorter.waiting];
        if (range.count > ENG_WIDE_WORDS_MAX && words) {
            struct eng_wide_range second = split(items, &range, ENG_WIDE);
            push(&sorter, second);
            push(&sorter, range);
        } else if (words && range.count >= ENG_WIDE_WORDS_MIN) {
            eng_wide_words_sort(words, items, range, ids);
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

/* No part is split here that words can take whole: they alone decide how the items of a
 * group follow each other. */
void eng_wide_sort_parts(struct eng_split_item *items, struct eng_wide_range *parts,
                         uint32_t count, int threads, uint64_t *words, uint32_t *ids)
{
    const uint32_t stride = 2 * ENG_WIDE_WORDS_MAX;
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
        uint64_t *own = words ? words + stride * (uint32_t)omp_get_thread_num() : NULL;
        sort_part(items, parts[i], own, ids);
    }
    eng_parallel_close();
}
