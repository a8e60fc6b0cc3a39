/* test_eng_mesh.c - registration of a mesh.
 *
 * Source: daemon/engine/scene/mesh.h; paper section 3.1.
 */
#include "eng_kit.h"
#include "memory.h"
#include "topology.h"

/* Huge counts are to be answered, under a sanitizer too. */
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "allocator_may_return_null=1";
}

__attribute__((visibility("default"))) const char *__tsan_default_options(void);
const char *__tsan_default_options(void)
{
    return __asan_default_options();
}

/* Two triangles of a unit square. */
static const double square_x[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
static const uint32_t square_t[2][3] = {{0, 1, 2}, {0, 2, 3}};

static struct eng_mesh *new_mesh(uint32_t vertices, uint32_t triangles)
{
    struct eng_mesh *mesh = NULL;
    assert_ok(eng_mesh_new(vertices, triangles, &mesh));
    return mesh;
}

static int write_x(struct eng_mesh *mesh, uint32_t first, uint32_t count)
{
    return eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, first, count, square_x[first]);
}

static int write_t(struct eng_mesh *mesh, uint32_t first, uint32_t count)
{
    uint32_t bad = 0;
    return eng_mesh_write_triangles(mesh, first, count, square_t[first], &bad);
}

/* If it failed: a large mesh could not come in pieces. */
CASE(mesh__chunks_in_order_make_a_mesh)
{
    struct eng_mesh *mesh = new_mesh(4, 2);
    struct eng_mesh_counts received;
    assert_ok(write_x(mesh, 0, 1));
    assert_ok(write_x(mesh, 1, 2));
    eng_mesh_received(mesh, &received);
    assert_int_equal(received.vertices, 3);
    assert_int_equal(received.triangles, 0);
    assert_ok(write_x(mesh, 2, 2)); /* overlapping is allowed */
    assert_ok(write_t(mesh, 0, 1));
    assert_ok(write_t(mesh, 1, 1));
    assert_ok(write_t(mesh, 0, 1)); /* again: the prefix stays */
    eng_mesh_received(mesh, &received);
    assert_int_equal(received.vertices, 4);
    assert_int_equal(received.triangles, 2);
    assert_false(eng_mesh_is_committed(mesh));
    assert_ok(eng_mesh_commit(mesh, 1));
    assert_true(eng_mesh_is_committed(mesh));
    assert_true(eng_feature_validate(mesh));
    assert_memory_equal(mesh->x, square_x, sizeof square_x);
    eng_mesh_release(mesh);
}

/* If it failed: vertices that never came would be used. */
CASE(mesh__gaps_and_ranges_outside_are_refused)
{
    struct eng_mesh *mesh = new_mesh(4, 2);
    assert_int_equal(write_x(mesh, 1, 1), PCCD_E_STATE);
    assert_int_equal(write_t(mesh, 1, 1), PCCD_E_STATE);
    assert_int_equal(write_x(mesh, 0, 0), PCCD_E_INVAL);
    assert_int_equal(write_x(mesh, 0, 5), PCCD_E_INVAL);
    assert_int_equal(write_x(mesh, 3, 2), PCCD_E_INVAL);
    assert_int_equal(write_x(mesh, 0, UINT32_MAX), PCCD_E_INVAL);
    assert_int_equal(
        eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, UINT32_MAX, 2, square_x),
        PCCD_E_INVAL);
    assert_int_equal(write_t(mesh, 0, 3), PCCD_E_INVAL);
    struct eng_mesh_counts received;
    eng_mesh_received(mesh, &received);
    assert_int_equal(received.vertices, 0);
    assert_int_equal(received.triangles, 0);
    eng_mesh_release(mesh);
}

/* If it failed: a peer's wrong index would read outside, or it would not learn which
 * one. */
CASE(mesh__index_out_of_range_names_the_triangle)
{
    enum { COUNT = 1500 };
    static uint32_t triangles[COUNT][3];
    struct eng_mesh *mesh = new_mesh(4, COUNT);
    for (uint32_t at = 0; at < COUNT; at += 499) {
        for (uint32_t corner = 0; corner < 3; corner++) {
            uint32_t bad = UINT32_MAX;
            memset(triangles, 0, sizeof triangles);
            triangles[at][corner] = corner == 2 ? UINT32_MAX : 4;
            assert_int_equal(eng_mesh_write_triangles(mesh, 0, COUNT, triangles, &bad),
                             PCCD_E_INDEX);
            assert_int_equal(bad, at);
            /* The same in a chunk that does not begin at 0. */
            memset(triangles, 0, sizeof triangles);
            assert_ok(eng_mesh_write_triangles(mesh, 0, 10, triangles, &bad));
            if (at >= 10) {
                triangles[at][corner] = 4;
                assert_int_equal(
                    eng_mesh_write_triangles(mesh, 10, COUNT - 10, triangles[10], &bad),
                    PCCD_E_INDEX);
                assert_int_equal(bad, at);
            }
        }
    }
    struct eng_mesh_counts received;
    eng_mesh_received(mesh, &received);
    assert_int_equal(received.triangles, 10); /* nothing of a refused chunk counts */
    eng_mesh_release(mesh);
}

/* If it failed: NaN or overflow would reach boxes and error bounds. */
CASE(mesh__coordinates_beyond_the_limits_are_refused)
{
    const double bad[] = {NAN,   -NAN, INFINITY, -INFINITY, nextafter(1e18, INFINITY),
                          -1e300};
    const double good[] = {1e18, -1e18, 0.0, -0.0, 5e-324, -1e-310};
    const float bad_f[] = {NAN, INFINITY, -INFINITY, nextafterf(1e18f, INFINITY), -3e38f};
    for (size_t i = 0; i < 12 * sizeof bad / sizeof *bad; i++) {
        double x[4][3] = {{0}};
        struct eng_mesh *mesh = new_mesh(4, 2);
        x[i % 12 / 3][i % 3] = bad[i / 12];
        assert_int_equal(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, 4, x),
                         PCCD_E_NOTFINITE);
        x[i % 12 / 3][i % 3] = good[i / 12];
        assert_ok(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, 4, x));
        assert_memory_equal(mesh->x, x, sizeof x);
        eng_mesh_release(mesh);
    }
    for (size_t i = 0; i < 12 * sizeof bad_f / sizeof *bad_f; i++) {
        float x[4][3] = {{0}};
        struct eng_mesh *mesh = new_mesh(4, 2);
        x[i % 12 / 3][i % 3] = bad_f[i / 12];
        assert_int_equal(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F32, 0, 4, x),
                         PCCD_E_NOTFINITE);
        x[i % 12 / 3][i % 3] = 0.1f;
        assert_ok(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F32, 0, 4, x));
        assert_true(mesh->x[i % 12 / 3][i % 3] == (double)0.1f);
        eng_mesh_release(mesh);
    }
}

/* If it failed: what a refused chunk spoilt would be taken for good vertices. */
CASE(mesh__refused_chunk_has_to_come_again)
{
    double x[4][3];
    struct eng_mesh *mesh = new_mesh(4, 2);
    assert_ok(write_x(mesh, 0, 4));
    assert_ok(write_t(mesh, 0, 2));
    memcpy(x, square_x, sizeof x);
    x[2][1] = NAN;
    assert_int_equal(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 1, 3, x[1]),
                     PCCD_E_NOTFINITE);
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_ok(write_x(mesh, 1, 3));
    assert_ok(eng_mesh_commit(mesh, 1));
    assert_memory_equal(mesh->x, square_x, sizeof square_x);
    eng_mesh_release(mesh);
}

/* If it failed: a mesh in use could change, or an unfinished one could be used. */
CASE(mesh__commit_happens_once_and_only_when_complete)
{
    struct eng_mesh *mesh = new_mesh(4, 2);
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_ok(write_x(mesh, 0, 4));
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_ok(write_t(mesh, 0, 1));
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_ok(write_t(mesh, 1, 1));
    assert_ok(eng_mesh_commit(mesh, 1));
    assert_int_equal(eng_mesh_commit(mesh, 1), PCCD_E_STATE);
    assert_int_equal(write_x(mesh, 0, 4), PCCD_E_STATE);
    assert_int_equal(write_t(mesh, 0, 2), PCCD_E_STATE);
    eng_mesh_release(mesh);
}

/* If it failed: a peer's absurd count would crash the process or leave memory behind. */
CASE(mesh__absurd_counts_are_refused)
{
    struct eng_mesh *mesh = NULL;
    uint64_t bytes = eng_alloc_bytes();
    assert_int_equal(eng_mesh_new(0, 1, &mesh), PCCD_E_INVAL);
    assert_int_equal(eng_mesh_new(1, 0, &mesh), PCCD_E_INVAL);
    assert_int_equal(eng_mesh_new(PROTO_COUNT_MAX + 1, 1, &mesh), PCCD_E_INVAL);
    assert_int_equal(eng_mesh_new(1, PROTO_COUNT_MAX + 1, &mesh), PCCD_E_INVAL);
    assert_int_equal(eng_mesh_new(UINT32_MAX, UINT32_MAX, &mesh), PCCD_E_INVAL);
    assert_null(mesh);
    int status = eng_mesh_new(PROTO_COUNT_MAX, PROTO_COUNT_MAX, &mesh);
    if (status == PCCD_OK) { /* memory that is reserved but not touched */
        assert_true(eng_mesh_bytes(mesh) > (uint64_t)PROTO_COUNT_MAX * 36);
        eng_mesh_release(mesh);
    } else {
        assert_int_equal(status, PCCD_E_NOMEM);
        assert_null(mesh);
    }
    assert_int_equal(eng_alloc_bytes(), bytes);
}

/* If it failed: the report after registration would not describe the mesh. */
CASE(mesh__counts_describe_duplicates_degenerates_and_isolated)
{
    const double x[7][3] = {{0, 0, 0}, {1, 0, 0},   {0, 1, 0}, {2, 0, 0},
                            {5, 5, 5}, {0.1, 0, 1}, {9, 9, 9}};
    const uint32_t t[7][3] = {
        {0, 1, 2}, {2, 0, 1}, /* the same, rotated */
        {1, 0, 2},            /* the same, turned over */
        {0, 1, 3},            /* on one line */
        {2, 2, 5},            /* a segment */
        {5, 5, 5},            /* a point */
        {0, 1, 5},
    };
    struct eng_mesh *mesh = kit_mesh(x, 7, t, 7);
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    assert_int_equal(info.vertex_count, 7);
    assert_int_equal(info.triangle_count, 7);
    assert_int_equal(info.duplicate_count, 2);
    assert_int_equal(info.degenerate_count, 3);
    assert_int_equal(info.isolated_count, 2);
    assert_int_equal(info.edge_count, 8); /* 01 02 12 03 13 25 05 15 */
    eng_mesh_release(mesh);
}

static void check_order(const struct eng_mesh *mesh)
{
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    const uint32_t(*edges)[2] = eng_mesh_edges(mesh);
    for (uint32_t i = 0; i < info.edge_count; i++) {
        assert_true(edges[i][0] < edges[i][1]);
        assert_true(i == 0 || edges[i - 1][1] < edges[i][1] ||
                    (edges[i - 1][1] == edges[i][1] && edges[i - 1][0] < edges[i][0]));
    }
}

/* If it failed: edge numbers would not be those of public ground-truth data. */
CASE(mesh__edges_are_unique_and_sorted_by_higher_then_lower)
{
    const uint32_t square_edges[5][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {2, 3}};
    struct eng_mesh *mesh = kit_mesh(square_x, 4, square_t, 2);
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    assert_int_equal(info.edge_count, 5);
    assert_memory_equal(eng_mesh_edges(mesh), square_edges, sizeof square_edges);
    eng_mesh_release(mesh);

    mesh = kit_sheet(20, 0);
    eng_mesh_get_info(mesh, &info);
    assert_int_equal(info.edge_count, 20 * 21 * 2 + 20 * 20);
    check_order(mesh);
    eng_mesh_release(mesh);
}

/* Each vertex of a triangle and each edge has one owner, the owner has it, and the edges
 * of a triangle are the pairs of its corners. */
static void check_ownership(const struct eng_mesh *mesh)
{
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    uint32_t *vertex_owners = calloc(info.vertex_count, sizeof *vertex_owners);
    uint32_t *used = calloc(info.vertex_count, sizeof *used);
    uint32_t *edge_owners = calloc(info.edge_count + 1, sizeof *edge_owners);
    uint32_t *first = calloc(info.vertex_count + 1, sizeof *first);
    assert_true(vertex_owners && used && edge_owners && first);
    eng_feature_index(mesh, first);
    for (uint32_t t = 0; t < info.triangle_count; t++) {
        const struct eng_face *triangle = &mesh->leaves[t];
        for (unsigned k = 0; k < 3; k++) {
            uint32_t a = triangle->v[k];
            uint32_t b = triangle->v[(k + 1) % 3];
            used[a] = 1;
            uint32_t edge = eng_feature_edge(mesh, first, a, b);
            vertex_owners[a] += (triangle->owns & ENG_OWNS_VERTEX(k)) != 0;
            if (a == b) {
                assert_int_equal(edge, ENG_NO_EDGE);
                assert_false(triangle->owns & ENG_OWNS_EDGE(k));
                continue;
            }
            assert_true(edge < info.edge_count);
            /* The owner is the first that has it. */
            assert_true(edge_owners[edge] > 0 || triangle->owns & ENG_OWNS_EDGE(k));
            assert_int_equal(mesh->edges[edge][0], a < b ? a : b);
            assert_int_equal(mesh->edges[edge][1], a < b ? b : a);
            edge_owners[edge] += (triangle->owns & ENG_OWNS_EDGE(k)) != 0;
        }
    }
    for (uint32_t v = 0; v < info.vertex_count; v++) {
        assert_int_equal(vertex_owners[v], used[v]);
    }
    for (uint32_t e = 0; e < info.edge_count; e++) {
        assert_int_equal(edge_owners[e], 1);
    }
    free(vertex_owners);
    free(used);
    free(edge_owners);
    free(first);
}

static bool is_like(const uint32_t *a, const uint32_t *b)
{
    for (int turn = 0; turn < 3; turn++) {
        if (a[0] == b[turn] &&
            ((a[1] == b[(turn + 1) % 3] && a[2] == b[(turn + 2) % 3]) ||
             (a[1] == b[(turn + 2) % 3] && a[2] == b[(turn + 1) % 3]))) {
            return true;
        }
    }
    return false;
}

/* Triangles with the corners of an earlier one. */
static uint32_t count_duplicates(const struct eng_mesh *mesh)
{
    uint32_t count = 0;
    for (uint32_t i = 1; i < mesh->info.triangle_count; i++) {
        uint32_t other = 0;
        while (other < i && !is_like(mesh->leaves[i].v, mesh->leaves[other].v)) {
            other++;
        }
        count += other < i;
    }
    return count;
}

/* If it failed: a contact would be missing (no owner) or reported twice (two). */
CASE(mesh__every_feature_is_owned_exactly_once)
{
    struct prng random = {7};
    struct eng_mesh *mesh = kit_sheet(9, 0);
    check_ownership(mesh);
    eng_mesh_release(mesh);
    mesh = kit_soup(&random, 100); /* every triangle by itself */
    check_ownership(mesh);
    eng_mesh_release(mesh);

    /* A book: many pages at one edge. */
    double x[22][3] = {{0}};
    uint32_t pages[20][3];
    for (uint32_t i = 0; i < 20; i++) {
        pages[i][0] = i % 2;
        pages[i][1] = 1 - i % 2;
        pages[i][2] = 2 + i;
    }
    mesh = kit_mesh(x, 22, pages, 20);
    check_ownership(mesh);
    eng_mesh_release(mesh);

    /* Few vertices, random corners: repeated indices, duplicates, every non-manifold
     * case. */
    for (int round = 0; round < 300; round++) {
        uint32_t triangles[30][3];
        uint32_t vertices = 1 + prng_u32(&random, 12);
        for (uint32_t i = 0; i < 90; i++) {
            triangles[i / 3][i % 3] = prng_u32(&random, vertices);
        }
        mesh = kit_mesh(x, vertices, triangles, 1 + prng_u32(&random, 30));
        check_ownership(mesh);
        assert_int_equal(mesh->info.duplicate_count, count_duplicates(mesh));
        eng_mesh_release(mesh);
    }
}

/* If it failed: a vertex with many edges would have them in another order, or twice, or
 * many triangles at one vertex would be no duplicates. */
CASE(mesh__many_edges_at_a_vertex_are_like_few)
{
    enum { RIM = 300, TWICE = 40 };
    double x[RIM + 1][3] = {{0}};
    uint32_t fan[RIM + TWICE][3];
    for (uint32_t i = 0; i < RIM; i++) {
        uint32_t v = i * 77 % RIM; /* all of them, in no order */
        fan[i][0] = RIM;
        fan[i][1] = v;
        fan[i][2] = (v + 1) % RIM;
    }
    for (uint32_t i = 0; i < TWICE; i++) { /* the same triangle, its corners turned */
        for (uint32_t k = 0; k < 3; k++) {
            fan[RIM + i][k] = fan[5][(k + i) % 3];
        }
    }
    struct eng_mesh *mesh = kit_mesh(x, RIM + 1, fan, RIM + TWICE);
    assert_int_equal(mesh->info.edge_count, 2 * RIM);
    assert_int_equal(mesh->info.duplicate_count, TWICE);
    check_order(mesh);
    check_ownership(mesh);
    eng_mesh_release(mesh);
}

/* If it failed: how a mesh is derived would depend on how many threads there are. */
CASE(mesh__is_the_same_by_any_number_of_threads)
{
    struct eng_mesh *one = kit_sheet(100, 0);
    const struct eng_mesh_info *info = &one->info;
    uint32_t(*corners)[3] = malloc(info->triangle_count * sizeof *corners);
    assert_non_null(corners);
    eng_mesh_get_corners(one, corners);
    for (uint32_t threads = 2; threads <= 8; threads += 6) {
        struct eng_mesh *mesh = NULL;
        uint32_t bad;
        assert_ok(eng_mesh_new(info->vertex_count, info->triangle_count, &mesh));
        assert_ok(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, info->vertex_count,
                                          one->x));
        assert_ok(eng_mesh_write_triangles(mesh, 0, info->triangle_count, corners, &bad));
        assert_ok(eng_mesh_commit(mesh, threads));
        assert_memory_equal(&mesh->info, info, sizeof *info);
        assert_memory_equal(mesh->leaves, one->leaves,
                            one->leaf_count * sizeof *one->leaves);
        assert_memory_equal(mesh->edges, one->edges,
                            info->edge_count * sizeof *one->edges);
        eng_mesh_release(mesh);
    }
    free(corners);
    eng_mesh_release(one);
}

/* If it failed: a mesh would go while an instance of it is in use, or stay for ever. */
CASE(mesh__last_release_frees)
{
    uint64_t bytes = eng_alloc_bytes();
    struct eng_mesh *mesh = kit_mesh(square_x, 4, square_t, 2);
    uint64_t held = eng_alloc_bytes();
    assert_true(held > bytes);
    assert_ptr_equal(eng_mesh_acquire(mesh), mesh);
    eng_mesh_release(mesh);
    assert_int_equal(eng_alloc_bytes(), held);
    assert_int_equal(mesh->info.edge_count, 5);
    eng_mesh_release(mesh);
    assert_int_equal(eng_alloc_bytes(), bytes);
    eng_mesh_release(NULL);
}
