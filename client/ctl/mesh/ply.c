/* client/ctl/mesh/ply.c - the body of a PLY file.
 *
 * Room:     client/ctl.
 * Does:     reads vertices, faces and edges, ascii and binary of both byte orders, with
 *           values of any type; skips everything else; turns vertices into points
 *           where there is nothing else.
 * Does not: trust a count: each value is checked against the end of the file.
 * Threads:  [any]; nothing is shared.
 * Source:   "The PLY Polygon File Format" (Turk 1994).
 */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "meshfile.h"
#include "plural.h"
#include "ply_header.h"

struct body_reader {
    const struct ctl_file *file;
    const struct ply_header *header;
    struct ctl_mesh *mesh;
    struct ctl_error *error;
    struct ctl_text text;  /* ascii: where the next row begins; binary: next byte */
    struct ctl_word line;  /* ascii: what is left of this row */
    bool has_value_a_line; /* ascii: the row goes on in the next lines */
    const struct ply_element *element; /* being read, for messages */
    uint64_t row;                      /* of the element, from 0 */
    uint32_t ends[2];                  /* of the edge in that row */
};

/* Where the next one is. */
static uint64_t byte_of(const struct body_reader *reader)
{
    return reader->file->offset + (uint64_t)(reader->text.at - reader->file->data);
}

/* The place, the element's row, and what was wrong. */
static int fail(struct body_reader *reader, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static int fail(struct body_reader *reader, int status, const char *format, ...)
{
    char what[256];
    char where[64];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    if (reader->header->encoding == PLY_ASCII) {
        snprintf(where, sizeof where, ":%" PRIu64, reader->text.line);
    } else {
        snprintf(where, sizeof where, ": byte %" PRIu64, byte_of(reader));
    }
    return ctl_error_set(reader->error, status, "%s%s: %.*s %" PRIu64 ": %s",
                         reader->file->path, where,
                         ctl_word_length(&reader->element->name),
                         reader->element->name.at, reader->row, what);
}

/* The value of `bytes` bytes at `at` as unsigned bits. */
static uint64_t load_bits(const char *at, size_t bytes, enum ply_encoding encoding)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < bytes; i++) {
        size_t from = encoding == PLY_BIG_ENDIAN ? i : bytes - 1 - i;
        bits = bits << 8 | (unsigned char)at[from];
    }
    return bits;
}

/* Values of all types are exact in a double but the largest of 64 bits, which are no
 * indices. */
static double decode(uint64_t bits, enum ply_type type)
{
    uint32_t low = (uint32_t)bits;
    float narrow;
    double wide;
    switch (type) {
    case PLY_INT8:
        return (double)(int8_t)low;
    case PLY_INT16:
        return (double)(int16_t)low;
    case PLY_INT32:
        return (double)(int32_t)low;
    case PLY_INT64:
        return (double)(int64_t)bits;
    case PLY_UINT64:
        return (double)bits;
    case PLY_UINT8:
    case PLY_UINT16:
    case PLY_UINT32:
        return (double)low;
    case PLY_FLOAT32:
        memcpy(&narrow, &low, sizeof narrow);
        return (double)narrow;
    case PLY_FLOAT64:
        memcpy(&wide, &bits, sizeof wide);
        return wide;
    case PLY_TYPE_COUNT:
        break;
    }
    abort();
}

static int read_binary(struct body_reader *reader, enum ply_type type, double *value)
{
    size_t bytes = ctl_ply_type_bytes(type);
    if (!ctl_text_more(&reader->text, bytes)) {
        return fail(reader, PCCD_E_FORMAT, "the file ends here");
    }
    *value = decode(load_bits(reader->text.at, bytes, reader->header->encoding), type);
    reader->text.at += bytes;
    return PCCD_OK;
}

/* Of a row whose first line has one value more lines may follow. */
static int next_word(struct body_reader *reader, struct ctl_word *word)
{
    bool is_there = ctl_word_next(&reader->line, word);
    while (!is_there && reader->has_value_a_line &&
           ctl_text_line(&reader->text, &reader->line)) {
        is_there = ctl_word_next(&reader->line, word);
    }
    if (!is_there) {
        return fail(reader, PCCD_E_FORMAT, "a value is missing at the end of the line");
    }
    return PCCD_OK;
}

static int read_ascii(struct body_reader *reader, enum ply_type type, double *value)
{
    struct ctl_word word;
    int64_t whole;
    bool is_number;
    int status = next_word(reader, &word);
    if (status != PCCD_OK) {
        return status;
    }
    if (ctl_ply_type_is_whole(type)) {
        is_number = ctl_word_integer(&word, &whole) &&
                    (ctl_ply_type_bytes(type) == 8 ||
                     (whole >= INT32_MIN && whole <= (int64_t)UINT32_MAX));
        if (is_number) {
            *value = (double)whole;
        }
    } else if (type == PLY_FLOAT32) {
        is_number = ctl_word_float(&word, value);
    } else {
        is_number = ctl_word_double(&word, value);
    }
    if (!is_number) {
        return fail(reader, PCCD_E_FORMAT, "\"%.*s\" is not a%s number",
                    ctl_word_length(&word), word.at,
                    ctl_ply_type_is_whole(type) ? " whole" : "");
    }
    return PCCD_OK;
}

static int read_value(struct body_reader *reader, enum ply_type type, double *value)
{
    if (reader->header->encoding == PLY_ASCII) {
        return read_ascii(reader, type, value);
    }
    return read_binary(reader, type, value);
}

static int skip_value(struct body_reader *reader, enum ply_type type)
{
    struct ctl_word word;
    double value;
    if (reader->header->encoding == PLY_ASCII) {
        return next_word(reader, &word);
    }
    return read_binary(reader, type, &value);
}

static int read_coordinate(struct body_reader *reader,
                           const struct ply_property *property)
{
    double value;
    int status = read_value(reader, property->type, &value);
    if (status != PCCD_OK) {
        return status;
    }
    if (!common_is_coordinate(value)) {
        return fail(reader, PCCD_E_NOTFINITE,
                    "coordinate %c is %g; |x| <= 1e18 is needed", "xyz"[property->role],
                    value);
    }
    ctl_mesh_set(reader->mesh, (size_t)reader->row * 3 + (size_t)property->role, value);
    return PCCD_OK;
}

static int take_index(struct body_reader *reader, double value, uint32_t *index)
{
    if (!(value >= 0 && value < (double)reader->header->vertex_count) ||
        value != floor(value)) {
        return fail(
            reader, PCCD_E_INDEX, "%.17g is not a vertex number (%" PRIu64 " %s there)",
            value, reader->header->vertex_count,
            proto_plural(reader->header->vertex_count, "vertex is", "vertices are"));
    }
    *index = (uint32_t)value;
    return PCCD_OK;
}

static int read_index(struct body_reader *reader, const struct ply_property *property,
                      uint32_t *index)
{
    double value;
    int status = read_value(reader, property->type, &value);
    return status == PCCD_OK ? take_index(reader, value, index) : status;
}

/* The number that begins a new strip: -1, or what that is without a sign. */
static bool is_restart(double value, enum ply_type type)
{
    return value == -1 || (type == PLY_UINT32 && value == (double)UINT32_MAX) ||
           (type == PLY_UINT16 && value == UINT16_MAX) ||
           (type == PLY_UINT64 && value == 0x1p64);
}

/* v0 v1 v2 v3 v4 is (v0 v1 v2) (v2 v1 v3) (v2 v3 v4); one that has a corner twice only
 * joins two others. */
static int read_strip(struct body_reader *reader, const struct ply_property *property,
                      uint64_t count)
{
    uint32_t corners[3] = {0, 0, 0};
    uint64_t seen = 0; /* of this strip */
    for (uint64_t i = 0; i < count; i++) {
        double value;
        int status = read_value(reader, property->type, &value);
        if (status == PCCD_OK && is_restart(value, property->type)) {
            seen = 0;
            continue;
        }
        if (status == PCCD_OK) {
            status = take_index(reader, value, &corners[seen < 2 ? seen : 2]);
        }
        if (status == PCCD_OK && ++seen >= 3) {
            bool is_odd = seen % 2 == 0;
            const uint32_t triangle[3] = {corners[is_odd], corners[!is_odd], corners[2]};
            bool joins = corners[0] == corners[1] || corners[1] == corners[2] ||
                         corners[2] == corners[0];
            status =
                joins ? PCCD_OK : ctl_mesh_add(reader->mesh, CTL_TRIANGLES, triangle);
            corners[0] = corners[1];
            corners[1] = corners[2];
        }
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

static int read_polygon(struct body_reader *reader, const struct ply_property *property,
                        uint64_t count)
{
    if (count < 3) {
        return fail(reader, PCCD_E_FORMAT, "%" PRIu64 " %s where a face needs at least 3",
                    count, proto_plural(count, "vertex", "vertices"));
    }
    for (uint64_t i = 0; i < count; i++) {
        uint32_t corner;
        int status = read_index(reader, property, &corner);
        if (status == PCCD_OK) {
            status = ctl_mesh_add_corner(reader->mesh, corner);
        }
        if (status != PCCD_OK) {
            return status;
        }
    }
    return ctl_mesh_end_face(reader->mesh, reader->element->row_first + reader->row);
}

static int read_list(struct body_reader *reader, const struct ply_property *property)
{
    double value;
    int status = read_value(reader, property->count_type, &value);
    if (status != PCCD_OK) {
        return status;
    }
    /* Each item takes a byte at least, so the file's size bounds the count. */
    const struct ctl_file *file = reader->file;
    uint64_t bytes = file->offset + file->bytes + file->rest_bytes;
    if (!(value >= 0 && value <= (double)bytes) || value != floor(value)) {
        return fail(reader, PCCD_E_FORMAT, "%.17g is not a possible list length", value);
    }
    uint64_t count = (uint64_t)value;
    if (property->role == PLY_INDICES) {
        return reader->element->are_strips ? read_strip(reader, property, count)
                                           : read_polygon(reader, property, count);
    }
    for (uint64_t i = 0; i < count && status == PCCD_OK; i++) {
        status = skip_value(reader, property->type);
    }
    return status;
}

/* Ascii: rows are lines; blank lines between them are let pass. */
static int begin_row(struct body_reader *reader)
{
    struct ctl_word rest, word;
    do {
        if (!ctl_text_line(&reader->text, &reader->line)) {
            return fail(reader, PCCD_E_FORMAT, "the file ends here");
        }
        rest = reader->line;
    } while (!ctl_word_next(&rest, &word));
    reader->has_value_a_line = !ctl_word_next(&rest, &word);
    return PCCD_OK;
}

static int read_row(struct body_reader *reader)
{
    bool is_ascii = reader->header->encoding == PLY_ASCII;
    bool is_edge = false;
    struct ctl_word surplus;
    int status = is_ascii ? begin_row(reader) : PCCD_OK;
    if (reader->element->has_faces) {
        ctl_mesh_begin_row(reader->mesh, reader->element->row_first + reader->row,
                           reader->header->face_count);
    } else {
        ctl_mesh_begin_row(reader->mesh, reader->row, reader->element->count);
    }
    for (uint32_t i = 0; i < reader->element->property_count && status == PCCD_OK; i++) {
        const struct ply_property *property =
            &reader->header->properties[reader->element->property_first + i];
        if (property->is_list) {
            status = read_list(reader, property);
        } else if (property->role == PLY_SKIP) {
            status = skip_value(reader, property->type);
        } else if (property->role == PLY_END0 || property->role == PLY_END1) {
            status =
                read_index(reader, property, &reader->ends[property->role - PLY_END0]);
            is_edge = true;
        } else {
            status = read_coordinate(reader, property);
        }
    }
    if (status == PCCD_OK && is_ascii && ctl_word_next(&reader->line, &surplus)) {
        return fail(reader, PCCD_E_FORMAT, "\"%.*s\" is too much on the line",
                    ctl_word_length(&surplus), surplus.at);
    }
    return status == PCCD_OK && is_edge
               ? ctl_mesh_add(reader->mesh, CTL_EDGES, reader->ends)
               : status;
}

/* Bytes after the last row mean that the counts do not fit the data. */
static int check_end(struct body_reader *reader)
{
    struct ctl_word line, word;
    if (reader->header->encoding != PLY_ASCII) {
        if (!ctl_text_more(&reader->text, 1)) {
            return PCCD_OK;
        }
        /* Some writers end the data with a line end. */
        bool is_pair = reader->text.at[0] == '\r' && ctl_text_more(&reader->text, 2) &&
                       reader->text.at[1] == '\n';
        size_t end_bytes = is_pair ? 2 : 1;
        if ((reader->text.at[0] == '\n' || reader->text.at[0] == '\r') &&
            !ctl_text_more(&reader->text, end_bytes + 1)) {
            return PCCD_OK;
        }
        uint64_t left =
            (uint64_t)(reader->text.end - reader->text.at) + reader->file->rest_bytes;
        return ctl_error_set(reader->error, PCCD_E_FORMAT,
                             "%s: byte %" PRIu64 ": %" PRIu64
                             " %s after the last element",
                             reader->file->path, byte_of(reader), left,
                             proto_plural(left, "byte", "bytes"));
    }
    while (ctl_text_line(&reader->text, &line)) {
        if (ctl_word_next(&line, &word)) {
            return ctl_error_set(reader->error, PCCD_E_FORMAT,
                                 "%s:%" PRIu64 ": \"%.*s\" after the last element",
                                 reader->file->path, reader->text.line,
                                 ctl_word_length(&word), word.at);
        }
    }
    return PCCD_OK;
}

int ctl_ply_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct ply_header *header = malloc(sizeof *header);
    struct body_reader reader = {
        .file = file,
        .header = header,
        .mesh = mesh,
        .error = mesh->error,
        .text = ctl_text_begin(file),
    };
    if (header == NULL) {
        return ctl_error_set(mesh->error, PCCD_E_NOMEM, "%s: no memory for the header",
                             file->path);
    }
    int status = ctl_ply_header(file, &reader.text, header, mesh->error);
    if (status == PCCD_OK) {
        status = ctl_mesh_alloc_vertices(
            mesh, header->is_narrow ? PCCD_FORMAT_F32 : PCCD_FORMAT_F64,
            header->vertex_count);
    }
    for (uint32_t i = 0; i < header->element_count && status == PCCD_OK; i++) {
        reader.element = &header->elements[i];
        for (reader.row = 0; reader.row < reader.element->count && status == PCCD_OK;
             reader.row++) {
            status = read_row(&reader);
        }
    }
    if (status == PCCD_OK) {
        status = check_end(&reader);
    }
    bool is_cloud = header->face_count + header->edge_count == 0;
    uint32_t vertices = status == PCCD_OK && is_cloud ? mesh->part.vertex_total : 0;
    for (uint32_t v = 0; status == PCCD_OK && v < vertices; v++) {
        ctl_mesh_begin_row(mesh, v, vertices);
        status = ctl_mesh_add(mesh, CTL_POINTS, &v);
    }
    free(header);
    return status;
}

int ctl_ply_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    struct ctl_text text = {
        .at = ctl_file_start(begin), .end = begin->data + begin->bytes, .line = 0};
    struct ply_header *header = malloc(sizeof *header);
    if (header == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for the header",
                             begin->path);
    }
    int status = ctl_ply_header(begin, &text, header, error);
    *is_text = status == PCCD_OK && header->encoding == PLY_ASCII;
    free(header);
    return status;
}
