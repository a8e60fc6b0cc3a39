/* client/ctl/mesh/gltf_accessor.h - the elements of a glTF accessor, as doubles.
 *
 * Room:     client/ctl. May include: gltf_file.h.
 * Does:     find and judge an accessor: what it has, where it lies, what is sparse; read
 *           any element of it. Nothing is copied, and nothing beyond the file is touched.
 * Threads:  find: one at a time; the rest: any.
 * Source:   "glTF 2.0 Specification", 3.6.2; KHR_mesh_quantization.
 */
#ifndef CTL_GLTF_ACCESSOR_H
#define CTL_GLTF_ACCESSOR_H

#include "gltf_file.h"

/* Types of components, as bits. */
enum gltf_type {
    GLTF_I8 = 1,
    GLTF_U8 = 2,
    GLTF_I16 = 4,
    GLTF_U16 = 8,
    GLTF_U32 = 32,
    GLTF_FLOAT = 64,
    GLTF_NORMALIZED = 128, /* integers only if they stand for fractions */
    /* What may stand in some places: */
    GLTF_POSITIONS = GLTF_FLOAT | GLTF_I8 | GLTF_U8 | GLTF_I16 | GLTF_U16,
    GLTF_FRACTIONS = GLTF_POSITIONS | GLTF_NORMALIZED,
    GLTF_INDICES = GLTF_U8 | GLTF_U16 | GLTF_U32,
};

struct gltf_accessor {
    const char *at; /* NULL: all zeros */
    size_t count, stride;
    size_t components, bytes; /* of an element; of a component */
    enum gltf_type type;
    bool is_normalized;
    double greatest; /* what stands for 1 then */
    size_t index;    /* in the file */
    /* Elements that others stand for, in ascending order. */
    size_t sparse_count, sparse_bytes;
    const char *sparse_at, *sparse_values;
    enum gltf_type sparse_type;
};

/* Find accessor `index`, which is to have elements of a kind ("VEC3") and components of
 * `types`. Errors: E_FORMAT, and those of gltf_buffer. */
int gltf_accessor_find(struct gltf *gltf, int64_t index, const char *kind, unsigned types,
                       struct gltf_accessor *accessor);
/* Fill values[components] from element i. */
void gltf_accessor_read(const struct gltf_accessor *accessor, size_t i, double *values);
/* Component k of element i of one whose components are GLTF_INDICES. */
uint32_t gltf_accessor_integer(const struct gltf_accessor *accessor, size_t i, size_t k);
/* An integer of GLTF_INDICES that lies there. */
static inline uint32_t gltf_integer_at(const char *at, enum gltf_type type)
{
    const unsigned char *bytes = (const unsigned char *)at;
    return type == GLTF_U8    ? bytes[0]
           : type == GLTF_U16 ? (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8
                              : (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 |
                                    (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

#endif
