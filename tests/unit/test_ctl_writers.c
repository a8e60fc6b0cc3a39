/* test_ctl_writers.c - what programs write into mesh files beside what the formats' first
 * examples have.
 */
#include "ctl_kit.h"
#include "meshfile.h"

/* A file of four vertices and two triangles. */
struct form {
    const char *name; /* of the file */
    const char *text;
    size_t bytes; /* 0: strlen */
};

static const float places[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
static const uint32_t faces[2][3] = {{0, 1, 2}, {2, 1, 3}};

static double place(const struct ctl_mesh *mesh, int i)
{
    return mesh->format == PCCD_FORMAT_F32 ? (double)((const float *)mesh->x)[i]
                                           : ((const double *)mesh->x)[i];
}

static void check_form(const struct form *form, const char *data, size_t bytes)
{
    if (kit_read(form->name, data, bytes) != PCCD_OK) {
        fail_msg("%s; the file is:\n%s", kit_read_error.text, data);
    }
    if (kit_read_mesh.vertex_count != 4 || kit_read_mesh.triangles.count != 2 ||
        memcmp(kit_read_mesh.triangles.vertices, faces, sizeof faces) != 0) {
        fail_msg("%u vertices, %u triangles: another mesh than this one:\n%s",
                 kit_read_mesh.vertex_count, kit_read_mesh.triangles.count, data);
    }
    for (int i = 0; i < 12; i++) {
        assert_true(place(&kit_read_mesh, i) == (double)places[i / 3][i % 3]);
    }
}

/* Each as it is, and, if it is text, with a byte order mark, with each kind of line end,
 * and larger than a mebibyte. */
static void check_forms(const struct form *forms, size_t count, const char *filler)
{
    static const char *const ends[] = {"\n", "\r\n", "\r"};
    static char data[2 << 20];
    for (size_t f = 0; f < count; f++) {
        const struct form *form = &forms[f];
        if (form->bytes > 0) {
            check_form(form, form->text, form->bytes);
            continue;
        }
        for (int way = 0; way < 9; way++) {
            size_t bytes = 0;
            if (way % 3 == 1) {
                memcpy(data, "\xef\xbb\xbf", 3);
                bytes = 3;
            }
            for (const char *at = form->text; *at != '\0'; at++) {
                const char *put = *at == '\n' ? ends[way / 3] : (const char[]){*at, '\0'};
                bytes += (size_t)sprintf(data + bytes, "%s", put);
            }
            for (int line = 0; way % 3 == 2 && line < 1 << 14; line++) {
                bytes +=
                    (size_t)sprintf(data + bytes, "%s%s%70s", ends[way / 3], filler, "");
            }
            check_form(form, data, bytes);
        }
    }
}

#define XYZ   "property float x\nproperty float y\nproperty float z\n"
#define ASCII "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
#define FOUR  "0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
#define TWO   "3 0 1 2\n3 2 1 3\n"

/* If it failed: a file that a program wrote would be refused, or read as points. */
CASE(writers__of_ply_are_understood)
{
    static const struct form forms[] = {
        {"a.ply",
         ASCII "element face 2\nproperty list uchar int vertex_indices\n"
               "end_header\n" FOUR TWO,
         0},
        {"ends with blanks.ply",
         "ply \nformat ascii 1.0\nelement vertex 4\n" XYZ
         "element face 2\nproperty list uchar uint vertex_index\n"
         "end_header\n" FOUR TWO "\n \n",
         0},
        {"strip.ply",
         ASCII "element tristrips 1\nproperty list int int vertex_indices\n"
               "end_header\n" FOUR "4 0 1 2 3\n",
         0},
        {"restart.ply",
         ASCII "element tristrips 1\nproperty list int int vertex_indices\n"
               "end_header\n" FOUR "10 0 1 -1 0 1 2 -1 2 1 3\n",
         0},
        {"triangle.ply",
         ASCII "element triangle 2\nproperty list uchar int vertex_indices\n"
               "end_header\n" FOUR TWO,
         0},
        {"polygon.ply",
         ASCII "element polygon 2\nproperty list uint64 int64 vertices\n"
               "end_header\n" FOUR TWO,
         0},
        {"two elements.ply",
         ASCII "element face 1\nproperty list uchar int vertex_indices\n"
               "element triangle 1\nproperty list uchar long "
               "vertex_indices\nend_header\n" FOUR TWO,
         0},
        {"value a line.ply",
         ASCII "element face 2\nproperty list uchar int vertex_indices\n"
               "end_header\n0\n0\n0\n1\n0\n0\n0\n1\n0\n1\n1\n0\n"
               "3\n0\n1\n2\n3\n2 1 3\n",
         0},
    };
    check_forms(forms, KIT_COUNT(forms), "");
}

#define RESTARTED                                                                        \
    "ply\nformat ascii 1.0\nelement vertex 5\n" XYZ                                      \
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" FOUR       \
    "2 2 2\n"

/* If it failed: strips would be joined by triangles that nobody wrote, or turn over. */
CASE(writers__of_strips_begin_anew_and_turn)
{
    static const char text[] = RESTARTED "12 0 1 2 3 -1 3 4 0 0 0 1 2\n";
    static const uint32_t expected[4][3] = {{0, 1, 2}, {2, 1, 3}, {3, 4, 0}, {0, 1, 2}};
    assert_ok(kit_read("strips.ply", text, strlen(text)));
    assert_int_equal(kit_read_mesh.triangles.count, 4);
    assert_memory_equal(kit_read_mesh.triangles.vertices, expected, sizeof expected);
}

/* If it failed: a line end behind binary data would refuse a file, or other bytes not. */
CASE(writers__of_binary_ply_end_with_a_line_end)
{
    static const char *const ends[] = {"",  "\n",   "\r\n", "\r",
                                       "x", "\n\n", "\n\r", "\r\nx"};
    static const char head[] =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\n" XYZ
        "element face 2\nproperty list uchar uchar vertex_indices\n"
        "end_header\n";
    for (size_t i = 0; i < KIT_COUNT(ends); i++) {
        struct kit_bytes bytes = {.count = 0};
        kit_put_text(&bytes, head);
        memcpy(bytes.data + bytes.count, places, sizeof places);
        bytes.count += sizeof places;
        memcpy(bytes.data + bytes.count, "\3\0\1\2\3\2\1\3", 8);
        bytes.count += 8;
        kit_put_text(&bytes, ends[i]);
        assert_int_equal(kit_read("end.ply", bytes.data, bytes.count),
                         i < 4 ? PCCD_OK : PCCD_E_FORMAT);
    }
}

/* If it failed: a surface would be read as loose points, without a word. */
CASE(writers__of_ply_never_lose_what_may_be_faces)
{
    static const char text[] = ASCII "element mosaic 2\nproperty list uchar int corners\n"
                                     "end_header\n" FOUR TWO;
    assert_int_equal(kit_read("mosaic.ply", text, strlen(text)), PCCD_E_FORMAT);
    assert_non_null(strstr(kit_read_error.text,
                           "element \"mosaic\" may have the faces: its list "
                           "\"corners\" is none that is known"));
}

#define V "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
#define F "f 1 2 3\nf 3 2 4\n"

/* If it failed: a comment or a name would eat the line behind it. */
CASE(writers__of_obj_are_understood)
{
    static const struct form forms[] = {
        {"a.obj", V F, 0},
        {"comment.obj", "# C:\\work\\\n" V "f 1 2 3 # to be continued \\\nf 3 2 4", 0},
        {"name.obj", "mtllib C:\\work\\\no back\\\n" V "usemtl it\\\n" F "g \\\n", 0},
        {"continued.obj",
         "v 0 0 \\\n0\nv 1 0 0\nv 0 \\\n1 0\nv 1 1 0\nf 1 \\\n2 \\\n3 # x \\\n"
         "f 3 2 4\n",
         0},
    };
    check_forms(forms, KIT_COUNT(forms), "#");
}

/* If it failed: results would be told of another object of the file. */
CASE(writers__of_obj_name_objects)
{
    static const struct {
        const char *text, *names[2];
    } cases[] = {{V "o  big box \nf 1 2 3\ng left\nusemtl m\no rod\ng x\nf 3 2 4\n",
                  {"big box", "rod"}},
                 {V "g a b\nf 1 2 3\ng\ng c\nf 3 2 4\n", {"a b", "c"}}};
    for (size_t i = 0; i < KIT_COUNT(cases); i++) {
        assert_ok(kit_read("named.obj", cases[i].text, strlen(cases[i].text)));
        assert_int_equal(kit_read_mesh.object_count, 2);
        for (uint32_t k = 0; k < 2; k++) {
            assert_string_equal(kit_read_mesh.objects[k].name, cases[i].names[k]);
            assert_int_equal(kit_read_mesh.objects[k].first[CTL_TRIANGLES], k);
        }
    }
}

/* If it failed: contacts of one group would be told of two, and of the group with itself
 * as of two that meet. */
CASE(writers__of_obj_write_a_group_in_parts)
{
    static const char text[] = V "g a\nf 1 2 3\ng b\nf 3 2 4\ng a\nl 1 4\np 4\n";
    assert_ok(kit_read("parts.obj", text, strlen(text)));
    assert_int_equal(ctl_mesh_object_at(&kit_read_mesh, CTL_TRIANGLES, 0), 0);
    assert_int_equal(ctl_mesh_object_at(&kit_read_mesh, CTL_TRIANGLES, 1), 1);
    assert_int_equal(ctl_mesh_object_at(&kit_read_mesh, CTL_EDGES, 0), 0);
    assert_int_equal(ctl_mesh_object_at(&kit_read_mesh, CTL_POINTS, 0), 0);
}

#define FACET(a, b, c)                                                                   \
    "facet normal 0 0 1\n outer loop\n  vertex " a "\n  vertex " b "\n  vertex " c       \
    "\n endloop\nendfacet\n"
#define BIG_FACET(a, b, c)                                                               \
    "FACET NORMAL 0 0 1\n OUTER LOOP\n  VERTEX " a "\n  VERTEX " b "\n  VERTEX " c       \
    "\n END LOOP\nEndFacet\n"
#define BOTH FACET("0 0 0", "1 0 0", "0 1 0") FACET("0 1 0", "1 0 0", "1 1 0")

/* If it failed: the way in which a program writes words would refuse its file, or only a
 * large one. */
CASE(writers__of_stl_are_understood)
{
    static const struct form forms[] = {
        {"a.stl", "solid\n" BOTH "endsolid\n", 0},
        {"capitals.stl",
         "SOLID PART\n" BIG_FACET("0 0 0", "1 0 0", "0 1 0")
             BIG_FACET("0 1 0", "1 0 0", "1 1 0") "ENDSOLID PART\n",
         0},
        {"blanks.stl", "\n \t solid part\n" BOTH "  end solid part\n", 0},
        {"endless.stl", "solid part of\n" BOTH, 0},
        {"two.stl",
         "solid a\n" FACET("0 0 0", "1 0 0",
                           "0 1 0") "endsolid\nsolid\n" FACET("0 1 0", "1 0 0", "1 1 0"),
         0},
    };
    check_forms(forms, KIT_COUNT(forms), "");
}

/* If it failed: a user would not know what is wrong with a binary file. */
CASE(writers__of_binary_stl_hear_both_counts)
{
    char data[84 + 100] = "solid that is none", path[KIT_PATH_BYTES];
    struct ctl_mesh mesh = {0};
    struct ctl_error error = {.text = ""};
    data[80] = 3;
    for (int more = 0; more < 2; more++) {
        kit_write_file("count.stl", data, sizeof data - (more ? 7 : 0), path);
        assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_FORMAT);
        assert_non_null(
            strstr(error.text, more ? "tells of 3 facets, where 177 bytes have 1 "
                                      "and 43 bytes more"
                                    : "tells of 3 facets, where 184 bytes have 2 "
                                      "and 0 bytes more"));
    }
}

/* Bytes of binary files: a 0 and a 1 of a float, and the first five numbers of a
 * facet. */
#define O      "\0\0\0\0"
#define I      "\0\0\200\77"
#define NORMAL O O I
#define BINARY                                                                           \
    "element vertex 4\n" XYZ "element face 2\nproperty list uchar uchar "                \
    "vertex_indices\nend_header\n"
static const char little_ply[] =
    "ply\nformat binary_little_endian 1.0\n" BINARY O O O I O O O I O I I O
    "\3\0\1\2\3\2\1\3";
static const char big_ply[] =
    "ply\nformat binary_big_endian 1.0\n" BINARY O O O "\77\200\0\0" O O O "\77\200\0\0" O
    "\77\200\0\0\77\200\0\0" O "\3\0\1\2\4\2\1\3\0";
static const char binary_stl[] =
    "a header of eighty bytes, of which nothing is known but that it is no ascii file"
    "\2\0\0\0" NORMAL O O O I O O O I O "\0\0" NORMAL O I O I O O I I O "\0";

/* If it failed: a damaged file would crash its reader, or be read beyond its end (built
 * with sanitisers), or be refused without its name. */
CASE(writers__damage_is_survived)
{
    static const struct form forms[] = {
        {"m.ply",
         ASCII "element face 1\nproperty list uchar int vertex_indices\n"
               "element tristrips 1\nproperty list int int vertex_indices\n"
               "end_header\n" FOUR "4 0 1 3 2\n4 0 1 2 3\n",
         0},
        {"m.obj", "o a\\\n" V F "f 1 2 4 3\ng b\nl 1 2\np 1 # \\\n", 0},
        {"m.stl", "solid\n" BOTH "end solid\n", 0},
        {"l.ply", little_ply, sizeof little_ply - 1},
        {"b.ply", big_ply, sizeof big_ply - 1},
        {"b.stl", binary_stl, sizeof binary_stl},
    };
    uint32_t read_count = 0; /* of binary files */
    unsigned seed = 11;
    for (size_t f = 0; f < KIT_COUNT(forms); f++) {
        for (int round = 0; round < 1000; round++) {
            char data[1024], path[KIT_PATH_BYTES];
            bool is_binary = forms[f].bytes > 0;
            size_t bytes = is_binary ? forms[f].bytes : strlen(forms[f].text);
            struct ctl_mesh mesh = {0};
            struct ctl_error error = {.text = ""};
            memcpy(data, forms[f].text, bytes);
            for (int k = 0; k <= round % 4; k++) {
                static const char put[] = "\n\r\\#-9 0\0e.\xff";
                seed = seed * 1664525u + 1013904223u;
                size_t at = (seed >> 8) % bytes;
                switch (seed >> 28) {
                case 0: /* cut */
                    bytes = at + 1;
                    break;
                case 1: /* twice */
                    memmove(data + at, data + at / 2, bytes - at);
                    break;
                default:
                    data[at] = put[(seed >> 4) % (sizeof put - 1)];
                }
            }
            kit_write_file(forms[f].name, data, bytes, path);
            if (ctl_mesh_read(path, &mesh, &error) != PCCD_OK) {
                assert_true(strncmp(error.text, path, strlen(path)) == 0);
            }
            read_count += is_binary && mesh.vertex_count > 0;
            for (uint32_t i = 0; i < mesh.triangles.count; i++) {
                assert_true(mesh.triangles.vertices[3 * i] < mesh.vertex_count);
                assert_true(mesh.triangles.vertices[3 * i + 1] < mesh.vertex_count);
                assert_true(mesh.triangles.vertices[3 * i + 2] < mesh.vertex_count);
            }
            ctl_mesh_deinit(&mesh);
        }
    }
    assert_true(read_count > 300);
}

/* If it failed: a coordinate would differ in its last bit from what others read. */
CASE(writers__numbers_are_rounded_as_the_c_library_does)
{
    static const char *const odd[] = {"16777217",
                                      "16777217.0000000001",
                                      "0",
                                      "-0",
                                      ".5",
                                      "5.",
                                      ".",
                                      "-",
                                      "1e",
                                      "+1",
                                      "1.0.0",
                                      "9007199254740993",
                                      "0.00000000000000001",
                                      "3.4028235e38",
                                      "1e-45"};
    unsigned seed = 5;
    for (int i = 0; i < 200000; i++) {
        char text[40];
        seed = seed * 1664525u + 1013904223u;
        int digits = 1 + (int)(seed >> 28);
        double made = (double)(seed >> 3) / (double)(1u << (seed % 29)) *
                      (seed % 5 == 0 ? 1e-3 : 1);
        snprintf(text, sizeof text, seed % 2 == 0 ? "%.*f" : "-%.*g", digits, made);
        const char *put = i < (int)KIT_COUNT(odd) ? odd[i] : text;
        const struct ctl_word word = {put, put + strlen(put)};
        double value = 0, narrow = 0;
        char *stop;
        double expected = strtod(put, &stop);
        assert_int_equal(ctl_word_double(&word, &value), stop == word.end);
        assert_int_equal(ctl_word_float(&word, &narrow), stop == word.end);
        if (stop == word.end) {
            assert_memory_equal(&value, &expected, sizeof value);
            assert_true((float)narrow == strtof(put, NULL));
        }
    }
}

CASES_WITH(kit_make_folder, kit_remove_folder);
