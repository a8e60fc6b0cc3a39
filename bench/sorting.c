/* sorting.c - the merge of records beside qsort.
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
        if (eng_merge_is_by_all(merge)) {
            eng_merge_fill_buckets(merge, thread);
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
                     uint64_t total, const uint64_t hash[2], const uint64_t wanted[2])
{
    return out->count == total && hash[0] == wanted[0] && hash[1] == wanted[1] &&
           memcmp(out->data, expected, total * out->record_bytes) == 0;
}

enum side { QUICK, ALONE, BY_TEAM, SIDES };

static bool measure_once(struct lists *lists, struct eng_merge *merge,
                         struct eng_records *out, unsigned char *expected,
                         double ns[SIDES])
{
    uint64_t wanted[2];
    uint64_t hash[2];
    copy_all(&lists->all, expected);
    uint64_t t0 = common_now_ns();
    qsort(expected, lists->total, lists->record_bytes,
          lists->record_bytes == sizeof(struct pccd_pair) ? compare_pairs
                                                          : compare_contacts);
    uint64_t t1 = common_now_ns();
    eng_hash_end(eng_hash_records(expected, lists->total, lists->record_bytes),
                 lists->total, wanted);
    uint64_t t2 = common_now_ns();
    bool good = merge_alone(merge, lists, out, hash);
    uint64_t t3 = common_now_ns();
    good = good && is_right(out, expected, lists->total, hash, wanted);
    uint64_t t4 = common_now_ns();
    good = good && merge_by_team(merge, lists, out, hash);
    uint64_t t5 = common_now_ns();
    const uint64_t spans[SIDES] = {t1 - t0, t3 - t2, t5 - t4};
    for (int i = 0; i < SIDES; i++) {
        ns[i] = (double)spans[i] / (double)lists->total;
    }
    return good && is_right(out, expected, lists->total, hash, wanted);
}

static void measure(const char *scene, const char *kind, struct lists *lists,
                    unsigned repeats)
{
    static const char *const hows[SIDES] = {"qsort", "merge", "merge"};
    struct bench_side sides[SIDES] = {
        [QUICK] = {.unit = "ns"},
        [ALONE] = {.unit = "ns", .base_name = "qsort", .base = QUICK},
        [BY_TEAM] = {
            .unit = "ns", .base_name = "one thread", .base = ALONE, .threads = TEAM}};
    struct eng_merge merge;
    struct eng_records out = {0};
    eng_merge_init(&merge);
    unsigned char *expected = bench_alloc(lists->total, lists->record_bytes);
    bool good = lists->total > 0;
    for (unsigned r = 0; r < repeats && good; r++) {
        double ns[SIDES];
        good = bench_check(measure_once(lists, &merge, &out, expected, ns), scene,
                           "merge and qsort differ");
        for (int i = 0; i < SIDES && r > 0; i++) {
            bench_add(&sides[i].samples, ns[i]);
        }
    }
    for (int i = 0; i < SIDES; i++) {
        snprintf(sides[i].what, sizeof sides[i].what, "%s a %s", hows[i], kind);
    }
    if (good) {
        bench_number(scene, "records", "", (double)lists->total);
    }
    bench_sides_end(scene, sides, SIDES, good);
    free(expected);
    eng_records_deinit(&out);
    eng_merge_deinit(&merge);
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
