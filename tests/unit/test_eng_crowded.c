/* test_eng_crowded.c - which features of a mesh are crowded. */
#include "eng_kit.h"
#include "memory.h"
#include "step.h"
#include "topology.h"
#include "wide_crowded.h"

typedef long double real;

struct real3 {
    real x[3];
};

static struct real3 minus(const double *a, const double *b)
{
    struct real3 v;
    for (int k = 0; k < 3; k++) {
        v.x[k] = (real)a[k] - (real)b[k];
    }
    return v;
}

static real dot(struct real3 a, struct real3 b)
{
    return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

static struct real3 cross(struct real3 a, struct real3 b)
{
    return (struct real3){{a.x[1] * b.x[2] - a.x[2] * b.x[1],
                           a.x[2] * b.x[0] - a.x[0] * b.x[2],
                           a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

/* v + s * w */
static struct real3 go(struct real3 v, real s, struct real3 w)
{
    for (int k = 0; k < 3; k++) {
        v.x[k] += s * w.x[k];
    }
    return v;
}

/* From `from` to the segment from 0 along `along`. */
static real to_segment(struct real3 from, struct real3 along)
{
    real length2 = dot(along, along);
    real s = length2 > 0 ? dot(from, along) / length2 : 0;
    struct real3 left = go(from, -fminl(fmaxl(s, 0), 1), along);
    return sqrtl(dot(left, left));
}

static real vertex_to_edge(const double *p, const double *a, const double *b)
{
    return to_segment(minus(p, a), minus(b, a));
}

static real vertex_to_face(const double *p, const double *a, const double *b,
                           const double *c)
{
    struct real3 n = cross(minus(b, a), minus(c, a));
    real least = fminl(vertex_to_edge(p, a, b),
                       fminl(vertex_to_edge(p, b, c), vertex_to_edge(p, c, a)));
    bool is_inside = dot(n, n) > 0 && dot(cross(minus(b, a), minus(p, a)), n) >= 0 &&
                     dot(cross(minus(c, b), minus(p, b)), n) >= 0 &&
                     dot(cross(minus(a, c), minus(p, c)), n) >= 0;
    return is_inside ? fminl(least, fabsl(dot(minus(p, a), n)) / sqrtl(dot(n, n)))
                     : least;
}

static real edge_to_edge(const double *a, const double *b, const double *c,
                         const double *d)
{
    struct real3 u = minus(b, a);
    struct real3 v = minus(d, c);
    struct real3 n = cross(u, v);
    real least = fminl(fminl(vertex_to_edge(a, c, d), vertex_to_edge(b, c, d)),
                       fminl(vertex_to_edge(c, a, b), vertex_to_edge(d, a, b)));
    real nn = dot(n, n);
    if (nn > 0) {
        struct real3 w = minus(c, a);
        real s = dot(cross(w, v), n) / nn;
        real t = dot(cross(w, u), n) / nn;
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) {
            least = fminl(least, fabsl(dot(w, n)) / sqrtl(nn));
        }
    }
    return least;
}

/* With its features in order, as a daemon's meshes are. */
static struct eng_mesh *in_order(struct eng_mesh *mesh)
{
    assert_ok(eng_mesh_sort_features(mesh, 1));
    return mesh;
}

static bool has_crowded(const struct eng_mesh *mesh)
{
    return mesh->clearance.crowded_count > 0;
}

/* To the end, by small parts. */
static void search(struct eng_mesh *mesh, uint64_t budget)
{
    uint32_t parts = 0;
    while (!eng_mesh_knows_clearance(mesh)) {
        assert_true(eng_mesh_clearance(mesh) == 0);
        assert_true(eng_wide_crowded_advance(mesh, budget) > 0);
        assert_true(++parts < 1000000);
    }
    assert_true(eng_wide_crowded_advance(mesh, budget) == 0);
}

static uint64_t crowded_of(const struct eng_mesh *mesh, enum pccd_tree tree,
                           uint32_t count)
{
    uint64_t crowded = 0;
    for (uint32_t i = 0; i < count; i++) {
        crowded += eng_mesh_is_crowded(mesh, tree, i);
    }
    return crowded;
}

static uint64_t all_crowded_of(const struct eng_mesh *mesh)
{
    return crowded_of(mesh, PCCD_TREE_VERTICES, mesh->info.vertex_count) +
           crowded_of(mesh, PCCD_TREE_EDGES, mesh->info.edge_count) +
           crowded_of(mesh, PCCD_TREE_FACES, mesh->info.triangle_count);
}

/* ---- against all pairs ------------------------------------------------------------- */

struct least {
    real *of[PCCD_TREE_FACES + 1]; /* of each feature, to what it could meet */
};

static void meet(struct least *least, enum pccd_tree tree_a, uint32_t a,
                 enum pccd_tree tree_b, uint32_t b, real distance)
{
    least->of[tree_a][a] = fminl(least->of[tree_a][a], distance);
    least->of[tree_b][b] = fminl(least->of[tree_b][b], distance);
}

/* Every pair that is within the clearance has both its features crowded. */
static void check_pairs(const struct eng_mesh *mesh, struct least *least)
{
    const double(*x)[3] = (const double(*)[3])mesh->x;
    real length = (real)eng_mesh_clearance(mesh);
    for (uint32_t i = 0; i < mesh->info.triangle_count; i++) {
        const uint32_t *f = mesh->leaves[i].v;
        for (uint32_t v = 0; v < mesh->info.vertex_count; v++) {
            if (v == f[0] || v == f[1] || v == f[2]) {
                continue;
            }
            real distance = vertex_to_face(x[v], x[f[0]], x[f[1]], x[f[2]]);
            assert_true(distance > length ||
                        (eng_mesh_is_crowded(mesh, PCCD_TREE_VERTICES, v) &&
                         eng_mesh_is_crowded(mesh, PCCD_TREE_FACES, i)));
            meet(least, PCCD_TREE_VERTICES, v, PCCD_TREE_FACES, i, distance);
        }
    }
    for (uint32_t i = 0; i < mesh->info.edge_count; i++) {
        const uint32_t *a = mesh->edges[i];
        for (uint32_t j = 0; j < i; j++) {
            const uint32_t *b = mesh->edges[j];
            if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) {
                continue;
            }
            real distance = edge_to_edge(x[a[0]], x[a[1]], x[b[0]], x[b[1]]);
            assert_true(distance > length ||
                        (eng_mesh_is_crowded(mesh, PCCD_TREE_EDGES, i) &&
                         eng_mesh_is_crowded(mesh, PCCD_TREE_EDGES, j)));
            meet(least, PCCD_TREE_EDGES, i, PCCD_TREE_EDGES, j, distance);
        }
    }
}

/* Nothing is crowded without a reason. */
static void check_reasons(const struct eng_mesh *mesh, const struct least *least)
{
    const uint32_t counts[] = {mesh->info.vertex_count, mesh->info.edge_count,
                               mesh->info.triangle_count};
    for (int tree = 0; tree <= PCCD_TREE_FACES; tree++) {
        for (uint32_t i = 0; i < counts[tree]; i++) {
            assert_true(!eng_mesh_is_crowded(mesh, (enum pccd_tree)tree, i) ||
                        least->of[tree][i] <= 1.001L * (real)eng_mesh_clearance(mesh));
        }
    }
}

static void check(const struct eng_mesh *mesh)
{
    struct least least;
    const uint32_t counts[] = {mesh->info.vertex_count, mesh->info.edge_count,
                               mesh->info.triangle_count};
    for (int tree = 0; tree <= PCCD_TREE_FACES; tree++) {
        least.of[tree] = malloc(counts[tree] * sizeof *least.of[tree]);
        assert_non_null(least.of[tree]);
        for (uint32_t i = 0; i < counts[tree]; i++) {
            least.of[tree][i] = INFINITY;
        }
    }
    check_pairs(mesh, &least);
    check_reasons(mesh, &least);
    for (int tree = 0; tree <= PCCD_TREE_FACES; tree++) {
        free(least.of[tree]);
    }
}

/* A sheet of side x side squares that is bent and ruffled, and some patches of two
 * triangles about `gap` above it, each of them turned a little. */
static struct eng_mesh *some_mesh(struct prng *random, uint32_t side, uint32_t patches,
                                  double gap)
{
    uint32_t row = side + 1;
    uint32_t sheet = row * row;
    uint32_t vertices = sheet + 4 * patches;
    uint32_t count = 2 * side * side + 2 * patches;
    double(*x)[3] = malloc(vertices * sizeof *x);
    uint32_t(*triangles)[3] = malloc(count * sizeof *triangles);
    assert_true(x && triangles);
    for (uint32_t v = 0; v < sheet; v++) {
        x[v][0] = v % row + prng_between(random, -0.2, 0.2);
        x[v][1] = v / row + prng_between(random, -0.2, 0.2);
        x[v][2] = prng_between(random, -0.2, 0.2);
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t v = i / side * row + i % side;
        memcpy(triangles[n++], (uint32_t[]){v, v + 1, v + row}, sizeof *triangles);
        memcpy(triangles[n++], (uint32_t[]){v + 1, v + row + 1, v + row},
               sizeof *triangles);
    }
    for (uint32_t i = 0; i < patches; i++) {
        uint32_t v = sheet + 4 * i;
        const uint32_t *under = triangles[prng_u32(random, 2 * side * side)];
        double tilt = gap * prng_between(random, 0, 2);
        for (uint32_t k = 0; k < 3; k++) { /* a copy of the triangle, lifted and shrunk */
            for (int axis = 0; axis < 3; axis++) {
                double middle =
                    (x[under[0]][axis] + x[under[1]][axis] + x[under[2]][axis]) / 3;
                x[v + k][axis] = middle + 0.3 * (x[under[k]][axis] - middle);
            }
            x[v + k][2] += gap + (k == 0 ? tilt : 0);
        }
        memcpy(x[v + 3], x[v], sizeof *x);
        x[v + 3][2] += 0.4;
        memcpy(triangles[n++], (uint32_t[]){v, v + 1, v + 2}, sizeof *triangles);
        memcpy(triangles[n++], (uint32_t[]){v, v + 2, v + 3}, sizeof *triangles);
    }
    struct eng_mesh *mesh = in_order(kit_mesh(x, vertices, triangles, count));
    free(x);
    free(triangles);
    return mesh;
}

/* If this failed, features that touch would be taken for apart, and their contacts be
 * missed once the mesh is moved by poses; or rigid objects would be tested against
 * themselves though nothing of them is crowded. */
CASE(crowded__is_what_lies_within_the_clearance)
{
    struct prng random = {21};
    uint32_t with_crowded = 0;
    uint32_t without = 0;
    for (uint32_t i = 0; i < 60; i++) {
        double gap = 0x1p-20 * exp2(prng_between(&random, -6, 6));
        struct eng_mesh *mesh = some_mesh(&random, 8, i % 3, i % 7 ? gap : 0);
        search(mesh, 1 + prng_u32(&random, 3000));
        assert_true(eng_mesh_clearance(mesh) > 0x1p-22 &&
                    eng_mesh_clearance(mesh) < 0x1p-19);
        check(mesh);
        with_crowded += has_crowded(mesh);
        without += !has_crowded(mesh);
        assert_true(has_crowded(mesh) == (all_crowded_of(mesh) > 0));
        eng_mesh_release(mesh);
    }
    assert_true(with_crowded > 10 && without > 10);
}

/* If this failed, whether two sheets of a folded thing are crowded would be chance. */
CASE(crowded__parallel_sheets_are_told_by_their_distance)
{
    for (int i = 0; i < 2; i++) {
        enum { SIDE = 24 };
        struct eng_mesh *sheet = in_order(kit_sheet(SIDE, 0));
        uint32_t vertices = sheet->info.vertex_count;
        uint32_t count = sheet->info.triangle_count;
        double(*x)[3] = malloc((vertices + 3) * sizeof *x);
        uint32_t(*triangles)[3] = malloc((count + 1) * sizeof *triangles);
        assert_true(x && triangles);
        memcpy(x, sheet->x, vertices * sizeof *x);
        eng_mesh_get_corners(sheet, triangles);
        search(sheet, 1000);
        double length = eng_mesh_clearance(sheet);
        assert_true(length > 0 && !has_crowded(sheet));
        double height = length * (i == 0 ? 1.01 : 0.99);
        memcpy(x[vertices], (double[]){0.5, 0.5, height}, sizeof *x);
        memcpy(x[vertices + 1], (double[]){0.52, 0.51, height}, sizeof *x);
        memcpy(x[vertices + 2], (double[]){0.5, 0.53, height}, sizeof *x);
        memcpy(triangles[count], (uint32_t[]){vertices, vertices + 1, vertices + 2},
               sizeof *triangles);
        struct eng_mesh *two = in_order(kit_mesh(x, vertices + 3, triangles, count + 1));
        search(two, 1000);
        assert_true(eng_mesh_clearance(two) == length);
        assert_int_equal(has_crowded(two), i);
        check(two);
        free(x);
        free(triangles);
        eng_mesh_release(sheet);
        eng_mesh_release(two);
    }
}

/* If this failed, a soup of triangles would keep every step busy with a search that is of
 * no use, or a mesh without size would be divided by. */
CASE(crowded__is_not_told_of_heaps_and_points)
{
    static const double points[3][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    static const uint32_t one[1][3] = {{0, 1, 2}};
    struct prng random = {22};
    struct eng_mesh *meshes[3] = {in_order(kit_mesh(points, 3, one, 1)), NULL,
                                  some_mesh(&random, 2, 30, 0)};
    double(*heap)[3] = malloc(sizeof *heap * 3 * 4000);
    uint32_t(*triangles)[3] = malloc(sizeof *triangles * 4000);
    assert_true(heap && triangles);
    for (uint32_t v = 0; v < 3 * 4000; v++) {
        for (int k = 0; k < 3; k++) {
            heap[v][k] = prng_between(&random, 0, 1);
        }
        triangles[v / 3][v % 3] = v;
    }
    meshes[1] = in_order(kit_mesh(heap, 3 * 4000, triangles, 4000));
    for (int i = 0; i < 3; i++) {
        search(meshes[i], 10000);
        assert_true(eng_mesh_clearance(meshes[i]) == 0);
        assert_true(all_crowded_of(meshes[i]) == 0);
        assert_true(meshes[i]->clearance.work < 1100 * 4000);
        eng_mesh_release(meshes[i]);
    }
    free(heap);
    free(triangles);
}

/* If this failed, what is found would depend on how long steps take. */
CASE(crowded__is_found_alike_in_one_part_and_in_many)
{
    struct prng random = {23};
    for (uint32_t i = 0; i < 6; i++) {
        struct prng same = random;
        struct eng_mesh *whole = some_mesh(&random, 20, 8, 0x1p-22);
        struct eng_mesh *parts = some_mesh(&same, 20, 8, 0x1p-22);
        search(whole, UINT64_MAX);
        search(parts, 1 + i * 50);
        assert_true(eng_mesh_clearance(whole) > 0);
        assert_true(eng_mesh_clearance(whole) == eng_mesh_clearance(parts));
        assert_true(whole->clearance.crowded_count == parts->clearance.crowded_count);
        assert_true(all_crowded_of(whole) == all_crowded_of(parts) &&
                    all_crowded_of(whole) > 0);
        eng_mesh_release(parts);
        eng_mesh_release(whole);
    }
    struct eng_mesh *begun = some_mesh(&random, 20, 1, 1);
    assert_true(eng_wide_crowded_advance(begun, 100) > 0);
    eng_mesh_release(begun); /* a leak would show in a build with sanitizers */
}

/* If this failed, features far from the origin, of tiny or of huge meshes would be taken
 * for apart by rounding, or for crowded. */
CASE(crowded__scales_with_the_mesh)
{
    static const double scales[] = {0x1p-200, 0x1p-40, 1, 0x1p40};
    struct prng random = {24};
    struct eng_mesh *mesh = some_mesh(&random, 10, 3, 0x1p-21);
    search(mesh, UINT64_MAX);
    uint32_t(*triangles)[3] = malloc(sizeof *triangles * mesh->info.triangle_count);
    double(*x)[3] = malloc(sizeof *x * mesh->info.vertex_count);
    assert_true(x && triangles);
    eng_mesh_get_corners(mesh, triangles);
    for (int i = 0; i < 4; i++) {
        for (uint32_t k = 0; k < 3 * mesh->info.vertex_count; k++) {
            x[k / 3][k % 3] = scales[i] * mesh->x[k / 3][k % 3];
        }
        struct eng_mesh *other = in_order(
            kit_mesh(x, mesh->info.vertex_count, triangles, mesh->info.triangle_count));
        search(other, UINT64_MAX);
        assert_true(eng_mesh_clearance(other) == scales[i] * eng_mesh_clearance(mesh));
        assert_true(all_crowded_of(other) == all_crowded_of(mesh));
        eng_mesh_release(other);
    }
    free(x);
    free(triangles);
    eng_mesh_release(mesh);
}

/* If this failed, a mesh in another user's scene would leave that one with memory that he
 * has not, and its owner with less than none: the daemon stops where it finds that. */
CASE(crowded__is_charged_to_whoever_made_the_mesh)
{
    struct eng_account owner = {.limit = INT64_MAX}, other = {.limit = INT64_MAX};
    struct prng random = {25};
    eng_payer()->account = &owner;
    struct eng_mesh *mesh = some_mesh(&random, 20, 8, 0x1p-22);
    int64_t begun = owner.bytes;
    eng_payer()->account = &other;
    (void)eng_wide_crowded_advance(mesh, 100);
    assert_true(owner.bytes > begun && other.bytes == 0);
    search(mesh, UINT64_MAX);
    assert_true(all_crowded_of(mesh) > 0 && owner.bytes > begun && other.bytes == 0);
    begun = owner.bytes;
    assert_ok(eng_rings_prepare(mesh, 2, NULL));
    assert_true(owner.bytes > begun && other.bytes == 0);
    void *block = eng_alloc(1, 1); /* all else is for the other one still */
    assert_true(other.bytes > 0);
    eng_free(block);
    eng_payer()->account = &owner;
    eng_mesh_release(mesh);
    eng_payer()->account = NULL;
    assert_true(owner.bytes == 0 && other.bytes == 0);
}
