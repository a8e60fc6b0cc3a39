/* client/ctl/mesh/gltf_file.h - the JSON and the buffers of a glTF 2.0 file.
 *
 * Room:     client/ctl. May include: text.h, jansson.h.
 * Does:     find the JSON in .glb and .gltf, read its members, and a buffer when it is
 *           asked for: the file's own, of a data: URI, or of a file in the folder of this
 *           one or below it.
 * Does not: know what the JSON is about, beyond which extensions change positions.
 * Threads:  one at a time.
 * Source:   Khronos Group, "glTF 2.0 Specification", 3.6.1, 3.12, 4.4; RFC 3986.
 */
#ifndef CTL_GLTF_FILE_H
#define CTL_GLTF_FILE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "text.h"

struct gltf_buffer {
    const char *at; /* NULL: not asked for yet */
    size_t bytes;
    char *decoded; /* NULL, or of a data: URI */
    char *path;    /* NULL, or of another file, */
    struct ctl_file file;
};

/* Errors go to `error`, which belongs to the caller that is at work. */
struct gltf {
    struct ctl_file *file; /* loaded */
    struct ctl_error *error;
    json_t *root;
    const char *binary; /* the chunk of data; NULL: none */
    size_t binary_bytes;
    struct gltf_buffer *buffers;
    size_t buffer_count;
    uint64_t bytes; /* of all files that were read */
    bool is_export; /* of pccdctl export */
};

/* Parse the JSON of a file that is in memory, and judge its version and the extensions
 * that it requires. Errors: E_FORMAT, E_NOMEM. gltf_close also after an error. */
int gltf_open(struct ctl_file *file, struct ctl_error *error, struct gltf *gltf);
void gltf_close(struct gltf *gltf);

/* Write the file's name and the text; returns `status`. */
int gltf_fail(struct gltf *gltf, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* An index or a count; `otherwise` where there is none, -1 where it is none. */
int64_t gltf_number(const json_t *object, const char *name, int64_t otherwise);
/* Entry `index` of an array of the root; NULL: there is none. */
const json_t *gltf_entry(const struct gltf *gltf, const char *array, int64_t index);
size_t gltf_entry_count(const struct gltf *gltf, const char *array);
/* Fill values[count] from an array of `count` finite numbers, which stay as they are
 * where there is none. `what` and `index` name the object in the error, E_FORMAT. */
int gltf_numbers(struct gltf *gltf, const json_t *object, const char *name, size_t count,
                 double *values, const char *what, size_t index);

/* The bytes of a buffer. Errors: E_FORMAT, E_NOMEM, E_SYSTEM. */
int gltf_buffer(struct gltf *gltf, int64_t index, const struct gltf_buffer **buffer);

#endif
