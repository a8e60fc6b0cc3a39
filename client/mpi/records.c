/* records.c - this rank's part of an answer.
 *
 * Room:     client/mpi.
 * Does:     translate numbers by the arrays of local.h.
 * Threads:  one.
 * Source:   records.h; proto/PROTOCOL.md, "The hash of an answer".
 */
#include "records.h"

#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "local.h"

/* In this file: a record of a length that the compiler knows takes few instructions. */
#define XXH_INLINE_ALL
#include <xxhash.h>

/* A hash of 128 bits, added up in words of 32 so that sums over ranks do not overflow. */
static void add_hash(uint64_t sum[4], XXH128_hash_t hash)
{
    sum[0] += hash.low64 & UINT32_MAX;
    sum[1] += hash.low64 >> 32;
    sum[2] += hash.high64 & UINT32_MAX;
    sum[3] += hash.high64 >> 32;
}

static void carry(uint64_t sum[4])
{
    for (int i = 0; i < 4; i++) {
        if (i < 3) {
            sum[i + 1] += sum[i] >> 32;
        }
        sum[i] &= UINT32_MAX;
    }
}

void ranks_records_hash(const struct ranks_sums *sums, uint64_t hash[2])
{
    uint64_t sum[4];
    memcpy(sum, sums->hash, sizeof sum);
    carry(sum);
    add_hash(sum, XXH3_128bits(&sums->total, sizeof sums->total));
    carry(sum);
    hash[0] = sum[3] << 32 | sum[2];
    hash[1] = sum[1] << 32 | sum[0];
}

void ranks_verdict_hash(uint32_t verdict, uint64_t hash[2])
{
    XXH128_hash_t of_it = XXH3_128bits(&verdict, sizeof verdict);
    hash[0] = of_it.high64;
    hash[1] = of_it.low64;
}

static bool has_bit(const uint64_t *bits, uint32_t i)
{
    return bits[i / 64] >> i % 64 & 1u;
}

/* The number in the whole of a local feature of `points` vertices. */
static uint32_t number_of(const struct ranks_local *local, uint32_t points,
                          uint32_t feature)
{
    return points == 1   ? local->vertices[feature]
           : points == 2 ? local->edges[feature]
                         : local->triangles[feature];
}

/* Records of one page have few objects, one after the other. */
static const struct ranks_object *object_of(struct pccd_mpi *world, uint32_t handle,
                                            const struct ranks_object *last)
{
    return last != NULL && last->handle == handle ? last
                                                  : ranks_find_object(world, handle);
}

/* Give a record its numbers; does it belong to this rank? */
struct reader {
    const struct ranks_object *a, *b;
};
static bool translate(struct pccd_mpi *world, struct reader *reader, uint32_t kind,
                      uint32_t object_a, uint32_t *feature_a, uint32_t object_b,
                      uint32_t *feature_b)
{
    const uint32_t *points = common_kinds[kind].points;
    reader->a = object_of(world, object_a, reader->a);
    reader->b = object_of(world, object_b, reader->b);
    const struct ranks_local *local = &reader->a->local;
    /* The first feature of every kind is a vertex or an edge. */
    bool is_own =
        has_bit(points[0] == 1 ? local->owns_vertex : local->owns_edge, *feature_a);
    *feature_a = number_of(local, points[0], *feature_a);
    *feature_b = number_of(&reader->b->local, points[1], *feature_b);
    return is_own;
}

bool ranks_record_is_own(struct pccd_mpi *world, const struct pccd_near *record)
{
    const struct ranks_local *local = &ranks_find_object(world, record->object_a)->local;
    bool is_vertex = common_kinds[record->kind].points[0] == 1;
    const uint32_t *numbers = is_vertex ? local->vertices : local->edges;
    uint32_t count = is_vertex ? local->vertex_count : local->edge_count;
    uint32_t at = ranks_place_of(numbers, count, record->feature_a);
    return at < count && has_bit(is_vertex ? local->owns_vertex : local->owns_edge, at);
}

static int make_room(struct pccd_mpi *world, uint64_t more, size_t record_bytes)
{
    uint64_t wanted = world->record_count + more;
    if (wanted <= world->record_capacity / record_bytes) {
        return PCCD_OK;
    }
    uint64_t bytes = (wanted + wanted / 2) * record_bytes;
    void *records = realloc(world->records, bytes);
    if (records == NULL) {
        return ranks_no_memory(world);
    }
    world->records = records;
    world->record_capacity = bytes;
    return PCCD_OK;
}

int ranks_records_reserve(struct pccd_mpi *world, uint64_t more)
{
    return make_room(world, more, ranks_record_bytes(world->mode));
}

int ranks_record_compare(const void *a, const void *b)
{
    uint32_t one[RANKS_NAME_WORDS], other[RANKS_NAME_WORDS];
    ranks_record_name(a, PCCD_MODE_ALL, one);
    ranks_record_name(b, PCCD_MODE_ALL, other);
    return ranks_name_is_before(one, other) ? -1 : ranks_name_is_before(other, one);
}

void ranks_records_sort(struct pccd_near *records, uint64_t count)
{
    if (count > 1) {
        qsort(records, count, sizeof *records, ranks_record_compare);
    }
}

/* Room for strays: as many as there are records in a page. */
static int make_stray_room(struct pccd_mpi *world, uint64_t more)
{
    uint64_t wanted = world->stray_count + more;
    if (wanted <= world->stray_capacity) {
        return PCCD_OK;
    }
    struct pccd_near *strays =
        realloc(world->strays, (wanted + wanted / 2) * sizeof *strays);
    if (strays == NULL) {
        return ranks_no_memory(world);
    }
    world->strays = strays;
    world->stray_capacity = wanted + wanted / 2;
    return PCCD_OK;
}

/* Of 64 bytes, like contacts. */
static int take_near(struct pccd_mpi *world, const struct pccd_answer *page)
{
    struct reader reader = {NULL, NULL};
    int status = world->is_merged ? make_stray_room(world, page->count) : PCCD_OK;
    for (uint64_t i = 0; i < page->count && status == PCCD_OK; i++) {
        struct pccd_near *to = (struct pccd_near *)world->records + world->record_count;
        *to = page->near[i];
        if (translate(world, &reader, to->kind, to->object_a, &to->feature_a,
                      to->object_b, &to->feature_b)) {
            world->record_count++;
        } else if (world->is_merged) {
            world->strays[world->stray_count++] = *to;
        }
    }
    return status;
}

int ranks_records_take(struct pccd_mpi *world, const struct pccd_answer *page)
{
    struct reader reader = {NULL, NULL};
    size_t bytes = world->has_bounds ? sizeof(double) : ranks_record_bytes(world->mode);
    int status = make_room(world, page->count, bytes);
    if (status != PCCD_OK) {
        return status;
    }
    if (page->near != NULL) {
        status = take_near(world, page);
    }
    if (page->vertex_bounds != NULL) {
        memcpy((double *)world->records + world->record_count, page->vertex_bounds,
               page->count * sizeof(double));
        world->record_count += page->count;
    }
    for (uint64_t i = 0; page->contacts != NULL && i < page->count; i++) {
        struct pccd_contact *to =
            (struct pccd_contact *)world->records + world->record_count;
        *to = page->contacts[i];
        world->record_count += translate(world, &reader, to->kind, to->object_a,
                                         &to->feature_a, to->object_b, &to->feature_b);
    }
    for (uint64_t i = 0; page->pairs != NULL && i < page->count; i++) {
        struct pccd_pair *to = (struct pccd_pair *)world->records + world->record_count;
        *to = page->pairs[i];
        world->record_count += translate(world, &reader, to->kind, to->object_a,
                                         &to->feature_a, to->object_b, &to->feature_b);
    }
    return status;
}

void ranks_record_name(const char *record, enum pccd_mode mode,
                       uint32_t name[RANKS_NAME_WORDS])
{
    bool is_pair = mode == PCCD_MODE_PAIRS; /* else it has flags behind the kind */
    uint32_t words[6];
    memcpy(words, record, is_pair ? 5 * sizeof *words : 6 * sizeof *words);
    name[0] = words[0];
    memcpy(name + 1, words + (is_pair ? 1 : 2), 4 * sizeof *name);
}

double ranks_records_limit(const struct pccd_mpi *world)
{
    const struct pccd_contact *contacts = world->records;
    double limit = 2;
    for (uint64_t i = 0; i < world->record_count; i++) {
        limit = contacts[i].toi_hi < limit ? contacts[i].toi_hi : limit;
    }
    return limit;
}

void ranks_records_drop_later(struct pccd_mpi *world, double limit)
{
    struct pccd_contact *contacts = world->records;
    uint64_t kept = 0;
    for (uint64_t i = 0; i < world->record_count; i++) {
        if (contacts[i].toi <= limit) {
            contacts[kept++] = contacts[i];
        }
    }
    world->record_count = kept;
}

static void count_contact(const struct pccd_contact *contact, struct ranks_sums *sums)
{
    bool is_initial = (contact->flags & PCCD_INITIAL) != 0;
    sums->counts[contact->kind]++;
    sums->possible += (contact->flags & PCCD_PROVED) == 0;
    sums->initial += is_initial;
    sums->inside += (contact->flags & PCCD_INSIDE) != 0 && !is_initial;
    sums->toi_first = contact->toi < sums->toi_first ? contact->toi : sums->toi_first;
    add_hash(sums->hash, XXH3_128bits(contact, sizeof *contact));
}

void ranks_records_sum(const struct pccd_mpi *world, struct ranks_sums *sums)
{
    *sums = (struct ranks_sums){.total = world->record_count, .toi_first = 2};
    for (uint64_t i = 0; i < world->record_count; i++) {
        if (world->mode == PCCD_MODE_PAIRS) {
            const struct pccd_pair *pair = (const struct pccd_pair *)world->records + i;
            sums->counts[pair->kind]++;
            add_hash(sums->hash, XXH3_128bits(pair, sizeof *pair));
        } else {
            count_contact((const struct pccd_contact *)world->records + i, sums);
        }
        if (i % (1u << 30) == (1u << 30) - 1) {
            carry(sums->hash);
        }
    }
    carry(sums->hash);
}

void ranks_records_sum_near(const struct pccd_mpi *world, struct ranks_sums *sums,
                            double *least, double *greatest)
{
    const struct pccd_near *near = world->records;
    *sums = (struct ranks_sums){.total = world->record_count, .toi_first = 2};
    *least = 2e18;
    *greatest = 0;
    for (uint64_t i = 0; i < world->record_count; i++) {
        sums->counts[near[i].kind]++;
        *least = near[i].d_lo < *least ? near[i].d_lo : *least;
        *greatest = near[i].d_hi > *greatest ? near[i].d_hi : *greatest;
        add_hash(sums->hash, XXH3_128bits(&near[i], sizeof near[i]));
        if (i % (1u << 30) == (1u << 30) - 1) {
            carry(sums->hash);
        }
    }
    carry(sums->hash);
}

void ranks_bounds_sum(const struct ranks_bound *bounds, uint64_t count,
                      struct ranks_sums *sums)
{
    for (uint64_t i = 0; i < count; i++) {
        add_hash(sums->hash, XXH3_128bits(&bounds[i], sizeof bounds[i]));
    }
    sums->total += count;
    carry(sums->hash);
}
