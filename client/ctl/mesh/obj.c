/* client/ctl/mesh/obj.c - Wavefront OBJ files.
 *
 * Room:     client/ctl.
 * Does:     reads v, f, l and p (also negative and slash-separated numbers), turns lines
 *           into edges, keeps the order of the file; coordinates are double.
 * Does not: read texture, normal or material data, nor free-form surfaces.
 * Threads:  [any]; nothing is shared.
 * Source:   Wavefront OBJ specification, appendix B1.
 */
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "meshfile.h"
#include "plural.h"

/* Statements without vertices, faces, lines or points. Anything else is an error, so that
 * a file of another kind is not read as an empty mesh. */
static const char *const ignored[] = {
    "vt",  "vn",    "s",        "mg",       "usemtl",     "mtllib",    "usemap", "maplib",
    "lod", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "vp",
};

/* Statements of the file. */
struct obj_counts {
    uint64_t vertices, faces, lines, points, objects;
};

struct obj_reader {
    struct ctl_file *file;
    struct ctl_mesh *mesh;
    struct ctl_error *error;
    struct ctl_text text;
    uint64_t line_begin; /* where the statement at hand begins, for messages */
    uint64_t vertex_seen, face_seen, line_seen, points_seen;
    struct obj_counts counts;
};

static int fail(struct obj_reader *reader, int status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static int fail(struct obj_reader *reader, int status, const char *format, ...)
{
    char what[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return ctl_error_set(reader->error, status, "%s:%" PRIu64 ": %s", reader->file->path,
                         reader->line_begin, what);
}

/* Whether a statement is a name, which may end in a backslash. */
static bool is_name(struct ctl_word statement)
{
    static const char *const names[] = {"o",      "g",      "usemtl",     "mtllib",
                                        "usemap", "maplib", "shadow_obj", "trace_obj"};
    struct ctl_word word;
    bool is_one = false;
    if (ctl_word_next(&statement, &word)) {
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
            is_one = is_one || ctl_word_is(&word, names[i]);
        }
    }
    return is_one;
}

/* Whether the next line continues this one, which is a statement's first or a later one:
 * it ends in a backslash, and that is not of a comment or a name. */
static bool goes_on(const struct ctl_word *line, bool is_first)
{
    return line->end > line->at && line->end[-1] == '\\' &&
           memchr(line->at, '#', (size_t)(line->end - line->at)) == NULL &&
           !(is_first && is_name(*line));
}

/* A comment reaches to the end of the line. Within a word of a name it is none: leg#1. */
static void end_at_comment(struct ctl_word *statement)
{
    const char *end = statement->end;
    const char *hash = memchr(statement->at, '#', (size_t)(end - statement->at));
    while (hash != NULL && hash > statement->at && hash[-1] != ' ' && hash[-1] != '\t' &&
           is_name(*statement)) {
        hash = memchr(hash + 1, '#', (size_t)(end - hash - 1));
    }
    if (hash != NULL) {
        statement->end = hash;
    }
}

/* The next statement: lines that end in a backslash go on in the next one. Its characters
 * stay in place: the backslash and the line end are blanked in our copy of the file. */
static bool next_statement(struct obj_reader *reader, struct ctl_word *statement)
{
    struct ctl_word line;
    if (!ctl_text_line(&reader->text, &line)) {
        return false;
    }
    reader->line_begin = reader->text.line;
    *statement = line;
    reader->text.keep = line.at; /* the lines of a statement stay together */
    for (bool is_first = true; goes_on(&line, is_first); is_first = false) {
        size_t gap = (size_t)(line.end - 1 - reader->text.keep);
        size_t gap_bytes = (size_t)(reader->text.at - reader->text.keep) - gap;
        bool has_more = ctl_text_line(&reader->text, &line);
        *statement = (struct ctl_word){reader->text.keep, reader->text.keep + gap};
        if (!has_more) {
            break;
        }
        memset(reader->file->data + (statement->end - reader->file->data), ' ',
               gap_bytes);
        statement->end = line.end;
    }
    reader->text.keep = NULL;
    end_at_comment(statement);
    return true;
}

/* Statements in the file, so that vertices are allocated once and a part knows where it
 * begins. A line that continues another is no statement. */
static struct obj_counts count_statements(struct ctl_file *file)
{
    struct ctl_text text = ctl_text_begin(file);
    struct ctl_word line, word;
    struct obj_counts counts = {0, 0, 0, 0, 0};
    bool is_continued = false;
    while (ctl_text_line(&text, &line)) {
        bool is_start = !is_continued;
        is_continued = goes_on(&line, is_start);
        if (!is_start || !ctl_word_next(&line, &word)) {
            continue;
        }
        counts.vertices += ctl_word_is(&word, "v");
        counts.faces += ctl_word_is(&word, "f");
        counts.lines += ctl_word_is(&word, "l");
        counts.points += ctl_word_is(&word, "p");
        counts.objects += ctl_word_is(&word, "o");
    }
    return counts;
}

static int read_vertex(struct obj_reader *reader, struct ctl_word *line)
{
    double values[7];
    uint32_t count = 0;
    struct ctl_word word;
    if (reader->vertex_seen == reader->counts.vertices) {
        return fail(reader, PCCD_E_FORMAT, "a vertex that begins on a continued line");
    }
    while (ctl_word_next(line, &word)) {
        if (count == 7) {
            return fail(reader, PCCD_E_FORMAT, "more than 7 numbers in a vertex");
        }
        if (!ctl_word_double(&word, &values[count])) {
            return fail(reader, PCCD_E_FORMAT, "\"%.*s\" is not a number",
                        ctl_word_length(&word), word.at);
        }
        count++;
    }
    /* x y z, then perhaps a weight, then perhaps a colour. */
    if (count < 3 || count == 5) {
        return fail(reader, PCCD_E_FORMAT, "a vertex of %" PRIu32 " numbers", count);
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        if (!common_is_coordinate(values[axis])) {
            return fail(reader, PCCD_E_NOTFINITE,
                        "vertex %" PRIu64 ": coordinate %c is %g; |x| <= 1e18 is needed",
                        reader->vertex_seen + 1, "xyz"[axis], values[axis]);
        }
        ctl_mesh_set(reader->mesh, (size_t)reader->vertex_seen * 3 + axis, values[axis]);
    }
    reader->vertex_seen++;
    return PCCD_OK;
}

/* "7", "7/1", "7/1/2", "7//2", "-1": the vertex number before the first slash, from 1, or
 * backwards from the last vertex so far. */
static int read_corner(struct obj_reader *reader, const struct ctl_word *word,
                       uint32_t *index)
{
    struct ctl_word number = *word;
    int64_t value;
    const char *slash = memchr(word->at, '/', (size_t)(word->end - word->at));
    if (slash != NULL) {
        number.end = slash;
    }
    if (number.end == number.at || !ctl_word_integer(&number, &value)) {
        return fail(reader, PCCD_E_FORMAT, "\"%.*s\" is not a vertex number",
                    ctl_word_length(word), word->at);
    }
    int64_t seen = (int64_t)reader->vertex_seen;
    int64_t known = (int64_t)reader->counts.vertices;
    if (value < 0 && value >= -seen) {
        value += seen;
    } else if (value > 0 && value <= known) {
        value -= 1;
    } else {
        return fail(reader, PCCD_E_INDEX,
                    "%" PRId64 " is not a vertex number (%" PRId64
                    " vertices so far, %" PRId64 " in the file)",
                    value, seen, known);
    }
    *index = (uint32_t)value;
    return PCCD_OK;
}

static int read_face(struct obj_reader *reader, struct ctl_word *line)
{
    uint64_t count = 0;
    struct ctl_word word;
    while (ctl_word_next(line, &word)) {
        uint32_t corner;
        int status = read_corner(reader, &word, &corner);
        if (status == PCCD_OK) {
            status = ctl_mesh_add_corner(reader->mesh, corner);
        }
        if (status != PCCD_OK) {
            return status;
        }
        count++;
    }
    if (count < 3) {
        return fail(reader, PCCD_E_FORMAT, "%" PRIu64 " %s where a face needs at least 3",
                    count, proto_plural(count, "vertex", "vertices"));
    }
    return ctl_mesh_end_face(reader->mesh, reader->line_begin);
}

/* l 1 2 3: the edges 1 2 and 2 3. */
static int read_line(struct obj_reader *reader, struct ctl_word *line)
{
    uint32_t ends[2] = {0, 0};
    uint64_t count = 0;
    struct ctl_word word;
    while (ctl_word_next(line, &word)) {
        int status = read_corner(reader, &word, &ends[1]);
        if (status == PCCD_OK && count > 0) {
            status = ctl_mesh_add(reader->mesh, CTL_EDGES, ends);
        }
        if (status != PCCD_OK) {
            return status;
        }
        ends[0] = ends[1];
        count++;
    }
    if (count < 2) {
        return fail(reader, PCCD_E_FORMAT, "%" PRIu64 " %s where a line needs at least 2",
                    count, proto_plural(count, "vertex", "vertices"));
    }
    return PCCD_OK;
}

static int read_points(struct obj_reader *reader, struct ctl_word *line)
{
    uint64_t count = 0;
    struct ctl_word word;
    while (ctl_word_next(line, &word)) {
        uint32_t vertex;
        int status = read_corner(reader, &word, &vertex);
        if (status == PCCD_OK) {
            status = ctl_mesh_add(reader->mesh, CTL_POINTS, &vertex);
        }
        if (status != PCCD_OK) {
            return status;
        }
        count++;
    }
    return count > 0 ? PCCD_OK : fail(reader, PCCD_E_FORMAT, "points without a vertex");
}

/* Objects are named by `o`, and by `g` in a file that has no `o`. */
static int read_name(struct obj_reader *reader, const struct ctl_word *line)
{
    struct ctl_word rest = *line, name = {line->end, line->end}, word;
    while (ctl_word_next(&rest, &word)) {
        name.at = name.at == line->end ? word.at : name.at;
        name.end = word.end;
    }
    return ctl_mesh_add_object(reader->mesh, name.at, (size_t)(name.end - name.at));
}

static int read_statement(struct obj_reader *reader, struct ctl_word *line)
{
    struct ctl_word word;
    if (!ctl_word_next(line, &word)) {
        return PCCD_OK;
    }
    if (ctl_word_is(&word, "v")) {
        return read_vertex(reader, line);
    }
    if (ctl_word_is(&word, "f")) {
        ctl_mesh_begin_row(reader->mesh, reader->face_seen++, reader->counts.faces);
        return read_face(reader, line);
    }
    if (ctl_word_is(&word, "l")) {
        ctl_mesh_begin_row(reader->mesh, reader->line_seen++, reader->counts.lines);
        return read_line(reader, line);
    }
    if (ctl_word_is(&word, "p")) {
        ctl_mesh_begin_row(reader->mesh, reader->points_seen++, reader->counts.points);
        return read_points(reader, line);
    }
    if (ctl_word_is(&word, "o") || ctl_word_is(&word, "g")) {
        bool is_object = word.at[0] == 'o' || reader->counts.objects == 0;
        return is_object ? read_name(reader, line) : PCCD_OK;
    }
    for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++) {
        if (ctl_word_is(&word, ignored[i])) {
            return PCCD_OK;
        }
    }
    return fail(reader, PCCD_E_FORMAT, "unknown statement \"%.*s\"",
                ctl_word_length(&word), word.at);
}

int ctl_obj_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct obj_reader reader = {
        .file = file,
        .mesh = mesh,
        .error = mesh->error,
        .counts = count_statements(file),
    };
    struct ctl_word statement;
    reader.text = ctl_text_begin(file);
    mesh->has_lines = true;
    int status = ctl_mesh_alloc_vertices(mesh, PCCD_FORMAT_F64, reader.counts.vertices);
    while (status == PCCD_OK && next_statement(&reader, &statement)) {
        status = read_statement(&reader, &statement);
    }
    if (status == PCCD_OK && reader.vertex_seen < reader.counts.vertices) {
        status = ctl_error_set(mesh->error, PCCD_E_FORMAT,
                               "%s: it changed while it was read", file->path);
    }
    return status;
}
