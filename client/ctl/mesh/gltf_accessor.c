/* client/ctl/mesh/gltf_accessor.c - the elements of a glTF accessor, as doubles.
 *
 * Room:     client/ctl.
 * Does:     judge where elements lie; read them.
 * Threads:  find: one at a time; the rest: any.
 * Source:   gltf_accessor.h.
 */
#include "gltf_accessor.h"

#include <inttypes.h>
#include <string.h>

#include "pccd_types.h"

#define STRIDE_MAX 252 /* of the specification */
#define MESHOPT    "_meshopt_compression"

static const struct {
    int64_t code;
    enum gltf_type type;
    size_t bytes;
    double greatest; /* what stands for 1 */
} types_known[] = {
    {5120, GLTF_I8, 1, 127},    {5121, GLTF_U8, 1, 255}, {5122, GLTF_I16, 2, 32767},
    {5123, GLTF_U16, 2, 65535}, {5125, GLTF_U32, 4, 1},  {5126, GLTF_FLOAT, 4, 1},
};
static const struct {
    const char *kind;
    size_t components;
} kinds_known[] = {{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};

/* Where the type stands in the list; -1: it is none. */
static int row_of_code(int64_t code)
{
    int row = (int)(sizeof types_known / sizeof types_known[0]) - 1;
    while (row >= 0 && types_known[row].code != code) {
        row--;
    }
    return row;
}

/* A run of `count` elements of `bytes` each in bufferView `index` from `offset` on. */
static int find_run(struct gltf *gltf, size_t accessor, int64_t index, int64_t offset,
                    size_t count, size_t bytes, const char **at, size_t *stride)
{
    const json_t *view = gltf_entry(gltf, "bufferViews", index);
    const json_t *extensions = json_object_get(view, "extensions");
    const struct gltf_buffer *buffer;
    const char *name;
    json_t *value;
    if (view == NULL) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: there is no bufferView %" PRId64, accessor,
                         index);
    }
    json_object_foreach((json_t *)extensions, name, value)
    {
        if (strstr(name, MESHOPT) != NULL) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "bufferView %" PRId64
                             ": is compressed by \"%.80s\", which is not read",
                             index, name);
        }
    }
    int status = gltf_buffer(gltf, gltf_number(view, "buffer", -1), &buffer);
    if (status != PCCD_OK) {
        return status;
    }
    int64_t begin = gltf_number(view, "byteOffset", 0);
    int64_t length = gltf_number(view, "byteLength", -1);
    int64_t step = gltf_number(view, "byteStride", (int64_t)bytes);
    if (begin < 0 || length < 0 || (uint64_t)length > buffer->bytes ||
        (uint64_t)begin > buffer->bytes - (uint64_t)length) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "bufferView %" PRId64
                         ": goes beyond its buffer, which has %zu bytes",
                         index, buffer->bytes);
    }
    if (step < (int64_t)bytes || step > STRIDE_MAX) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "bufferView %" PRId64 ": a stride of %" PRId64
                         " bytes for elements of %zu",
                         index, step, bytes);
    }
    if (offset < 0 || offset > length ||
        (count > 0 &&
         ((int64_t)bytes > length - offset ||
          count - 1 > (uint64_t)(length - offset - (int64_t)bytes) / (uint64_t)step))) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: goes beyond bufferView %" PRId64
                         ", which has %" PRId64 " bytes",
                         accessor, index, length);
    }
    *at = buffer->at + begin + offset;
    *stride = (size_t)step;
    return PCCD_OK;
}

static size_t sparse_index(const struct gltf_accessor *accessor, size_t k)
{
    return gltf_integer_at(accessor->sparse_at + k * accessor->sparse_bytes,
                           accessor->sparse_type);
}

static int find_sparse(struct gltf *gltf, const json_t *sparse, size_t bytes,
                       struct gltf_accessor *accessor)
{
    const json_t *indices = json_object_get(sparse, "indices");
    const json_t *values = json_object_get(sparse, "values");
    int64_t count = gltf_number(sparse, "count", -1);
    int row = row_of_code(gltf_number(indices, "componentType", -1));
    size_t stride;
    if (count < 0 || (uint64_t)count > accessor->count || row < 0 ||
        (types_known[row].type & GLTF_INDICES) == 0) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: its sparse elements have no valid count or type",
                         accessor->index);
    }
    accessor->sparse_count = (size_t)count;
    accessor->sparse_type = types_known[row].type;
    accessor->sparse_bytes = types_known[row].bytes;
    int status = find_run(gltf, accessor->index, gltf_number(indices, "bufferView", -1),
                          gltf_number(indices, "byteOffset", 0), (size_t)count,
                          accessor->sparse_bytes, &accessor->sparse_at, &stride);
    if (status == PCCD_OK) {
        status = find_run(gltf, accessor->index, gltf_number(values, "bufferView", -1),
                          gltf_number(values, "byteOffset", 0), (size_t)count, bytes,
                          &accessor->sparse_values, &stride);
    }
    for (size_t k = 0; k < (size_t)count && status == PCCD_OK; k++) {
        size_t here = sparse_index(accessor, k);
        if (here >= accessor->count || (k > 0 && here <= sparse_index(accessor, k - 1))) {
            return gltf_fail(gltf, PCCD_E_INDEX,
                             "accessor %zu: sparse index %zu is %zu of %zu, and they "
                             "ascend",
                             accessor->index, k, here, accessor->count);
        }
    }
    return status;
}

/* Judge what the elements are, and how many. */
static int judge(struct gltf *gltf, const json_t *entry, const char *kind, unsigned types,
                 struct gltf_accessor *accessor)
{
    const char *has = json_string_value(json_object_get(entry, "type"));
    int64_t code = gltf_number(entry, "componentType", -1);
    int64_t count = gltf_number(entry, "count", -1);
    int row = row_of_code(code);
    if (count < 0) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "accessor %zu: has no count",
                         accessor->index);
    }
    if (has == NULL || strcmp(has, kind) != 0 || row < 0 ||
        (types_known[row].type & types) == 0) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: has %.16s of component type %" PRId64
                         " where %s is needed",
                         accessor->index, has != NULL ? has : "elements", code, kind);
    }
    accessor->type = types_known[row].type;
    accessor->bytes = types_known[row].bytes;
    accessor->greatest = types_known[row].greatest;
    accessor->is_normalized = json_is_true(json_object_get(entry, "normalized")) &&
                              accessor->type != GLTF_FLOAT;
    if ((types & GLTF_NORMALIZED) != 0 && !accessor->is_normalized &&
        accessor->type != GLTF_FLOAT) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: has integers that are not normalized, where "
                         "fractions are needed",
                         accessor->index);
    }
    for (size_t i = 0; i < sizeof kinds_known / sizeof kinds_known[0]; i++) {
        if (strcmp(kinds_known[i].kind, kind) == 0) {
            accessor->components = kinds_known[i].components;
        }
    }
    accessor->count = (size_t)count;
    return PCCD_OK;
}

int gltf_accessor_find(struct gltf *gltf, int64_t index, const char *kind, unsigned types,
                       struct gltf_accessor *accessor)
{
    const json_t *entry = gltf_entry(gltf, "accessors", index);
    struct gltf_accessor made = {.index = (size_t)index};
    if (entry == NULL) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "accessor %" PRId64 ": there is none",
                         index);
    }
    int status = judge(gltf, entry, kind, types, &made);
    size_t bytes = made.bytes * made.components;
    if (status == PCCD_OK && json_object_get(entry, "bufferView") != NULL) {
        status = find_run(gltf, made.index, gltf_number(entry, "bufferView", -1),
                          gltf_number(entry, "byteOffset", 0), made.count, bytes,
                          &made.at, &made.stride);
    }
    const json_t *sparse = json_object_get(entry, "sparse");
    if (status == PCCD_OK && sparse != NULL) {
        status = find_sparse(gltf, sparse, bytes, &made);
    }
    /* Zeros that nobody has written take no bytes: there are no more of them than
     * bytes. */
    if (status == PCCD_OK && made.at == NULL && made.count > gltf->bytes) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "accessor %zu: has %zu zeros in a file of %" PRIu64 " bytes",
                         made.index, made.count, gltf->bytes);
    }
    if (status == PCCD_OK) {
        *accessor = made;
    }
    return status;
}

/* ---- elements ---------------------------------------------------------------------- */

/* Where element i lies; NULL: it is zero. */
static const char *place_of(const struct gltf_accessor *accessor, size_t i)
{
    size_t low = 0, high = accessor->sparse_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        size_t here = sparse_index(accessor, middle);
        if (here == i) {
            return accessor->sparse_values +
                   middle * accessor->bytes * accessor->components;
        }
        low = here < i ? middle + 1 : low;
        high = here < i ? high : middle;
    }
    return accessor->at == NULL ? NULL : accessor->at + i * accessor->stride;
}

static inline double value_at(const char *at, enum gltf_type type)
{
    uint32_t bits;
    float value;
    switch (type) {
    case GLTF_I8:
        return (double)(signed char)at[0];
    case GLTF_I16:
        return (double)(int16_t)gltf_integer_at(at, GLTF_U16);
    case GLTF_FLOAT:
        bits = ctl_file_word(at);
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    default:
        return (double)gltf_integer_at(at, type);
    }
}

void gltf_accessor_read(const struct gltf_accessor *accessor, size_t i, double *values)
{
    const char *at = place_of(accessor, i);
    for (size_t k = 0; accessor->type == GLTF_FLOAT && k < accessor->components; k++) {
        values[k] = at == NULL ? 0 : value_at(at + 4 * k, GLTF_FLOAT);
    }
    for (size_t k = 0; accessor->type != GLTF_FLOAT && k < accessor->components; k++) {
        values[k] = at == NULL ? 0 : value_at(at + k * accessor->bytes, accessor->type);
        if (accessor->is_normalized) {
            values[k] /= accessor->greatest;
            values[k] = values[k] < -1 ? -1 : values[k];
        }
    }
}

uint32_t gltf_accessor_integer(const struct gltf_accessor *accessor, size_t i, size_t k)
{
    const char *at = place_of(accessor, i);
    return at == NULL ? 0 : gltf_integer_at(at + k * accessor->bytes, accessor->type);
}
