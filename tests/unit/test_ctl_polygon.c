/* test_ctl_polygon.c - polygons of mesh files, and how they are cut. */
#include "ctl_kit.h"
#include "meshfile.h"
#include "polygon.h"

#define CORNERS_MAX 64

static struct ctl_cutter cutter;

/* Twice the area of a triangle or a polygon of small whole numbers, which is exact. */
static double doubled_area(const double (*p)[2], const uint32_t *corners, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double *a = p[corners[i]], *b = p[corners[(i + 1) % count]];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return sum;
}

/* Cut the polygon from corner `first` on, leaning into the third axis. */
static bool cut(const double (*p)[2], uint32_t count, uint32_t first)
{
    assert_true(ctl_cutter_reserve(&cutter, count));
    for (uint32_t i = 0; i < count; i++) {
        const double *corner = p[(first + i) % count];
        cutter.x[i][0] = corner[0];
        cutter.x[i][1] = corner[1];
        cutter.x[i][2] = corner[0] + 3 * corner[1];
    }
    return ctl_cutter_cut(&cutter, count);
}

/* A point is inside as many of the triangles as of the polygon: 1 or 0. Points of a fine
 * grid, none of which is on a line between two corners. */
static uint32_t covers(const double (*p)[2], const uint32_t corners[3], double x,
                       double y)
{
    uint32_t sides = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = p[corners[k]], *b = p[corners[(k + 1) % 3]];
        sides += (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) > 0;
    }
    return sides == 3;
}

/* All triangles have an area of the polygon's sign; together they are the polygon, and no
 * two of them overlap. */
static void check_cut(const double (*p)[2], uint32_t count, uint32_t first)
{
    uint32_t all[CORNERS_MAX];
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        all[i] = i;
    }
    assert_true(cut(p, count, first));
    double whole = doubled_area(p, all, count);
    uint32_t triangles[CORNERS_MAX][3];
    for (uint32_t i = 0; i + 2 < count; i++) {
        for (int k = 0; k < 3; k++) {
            triangles[i][k] = (first + cutter.cut[i][k]) % count;
        }
        double area = doubled_area(p, triangles[i], 3);
        assert_true(area * whole > 0);
        sum += area;
    }
    assert_true(sum == whole);
    for (int at = 0; at < 400 && whole > 0; at++) {
        double x = (at % 20) * .73 - .31, y = (at / 20) * .711 - .17;
        uint32_t covered = 0;
        for (uint32_t i = 0; i + 2 < count; i++) {
            covered += covers(p, triangles[i], x, y);
        }
        assert_true(covered <= 1);
    }
}

static int compare_triangles(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* The triangles by the numbers of p, each from its least corner, in order. */
static void name_cut(uint32_t count, uint32_t first, uint32_t named[CORNERS_MAX][3])
{
    for (uint32_t i = 0; i + 2 < count; i++) {
        uint32_t t[3], least = 0;
        for (uint32_t k = 0; k < 3; k++) {
            t[k] = (first + cutter.cut[i][k]) % count;
            least = t[k] < t[least] ? k : least;
        }
        for (uint32_t k = 0; k < 3; k++) {
            named[i][k] = t[(least + k) % 3];
        }
    }
    qsort(named, count - 2, sizeof named[0], compare_triangles);
}

static const double l_shape[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
static const double comb[12][2] = {{0, 0}, {10, 0}, {10, 4}, {8, 4}, {8, 1}, {6, 1},
                                   {6, 4}, {4, 4},  {4, 1},  {2, 1}, {2, 4}, {0, 4}};
/* Corners in the middle of sides. */
static const double flat[8][2] = {{0, 0}, {2, 0}, {4, 0}, {4, 3},
                                  {4, 4}, {1, 4}, {0, 4}, {0, 1}};
static const double triangle[4][2] = {{0, 0}, {2, 0}, {4, 0}, {0, 4}};
static const double star[8][2] = {{6, 0},  {7, 5}, {12, 6}, {7, 7},
                                  {6, 12}, {5, 7}, {0, 6},  {5, 5}};

/* If it failed: a face would cover what is no part of it, and meet what passes there. */
CASE(polygon__is_cut_within_itself_from_each_corner)
{
    static const struct {
        const double (*p)[2];
        uint32_t count;
    } shapes[] = {{l_shape, 6}, {comb, 12}, {flat, 8}, {triangle, 4}, {star, 8}};
    for (size_t s = 0; s < KIT_COUNT(shapes); s++) {
        uint32_t count = shapes[s].count, once[CORNERS_MAX][3], again[CORNERS_MAX][3];
        for (uint32_t first = 0; first < count; first++) {
            check_cut(shapes[s].p, count, first);
            name_cut(count, first, first == 0 ? once : again);
            if (first > 0) {
                assert_memory_equal(once, again, (count - 2) * sizeof once[0]);
            }
        }
    }
}

/* If it failed: files of quads would have other triangles than before. */
CASE(polygon__of_four_corners_keeps_its_diagonal)
{
    static const double square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const double dart[4][2] = {{0, 0}, {4, 0}, {1, 1}, {0, 4}};
    static const uint32_t diagonal[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (uint32_t first = 0; first < 4; first++) {
        assert_true(cut(square, 4, first));
        assert_memory_equal(cutter.cut, diagonal, sizeof diagonal);
        check_cut(dart, 4, first);
    }
}

/* If it failed: a face that crosses itself would be read as some other surface, or one
 * whose corners are at one place be refused. */
CASE(polygon__without_a_simple_cut_has_none)
{
    static const double bow[4][2] = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
    static const double pentagram[5][2] = {{0, 3}, {6, 3}, {1, 0}, {3, 5}, {5, 0}};
    static const double touching[6][2] = {{0, 0}, {4, 0}, {2, 2}, {4, 4}, {0, 4}, {2, 2}};
    static const double line[5][2] = {{0, 0}, {1, 0}, {3, 0}, {2, 0}, {0, 0}};
    static const double spike[5][2] = {{0, 0}, {4, 0}, {6, 0}, {4, 0}, {0, 4}};
    static const double doubled[6][2] = {{0, 0}, {0, 0}, {4, 0}, {4, 4}, {4, 4}, {0, 0}};
    assert_false(cut(bow, 4, 0));
    assert_false(cut(pentagram, 5, 0));
    assert_false(cut(touching, 6, 0));
    assert_false(cut(spike, 5, 0));
    assert_true(cut(line, 5, 0));
    for (uint32_t first = 0; first < 6; first++) {
        double sum = 0;
        assert_true(cut(doubled, 6, first));
        for (uint32_t i = 0; i < 4; i++) {
            const uint32_t corners[3] = {(first + cutter.cut[i][0]) % 6,
                                         (first + cutter.cut[i][1]) % 6,
                                         (first + cutter.cut[i][2]) % 6};
            sum += doubled_area(doubled, corners, 3);
        }
        assert_true(sum == 16);
    }
}

/* If it failed: rounding would decide where a corner is, and a cut leave its polygon. */
CASE(polygon__signs_are_exact)
{
    /* A corner that is one unit in the last place beside a side, to the inside or to the
     * outside; numbers from the least to the largest. */
    static const double scales[] = {1, 1e17, 1e-280,
                                    4.9406564584124654e-324 * 1073741824};
    for (size_t s = 0; s < KIT_COUNT(scales); s++) {
        for (int in = 0; in < 2; in++) {
            double unit = scales[s], third = unit / 4;
            double off = in ? third * (1 + 0x1p-26) : third * (1 - 0x1p-26);
            const double p[4][2] = {
                {0, 0}, {third, off}, {unit, unit}, {0, unit}}; /* side 0-2: x = y */
            assert_true(ctl_cutter_reserve(&cutter, 4));
            for (int i = 0; i < 4; i++) {
                cutter.x[i][0] = p[i][0];
                cutter.x[i][1] = p[i][1];
                cutter.x[i][2] = 0;
            }
            assert_true(ctl_cutter_cut(&cutter, 4));
            assert_int_equal(cutter.cut[0][0], in ? 1 : 0); /* reflex, or convex */
        }
    }
}

/* If it failed: large polygons would be cut wrongly, or take for ever. */
CASE(polygon__of_many_corners_is_cut)
{
    enum { TEETH = 5000, COUNT = 2 * TEETH + 2 };
    double sum = 0;
    assert_true(ctl_cutter_reserve(&cutter, COUNT));
    for (uint32_t i = 0; i < COUNT - 2; i++) {
        cutter.x[i][0] = (double)i;
        cutter.x[i][1] = i % 2 == 0 ? 1 : 3;
        cutter.x[i][2] = 0;
    }
    const double ends[2][2] = {{COUNT - 3, 0}, {0, 0}};
    for (int k = 0; k < 2; k++) {
        cutter.x[COUNT - 2 + k][0] = ends[k][0];
        cutter.x[COUNT - 2 + k][1] = ends[k][1];
        cutter.x[COUNT - 2 + k][2] = 0;
    }
    assert_true(ctl_cutter_cut(&cutter, COUNT));
    for (uint32_t i = 0; i < COUNT - 2; i++) {
        const double *a = cutter.x[cutter.cut[i][0]], *b = cutter.x[cutter.cut[i][1]];
        const double *c = cutter.x[cutter.cut[i][2]];
        double area = (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0]);
        assert_true(area < 0);
        sum += area;
    }
    assert_true(sum == -4.0 * (COUNT - 3));
}

/* ---- files ------------------------------------------------------------------------- */

static void write_text(const char *name, const char *text, char path[KIT_PATH_BYTES])
{
    kit_write_file(name, text, strlen(text), path);
}

/* If it failed: a user would not know which face to mend. */
CASE(polygon__that_has_no_cut_is_refused_by_its_place)
{
    struct ctl_mesh mesh = {0};
    struct ctl_error error = {.text = ""};
    char path[KIT_PATH_BYTES];
    write_text("bow.obj", "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nf 1 3 2\n\nf 1 2 3 4\n",
               path);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_FORMAT);
    assert_non_null(strstr(
        error.text, "bow.obj:7: a face of 4 corners that touches or crosses itself"));
    write_text("bow.ply",
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
               "property float y\nproperty float z\nelement face 2\n"
               "property list uchar int vertex_indices\nend_header\n"
               "0 0 0\n2 2 0\n2 0 0\n0 2 0\n3 0 2 1\n4 0 1 2 3\n",
               path);
    assert_int_equal(ctl_mesh_read(path, &mesh, &error), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, "bow.ply: face 1: its 4 corners make a polygon "
                                       "that touches or crosses itself"));
}

/* A square whose third corner is at (x, x), and a concave face beside it. */
static void write_frame(const char *name, double x, char path[KIT_PATH_BYTES])
{
    char text[512];
    snprintf(text, sizeof text,
             "v 0 0 0\nv 1 0 0\nv %g %g 0\nv 0 1 0\nv 5 0 0\nv 9 0 0\nv 6 1 0\nv 5 4 0\n"
             "f 1 2 3 4\nf 1 2 3\nf 6 7 8 5\n",
             x, x);
    write_text(name, text, path);
}

/* If it failed: a mesh would change its triangles while it moves, or its later frames be
 * refused. */
CASE(polygon__is_cut_as_in_the_first_frame)
{
    struct ctl_mesh first = {0}, later = {0};
    struct ctl_error error = {.text = ""};
    char path[KIT_PATH_BYTES], other[KIT_PATH_BYTES];
    static const uint32_t cut_first[5][3] = {
        {0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {6, 7, 4}, {6, 4, 5}};
    write_frame("first.obj", 1, path);
    write_frame("later.obj", .2, other); /* concave the other way */
    assert_ok(ctl_mesh_read(path, &first, &error));
    assert_memory_equal(first.triangles.vertices, cut_first, sizeof cut_first);
    assert_ok(
        ctl_mesh_read_as(other, &(struct ctl_reading){.like = &first}, &later, &error));
    assert_memory_equal(later.triangles.vertices, cut_first, sizeof cut_first);
    ctl_mesh_deinit(&later);
    write_frame("crossed.obj", -1, other);
    assert_ok(
        ctl_mesh_read_as(other, &(struct ctl_reading){.like = &first}, &later, &error));
    ctl_mesh_deinit(&later);
    assert_ok(ctl_mesh_read(other, &later, &error)); /* a dart */
    ctl_mesh_deinit(&later);
    ctl_mesh_deinit(&first);
}

/* If it failed: two files whose quads were cut by their writers where they bend would be
 * taken for one mesh, or it would not be told which face that was. */
CASE(polygon__of_another_topology_is_named)
{
    static const struct {
        const char *first, *later, *message;
    } cases[] = {
        {"f 1 2 3 4\nf 5 6 7 8\n", "f 1 2 3 4\nf 5 6 8 7\n",
         "the face of line 10 has 6 for corner 2 in a.obj and 7 in b.obj: not two frames "
         "of one mesh"},
        {"f 1 2 3 4\n", "f 1 2 4\nf 2 3 4\n",
         "triangles 0 to 1 are one face of 4 corners in a.obj, and others in b.obj: two "
         "topologies, not two frames of one mesh"},
        {"o roof\nf 1 2 3\nf 1 3 4\n", "o roof\nf 1 2 4\nf 2 3 4\n",
         "triangles 0 and 1 of roof are a quad that a.obj and b.obj cut by two "
         "diagonals: two topologies, not two frames of one mesh"},
        {"f 1 2 3 4\n", "f 1 2 3\nf 1 3 4\n", NULL},
    };
    static const char vertices[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                   "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    for (size_t i = 0; i < KIT_COUNT(cases); i++) {
        struct ctl_mesh first = {0}, later = {0};
        struct ctl_error error = {.text = ""};
        char path[KIT_PATH_BYTES], text[512];
        snprintf(text, sizeof text, "%s%s", vertices, cases[i].first);
        write_text("a.obj", text, path);
        assert_ok(ctl_mesh_read(path, &first, &error));
        snprintf(text, sizeof text, "%s%s", vertices, cases[i].later);
        write_text("b.obj", text, path);
        first.path = "a.obj";
        int status =
            ctl_mesh_read_as(path, &(struct ctl_reading){.like = &first}, &later, &error);
        if (cases[i].message == NULL) {
            assert_ok(status);
        } else {
            char *at;
            assert_int_equal(status, PCCD_E_INVAL);
            while ((at = strstr(error.text, path)) != NULL) { /* without its folder */
                size_t folder = strlen(path) - strlen("b.obj");
                memmove(at, at + folder, strlen(at + folder) + 1);
            }
            assert_string_equal(error.text, cases[i].message);
        }
        ctl_mesh_deinit(&first);
        ctl_mesh_deinit(&later);
    }
}

/* If it failed: ranks would cut a polygon in other ways than one process does, because
 * they keep other vertices than it has. */
CASE(polygon__is_cut_alike_in_any_parts)
{
    enum { FACES = 40 };
    char text[8192], path[KIT_PATH_BYTES];
    size_t length = 0;
    struct ctl_mesh whole = {0};
    struct ctl_error error = {.text = ""};
    for (uint32_t i = 0; i < FACES; i++) {
        for (uint32_t k = 0; k < 6; k++) { /* an L, begun at another corner each time */
            const double *p = l_shape[(i + k) % 6];
            length += (size_t)snprintf(text + length, sizeof text - length,
                                       "v %g %g %u\n", p[0], p[1], i);
        }
    }
    for (uint32_t i = 0; i < FACES; i++) {
        uint32_t v = (FACES - 1 - i) * 6 + 1; /* far from the face's own part */
        length +=
            (size_t)snprintf(text + length, sizeof text - length, "f %u %u %u %u %u %u\n",
                             v, v + 1, v + 2, v + 3, v + 4, v + 5);
    }
    write_text("parts.obj", text, path);
    assert_ok(ctl_mesh_read(path, &whole, &error));
    assert_int_equal(whole.triangles.count, 4 * FACES);
    for (uint32_t pieces = 1; pieces <= 7; pieces += 3) {
        uint32_t seen = 0;
        for (uint32_t i = 0; i < pieces; i++) {
            struct ctl_mesh piece = {0}, later = {0};
            assert_ok(ctl_mesh_read_as(
                path, &(struct ctl_reading){.number = i, .count = pieces}, &piece,
                &error));
            assert_memory_equal(whole.triangles.vertices + 3 * (size_t)seen,
                                piece.triangles.vertices,
                                piece.triangles.count * sizeof(uint32_t[3]));
            seen += piece.triangles.count;
            assert_ok(ctl_mesh_read_as(path, &(struct ctl_reading){.like = &piece},
                                       &later, &error));
            ctl_mesh_deinit(&piece);
            ctl_mesh_deinit(&later);
        }
        assert_int_equal(seen, whole.triangles.count);
    }
    ctl_mesh_deinit(&whole);
}

static int end(void **state)
{
    ctl_cutter_deinit(&cutter);
    return kit_remove_folder(state);
}

CASES_WITH(kit_make_folder, end);
