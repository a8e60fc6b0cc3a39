/* client/ctl/mesh/stl.c - STL files.
 *
 * Room:     client/ctl.
 * Does:     read binary and ascii STL. Each facet of the file has corners of its own;
 *           corners at exactly the same place become one vertex, numbered as they come,
 *           since a surface is of one piece only by its vertices.
 * Does not: read normals, colours or names of solids; join corners that are merely close.
 * Threads:  [any]; nothing is shared.
 * Source:   3D Systems, "StereoLithography Interface Specification" (1988).
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "meshfile.h"

#define HEADER_BYTES 84u /* 80 of any text, and the number of facets */
#define FACET_BYTES  50u /* a normal, three corners, and two bytes of anything */
#define FREE         UINT32_MAX
#define LOOK_BYTES   ((size_t)512) /* of a file that may be ascii */

struct stl_reader {
    struct ctl_file *file;
    struct ctl_mesh *mesh;
    struct ctl_error *error;
    struct ctl_text text;     /* of ascii */
    uint32_t vertex_capacity; /* of mesh->x */
    uint32_t *table;          /* [table_mask + 1]: vertices by their places; FREE: none */
    uint32_t table_mask;
    uint32_t corners[3];
};

static int no_memory(struct stl_reader *reader)
{
    return ctl_error_set(reader->error, PCCD_E_NOMEM, "%s: no memory for %u vertices",
                         reader->file->path, reader->mesh->vertex_count);
}

/* Where a place, or the first free entry after it, is in the table. */
static uint32_t *entry_of(const struct stl_reader *reader, const float place[3])
{
    const float(*x)[3] = reader->mesh->x;
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t bits;
        memcpy(&bits, &place[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    uint32_t at = (uint32_t)hash & reader->table_mask;
    while (reader->table[at] != FREE &&
           memcmp(x[reader->table[at]], place, sizeof *x) != 0) {
        at = (at + 1) & reader->table_mask;
    }
    return &reader->table[at];
}

/* Twice as many vertices, and a table that is at most half full with them. */
static int grow(struct stl_reader *reader)
{
    struct ctl_mesh *mesh = reader->mesh;
    uint64_t wanted =
        reader->vertex_capacity > 0 ? 2 * (uint64_t)reader->vertex_capacity : 1024;
    if (mesh->vertex_count == CTL_MESH_COUNT_MAX) {
        return ctl_error_set(reader->error, PCCD_E_LIMIT,
                             "%s: more than %" PRIu64 " vertices", reader->file->path,
                             CTL_MESH_COUNT_MAX);
    }
    wanted = wanted > CTL_MESH_COUNT_MAX ? CTL_MESH_COUNT_MAX : wanted;
    void *x = realloc(mesh->x, (size_t)wanted * sizeof(float[3]));
    if (x == NULL) {
        return no_memory(reader);
    }
    mesh->x = x;
    reader->vertex_capacity = (uint32_t)wanted;
    uint32_t entries = 2048;
    while (entries < 2 * wanted) {
        entries *= 2;
    }
    free(reader->table);
    reader->table = malloc(entries * sizeof *reader->table);
    if (reader->table == NULL) {
        return no_memory(reader);
    }
    memset(reader->table, 0xff, entries * sizeof *reader->table);
    reader->table_mask = entries - 1;
    for (uint32_t i = 0; i < mesh->vertex_count && !mesh->is_corners; i++) {
        *entry_of(reader, ((const float(*)[3])mesh->x)[i]) = i;
    }
    return PCCD_OK;
}

static int add_corner(struct stl_reader *reader, const float x[3], uint32_t *vertex)
{
    struct ctl_mesh *mesh = reader->mesh;
    float place[3];
    for (int k = 0; k < 3; k++) {
        place[k] = x[k] == 0 ? 0 : x[k]; /* 0 and -0 are one place */
    }
    if (mesh->vertex_count == reader->vertex_capacity) {
        int status = grow(reader);
        if (status != PCCD_OK) {
            return status;
        }
    }
    if (mesh->is_corners) {
        memcpy(((float(*)[3])mesh->x)[mesh->vertex_count], place, sizeof place);
        *vertex = mesh->vertex_count++;
        return PCCD_OK;
    }
    uint32_t *entry = entry_of(reader, place);
    if (*entry == FREE) {
        memcpy(((float(*)[3])mesh->x)[mesh->vertex_count], place, sizeof place);
        *entry = mesh->vertex_count++;
    }
    *vertex = *entry;
    return PCCD_OK;
}

/* ---- binary ------------------------------------------------------------------------ */

/* Whether a file of so many bytes is binary: its number of facets says how long it is.
 * The first line of ascii does not tell, since headers may begin with "solid", too. */
static bool is_binary(const char *data, size_t bytes, uint64_t all_bytes)
{
    return bytes >= HEADER_BYTES &&
           all_bytes == HEADER_BYTES + (uint64_t)ctl_file_word(data + 80) * FACET_BYTES;
}

/* Whether it begins with "solid", and has no byte 0 soon, as a binary file has. */
static bool is_ascii(const struct ctl_file *begin)
{
    const char *start = ctl_file_start(begin);
    size_t bytes = (size_t)(begin->data + begin->bytes - start);
    struct ctl_word text = {start, start + (bytes < LOOK_BYTES ? bytes : LOOK_BYTES)},
                    word;
    while (text.at < text.end && (*text.at == '\n' || *text.at == '\r')) {
        text.at++;
    }
    const char *stop = memchr(text.at, '\n', (size_t)(text.end - text.at));
    const char *other = memchr(text.at, '\r', (size_t)(text.end - text.at));
    bool has_zero = memchr(text.at, 0, (size_t)(text.end - text.at)) != NULL;
    text.end = stop != NULL ? stop : text.end;
    text.end = other != NULL && other < text.end ? other : text.end;
    return !has_zero && ctl_word_next(&text, &word) &&
           ctl_word_is_any_case(&word, "solid");
}

static int no_stl(const struct ctl_file *begin, struct ctl_error *error)
{
    uint64_t all_bytes = begin->offset + begin->bytes + begin->rest_bytes;
    if (begin->bytes < HEADER_BYTES) {
        return ctl_error_set(
            error, PCCD_E_FORMAT,
            "%s: no STL: it does not begin with \"solid\", and has %" PRIu64
            " bytes where a binary one has %u and more",
            begin->path, all_bytes, HEADER_BYTES);
    }
    uint64_t facets = (all_bytes - HEADER_BYTES) / FACET_BYTES;
    return ctl_error_set(
        error, PCCD_E_FORMAT,
        "%s: no STL: it does not begin with \"solid\", and its header tells of %" PRIu32
        " facets, where %" PRIu64 " bytes have %" PRIu64 " and %" PRIu64 " bytes more",
        begin->path, ctl_file_word(begin->data + 80), all_bytes, facets,
        (all_bytes - HEADER_BYTES) % FACET_BYTES);
}

static int read_binary(struct stl_reader *reader)
{
    const struct ctl_file *file = reader->file;
    uint32_t count = ctl_file_word(file->data + 80);
    int status = PCCD_OK;
    reader->text.at = file->data + HEADER_BYTES;
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        if (!ctl_text_more(&reader->text, FACET_BYTES)) {
            return ctl_error_set(reader->error, PCCD_E_FORMAT,
                                 "%s: facet %" PRIu32 " of %" PRIu32
                                 ": the file ends here",
                                 file->path, i, count);
        }
        const char *facet = reader->text.at;
        for (uint32_t k = 0; k < 3 && status == PCCD_OK; k++) {
            float x[3];
            for (uint32_t axis = 0; axis < 3; axis++) {
                uint32_t bits = ctl_file_word(facet + 12 * (k + 1) + 4 * axis);
                memcpy(&x[axis], &bits, sizeof bits);
                if (!common_is_coordinate((double)x[axis])) {
                    return ctl_error_set(reader->error, PCCD_E_NOTFINITE,
                                         "%s: facet %" PRIu32 ", corner %" PRIu32
                                         ": coordinate %c is %g; |x| <= 1e18 is needed",
                                         file->path, i, k, "xyz"[axis], (double)x[axis]);
                }
            }
            status = add_corner(reader, x, &reader->corners[k]);
        }
        if (status == PCCD_OK) {
            status = ctl_mesh_add(reader->mesh, CTL_TRIANGLES, reader->corners);
        }
        reader->text.at += FACET_BYTES;
    }
    return status;
}

/* ---- ascii ------------------------------------------------------------------------- */

/* The next line that is not blank, and its first word, of "end" the second one, too. */
static bool next_line(struct stl_reader *reader, struct ctl_word *line,
                      struct ctl_word *word)
{
    while (ctl_text_line(&reader->text, line)) {
        if (ctl_word_next(line, word)) {
            return true;
        }
    }
    return false;
}

/* "endfacet", or "end facet". */
static bool is_end(const struct ctl_word *word, struct ctl_word line, const char *what)
{
    struct ctl_word second, rest = {word->at + 3, word->end};
    bool is_split = ctl_word_is_any_case(word, "end") && ctl_word_next(&line, &second);
    struct ctl_word begin = {word->at,
                             word->end - word->at > 3 ? word->at + 3 : word->end};
    return is_split ? ctl_word_is_any_case(&second, what)
                    : ctl_word_is_any_case(&begin, "end") && rest.end > rest.at &&
                          ctl_word_is_any_case(&rest, what);
}

static int unexpected(struct stl_reader *reader, const char *wanted,
                      const struct ctl_word *word)
{
    return ctl_error_set(
        reader->error, PCCD_E_FORMAT, "%s:%" PRIu64 ": \"%.*s\" where \"%s\" is needed",
        reader->file->path, reader->text.line, ctl_word_length(word), word->at, wanted);
}

/* A line that begins so, or with "end" and so. */
static int expect(struct stl_reader *reader, const char *wanted, struct ctl_word *line)
{
    struct ctl_word word;
    bool is_of_end = strncmp(wanted, "end", 3) == 0;
    if (!next_line(reader, line, &word)) {
        return ctl_error_set(reader->error, PCCD_E_FORMAT,
                             "%s: it ends where \"%s\" is needed", reader->file->path,
                             wanted);
    }
    bool is_it = is_of_end ? is_end(&word, *line, wanted + 3)
                           : ctl_word_is_any_case(&word, wanted);
    return is_it ? PCCD_OK : unexpected(reader, wanted, &word);
}

static int read_corner(struct stl_reader *reader, uint32_t *vertex)
{
    struct ctl_word line;
    float x[3];
    int status = expect(reader, "vertex", &line);
    if (status != PCCD_OK) {
        return status;
    }
    for (int axis = 0; axis < 3; axis++) {
        struct ctl_word word = {line.end, line.end};
        double value;
        if (!ctl_word_next(&line, &word) || !ctl_word_float(&word, &value)) {
            return unexpected(reader, "three numbers", &word);
        }
        if (!common_is_coordinate(value)) {
            return ctl_error_set(
                reader->error, PCCD_E_NOTFINITE,
                "%s:%" PRIu64 ": coordinate %c is %g; |x| <= 1e18 is needed",
                reader->file->path, reader->text.line, "xyz"[axis], value);
        }
        x[axis] = (float)value;
    }
    return add_corner(reader, x, vertex);
}

static int read_facet(struct stl_reader *reader)
{
    struct ctl_word line;
    int status = expect(reader, "outer", &line);
    for (int k = 0; k < 3 && status == PCCD_OK; k++) {
        status = read_corner(reader, &reader->corners[k]);
    }
    if (status == PCCD_OK) {
        status = expect(reader, "endloop", &line);
    }
    if (status == PCCD_OK) {
        status = expect(reader, "endfacet", &line);
    }
    return status == PCCD_OK ? ctl_mesh_add(reader->mesh, CTL_TRIANGLES, reader->corners)
                             : status;
}

/* One solid after the other; they are one mesh. The last one may lack its end. */
static int read_ascii(struct stl_reader *reader)
{
    struct ctl_word line, word;
    bool is_within = false, has_begun = false;
    int status = PCCD_OK;
    while (status == PCCD_OK && next_line(reader, &line, &word)) {
        if (is_within && ctl_word_is_any_case(&word, "facet")) {
            status = read_facet(reader);
        } else if (is_within && is_end(&word, line, "solid")) {
            is_within = false;
        } else if (!is_within && ctl_word_is_any_case(&word, "solid")) {
            is_within = has_begun = true;
        } else {
            status = unexpected(reader, is_within ? "facet" : "solid", &word);
        }
    }
    return status == PCCD_OK && !has_begun ? no_stl(reader->file, reader->error) : status;
}

int ctl_stl_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct stl_reader reader = {
        .file = file,
        .mesh = mesh,
        .error = mesh->error,
        .text = ctl_text_begin(file),
    };
    uint64_t all_bytes = file->bytes + file->rest_bytes;
    mesh->format = PCCD_FORMAT_F32;
    int status;
    if (is_binary(file->data, file->bytes, all_bytes)) {
        status = read_binary(&reader);
    } else if (!is_ascii(file) && memchr(file->data, 0, file->bytes) != NULL) {
        status = no_stl(file, mesh->error);
    } else {
        status = read_ascii(&reader);
    }
    free(reader.table);
    return status;
}

int ctl_stl_judge(const struct ctl_file *begin, bool *is_text, struct ctl_error *error)
{
    *is_text = !is_binary(begin->data, begin->bytes, begin->bytes + begin->rest_bytes);
    return !*is_text || is_ascii(begin) ? PCCD_OK : no_stl(begin, error);
}
