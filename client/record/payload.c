/* payload.c - shapes; the attributes of an object, as FILTER has them; hashes. */
#include "payload.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "coordinates.h"

struct record_shape record_shape_of(const struct record_mesh *head)
{
    struct record_shape at = {.x = sizeof *head};
    uint64_t x_bytes = head->vertex_count * common_vertex_bytes(head->format);

    at.radii = at.x + (x_bytes + 7) / 8 * 8;
    at.triangles =
        at.radii + (head->has_radii != 0) * head->vertex_count * sizeof(double);
    at.edges = at.triangles + head->triangle_count * sizeof(uint32_t[3]);
    at.points = at.edges + head->edge_count * sizeof(uint32_t[2]);
    at.end = at.points + head->point_count * sizeof(uint32_t);
    return at;
}

void record_filter_make(struct record_filter *filter, uint32_t scene, uint32_t object,
                        uint32_t what, const struct common_attributes *given)
{
    *filter = (struct record_filter){
        .scene = scene, .object = object, .what = COMMON_OBJECT_BITS(what)};
    common_attributes_pack(given, filter->words);
}

void record_filter_read(const void *payload, uint64_t bytes, struct record_filter *filter,
                        struct common_attributes *given)
{
    uint64_t read = bytes < sizeof *filter ? bytes : sizeof *filter;
    uint64_t count = (read - offsetof(struct record_filter, words)) / sizeof(uint64_t);

    assert(bytes >= RECORD_FILTER_BYTES);
    *filter = (struct record_filter){.what = 0};
    memcpy(filter, payload, read);
    *given = (struct common_attributes)COMMON_ATTRIBUTES_AT_FIRST;
    common_attributes_unpack(given, filter->words, count);
}

/* sum += what, modulo 2^128. */
static void add(uint64_t sum[2], XXH128_hash_t what)
{
    sum[1] += what.low64;
    sum[0] += what.high64 + (sum[1] < what.low64 ? 1 : 0);
}

void record_verdict_hash(uint32_t verdict, uint64_t hash[2])
{
    hash[0] = hash[1] = 0;
    add(hash, XXH3_128bits(&verdict, sizeof verdict));
}

void record_answer_hash(const void *records, uint64_t count, size_t record_bytes,
                        uint64_t hash[2])
{
    const unsigned char *record = records;

    assert(records != NULL || count == 0);
    hash[0] = hash[1] = 0;
    for (uint64_t i = 0; i < count; i++) {
        add(hash, XXH3_128bits(record + i * record_bytes, record_bytes));
    }
    add(hash, XXH3_128bits(&count, sizeof count));
}
