/* test_ctl_parts.c - mesh files that are larger than what is read at once, and parts
 * of them.
 */
#include <inttypes.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ctl_kit.h"
#include "meshfile.h"

#define VERTICES 60000u
#define FACES    70000u /* rows: every seventh has four corners */
#define EDGES    5000u
#define POINTS   300u
#define OTHERS   1100000u /* vertices of a file that would take many megabytes */

enum kind { PLY_TEXT, PLY_BINARY, OBJ };
static const char *const names[] = {"text.ply", "binary.ply", "large.obj"};

/* On a parabola, so that faces of four corners are convex. */
static float coordinate(uint32_t vertex, uint32_t axis)
{
    uint32_t along = vertex % 4096;
    return axis == 0 ? (float)along / 16 - 100 : (float)(along * along * axis);
}

/* Corner k of a face; end k of an edge is that of face 2 i. */
static uint32_t corner(uint32_t face, uint32_t k)
{
    return (face * 11 + k * k * 101) % VERTICES;
}

static uint32_t corner_count(uint32_t face)
{
    return face % 7 == 3 ? 4 : 3;
}

static FILE *create(const char *name, char path[KIT_PATH_BYTES])
{
    kit_write_file(name, "", 0, path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    return file;
}

static void write_ply(FILE *file, bool is_text)
{
    fprintf(file,
            "ply\nformat %s 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
            "property float z\nelement face %u\nproperty list uchar int vertex_indices\n"
            "element edge %u\nproperty int vertex1\nproperty int vertex2\nend_header\n",
            is_text ? "ascii" : "binary_little_endian", VERTICES, FACES, EDGES);
    for (uint32_t v = 0; v < VERTICES; v++) {
        const float x[3] = {coordinate(v, 0), coordinate(v, 1), coordinate(v, 2)};
        if (is_text) {
            fprintf(file, "%.9g %.9g %.9g\n", (double)x[0], (double)x[1], (double)x[2]);
        } else {
            fwrite(x, sizeof x, 1, file);
        }
    }
    for (uint32_t row = 0; row < FACES + EDGES; row++) {
        bool is_edge = row >= FACES;
        uint32_t face = is_edge ? 2 * (row - FACES) : row;
        uint32_t count = is_edge ? 2 : corner_count(face);
        if (!is_edge) {
            fprintf(file, is_text ? "%u" : "%c", count);
        }
        for (uint32_t k = 0; k < count; k++) {
            uint32_t v = corner(face, k);
            if (is_text) {
                fprintf(file, " %" PRIu32, v);
            } else {
                fwrite(&v, sizeof v, 1, file);
            }
        }
        fputs(is_text ? "\n" : "", file);
    }
}

/* With lines that go on in the next one, comments that are long, one of them longer than
 * what is read at once, and statements that are not read. */
static void write_obj(FILE *file)
{
    for (uint32_t v = 0; v < VERTICES; v++) {
        fprintf(file, v % 13 == 5 ? "v %.9g \\\n %.9g %.9g\n" : "v %.9g %.9g %.9g\n",
                (double)coordinate(v, 0), (double)coordinate(v, 1),
                (double)coordinate(v, 2));
        fputs(v % 9 == 2 ? "vn 0 0 1\n" : "", file);
    }
    for (uint32_t face = 0; face < FACES; face++) {
        fputs("f", file);
        for (uint32_t k = 0; k < corner_count(face); k++) {
            fprintf(file, face % 5 == k ? " \\\r\n%" PRIu32 "/1" : " %" PRIu32,
                    corner(face, k) + 1);
        }
        fprintf(file, face % 1000 == 0 ? "# %0*u\n" : "\n",
                face == 5000 ? 3 << 20 : (int)(face / 10), 0);
    }
    for (uint32_t e = 0; e < EDGES; e++) {
        fprintf(file, "l %" PRIu32 " %" PRIu32 "\n", corner(2 * e, 0) + 1,
                corner(2 * e, 1) + 1);
    }
    for (uint32_t p = 0; p < POINTS; p++) {
        fprintf(file, "p %" PRIu32 "\n", 7 * p + 1);
    }
}

static void write_mesh(enum kind kind, char path[KIT_PATH_BYTES])
{
    FILE *file = create(names[kind], path);
    if (kind == OBJ) {
        write_obj(file);
    } else {
        write_ply(file, kind == PLY_TEXT);
    }
    assert_true(ftell(file) > 3 << 19); /* more than is read at once */
    assert_int_equal(fclose(file), 0);
}

static double place(const struct ctl_mesh *mesh, size_t i)
{
    return mesh->format == PCCD_FORMAT_F32 ? (double)((const float *)mesh->x)[i]
                                           : ((const double *)mesh->x)[i];
}

/* Piece `number` of `pieces` has what comes after the pieces before it, of which `first`
 * tells the counts. */
static void check_piece(const struct ctl_mesh *piece, struct ctl_mesh *first,
                        uint32_t *face, uint32_t *fan)
{
    for (size_t i = 0; i < (size_t)piece->vertex_count * 3; i++) {
        size_t all = (size_t)first->vertex_count * 3 + i;
        assert_true(place(piece, i) ==
                    (double)coordinate((uint32_t)(all / 3), (uint32_t)(all % 3)));
    }
    for (uint32_t i = 0; i < piece->triangles.count; i++) {
        const uint32_t expected[3] = {corner(*face, 0), corner(*face, 1 + *fan),
                                      corner(*face, 2 + *fan)};
        assert_memory_equal(piece->triangles.vertices + 3 * i, expected, sizeof expected);
        if (++*fan + 2 == corner_count(*face)) {
            *fan = 0;
            ++*face;
        }
    }
    for (uint32_t i = 0; i < piece->edges.count; i++) {
        assert_int_equal(piece->edges.vertices[2 * i],
                         corner(2 * (first->edges.count + i), 0));
        assert_int_equal(piece->edges.vertices[2 * i + 1],
                         corner(2 * (first->edges.count + i), 1));
    }
    for (uint32_t i = 0; i < piece->points.count; i++) {
        assert_int_equal(piece->points.vertices[i], 7 * (first->points.count + i));
    }
    first->vertex_count += piece->vertex_count;
    first->triangles.count += piece->triangles.count;
    first->edges.count += piece->edges.count;
    first->points.count += piece->points.count;
}

static void check_pieces(enum kind kind, const char *path, uint32_t pieces)
{
    struct ctl_mesh all = {.part = {.count = 0}};
    uint32_t face = 0, fan = 0;
    for (uint32_t i = 0; i < (pieces > 0 ? pieces : 1); i++) {
        struct ctl_mesh piece;
        struct ctl_error error = {.text = ""};
        if (ctl_mesh_read_as(path, &(struct ctl_reading){.number = i, .count = pieces},
                             &piece, &error) != PCCD_OK) {
            fail_msg("piece %u of %u: %s", i, pieces, error.text);
        }
        if (pieces > 0) {
            assert_true(piece.vertex_count <= VERTICES / pieces + 1);
            assert_true(piece.triangles.count <= 2 * (FACES / pieces + 1));
            assert_int_equal(piece.part.vertex_first, all.vertex_count);
        }
        assert_int_equal(piece.part.vertex_total, VERTICES);
        assert_int_equal(piece.triangles.total, FACES + FACES / 7);
        check_piece(&piece, &all, &face, &fan);
        ctl_mesh_deinit(&piece);
    }
    assert_int_equal(all.vertex_count, VERTICES);
    assert_int_equal(face, FACES);
    assert_int_equal(all.edges.count, EDGES);
    assert_int_equal(all.points.count, kind == OBJ ? POINTS : 0);
}

/* Kibibytes by which the most memory of a process grows when it reads a piece. */
static long growth(const char *path, uint32_t pieces)
{
    int ends[2];
    long kib = -1;
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0) {
        struct rusage before, after;
        struct ctl_error error;
        struct ctl_mesh piece;
        getrusage(RUSAGE_SELF, &before);
        int status = ctl_mesh_read_as(
            path, &(struct ctl_reading){.number = 0, .count = pieces}, &piece, &error);
        getrusage(RUSAGE_SELF, &after);
        kib = status == PCCD_OK ? after.ru_maxrss - before.ru_maxrss : -1;
        _exit(write(ends[1], &kib, sizeof kib) == (ssize_t)sizeof kib ? 0 : 1);
    }
    assert_int_equal(read(ends[0], &kib, sizeof kib), (ssize_t)sizeof kib);
    close(ends[0]);
    close(ends[1]);
    assert_int_equal(waitpid(child, NULL, 0), child);
    assert_true(kib >= 0);
    return kib;
}

/* If it failed: a scene that is too large for one machine could not be read on many. The
 * first case: what others have given back would be used again, and not be seen. */
CASE(parts__take_memory_for_a_part_alone)
{
    char path[KIT_PATH_BYTES];
    FILE *file = create("cloud.ply", path);
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty double x\n"
            "property double y\nproperty double z\nend_header\n",
            OTHERS);
    for (uint32_t v = 0; v < OTHERS; v++) {
        const double x[3] = {(double)v, 0, 1};
        fwrite(x, sizeof x, 1, file);
    }
    assert_int_equal(fclose(file), 0);
    long all = growth(path, 0), piece = growth(path, 16);
    assert_true(all > OTHERS * 28l / 1024 - 2048);
    assert_true(piece < all / 4);
}

/* If it failed: what lies where one window of a large file ends and the next begins would
 * be read wrongly, or ranks would have something twice, or not at all. */
CASE(parts__are_together_what_the_file_has)
{
    static const uint32_t pieces[] = {0, 1, 3, 8};
    char path[KIT_PATH_BYTES];
    for (uint32_t kind = PLY_TEXT; kind <= OBJ; kind++) {
        write_mesh((enum kind)kind, path);
        for (size_t i = 0; i < KIT_COUNT(pieces); i++) {
            check_pieces((enum kind)kind, path, pieces[i]);
        }
    }
}

/* If it failed: a small file, or one that is read whole, would be another mesh in parts
 * than in one; or of few rows some would have no owner. */
CASE(parts__of_small_files_are_together_what_they_have)
{
    static const char stl[] = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                              "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                              "facet normal 0 0 1\nouter loop\nvertex 1 0 0\n"
                              "vertex 0 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
                              "endsolid a\n";
    static const char cloud[] = "ply\nformat ascii 1.0\nelement vertex 4\n"
                                "property float x\nproperty float y\nproperty float z\n"
                                "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    static const char *const texts[] = {stl, cloud}, *const files[] = {"a.stl", "c.ply"};
    for (uint32_t f = 0; f < KIT_COUNT(files); f++) {
        uint32_t vertices = 0, triangles = 0, points = 0;
        char path[KIT_PATH_BYTES];
        kit_write_file(files[f], texts[f], strlen(texts[f]), path);
        for (uint32_t i = 0; i < 3; i++) {
            struct ctl_mesh piece;
            struct ctl_error error = {.text = ""};
            assert_ok(ctl_mesh_read_as(
                path, &(struct ctl_reading){.number = i, .count = 3}, &piece, &error));
            assert_int_equal(piece.part.vertex_first, vertices);
            assert_int_equal(piece.part.vertex_total, 4);
            for (uint32_t k = 0; k < piece.points.count; k++) {
                assert_int_equal(piece.points.vertices[k], points + k);
            }
            vertices += piece.vertex_count;
            triangles += piece.triangles.count;
            points += piece.points.count;
            ctl_mesh_deinit(&piece);
        }
        assert_int_equal(vertices, 4);
        assert_int_equal(triangles, f == 0 ? 2 : 0);
        assert_int_equal(points, f == 0 ? 0 : 4);
    }
}

/* If it failed: a mistake behind the first window of a file would be told of another
 * place than where it is, or by a rank whose part has it alone. */
CASE(parts__mistakes_are_told_by_all_of_them)
{
    struct ctl_error error = {.text = ""};
    struct ctl_mesh piece;
    char path[KIT_PATH_BYTES];
    write_mesh(PLY_BINARY, path);
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    long bytes = ftell(file);
    const uint32_t wrong = VERTICES;
    fseek(file, bytes - 4, SEEK_SET); /* the last edge */
    fwrite(&wrong, sizeof wrong, 1, file);
    fclose(file);
    for (uint32_t i = 0; i < 2; i++) {
        char expected[128];
        snprintf(expected, sizeof expected, ": byte %ld: edge %u: %u is not a vertex",
                 bytes, EDGES - 1, VERTICES);
        assert_int_equal(ctl_mesh_read_as(path,
                                          &(struct ctl_reading){.number = i, .count = 2},
                                          &piece, &error),
                         PCCD_E_INDEX);
        assert_non_null(strstr(error.text, expected));
    }
    assert_int_equal(truncate(path, bytes - 6), 0);
    assert_int_equal(ctl_mesh_read_as(path,
                                      &(struct ctl_reading){.number = 0, .count = 2},
                                      &piece, &error),
                     PCCD_E_FORMAT);
    write_mesh(PLY_TEXT, path);
    file = fopen(path, "r+b");
    assert_non_null(file);
    fseek(file, 3 << 19, SEEK_SET);
    fputc(0, file);
    fclose(file);
    assert_int_equal(ctl_mesh_read_as(path,
                                      &(struct ctl_reading){.number = 0, .count = 2},
                                      &piece, &error),
                     PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, ": byte 1572864 is zero, which no text has"));
}

CASES_WITH(kit_make_folder, kit_remove_folder);
