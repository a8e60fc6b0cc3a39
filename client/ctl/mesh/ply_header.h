/* client/ctl/mesh/ply_header.h - reads the header of a PLY file.
 *
 * Room:     client/ctl. May include: error.h, text.h, pccd_types.h.
 * Does:     find the properties that matter, and bound every count by the bytes that
 *           follow.
 * Does not: read the body (see ply.c).
 * Threads:  [any]; nothing is shared.
 * Source:   "The PLY Polygon File Format" (Turk 1994).
 */
#ifndef CTL_PLY_HEADER_H
#define CTL_PLY_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "text.h"

#define PLY_ELEMENTS_MAX   32
#define PLY_PROPERTIES_MAX 256 /* of all elements together */
#define PLY_NAME_BYTES     48  /* of an element's name, for messages */

enum ply_encoding { PLY_NONE, PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN };

/* X(id, first name, second name, bytes, whole numbers, exact in a float) */
#define PLY_TYPES(X)                                                                     \
    X(INT8, "char", "int8", 1, true, true)                                               \
    X(UINT8, "uchar", "uint8", 1, true, true)                                            \
    X(INT16, "short", "int16", 2, true, true)                                            \
    X(UINT16, "ushort", "uint16", 2, true, true)                                         \
    X(INT32, "int", "int32", 4, true, false)                                             \
    X(UINT32, "uint", "uint32", 4, true, false)                                          \
    X(INT64, "long", "int64", 8, true, false)                                            \
    X(UINT64, "ulong", "uint64", 8, true, false)                                         \
    X(FLOAT32, "float", "float32", 4, false, true)                                       \
    X(FLOAT64, "double", "float64", 8, false, false)

enum ply_type {
#define PLY_TYPE_ENUM(id, name, alias, bytes, whole, narrow) PLY_##id,
    PLY_TYPES(PLY_TYPE_ENUM)
#undef PLY_TYPE_ENUM
        PLY_TYPE_COUNT
};

/* What a property is to us. X, Y, Z are 0, 1, 2 so that the role is the axis. */
enum ply_role { PLY_X, PLY_Y, PLY_Z, PLY_INDICES, PLY_END0, PLY_END1, PLY_SKIP };

struct ply_property {
    struct ctl_word name;
    enum ply_type type; /* of the value, or of the list's items */
    enum ply_type count_type;
    bool is_list;
    enum ply_role role;
};

struct ply_element {
    struct ctl_word name;
    uint64_t count;
    uint32_t property_first;
    uint32_t property_count;
    bool has_faces,
        are_strips;     /* a list of indices: of faces, or of strips of triangles */
    uint64_t row_first; /* of faces: in the elements before it */
};

struct ply_header {
    enum ply_encoding encoding;
    uint32_t element_count;
    uint32_t property_count;
    struct ply_element elements[PLY_ELEMENTS_MAX];
    struct ply_property properties[PLY_PROPERTIES_MAX];
    char names[PLY_ELEMENTS_MAX][PLY_NAME_BYTES];
    uint64_t vertex_count;
    uint64_t face_count; /* of all elements that have faces; 0: there are none */
    uint64_t edge_count; /* likewise */
    bool is_narrow;      /* every coordinate type is exact in a float */
};

/* Read the header at text's start; afterwards text stands at the first byte of the body.
 * On success: there is one element "vertex" with scalar x, y, z, and maybe some with
 * a list of indices, and one "edge" with scalar vertex1 and vertex2; no element can
 * be longer than the file. Names of elements lie in the header then, and may be cut;
 * those of properties lie in the text, which may move. */
int ctl_ply_header(const struct ctl_file *file, struct ctl_text *text,
                   struct ply_header *header, struct ctl_error *error);

size_t ctl_ply_type_bytes(enum ply_type type);
bool ctl_ply_type_is_whole(enum ply_type type);

#endif
