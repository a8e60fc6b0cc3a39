/* sorting.c - the merge of records against plainer ways to sort them.
 *
 * Floor, bytes moved for a contact of 64 bytes: 64 read for the key, key and address of
 * 16 written and read three times, 64 read, 64 fetched and written, 64 read by the hash:
 * 416, about 10 ns at the 42 GB/s of a Sapphire Rapids core's memory, less where caches
 * hold them. For a pair of 20 bytes: 196, about 5 ns.
 */
#include "gather.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "merge.h"
#include "report.h"

#define CONTACTS_MAX 120000u
#define TEAM         2u

/* The same records in one list and in one for each thread of a team. */
struct lists {
    struct eng_pool pool;
    struct eng_found all;
    struct eng_found part[TEAM];
    uint64_t total;
    uint32_t record_bytes;
};

struct times {
    struct bench_samples alone;
    struct bench_samples team;
    struct bench_samples whole;
    struct bench_samples quick;
};

static int compare_names(const struct eng_name *x, const struct eng_name *y)
{
    for (unsigned i = 0; i < ENG_NAME_WORDS; i++) {
        if (x->word[i] != y->word[i]) {
            return x->word[i] < y->word[i] ? -1 : 1;
        }
    }
    return 0;
}

static int compare_pairs(const void *a, const void *b)
{
    return compare_names(a, b);
}

static int compare_contacts(const void *a, const void *b)
{
    struct eng_name x = eng_name_of(a, sizeof(struct pccd_contact));
    struct eng_name y = eng_name_of(b, sizeof(struct pccd_contact));
    return compare_names(&x, &y);
}

/* A record named as `pair`; the rest of a contact follows from it. */
static void append(struct eng_found *found, const struct pccd_pair *pair)
{
    unsigned char *record = eng_found_add(found, pair);
    if (!record) {
        abort();
    }
    if (found->record_bytes == sizeof(struct pccd_contact)) {
        struct pccd_contact *contact = (void *)record;
        contact->flags = PCCD_PROVED;
        contact->toi = 1.0 / (1 + pair->feature_a);
        contact->toi_hi = contact->toi;
        memset(contact->param, 0, sizeof contact->param);
        memset(contact->normal, 0, sizeof contact->normal);
        contact->reserved = 0;
    }
}

static void fill(struct lists *lists, const struct eng_found *pairs,
                 uint32_t record_bytes, uint64_t max)
{
    lists->record_bytes = record_bytes;
    lists->total = pairs->count < max ? pairs->count : max;
    eng_pool_init(&lists->pool);
    eng_found_begin(&lists->all, &lists->pool, record_bytes, UINT32_MAX);
    for (uint32_t t = 0; t < TEAM; t++) {
        eng_found_begin(&lists->part[t], &lists->pool, record_bytes, UINT32_MAX);
    }
    uint64_t at = 0;
    for (const struct eng_block *block = pairs->first; block; block = block->next) {
        const struct pccd_pair *pair = (const void *)block->data;
        for (uint32_t i = 0; i < block->count && at < lists->total; i++, at++) {
            append(&lists->all, &pair[i]);
            append(&lists->part[at * TEAM / lists->total], &pair[i]);
        }
    }
}

/* The records of the list in one piece. */
static void copy_all(const struct eng_found *found, unsigned char *to)
{
    for (const struct eng_block *block = found->first; block; block = block->next) {
        memcpy(to, block->data, (size_t)block->count * found->record_bytes);
        to += (size_t)block->count * found->record_bytes;
    }
}

/* ---- whole names, a byte at a time ------------------------------------------------- */

struct whole {
    uint64_t hi; /* more significant half of the name */
    uint64_t lo;
    uint64_t index; /* of its record: the address */
};

static unsigned digit_of(const struct whole *item, unsigned digit)
{
    uint64_t half = digit < 8 ? item->lo : item->hi;
    return (unsigned)(half >> (8 * (digit & 7))) & 255u;
}

static void pass(const struct whole *from, struct whole *to, size_t count, unsigned digit)
{
    size_t offset[256] = {0};
    for (size_t i = 0; i < count; i++) {
        offset[digit_of(&from[i], digit)]++;
    }
    size_t sum = 0;
    for (unsigned d = 0; d < 256; d++) {
        size_t n = offset[d];
        offset[d] = sum;
        sum += n;
    }
    for (size_t i = 0; i < count; i++) {
        to[offset[digit_of(&from[i], digit)]++] = from[i];
    }
}

static struct whole *radix_sort(struct whole *items, struct whole *spare, size_t count)
{
    uint64_t differ_hi = 0;
    uint64_t differ_lo = 0;
    for (size_t i = 1; i < count; i++) {
        differ_hi |= items[i].hi ^ items[0].hi;
        differ_lo |= items[i].lo ^ items[0].lo;
    }
    for (unsigned digit = 0; digit < 16; digit++) {
        uint64_t half = digit < 8 ? differ_lo : differ_hi;
        if (((half >> (8 * (digit & 7))) & 255u) == 0) {
            continue;
        }
        pass(items, spare, count, digit);
        struct whole *swap = items;
        items = spare;
        spare = swap;
    }
    return items;
}

/* One thread, one kind after the other: names of 128 bits, 24 bytes an item, byte by byte
 * over all items, then gather and hash. */
static void sort_whole_names(const struct eng_found *found, struct whole *items,
                             struct whole *spare, unsigned char *to, uint64_t hash[2])
{
    unsigned char *out = to;
    for (uint32_t kind = PCCD_VF; kind <= PCCD_EE; kind++) {
        size_t count = 0;
        for (const struct eng_block *block = found->first; block; block = block->next) {
            for (uint32_t i = 0; i < block->count; i++) {
                const unsigned char *record =
                    block->data + (size_t)i * found->record_bytes;
                struct eng_name name = eng_name_of(record, found->record_bytes);
                if (name.word[0] == kind) {
                    items[count++] = (struct whole){
                        (uint64_t)name.word[1] << 32 | name.word[2],
                        (uint64_t)name.word[3] << 32 | name.word[4], (uintptr_t)record};
                }
            }
        }
        const struct whole *sorted = radix_sort(items, spare, count);
        for (size_t i = 0; i < count; i++) {
            memcpy(out, (const void *)(uintptr_t)sorted[i].index, found->record_bytes);
            out += found->record_bytes;
        }
    }
    uint64_t count = (uint64_t)(out - to) / found->record_bytes;
    eng_hash_end(eng_hash_records(to, count, found->record_bytes), count, hash);
}

/* ---- merge ------------------------------------------------------------------------ */

static bool merge_alone(struct eng_merge *merge, struct lists *lists,
                        struct eng_records *out, uint64_t hash[2])
{
    struct eng_found *const all[1] = {&lists->all};
    struct eng_counts counts;
    if (eng_merge_begin(merge, all, 1, out) != PCCD_OK ||
        eng_merge_end(merge, &counts) != PCCD_OK) {
        return false;
    }
    eng_hash_end(counts.hash, out->count, hash);
    return true;
}

static bool merge_by_team(struct eng_merge *merge, struct lists *lists,
                          struct eng_records *out, uint64_t hash[2])
{
    struct eng_found *parts[TEAM];
    struct eng_counts counts;
    for (uint32_t t = 0; t < TEAM; t++) {
        parts[t] = &lists->part[t];
    }
    if (eng_merge_begin(merge, parts, TEAM, out) != PCCD_OK) {
        return false;
    }
#pragma omp parallel num_threads(TEAM)
    {
        uint32_t thread = (uint32_t)omp_get_thread_num();
        eng_merge_survey(merge, (uint32_t)omp_get_num_threads(), thread);
#pragma omp barrier
        if (eng_merge_is_shared(merge)) {
            eng_merge_divide(merge, thread);
#pragma omp barrier
            eng_merge_finish(merge, thread);
        }
    }
    if (eng_merge_end(merge, &counts) != PCCD_OK) {
        return false;
    }
    eng_hash_end(counts.hash, out->count, hash);
    return true;
}

static bool is_right(const struct eng_records *out, const unsigned char *expected,
                     uint64_t total, const uint64_t hash[2], const uint64_t whole[2])
{
    return out->count == total && hash[0] == whole[0] && hash[1] == whole[1] &&
           memcmp(out->data, expected, total * out->record_bytes) == 0;
}

static bool measure_once(struct lists *lists, struct eng_merge *merge,
                         struct eng_records *out, struct whole *items,
                         unsigned char *expected, double ns[4])
{
    uint64_t whole[2];
    uint64_t hash[2];
    struct whole *spare = items + lists->total;
    uint64_t t0 = common_now_ns();
    sort_whole_names(&lists->all, items, spare, expected, whole);
    uint64_t t1 = common_now_ns();
    bool good = merge_alone(merge, lists, out, hash);
    uint64_t t2 = common_now_ns();
    good = good && is_right(out, expected, lists->total, hash, whole);
    uint64_t t3 = common_now_ns();
    good = good && merge_by_team(merge, lists, out, hash);
    uint64_t t4 = common_now_ns();
    good = good && is_right(out, expected, lists->total, hash, whole);
    copy_all(&lists->all, expected);
    uint64_t t5 = common_now_ns();
    qsort(expected, lists->total, lists->record_bytes,
          lists->record_bytes == sizeof(struct pccd_pair) ? compare_pairs
                                                          : compare_contacts);
    uint64_t t6 = common_now_ns();
    const uint64_t spans[4] = {t2 - t1, t4 - t3, t1 - t0, t6 - t5};
    for (int i = 0; i < 4; i++) {
        ns[i] = (double)spans[i] / (double)lists->total;
    }
    return good && is_right(out, expected, lists->total, hash, whole);
}

static void print(const char *scene, const char *kind, const char *how,
                  const struct bench_samples *samples, const char *base_name,
                  const struct bench_samples *base, uint32_t threads)
{
    char what[64];
    snprintf(what, sizeof what, "%s a %s", how, kind);
    bench_row(&(struct bench_row){.scene = scene,
                                  .what = what,
                                  .unit = "ns",
                                  .samples = samples,
                                  .base_name = base_name,
                                  .base = base,
                                  .threads = threads});
}

static void measure(const char *scene, const char *kind, struct lists *lists,
                    unsigned repeats)
{
    struct eng_merge merge;
    struct eng_records out = {0};
    struct times times;
    memset(&times, 0, sizeof times);
    eng_merge_init(&merge);
    struct whole *items = bench_alloc(2 * lists->total, sizeof *items);
    unsigned char *expected = bench_alloc(lists->total, lists->record_bytes);
    bool good = lists->total > 0;
    for (unsigned r = 0; r < repeats && good; r++) {
        double ns[4];
        good = bench_check(measure_once(lists, &merge, &out, items, expected, ns), scene,
                           "merge and qsort differ");
        if (r > 0) {
            bench_add(&times.alone, ns[0]);
            bench_add(&times.team, ns[1]);
            bench_add(&times.whole, ns[2]);
            bench_add(&times.quick, ns[3]);
        }
    }
    if (good && lists->total > 0) {
        bench_number(scene, "records", "", (double)lists->total);
        print(scene, kind, "qsort", &times.quick, NULL, NULL, 1);
        print(scene, kind, "whole names", &times.whole, "qsort", &times.quick, 1);
        print(scene, kind, "merge", &times.alone, "whole names", &times.whole, 1);
        print(scene, kind, "merge", &times.team, "one thread", &times.alone, TEAM);
    }
    free(items);
    free(expected);
    eng_records_deinit(&out);
    eng_merge_deinit(&merge);
    bench_free(&times.alone);
    bench_free(&times.team);
    bench_free(&times.whole);
    bench_free(&times.quick);
}

void bench_sorting_measure(const struct bench_work *work, unsigned repeats)
{
    const char *scene = work->world.source->name;
    struct lists lists;
    fill(&lists, &work->found, sizeof(struct pccd_pair), UINT32_MAX);
    measure(scene, "pair", &lists, repeats);
    eng_pool_deinit(&lists.pool);
    fill(&lists, &work->found, sizeof(struct pccd_contact), CONTACTS_MAX);
    measure(scene, "contact", &lists, repeats);
    eng_pool_deinit(&lists.pool);
}
