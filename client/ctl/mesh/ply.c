/* client/ctl/mesh/ply.c - PLY files.
 *
 * Faces, edges and points are as meshfile.h says; all else is skipped. No count is
 * trusted: the header's are bounded by the bytes that follow, and each value is checked
 * against the end of the file.
 *
 * Source: "The PLY Polygon File Format" (Turk 1994).
 */
#include <endian.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "meshfile.h"
#include "printable.h"

#define ELEMENTS_MAX   32u
#define PROPERTIES_MAX 256u /* of all elements together */
#define NAME_BYTES     48   /* of what messages quote of a name */

enum kind { SIGNED, UNSIGNED, REAL };

static const struct type {
    const char *name, *alias;
    uint32_t bytes;
    enum kind kind;
} types[] = {
    {"char", "int8", 1, SIGNED},   {"uchar", "uint8", 1, UNSIGNED},
    {"short", "int16", 2, SIGNED}, {"ushort", "uint16", 2, UNSIGNED},
    {"int", "int32", 4, SIGNED},   {"uint", "uint32", 4, UNSIGNED},
    {"long", "int64", 8, SIGNED},  {"ulong", "uint64", 8, UNSIGNED},
    {"float", "float32", 4, REAL}, {"double", "float64", 8, REAL},
};

/* Use that we make of a property; those before NAMED_ROLES have one element and one
 * name. */
enum role { AXIS_X, AXIS_Y, AXIS_Z, END_0, END_1, NAMED_ROLES, INDICES, SKIP };

static const struct {
    const char *element, *property;
} named_roles[NAMED_ROLES] = {{"vertex", "x"},
                              {"vertex", "y"},
                              {"vertex", "z"},
                              {"edge", "vertex1"},
                              {"edge", "vertex2"}};

struct property {
    const struct type *type;       /* of the value, or of the list's items */
    const struct type *count_type; /* NULL: no list */
    enum role role;
};

struct element {
    char name[NAME_BYTES];
    uint64_t count;
    uint32_t property_first, property_count;
    bool is_surface, are_strips; /* it has the name of one; of strips of triangles */
    struct property *faces;      /* its list of vertices; NULL: it has none */
    bool is_standard;            /* that has the name of the specification, or nearly */
    char unknown[NAME_BYTES];    /* "", or what may be faces or edges, */
    bool is_unknown;             /* and is that */
    uint64_t row_first;          /* of faces: in the elements before it */
};

struct ply {
    struct ctl_file *file;
    struct ctl_mesh *mesh;
    enum encoding { NO_ENCODING, ASCII, LOWEST_FIRST, HIGHEST_FIRST } encoding;
    uint32_t element_count, property_count;
    struct element elements[ELEMENTS_MAX];
    struct property properties[PROPERTIES_MAX];
    const struct property *named[NAMED_ROLES]; /* NULL: there is none */
    const struct element *vertex, *edge;       /* edge may be NULL */
    uint64_t face_count;                       /* of all elements that have faces */
    bool is_cloud;                             /* there is nothing but vertices */
    bool is_wide;          /* a coordinate of a type that is not exact in a float */
    struct ctl_word line;  /* ascii: what is left of this row */
    bool has_value_a_line; /* ascii: the row goes on in the next lines */
};

/* ---- the lines of the header ------------------------------------------------------- */

/* Copy as much of a word as a message quotes: the text that it lies in does not stay. */
static void copy_name(char name[NAME_BYTES], const struct ctl_word *word)
{
    snprintf(name, NAME_BYTES, "%.*s", CTL_QUOTE(*word));
}

/* Return whether a word is one of the first `count` names, in capitals, too. */
static bool is_any_of(const struct ctl_word *word, const char *const *names, size_t count)
{
    bool is_one = false;
    for (size_t i = 0; i < count; i++) {
        is_one = is_one || ctl_word_is_any_case(word, names[i]);
    }
    return is_one;
}

static int read_format(struct ply *ply, const struct ctl_word words[3])
{
    static const char *const names[] = {[ASCII] = "ascii",
                                        [LOWEST_FIRST] = "binary_little_endian",
                                        [HIGHEST_FIRST] = "binary_big_endian"};
    if (ply->encoding != NO_ENCODING) {
        return ctl_file_refuse(ply->file, "a second format line");
    }
    for (enum encoding i = ASCII; i <= HIGHEST_FIRST; i++) {
        ply->encoding = ctl_word_is(&words[1], names[i]) ? i : ply->encoding;
    }
    if (ply->encoding == NO_ENCODING) {
        return ctl_file_refuse(ply->file, "unknown encoding \"%.*s\"",
                               CTL_QUOTE(words[1]));
    }
    return ctl_word_is(&words[2], "1.0")
               ? PCCD_OK
               : ctl_file_refuse(ply->file, "version \"%.*s\" where 1.0 is known",
                                 CTL_QUOTE(words[2]));
}

static int read_element(struct ply *ply, const struct ctl_word words[3])
{
    static const char *const surfaces[] = {
        "tristrips", "tristrip", "triangle_strips", "triangle_strip", "strips",
        "strip",     "face",     "faces",           "triangle",       "triangles",
        "tri",       "tris",     "polygon",         "polygons",       "poly",
        "quad",      "quads"};
    int64_t count;
    if (!ctl_word_integer(&words[2], &count) || count < 0) {
        return ctl_file_refuse(ply->file, "\"%.*s\" is not a count", CTL_QUOTE(words[2]));
    }
    if (ply->element_count == ELEMENTS_MAX) {
        return ctl_file_fail(ply->file, PCCD_E_LIMIT, "more than %u elements",
                             ELEMENTS_MAX);
    }
    struct element *element = &ply->elements[ply->element_count++];
    *element = (struct element){.count = (uint64_t)count,
                                .property_first = ply->property_count,
                                .is_surface = is_any_of(&words[1], surfaces, 17),
                                .are_strips = is_any_of(&words[1], surfaces, 6)};
    copy_name(element->name, &words[1]);
    return PCCD_OK;
}

static const struct type *read_type(struct ply *ply, const struct ctl_word *word)
{
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (ctl_word_is(word, types[i].name) || ctl_word_is(word, types[i].alias)) {
            return &types[i];
        }
    }
    ctl_file_refuse(ply->file, "unknown type \"%.*s\"", CTL_QUOTE(*word));
    return &types[0];
}

static enum role role_of(struct ply *ply, struct element *element,
                         struct property *property, const struct ctl_word *name)
{
    static const char *const names[] = {"vertex_indices", "vertex_index",
                                        "vertex_indexes", "vertices", "indices"};
    bool is_whole = property->type->kind != REAL, is_list = property->count_type != NULL;
    for (enum role role = 0; role < NAMED_ROLES; role++) {
        if (!ctl_word_is(name, named_roles[role].property) ||
            strcmp(element->name, named_roles[role].element) != 0) {
            continue;
        }
        if (ply->named[role] != NULL) {
            ctl_file_refuse(ply->file, "two properties \"%s\" of \"%s\"",
                            named_roles[role].property, element->name);
        }
        ply->named[role] = property;
        return role;
    }
    if (strcmp(element->name, "vertex") == 0 || strcmp(element->name, "edge") == 0) {
        return SKIP;
    }
    /* Faces are in the first list with a name of the specification, else in the first one
     * that has a name of indices. Whole numbers may be written as others there. */
    bool is_standard = is_list && is_any_of(name, names, is_whole ? 3 : 2);
    bool is_one = is_standard || (is_list && is_whole && is_any_of(name, names, 5));
    if (element->is_surface && is_one &&
        (element->faces == NULL || (is_standard && !element->is_standard))) {
        if (element->faces != NULL) {
            element->faces->role = SKIP;
        }
        element->faces = property;
        element->is_standard = is_standard;
        return INDICES;
    }
    bool is_edge = !is_list && ctl_word_is(name, named_roles[END_0].property);
    bool is_unknown = is_standard || is_edge;
    if (is_unknown || (is_list && is_whole && element->unknown[0] == '\0')) {
        copy_name(element->unknown, name);
        element->is_unknown = element->is_unknown || is_unknown;
    }
    return SKIP;
}

static int read_property(struct ply *ply, const struct ctl_word words[5])
{
    if (ply->element_count == 0) {
        return ctl_file_refuse(ply->file, "property before any element");
    }
    if (ply->property_count == PROPERTIES_MAX) {
        return ctl_file_fail(ply->file, PCCD_E_LIMIT, "more than %u properties",
                             PROPERTIES_MAX);
    }
    bool is_list = ctl_word_is(&words[1], "list");
    const struct ctl_word *last = &words[is_list ? 4 : 2];
    struct element *element = &ply->elements[ply->element_count - 1];
    struct property *property = &ply->properties[ply->property_count++];
    property->count_type = is_list ? read_type(ply, &words[2]) : NULL;
    property->type = read_type(ply, last - 1);
    property->role = role_of(ply, element, property, last);
    bool is_narrow = property->type->bytes < (property->type->kind == REAL ? 8 : 4);
    ply->is_wide = ply->is_wide || (property->role <= AXIS_Z && !is_narrow);
    element->property_count++;
    return ply->file->status;
}

/* One line after the first; *is_end is set by "end_header". */
static int read_header_line(struct ply *ply, struct ctl_word line, bool *is_end)
{
    static const struct {
        const char *word;
        uint32_t count; /* of words */
        const char *lack;
        int (*read)(struct ply *ply, const struct ctl_word *words);
    } lines[] = {
        {"property", 3, "property without a name", read_property},
        {"element", 3, "element without a name and a count", read_element},
        {"format", 3, "format without an encoding and a version", read_format},
        {"end_header", 1, NULL, NULL},
    };
    struct ctl_word words[6] = {{NULL, NULL}}; /* one more than a line has */
    uint32_t count = 0, i = 0;
    while (count < 6 && ctl_word_next(&line, &words[count])) {
        count++;
    }
    if (count == 0) {
        return ctl_file_refuse(ply->file, "blank line in the header");
    }
    if (ctl_word_is(&words[0], "comment") || ctl_word_is(&words[0], "obj_info")) {
        return PCCD_OK;
    }
    while (i < 4 && !ctl_word_is(&words[0], lines[i].word)) {
        i++;
    }
    if (i == 4) {
        return ctl_file_refuse(ply->file, "unknown header line \"%.*s\"",
                               CTL_QUOTE(words[0]));
    }
    uint32_t needed = i == 0 && ctl_word_is(&words[1], "list") ? 5 : lines[i].count;
    if (count > needed) {
        return ctl_file_refuse(ply->file, "\"%.*s\" is too much on a header line",
                               CTL_QUOTE(words[needed]));
    }
    if (count < needed) {
        bool has_no_type = i == 0 && count + 1 < needed;
        return ctl_file_refuse(ply->file, "%s",
                               has_no_type ? "property without a type" : lines[i].lack);
    }
    *is_end = lines[i].read == NULL;
    return *is_end ? PCCD_OK : lines[i].read(ply, words);
}

/* ---- the header as a whole --------------------------------------------------------- */

/* The elements "vertex" and "edge" are there once, with all that is needed of them, and
 * "face" has faces. */
static int check_elements(struct ply *ply)
{
    const struct element *unknown = NULL;
    for (uint32_t i = 0; i < ply->element_count; i++) {
        struct element *element = &ply->elements[i];
        bool is_vertex = strcmp(element->name, "vertex") == 0;
        bool is_edge = strcmp(element->name, "edge") == 0;
        if ((is_vertex && ply->vertex != NULL) || (is_edge && ply->edge != NULL)) {
            return ctl_file_refuse(ply->file, "two elements \"%s\"", element->name);
        }
        bool has_faces = element->faces != NULL, has_rows = element->count > 0;
        if (element->is_surface && !has_faces && has_rows) {
            return ctl_file_refuse(ply->file,
                                   "element \"%s\" has no list \"vertex_indices\" or "
                                   "\"vertex_index\"",
                                   element->name);
        }
        if (!element->is_surface && element->is_unknown && has_rows) {
            return ctl_file_refuse(ply->file,
                                   "element \"%s\" has \"%s\", and is none that is read, "
                                   "such as \"face\" or \"edge\"",
                                   element->name, element->unknown);
        }
        ply->vertex = is_vertex ? element : ply->vertex;
        ply->edge = is_edge ? element : ply->edge;
        element->row_first = has_faces ? ply->face_count : 0;
        ply->face_count += has_faces ? element->count : 0;
        unknown = has_rows && element->unknown[0] != '\0' ? element : unknown;
    }
    if (ply->vertex == NULL) {
        return ctl_file_refuse(ply->file, "the header has no element \"vertex\"");
    }
    for (enum role role = 0; role < (ply->edge != NULL ? NAMED_ROLES : END_0); role++) {
        const char *element = named_roles[role].element;
        const char *name = named_roles[role].property;
        if (ply->named[role] == NULL) {
            return ctl_file_refuse(ply->file, "element \"%s\" has no property \"%s\"",
                                   element, name);
        }
        if (ply->named[role]->count_type != NULL) {
            return ctl_file_refuse(ply->file, "property \"%s\" of \"%s\" is a list", name,
                                   element);
        }
    }
    /* Vertices are points only where nothing that may be faces is left out. */
    bool has_edges = ply->edge != NULL && ply->edge->count > 0;
    ply->is_cloud = ply->face_count == 0 && !has_edges;
    return !ply->is_cloud || unknown == NULL
               ? PCCD_OK
               : ctl_file_refuse(ply->file,
                                 "element \"%s\" may have the faces: its list \"%s\" is "
                                 "none that is known, such as \"vertex_indices\"",
                                 unknown->name, unknown->unknown);
}

/* The largest number of a type; what is no whole number is as large as can be. */
static uint64_t largest(const struct type *type)
{
    return type->kind == REAL || type->bytes == 8
               ? UINT64_MAX
               : ((uint64_t)1 << (8 * type->bytes - (type->kind == SIGNED))) - 1;
}

/* a + b * c, or what comes nearest. */
static uint64_t add_product(uint64_t a, uint64_t b, uint64_t c)
{
    uint64_t all;
    return __builtin_mul_overflow(b, c, &all) || __builtin_add_overflow(a, all, &all)
               ? UINT64_MAX
               : all;
}

/* Refuse counts that do not go with the bytes after the header, before these are read and
 * before anything is allocated by them. */
static int check_counts(const struct ply *ply)
{
    bool is_ascii = ply->encoding == ASCII;
    uint64_t there = ctl_file_left(ply->file), left = there, most = 0;
    for (uint32_t i = 0; i < ply->element_count; i++) {
        const struct element *element = &ply->elements[i];
        uint64_t row_least = 0, row_most = 0;
        for (uint32_t k = 0; k < element->property_count; k++) {
            const struct property *property =
                &ply->properties[element->property_first + k];
            const struct type *type = property->type, *count = property->count_type;
            uint64_t items = count != NULL ? largest(count) : 1;
            uint64_t count_bytes = count != NULL ? count->bytes : 0;
            row_least += is_ascii        ? 2 /* a digit and a blank */
                         : count != NULL ? count_bytes
                                         : type->bytes;
            row_most = add_product(row_most, 1, count_bytes);
            row_most = add_product(row_most, items, type->bytes);
        }
        uint64_t needed = add_product(0, element->count, row_least);
        if (element->count > 0 && row_least == 0) {
            return ctl_file_refuse(ply->file, "element \"%s\" has no properties",
                                   element->name);
        }
        /* The last row of an ascii file may lack its line end. */
        if (needed > left + is_ascii) {
            return ctl_file_refuse(ply->file,
                                   "%" PRIu64 " rows of element \"%s\" take %" PRIu64
                                   " bytes or more, and %" PRIu64 " of the file are left",
                                   element->count, element->name, needed, left);
        }
        left -= needed < left ? needed : left;
        most = add_product(most, element->count, row_most);
    }
    /* A line end may follow. */
    return is_ascii || there <= add_product(most, 1, 2)
               ? PCCD_OK
               : ctl_file_refuse(ply->file,
                                 "the elements take at most %" PRIu64
                                 " bytes, and the file has %" PRIu64 " more",
                                 most, there - most);
}

/* Afterwards the file is at the first byte of the body. */
static int read_header(struct ply *ply)
{
    struct ctl_file *file = ply->file;
    struct ctl_word line, word;
    bool is_end = false;
    ctl_file_begin(file);
    bool has_more = file->has_more;
    file->has_more = false; /* no more is read for a header that does not end */
    if (!ctl_file_line(file, &line) || !ctl_word_next(&line, &word) ||
        !ctl_word_is(&word, "ply")) {
        return ctl_file_refuse(file, "the first line is not \"ply\"");
    }
    /* Where a CR alone ends lines, an LF behind the last one is data. */
    bool has_feeds = file->at[-1] == '\n';
    while (file->status == PCCD_OK && !is_end) {
        if (ctl_file_line(file, &line)) {
            read_header_line(ply, line, &is_end);
        } else {
            ctl_file_refuse(file, "%s",
                            file->rest_bytes > 0
                                ? "the header does not end in the first MiB"
                                : "the file ends inside the header");
        }
    }
    file->has_more = has_more;
    if (ply->encoding == NO_ENCODING) {
        return ctl_file_refuse(file, "the header has no format line");
    }
    if (ply->encoding != ASCII && !has_feeds && file->at[-1] == '\n') {
        file->at--;
    }
    return file->status == PCCD_OK && check_elements(ply) == PCCD_OK ? check_counts(ply)
                                                                     : file->status;
}

/* ---- values ------------------------------------------------------------------------ */

/* Values of all types are exact in a double but the largest of 64 bits, which are no
 * indices. */
static inline double decode(const char *at, const struct type *type,
                            bool is_highest_first)
{
    bool is_signed = type->kind == SIGNED;
    uint16_t two;
    uint32_t four;
    uint64_t eight;
    switch (type->bytes) {
    case 1:
        return is_signed ? (double)(int8_t)at[0] : (double)(uint8_t)at[0];
    case 2:
        memcpy(&two, at, sizeof two);
        two = is_highest_first ? be16toh(two) : le16toh(two);
        return is_signed ? (double)(int16_t)two : (double)two;
    case 4:
        memcpy(&four, at, sizeof four);
        four = is_highest_first ? be32toh(four) : le32toh(four);
        if (type->kind == REAL) {
            float real;
            memcpy(&real, &four, sizeof real);
            return (double)real;
        }
        return is_signed ? (double)(int32_t)four : (double)four;
    default:
        memcpy(&eight, at, sizeof eight);
        eight = is_highest_first ? be64toh(eight) : le64toh(eight);
        if (type->kind == REAL) {
            double real;
            memcpy(&real, &eight, sizeof real);
            return real;
        }
        return is_signed ? (double)(int64_t)eight : (double)eight;
    }
}

static bool parse(const struct ctl_word *word, const struct type *type, double *value)
{
    int64_t whole;
    if (type->kind == REAL) {
        return type->bytes == 4 ? ctl_word_float(word, value)
                                : ctl_word_double(word, value);
    }
    if (!ctl_word_integer(word, &whole)) {
        return false;
    }
    *value = (double)whole;
    return true;
}

/* Return whether a whole number is one of its type. An unsigned -1, which begins a strip,
 * is the largest. */
static bool fits(double value, const struct type *type)
{
    double most = (double)largest(type);
    double least = type->kind == SIGNED ? -most - 1 : -1;
    return type->kind == REAL || type->bytes == 8 || (value >= least && value <= most);
}

/* Read a value where the line of the row, or the window of the file, may end. */
static double read_beyond(struct ply *ply, const struct type *type, bool is_wanted)
{
    struct ctl_file *file = ply->file;
    struct ctl_word word;
    double value = 0;
    if (ply->encoding != ASCII) {
        if (!ctl_file_more(file, type->bytes)) {
            ctl_file_refuse(file, "the file ends here");
            return 0;
        }
        file->at += type->bytes;
        return decode(file->at - type->bytes, type, ply->encoding == HIGHEST_FIRST);
    }
    bool is_there = ctl_word_next(&ply->line, &word);
    while (!is_there && ply->has_value_a_line && ctl_file_line(file, &ply->line)) {
        is_there = ctl_word_next(&ply->line, &word);
    }
    if (!is_there) {
        ctl_file_refuse(file, "a value is missing at the end of the line");
    } else if (is_wanted && !parse(&word, type, &value)) {
        ctl_file_refuse(file, "\"%.*s\" is not a%s number", CTL_QUOTE(word),
                        type->kind == REAL ? "" : " whole");
    } else if (!fits(value, type)) {
        ctl_file_refuse(file, "%.*s is no %s", CTL_QUOTE(word), type->name);
    }
    return value;
}

/* The next value of the row; in text, what is not wanted may be anything, and is 0. Most
 * binary ones are in the window, and cost no call. */
static inline double read_value(struct ply *ply, const struct type *type, bool is_wanted)
{
    struct ctl_file *file = ply->file;
    const char *at = file->at;
    if (ply->encoding == ASCII ||
        file->data + file->bytes - at < (ptrdiff_t)type->bytes) {
        return read_beyond(ply, type, is_wanted);
    }
    file->at = at + type->bytes;
    return decode(at, type, ply->encoding == HIGHEST_FIRST);
}

static uint32_t index_of(const struct ply *ply, double value)
{
    uint64_t count = ply->vertex->count;
    if (value >= 0 && value < (double)count && value == (double)(uint32_t)value) {
        return (uint32_t)value;
    }
    ctl_file_fail(ply->file, PCCD_E_INDEX,
                  "%.17g is not a vertex number (%" PRIu64 " %s there)", value, count,
                  proto_plural(count, "vertex is", "vertices are"));
    return 0;
}

/* ---- rows -------------------------------------------------------------------------- */

/* A polygon v0 v1 v2 v3 ... until it is cut. */
static void read_polygon(struct ply *ply, const struct type *type, uint64_t count,
                         uint64_t row)
{
    struct ctl_file *file = ply->file;
    if (count < 3) {
        ctl_file_refuse(file, "%" PRIu64 " %s where a face needs at least 3", count,
                        proto_plural(count, "vertex", "vertices"));
    }
    if (count == 3) { /* most are, and need no more */
        uint32_t corners[3];
        for (int k = 0; k < 3; k++) {
            corners[k] = index_of(ply, read_value(ply, type, true));
        }
        if (file->status == PCCD_OK) {
            file->status = ctl_mesh_add(ply->mesh, CTL_TRIANGLES, corners);
        }
        return;
    }
    for (uint64_t i = 0; i < count && file->status == PCCD_OK; i++) {
        uint32_t corner = index_of(ply, read_value(ply, type, true));
        if (file->status == PCCD_OK) {
            file->status = ctl_mesh_add_corner(ply->mesh, corner);
        }
    }
    if (file->status == PCCD_OK) {
        file->status = ctl_mesh_end_face(ply->mesh, row);
    }
}

/* The number that begins a new strip: -1, or what that is without a sign. */
static bool is_restart(double value, const struct type *type)
{
    return value == -1 ||
           (type->kind == UNSIGNED && type->bytes > 1 && value == (double)largest(type));
}

/* v0 v1 v2 v3 v4 is (v0 v1 v2) (v2 v1 v3) (v2 v3 v4); one that has a corner twice only
 * joins two others. */
static void read_strip(struct ply *ply, const struct type *type, uint64_t count)
{
    struct ctl_file *file = ply->file;
    uint32_t corners[3] = {0, 0, 0};
    uint64_t seen = 0; /* of this strip */
    for (uint64_t i = 0; i < count && file->status == PCCD_OK; i++) {
        double value = read_value(ply, type, true);
        if (is_restart(value, type)) {
            seen = 0;
            continue;
        }
        corners[seen < 2 ? seen : 2] = index_of(ply, value);
        if (++seen < 3) {
            continue;
        }
        bool is_odd = seen % 2 == 0;
        const uint32_t triangle[3] = {corners[is_odd], corners[!is_odd], corners[2]};
        bool joins = corners[0] == corners[1] || corners[1] == corners[2] ||
                     corners[2] == corners[0];
        if (!joins && file->status == PCCD_OK) {
            file->status = ctl_mesh_add(ply->mesh, CTL_TRIANGLES, triangle);
        }
        corners[0] = corners[1];
        corners[1] = corners[2];
    }
}

static void read_list(struct ply *ply, const struct property *property,
                      const struct element *element, double count)
{
    struct ctl_file *file = ply->file;
    /* Each item takes a byte at least, so the file's size bounds the count. */
    if (!(count >= 0 && count <= (double)ctl_file_size(file)) || count != floor(count)) {
        ctl_file_refuse(file, "%.17g is not a possible list length", count);
    } else if (property->role != INDICES) {
        for (double i = 0; i < count && file->status == PCCD_OK; i++) {
            read_value(ply, property->type, false);
        }
    } else if (element->are_strips) {
        read_strip(ply, property->type, (uint64_t)count);
    } else {
        read_polygon(ply, property->type, (uint64_t)count,
                     element->row_first + file->item_number);
    }
}

/* Ascii: rows are lines; blank lines between them are let pass. */
static void begin_line(struct ply *ply)
{
    struct ctl_word rest = {NULL, NULL}, word;
    bool has_word = false;
    while (!has_word && ctl_file_line(ply->file, &ply->line)) {
        rest = ply->line;
        has_word = ctl_word_next(&rest, &word);
    }
    if (!has_word) {
        ctl_file_refuse(ply->file, "the file ends here");
    }
    /* Of a row whose first line has one value more lines may follow. */
    ply->has_value_a_line = !ctl_word_next(&rest, &word);
}

static void read_row(struct ply *ply, const struct element *element)
{
    struct ctl_file *file = ply->file;
    struct ctl_word surplus;
    uint32_t ends[2] = {0, 0};
    if (ply->encoding == ASCII) {
        begin_line(ply);
    }
    ctl_mesh_begin_row(ply->mesh, element->row_first + file->item_number,
                       element->faces != NULL ? ply->face_count : element->count);
    for (uint32_t i = 0; i < element->property_count && file->status == PCCD_OK; i++) {
        const struct property *property = &ply->properties[element->property_first + i];
        enum role role = property->role;
        if (property->count_type != NULL) {
            read_list(ply, property, element,
                      read_value(ply, property->count_type, true));
            continue;
        }
        double value = read_value(ply, property->type, role != SKIP);
        if (role == END_0 || role == END_1) {
            ends[role - END_0] = index_of(ply, value);
        } else if (role <= AXIS_Z && !common_is_coordinate(value)) {
            ctl_file_fail(file, PCCD_E_NOTFINITE,
                          "coordinate %c is %g; |x| <= 1e18 is needed", "xyz"[role],
                          value);
        } else if (role <= AXIS_Z) {
            ctl_mesh_set(ply->mesh, (size_t)file->item_number * 3 + (size_t)role, value);
        }
    }
    bool has_line = ply->encoding == ASCII && file->status == PCCD_OK;
    if (has_line && ctl_word_next(&ply->line, &surplus)) {
        ctl_file_refuse(file, "\"%.*s\" is too much on the line", CTL_QUOTE(surplus));
    }
    if (element == ply->edge && file->status == PCCD_OK) {
        file->status = ctl_mesh_add(ply->mesh, CTL_EDGES, ends);
    }
}

/* Bytes after the last row mean that the counts do not fit the data. */
static void check_end(const struct ply *ply)
{
    struct ctl_file *file = ply->file;
    struct ctl_word line, word;
    while (ply->encoding == ASCII && ctl_file_line(file, &line)) {
        if (ctl_word_next(&line, &word)) {
            ctl_file_refuse(file, "\"%.*s\" after the last element", CTL_QUOTE(word));
        }
    }
    /* Some writers end binary data with a line end. */
    bool is_pair = ctl_file_more(file, 2) && memcmp(file->at, "\r\n", 2) == 0;
    bool is_end = ctl_file_more(file, 1) && (file->at[0] == '\n' || file->at[0] == '\r');
    uint64_t left = ctl_file_left(file);
    if (left > (is_pair ? 2 : is_end)) {
        ctl_file_refuse(file, "%" PRIu64 " %s after the last element", left,
                        proto_plural(left, "byte", "bytes"));
    }
}

int ctl_ply_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct ply ply = {.file = file, .mesh = mesh};
    if (read_header(&ply) != PCCD_OK) {
        return file->status;
    }
    file->status = ctl_mesh_alloc_vertices(
        mesh, ply.is_wide ? PCCD_FORMAT_F64 : PCCD_FORMAT_F32, ply.vertex->count);
    if (ply.encoding == ASCII) {
        ctl_file_expect_text(file);
    } else {
        file->line = 0;
    }
    for (uint32_t i = 0; i < ply.element_count && file->status == PCCD_OK; i++) {
        const struct element *element = &ply.elements[i];
        file->item = element->name;
        file->item_number = 0;
        while (file->item_number < element->count && file->status == PCCD_OK) {
            read_row(&ply, element);
            file->item_number++;
        }
    }
    file->item = NULL;
    check_end(&ply);
    uint32_t points = ply.is_cloud ? mesh->part.vertex_total : 0;
    for (uint32_t v = 0; v < points && file->status == PCCD_OK; v++) {
        ctl_mesh_begin_row(mesh, v, points);
        file->status = ctl_mesh_add(mesh, CTL_POINTS, &v);
    }
    return file->status;
}
