/* client/ctl/mesh/ply_header.c - what a PLY file says about itself.
 *
 * Room:     client/ctl.
 * Does:     reads the header line by line, then checks it as a whole.
 * Does not: read the body (see ply.c).
 * Threads:  [any]; nothing is shared.
 * Source:   ply_header.h.
 */
#include "ply_header.h"

#include <string.h>

#include "meshfile.h"

static const struct {
    const char *name;
    const char *alias;
    size_t bytes;
    bool is_whole;
    bool is_narrow;
} types[PLY_TYPE_COUNT] = {
#define PLY_TYPE_ROW(id, name, alias, bytes, whole, narrow)                              \
    {name, alias, bytes, whole, narrow},
    PLY_TYPES(PLY_TYPE_ROW)
#undef PLY_TYPE_ROW
};

/* The state of reading, so that messages know the place. */
struct header_reader {
    const struct ctl_file *file;
    struct ctl_text *text;
    struct ply_header *header;
    struct ctl_error *error;
};

/* "FILE:LINE: " before a message about the line at hand. */
#define FAIL(reader, status, format, ...)                                                \
    ctl_error_set((reader)->error, status, "%s:%llu: " format, (reader)->file->path,     \
                  (unsigned long long)(reader)->text->line, __VA_ARGS__)

size_t ctl_ply_type_bytes(enum ply_type type)
{
    return types[type].bytes;
}

bool ctl_ply_type_is_whole(enum ply_type type)
{
    return types[type].is_whole;
}

static int read_type(struct header_reader *reader, struct ctl_word *line,
                     enum ply_type *type)
{
    struct ctl_word word;
    if (!ctl_word_next(line, &word)) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "property without a type");
    }
    for (uint32_t i = 0; i < PLY_TYPE_COUNT; i++) {
        if (ctl_word_is(&word, types[i].name) || ctl_word_is(&word, types[i].alias)) {
            *type = (enum ply_type)i;
            return PCCD_OK;
        }
    }
    return FAIL(reader, PCCD_E_FORMAT, "unknown type \"%.*s\"", ctl_word_length(&word),
                word.at);
}

static int read_format(struct header_reader *reader, struct ctl_word *line)
{
    struct ctl_word word, version;
    if (reader->header->encoding != PLY_NONE) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "a second format line");
    }
    if (!ctl_word_next(line, &word) || !ctl_word_next(line, &version)) {
        return FAIL(reader, PCCD_E_FORMAT, "%s",
                    "format without an encoding and a version");
    }
    if (ctl_word_is(&word, "ascii")) {
        reader->header->encoding = PLY_ASCII;
    } else if (ctl_word_is(&word, "binary_little_endian")) {
        reader->header->encoding = PLY_LITTLE_ENDIAN;
    } else if (ctl_word_is(&word, "binary_big_endian")) {
        reader->header->encoding = PLY_BIG_ENDIAN;
    } else {
        return FAIL(reader, PCCD_E_FORMAT, "unknown encoding \"%.*s\"",
                    ctl_word_length(&word), word.at);
    }
    if (!ctl_word_is(&version, "1.0")) {
        return FAIL(reader, PCCD_E_FORMAT, "version \"%.*s\" where 1.0 is known",
                    ctl_word_length(&version), version.at);
    }
    return PCCD_OK;
}

static int read_element(struct header_reader *reader, struct ctl_word *line)
{
    struct ply_header *header = reader->header;
    struct ctl_word name, count_word;
    int64_t count;
    if (!ctl_word_next(line, &name) || !ctl_word_next(line, &count_word)) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "element without a name and a count");
    }
    if (!ctl_word_integer(&count_word, &count) || count < 0) {
        return FAIL(reader, PCCD_E_FORMAT, "\"%.*s\" is not a count",
                    ctl_word_length(&count_word), count_word.at);
    }
    if (header->element_count == PLY_ELEMENTS_MAX) {
        return FAIL(reader, PCCD_E_LIMIT, "more than %d elements", PLY_ELEMENTS_MAX);
    }
    header->elements[header->element_count++] =
        (struct ply_element){.name = name,
                             .count = (uint64_t)count,
                             .property_first = header->property_count,
                             .property_count = 0};
    return PCCD_OK;
}

static int read_property(struct header_reader *reader, struct ctl_word *line)
{
    struct ply_header *header = reader->header;
    struct ply_property property = {.count_type = PLY_UINT8, .role = PLY_SKIP};
    struct ctl_word rest = *line;
    struct ctl_word word;
    int status = PCCD_OK;
    if (header->element_count == 0) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "property before any element");
    }
    if (header->property_count == PLY_PROPERTIES_MAX) {
        return FAIL(reader, PCCD_E_LIMIT, "more than %d properties", PLY_PROPERTIES_MAX);
    }
    if (ctl_word_next(&rest, &word) && ctl_word_is(&word, "list")) {
        property.is_list = true;
        *line = rest;
        status = read_type(reader, line, &property.count_type);
    }
    if (status == PCCD_OK) {
        status = read_type(reader, line, &property.type);
    }
    if (status != PCCD_OK) {
        return status;
    }
    if (!ctl_word_next(line, &property.name)) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "property without a name");
    }
    header->properties[header->property_count++] = property;
    header->elements[header->element_count - 1].property_count++;
    return PCCD_OK;
}

/* One line after the first; *is_end is set by "end_header". */
static int read_line(struct header_reader *reader, struct ctl_word *line, bool *is_end)
{
    struct ctl_word word;
    struct ctl_word surplus;
    int status;
    if (!ctl_word_next(line, &word)) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "blank line in the header");
    }
    if (ctl_word_is(&word, "comment") || ctl_word_is(&word, "obj_info")) {
        return PCCD_OK;
    }
    if (ctl_word_is(&word, "end_header")) {
        *is_end = true;
        status = PCCD_OK;
    } else if (ctl_word_is(&word, "format")) {
        status = read_format(reader, line);
    } else if (ctl_word_is(&word, "element")) {
        status = read_element(reader, line);
    } else if (ctl_word_is(&word, "property")) {
        status = read_property(reader, line);
    } else {
        return FAIL(reader, PCCD_E_FORMAT, "unknown header line \"%.*s\"",
                    ctl_word_length(&word), word.at);
    }
    if (status == PCCD_OK && ctl_word_next(line, &surplus)) {
        return FAIL(reader, PCCD_E_FORMAT, "\"%.*s\" is too much on a header line",
                    ctl_word_length(&surplus), surplus.at);
    }
    return status;
}

/* The only element of that name; NULL: there is none. */
static int find_element(struct header_reader *reader, const char *name,
                        struct ply_element **found)
{
    struct ply_element *element = NULL;
    for (uint32_t i = 0; i < reader->header->element_count; i++) {
        if (!ctl_word_is(&reader->header->elements[i].name, name)) {
            continue;
        }
        if (element != NULL) {
            return FAIL(reader, PCCD_E_FORMAT, "two elements \"%s\"", name);
        }
        element = &reader->header->elements[i];
    }
    *found = element;
    return PCCD_OK;
}

/* Give x, y and z of the vertex element their roles. */
static int find_axes(struct header_reader *reader, const struct ply_element *element)
{
    static const char *const axes[3] = {"x", "y", "z"};
    struct ply_property *properties =
        reader->header->properties + element->property_first;
    reader->header->is_narrow = true;
    for (uint32_t axis = 0; axis < 3; axis++) {
        struct ply_property *found = NULL;
        for (uint32_t i = 0; i < element->property_count && found == NULL; i++) {
            if (ctl_word_is(&properties[i].name, axes[axis])) {
                found = &properties[i];
            }
        }
        if (found == NULL) {
            return FAIL(reader, PCCD_E_FORMAT,
                        "element \"vertex\" has no property \"%s\"", axes[axis]);
        }
        if (found->is_list) {
            return FAIL(reader, PCCD_E_FORMAT, "property \"%s\" of \"vertex\" is a list",
                        axes[axis]);
        }
        found->role = (enum ply_role)axis;
        reader->header->is_narrow &= types[found->type].is_narrow;
    }
    return PCCD_OK;
}

static uint64_t sum(uint64_t a, uint64_t b)
{
    uint64_t both;
    return __builtin_add_overflow(a, b, &both) ? UINT64_MAX : both;
}

static bool is_any_of(const struct ctl_word *word, const char *const *names, size_t count)
{
    bool is_one = false;
    for (size_t i = 0; i < count; i++) {
        is_one = is_one || ctl_word_is_any_case(word, names[i]);
    }
    return is_one;
}

/* The first list of an element that has the name of indices, or, where any_list is set,
 * that may have them; NULL: there is none. */
static struct ply_property *find_list(struct header_reader *reader,
                                      const struct ply_element *element, bool any_list)
{
    static const char *const names[] = {"vertex_indices", "vertex_index",
                                        "vertex_indexes", "vertices", "indices"};
    struct ply_property *properties =
        reader->header->properties + element->property_first;
    for (uint32_t i = 0; i < element->property_count; i++) {
        if (properties[i].is_list && types[properties[i].type].is_whole &&
            (any_list || is_any_of(&properties[i].name, names, 5))) {
            return &properties[i];
        }
        if (properties[i].is_list && is_any_of(&properties[i].name, names, 2)) {
            return &properties[i]; /* whole numbers may be written as others */
        }
    }
    return NULL;
}

/* Faces are in the element "face", and in any other that has a list of indices; strips in
 * those whose names say so. */
static int find_faces(struct header_reader *reader, const struct ply_element *vertex)
{
    static const char *const strips[] = {"tristrips",      "tristrip", "triangle_strips",
                                         "triangle_strip", "strips",   "strip"};
    struct ply_header *header = reader->header;
    for (uint32_t i = 0; i < header->element_count; i++) {
        struct ply_element *element = &header->elements[i];
        struct ply_property *list =
            element != vertex ? find_list(reader, element, false) : NULL;
        if (list == NULL && ctl_word_is(&element->name, "face")) {
            return FAIL(reader, PCCD_E_FORMAT, "%s",
                        "element \"face\" has no list \"vertex_indices\" or "
                        "\"vertex_index\"");
        }
        if (list != NULL) {
            list->role = PLY_INDICES;
            element->has_faces = true;
            element->are_strips = is_any_of(&element->name, strips, 6);
            element->row_first = header->face_count;
            header->face_count = sum(header->face_count, element->count);
        }
    }
    return PCCD_OK;
}

/* Vertices are points only where nothing that may be faces is left out. */
static int check_cloud(struct header_reader *reader, const struct ply_element *vertex)
{
    struct ply_header *header = reader->header;
    for (uint32_t i = 0; i < header->element_count; i++) {
        struct ply_element *element = &header->elements[i];
        if (element == vertex || element->count == 0) {
            continue;
        }
        const struct ply_property *list = find_list(reader, element, true);
        if (list != NULL) {
            return FAIL(reader, PCCD_E_FORMAT,
                        "element \"%.*s\" may have the faces: its list \"%.*s\" is none "
                        "that is known, such as \"vertex_indices\"",
                        ctl_word_length(&element->name), element->name.at,
                        ctl_word_length(&list->name), list->name.at);
        }
    }
    return PCCD_OK;
}

/* The ends of edges. */
static int find_ends(struct header_reader *reader, const struct ply_element *element)
{
    static const char *const ends[2] = {"vertex1", "vertex2"};
    struct ply_property *properties =
        reader->header->properties + element->property_first;
    for (uint32_t end = 0; end < 2; end++) {
        uint32_t i = 0;
        while (i < element->property_count &&
               (properties[i].is_list || !ctl_word_is(&properties[i].name, ends[end]))) {
            i++;
        }
        if (i == element->property_count) {
            return FAIL(reader, PCCD_E_FORMAT, "element \"edge\" has no property \"%s\"",
                        ends[end]);
        }
        properties[i].role = (enum ply_role)(PLY_END0 + end);
    }
    return PCCD_OK;
}

/* Fewest and most bytes that one row of the element can take. */
struct row_bytes {
    uint64_t least, most;
};

static uint64_t product(uint64_t a, uint64_t b)
{
    uint64_t both;
    return __builtin_mul_overflow(a, b, &both) ? UINT64_MAX : both;
}

/* Items of the longest list; what is no whole number is as large as can be. */
static uint64_t list_length_max(enum ply_type count)
{
    bool has_sign = count == PLY_INT8 || count == PLY_INT16 || count == PLY_INT32;
    if (types[count].bytes == 8) {
        return UINT64_MAX;
    }
    return types[count].is_whole
               ? ((uint64_t)1 << (8 * types[count].bytes - has_sign)) - 1
               : UINT64_MAX;
}

static struct row_bytes row_bytes_of(const struct ply_header *header,
                                     const struct ply_element *element)
{
    struct row_bytes row = {0, 0};
    for (uint32_t i = 0; i < element->property_count; i++) {
        const struct ply_property *property =
            &header->properties[element->property_first + i];
        if (header->encoding == PLY_ASCII) {
            row.least += 2; /* a digit and what parts it from the next */
            row.most = UINT64_MAX;
        } else if (property->is_list) {
            uint64_t items = product(list_length_max(property->count_type),
                                     types[property->type].bytes);
            row.least += types[property->count_type].bytes;
            row.most = sum(row.most, sum(types[property->count_type].bytes, items));
        } else {
            row.least += types[property->type].bytes;
            row.most = sum(row.most, types[property->type].bytes);
        }
    }
    return row;
}

/* Refuse counts that do not go with the bytes after the header, before these are read and
 * before anything is allocated by them. */
static int check_counts(struct header_reader *reader)
{
    const struct ply_header *header = reader->header;
    uint64_t there =
        (uint64_t)(reader->text->end - reader->text->at) + reader->file->rest_bytes;
    uint64_t most = 0, left = there;
    for (uint32_t i = 0; i < header->element_count; i++) {
        const struct ply_element *element = &header->elements[i];
        struct row_bytes row = row_bytes_of(header, element);
        uint64_t needed = product(element->count, row.least);
        if (element->count == 0) {
            continue;
        }
        if (row.least == 0) {
            return FAIL(reader, PCCD_E_FORMAT, "element \"%.*s\" has no properties",
                        ctl_word_length(&element->name), element->name.at);
        }
        /* The last row of an ascii file may lack its line end. */
        if (needed > left + (header->encoding == PLY_ASCII)) {
            return FAIL(reader, PCCD_E_FORMAT,
                        "%llu rows of element \"%.*s\" take %llu bytes or more, and "
                        "%llu of the file are left",
                        (unsigned long long)element->count,
                        ctl_word_length(&element->name), element->name.at,
                        (unsigned long long)needed, (unsigned long long)left);
        }
        left -= needed < left ? needed : left;
        most = sum(most, product(element->count, row.most));
    }
    /* A line end may follow. */
    if (header->encoding != PLY_ASCII && there > sum(most, 2)) {
        return FAIL(reader, PCCD_E_FORMAT,
                    "the elements take at most %llu bytes, and the file has %llu more",
                    (unsigned long long)most, (unsigned long long)(there - most));
    }
    return PCCD_OK;
}

static int check_header(struct header_reader *reader)
{
    struct ply_element *vertex = NULL, *edge = NULL;
    if (reader->header->encoding == PLY_NONE) {
        return FAIL(reader, PCCD_E_FORMAT, "%s", "the header has no format line");
    }
    int status = find_element(reader, "vertex", &vertex);
    if (status == PCCD_OK && vertex == NULL) {
        status =
            FAIL(reader, PCCD_E_FORMAT, "%s", "the header has no element \"vertex\"");
    }
    if (status == PCCD_OK) {
        status = find_element(reader, "edge", &edge);
    }
    if (status == PCCD_OK) {
        status = find_axes(reader, vertex);
    }
    if (status == PCCD_OK) {
        status = find_faces(reader, vertex);
    }
    if (status == PCCD_OK && edge != NULL) {
        status = find_ends(reader, edge);
    }
    if (status == PCCD_OK) {
        status = check_counts(reader);
    }
    bool is_cloud = reader->header->face_count == 0 && (edge == NULL || edge->count == 0);
    if (status == PCCD_OK && is_cloud) {
        status = check_cloud(reader, vertex);
    }
    if (status != PCCD_OK) {
        return status;
    }
    reader->header->vertex_count = vertex->count;
    reader->header->edge_count = edge != NULL ? edge->count : 0;
    return PCCD_OK;
}

/* The text that they lie in does not stay. */
static void copy_names(struct ply_header *header)
{
    for (uint32_t i = 0; i < header->element_count; i++) {
        struct ctl_word *name = &header->elements[i].name;
        size_t bytes = (size_t)(name->end - name->at);
        bytes = bytes < PLY_NAME_BYTES ? bytes : PLY_NAME_BYTES;
        memcpy(header->names[i], name->at, bytes);
        *name = (struct ctl_word){header->names[i], header->names[i] + bytes};
    }
}

int ctl_ply_header(const struct ctl_file *file, struct ctl_text *text,
                   struct ply_header *header, struct ctl_error *error)
{
    struct header_reader reader = {file, text, header, error};
    struct ctl_word line, word;
    bool is_end = false;
    header->encoding = PLY_NONE;
    header->element_count = 0;
    header->property_count = 0;
    header->face_count = 0;
    if (!ctl_text_line(text, &line) || !ctl_word_next(&line, &word) ||
        !ctl_word_is(&word, "ply")) {
        return FAIL(&reader, PCCD_E_FORMAT, "%s", "the first line is not \"ply\"");
    }
    /* Where a CR alone ends lines, an LF behind the last one is data. */
    bool has_feeds = text->at[-1] == '\n';
    while (!is_end) {
        if (!ctl_text_line(text, &line)) {
            return FAIL(&reader, PCCD_E_FORMAT, "%s",
                        file->rest_bytes > 0 ? "the header does not end in the first MiB"
                                             : "the file ends inside the header");
        }
        int status = read_line(&reader, &line, &is_end);
        if (status != PCCD_OK) {
            return status;
        }
    }
    if (!has_feeds && header->encoding != PLY_ASCII && text->at[-1] == '\n') {
        text->at--;
    }
    int status = check_header(&reader);
    copy_names(header);
    return status;
}
