/* client/ctl/mesh/obj.c - Wavefront OBJ files.
 *
 * Vertices, faces, lines and points are read, in the order of the file; textures, normals
 * and materials are not, and free-form surfaces are refused.
 *
 * Source: Wavefront OBJ specification, appendix B1.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "meshfile.h"
#include "printable.h"

/* Kinds of statements. The first three name vertices; from OBJECT to NAMES_END they have
 * a name, which may end in a backslash, and have a hash within. Those without a kind of
 * their own are not read, and have no vertices, faces, lines or points; anything else is
 * an error, so that a file of another kind is not read as an empty mesh. */
enum {
    POINTS = CTL_POINTS,
    LINE = CTL_EDGES,
    FACE = CTL_TRIANGLES,
    VERTEX,
    OBJECT,
    GROUP
};
static const char *const statements[] = {
    "p",      "l",      "f",      "v",          "o",         "g",        "usemtl",
    "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj", "vn",       "vt",
    "s",      "mg",     "vp",     "lod",        "bevel",     "c_interp", "d_interp"};
enum { NAMES_END = GROUP + 7, UNKNOWN = sizeof statements / sizeof statements[0] };

struct obj {
    struct ctl_file *file;
    struct ctl_mesh *mesh;
    uint64_t counts[UNKNOWN + 1], seen[UNKNOWN + 1]; /* in the file; so far */
};

/* Return the kind of a line, by its first word. */
static uint32_t kind_of(struct ctl_word line)
{
    struct ctl_word word;
    uint32_t kind = ctl_word_next(&line, &word) ? 0 : UNKNOWN;
    while (kind < UNKNOWN &&
           (statements[kind][0] != *word.at || !ctl_word_is(&word, statements[kind]))) {
        kind++;
    }
    return kind;
}

bool ctl_obj_begins(const struct ctl_file *file)
{
    const char *end = file->data + file->bytes;
    struct ctl_word line = {ctl_file_start(file), NULL}, word;
    bool is_said = false;
    while (line.at < end && !is_said) {
        line.end = line.at + strcspn(line.at, "\r\n"); /* data ends with a byte 0 */
        struct ctl_word rest = line;
        is_said = ctl_word_next(&rest, &word) && *word.at != '#';
        line.at = is_said ? line.at : line.end + 1;
    }
    return is_said && kind_of(line) < UNKNOWN;
}

static bool has_name(uint32_t kind)
{
    return kind >= OBJECT && kind < NAMES_END;
}

/* Return whether the next line continues this one, of a statement of that kind: it ends
 * in a backslash, and that is not of a comment or a name. */
static bool goes_on(const struct ctl_word *line, uint32_t kind)
{
    return line->end > line->at && line->end[-1] == '\\' && !has_name(kind) &&
           memchr(line->at, '#', (size_t)(line->end - line->at)) == NULL;
}

/* A comment reaches to the end of the line. Within a word of a name it is none: leg#1. */
static void end_at_comment(struct ctl_word *statement, uint32_t kind)
{
    const char *end = statement->end;
    const char *hash = memchr(statement->at, '#', (size_t)(end - statement->at));
    while (hash != NULL && hash > statement->at && hash[-1] != ' ' && hash[-1] != '\t' &&
           has_name(kind)) {
        hash = memchr(hash + 1, '#', (size_t)(end - hash - 1));
    }
    statement->end = hash != NULL ? hash : end;
}

/* The next statement: lines that end in a backslash go on in the next one. Its characters
 * stay in place: the backslash and the line end are blanked in our copy of the file. */
static bool next_statement(struct ctl_file *file, struct ctl_word *statement,
                           uint32_t *kind)
{
    struct ctl_word line;
    bool has_more = ctl_file_line(file, &line);
    if (!has_more) {
        return false;
    }
    uint32_t first_kind = kind_of(line);
    *kind = first_kind;
    *statement = line;
    file->keep = line.at; /* the lines of a statement stay together */
    while (has_more && goes_on(&line, first_kind)) {
        size_t gap = (size_t)(line.end - 1 - file->keep);
        size_t gap_bytes = (size_t)(file->at - file->keep) - gap;
        has_more = ctl_file_line(file, &line);
        memset(file->data + (file->keep - file->data) + gap, ' ', gap_bytes);
        *statement =
            (struct ctl_word){file->keep, has_more ? line.end : file->keep + gap};
        *kind = kind_of(*statement);
    }
    file->keep = NULL;
    end_at_comment(statement, *kind);
    return file->status == PCCD_OK;
}

/* Count the statements of the file, so that vertices are allocated once and a part knows
 * where it begins. A line that continues another is no statement. */
static void count_statements(struct obj *obj)
{
    struct ctl_word line;
    bool is_continued = false;
    while (ctl_file_line(obj->file, &line)) {
        uint32_t kind = is_continued ? UNKNOWN : kind_of(line);
        is_continued = goes_on(&line, kind);
        obj->counts[kind]++;
    }
}

static int read_vertex(struct obj *obj, struct ctl_word *line)
{
    struct ctl_file *file = obj->file;
    uint64_t vertex = obj->seen[VERTEX];
    double values[7];
    uint32_t count = 0;
    struct ctl_word word;
    if (vertex > obj->counts[VERTEX]) {
        return ctl_file_refuse(file, "a vertex that begins on a continued line");
    }
    while (ctl_word_next(line, &word)) {
        if (count == 7) {
            return ctl_file_refuse(file, "more than 7 numbers in a vertex");
        }
        if (!ctl_word_double(&word, &values[count++])) {
            return ctl_file_refuse(file, "\"%.*s\" is not a number", CTL_QUOTE(word));
        }
    }
    /* x y z, then perhaps a weight, then perhaps a colour. */
    if (count < 3 || count == 5) {
        return ctl_file_refuse(file, "a vertex of %" PRIu32 " numbers", count);
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        if (!common_is_coordinate(values[axis])) {
            return ctl_file_fail(file, PCCD_E_NOTFINITE,
                                 "vertex %" PRIu64
                                 ": coordinate %c is %g; |x| <= 1e18 is needed",
                                 vertex, "xyz"[axis], values[axis]);
        }
        ctl_mesh_set(obj->mesh, (size_t)(vertex - 1) * 3 + axis, values[axis]);
    }
    return PCCD_OK;
}

/* "7", "7/1", "7/1/2", "7//2", "-1": the vertex number before the first slash, from 1, or
 * backwards from the last vertex so far. */
static uint32_t read_corner(struct obj *obj, const struct ctl_word *word)
{
    struct ctl_word number = *word;
    int64_t value, seen = (int64_t)obj->seen[VERTEX];
    int64_t known = (int64_t)obj->counts[VERTEX];
    const char *slash = memchr(word->at, '/', (size_t)(word->end - word->at));
    number.end = slash != NULL ? slash : number.end;
    if (number.end == number.at || !ctl_word_integer(&number, &value)) {
        ctl_file_refuse(obj->file, "\"%.*s\" is not a vertex number", CTL_QUOTE(*word));
        return 0;
    }
    if (value == 0 || value < -seen || value > known) {
        ctl_file_fail(obj->file, PCCD_E_INDEX,
                      "%" PRId64 " is not a vertex number (%" PRId64
                      " vertices so far, %" PRId64 " in the file)",
                      value, seen, known);
        return 0;
    }
    return (uint32_t)(value < 0 ? value + seen : value - 1);
}

/* A face has corners; l 1 2 3 are the edges 1 2 and 2 3; points are by themselves. */
static int read_corners(struct obj *obj, uint32_t kind, struct ctl_word *line)
{
    struct ctl_file *file = obj->file;
    struct ctl_mesh *mesh = obj->mesh;
    uint32_t ends[2] = {0, 0};
    uint64_t count = 0;
    struct ctl_word word;
    ctl_mesh_begin_row(mesh, obj->seen[kind] - 1, obj->counts[kind]);
    while (file->status == PCCD_OK && ctl_word_next(line, &word)) {
        ends[1] = read_corner(obj, &word);
        if (file->status == PCCD_OK && (kind != LINE || count > 0)) {
            file->status = kind == FACE   ? ctl_mesh_add_corner(mesh, ends[1])
                           : kind == LINE ? ctl_mesh_add(mesh, CTL_EDGES, ends)
                                          : ctl_mesh_add(mesh, CTL_POINTS, &ends[1]);
        }
        ends[0] = ends[1];
        count++;
    }
    if (count == 0 && kind == POINTS) {
        return ctl_file_refuse(file, "points without a vertex");
    }
    if (count <= kind) {
        return ctl_file_refuse(file, "%" PRIu64 " %s where a %s needs at least %" PRIu32,
                               count, proto_plural(count, "vertex", "vertices"),
                               kind == FACE ? "face" : "line", kind + 1);
    }
    return file->status == PCCD_OK && kind == FACE ? ctl_mesh_end_face(mesh, file->line)
                                                   : file->status;
}

static int read_name(struct obj *obj, struct ctl_word *line)
{
    struct ctl_word name = {line->end, line->end}, word;
    while (ctl_word_next(line, &word)) {
        name.at = name.at == line->end ? word.at : name.at;
        name.end = word.end;
    }
    return ctl_mesh_add_object(obj->mesh, name.at, (size_t)(name.end - name.at));
}

static int read_statement(struct obj *obj, uint32_t kind, struct ctl_word line)
{
    struct ctl_word word;
    /* Objects are named by `o`, and by `g` in a file that has no `o`. */
    bool is_object = kind == OBJECT || (kind == GROUP && obj->counts[OBJECT] == 0);
    obj->seen[kind]++;
    if (!ctl_word_next(&line, &word)) {
        return PCCD_OK;
    }
    return kind == UNKNOWN
               ? ctl_file_refuse(obj->file, "unknown statement \"%.*s\"", CTL_QUOTE(word))
           : kind <= FACE   ? read_corners(obj, kind, &line)
           : kind == VERTEX ? read_vertex(obj, &line)
           : is_object      ? read_name(obj, &line)
                            : PCCD_OK;
}

static int compare_names(const void *a, const void *b)
{
    const struct ctl_mesh_object *const *left = a, *const *right = b;
    int order = strcmp((*left)->name, (*right)->name);
    return order != 0 ? order : (*left < *right ? -1 : 1);
}

/* Join parts that have one name: they are one object. */
static void join_parts(struct obj *obj)
{
    struct ctl_mesh *mesh = obj->mesh;
    size_t count = mesh->object_count;
    struct ctl_mesh_object **order = malloc((count + 1) * sizeof(void *));
    if (order == NULL) {
        ctl_file_fail(obj->file, PCCD_E_NOMEM, "no memory for %zu objects", count);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        order[i] = &mesh->objects[i];
    }
    qsort(order, count, sizeof(void *), compare_names);
    for (size_t i = 1; i < count; i++) {
        if (strcmp(order[i]->name, order[i - 1]->name) == 0) {
            order[i]->whole = order[i - 1]->whole;
        }
    }
    free(order);
}

int ctl_obj_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct obj obj = {.file = file, .mesh = mesh};
    struct ctl_word statement;
    uint32_t kind;
    ctl_file_begin(file);
    ctl_file_expect_text(file);
    count_statements(&obj);
    ctl_file_begin(file);
    mesh->has_lines = true;
    if (file->status == PCCD_OK) {
        file->status = ctl_mesh_alloc_vertices(mesh, PCCD_FORMAT_F64, obj.counts[VERTEX]);
    }
    while (file->status == PCCD_OK && next_statement(file, &statement, &kind)) {
        file->status = read_statement(&obj, kind, statement);
    }
    join_parts(&obj);
    return obj.seen[VERTEX] < obj.counts[VERTEX]
               ? ctl_file_refuse(file, "it changed while it was read")
               : file->status;
}
