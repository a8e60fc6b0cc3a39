/* client/ctl/mesh/stl.c - STL files, binary and ascii.
 *
 * Each facet has corners of its own; corners at exactly the same place become one vertex,
 * numbered as they come, since a surface is of one piece only by its vertices.
 *
 * Source: 3D Systems, "StereoLithography Interface Specification" (1988).
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "array.h"
#include "meshfile.h"

#define HEADER_BYTES 84u /* 80 of any text, and the number of facets */
#define FACET_BYTES  50u /* a normal, three corners, and two bytes of anything */
#define NORMAL_BYTES 12u
#define FREE         UINT32_MAX
#define LOOK_BYTES   ((size_t)512) /* of a file that may be ascii */

struct stl {
    struct ctl_file *file;
    struct ctl_mesh *mesh;
    size_t room;     /* of mesh->x */
    uint32_t *table; /* [table_mask + 1]: vertices by their places; FREE: none */
    size_t table_mask;
};

/* Return where a place is in the table, or the first free entry after that. */
static uint32_t *entry_of(const struct stl *stl, const float place[3])
{
    const float(*x)[3] = stl->mesh->x;
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t bits;
        memcpy(&bits, &place[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    size_t at = (uint32_t)hash & stl->table_mask;
    while (stl->table[at] != FREE && memcmp(x[stl->table[at]], place, sizeof *x) != 0) {
        at = (at + 1) & stl->table_mask;
    }
    return &stl->table[at];
}

/* Twice as much room for vertices, and a table that is at most half full with them. */
static int make_room(struct stl *stl)
{
    struct ctl_mesh *mesh = stl->mesh;
    if (mesh->vertex_count == CTL_MESH_COUNT_MAX) {
        return ctl_file_fail(stl->file, PCCD_E_LIMIT, "more than %" PRIu64 " vertices",
                             CTL_MESH_COUNT_MAX);
    }
    bool has_room =
        array_reserve(&mesh->x, mesh->vertex_count, &stl->room, sizeof(float[3]));
    size_t entries = 2 * stl->room; /* a power of two, as the room is */
    free(stl->table);
    stl->table = has_room ? malloc(entries * sizeof *stl->table) : NULL;
    if (stl->table == NULL) {
        return ctl_file_fail(stl->file, PCCD_E_NOMEM, "no memory for %zu vertices",
                             stl->room);
    }
    memset(stl->table, 0xff, entries * sizeof *stl->table);
    stl->table_mask = entries - 1;
    for (uint32_t i = 0; i < mesh->vertex_count && !mesh->is_corners; i++) {
        *entry_of(stl, ((const float(*)[3])mesh->x)[i]) = i;
    }
    return PCCD_OK;
}

static uint32_t vertex_at(struct stl *stl, const float x[3])
{
    struct ctl_mesh *mesh = stl->mesh;
    uint32_t new = FREE;
    float place[3];
    for (int axis = 0; axis < 3; axis++) {
        place[axis] = x[axis] == 0 ? 0 : x[axis]; /* 0 and -0 are one place */
    }
    if (mesh->vertex_count == stl->room && make_room(stl) != PCCD_OK) {
        return 0;
    }
    uint32_t *entry = mesh->is_corners ? &new : entry_of(stl, place);
    if (*entry == FREE) {
        memcpy(((float(*)[3])mesh->x)[mesh->vertex_count], place, sizeof place);
        *entry = mesh->vertex_count++;
    }
    return *entry;
}

static void add_facet(struct stl *stl, const float x[9])
{
    uint32_t corners[3];
    for (int k = 0; k < 3; k++) {
        corners[k] = stl->file->status == PCCD_OK ? vertex_at(stl, x + 3 * k) : 0;
    }
    if (stl->file->status == PCCD_OK) {
        stl->file->status = ctl_mesh_add(stl->mesh, CTL_TRIANGLES, corners);
    }
}

/* Return whether a file is binary: its number of facets says how long it is. The first
 * line of ascii does not tell, since headers may begin with "solid", too. */
static bool is_binary(const struct ctl_file *file)
{
    return file->bytes >= HEADER_BYTES &&
           ctl_file_size(file) ==
               HEADER_BYTES + (uint64_t)ctl_file_word(file->data + 80) * FACET_BYTES;
}

static void read_binary(struct stl *stl)
{
    struct ctl_file *file = stl->file;
    uint32_t count = ctl_file_word(file->data + 80);
    float x[9];
    file->at = file->data + HEADER_BYTES;
    for (uint32_t i = 0; i < count && file->status == PCCD_OK; i++) {
        if (!ctl_file_more(file, FACET_BYTES)) {
            ctl_file_refuse(file, "facet %" PRIu32 " of %" PRIu32 ": the file ends here",
                            i, count);
            return;
        }
        for (uint32_t k = 0; k < 9; k++) {
            uint32_t bits = ctl_file_word(file->at + NORMAL_BYTES + 4 * k);
            memcpy(&x[k], &bits, sizeof bits);
            if (!common_is_coordinate((double)x[k])) {
                ctl_file_fail(file, PCCD_E_NOTFINITE,
                              "facet %" PRIu32 ", corner %" PRIu32
                              ": coordinate %c is %g; |x| <= 1e18 is needed",
                              i, k / 3, "xyz"[k % 3], (double)x[k]);
            }
        }
        add_facet(stl, x);
        file->at += FACET_BYTES;
    }
}

/* Return whether a file begins with "solid", and has no byte 0 soon, as a binary file
 * has. */
static bool is_ascii(const struct ctl_file *file)
{
    static const char blanks[] = " \t\r\n\v\f";
    const char *start = ctl_file_start(file), *word = start + strspn(start, blanks);
    size_t left = (size_t)(file->data + file->bytes - word);
    return strncasecmp(word, "solid", 5) == 0 && strchr(blanks, word[5]) != NULL &&
           memchr(word, 0, left < LOOK_BYTES ? left : LOOK_BYTES) == NULL;
}

bool ctl_stl_begins(const struct ctl_file *file)
{
    return is_binary(file) || is_ascii(file);
}

static void refuse_kind(struct ctl_file *file)
{
    uint64_t all = ctl_file_size(file), rest = all - HEADER_BYTES;
    if (file->bytes < HEADER_BYTES) {
        ctl_file_refuse(file,
                        "no STL: it does not begin with \"solid\", and has %" PRIu64
                        " bytes where a binary one has %u and more",
                        all, HEADER_BYTES);
        return;
    }
    ctl_file_refuse(file,
                    "no STL: it does not begin with \"solid\", and its header tells of "
                    "%" PRIu32 " facets, where %" PRIu64 " bytes have %" PRIu64
                    " and %" PRIu64 " bytes more",
                    ctl_file_word(file->data + 80), all, rest / FACET_BYTES,
                    rest % FACET_BYTES);
}

/* Return whether a line begins with the words wanted; "end facet" is "endfacet". */
static bool begins(const struct ctl_word *word, struct ctl_word line, const char *wanted)
{
    struct ctl_word second;
    return ctl_word_is_any_case(word, wanted) ||
           (strncmp(wanted, "end", 3) == 0 && ctl_word_is_any_case(word, "end") &&
            ctl_word_next(&line, &second) && ctl_word_is_any_case(&second, wanted + 3));
}

static void read_place(struct ctl_file *file, struct ctl_word *line, float x[3])
{
    for (int axis = 0; axis < 3; axis++) {
        struct ctl_word word = {line->end, line->end};
        double value;
        if (!ctl_word_next(line, &word) || !ctl_word_float(&word, &value)) {
            ctl_file_refuse(file, "\"%.*s\" where \"three numbers\" is needed",
                            CTL_QUOTE(word));
        } else if (!common_is_coordinate(value)) {
            ctl_file_fail(file, PCCD_E_NOTFINITE,
                          "coordinate %c is %g; |x| <= 1e18 is needed", "xyz"[axis],
                          value);
        } else {
            x[axis] = (float)value;
        }
    }
}

/* One solid after the other; they are one mesh. The last one may lack its end. */
static void read_ascii(struct stl *stl)
{
    static const struct {
        const char *begin;
        uint32_t words; /* that follow, at most, beside three numbers of a vertex */
    } lines[] = {{"solid", 0},  {"facet", 4},  {"outer", 1},   {"vertex", 0},
                 {"vertex", 0}, {"vertex", 0}, {"endloop", 0}, {"endfacet", 0}};
    struct ctl_file *file = stl->file;
    struct ctl_word line, word;
    float x[9] = {0};
    uint32_t due = 0; /* of these lines */
    bool has_begun = false;
    while (ctl_file_line(file, &line)) {
        if (!ctl_word_next(&line, &word)) {
            continue;
        }
        if (due == 1 && begins(&word, line, "endsolid")) {
            due = 0;
            continue;
        }
        if (!begins(&word, line, lines[due].begin)) {
            ctl_file_refuse(file, "\"%.*s\" where \"%s\" is needed", CTL_QUOTE(word),
                            lines[due].begin);
        } else if (due >= 3 && due < 6) {
            read_place(file, &line, x + 3 * (due - 3));
        } else if (due == 7) {
            add_facet(stl, x);
        }
        uint32_t words = ctl_word_is_any_case(&word, "end") ? 1 : lines[due].words;
        for (uint32_t k = 0; k < words && ctl_word_next(&line, &word); k++) {
        }
        if (due > 0 && ctl_word_next(&line, &word)) {
            ctl_file_refuse(file, "\"%.*s\" is too much on the line", CTL_QUOTE(word));
        }
        has_begun = true;
        due = due == 7 ? 1 : due + 1;
    }
    if (!has_begun) {
        refuse_kind(file);
    } else if (due > 1 && file->status == PCCD_OK) {
        file->status = ctl_error_set(file->error, PCCD_E_FORMAT,
                                     "%s: it ends where \"%s\" is needed", file->path,
                                     lines[due].begin);
    }
}

int ctl_stl_parse(struct ctl_file *file, struct ctl_mesh *mesh)
{
    struct stl stl = {.file = file, .mesh = mesh};
    mesh->format = PCCD_FORMAT_F32;
    ctl_file_begin(file);
    if (is_binary(file)) {
        read_binary(&stl);
    } else if (!is_ascii(file) &&
               (file->has_more || memchr(file->data, 0, file->bytes) != NULL)) {
        refuse_kind(file);
    } else {
        ctl_file_expect_text(file);
        read_ascii(&stl);
    }
    free(stl.table);
    return file->status;
}
