/* records.c - this rank's part of an answer.
 *
 * Source: proto/PROTOCOL.md, "The hash of an answer".
 */
#include "answer.h"

#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "mpi_hooks.h"
#include "parts.h"
#include "team.h"

/* In this file: a record of a length that the compiler knows takes few instructions. */
#define XXH_INLINE_ALL
#include <xxhash.h>

/* Records that are looked at together: the nearest cache holds them. */
#define PIECE 64u

/* A sum of hashes, of which only 128 bits count. */
typedef unsigned __int128 hash_sum;

static void add_hash(hash_sum *sum, XXH128_hash_t hash)
{
    *sum += (hash_sum)hash.high64 << 64 | hash.low64;
}

static void add_contacts(hash_sum *sum, const struct pccd_contact *contacts,
                         uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        add_hash(sum, XXH3_128bits(&contacts[i], sizeof contacts[i]));
    }
}

static void add_pairs(hash_sum *sum, const struct pccd_pair *pairs, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        add_hash(sum, XXH3_128bits(&pairs[i], sizeof pairs[i]));
    }
}

/* In words of 32 bits, so that sums over ranks do not overflow. */
static void add_words(uint64_t words[4], hash_sum sum)
{
    for (int i = 0; i < 4; i++) {
        words[i] += (uint32_t)(sum >> 32 * i);
    }
}

static hash_sum sum_of(const uint64_t words[4])
{
    hash_sum sum = 0;
    for (int i = 0; i < 4; i++) {
        sum += (hash_sum)words[i] << 32 * i;
    }
    return sum;
}

void ranks_records_hash(const struct ranks_sums *sums, uint64_t hash[2])
{
    hash_sum sum = sum_of(sums->hash);
    add_hash(&sum, XXH3_128bits(&sums->total, sizeof sums->total));
    hash[0] = (uint64_t)(sum >> 64);
    hash[1] = (uint64_t)sum;
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

/* Numbers by which features of a record are called: mostly those of the record before it,
 * as records of one page have few objects, one after the other. */
struct reader {
    const struct ranks_object *a, *b;
    uint32_t kind;
    const uint32_t *numbers_a, *numbers_b; /* of the whole, by local number */
};

static const uint32_t *numbers_of(const struct ranks_local *local, uint32_t points)
{
    return points == 1 ? local->vertices : points == 2 ? local->edges : local->triangles;
}

/* Find the numbers that features of a record get. */
static inline void look_up(const struct pccd_mpi *world, struct reader *reader,
                           uint32_t kind, uint32_t object_a, uint32_t object_b)
{
    if (reader->a != NULL && reader->kind == kind && reader->a->handle == object_a &&
        reader->b->handle == object_b) {
        return;
    }
    const uint32_t *points = common_kinds[kind].points;
    reader->a = ranks_find_object(world, object_a);
    reader->b = ranks_find_object(world, object_b);
    reader->kind = kind;
    reader->numbers_a = numbers_of(&reader->a->local, points[0]);
    reader->numbers_b = numbers_of(&reader->b->local, points[1]);
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
    if (wanted > world->copied_bytes / record_bytes) {
        uint64_t bytes = (wanted + wanted / 2) * record_bytes;
        void *records = realloc(world->copied, bytes);
        if (records == NULL) {
            return ranks_no_memory(world);
        }
        world->copied = records;
        world->copied_bytes = bytes;
    }
    world->records = world->copied;
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

/* Return whether a record with local numbers belongs to this rank. */
static bool is_own(const struct reader *reader, uint32_t feature)
{
    const struct ranks_local *local = &reader->a->local;
    /* The first feature of every kind is a vertex or an edge. */
    return has_bit(reader->numbers_a == local->vertices ? local->owns_vertex
                                                        : local->owns_edge,
                   feature);
}

/* Take records of 64 bytes, as contacts have. */
static int take_near(struct pccd_mpi *world, const struct pccd_answer *page)
{
    struct reader reader = {.a = NULL};
    int status = world->is_merged ? make_stray_room(world, page->count) : PCCD_OK;
    for (uint64_t i = 0; i < page->count && status == PCCD_OK; i++) {
        struct pccd_near *to = (struct pccd_near *)world->records + world->record_count;
        *to = page->near[i];
        look_up(world, &reader, to->kind, to->object_a, to->object_b);
        to->feature_a = reader.numbers_a[to->feature_a];
        to->feature_b = reader.numbers_b[to->feature_b];
        if (is_own(&reader, page->near[i].feature_a)) {
            world->record_count++;
        } else if (world->is_merged) {
            world->strays[world->stray_count++] = *to;
        }
    }
    return status;
}

static void count_contact(const struct pccd_contact *contact, struct ranks_sums *sums)
{
    bool is_initial = (contact->flags & PCCD_INITIAL) != 0;
    sums->counts[contact->kind]++;
    sums->possible += (contact->flags & PCCD_PROVED) == 0;
    sums->initial += is_initial;
    sums->inside += (contact->flags & PCCD_INSIDE) != 0 && !is_initial;
    sums->coincident += is_initial && common_is_at_vertices(contact->param);
    sums->toi_first = contact->toi < sums->toi_first ? contact->toi : sums->toi_first;
}

/* Give local contacts the numbers of the whole. All begin with a feature of this rank's
 * own: libpccd leaves out others. */
static void take_contacts(const struct pccd_mpi *world, struct reader *reader,
                          const struct pccd_contact *from, struct pccd_contact *to,
                          uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        to[i] = from[i];
        look_up(world, reader, to[i].kind, to[i].object_a, to[i].object_b);
        to[i].feature_a = reader->numbers_a[to[i].feature_a];
        to[i].feature_b = reader->numbers_b[to[i].feature_b];
    }
}

static void take_pairs(const struct pccd_mpi *world, struct reader *reader,
                       const struct pccd_pair *from, struct pccd_pair *to, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        to[i] = from[i];
        look_up(world, reader, to[i].kind, to[i].object_a, to[i].object_b);
        to[i].feature_a = reader->numbers_a[to[i].feature_a];
        to[i].feature_b = reader->numbers_b[to[i].feature_b];
    }
}

/* Contacts or pairs begin .. end - 1: some get their numbers, then they are hashed. A
 * processor cannot read at once what it has just written in parts. [team] */
static hash_sum write_part(const struct pccd_mpi *world, void *to, const void *from,
                           uint64_t begin, uint64_t end)
{
    struct reader reader = {.a = NULL};
    hash_sum sum = 0;
    for (uint64_t i = begin; i < end; i += PIECE) {
        uint64_t n = end - i < PIECE ? end - i : PIECE;
        if (world->mode == PCCD_MODE_PAIRS) {
            struct pccd_pair *pairs = (struct pccd_pair *)to + i;
            take_pairs(world, &reader, (const struct pccd_pair *)from + i, pairs, n);
            add_pairs(&sum, pairs, n);
        } else {
            struct pccd_contact *contacts = (struct pccd_contact *)to + i;
            take_contacts(world, &reader, (const struct pccd_contact *)from + i, contacts,
                          n);
            add_contacts(&sum, contacts, n);
        }
    }
    return sum;
}

/* For cli_mpi_write: contacts or pairs, as the mode says, get their numbers and are
 * hashed. */
static void write_records(void *writer, void *to, const void *from, uint64_t count)
{
    struct pccd_mpi *world = writer;
    hash_sum sum = 0;
    const int team = ranks_team(world, count);
#pragma omp parallel for num_threads(team) schedule(static, 1)
    for (int t = 0; t < team; t++) {
        hash_sum part = write_part(world, to, from, ranks_part(count, t, team),
                                   ranks_part(count, t + 1, team));
#pragma omp critical(ranks_hash_sum)
        sum += part;
    }
    add_words(world->page_hash, sum);
    world->written = to;
}

/* Take the records of a page of a step: copy them if they have numbers of the whole
 * already, else write them so. */
static void take_step(struct pccd_mpi *world, const struct pccd_answer *page)
{
    const void *records =
        page->pairs != NULL ? (const void *)page->pairs : page->contacts;
    size_t bytes = ranks_record_bytes(world->mode);
    char *to = (char *)world->records + world->record_count * bytes;
    if (world->written != NULL) {
        memcpy(to, records, page->count * bytes);
    } else {
        write_records(world, to, records, page->count);
    }
    world->written = NULL;
    world->record_count += page->count;
}

int ranks_records_take(struct pccd_mpi *world, const struct pccd_answer *page)
{
    size_t bytes = world->has_bounds ? sizeof(double) : ranks_record_bytes(world->mode);
    int status = make_room(world, page->count, bytes);
    if (status != PCCD_OK) {
        return status;
    }
    if (page->near != NULL) {
        status = take_near(world, page);
    } else if (page->vertex_bounds != NULL) {
        memcpy((double *)world->records + world->record_count, page->vertex_bounds,
               page->count * sizeof(double));
        world->record_count += page->count;
    } else if (page->count > 0) {
        take_step(world, page);
    }
    return status;
}

bool ranks_records_hold(struct pccd_mpi *world, const struct pccd_answer *page)
{
    if (world->written == NULL || page->cursor < page->total) {
        return false;
    }
    world->records = world->written;
    world->record_count = page->count;
    world->written = NULL;
    world->page = *page;
    free(world->copied); /* those of before */
    world->copied = NULL;
    world->copied_bytes = 0;
    return true;
}

void ranks_records_begin(struct pccd_mpi *world)
{
    pccd_answer_release(world->client, &world->page);
    world->records = world->copied;
    world->written = NULL;
    /* Of one rank that is recorded, a page is only copied. */
    (void)cli_mpi_write(world->client, write_records, world);
    world->record_count = 0;
    memset(world->page_hash, 0, sizeof world->page_hash);
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

void ranks_records_sum(const struct pccd_mpi *world, struct ranks_sums *sums)
{
    const struct pccd_contact *contacts = world->records;
    const struct pccd_pair *pairs = world->records;
    uint64_t count = world->record_count;
    bool has_pairs = world->mode == PCCD_MODE_PAIRS;
    hash_sum sum = 0;
    *sums = (struct ranks_sums){.total = count, .toi_first = 2};
    for (uint64_t i = 0; i < count && has_pairs; i++) {
        sums->counts[pairs[i].kind]++;
    }
    for (uint64_t i = 0; i < count && !has_pairs; i++) {
        count_contact(&contacts[i], sums);
    }
    if (has_pairs) {
        add_pairs(&sum, pairs, count);
    } else {
        add_contacts(&sum, contacts, count);
    }
    add_words(sums->hash, sum);
}

void ranks_records_told(const struct pccd_mpi *world, const struct pccd_answer *answer,
                        struct ranks_sums *sums)
{
    if (world->record_count != answer->total) { /* it ended early */
        ranks_records_sum(world, sums);
        return;
    }
    *sums = (struct ranks_sums){.possible = answer->possible,
                                .initial = answer->initial,
                                .inside = answer->inside,
                                .coincident = answer->coincident,
                                .total = world->record_count,
                                .toi_first = answer->toi_first};
    memcpy(sums->counts, answer->counts, sizeof sums->counts);
    memcpy(sums->hash, world->page_hash, sizeof sums->hash);
}

void ranks_records_count_near(const struct pccd_mpi *world, struct ranks_sums *sums,
                              double *least, double *greatest)
{
    const struct pccd_near *near = world->records;
    hash_sum sum = 0;
    *sums = (struct ranks_sums){.total = world->record_count, .toi_first = 2};
    *least = 2e18;
    *greatest = 0;
    for (uint64_t i = 0; i < world->record_count; i++) {
        sums->counts[near[i].kind]++;
        *least = near[i].d_lo < *least ? near[i].d_lo : *least;
        *greatest = near[i].d_hi > *greatest ? near[i].d_hi : *greatest;
        add_hash(&sum, XXH3_128bits(&near[i], sizeof near[i]));
    }
    add_words(sums->hash, sum);
}

void ranks_bounds_sum(const struct ranks_bound *bounds, uint64_t count,
                      struct ranks_sums *sums)
{
    hash_sum sum = 0;
    for (uint64_t i = 0; i < count; i++) {
        add_hash(&sum, XXH3_128bits(&bounds[i], sizeof bounds[i]));
    }
    sums->total += count;
    add_words(sums->hash, sum);
}
