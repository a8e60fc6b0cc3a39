/* test_ctl_meshfile.c - the readers of PLY and OBJ, and whole files. */
#include <unistd.h>

#include "ctl_kit.h"
#include "meshfile.h"

static const uint32_t expected_triangles[KIT_TRIANGLES][3] = {
    {0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}};

static void check_pyramid(const struct ctl_mesh *mesh, enum pccd_format format)
{
    assert_int_equal(mesh->format, format);
    assert_int_equal(mesh->vertex_count, KIT_VERTICES);
    assert_int_equal(mesh->triangles.count, KIT_TRIANGLES);
    for (int i = 0; i < KIT_VERTICES * 3; i++) {
        double x = format == PCCD_FORMAT_F32 ? (double)((const float *)mesh->x)[i]
                                             : ((const double *)mesh->x)[i];
        assert_true(x == kit_x[i / 3][i % 3]);
    }
    assert_memory_equal(mesh->triangles.vertices, expected_triangles,
                        sizeof expected_triangles);
}

static const struct kit_variant variants[] = {
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
CASE(meshfile__reads_every_ply_encoding_the_same)
{
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++) {
        static struct kit_bytes bytes;
        kit_make_ply(&bytes, &variants[i]);
        int status = kit_read("pyramid.ply", bytes.data, bytes.count);
        if (status != PCCD_OK) {
            fail_msg("variant %zu: %s", i, kit_read_error.text);
        }
        check_pyramid(&kit_read_mesh, variants[i].format);
    }
}

/* If it failed: OBJ frames would lose the correspondence with their PLY form. */
CASE(meshfile__reads_every_obj_form_the_same)
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
    for (size_t i = 0; i < sizeof rests / sizeof rests[0]; i++) {
        static struct kit_bytes bytes;
        bytes.count = 0;
        kit_put_text(&bytes, vertices);
        kit_put_text(&bytes, rests[i]);
        int status = kit_read("pyramid.OBJ", bytes.data, bytes.count);
        if (status != PCCD_OK) {
            fail_msg("form %zu: %s", i, kit_read_error.text);
        }
        check_pyramid(&kit_read_mesh, PCCD_FORMAT_F64);
    }
}

struct named {
    const char *file;
    const char *text;
    uint32_t triangles, edges, points;
    uint32_t ends[3][2];
    uint32_t point[3];
};

#define PLY_HEAD(count)                                                                  \
    "ply\nformat ascii 1.0\nelement vertex " count                                       \
    "\nproperty float x\nproperty float y\nproperty float z\n"

/* If it failed: rods and clouds would not be read, or as others than they are; vertices
 * of a mesh of faces or edges would be taken for a cloud. */
CASE(meshfile__reads_edges_and_points_by_themselves)
{
    static const struct named files[] = {
        {"rods.obj",
         "v 0 0 0\nv 1 0 0\nv 2 0 0\nl 1/1 2/2 3\nl -1 -3\nf 1 2 3\n",
         1,
         3,
         0,
         {{0, 1}, {1, 2}, {2, 0}},
         {0}},
        {"cloud.obj", "v 0 0 0\nv 1 0 0\np 2\np 1 -1\n", 0, 0, 3, {{0}}, {1, 0, 1}},
        {"rods.ply",
         PLY_HEAD("3") "element edge 2\nproperty uchar red\nproperty int vertex2\n"
                       "property int vertex1\nend_header\n0 0 0\n1 0 0\n2 0 0\n9 1 0\n"
                       "9 2 1\n",
         0,
         2,
         0,
         {{0, 1}, {1, 2}},
         {0}},
        {"cloud.ply",
         PLY_HEAD("3") "end_header\n0 0 0\n1 0 0\n2 0 0\n",
         0,
         0,
         3,
         {{0}},
         {0, 1, 2}},
        {"none.ply",
         PLY_HEAD("2") "element face 0\nproperty list uchar int vertex_index\n"
                       "end_header\n0 0 0\n1 0 0\n",
         0,
         0,
         2,
         {{0}},
         {0, 1}},
    };
    for (size_t i = 0; i < KIT_COUNT(files); i++) {
        const struct named *file = &files[i];
        if (kit_read(file->file, file->text, strlen(file->text)) != PCCD_OK) {
            fail_msg("%s", kit_read_error.text);
        }
        assert_int_equal(kit_read_mesh.triangles.count, file->triangles);
        assert_int_equal(kit_read_mesh.edges.count, file->edges);
        assert_int_equal(kit_read_mesh.points.count, file->points);
        for (uint32_t k = 0; k < file->edges; k++) {
            assert_memory_equal(kit_read_mesh.edges.vertices + 2 * k, file->ends[k],
                                sizeof file->ends[k]);
        }
        for (uint32_t k = 0; k < file->points; k++) {
            assert_int_equal(kit_read_mesh.points.vertices[k], file->point[k]);
        }
    }
}

/* If it failed: a decimal fraction of a float file would be rounded twice or kept wide.
 */
CASE(meshfile__rounds_ascii_floats_once)
{
    static const char text[] =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_index\nend_header\n"
        "0.1 1e-3 16777217\n0 0 0\n1 1 1\n3 0 1 2";
    assert_ok(kit_read("floats.ply", text, sizeof text - 1));
    const float *x = kit_read_mesh.x;
    assert_true(x[0] == 0.1f);
    assert_true(x[1] == 1e-3f);
    assert_true(x[2] == 16777216.0f);
    assert_ok(ctl_mesh_promote(&kit_read_mesh, &kit_read_error));
    const double *wide = kit_read_mesh.x;
    assert_true(wide[0] == (double)0.1f);
    assert_int_equal(kit_read_mesh.format, PCCD_FORMAT_F64);
}

/* If it failed: two frames of different meshes would be checked against each other. */
CASE(meshfile__match_names_the_first_difference)
{
    uint32_t a_triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    uint32_t b_triangles[2][3] = {{0, 1, 2}, {0, 3, 2}};
    struct ctl_mesh a = {.path = "a",
                         .vertex_count = 4,
                         .triangles = {.count = 2, .vertices = a_triangles[0]}};
    struct ctl_mesh b = {.path = "b",
                         .vertex_count = 4,
                         .triangles = {.count = 2, .vertices = b_triangles[0]}};
    struct ctl_error error = {.text = ""};
    assert_ok(ctl_mesh_match(&a, &a, &error));
    assert_int_equal(ctl_mesh_match(&a, &b, &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "triangle 1 is (0 2 3) in a and (0 3 2) in b: not two "
                        "frames of one mesh");
    uint32_t a_edges[1][2] = {{0, 1}};
    uint32_t b_edges[1][2] = {{1, 0}};
    struct ctl_mesh with_a = a, with_b = a;
    with_b.path = "b";
    with_a.edges.vertices = a_edges[0];
    with_b.edges.vertices = b_edges[0];
    with_a.edges.count = with_b.edges.count = 1;
    assert_int_equal(ctl_mesh_match(&with_a, &with_b, &error), PCCD_E_INVAL);
    assert_string_equal(
        error.text, "edge 0 has vertex 0 in a and 1 in b: not two frames of one mesh");
    with_b.edges.count = 0;
    assert_int_equal(ctl_mesh_match(&with_a, &with_b, &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "a has 1 edges and b has 0: not two frames of one mesh");
    b.triangles.count = 1;
    assert_int_equal(ctl_mesh_match(&a, &b, &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "a has 2 triangles and b has 1: not two frames of one mesh");
    b.vertex_count = 5;
    assert_int_equal(ctl_mesh_match(&a, &b, &error), PCCD_E_INVAL);
    assert_string_equal(error.text,
                        "a has 4 vertices and b has 5: not two frames of one mesh");
}

/* If it failed: what belongs to an object of a file would be told of another. */
CASE(meshfile__objects_begin_where_the_one_before_ends)
{
    struct ctl_error error = {.text = ""};
    struct ctl_mesh mesh = {.path = "a", .error = &error};
    const uint32_t corners[3] = {0, 1, 2};
    assert_ok(ctl_mesh_add_object(&mesh, "empty", 5));
    assert_ok(ctl_mesh_add_object(&mesh, "body of", 4));
    assert_ok(ctl_mesh_add(&mesh, CTL_TRIANGLES, corners));
    assert_ok(ctl_mesh_add_object(&mesh, "rod", 3));
    assert_ok(ctl_mesh_add(&mesh, CTL_EDGES, corners));
    assert_int_equal(mesh.object_count, 2);
    assert_string_equal(mesh.objects[0].name, "body");
    assert_int_equal(mesh.objects[0].first[CTL_TRIANGLES], 0);
    assert_string_equal(mesh.objects[1].name, "rod");
    assert_int_equal(mesh.objects[1].first[CTL_TRIANGLES], 1);
    assert_int_equal(mesh.objects[1].first[CTL_EDGES], 0);
    ctl_mesh_deinit(&mesh);
    assert_int_equal(mesh.object_count, 0);
}

/* If it failed: the real scenes would not be read as their description says. */
CASE(meshfile__reads_the_real_frames)
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
    for (size_t i = 0; i < KIT_COUNT(frames); i++) {
        struct ctl_mesh mesh = {0};
        struct ctl_error error = {.text = ""};
        snprintf(path, sizeof path, "%s/%s", data != NULL ? data : "", frames[i].name);
        if (access(path, R_OK) != 0) {
            test_skip("no such frames in $PCCD_DATA");
        }
        if (ctl_mesh_read(path, &mesh, &error) != PCCD_OK) {
            fail_msg("%s", error.text);
        }
        assert_int_equal(mesh.format, frames[i].format);
        assert_int_equal(mesh.vertex_count, frames[i].vertices);
        assert_int_equal(mesh.triangles.count, frames[i].triangles);
        ctl_mesh_deinit(&mesh);
    }
}

CASES_WITH(kit_make_folder, kit_remove_folder);
