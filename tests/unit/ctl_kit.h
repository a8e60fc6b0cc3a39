/* ctl_kit.h - writes mesh files, for the tests of the mesh readers.
 *
 * Source: "The PLY Polygon File Format" (Turk 1994).
 */
#ifndef TEST_CTL_KIT_H
#define TEST_CTL_KIT_H

#include "cases.h"
#include "meshfile.h"
#include "pccd_types.h"

#define KIT_PATH_BYTES     256
#define KIT_FILE_BYTES_MAX 4096
#define KIT_COUNT(array)   (sizeof array / sizeof((array)[0]))

/* The mesh of every whole file: a pyramid whose base is one face of four corners. The
 * coordinates are exact in a float and in 16 bits. */
#define KIT_VERTICES  5
#define KIT_TRIANGLES 6
extern const double kit_x[KIT_VERTICES][3];

/* A file being made. */
struct kit_bytes {
    char data[KIT_FILE_BYTES_MAX];
    size_t count;
};

/* Differences of one PLY file from the others. */
struct kit_variant {
    const char *encoding;
    const char *coordinate, *count, *index; /* types */
    bool has_extras;                        /* properties and an element to be skipped */
    enum pccd_format format;                /* what the mesh must be */
};

void kit_put_text(struct kit_bytes *bytes, const char *text);
/* The whole file; what stood in `bytes` before is gone. */
void kit_make_ply(struct kit_bytes *bytes, const struct kit_variant *variant);

/* The folder of this program, from kit_make_folder to kit_remove_folder, which are the
 * group's setup and teardown. */
extern char kit_folder[];
int kit_make_folder(void **state);
int kit_remove_folder(void **state);
/* Write a file into it and read it; returns the reader's status. The mesh is there until
 * the next one is read, and what was wrong. */
int kit_read(const char *name, const void *data, size_t bytes);
extern struct ctl_mesh kit_read_mesh;
extern struct ctl_error kit_read_error;
/* Write a file into it; `path` of KIT_PATH_BYTES gets where it is. */
void kit_write_file(const char *name, const void *data, size_t bytes, char *path);

#endif
