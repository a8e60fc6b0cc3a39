/* test_ctl_stl_glb.c - the readers of STL and of binary glTF. */
#include "ctl_kit.h"
#include "meshfile.h"

static struct kit_bytes bytes;

static void put(const void *data, size_t count)
{
    assert_true(bytes.count + count <= KIT_FILE_BYTES_MAX);
    memcpy(bytes.data + bytes.count, data, count);
    bytes.count += count;
}

static int read_bytes(const char *name, struct ctl_mesh *mesh, struct ctl_error *error)
{
    char path[KIT_PATH_BYTES];
    *mesh = (struct ctl_mesh){0};
    error->text[0] = '\0';
    kit_write_file(name, bytes.data, bytes.count, path);
    int status = ctl_mesh_read(path, mesh, error);
    if (status != PCCD_OK) {
        assert_null(mesh->x);
        assert_true(strncmp(error->text, path, strlen(path)) == 0);
        memmove(error->text, error->text + strlen(path),
                strlen(error->text) - strlen(path) + 1);
    }
    return status;
}

/* Two triangles with an edge in common: six corners at four places, one of them with a
 * zero of the other sign. */
static const float corners[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, .1f}},
                                       {{1, -0.0f, 0}, {1, 1, 5}, {0, 1, .1f}}};
static const uint32_t joined[2][3] = {{0, 1, 2}, {1, 3, 2}};

static void put_binary_stl(uint32_t count)
{
    char head[80] = "solid as this word may also be in a binary file";
    bytes.count = 0;
    put(head, sizeof head);
    put(&count, 4);
    for (uint32_t i = 0; i < count; i++) {
        float normal[3] = {0, 0, 1};
        put(normal, sizeof normal);
        put(corners[i % 2], sizeof corners[0]);
        put("ab", 2);
    }
}

static void put_ascii_stl(void)
{
    bytes.count = 0;
    kit_put_text(&bytes, "solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
                         "   vertex 1e0 0 0\n   vertex 0 1 .1\n  endloop\n endfacet\n"
                         "endsolid one\n\nsolid\nfacet normal 0 0 0\nouter loop\n"
                         "vertex 1 -0 0\nvertex 1 1 5\nvertex 0 1 0.1\nendloop\n"
                         "endfacet\nendsolid");
}

static void check_joined(const struct ctl_mesh *mesh)
{
    const float(*x)[3] = mesh->x;
    assert_int_equal(mesh->format, PCCD_FORMAT_F32);
    assert_int_equal(mesh->vertex_count, 4);
    assert_int_equal(mesh->triangles.count, 2);
    assert_memory_equal(mesh->triangles.vertices, joined, sizeof joined);
    assert_true(x[2][2] == .1f && x[3][2] == 5.0f && x[1][0] == 1.0f);
}

/* If it failed: a surface from STL would be loose triangles, which touch each other all
 * the time, or two encodings of one surface would differ. */
CASE(stl__joins_corners_at_the_same_place)
{
    struct ctl_mesh mesh;
    struct ctl_error error;
    put_binary_stl(2);
    assert_ok(read_bytes("two.STL", &mesh, &error));
    check_joined(&mesh);
    ctl_mesh_deinit(&mesh);
    put_ascii_stl();
    assert_ok(read_bytes("two.stl", &mesh, &error));
    check_joined(&mesh);
    ctl_mesh_deinit(&mesh);
}

/* If it failed: of a long file some corners would be lost where the table grows. */
CASE(stl__joins_many_corners)
{
    enum { FACETS = 3000 };
    static char data[84 + 50 * FACETS];
    uint32_t count = FACETS;
    memcpy(data + 80, &count, 4);
    for (uint32_t i = 0; i < FACETS; i++) {
        float x[3][3] = {{0}};
        for (uint32_t k = 0; k < 3; k++) {
            x[k][0] = (float)(i + k); /* a strip: each place in up to three facets */
            x[k][1] = (float)((i + k) % 2);
        }
        memcpy(data + 84 + 50 * i + 12, x, sizeof x);
    }
    assert_ok(kit_read("strip.stl", data, sizeof data));
    assert_int_equal(kit_read_mesh.vertex_count, FACETS + 2);
    for (uint32_t i = 0; i < FACETS; i++) {
        assert_int_equal(kit_read_mesh.triangles.vertices[3 * i], i);
        assert_int_equal(kit_read_mesh.triangles.vertices[3 * i + 2], i + 2);
    }
}

/* If it failed: a broken STL would be read in part, or its message would not help. */
CASE(stl__names_what_is_wrong)
{
    static const struct {
        const char *text;
        int status;
        const char *message;
    } cases[] = {
        {"solid\n", PCCD_E_FORMAT, ": no vertices"},
        {"solid\nfacet\nouter loop\nvertex 0 0 0\n", PCCD_E_FORMAT,
         ": it ends where \"vertex\" is needed"},
        {"solid\nendsolid\n", PCCD_E_FORMAT, ": no vertices"},
        {"wings\n", PCCD_E_FORMAT, ":1: \"wings\" where \"solid\" is needed"},
        {"solid\nfacet normal 0 0 1\nvertex 0 0 0\n", PCCD_E_FORMAT,
         ":3: \"vertex\" where \"outer\" is needed"},
        {"solid\nfacet\nouter loop\nvertex 0 0\n", PCCD_E_FORMAT,
         ":4: \"\" where \"three numbers\" is needed"},
        {"solid\nfacet\nouter loop\nvertex 0 0 1e19\n", PCCD_E_NOTFINITE,
         ":4: coordinate z is 1e+19; |x| <= 1e18 is needed"},
        {"solid\nfacet\nouter loop\nvertex 0 nan 0\n", PCCD_E_NOTFINITE,
         ":4: coordinate y is nan; |x| <= 1e18 is needed"},
    };
    struct ctl_mesh mesh;
    struct ctl_error error;
    for (size_t i = 0; i < KIT_COUNT(cases); i++) {
        bytes.count = 0;
        kit_put_text(&bytes, cases[i].text);
        assert_int_equal(read_bytes("bad.stl", &mesh, &error), cases[i].status);
        assert_string_equal(error.text, cases[i].message);
    }
    put_binary_stl(2);
    memset(bytes.data + 84 + 12 + 4, 0xff, 4);
    assert_int_equal(read_bytes("bad.stl", &mesh, &error), PCCD_E_NOTFINITE);
    assert_non_null(strstr(error.text, ": facet 0, corner 0: coordinate y is "));
}

/* ---- glTF -------------------------------------------------------------------------- */

#define NODE(rest) "\"nodes\":[{\"mesh\":0" rest "}]"
#define TRIANGLE(n)                                                                      \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":" n               \
    ",\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5123,"                      \
    "\"count\":3,\"type\":\"SCALAR\"}]"
#define VIEWS                                                                            \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,"                   \
    "\"byteOffset\":48,\"byteLength\":8}],\"buffers\":[{\"byteLength\":56}]"
#define MESH(rest)                                                                       \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}" rest "}]}]"
#define FILE_OF(node, mesh, n)                                                           \
    "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}]," NODE(               \
        node) "," TRIANGLE(n) "," VIEWS "," MESH(mesh) "}"

static const float quad[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, .1f}, {0, 1, 0}};
static const uint16_t fan[4] = {2, 0, 3, 9};

static void put_glb(const char *json)
{
    char padded[2048];
    uint32_t words[2];
    uint32_t json_bytes = (uint32_t)((strlen(json) + 3) / 4 * 4);
    memset(padded, ' ', sizeof padded);
    memcpy(padded, json, strlen(json));
    bytes.count = 0;
    put("glTF", 4);
    words[0] = 2;
    words[1] = 12 + 8 + json_bytes + 8 + 56;
    put(words, 8);
    words[0] = json_bytes;
    words[1] = 0x4e4f534au;
    put(words, 8);
    put(padded, json_bytes);
    words[0] = 56;
    words[1] = 0x004e4942u;
    put(words, 8);
    put(quad, sizeof quad);
    put(fan, sizeof fan);
}

/* If it failed: a model would be read as another one, or elsewhere than it is. */
CASE(glb__reads_what_a_node_shows)
{
    struct ctl_mesh mesh;
    struct ctl_error error;
    put_glb(FILE_OF("", ",\"indices\":1", "4"));
    assert_ok(read_bytes("quad.glb", &mesh, &error));
    assert_int_equal(mesh.format, PCCD_FORMAT_F32);
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.triangles.count, 1);
    assert_memory_equal(mesh.x, quad, sizeof quad);
    assert_memory_equal(mesh.triangles.vertices, ((uint32_t[]){2, 0, 3}), 12);
    ctl_mesh_deinit(&mesh);

    put_glb(FILE_OF(",\"translation\":[0,0,0.5]", ",\"mode\":1", "4"));
    assert_ok(read_bytes("by its first bytes", &mesh, &error));
    const double(*x)[3] = mesh.x;
    assert_int_equal(mesh.format, PCCD_FORMAT_F64);
    assert_int_equal(mesh.edges.count, 2);
    assert_true(x[2][2] == (double).1f + .5 && x[3][2] == .5);
    ctl_mesh_deinit(&mesh);

    put_glb(
        FILE_OF(",\"weights\":[0.5]", ",\"mode\":0,\"targets\":[{\"POSITION\":0}]", "4"));
    assert_ok(read_bytes("moved.glb", &mesh, &error));
    assert_int_equal(mesh.points.count, 4);
    x = mesh.x; /* not rounded to floats */
    assert_true(x[1][0] == 1.5 && x[2][2] == (double).1f + .5 * (double).1f);
    ctl_mesh_deinit(&mesh);
}

/* If it failed: a file that this reader does not know would be read as something else. */
CASE(glb__names_what_it_does_not_read)
{
    static const struct {
        const char *json;
        int status;
        const char *message;
    } cases[] = {
        {"{", PCCD_E_FORMAT, ": its JSON, line 1, byte "},
        {"{}", PCCD_E_FORMAT, ": no vertices"},
        {FILE_OF("", "", "0"), PCCD_E_FORMAT, ": no vertices"},
        {FILE_OF("", ",\"indices\":1", "0"), PCCD_E_INDEX,
         ": accessor 1: index 0 is 2 of 0 vertices"},
        {FILE_OF("", "", "5"), PCCD_E_FORMAT,
         ": accessor 0: goes beyond bufferView 0, which has 48 bytes"},
        {FILE_OF("", ",\"indices\":1", "3"), PCCD_E_INDEX,
         ": accessor 1: index 2 is 3 of 3 vertices"},
        {FILE_OF("", ",\"extensions\":{\"X_compression\":{}}", "3"), PCCD_E_FORMAT,
         ": mesh 0, primitive 0: is compressed by \"X_compression\""},
        {FILE_OF(",\"translation\":[0,1e30,0]", "", "3"), PCCD_E_NOTFINITE,
         ": vertex 0: coordinate y is 1e+30; |x| <= 1e18 is needed"},
        {FILE_OF(",\"children\":[0]", "", "3"), PCCD_E_FORMAT,
         ": node 0: is below itself"},
    };
    struct ctl_mesh mesh;
    struct ctl_error error;
    for (size_t i = 0; i < KIT_COUNT(cases); i++) {
        put_glb(cases[i].json);
        int status = read_bytes("other.glb", &mesh, &error);
        if (status != cases[i].status ||
            strncmp(error.text, cases[i].message, strlen(cases[i].message)) != 0) {
            fail_msg("case %zu: %d \"%s\"", i, status, error.text);
        }
    }
    bytes.data[4] = 1;
    assert_int_equal(read_bytes("other.glb", &mesh, &error), PCCD_E_FORMAT);
    assert_string_equal(error.text, ": glTF of version 1, not 2");
}

/* If it failed: a file cut anywhere could be taken for a whole one, or read past its
 * end. */
CASE(stl_and_glb__are_refused_when_cut)
{
    struct ctl_mesh mesh;
    struct ctl_error error;
    put_binary_stl(2);
    for (size_t count = bytes.count; count-- > 0;) {
        bytes.count = count;
        assert_int_not_equal(read_bytes("cut.stl", &mesh, &error), PCCD_OK);
        assert_string_not_equal(error.text, "");
    }
    put_glb(FILE_OF("", ",\"indices\":1", "4"));
    for (size_t count = bytes.count; count-- > 0;) {
        bytes.count = count;
        assert_int_not_equal(read_bytes("cut.glb", &mesh, &error), PCCD_OK);
        assert_string_not_equal(error.text, "");
    }
}

CASES_WITH(kit_make_folder, kit_remove_folder);
