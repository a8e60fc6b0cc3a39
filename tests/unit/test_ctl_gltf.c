/* test_ctl_gltf.c - the reader of glTF, on files of known content. */
#include <unistd.h>

#include "ctl_kit.h"
#include "meshframes.h"

#define FILE_BYTES 16384
#define FLOAT      5126
#define I8         5120
#define U8         5121
#define I16        5122
#define U16        5123
#define U32        5125

/* ---- files ------------------------------------------------------------------------- */

/* File that is being made: accessors in their order, each in a view of its own. */
static struct {
    char data[FILE_BYTES], views[FILE_BYTES], accessors[FILE_BYTES];
    size_t bytes;
    int view_count, accessor_count;
} making;

static void begin(void)
{
    memset(&making, 0, sizeof making);
}

static void append(char *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void append(char *text, const char *format, ...)
{
    size_t length = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    int more = vsnprintf(text + length, FILE_BYTES - length, format, arguments);
    va_end(arguments);
    assert_true((size_t)more < FILE_BYTES - length);
}

static int add_view(const void *data, size_t bytes, const char *more)
{
    append(making.views, "%s{'buffer':0,'byteOffset':%zu,'byteLength':%zu%s}",
           making.view_count > 0 ? "," : "", making.bytes, bytes, more);
    memcpy(making.data + making.bytes, data, bytes);
    making.bytes += (bytes + 3) / 4 * 4;
    return making.view_count++;
}

static int add_entry(int view, int type, const char *kind, size_t count, const char *more)
{
    append(making.accessors, "%s{'componentType':%d,'type':'%s','count':%zu%s",
           making.accessor_count > 0 ? "," : "", type, kind, count, more);
    if (view >= 0) {
        append(making.accessors, ",'bufferView':%d", view);
    }
    append(making.accessors, "}");
    return making.accessor_count++;
}

/* Three-vectors of floats, zeros but for `count` of them; indices of that type. */
static void add_sparse(size_t all, size_t count, int index_type, int indices, int values)
{
    char sparse[256];
    snprintf(sparse, sizeof sparse,
             ",'sparse':{'count':%zu,'indices':{'bufferView':%d,'componentType':%d},"
             "'values':{'bufferView':%d}}",
             count, indices, index_type, values);
    add_entry(-1, FLOAT, "VEC3", all, sparse);
}

#define ADD(type, kind, count, array)                                                    \
    add_entry(add_view(array, sizeof(array), ""), type, kind, count, "")

static const char *maker = ""; /* of the next file; "": it does not say */

/* The JSON with ' for ", in `text`: what was added, and `rest`. */
static void describe(const char *rest, const char *uri, char *text)
{
    text[0] = '\0';
    append(text, "{'asset':{'version':'2.0'%s},'buffers':[{'byteLength':%zu%s}],", maker,
           making.bytes, uri);
    append(text, "'bufferViews':[%s],'accessors':[%s],%s}", making.views,
           making.accessors, rest);
    for (char *at = text; *at != '\0'; at++) {
        *at = *at == '\'' ? '"' : *at;
    }
}

static size_t make_glb(const char *rest, char *file)
{
    static char text[FILE_BYTES];
    describe(rest, "", text);
    uint32_t json = (uint32_t)((strlen(text) + 3) / 4 * 4);
    uint32_t head[5] = {0x46546c67, 2, 28 + json + (uint32_t)making.bytes, json,
                        0x4e4f534a};
    uint32_t chunk[2] = {(uint32_t)making.bytes, 0x004e4942};
    memset(file, ' ', 20 + json);
    memcpy(file, head, sizeof head);
    memcpy(file + 20, text, strlen(text));
    memcpy(file + 20 + json, chunk, sizeof chunk);
    memcpy(file + 28 + json, making.data, making.bytes);
    return head[2];
}

/* ---- reading ----------------------------------------------------------------------- */

static char path[KIT_PATH_BYTES];
static struct ctl_mesh mesh;
static struct ctl_motion motion;
static struct ctl_error error;
static struct ctl_motion_wish wish;

static void write_glb(const char *rest)
{
    static char file[2 * FILE_BYTES];
    size_t bytes = make_glb(rest, file);
    kit_write_file("made.glb", file, bytes, path);
}

static void finish(void)
{
    ctl_mesh_deinit(&mesh);
    ctl_motion_close(&motion);
}

static int open_path(void)
{
    finish();
    error.text[0] = '\0';
    int status = ctl_motion_open(path, ctl_gltf_open, &wish, &motion, &error);
    if (status == PCCD_OK) {
        status = ctl_mesh_read_shape(&motion, path, &mesh, &error);
    }
    if (status != PCCD_OK) {
        assert_null(mesh.x);
        assert_true(strncmp(error.text, path, strlen(path)) == 0);
    }
    return status;
}

/* Open a file of what was added and `rest`; it must be read. */
static void open_made(const char *rest)
{
    write_glb(rest);
    if (open_path() != PCCD_OK) {
        fail_msg("%s", error.text);
    }
}

/* It is refused with this text behind its name. */
static void refuse(const char *rest, int status, const char *message)
{
    write_glb(rest);
    int got = open_path();
    if (got != status || strcmp(error.text + strlen(path) + 2, message) != 0) {
        fail_msg("%d \"%s\" where \"%s\" is right", got, error.text, message);
    }
}

#define REFUSE(rest, message) refuse(rest, PCCD_E_FORMAT, message)

/* The first `count` vertices of a frame, exactly. */
static void check_frame(uint32_t frame, const double (*right)[3], size_t count)
{
    static double x[64 * 3];
    assert_true(frame < motion.frame_count && motion.vertex_count <= 64);
    if (motion.read(&motion, frame, x, &error) != PCCD_OK) {
        fail_msg("%s", error.text);
    }
    for (size_t i = 0; i < count * 3; i++) {
        double value = motion.format == PCCD_FORMAT_F32 ? (double)((float *)x)[i] : x[i];
        if (value != right[i / 3][i % 3]) {
            fail_msg("frame %u, vertex %zu: %c is %.17g, not %.17g", frame, i / 3,
                     "xyz"[i % 3], value, right[i / 3][i % 3]);
        }
    }
}

#define CHECK(frame, ...)                                                                \
    check_frame(frame, (const double[][3]){__VA_ARGS__},                                 \
                sizeof((const double[][3]){__VA_ARGS__}) / sizeof(double[3]))

/* The same as the mesh itself has them, which are those of the first frame. */
static void check_triangles(const uint32_t (*right)[3], uint32_t count)
{
    assert_int_equal(mesh.triangles.count, count);
    assert_memory_equal(mesh.triangles.vertices, right, count * sizeof *right);
}

#define TRIANGLES(...)                                                                   \
    check_triangles((const uint32_t[][3]){__VA_ARGS__},                                  \
                    sizeof((const uint32_t[][3]){__VA_ARGS__}) / sizeof(uint32_t[3]))

static const float corner[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const float square[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};

#define ONE_MESH "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]"
#define ONE_NODE "'nodes':[{'mesh':0}],'scenes':[{'nodes':[0]}],'scene':0"

static void begin_corner(void)
{
    begin();
    ADD(FLOAT, "VEC3", 3, corner);
}

/* ---- nodes ------------------------------------------------------------------------- */

/* If it failed: what is turned, scaled, mirrored or moved would be read elsewhere. */
CASE(node__transforms_apply_from_the_leaf_to_the_root)
{
    begin_corner();
    /* A quarter turn about z, and above it a mirror; by hand: (x, y, z) -> scale
     * (2x, y, -z/2) -> turn (-y, 2x, -z/2) -> move (1-y, 2+2x, 3-z/2) -> mirror x. */
    open_made(ONE_MESH ",'nodes':[{'scale':[-1,1,1],'children':[1]},"
                       "{'translation':[1,2,3],'rotation':[0,0,0.70710678,0.70710678],"
                       "'children':[2]},{'mesh':0,'scale':[2,1,-0.5]}],"
                       "'scenes':[{'nodes':[0]}]");
    CHECK(0, {-1, 4, 3}, {0, 2, 3}, {-1, 2, 2.5});
    assert_int_equal(mesh.format, PCCD_FORMAT_F32);
    assert_int_equal(motion.frame_count, 1);
    /* Columns: x to (0,1,0), y to (0,0,3), z to (1,1,0), and moved by (5,0,0). */
    open_made(ONE_MESH
              ",'nodes':[{'mesh':0,'matrix':[0,1,0,0,0,0,3,0,1,1,0,0,5,0,0,1]}]");
    CHECK(0, {5, 1, 0}, {5, 0, 3}, {6, 1, 0});
    TRIANGLES({0, 1, 2});
    /* A third of a turn about (1,1,1): each axis becomes the next one. */
    open_made(ONE_MESH ",'nodes':[{'mesh':0,'rotation':[0.5,0.5,0.5,0.5]}]");
    CHECK(0, {0, 1, 0}, {0, 0, 1}, {1, 0, 0});
}

/* If it failed: coordinates would be rounded to floats, or their type depend on what the
 * file does not say. */
CASE(node__places_are_doubles_where_floats_do_not_hold_them)
{
    begin_corner();
    open_made(ONE_MESH ",'nodes':[{'mesh':0,'translation':[0.1,0,0]}]");
    assert_int_equal(mesh.format, PCCD_FORMAT_F64);
    CHECK(0, {1.1, 0, 0}, {0.1, 1, 0}, {0.1, 0, 1});
    open_made(ONE_MESH ",'nodes':[{'mesh':0,'translation':[0.25,0,0]}]");
    assert_int_equal(mesh.format, PCCD_FORMAT_F32);
    struct ctl_mesh alone = {0};
    assert_ok(ctl_mesh_read(path, &alone, &error));
    assert_true(((const float(*)[3])alone.x)[0][0] == 1.25f);
    ctl_mesh_deinit(&alone);
}

/* If it failed: another scene would be read than the file shows. */
CASE(scene__is_the_one_that_the_file_names)
{
    static const char *const scenes[] = {
        "'scenes':[{'nodes':[0]},{'nodes':[1]}],'scene':1",
        "'scenes':[{'nodes':[1]},{'nodes':[0]}]", "'scenes':[{'nodes':[1,0]}]",
        "'scenes':[]"};
    static const uint32_t counts[] = {1, 1, 2, 2};
    static const double first[] = {8, 8, 8, 1};
    begin_corner();
    for (size_t i = 0; i < KIT_COUNT(scenes); i++) {
        char rest[512];
        snprintf(rest, sizeof rest,
                 ONE_MESH ",'nodes':[{'mesh':0},{'mesh':0,'translation':[7,0,0]}],%s",
                 scenes[i]);
        open_made(rest);
        assert_int_equal(mesh.triangles.count, counts[i]);
        CHECK(0, {first[i], 0, 0});
    }
}

/* If it failed: what nobody sees in the scene would be checked with the rest. */
CASE(node__that_is_hidden_is_passed_over)
{
#define SEEN(yes) "'extensions':{'KHR_node_visibility':{'visible':" yes "}}"
    begin_corner();
    open_made(ONE_MESH
              ",'extensionsRequired':['KHR_node_visibility'],"
              "'nodes':[{'children':[1]," SEEN("false") "},{'mesh':0," SEEN("true") "},"
              "{'mesh':0,'translation':[7,0,0]," SEEN("true") "},"
              "{'mesh':0," SEEN("false") "}]");
    assert_int_equal(mesh.triangles.count, 1);
    CHECK(0, {8, 0, 0});
#undef SEEN
}

/* If it failed: who has the file would not know which node is wrong, or the reader would
 * not come to an end. */
CASE(node__refuses_what_is_no_tree)
{
    begin_corner();
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0,'children':[1]},{'children':[0]}]",
           "node 0: is below itself");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0},{'children':[1]}]", "node 1: is below itself");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0},{'children':[0]},{'children':[0]}]",
           "node 0: is a child of node 2 and of node 1");
    refuse(ONE_MESH ",'nodes':[{'mesh':0,'children':[7]}]", PCCD_E_INDEX,
           "node 0: there is no node 7 for its children");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0},{'children':[0]}],'scenes':[{'nodes':[0]}]",
           "scene 0: node 0 is a child of another node");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0}],'scenes':[{'nodes':[0,0]}]",
           "scene 0: node 0 is there twice");
    refuse(ONE_MESH ",'nodes':[{'mesh':0}],'scenes':[{}],'scene':2", PCCD_E_INDEX,
           "scene 2: there is none");
    refuse(ONE_MESH ",'nodes':[{'mesh':3}]", PCCD_E_INDEX, "node 0: there is no mesh 3");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0,'rotation':[0,0,0,0]}]",
           "node 0: its rotation has no length");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0,'scale':[1,2]}]",
           "node 0: scale has 2 numbers, not 3");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0,'scale':[1,2,'3']}]",
           "node 0: scale[2] is no number");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0,'scale':[1,1,1],"
                    "'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]",
           "node 0: has a matrix, and a scale, too");
    REFUSE(ONE_MESH ",'nodes':[{'mesh':0,'matrix':[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]}]",
           "node 0: the last row of its matrix is not 0 0 0 1");
}

/* If it failed: a chain of bones longer than some stack would be refused, or overflow. */
CASE(node__may_be_as_deep_as_the_file_says)
{
    static char rest[FILE_BYTES];
    begin_corner();
    rest[0] = '\0';
    append(rest, ONE_MESH ",'nodes':[");
    for (int i = 0; i < 200; i++) {
        append(rest, "{'translation':[1,0,0],'children':[%d]},", i + 1);
    }
    append(rest, "{'mesh':0}],'scenes':[{'nodes':[0]}]");
    open_made(rest);
    CHECK(0, {201, 0, 0}, {200, 1, 0}, {200, 0, 1});
}

/* If it failed: parts of a file could not be told apart in a report. */
CASE(object__has_the_name_of_its_node)
{
    begin_corner();
    open_made("'meshes':[{'name':'M','primitives':[{'attributes':{'POSITION':0}},"
              "{'attributes':{'POSITION':0},'mode':0}]}],"
              "'nodes':[{'mesh':0,'name':'left'},{'mesh':0},{'name':'empty'}]");
    assert_int_equal(mesh.object_count, 2);
    assert_string_equal(mesh.objects[0].name, "left");
    assert_string_equal(mesh.objects[1].name, "M");
    assert_int_equal(mesh.objects[1].first[CTL_TRIANGLES], 1);
    assert_int_equal(mesh.objects[1].first[CTL_POINTS], 3);
    assert_int_equal(mesh.vertex_count, 6);
    open_made(ONE_MESH "," ONE_NODE);
    assert_string_equal(mesh.objects[0].name, "node 0");
}

/* If it failed: an object that stands in many places would be read in one of them. */
CASE(node__has_instances)
{
    static const float moves[2][3] = {{0, 0, 0}, {0, 0, 4}};
    static const int8_t turns[2][4] = {{0, 0, 0, 127}, {0, 0, 127, 0}};
    static const float sizes[2][3] = {{1, 1, 1}, {2, 2, 2}};
    begin_corner();
    ADD(FLOAT, "VEC3", 2, moves);
    add_entry(add_view(turns, sizeof turns, ""), I8, "VEC4", 2, ",'normalized':true");
    ADD(FLOAT, "VEC3", 2, sizes);
    ADD(FLOAT, "VEC3", 1, sizes);
#define INSTANCES(attributes)                                                            \
    ONE_MESH ",'nodes':[{'mesh':0,'name':'tree','translation':[1,0,0],'extensions':"     \
             "{'EXT_mesh_gpu_instancing':{'attributes':{" attributes "}}}}],"            \
             "'extensionsRequired':['EXT_mesh_gpu_instancing']"
    open_made(INSTANCES("'TRANSLATION':1,'ROTATION':2,'SCALE':3"));
    CHECK(0, {2, 0, 0}, {1, 1, 0}, {1, 0, 1}, {-1, 0, 4}, {1, -2, 4}, {1, 0, 6});
    assert_string_equal(mesh.objects[1].name, "tree [1]");
    TRIANGLES({0, 1, 2}, {3, 4, 5});
    REFUSE(INSTANCES("'TRANSLATION':1,'SCALE':4"),
           "node 0: SCALE of 1 instances, others of 2");
}

/* ---- primitives -------------------------------------------------------------------- */

#define MODE(mode, indices)                                                              \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':" mode indices         \
    "}]}],'nodes':[{'mesh':0}]"

/* If it failed: a mode would show other features than it names. */
CASE(primitive__has_seven_modes)
{
    begin();
    ADD(FLOAT, "VEC3", 4, square);
    open_made(MODE("0", ""));
    assert_int_equal(mesh.points.count, 4);
    open_made(MODE("1", ""));
    assert_int_equal(mesh.edges.count, 2);
    assert_memory_equal(mesh.edges.vertices, ((uint32_t[]){0, 1, 2, 3}), 16);
    open_made(MODE("2", ""));
    assert_int_equal(mesh.edges.count, 4);
    assert_memory_equal(mesh.edges.vertices, ((uint32_t[]){0, 1, 1, 2, 2, 3, 3, 0}), 32);
    open_made(MODE("3", ""));
    assert_int_equal(mesh.edges.count, 3);
    assert_memory_equal(mesh.edges.vertices, ((uint32_t[]){0, 1, 1, 2, 2, 3}), 24);
    open_made(MODE("5", ""));
    TRIANGLES({0, 1, 2}, {1, 3, 2});
    open_made(MODE("6", ""));
    TRIANGLES({1, 2, 0}, {2, 3, 0});
    REFUSE(MODE("7", ""), "mesh 0, primitive 0: there is no mode 7");
    REFUSE(MODE("4", ""), "accessor 0: 4 corners for triangles");
}

/* If it failed: indices would name other vertices, or a strip that goes on elsewhere
 * would have triangles without area, which touch all around them. */
CASE(primitive__takes_indices_of_each_type)
{
    static const uint8_t bytes[6] = {2, 1, 0, 1, 2, 3}, restart[3] = {0, 1, 255};
    static const uint16_t words[8] = {0, 1, 2, 2, 3, 3, 1, 0};
    static const uint32_t longs[3] = {3, 0, 4};
    begin();
    ADD(FLOAT, "VEC3", 4, square);
    ADD(U8, "SCALAR", 6, bytes);
    ADD(U16, "SCALAR", 8, words);
    ADD(U32, "SCALAR", 3, longs);
    ADD(U8, "SCALAR", 3, restart);
    ADD(U8, "SCALAR", 2, restart);
    open_made(MODE("4", ",'indices':1"));
    TRIANGLES({2, 1, 0}, {1, 2, 3});
    /* 0 1 2 | 1 2 2 | 2 2 3 | 2 3 3 | 3 3 1 | 3 1 0, turned at every second one. */
    open_made(MODE("5", ",'indices':2"));
    TRIANGLES({0, 1, 2}, {3, 0, 1});
    refuse(MODE("4", ",'indices':3"), PCCD_E_INDEX,
           "accessor 3: index 2 is 4 of 4 vertices");
    REFUSE(MODE("4", ",'indices':4"),
           "accessor 4: index 2 is 255, which would begin a primitive anew");
    REFUSE(MODE("5", ",'indices':5"), "accessor 5: 2 corners for a triangle strip");
    REFUSE(MODE("4", ",'indices':0"),
           "accessor 0: has VEC3 of component type 5126 where SCALAR is needed");
    REFUSE(MODE("4", ",'indices':9"), "accessor 9: there is none");
}

/* If it failed: two parts of a surface would fall apart, or those that move otherwise be
 * joined. */
CASE(primitive__shares_vertices_that_move_alike)
{
    begin_corner();
    ADD(FLOAT, "VEC3", 3, corner);
    open_made("'meshes':[{'primitives':[{'attributes':{'POSITION':0}},"
              "{'attributes':{'POSITION':1}},{'attributes':{'POSITION':0}}]}],"
              "'nodes':[{'mesh':0}]");
    TRIANGLES({0, 1, 2}, {3, 4, 5}, {0, 1, 2});
    open_made("'meshes':[{'weights':[1],'primitives':["
              "{'attributes':{'POSITION':0},'targets':[{'POSITION':1}]},"
              "{'attributes':{'POSITION':0},'targets':[{}]}]}],'nodes':[{'mesh':0}]");
    TRIANGLES({0, 1, 2}, {3, 4, 5});
    CHECK(0, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
}

/* ---- accessors --------------------------------------------------------------------- */

#define POSITIONS(number)                                                                \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':" number                         \
    "},'mode':0}]}],'nodes':[{'mesh':0,'scale':[0.5,0.5,0.5]}]"

/* If it failed: vertices would be where other bytes of the file put them. */
CASE(accessor__reads_steps_types_and_what_is_sparse)
{
    static const float spread[5] = {1, 2, 3, 9, 4};
    static const float spread_more[7] = {1, 2, 3, 9, 4, 5, 6};
    static const int16_t words[6] = {1, -2, 300, -32768, 0, 7};
    static const uint8_t bytes[6] = {255, 0, 51, 1, 2, 3};
    static const uint16_t which[1] = {1};
    static const float what[3] = {6, 8, 10};
    begin();
    add_entry(add_view(spread_more, sizeof spread_more, ",'byteStride':16"), FLOAT,
              "VEC3", 2, "");
    ADD(I16, "VEC3", 2, words);
    ADD(U8, "VEC3", 2, bytes);
    add_entry(add_view(bytes, sizeof bytes, ""), U8, "VEC3", 1, ",'normalized':true");
    add_entry(add_view(words, sizeof words, ""), I16, "VEC3", 2, ",'normalized':true");
    int at = add_view(which, sizeof which, "");
    int values = add_view(what, sizeof what, "");
    add_sparse(2, 1, U16, at, values);
    add_entry(add_view(spread, sizeof spread, ",'byteStride':8"), FLOAT, "VEC3", 2, "");
    open_made(POSITIONS("0"));
    CHECK(0, {0.5, 1, 1.5}, {2, 2.5, 3});
    open_made(POSITIONS("1"));
    CHECK(0, {0.5, -1, 150}, {-16384, 0, 3.5});
    open_made(POSITIONS("2"));
    CHECK(0, {127.5, 0, 25.5}, {0.5, 1, 1.5});
    open_made(POSITIONS("3")); /* 51/255 is a fifth */
    CHECK(0, {0.5, 0, 0.1});
    open_made(POSITIONS("4")); /* -32768 stands for -1, as -32767 does */
    CHECK(0, {0.5 / 32767, -1. / 32767, 150. / 32767}, {-0.5, 0, 3.5 / 32767});
    open_made(POSITIONS("5"));
    CHECK(0, {0, 0, 0}, {3, 4, 5});
    REFUSE(POSITIONS("6"), "bufferView 7: a stride of 8 bytes for elements of 12");
}

/* If it failed: a file could make the reader look beyond its bytes, or take memory that
 * it does not pay for. */
CASE(accessor__is_held_to_the_bytes_of_the_file)
{
    static const uint8_t order[2] = {1, 0}, twice[2] = {1, 1};
    begin();
    int view = add_view(corner, sizeof corner, "");
    add_entry(view, FLOAT, "VEC3", 4, "");
    add_entry(view, FLOAT, "VEC3", 3, ",'byteOffset':4");
    add_entry(view, FLOAT, "VEC3", 2147483647, "");
    add_entry(-1, FLOAT, "VEC3", 1000000, "");
    int bytes = add_view(order, sizeof order, "");
    add_sparse(3, 2, U8, bytes, view);
    add_sparse(3, 2, U8, add_view(twice, sizeof twice, ""), view);
    REFUSE(POSITIONS("0"), "accessor 0: goes beyond bufferView 0, which has 36 bytes");
    REFUSE(POSITIONS("1"), "accessor 1: goes beyond bufferView 0, which has 36 bytes");
    REFUSE(POSITIONS("2"), "accessor 2: goes beyond bufferView 0, which has 36 bytes");
    refuse(POSITIONS("4"), PCCD_E_INDEX,
           "accessor 4: sparse index 1 is 0 of 3, and they ascend");
    refuse(POSITIONS("5"), PCCD_E_INDEX,
           "accessor 5: sparse index 1 is 1 of 3, and they ascend");
    write_glb(POSITIONS("3"));
    assert_int_equal(open_path(), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, ": accessor 3: has 1000000 zeros in a file of "));
    write_glb(POSITIONS("4") ",'nodes':[]"); /* which of the two is meant? */
    assert_int_equal(open_path(), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, "duplicate object key"));
}

/* ---- extensions, buffers ----------------------------------------------------------- */

/* If it failed: what a file cannot be read without would be left out, or a lamp keep a
 * surface from being read. */
CASE(extension__is_refused_by_its_name_unless_it_is_harmless)
{
    begin_corner();
    open_made(ONE_MESH
              "," ONE_NODE
              ",'extensionsRequired':['KHR_lights_punctual','KHR_materials_unlit',"
              "'KHR_texture_transform','KHR_mesh_quantization'],"
              "'extensionsUsed':['EXT_something'],'cameras':[{}],'materials':[{}]");
    REFUSE(ONE_MESH "," ONE_NODE ",'extensionsRequired':['EXT_something']",
           "it requires the extension \"EXT_something\", which is not read");
    REFUSE("'meshes':[{'primitives':[{'attributes':{'POSITION':0},'extensions':"
           "{'KHR_draco_mesh_compression':{'bufferView':0}}}]}]," ONE_NODE,
           "mesh 0, primitive 0: is compressed by \"KHR_draco_mesh_compression\", which "
           "is not read");
    begin();
    add_entry(add_view(corner, sizeof corner,
                       ",'extensions':{'EXT_meshopt_compression':{'buffer':0}}"),
              FLOAT, "VEC3", 3, "");
    REFUSE(
        ONE_MESH "," ONE_NODE,
        "bufferView 0: is compressed by \"EXT_meshopt_compression\", which is not read");
}

static int read_text(const char *uri)
{
    static char text[FILE_BYTES];
    text[0] = '\0';
    describe(ONE_MESH "," ONE_NODE, uri, text + 3);
    memcpy(text, "\xef\xbb\xbf", 3); /* a byte order mark */
    kit_write_file("made.gltf", text, 3 + strlen(text + 3), path);
    return open_path();
}

/* If it failed: a file of text would not find its data, or read files that its folder
 * does not have. */
CASE(buffer__is_of_this_file_or_beside_it)
{
    static const char *const outside[] = {
        "../made.bin",     "/etc/passwd", "http://a/b.bin",
        "%2e%2e/made.bin", "a/../../b",   "file:made.bin",
        "a%5cb",           "%zz",         "%00"};
    char beside[KIT_PATH_BYTES], message[512];
    begin_corner();
    kit_write_file("made one.bin", making.data, making.bytes, beside);
    assert_ok(read_text(",'uri':'made%20one.bin'"));
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    /* 1 is the bytes 00 00 80 3f, 0 four zeros. */
    assert_ok(read_text(",'uri':'data:application/octet-stream;base64,"
                        "AACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/'"));
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    assert_int_equal(read_text(",'uri':'data:;base64,AACAP*AA'"), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, ": buffer 0: its data: URI is no base64"));
    assert_int_equal(read_text(",'uri':'data:;base64,AACA'"), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, ": buffer 0: has 3 bytes, not 36"));
    assert_int_equal(read_text(",'uri':'data:,1'"), PCCD_E_FORMAT);
    assert_non_null(strstr(error.text, ": buffer 0: its data: URI has no base64"));
    assert_int_equal(read_text(""), PCCD_E_FORMAT);
    assert_non_null(
        strstr(error.text, ": buffer 0: has no URI, and no data in the file"));
    assert_int_equal(read_text(",'uri':'none.bin'"), PCCD_E_SYSTEM);
    assert_non_null(strstr(error.text, "none.bin: cannot open"));
    for (size_t i = 0; i < KIT_COUNT(outside); i++) {
        snprintf(message, sizeof message, ",'uri':'%s'", outside[i]);
        assert_int_equal(read_text(message), PCCD_E_FORMAT);
        snprintf(message, sizeof message, ": buffer 0: \"%s\" is no file of this folder",
                 outside[i]);
        assert_non_null(strstr(error.text, message));
    }
}

/* ---- morph targets ----------------------------------------------------------------- */

/* If it failed: a shape key would be left out, taken for another one's weight, or
 * rounded. */
CASE(morph__adds_targets_by_the_weights)
{
    static const int8_t small[3][3] = {{0, 127, 0}, {0, 0, 0}, {0, 0, -127}};
    static const uint8_t which[1] = {2};
    static const float what[3] = {8, 0, 0};
    begin_corner();
    add_entry(add_view(small, sizeof small, ""), I8, "VEC3", 3, ",'normalized':true");
    int at = add_view(which, sizeof which, ""), values = add_view(what, sizeof what, "");
    add_sparse(3, 1, U8, at, values);
    ADD(FLOAT, "VEC3", 2, square);
#define MORPHED(mesh_weights, node_weights)                                              \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'targets':[{'POSITION':1},"   \
    "{'NORMAL':0},{'POSITION':2}]}]" mesh_weights "}],'nodes':[{'mesh':0" node_weights   \
    "}]"
    open_made(MORPHED("", ""));
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    open_made(MORPHED(",'weights':[0.5,9,0.25]", ""));
    CHECK(0, {1, 0.5, 0}, {0, 1, 0}, {2, 0, 0.5});
    open_made(MORPHED(",'weights':[0.5,9,0.25]", ",'weights':[0,0,0.1]"));
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0.8, 0, 1});
    assert_int_equal(mesh.format, PCCD_FORMAT_F64);
    REFUSE(MORPHED(",'weights':[1]", ""), "mesh 0: weights has 1 numbers, not 3");
    REFUSE("'meshes':[{'primitives':[{'attributes':{'POSITION':0},"
           "'targets':[{'POSITION':3}]}]}]," ONE_NODE,
           "accessor 3: a morph target of 2 vertices for 3 vertices");
}

/* If it failed: a step that pccdctl has exported would be read from other places than it
 * was computed for. */
CASE(morph__of_an_export_are_floats_again)
{
    static const float first[3][3] = {{0.1f, 0.2f, 0.3f}, {1, 2, 3}, {5, 6, 7}};
    static const float last[3][3] = {{0.7f, 0.9f, 1.3f}, {0.1f, 0.3f, 0.7f}, {8, 6, 9}};
    float motion_of[3][3];
    double places[3][3];
    for (int i = 0; i < 9; i++) {
        motion_of[i / 3][i % 3] = last[i / 3][i % 3] - first[i / 3][i % 3];
        places[i / 3][i % 3] = (double)(first[i / 3][i % 3] + motion_of[i / 3][i % 3]);
    }
    begin();
    ADD(FLOAT, "VEC3", 3, first);
    ADD(FLOAT, "VEC3", 3, motion_of);
    maker = ",'generator':'pccdctl export'";
    open_made("'meshes':[{'primitives':[{'attributes':{'POSITION':0},"
              "'targets':[{'POSITION':1}]}],'weights':[1]}],"
              "'nodes':[{'name':'sleeve','mesh':0}]");
    maker = "";
    check_frame(0, (const double(*)[3])places, 3);
    assert_int_equal(mesh.format, PCCD_FORMAT_F32);
}

/* ---- skins ------------------------------------------------------------------------- */

/* Accessors 1: joints, 2: weights as floats, 3: as bytes, 4: inverse matrices, 5: joints
 * that are not there, 6: a second set, 7: no weight at all. */
static void begin_skin(void)
{
    static const uint8_t joints[3][4] = {{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}};
    static const float weights[3][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}, {.25f, .75f, 0, 0}};
    static const uint8_t narrow[3][4] = {{255, 0}, {255, 0}, {51, 204}};
    static const float matrices[2][16] = {
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1}};
    static const uint8_t beyond[3][4] = {{0, 0, 0, 0}, {0, 2, 0, 0}};
    static const uint16_t more[3][4] = {{1}, {1}, {1}};
    static const float none[3][4] = {{0}};
    begin_corner();
    ADD(U8, "VEC4", 3, joints);
    ADD(FLOAT, "VEC4", 3, weights);
    add_entry(add_view(narrow, sizeof narrow, ""), U8, "VEC4", 3, ",'normalized':true");
    ADD(FLOAT, "MAT4", 2, matrices);
    ADD(U8, "VEC4", 3, beyond);
    ADD(U16, "VEC4", 3, more);
    ADD(FLOAT, "VEC4", 3, none);
}

/* The first joint stands 2 along x; the second 1 above it, turned a quarter about z. */
#define SKINNED(attributes, skin)                                                        \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0," attributes "}}]}],"          \
    "'nodes':[{'mesh':0,'skin':0,'translation':[100,0,0],'scale':[7,7,7]},"              \
    "{'translation':[2,0,0],'children':[2]},"                                            \
    "{'translation':[0,0,1],'rotation':[0,0,0.70710678,0.70710678]}],"                   \
    "'skins':[{'joints':[1,2]" skin "}]"
#define INVERSES ",'inverseBindMatrices':4"

/* If it failed: a body that bends would stand as it was bound, or twice away from
 * there. */
CASE(skin__puts_vertices_where_the_joints_are)
{
    begin_skin();
    /* Joint 0: (x+2, y, z); joint 1 after its inverse: (-y+2, x, z). Vertex 2 is (0,0,1),
     * which both put at (2,0,1); vertex 0 has joint 0, vertex 1 joint 1. */
    open_made(SKINNED("'JOINTS_0':1,'WEIGHTS_0':2", INVERSES));
    CHECK(0, {3, 0, 0}, {1, 0, 0}, {2, 0, 1});
    /* Without inverses joint 1 is 1 higher. */
    open_made(SKINNED("'JOINTS_0':1,'WEIGHTS_0':2", ""));
    CHECK(0, {3, 0, 0}, {1, 0, 1}, {2, 0, 1.75});
    open_made(SKINNED("'JOINTS_0':1,'WEIGHTS_0':3", ""));
    CHECK(0, {3, 0, 0}, {1, 0, 1}, {2, 0, 1.8});
    /* A second set weighs as much: (1,0,0) by halves of (3,0,0) and (2,1,1). */
    open_made(SKINNED("'JOINTS_0':1,'WEIGHTS_0':2,'JOINTS_1':6,'WEIGHTS_1':2", ""));
    CHECK(0, {2.5, 0.5, 0.5}, {1, 0, 1});
}

/* If it failed: a joint that is not there would be read, or a vertex go to the origin. */
CASE(skin__names_what_is_wrong)
{
    begin_skin();
    refuse(SKINNED("'JOINTS_0':5,'WEIGHTS_0':2", ""), PCCD_E_INDEX,
           "accessor 5: vertex 1 has joint 2 of 2");
    REFUSE(SKINNED("'JOINTS_0':1,'WEIGHTS_0':7", ""),
           "accessor 7: the weights of vertex 0 have the sum 0");
    REFUSE(SKINNED("'JOINTS_0':1", ""), "accessor -1: there is none");
    REFUSE(
        SKINNED("'JOINTS_0':1,'WEIGHTS_0':1", ""),
        "accessor 1: has integers that are not normalized, where fractions are needed");
    REFUSE(SKINNED("'NORMAL':0", ""), "mesh 0: has no joints for the skin of node 0");
    REFUSE(SKINNED("'JOINTS_0':1,'WEIGHTS_0':2", ",'inverseBindMatrices':0"),
           "accessor 0: has VEC3 of component type 5126 where MAT4 is needed");
    refuse("'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':1,"
           "'WEIGHTS_0':2}}]}],'nodes':[{'mesh':0,'skin':0}],'skins':[{'joints':[8]}]",
           PCCD_E_INDEX, "skin 0: joint 0 is node 8 of 1");
}

/* ---- animation --------------------------------------------------------------------- */

/* Accessors 1: times 0.25, 0.5, 1; 2: values of a vector; 3: of a rotation; 4: cubic
 * ones; 5: weights of one target; 6: times 0, 2; 7: times that do not ascend. */
static void begin_animation(void)
{
    static const float times[3] = {0.25f, 0.5f, 1}, two[2] = {0, 2}, wrong[3] = {0, 1, 1};
    static const float vectors[3][3] = {{0, 0, 0}, {4, 0, 0}, {4, 8, 2}};
    static const float turns[3][4] = {
        {0, 0, 0, 1}, {0, 0, .70710678f, .70710678f}, {0, 0, -1, 0}};
    static const float cubic[6][3] = {{9, 9, 9}, {1, 0, 0}, {4, 0, 0},
                                      {0, 8, 0}, {3, 0, 0}, {9, 9, 9}};
    static const float weights[3] = {0, 1, 0.5f};
    begin_corner();
    ADD(FLOAT, "SCALAR", 3, times);
    ADD(FLOAT, "VEC3", 3, vectors);
    ADD(FLOAT, "VEC4", 3, turns);
    ADD(FLOAT, "VEC3", 6, cubic);
    ADD(FLOAT, "SCALAR", 3, weights);
    ADD(FLOAT, "SCALAR", 2, two);
    ADD(FLOAT, "SCALAR", 3, wrong);
}

#define SAMPLER(input, output, more) "{'input':" input ",'output':" output more "}"
#define CHANNEL(sampler, node, path)                                                     \
    "{'sampler':" sampler ",'target':{'node':" node ",'path':'" path "'}}"
#define MOVED(samplers, channels)                                                        \
    ONE_MESH "," ONE_NODE ",'animations':[{'samplers':[" samplers                        \
             "],'channels':[" channels "]}]"
#define STEP  ",'interpolation':'STEP'"
#define CUBIC ",'interpolation':'CUBICSPLINE'"

/* If it failed: an object would be elsewhere than the file has it at that time. */
CASE(animation__interpolates_as_its_samplers_say)
{
    char name[64], note[256];
    begin_animation();
    open_made(MOVED(SAMPLER("1", "2", ""), CHANNEL("0", "0", "translation")));
    assert_int_equal(motion.frame_count, 3);
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(2, {5, 8, 2}, {4, 9, 2}, {4, 8, 3});
    CHECK(1, {5, 0, 0}, {4, 1, 0}, {4, 0, 1});
    motion.name(&motion, 0, name, sizeof name);
    assert_string_equal(name, "0.25 s");
    wish.rate = 8; /* 0.25, 0.375, 0.5, 0.625 .. 1 */
    open_made(MOVED(SAMPLER("1", "2", ""), CHANNEL("0", "0", "translation")));
    assert_int_equal(motion.frame_count, 7);
    CHECK(1, {3, 0, 0});
    CHECK(3, {5, 2, 0.5});
    CHECK(6, {5, 8, 2});
    motion.name(&motion, 1, name, sizeof name);
    assert_string_equal(name, "0.375 s");
    open_made(MOVED(SAMPLER("1", "2", STEP), CHANNEL("0", "0", "translation")));
    CHECK(1, {1, 0, 0});
    CHECK(2, {5, 0, 0});
    CHECK(5, {5, 0, 0});
    open_made(MOVED(SAMPLER("1", "2", ""), CHANNEL("0", "0", "scale")));
    CHECK(6, {4, 0, 0}, {0, 8, 0}, {0, 0, 2});
    wish.rate = 2;
    /* Of 2 seconds, at a quarter: 27/32 of the first, 5/32 of the second, and the span
     * times 9/64 of its out-tangent, and -3/64 of the in-tangent of the second. */
    open_made(MOVED(SAMPLER("6", "4", CUBIC), CHANNEL("0", "0", "translation")));
    assert_int_equal(motion.frame_count, 5);
    CHECK(0, {2, 0, 0});
    CHECK(1, {1 + 27. / 32 + 3 * 5. / 32 + 2 * 4 * 9. / 64, 2 * 8 * -3. / 64, 0});
    CHECK(2, {1 + 0.5 + 1.5 + 2 * 4 / 8., 2 * 8 * -1 / 8., 0});
    CHECK(4, {4, 0, 0});
    wish.rate = 0;
    open_made(MOVED(SAMPLER("6", "4", CUBIC), CHANNEL("0", "0", "translation")));
    assert_true(motion.note(&motion, note, sizeof note));
    assert_string_equal(note, "nodes curve between two keyframes: --rate N has frames "
                              "between them");
    finish();
}

static double distance(const double *x, double a, double b)
{
    return (x[0] - a) * (x[0] - a) + (x[1] - b) * (x[1] - b);
}

/* If it failed: a turn would be cut short, go the longer way round, or not be told where
 * keys alone do not show it. */
CASE(animation__turns_the_shorter_way_on_a_circle)
{
    double x[3][3];
    char note[256];
    begin_animation();
    /* From 0 by a quarter, and then to z = -1, which is half a turn, as z = 1 is. */
    open_made(MOVED(SAMPLER("1", "3", ""), CHANNEL("0", "0", "rotation")));
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(1, {0, 1, 0}, {-1, 0, 0}, {0, 0, 1});
    CHECK(2, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1});
    assert_true(motion.note(&motion, note, sizeof note));
    assert_string_equal(note, "nodes turn between two keyframes (up to 90 degrees): "
                              "--rate N has frames between them");
    wish.rate = 12; /* every third of the first quarter, every sixth of the second */
    open_made(MOVED(SAMPLER("1", "3", ""), CHANNEL("0", "0", "rotation")));
    assert_int_equal(motion.frame_count, 10);
    assert_true(motion.note(&motion, note, sizeof note));
    assert_string_equal(note, "nodes turn between two frames (up to 30 degrees): a "
                              "greater --rate has frames between them");
    static const double thirds[10][2] = {{1, 0},
                                         {.86602540378443864676, .5},
                                         {.5, .86602540378443864676},
                                         {0, 1},
                                         {-.25881904510252076235, .96592582628906828675},
                                         {-.5, .86602540378443864676},
                                         {-.70710678118654752440, .70710678118654752440},
                                         {-.86602540378443864676, .5},
                                         {-.96592582628906828675, .25881904510252076235},
                                         {-1, 0}};
    for (uint32_t frame = 0; frame < 10; frame++) {
        assert_ok(motion.read(&motion, frame, x, &error));
        assert_true(distance(x[0], thirds[frame][0], thirds[frame][1]) < 1e-30);
    }
    wish.rate = 1000; /* a third of a degree a frame */
    open_made(MOVED(SAMPLER("1", "3", ""), CHANNEL("0", "0", "rotation")));
    assert_false(motion.note(&motion, note, sizeof note));
    wish.rate = 0;
}

#define TARGETED                                                                         \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'targets':[{'POSITION':0}]}]" \
    "}]"
#define TWO_ANIMATIONS(mesh, path_1, node_2, path_2)                                     \
    mesh ",'nodes':[{'mesh':0},{'mesh':0,'translation':[0,0,9]},{'camera':0}],"          \
         "'animations':[{'name':'still','samplers':[],'channels':[]},"                   \
         "{'name':'one','samplers':[" SAMPLER("1", "2", "") "],'channels':[" CHANNEL(    \
             "0", "0", path_1) "]},"                                                     \
                               "{'name':'two','samplers':[" SAMPLER(                     \
                                   "6", "4",                                             \
                                   CUBIC) "],'channels':[" CHANNEL("0", node_2,          \
                                                                   path_2) "]}]"

/* If it failed: one animation would be left out or taken for another without a word, or a
 * camera that moves make frames. */
CASE(animation__is_chosen_and_told)
{
    char note[256];
    begin_animation();
    /* Two that move other things are played at once: at 0, .25, .5, 1 and 2. */
    open_made(TWO_ANIMATIONS(ONE_MESH, "translation", "1", "scale"));
    assert_int_equal(motion.frame_count, 5);
    CHECK(4, {5, 8, 2}, {4, 9, 2}, {4, 8, 3}, {3, 0, 9}, {0, 0, 9}, {0, 0, 9});
    /* Two that move the same are not. */
    open_made(TWO_ANIMATIONS(ONE_MESH, "translation", "0", "translation"));
    assert_int_equal(motion.frame_count, 3);
    assert_true(motion.note(&motion, note, sizeof note));
    assert_string_equal(note, "animation 1 \"one\" of 2 is read; --animation NAME takes "
                              "another");
    wish.animation = "two";
    open_made(TWO_ANIMATIONS(ONE_MESH, "translation", "0", "translation"));
    assert_int_equal(motion.frame_count, 2);
    CHECK(1, {4, 0, 0});
    wish.animation = "1";
    open_made(TWO_ANIMATIONS(ONE_MESH, "translation", "0", "translation"));
    CHECK(2, {5, 8, 2});
    wish.animation = "three";
    refuse(TWO_ANIMATIONS(ONE_MESH, "translation", "0", "translation"), PCCD_E_INVAL,
           "no animation has the name or number \"three\", of 3");
    wish.animation = NULL;
    /* A camera's keys make no frames. */
    open_made(TWO_ANIMATIONS(ONE_MESH, "translation", "2", "translation"));
    assert_int_equal(motion.frame_count, 3);
    assert_false(motion.note(&motion, note, sizeof note));
    /* Weights of a morph target, whatever the node has at rest. */
    open_made(TARGETED "," ONE_NODE ",'animations':[{'samplers':[" SAMPLER(
        "1", "5", "") "],'channels':[" CHANNEL("0", "0", "weights") "]}]");
    CHECK(0, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    CHECK(1, {2, 0, 0}, {0, 2, 0}, {0, 0, 2});
    CHECK(2, {1.5, 0, 0}, {0, 1.5, 0}, {0, 0, 1.5});
    assert_int_equal(motion.format, PCCD_FORMAT_F64);
    finish();
}

/* Bytes that this process has read. */
static unsigned long long bytes_read(void)
{
    unsigned long long bytes = 0;
    FILE *io = fopen("/proc/self/io", "r");
    assert_non_null(io);
    assert_int_equal(fscanf(io, "rchar: %llu", &bytes), 1);
    fclose(io);
    return bytes;
}

/* If it failed: a file that moves would be read once to count its frames, and then once
 * more for its shape, or where it is not the first. */
CASE(animation__is_read_once)
{
    static const struct ctl_frames_options as_it_is = {.weld = -1};
    static char rest[8192];
    struct ctl_frames frames;
    struct ctl_mesh frame = {0};
    begin_animation();
    snprintf(rest, sizeof rest, "%s%6000s",
             MOVED(SAMPLER("1", "2", ""), CHANNEL("0", "0", "translation")), "");
    write_glb(rest);
    unsigned long long before = bytes_read();
    assert_ok(ctl_frames_open(&frames, (char *[]){path, path}, 2, &as_it_is, &error));
    for (uint32_t i = 0; i < frames.count; i++) {
        assert_ok(ctl_frames_read(&frames, i, &frame, &error));
    }
    assert_int_equal(frames.count, 6);
    assert_true(bytes_read() - before < 3 * 6000); /* two files */
    ctl_mesh_deinit(&frame);
    ctl_frames_close(&frames);
}

/* If it failed: two files that move would be taken for one mesh, whose faces differ. */
CASE(animation__goes_on_in_another_file_of_the_same_mesh)
{
    static const float times[2] = {0, 1}, moves[2][3] = {{2, 0, 0}, {2, 0, 4}};
    char names[3][KIT_PATH_BYTES];
    for (int i = 0; i < 3; i++) {
        static const uint8_t order[3][3] = {{0, 1, 2}, {0, 1, 2}, {0, 2, 1}};
        static char file[2 * FILE_BYTES];
        begin_corner();
        ADD(U8, "SCALAR", 3, order[i]);
        ADD(FLOAT, "SCALAR", 2, times);
        ADD(FLOAT, "VEC3", 2, moves);
        size_t bytes = make_glb("'meshes':[{'primitives':[{'attributes':{'POSITION':0},"
                                "'indices':1}]}]," ONE_NODE
                                ",'animations':[{'samplers':[{'input':2,'output':3}],"
                                "'channels':[" CHANNEL("0", "0", "translation") "]}]",
                                file);
        char name[16];
        snprintf(name, sizeof name, "%d.glb", i);
        kit_write_file(name, file, bytes, names[i]);
    }
    static const struct ctl_frames_options as_it_is;
    for (int i = 1; i < 3; i++) {
        char *paths[2] = {names[0], names[i]};
        struct ctl_frames frames;
        struct ctl_mesh frame = {0};
        assert_ok(ctl_frames_open(&frames, paths, 2, &as_it_is, &error));
        assert_int_equal(frames.count, 4);
        assert_ok(ctl_frames_read(&frames, 1, &frame, &error));
        assert_true(((const double(*)[3])frame.x)[0][2] == 4);
        int status = ctl_frames_read(&frames, 2, &frame, &error);
        assert_int_equal(status, i == 1 ? PCCD_OK : PCCD_E_INVAL);
        ctl_mesh_deinit(&frame);
        ctl_frames_close(&frames);
    }
}

/* If it failed: a joint that moves would leave the skin behind. */
CASE(animation__moves_joints)
{
    static const float times[2] = {0, 1}, moves[2][3] = {{2, 0, 0}, {2, 0, 4}};
    begin_skin();
    ADD(FLOAT, "SCALAR", 2, times);
    ADD(FLOAT, "VEC3", 2, moves);
    /* The skinned node moves, too, and nothing with it. */
    open_made(SKINNED(
        "'JOINTS_0':1,'WEIGHTS_0':2",
        INVERSES) ",'animations':[{'samplers':[{'input':8,'output':9}],'channels':["
                  "{'sampler':0,'target':{'node':1,'path':'translation'}},"
                  "{'sampler':0,'target':{'node':0,'path':'translation'}}]}]");
    assert_int_equal(motion.frame_count, 2);
    CHECK(0, {3, 0, 0}, {1, 0, 0}, {2, 0, 1});
    CHECK(1, {3, 0, 4}, {1, 0, 4}, {2, 0, 5});
}

/* If it failed: a motion that is not understood would be left out in silence. */
CASE(animation__names_what_is_wrong)
{
    begin_animation();
    REFUSE(MOVED(SAMPLER("7", "2", ""), CHANNEL("0", "0", "translation")),
           "accessor 7: key 2 is at 1 s, not after the one before it");
    REFUSE(MOVED(SAMPLER("6", "2", ""), CHANNEL("0", "0", "translation")),
           "accessor 2: has 3 values for 2 keys of 1 each");
    REFUSE(MOVED(SAMPLER("1", "2", ",'interpolation':'BEZIER'"),
                 CHANNEL("0", "0", "translation")),
           "sampler 0: interpolation \"BEZIER\" is none of STEP, LINEAR, CUBICSPLINE");
    REFUSE(MOVED("", CHANNEL("0", "0", "translation")), "sampler 0: there is none");
    refuse(MOVED("", CHANNEL("0", "4", "translation")), PCCD_E_INDEX,
           "there is no node 4 to move");
    REFUSE(MOVED(SAMPLER("1", "2", ""),
                 CHANNEL("0", "0", "scale") "," CHANNEL("0", "0", "scale")),
           "animation 0: moves the scale of node 0 twice");
    REFUSE(MOVED("", "{'target':{'path':'pointer','extensions':{'KHR_animation_pointer':"
                     "{'pointer':'/nodes/0/scale'}}}}"),
           "\"/nodes/0/scale\" is moved by \"KHR_animation_pointer\", which is not read");
    open_made(MOVED("",
                    "{'target':{'path':'pointer','extensions':{"
                    "'KHR_animation_pointer':{'pointer':'/materials/0/alphaCutoff'}}}}"));
    assert_int_equal(motion.frame_count, 1);
    REFUSE(ONE_MESH "," ONE_NODE ",'extensionsRequired':['KHR_animation_pointer']",
           "it requires the extension \"KHR_animation_pointer\", which is not read");
    REFUSE(ONE_MESH
           ",'nodes':[{'mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],"
           "'animations':[{'samplers':[],'channels':[" CHANNEL("0", "0", "scale") "]}]",
           "node 0: moves and has a matrix");
}

/* ---- any bytes --------------------------------------------------------------------- */

/* If it failed: a broken file could end the program, or be read beyond its end. */
CASE(file__with_changed_bytes_is_refused_or_read)
{
    static char file[2 * FILE_BYTES], changed[2 * FILE_BYTES];
    static double x[1 << 16];
    uint64_t random = 12345;
    int read = 0;
    begin_skin();
    static const float times[2] = {0, 1}, turns[2][4] = {{0, 0, 0, 1}, {0, 1, 0, 0}};
    ADD(FLOAT, "SCALAR", 2, times);
    ADD(FLOAT, "VEC4", 2, turns);
    size_t bytes = make_glb(
        SKINNED("'JOINTS_0':1,'WEIGHTS_0':2,'JOINTS_1':6,'WEIGHTS_1':3},"
                "'targets':[{'POSITION':0}],'x':{",
                INVERSES) ",'animations':[{'samplers':[" SAMPLER("8", "9",
                                                                 "") "],'channels':"
                                                                     "[" CHANNEL("0", "2",
                                                                                 "rotatio"
                                                                                 "n") "]}"
                                                                                      "]",
        file);
    for (int i = 0; i < 2000; i++) {
        memcpy(changed, file, bytes);
        for (int k = 0; k < 1 + i % 3; k++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            size_t at = (size_t)(random >> 33) % bytes;
            /* Digits of the JSON become other digits, bytes of the data any others. */
            bool is_digit = changed[at] >= '0' && changed[at] <= '9';
            changed[at] = is_digit ? (char)('0' + (random >> 20) % 10)
                                   : (char)(random >> 20 & (i % 2 ? 255 : 15));
        }
        kit_write_file("changed.glb", changed, bytes, path);
        if (open_path() == PCCD_OK) {
            read++;
            assert_true(motion.vertex_count * 3 <= KIT_COUNT(x));
            for (uint32_t frame = 0; frame < motion.frame_count; frame++) {
                (void)motion.read(&motion, frame, x, &error);
            }
        }
    }
    assert_true(read > 20);
    finish();
}

/* If it failed: files of which it is known what they show would be read as something
 * else. */
CASE(file__of_known_cases_is_read_right)
{
    static const struct {
        const char *name;
        uint32_t vertices, triangles;
        double last[3]; /* vertex */
    } cases[] = {
        {"default.glb", 24, 12, {-1, -1, 1}},
        {"g02_strip.glb", 4, 2, {1, 1, 0}},
        {"g03_sparse.glb", 4, 2, {1, 1, 9}},
        {"g04_quantized.glb", 4, 2, {0.5, 0.5, 0}},
        {"g06b_instancing_required.glb", 8, 4, {1, 1, 3}},
        {"g08b_no_scenes.glb", 4, 2, {1, 1, 0}},
        {"g09_rotation.glb", 4, 2, {-1, 1, 0}},
        {"g09h_camera_turned.glb", 4, 2, {1, 1, 0}},
    };
    const char *data = getenv("PCCD_DATA");
    for (size_t i = 0; i < KIT_COUNT(cases); i++) {
        snprintf(path, sizeof path, "%s/cases/%s", data != NULL ? data : "",
                 cases[i].name);
        if (access(path, R_OK) != 0) {
            test_skip("no such files in $PCCD_DATA");
        }
        if (open_path() != PCCD_OK) {
            fail_msg("%s", error.text);
        }
        assert_int_equal(mesh.vertex_count, cases[i].vertices);
        assert_int_equal(mesh.triangles.count, cases[i].triangles);
        assert_int_equal(mesh.format, PCCD_FORMAT_F32);
        for (int axis = 0; axis < 3; axis++) {
            const float(*x)[3] = mesh.x;
            assert_true((double)x[mesh.vertex_count - 1][axis] == cases[i].last[axis]);
        }
    }
    finish();
}

static int remove_all(void **state)
{
    finish();
    return kit_remove_folder(state);
}

CASES_WITH(kit_make_folder, remove_all);
