/* client/ctl/mesh/gltf_file.h - the JSON, buffers and accessors of a glTF 2.0 file.
 *
 * What goes wrong is told once: the first text is in `error`, and its status in `status`
 * from then on. Who goes on to use what was read looks there. All that is allocated is
 * the file's, until gltf_close.
 *
 * Source: Khronos Group, "glTF 2.0 Specification", 3.6, 3.12, 4.4; KHR_mesh_quantization.
 */
#ifndef CTL_GLTF_FILE_H
#define CTL_GLTF_FILE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"
#include "text.h"

struct gltf {
    struct ctl_file *file; /* of which the rest is read when it is asked for */
    struct ctl_error *error;
    int status;
    json_t *root;
    struct gltf_buffer *buffers;
    size_t buffer_count;
    uint64_t bytes; /* of all files that were read */
    bool is_export; /* of pccdctl export */
    void **blocks;  /* [block_count]: what was allocated */
    size_t block_count, block_room;
    struct gltf_piece *pieces; /* [piece_count]: what was read of large files */
    size_t piece_count, piece_room;
};

/* Parse the JSON of a file that was opened, and judge its version and the extensions that
 * it requires. gltf_close also after an error. */
bool gltf_open(struct ctl_file *file, struct ctl_error *error, struct gltf *gltf);
void gltf_close(struct gltf *gltf);
/* Note an error, with the file's name and the text, unless `is_right`; an earlier one
 * stays. Returns is_right. */
bool gltf_check_as(struct gltf *gltf, bool is_right, int status, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
#define gltf_check(gltf, is_right, ...)                                                  \
    gltf_check_as(gltf, is_right, PCCD_E_FORMAT, __VA_ARGS__)
/* Allocate zeros for `count` things of `bytes`, which `what` names in the error, and for
 * one more. NULL: no memory. */
void *gltf_alloc(struct gltf *gltf, size_t count, size_t bytes, const char *what);

/* Return an index or a count; `otherwise` where there is none (NULL), -1 where it is
 * none. */
long long gltf_value(const json_t *value, long long otherwise);
long long gltf_number(const json_t *object, const char *name, long long otherwise);
/* Return entry `index` of an array of the root; NULL: there is none. */
const json_t *gltf_entry(const struct gltf *gltf, const char *array, long long index);
size_t gltf_entry_count(const struct gltf *gltf, const char *array);

/* An object of the file, and its name in an error: "node 3". */
struct gltf_named {
    const json_t *json;
    const char *what;
    size_t index;
};

/* Fill values[count] from an array of `count` finite numbers, which stay as they are
 * where there is none. */
void gltf_numbers(struct gltf *gltf, struct gltf_named object, const char *name,
                  size_t count, double *values);
/* Return the extension by which an object is compressed; NULL: by none. */
const char *gltf_compression(const json_t *object);

/* ---- accessors: elements of a buffer, as doubles; nothing is copied ---------------- */

/* Types of components, by their numbers in the file; 5124 is none. */
enum gltf_type {
    GLTF_I8 = 5120,
    GLTF_U8,
    GLTF_I16,
    GLTF_U16,
    GLTF_U32 = 5125,
    GLTF_FLOAT
};

/* Use of an accessor, which says what elements it may have. */
enum gltf_role {
    GLTF_POSITIONS, /* or how far morph targets are from them */
    GLTF_JOINTS,
    GLTF_JOINT_WEIGHTS,
    GLTF_INDICES,
    GLTF_MATRICES,
    GLTF_TIMES,
    GLTF_VECTORS,
    GLTF_ROTATIONS,
    GLTF_FRACTIONS,
};

struct gltf_accessor {
    const char *at;      /* NULL: all zeros */
    enum gltf_type type; /* 0: there is none */
    size_t count, stride;
    size_t components, bytes; /* of an element; of a component */
    double greatest; /* of integers that are fractions, what stands for 1; else 0 */
    size_t index;    /* in the file */
    /* Elements that others stand for, in ascending order. */
    size_t sparse_count;
    const char *sparse_at, *sparse_values;
    enum gltf_type sparse_type;
};

/* Find the accessor of this number (NULL: there is none), and judge what it has, where
 * that lies, and what is sparse. After an error it has no elements. */
struct gltf_accessor gltf_find(struct gltf *gltf, const json_t *number,
                               enum gltf_role role);
/* Fill values[components] from element i. */
void gltf_read(const struct gltf_accessor *accessor, size_t i, double *values);

#endif
