/* test_ctl_malformed.c - the readers of PLY and OBJ, and broken files. */
#include <time.h>
#include <unistd.h>

#include "ctl_kit.h"
#include "meshfile.h"

/* A malformed file: what stands in it, and what the message must say. */
struct malformed {
    const char *text;
    size_t bytes; /* 0: strlen */
    int status;
    const char *message; /* after the path */
};

/* A text that is refused for its form, with that message. */
#define BAD(text, message)                                                               \
    {                                                                                    \
        text, 0, PCCD_E_FORMAT, message                                                  \
    }

/* As large the files are made, with a hole at the end; 0: as their text. */
static off_t large_bytes;

static void check_malformed(const struct malformed *cases, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++) {
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        char path[KIT_PATH_BYTES];
        size_t bytes = cases[i].bytes != 0 ? cases[i].bytes : strlen(cases[i].text);
        kit_write_file(name, cases[i].text, bytes, path);
        if (large_bytes > 0 && truncate(path, large_bytes) != 0) {
            test_skip("no file system here has such large files");
        }
        int status = ctl_mesh_read(path, &mesh, &error);
        assert_null(mesh.x);
        assert_null(mesh.triangles.vertices);
        if (status != cases[i].status || strncmp(error.text, path, strlen(path)) != 0 ||
            strcmp(error.text + strlen(path), cases[i].message) != 0) {
            fail_msg("case %zu: status %d, \"%s\" where %d, \"%s%s\" is due", i, status,
                     error.text, cases[i].status, path, cases[i].message);
        }
    }
}

#define XYZ        "property float x\nproperty float y\nproperty float z\n"
#define LIST       "property list uchar int vertex_indices\n"
#define START      "ply\nformat ascii 1.0\nelement vertex 3\n"
#define HEAD       START XYZ "element face 1\n" LIST
#define BODY(text) HEAD "end_header\n" text

/* If it failed: a broken header would be guessed at, or its message would not help. */
CASE(malformed__names_what_is_wrong_in_a_ply_header)
{
    static const struct malformed cases[] = {
        BAD("", ": the file is empty"),
        BAD("plx\n", ":1: the first line is not \"ply\""),
        BAD("ply\n", ":1: the file ends inside the header"),
        BAD("ply\nformat ascii 1.0\n", ":2: the file ends inside the header"),
        BAD("ply\n\n", ":2: blank line in the header"),
        BAD("ply\nformat ascii\n", ":2: format without an encoding and a version"),
        BAD("ply\nformat ascii 2.0\n", ":2: version \"2.0\" where 1.0 is known"),
        BAD("ply\nformat text 1.0\n", ":2: unknown encoding \"text\""),
        BAD("ply\nformat ascii 1.0\nformat ascii 1.0\n", ":3: a second format line"),
        BAD("ply\nelephant\n", ":2: unknown header line \"elephant\""),
        BAD("ply\nelement vertex\n", ":2: element without a name and a count"),
        BAD("ply\nelement vertex -1\n", ":2: \"-1\" is not a count"),
        BAD("ply\nelement vertex 3x\n", ":2: \"3x\" is not a count"),
        BAD("ply\nelement vertex 99999999999999999999\n",
            ":2: \"99999999999999999999\" is not a count"),
        BAD("ply\nelement vertex 3 4\n", ":2: \"4\" is too much on a header line"),
        BAD("ply\nproperty float x\n", ":2: property before any element"),
        BAD("ply\nelement vertex 3\nproperty\n", ":3: property without a type"),
        BAD("ply\nelement vertex 3\nproperty half x\n", ":3: unknown type \"half\""),
        BAD("ply\nelement vertex 3\nproperty float\n", ":3: property without a name"),
        BAD("ply\nelement face 3\nproperty list uchar\n", ":3: property without a type"),
        BAD("ply\nelement vertex 0\nelement face 0\nend_header\n",
            ":4: the header has no format line"),
        BAD("ply\nformat ascii 1.0\nelement face 1\n" LIST "end_header\n",
            ":5: the header has no element \"vertex\""),
        BAD("ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
            "element edge 1\nproperty int vertex1\nend_header\n0 0 0\n0\n",
            ":9: element \"edge\" has no property \"vertex2\""),
        BAD(HEAD "element vertex 3\nend_header\n", ":10: two elements \"vertex\""),
        BAD("ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "property double x\n",
            ":7: two properties \"x\" of \"vertex\""),
        BAD("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
            "z\n"
            "element face 1\n" LIST "end_header\n",
            ":8: element \"vertex\" has no property \"y\""),
        BAD("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
            "property list int float y\nproperty float z\nelement face 1\n" LIST
            "end_header\n",
            ":9: property \"y\" of \"vertex\" is a list"),
        BAD("ply\nformat ascii 1.0\nelement vertex 3\n" XYZ "element face 1\n"
            "property int vertex_indices\nend_header\n",
            ":9: element \"face\" has no list \"vertex_indices\" or \"vertex_index\""),
        BAD(HEAD "element hole 2\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
            ":10: element \"hole\" has no properties"),
        BAD("ply\nformat ascii 1.0\nelement vertex 4000000000000000000\n" XYZ
            "element face 1\n" LIST "end_header\n0 0 0\n",
            ":9: 4000000000000000000 rows of element \"vertex\" take "
            "18446744073709551615 "
            "bytes or more, and 6 of the file are left"),
        BAD("ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ
            "element face 3000000000\n" LIST "end_header\n123456789012",
            ":9: 3000000000 rows of element \"face\" take 3000000000 bytes or more, and "
            "0 "
            "of "
            "the file are left"),
    };
    check_malformed(cases, KIT_COUNT(cases), "bad.ply");
}

/* If it failed: an empty mesh would be registered. */
CASE(malformed__refuses_a_ply_without_vertices_or_faces)
{
    static const struct malformed cases[] = {
        BAD("ply\nformat ascii 1.0\nelement vertex 0\n" XYZ "element face 0\n" LIST
            "end_header\n",
            ": no vertices"),
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
         "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
         "0 0 0\n0 1\n",
         0, PCCD_E_INDEX, ":12: edge 0: 1 is not a vertex number (1 vertex is there)"},
    };
    check_malformed(cases, KIT_COUNT(cases), "bad.ply");
}

/* If it failed: a broken row would shift everything behind it. */
CASE(malformed__names_what_is_wrong_in_an_ascii_ply)
{
    static const struct malformed cases[] = {
        BAD(BODY("0 0 0\n1 0\n0 1 0\n3 0 1 2\n"),
            ":11: vertex 1: a value is missing at the end of the line"),
        BAD(BODY("0 0 0\n1 0 0 5\n0 1 0\n3 0 1 2\n"),
            ":11: vertex 1: \"5\" is too much on the line"),
        BAD(BODY("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"),
            ":11: vertex 1: \"zero\" is not a number"),
        BAD(BODY("0 0 0\n1 0.5.5 0\n0 1 0\n3 0 1 2\n"),
            ":11: vertex 1: \"0.5.5\" is not a number"),
        BAD(BODY("0 0 0\n1 0x10 0\n0 1 0\n3 0 1 2\n"),
            ":11: vertex 1: \"0x10\" is not a number"),
        {BODY("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_NOTFINITE,
         ":11: vertex 1: coordinate y is nan; |x| <= 1e18 is needed"},
        {BODY("0 0 0\n1 0 -inf\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_NOTFINITE,
         ":11: vertex 1: coordinate z is -inf; |x| <= 1e18 is needed"},
        {BODY("0 0 0\n2e18 0 0\n0 1 0\n3 0 1 2\n"), 0, PCCD_E_NOTFINITE,
         ":11: vertex 1: coordinate x is 2e+18; |x| <= 1e18 is needed"},
        {BODY("0 0 0\n1 0 0\n\n0 1 0\n3 0 1 3\n"), 0, PCCD_E_INDEX,
         ":14: face 0: 3 is not a vertex number (3 vertices are there)"},
        {BODY("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), 0, PCCD_E_INDEX,
         ":13: face 0: -1 is not a vertex number (3 vertices are there)"},
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"),
            ":13: face 0: \"1.5\" is not a whole number"),
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n2 0 1    \n"),
            ":13: face 0: 2 vertices where a face needs at least 3"),
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"),
            ":13: face 0: -3 is no uchar"),
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"),
            ":13: face 0: 4000000000 is no uchar"),
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n256 0 1 2\n"), ":13: face 0: 256 is no uchar"),
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"),
            ":13: face 0: a value is missing at the end of the line"),
        BAD(BODY("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\nmore\n"),
            ":15: \"more\" after the last element"),
        BAD(BODY("00000 00000\n1 0 0\n0 1 0\n"),
            ":10: vertex 0: a value is missing at the end of the line"),
        BAD(BODY("0.000000000 0 0\n1 0 0\n0 1 0\n"), ":12: face 0: the file ends here"),
    };
    check_malformed(cases, KIT_COUNT(cases), "bad.ply");
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
CASE(malformed__names_what_is_wrong_in_a_binary_ply)
{
    static const struct malformed cases[] = {
        BINARY_CASE(ORIGIN "\2\0\0\0\0\0\0\0\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 181: face 0: 2 vertices where a face needs at least 3"),
        BINARY_CASE(ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 189: face 0: the file ends here"),
        BINARY_CASE(ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0\1\0\0\0", PCCD_E_INDEX,
                    ": byte 193: face 0: 1 is not a vertex number (1 vertex is there)"),
        BINARY_CASE(ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0\377\377\377\377", PCCD_E_INDEX,
                    ": byte 193: face 0: -1 is not a vertex number (1 vertex is there)"),
        BINARY_CASE(ORIGIN "\377\377\377\177\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 181: face 0: 2147483647 is not a possible list length"),
        BINARY_CASE(ORIGIN "\377\377\377\377\0\0\0\0", PCCD_E_FORMAT,
                    ": byte 181: face 0: -1 is not a possible list length"),
        BINARY_CASE(ORIGIN "\3\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0x", PCCD_E_FORMAT,
                    ": byte 193: 1 byte after the last element"),
        BINARY_CASE("\0\0\0\0\0\0\300\177\0\0\0\0\3\0\0\0", PCCD_E_NOTFINITE,
                    ": byte 173: vertex 0: coordinate y is nan; |x| <= 1e18 is needed"),
    };
    assert_int_equal(sizeof(BINARY) - 1, 165);
    check_malformed(cases, KIT_COUNT(cases), "bad.ply");
}

/* If it failed: a broken OBJ file would be read as another mesh. */
CASE(malformed__names_what_is_wrong_in_an_obj)
{
    static const struct malformed cases[] = {
        BAD("f 1 2 3\n", ": no vertices"),
        BAD("v 0 0 0\n", ": no faces, edges or points"),
        BAD("v 0 0 0\nl 1\n", ":2: 1 vertex where a line needs at least 2"),
        {"v 0 0 0\nl 1 2\n", 0, PCCD_E_INDEX,
         ":2: 2 is not a vertex number (1 vertices so far, 1 in the file)"},
        BAD("v 0 0 0\np\n", ":2: points without a vertex"),
        BAD("v 0 0\n", ":1: a vertex of 2 numbers"),
        BAD("v 0 0 0 0 0\n", ":1: a vertex of 5 numbers"),
        BAD("v 0 0 0 0 0 0 0 0\n", ":1: more than 7 numbers in a vertex"),
        BAD("v 0 0 x\n", ":1: \"x\" is not a number"),
        BAD("v 0 0 -0X1p3\n", ":1: \"-0X1p3\" is not a number"),
        {"v 0 0 0\nv 0 nan 0\n", 0, PCCD_E_NOTFINITE,
         ":2: vertex 2: coordinate y is nan; |x| <= 1e18 is needed"},
        {"v 0 0 0\nv 0 0 1e19\n", 0, PCCD_E_NOTFINITE,
         ":2: vertex 2: coordinate z is 1e+19; |x| <= 1e18 is needed"},
        BAD("v 0 0 0\nf 1 1\n", ":2: 2 vertices where a face needs at least 3"),
        {"v 0 0 0\nf 1 1 2\n", 0, PCCD_E_INDEX,
         ":2: 2 is not a vertex number (1 vertices so far, 1 in the file)"},
        {"v 0 0 0\nf 1 1 0\n", 0, PCCD_E_INDEX,
         ":2: 0 is not a vertex number (1 vertices so far, 1 in the file)"},
        {"v 0 0 0\nf -1 -1 -2\nv 1 1 1\n", 0, PCCD_E_INDEX,
         ":2: -2 is not a vertex number (1 vertices so far, 2 in the file)"},
        BAD("v 0 0 0\nf 1 /1 1\n", ":2: \"/1\" is not a vertex number"),
        BAD("v 0 0 0\nf 1 1 1.5\n", ":2: \"1.5\" is not a vertex number"),
        BAD("v 0 0 0\nsolid\n", ":2: unknown statement \"solid\""),
        BAD("v 0 0 0\n\\\nv 1 1 1\n", ":2: a vertex that begins on a continued line"),
    };
    check_malformed(cases, KIT_COUNT(cases), "bad.obj");
}

/* If it failed: a file cut anywhere could be taken for a whole one, or read past its end.
 */
CASE(malformed__refuses_a_binary_ply_cut_at_any_byte)
{
    static struct kit_bytes bytes;
    const struct kit_variant variant = {
        "binary_big_endian", "double", "uchar", "int", true, PCCD_FORMAT_F64};
    kit_make_ply(&bytes, &variant);
    for (size_t count = 0; count < bytes.count; count++) {
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        char path[KIT_PATH_BYTES];
        kit_write_file("cut.ply", bytes.data, count, path);
        assert_int_not_equal(ctl_mesh_read(path, &mesh, &error), PCCD_OK);
        assert_string_not_equal(error.text, "");
    }
}

/* If it failed: the caller could not tell a missing file from a bad one, nor which kind
 * is not read. */
CASE(malformed__tells_files_it_cannot_read)
{
    struct ctl_mesh mesh = {0};
    struct ctl_error error = {.text = ""};
    char path[KIT_PATH_BYTES];
    snprintf(path, sizeof path, "%s/absent.ply", kit_folder);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_SYSTEM);
    assert_non_null(strstr(error.text, "cannot open: No such file or directory"));
    assert_int_equal(ctl_mesh_read(kit_folder, &mesh, &error), PCCD_E_SYSTEM);
    assert_non_null(strstr(error.text, "cannot read: Is a directory"));
    kit_write_file("mesh.off", "OFF\n", 4, path);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, "neither PLY (first line \"ply\") nor glTF "));
    assert_non_null(strstr(error.text, ".gltf, but in .off; "));
    kit_write_file("mesh", "OFF\n", 4, path); /* the dots of folders end no name */
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, ".glb or .gltf; "));
}

#define BINARY_START "ply\nformat binary_little_endian 1.0\nelement vertex "

/* If it failed: somebody would wait for minutes to be told what the first lines show, or
 * the machine would run out of memory before. */
CASE(malformed__is_told_before_a_large_file_is_read)
{
    static const struct malformed cases[] = {
        BAD(BINARY_START "1000000000\n" XYZ "element face 1\n" LIST "end_header\n",
            ":9: 1000000000 rows of element \"vertex\" take 12000000000 bytes or more, "
            "and "
            "8589934414 of the file are left"),
        BAD(BINARY_START "1\n" XYZ
                         "element face 2\nproperty list uchar short vertex_indices\n"
                         "end_header\n",
            ":9: the elements take at most 1034 bytes, and the file has 8589933387 more"),
        BAD(BODY("0 0 0\n"), ": byte 160 is zero, which no text has"),
        BAD("ply\nformat ascii 1.0\n", ":3: unknown header line \"\""),
    };
    static const struct malformed obj =
        BAD("v 0 0 0\nv 1 0 0\n", ": byte 16 is zero, which no text has");
    clock_t begin = clock();
    large_bytes = (off_t)1 << 33;
    check_malformed(cases, KIT_COUNT(cases), "large.ply");
    check_malformed(&obj, 1, "large.obj");
    large_bytes = 0;
    assert_true(clock() - begin < 2 * CLOCKS_PER_SEC);
}

CASES_WITH(kit_make_folder, kit_remove_folder);
