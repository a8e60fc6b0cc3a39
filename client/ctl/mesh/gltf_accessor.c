/* client/ctl/mesh/gltf_accessor.c - the elements of a glTF accessor, as doubles. */
#include <inttypes.h>
#include <string.h>

#include "gltf_file.h"

#define STRIDE_MAX 252 /* of the specification */

#define BIT(type)  (1u << (GLTF_##type - GLTF_I8))
#define NORMALIZED (1u << 31) /* integers only if they stand for fractions */
#define INTEGERS   (BIT(U8) | BIT(U16) | BIT(U32))
#define POSITIONS  (BIT(FLOAT) | BIT(I8) | BIT(U8) | BIT(I16) | BIT(U16))
#define FRACTIONS  (POSITIONS | NORMALIZED)

static const struct {
    size_t bytes;
    double greatest; /* what stands for 1 */
} types[] = {{1, 127}, {1, 255}, {2, 32767}, {2, 65535}, {0, 0}, {4, 0}, {4, 0}};

static const struct {
    const char *kind;
    size_t components;
    unsigned types; /* that it may have, as bits */
} roles[] = {
    [GLTF_POSITIONS] = {"VEC3", 3, POSITIONS},
    [GLTF_JOINTS] = {"VEC4", 4, BIT(U8) | BIT(U16)},
    [GLTF_JOINT_WEIGHTS] = {"VEC4", 4, BIT(FLOAT) | BIT(U8) | BIT(U16) | NORMALIZED},
    [GLTF_INDICES] = {"SCALAR", 1, INTEGERS},
    [GLTF_MATRICES] = {"MAT4", 16, BIT(FLOAT)},
    [GLTF_TIMES] = {"SCALAR", 1, BIT(FLOAT)},
    [GLTF_VECTORS] = {"VEC3", 3, BIT(FLOAT)},
    [GLTF_ROTATIONS] = {"VEC4", 4, FRACTIONS},
    [GLTF_FRACTIONS] = {"SCALAR", 1, FRACTIONS},
};

/* The type that a code stands for, if it is one of these bits; 0: it is not. */
static enum gltf_type type_of(long long code, unsigned bits)
{
    bool is_type = code >= GLTF_I8 && code <= GLTF_FLOAT;
    return is_type && (bits >> (code - GLTF_I8) & 1) != 0 ? (enum gltf_type)code : 0;
}

static size_t bytes_of(enum gltf_type type)
{
    return type != 0 ? types[type - GLTF_I8].bytes : 0;
}

static inline double value_at(const char *at, enum gltf_type type)
{
    uint32_t bits;
    float value;
    switch (type) {
    case GLTF_I8:
        return (double)(signed char)at[0];
    case GLTF_I16:
        return (double)(int16_t)gltf_integer_at(at, 2);
    case GLTF_FLOAT:
        bits = gltf_integer_at(at, 4);
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    default:
        return (double)gltf_integer_at(at, bytes_of(type));
    }
}

static size_t sparse_index(const struct gltf_accessor *accessor, size_t k)
{
    size_t bytes = bytes_of(accessor->sparse_type);
    return gltf_integer_at(accessor->sparse_at + k * bytes, bytes);
}

/* ---- finding ----------------------------------------------------------------------- */

/* Where `count` elements of `bytes` each lie, by the bufferView and byteOffset of an
 * object of the accessor. NULL: nowhere. */
static const char *find_bytes(struct gltf *gltf, size_t accessor, const json_t *object,
                              size_t count, size_t bytes, size_t *stride)
{
    long long index = gltf_number(object, "bufferView", -1);
    long long offset = gltf_number(object, "byteOffset", 0);
    const json_t *view = gltf_entry(gltf, "bufferViews", index);
    long long begin = gltf_number(view, "byteOffset", 0);
    long long length = gltf_number(view, "byteLength", -1);
    long long step = gltf_number(view, "byteStride", (long long)bytes);
    long long rest = length - offset - (long long)bytes; /* behind the first one */
    const char *compression = gltf_compression(view);
    gltf_check(gltf, view != NULL, "accessor %zu: there is no bufferView %lld", accessor,
               index);
    gltf_check(gltf, compression == NULL,
               "bufferView %lld: is compressed by \"%.80s\", which is not read", index,
               compression);
    const struct gltf_buffer *buffer = gltf_buffer(gltf, gltf_number(view, "buffer", -1));
    if (buffer == NULL) {
        return NULL;
    }
    long long has = (long long)buffer->bytes;
    gltf_check(gltf, begin >= 0 && length >= 0 && begin <= has - length,
               "bufferView %lld: goes beyond its buffer, which has %lld bytes", index,
               has);
    gltf_check(gltf, step >= (long long)bytes && step <= STRIDE_MAX,
               "bufferView %lld: a stride of %lld bytes for elements of %zu", index, step,
               bytes);
    gltf_check(
        gltf,
        offset >= 0 && offset <= length &&
            (count == 0 || (rest >= 0 && step > 0 && count - 1 <= (size_t)(rest / step))),
        "accessor %zu: goes beyond bufferView %lld, which has %lld bytes", accessor,
        index, length);
    *stride = (size_t)step;
    return gltf->status == PCCD_OK ? buffer->at + begin + offset : NULL;
}

static void find_sparse(struct gltf *gltf, const json_t *sparse,
                        struct gltf_accessor *accessor)
{
    const json_t *indices = json_object_get(sparse, "indices");
    const json_t *values = json_object_get(sparse, "values");
    long long number = gltf_number(sparse, "count", -1);
    size_t count = (size_t)number, stride;
    accessor->sparse_type = type_of(gltf_number(indices, "componentType", -1), INTEGERS);
    gltf_check(
        gltf, number >= 0 && count <= accessor->count && accessor->sparse_type != 0,
        "accessor %zu: its sparse elements have no valid count or type", accessor->index);
    accessor->sparse_at = find_bytes(gltf, accessor->index, indices, count,
                                     bytes_of(accessor->sparse_type), &stride);
    accessor->sparse_values = find_bytes(gltf, accessor->index, values, count,
                                         accessor->bytes * accessor->components, &stride);
    for (size_t k = 0; k < count && gltf->status == PCCD_OK; k++) {
        size_t here = sparse_index(accessor, k);
        gltf_check_as(
            gltf,
            here < accessor->count && (k == 0 || here > sparse_index(accessor, k - 1)),
            PCCD_E_INDEX, "accessor %zu: sparse index %zu is %zu of %zu, and they ascend",
            accessor->index, k, here, accessor->count);
    }
    accessor->sparse_count = count;
}

struct gltf_accessor gltf_find(struct gltf *gltf, const json_t *number,
                               enum gltf_role role)
{
    long long index = gltf_value(number, -1);
    const json_t *entry = gltf_entry(gltf, "accessors", index);
    const json_t *sparse = json_object_get(entry, "sparse");
    const char *kind = json_string_value(json_object_get(entry, "type"));
    long long code = gltf_number(entry, "componentType", -1);
    long long count = gltf_number(entry, "count", -1);
    bool is_normalized = json_is_true(json_object_get(entry, "normalized"));
    struct gltf_accessor found = {.index = (size_t)index,
                                  .type = type_of(code, roles[role].types),
                                  .count = (size_t)count,
                                  .components = roles[role].components};
    found.bytes = bytes_of(found.type);
    found.greatest =
        is_normalized && found.type != 0 ? types[found.type - GLTF_I8].greatest : 0;
    gltf_check(gltf, entry != NULL, "accessor %lld: there is none", index);
    gltf_check(gltf, count >= 0, "accessor %lld: has no count", index);
    gltf_check(gltf,
               found.type != 0 && kind != NULL && strcmp(kind, roles[role].kind) == 0,
               "accessor %lld: has %.16s of component type %lld where %s is needed",
               index, kind != NULL ? kind : "elements", code, roles[role].kind);
    gltf_check(gltf,
               (roles[role].types & NORMALIZED) == 0 || found.type == GLTF_FLOAT ||
                   is_normalized,
               "accessor %lld: has integers that are not normalized, where fractions are "
               "needed",
               index);
    if (json_object_get(entry, "bufferView") != NULL) {
        found.at = find_bytes(gltf, found.index, entry, found.count,
                              found.bytes * found.components, &found.stride);
    }
    if (sparse != NULL) {
        find_sparse(gltf, sparse, &found);
    }
    /* Zeros that nobody has written take no bytes: there are no more of them than
     * bytes. */
    gltf_check(gltf, found.at != NULL || found.count <= gltf->bytes,
               "accessor %lld: has %zu zeros in a file of %" PRIu64 " bytes", index,
               found.count, gltf->bytes);
    return gltf->status == PCCD_OK ? found : (struct gltf_accessor){.count = 0};
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

void gltf_read(const struct gltf_accessor *accessor, size_t i, double *values)
{
    const char *at = place_of(accessor, i);
    size_t bytes = accessor->bytes;
    for (size_t k = 0; k < accessor->components; k++) {
        values[k] = at == NULL ? 0
                    : accessor->type == GLTF_FLOAT
                        ? value_at(at + k * 4, GLTF_FLOAT)
                        : value_at(at + k * bytes, accessor->type);
        if (accessor->greatest > 0) {
            values[k] /= accessor->greatest;
            values[k] = values[k] < -1 ? -1 : values[k];
        }
    }
}
