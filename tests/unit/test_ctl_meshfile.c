/* tests/unit/test_ctl_meshfile.c - the readers of PLY and OBJ.
 *
 * Room:     client/ctl (meshfile.h).
 * Does:     every encoding gives the same mesh; every malformed file gives its own
 *           message.
 * Does not: need a daemon.
 * Threads:  one.
 * Source:   client/ctl/meshfile.h.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "meshfile.h"

#define PATH_BYTES     256
#define FILE_BYTES_MAX 4096

static char folder[] = "/tmp/pccd-meshfile-XXXXXX";

/* The mesh that every file below describes: a pyramid whose base is one face of four
 * corners. The coordinates are exact in a float and in 16 bits. */
#define VERTICES  5
#define TRIANGLES 6
static const double expected_x[VERTICES][3] = {
    {-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 300, 0}};
static const uint32_t expected_triangles[TRIANGLES][3] = {
    {0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}};
/* The faces as they stand in the files: a count, then vertices. */
static const int faces[] = {4, 0, 1, 2, 3, 3, 0, 4, 1, 3, 1,
                            4, 2, 3, 2, 4, 3, 3, 3, 4, 0};
#define FACES 5

/* A file being made. */
struct bytes {
    char data[FILE_BYTES_MAX];
    size_t count;
};

static void put_text(struct bytes *bytes, const char *text)
{
    size_t length = strlen(text);
    assert_true(bytes->count + length <= FILE_BYTES_MAX);
    memcpy(bytes->data + bytes->count, text, length);
    bytes->count += length;
}

/* A PLY type by its name: its bits in the wanted byte order. */
static void put_value(struct bytes *bytes, const char *type, bool is_big, double value)
{
    uint8_t raw[8];
    size_t size;
    float narrow = (float)value;
    int64_t whole = (int64_t)value;
    if (strcmp(type, "float") == 0) {
        size = 4;
        memcpy(raw, &narrow, size);
    } else if (strcmp(type, "double") == 0) {
        size = 8;
        memcpy(raw, &value, size);
    } else {
        size = strstr(type, "char") != NULL ? 1 : strstr(type, "short") != NULL ? 2 : 4;
        memcpy(raw, &whole, size); /* little-endian: the low bytes come first */
    }
    assert_true(bytes->count + size <= FILE_BYTES_MAX);
    for (size_t i = 0; i < size; i++)
        bytes->data[bytes->count++] = (char)raw[is_big ? size - 1 - i : i];
}

/* How one file differs from the others. */
struct variant {
    const char *encoding;
    const char *coordinate, *count, *index; /* types */
    bool has_extras;                        /* properties and an element to be skipped */
    enum pccd_format format;                /* what the mesh must be */
};

static void put(struct bytes *bytes, const struct variant *variant, const char *type,
                double value)
{
    char text[64];
    if (strcmp(variant->encoding, "ascii") == 0) {
        snprintf(text, sizeof(text), "%.17g ", value);
        put_text(bytes, text);
    } else {
        put_value(bytes, type, strcmp(variant->encoding, "binary_big_endian") == 0,
                  value);
    }
}

static void end_row(struct bytes *bytes, const struct variant *variant)
{
    if (strcmp(variant->encoding, "ascii") == 0)
        put_text(bytes, "\n");
}

static void put_header(struct bytes *bytes, const struct variant *variant)
{
    char text[1024];
    const char *extra_element =
        variant->has_extras ? "element material 2\nproperty list uchar short tag\n"
                              "property double shine\n"
                            : "";
    const char *extra_vertex =
        variant->has_extras ? "property uchar red\nproperty list ushort float weights\n"
                            : "";
    const char *extra_face = variant->has_extras ? "property int group\n" : "";
    snprintf(text, sizeof(text),
             "ply\nformat %s 1.0\ncomment a pyramid\n%selement vertex %d\n%s"
             "property %s x\nproperty %s y\nproperty %s z\nelement face %d\n"
             "property list %s %s vertex_indices\n%send_header\n",
             variant->encoding, extra_element, VERTICES, extra_vertex,
             variant->coordinate, variant->coordinate, variant->coordinate, FACES,
             variant->count, variant->index, extra_face);
    put_text(bytes, text);
}

static void make_ply(struct bytes *bytes, const struct variant *variant)
{
    const int *face = faces;
    bytes->count = 0;
    put_header(bytes, variant);
    for (int row = 0; row < 2 && variant->has_extras; row++) {
        put(bytes, variant, "uchar", row);
        for (int i = 0; i < row; i++)
            put(bytes, variant, "short", 7);
        put(bytes, variant, "double", 0.25);
        end_row(bytes, variant);
    }
    for (int v = 0; v < VERTICES; v++) {
        if (variant->has_extras) {
            put(bytes, variant, "uchar", 200);
            put(bytes, variant, "ushort", 2);
            put(bytes, variant, "float", 0.5);
            put(bytes, variant, "float", 0.5);
        }
        for (int k = 0; k < 3; k++)
            put(bytes, variant, variant->coordinate, expected_x[v][k]);
        end_row(bytes, variant);
    }
    for (int f = 0; f < FACES; f++) {
        int corners = *face++;
        put(bytes, variant, variant->count, corners);
        for (int k = 0; k < corners; k++)
            put(bytes, variant, variant->index, *face++);
        if (variant->has_extras)
            put(bytes, variant, "int", -3);
        end_row(bytes, variant);
    }
}

static void write_file(const char *name, const void *data, size_t bytes, char *path)
{
    snprintf(path, PATH_BYTES, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, bytes, file), bytes);
    assert_int_equal(fclose(file), 0);
}

static void check_pyramid(const struct ctl_mesh *mesh, enum pccd_format format)
{
    assert_int_equal(mesh->format, format);
    assert_int_equal(mesh->vertex_count, VERTICES);
    assert_int_equal(mesh->triangle_count, TRIANGLES);
    for (int i = 0; i < VERTICES * 3; i++) {
        double x = format == PCCD_FORMAT_F32 ? (double)((const float *)mesh->x)[i]
                                             : ((const double *)mesh->x)[i];
        assert_true(x == expected_x[i / 3][i % 3]);
    }
    assert_memory_equal(mesh->triangles, expected_triangles, sizeof(expected_triangles));
}

static const struct variant variants[] = {
    {"ascii", "float", "uchar", "int", false, PCCD_FORMAT_F32},
    {"ascii", "double", "uchar", "int", false, PCCD_FORMAT_F64},
    {"ascii", "double", "int", "uint", true, PCCD_FORMAT_F64},
    {"binary_little_endian", "float", "uchar", "int", false, PCCD_FORMAT_F32},
    {"binary_little_endian", "double", "uchar", "uint", true, PCCD_FORMAT_F64},
    {"binary_little_endian", "short", "char", "uchar", false, PCCD_FORMAT_F32},
    {"binary_little_endian", "int", "int", "short", true, PCCD_FORMAT_F64},
    {"binary_little_endian", "float", "float", "double", false, PCCD_FORMAT_F32},
    {"binary_big_endian", "float", "uchar", "int", true, PCCD_FORMAT_F32},
    {"binary_big_endian", "double", "uint", "ushort", false, PCCD_FORMAT_F64},
    {"binary_big_endian", "short", "short", "char", true, PCCD_FORMAT_F32},
};

/* If it failed: a file's encoding would change the mesh that is checked. */
static void meshfile__reads_every_ply_encoding_the_same(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof(variants) / sizeof(variants[0]); i++) {
        static struct bytes bytes;
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        char path[PATH_BYTES];
        make_ply(&bytes, &variants[i]);
        write_file("pyramid.ply", bytes.data, bytes.count, path);
        int status = ctl_mesh_read(path, &mesh, &error);
        if (status != PCCD_OK)
            fail_msg("variant %zu: %s", i, error.text);
        check_pyramid(&mesh, variants[i].format);
        ctl_mesh_deinit(&mesh);
    }
}

/* If it failed: OBJ frames would lose the correspondence with their PLY form. */
static void meshfile__reads_every_obj_form_the_same(void **state)
{
    static const char vertices[] = "v -1 0 -1\nv 1 0 -1 1.0\nv 1 0 1 0.5 0.5 0.5\n"
                                   "v -1.0 0e0 1 # a corner\n  v 0 300 0\n";
    static const char *const rests[] = {
        "f 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n",
        "f -5 -4 -3 -2\nf -5 -1 -4\nf -4 -1 -3\nf -3 -1 -2\nf -2 -1 -5",
        "vt 0 0\nvn 0 1 0\ng side\nusemtl red\ns off\nf 1/1 2/1 3/1 4/1\nf 1//1 5//1 "
        "2//1\n"
        "f 2/1/1 5/1/1 3/1/1\n\no other\r\nf 3 5 4\r\nf 4 5 1\r\n",
        "f 1 2 \\\n3 4\nf 1 5 2\n# f 9 9 9\nf 2 5 3\nf 3 5\\\n 4\nf 4 5 1 \\\n",
    };
    (void)state;
    for (size_t i = 0; i < sizeof(rests) / sizeof(rests[0]); i++) {
        static struct bytes bytes;
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        char path[PATH_BYTES];
        bytes.count = 0;
        put_text(&bytes, vertices);
        put_text(&bytes, rests[i]);
        write_file("pyramid.OBJ", bytes.data, bytes.count, path);
        int status = ctl_mesh_read(path, &mesh, &error);
        if (status != PCCD_OK)
            fail_msg("form %zu: %s", i, error.text);
        check_pyramid(&mesh, PCCD_FORMAT_F64);
        ctl_mesh_deinit(&mesh);
    }
}

/* If it failed: a decimal fraction of a float file would be rounded twice or kept wide.
 */
static void meshfile__rounds_ascii_floats_once(void **state)
{
    static const char text[] =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_index\nend_header\n"
        "0.1 1e-3 16777217\n0 0 0\n1 1 1\n3 0 1 2";
    struct ctl_mesh mesh = {0};
    struct ctl_error error = {.text = ""};
    char path[PATH_BYTES];
    (void)state;
    write_file("floats.ply", text, sizeof(text) - 1, path);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_OK);
    const float *x = mesh.x;
    assert_true(x[0] == 0.1f);
    assert_true(x[1] == 1e-3f);
    assert_true(x[2] == 16777216.0f);
    assert_int_equal(ctl_mesh_promote(&mesh, &error), PCCD_OK);
    const double *wide = mesh.x;
    assert_true(wide[0] == (double)0.1f);
    assert_int_equal(mesh.format, PCCD_FORMAT_F64);
    ctl_mesh_deinit(&mesh);
}

/* A malformed file: what stands in it, and what the message must say. */
struct malformed {
    const char *text;
    size_t bytes; /* 0: strlen */
    int status;
    const char *message; /* after the path */
};

static void check_malformed(const struct malformed *cases, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++) {
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        char path[PATH_BYTES];
        size_t bytes = cases[i].bytes != 0 ? cases[i].bytes : strlen(cases[i].text);
        write_file(name, cases[i].text, bytes, path);
        int status = ctl_mesh_read(path, &mesh, &error);
        assert_null(mesh.x);
        assert_null(mesh.triangles);
        if (status != cases[i].status || strncmp(error.text, path, strlen(path)) != 0 ||
            strcmp(error.text + strlen(path), cases[i].message) != 0)
            fail_msg("case %zu: status %d, \"%s\" where %d, \"%s%s\" is due", i, status,
                     error.text, cases[i].status, path, cases[i].message);
    }
}

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define XYZ          "property float x\nproperty float y\nproperty float z\n"
#define LIST         "property list uchar int vertex_indices\n"
#define START        "ply\nformat ascii 1.0\nelement vertex 3\n"
#define HEAD         START XYZ "element face 1\n" LIST
#define BODY(text)   HEAD "end_header\n" text

/* If it failed: a broken header would be guessed at, or its message would not help. */
static void meshfile__names_what_is_wrong_in_a_ply_header(void **state)
{
    static const struct malformed cases[] = {
        {"", 0, PCCD_E_FORMAT, ": the file is empty"},
        {"plx\n", 0, PCCD_E_FORMAT, ":1: the first line is not \"ply\""},
        {"ply\n", 0, PCCD_E_FORMAT, ":1: the file ends inside the header"},
        {"ply\nformat ascii 1.0\n", 0, PCCD_E_FORMAT,
         ":2: the file ends inside the header"},
        {"ply\n\n", 0, PCCD_E_FORMAT, ":2: blank line in the header"},
        {"ply\nformat ascii\n", 0, PCCD_E_FORMAT,
         ":2: format without an encoding and a version"},
        {"ply\nformat ascii 2.0\n", 0, PCCD_E_FORMAT,
         ":2: version \"2.0\" where 1.0 is known"},
        {"ply\nformat text 1.0\n", 0, PCCD_E_FORMAT, ":2: unknown encoding \"text\""},
        {"ply\nformat ascii 1.0\nformat ascii 1.0\n", 0, PCCD_E_FORMAT,
         ":3: a second format line"},
        {"ply\nelephant\n", 0, PCCD_E_FORMAT, ":2: unknown header line \"elephant\""},
        {"ply\nelement vertex\n", 0, PCCD_E_FORMAT,
         ":2: element without a name and a count"},
        {"ply\nelement vertex -1\n", 0, PCCD_E_FORMAT, ":2: \"-1\" is not a count"},
        {"ply\nelement vertex 3x\n", 0, PCCD_E_FORMAT, ":2: \"3x\" is not a count"},
        {"ply\nelement vertex 99999999999999999999\n", 0, PCCD_E_FORMAT,
         ":2: \"99999999999999999999\" is not a count"},
        {"ply\nelement vertex 3 4\n", 0, PCCD_E_FORMAT,
         ":2: \"4\" is too much on a header line"},
        {"ply\nproperty float x\n", 0, PCCD_E_FORMAT, ":2: property before any element"},
        {"ply\nelement vertex 3\nproperty\n", 0, PCCD_E_FORMAT,
         ":3: property without a type"},
        {"ply\nelement vertex 3\nproperty half x\n", 0, PCCD_E_FORMAT,
         ":3: unknown type \"half\""},
        {"ply\nelement vertex 3\nproperty float\n", 0, PCCD_E_FORMAT,
         ":3: property without a name"},
        {"ply\nelement face 3\nproperty list uchar\n", 0, PCCD_E_FORMAT,
         ":3: property without a type"},
        {"ply\nelement vertex 0\nelement face 0\nend_header\n", 0, PCCD_E_FORMAT,
         ":4: the header has no format line"},
        {"ply\nformat ascii 1.0\nelement face 1\n" LIST "end_header\n", 0, PCCD_E_FORMAT,
         ":5: the header has no element \"vertex\""},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n", 0, PCCD_E_FORMAT,
         ":7: the header has no element \"face\""},
        {HEAD "element vertex 3\nend_header\n", 0, PCCD_E_FORMAT,
         ":10: two elements \"vertex\""},
        {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float z\n"
         "element face 1\n" LIST "end_header\n",
         0, PCCD_E_FORMAT, ":8: element \"vertex\" has no property \"y\""},
        {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
         "property list int float y\nproperty float z\nelement face 1\n" LIST
         "end_header\n",
         0, PCCD_E_FORMAT, ":9: property \"y\" of \"vertex\" is a list"},
        {"ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 1\n"
         "property int vertex_indices\nend_header\n",
         0, PCCD_E_FORMAT,
         ":9: element \"face\" has no list \"vertex_indices\" or \"vertex_index\""},
        {HEAD "element hole 2\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 0,
         PCCD_E_FORMAT, ":10: element \"hole\" has no properties"},
        {"ply\nformat ascii 1.0\nelement vertex 4000000000000000000\n" XYZ
         "element face 1\n" LIST "end_header\n0 0 0\n",
         0, PCCD_E_FORMAT,
         ":9: 4000000000000000000 rows of element \"vertex\" are announced, but the file "
         "ends before"},
        {"ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ
         "element face 3000000000\n" LIST "end_header\n123456789012",
         0, PCCD_E_FORMAT,
         ":9: 3000000000 rows of element \"face\" are announced, but the file ends "
         "before"},
    };
    (void)state;
    check_malformed(cases, COUNT(cases), "bad.ply");
}

/* If it failed: an empty mesh would be registered. */
static void meshfile__refuses_a_ply_without_vertices_or_faces(void **state)
{
    static const struct malformed cases[] = {
        {"ply\nformat ascii 1.0\nelement vertex 0\n" XYZ "element face 0\n" LIST
         "end_header\n",
         0, PCCD_E_FORMAT, ": no vertices"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 0\n" LIST
         "end_header\n0 0 0\n",
         0, PCCD_E_FORMAT, ": no faces"},
    };
    (void)state;
    check_malformed(cases, COUNT(cases), "bad.ply");
}

/* If it failed: a broken row would shift everything behind it. */
static void meshfile__names_what_is_wrong_in_an_ascii_ply(void **state)
{
    static const struct malformed cases[] = {
        {BODY("0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":11: vertex 1: a value is missing at the end of the line"},
        {BODY("0 0 0\n1 0 0 5\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":11: vertex 1: \"5\" is too much on the line"},
        {BODY("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":11: vertex 1: \"zero\" is not a number"},
        {BODY("0 0 0\n1 0.5.5 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":11: vertex 1: \"0.5.5\" is not a number"},
        {BODY("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_NOTFINITE,
         ":11: vertex 1: coordinate y is nan; |x| <= 1e18 is needed"},
        {BODY("0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_NOTFINITE,
         ":11: vertex 1: coordinate z is -inf; |x| <= 1e18 is needed"},
        {BODY("0 0 0\n2e18 0 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_NOTFINITE,
         ":11: vertex 1: coordinate x is 2e+18; |x| <= 1e18 is needed"},
        {BODY("0 0 0\n1 0 0\n\n0 1 0\n3 0 1 3\n"), 0, PCCD_E_INDEX,
         ":14: face 0: 3 is not a vertex number (there are 3 vertices)"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), 0, PCCD_E_INDEX,
         ":13: face 0: -1 is not a vertex number (there are 3 vertices)"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"), 0, PCCD_E_FORMAT,
         ":13: face 0: \"1.5\" is not a whole number"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n2 0 1    \n"), 0, PCCD_E_FORMAT,
         ":13: face 0: 2 vertices where a face needs at least 3"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":13: face 0: -3 is not a possible list length"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":13: face 0: 4000000000 is not a possible list length"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"), 0, PCCD_E_FORMAT,
         ":13: face 0: a value is missing at the end of the line"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\nmore\n"), 0, PCCD_E_FORMAT,
         ":15: \"more\" after the last element"},
        {BODY("00000 00000\n1 0 0\n0 1 0\n"), 0, PCCD_E_FORMAT,
         ":10: vertex 0: a value is missing at the end of the line"},
        {BODY("0.000000000 0 0\n1 0 0\n0 1 0\n"), 0, PCCD_E_FORMAT,
         ":12: face 0: the file ends here"},
    };
    (void)state;
    check_malformed(cases, COUNT(cases), "bad.ply");
}

#define BINARY                                                                           \
    "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ "element face 1\n"    \
    "property list int int vertex_index\nend_header\n"
#define ORIGIN "\0\0\0\0\0\0\0\0\0\0\0\0"
#define BINARY_CASE(body, status, message)                                               \
    {                                                                                    \
        BINARY body, sizeof(BINARY body) - 1, status, message                            \
    }

/* If it failed: a broken binary file would be read past its end, or its place not be
 * told. The header takes 165 bytes. */
static void meshfile__names_what_is_wrong_in_a_binary_ply(void **state)
{
    static const struct malformed cases[] = {
        BINARY_CASE(ORIGIN "\2\0\0\0\0\0\0\0\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 181: face 0: 2 vertices where a face needs at least 3"),
        BINARY_CASE(ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 189: face 0: the file ends here"),
        BINARY_CASE(
            ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0", PCCD_E_INDEX,
            ": byte 193: face 0: 1 is not a vertex number (there are 1 vertices)"),
        BINARY_CASE(
            ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0\377\377\377\377", PCCD_E_INDEX,
            ": byte 193: face 0: -1 is not a vertex number (there are 1 vertices)"),
        BINARY_CASE(ORIGIN "\377\377\377\177\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 181: face 0: 2147483647 is not a possible list length"),
        BINARY_CASE(ORIGIN "\377\377\377\377\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 181: face 0: -1 is not a possible list length"),
        BINARY_CASE(ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\n", PCCD_E_FORMAT,
                    ": byte 193: 1 bytes after the last element"),
        BINARY_CASE("\0\0\0\0\0\0\300\177\0\0\0\0\3\0\0\0", PCCD_E_NOTFINITE,
                    ": byte 173: vertex 0: coordinate y is nan; |x| <= 1e18 is needed"),
    };
    (void)state;
    assert_int_equal(sizeof(BINARY) - 1, 165);
    check_malformed(cases, COUNT(cases), "bad.ply");
}

/* If it failed: a broken OBJ file would be read as another mesh. */
static void meshfile__names_what_is_wrong_in_an_obj(void **state)
{
    static const struct malformed cases[] = {
        {"f 1 2 3\n", 0, PCCD_E_FORMAT, ": no vertices"},
        {"v 0 0 0\n", 0, PCCD_E_FORMAT, ": no faces"},
        {"v 0 0\n", 0, PCCD_E_FORMAT, ":1: a vertex of 2 numbers"},
        {"v 0 0 0 0 0\n", 0, PCCD_E_FORMAT, ":1: a vertex of 5 numbers"},
        {"v 0 0 0 0 0 0 0 0\n", 0, PCCD_E_FORMAT, ":1: more than 7 numbers in a vertex"},
        {"v 0 0 x\n", 0, PCCD_E_FORMAT, ":1: \"x\" is not a number"},
        {"v 0 0 0\nv 0 nan 0\n", 0, PCCD_E_NOTFINITE,
         ":2: vertex 2: coordinate y is nan; |x| <= 1e18 is needed"},
        {"v 0 0 0\nv 0 0 1e19\n", 0, PCCD_E_NOTFINITE,
         ":2: vertex 2: coordinate z is 1e+19; |x| <= 1e18 is needed"},
        {"v 0 0 0\nf 1 1\n", 0, PCCD_E_FORMAT,
         ":2: 2 vertices where a face needs at least 3"},
        {"v 0 0 0\nf 1 1 2\n", 0, PCCD_E_INDEX,
         ":2: 2 is not a vertex number (1 vertices so far, 1 in the file)"},
        {"v 0 0 0\nf 1 1 0\n", 0, PCCD_E_INDEX,
         ":2: 0 is not a vertex number (1 vertices so far, 1 in the file)"},
        {"v 0 0 0\nf -1 -1 -2\nv 1 1 1\n", 0, PCCD_E_INDEX,
         ":2: -2 is not a vertex number (1 vertices so far, 2 in the file)"},
        {"v 0 0 0\nf 1 /1 1\n", 0, PCCD_E_FORMAT, ":2: \"/1\" is not a face corner"},
        {"v 0 0 0\nf 1 1 1.5\n", 0, PCCD_E_FORMAT, ":2: \"1.5\" is not a face corner"},
        {"v 0 0 0\nsolid\n", 0, PCCD_E_FORMAT, ":2: unknown statement \"solid\""},
        {"v 0 0 0\n\\\nv 1 1 1\n", 0, PCCD_E_FORMAT,
         ":2: a vertex that begins on a continued line"},
    };
    (void)state;
    check_malformed(cases, COUNT(cases), "bad.obj");
}

/* If it failed: a file cut anywhere could be taken for a whole one, or read past its end.
 */
static void meshfile__refuses_a_binary_ply_cut_at_any_byte(void **state)
{
    static struct bytes bytes;
    const struct variant variant = {"binary_big_endian", "double", "uchar", "int", true,
                                    PCCD_FORMAT_F64};
    (void)state;
    make_ply(&bytes, &variant);
    for (size_t count = 0; count < bytes.count; count++) {
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        char path[PATH_BYTES];
        write_file("cut.ply", bytes.data, count, path);
        assert_int_not_equal(ctl_mesh_read(path, &mesh, &error), PCCD_OK);
        assert_string_not_equal(error.text, "");
    }
}

/* If it failed: the caller could not tell a missing file from a bad one. */
static void meshfile__tells_files_it_cannot_read(void **state)
{
    struct ctl_mesh mesh = {0};
    struct ctl_error error = {.text = ""};
    char path[PATH_BYTES];
    (void)state;
    snprintf(path, sizeof(path), "%s/absent.ply", folder);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_SYSTEM);
    assert_non_null(strstr(error.text, "cannot open: No such file or directory"));
    assert_int_equal(ctl_mesh_read(folder, &mesh, &error), PCCD_E_SYSTEM);
    assert_non_null(strstr(error.text, "cannot read: Is a directory"));
    write_file("mesh.stl", "solid\n", 6, path);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_FORMAT);
    assert_non_null(
        strstr(error.text, "neither PLY (first line \"ply\") nor a name ending"));
}

/* If it failed: two frames of different meshes would be checked against each other. */
static void meshfile__match_names_the_first_difference(void **state)
{
    uint32_t a_triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    uint32_t b_triangles[2][3] = {{0, 1, 2}, {0, 3, 2}};
    struct ctl_mesh a = {
        .vertex_count = 4, .triangle_count = 2, .triangles = a_triangles};
    struct ctl_mesh b = {
        .vertex_count = 4, .triangle_count = 2, .triangles = b_triangles};
    struct ctl_error error = {.text = ""};
    (void)state;
    assert_int_equal(ctl_mesh_match(&a, "a", &a, "b", &error), PCCD_OK);
    assert_int_equal(ctl_mesh_match(&a, "a", &b, "b", &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "triangle 1 is (0 2 3) in a and (0 3 2) in b: not two "
                        "frames of one mesh");
    b.triangle_count = 1;
    assert_int_equal(ctl_mesh_match(&a, "a", &b, "b", &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "a has 2 triangles and b has 1: not two frames of one mesh");
    b.vertex_count = 5;
    assert_int_equal(ctl_mesh_match(&a, "a", &b, "b", &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "a has 4 vertices and b has 5: not two frames of one mesh");
}

/* If it failed: the real scenes would not be read as their description says. */
static void meshfile__reads_the_real_frames(void **state)
{
    static const struct {
        const char *name;
        enum pccd_format format;
        uint32_t vertices, triangles;
    } frames[] = {
        {"cloth-ball/frames/cloth_ball92.ply", PCCD_FORMAT_F32, 46598, 92230},
        {"cloth-funnel/frames/227.ply", PCCD_FORMAT_F64, 9450, 18484},
        {"n-body-simulation/frames/balls16_18.ply", PCCD_FORMAT_F32, 73960, 146480},
    };
    const char *data = getenv("PCCD_DATA");
    char path[4096];
    (void)state;
    for (size_t i = 0; i < COUNT(frames); i++) {
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        snprintf(path, sizeof(path), "%s/%s", data != NULL ? data : "../shared/data",
                 frames[i].name);
        if (access(path, R_OK) != 0)
            skip();
        if (ctl_mesh_read(path, &mesh, &error) != PCCD_OK)
            fail_msg("%s", error.text);
        assert_int_equal(mesh.format, frames[i].format);
        assert_int_equal(mesh.vertex_count, frames[i].vertices);
        assert_int_equal(mesh.triangle_count, frames[i].triangles);
        ctl_mesh_deinit(&mesh);
    }
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) != NULL ? 0 : -1;
}

static int remove_folder(void **state)
{
    static const char *const names[] = {"pyramid.ply", "pyramid.OBJ", "floats.ply",
                                        "bad.ply",     "bad.obj",     "cut.ply",
                                        "mesh.stl"};
    (void)state;
    for (size_t i = 0; i < COUNT(names); i++) {
        char path[PATH_BYTES];
        snprintf(path, sizeof(path), "%s/%s", folder, names[i]);
        unlink(path);
    }
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshfile__reads_every_ply_encoding_the_same),
        cmocka_unit_test(meshfile__reads_every_obj_form_the_same),
        cmocka_unit_test(meshfile__rounds_ascii_floats_once),
        cmocka_unit_test(meshfile__names_what_is_wrong_in_a_ply_header),
        cmocka_unit_test(meshfile__refuses_a_ply_without_vertices_or_faces),
        cmocka_unit_test(meshfile__names_what_is_wrong_in_an_ascii_ply),
        cmocka_unit_test(meshfile__names_what_is_wrong_in_a_binary_ply),
        cmocka_unit_test(meshfile__names_what_is_wrong_in_an_obj),
        cmocka_unit_test(meshfile__refuses_a_binary_ply_cut_at_any_byte),
        cmocka_unit_test(meshfile__tells_files_it_cannot_read),
        cmocka_unit_test(meshfile__match_names_the_first_difference),
        cmocka_unit_test(meshfile__reads_the_real_frames),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
