/* test_eng_sweep.c - trees of meshes, and what they find while one of two turns. */
#include "body_tree.h"
#include "distance.h"
#include "eng_kit.h"
#include "eng_turns.h"
#include "kinds.h"
#include "memory.h"
#include "sweep.h"
#include "vec.h"

/* ---- meshes ------------------------------------------------------------------------ */

/* Triangles, free edges and free points over a few common vertices of a cube. */
static struct eng_mesh *random_mesh(struct prng *random)
{
    struct eng_mesh_counts counts = {
        .vertices = 4 + prng_u32(random, 20),
        .triangles = prng_u32(random, 20),
        .edges = prng_u32(random, 4),
        .points = 1 + prng_u32(random, 4),
    };
    double x[24][3];
    uint32_t named[3 * 20];
    double flat = prng_u32(random, 4) == 0 ? 0 : 1; /* all in a plane, now and then */
    for (uint32_t i = 0; i < counts.vertices; i++) {
        for (int k = 0; k < 3; k++) {
            x[i][k] = prng_between(random, -1, 1) * (k == 2 ? flat : 1);
        }
    }
    for (uint32_t i = 0; i < 3 * 20; i++) {
        named[i] = prng_u32(random, counts.vertices);
    }
    struct eng_mesh *mesh =
        kit_mesh_of(&(struct kit_shape){counts, x, named, named + 30, named + 50, NULL});
    assert_ok(eng_body_tree_prepare(mesh, NULL, NULL));
    return mesh;
}

/* Fit a body to where its mesh goes. */
static int fit(struct eng_body *body, const struct eng_mesh *mesh, const double (*x0)[3],
               const double (*x1)[3])
{
    struct eng_bounds bounds = eng_mesh_measure(mesh, x0);
    struct eng_bounds other = eng_mesh_measure(mesh, x1);
    eng_bounds_unite(&bounds, &other);
    return eng_body_fit(body, mesh, x0, x1, &bounds);
}

/* ---- trees ------------------------------------------------------------------------- */

/* The boxes from the root to a leaf hold it: at an end of the step, exactly. */
static void check_child(const struct eng_body *body, int end, uint32_t node, int which,
                        uint32_t leaf)
{
    const struct eng_body_boxes *boxes = &body->boxes[end][node];
    const uint32_t *v = body->mesh->leaves[leaf].v;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            double x = body->x[end][v[i]][k] - body->origin[k];
            double centre = (double)boxes->centre[k][which];
            assert_true(fabs(x - centre) <= (double)boxes->half[k][which]);
        }
    }
}

/* Go down to each leaf, whose ancestors, `above`, have boxes that hold it. */
static void check_below(const struct eng_body *body, uint32_t node, uint32_t depth,
                        uint32_t (*above)[2], uint32_t *found)
{
    const struct eng_body_tree *tree = eng_body_tree_of(body->mesh);
    assert_true(depth < 64);
    for (uint32_t which = 0; which < 4; which++) {
        uint32_t child = tree->children[node][which];
        above[depth][0] = node;
        above[depth][1] = which;
        if (child == ENG_BODY_NONE) {
            assert_true(body->boxes[0][node].half[0][which] < 0);
        } else if (child & ENG_BODY_LEAF) {
            found[child & ~ENG_BODY_LEAF]++;
            for (uint32_t i = 0; i <= depth; i++) {
                check_child(body, 0, above[i][0], (int)above[i][1],
                            child & ~ENG_BODY_LEAF);
                check_child(body, 1, above[i][0], (int)above[i][1],
                            child & ~ENG_BODY_LEAF);
            }
        } else {
            assert_true(child > node && child < tree->node_count);
            check_below(body, child, depth + 1, above, found);
        }
    }
}

static void check_body(const struct eng_body *body)
{
    uint32_t above[64][2];
    uint32_t *found = test_room(body->mesh->leaf_count * sizeof *found);
    check_below(body, 0, 0, above, found);
    for (uint32_t i = 0; i < body->mesh->leaf_count; i++) {
        assert_int_equal(found[i], 1);
    }
    free(found);
}

static void check_tree(struct eng_mesh *mesh)
{
    struct eng_body body = {0};
    uint64_t before = eng_mesh_bytes(mesh);
    assert_ok(eng_body_tree_prepare(mesh, NULL, NULL));
    const struct eng_body_tree *tree = eng_body_tree_of(mesh);
    assert_ok(eng_body_tree_prepare(mesh, NULL, NULL)); /* it is there */
    assert_ptr_equal(eng_body_tree_of(mesh), tree);
    assert_true(eng_mesh_bytes(mesh) - before <= 512 + 64 * (uint64_t)mesh->leaf_count);
    eng_body_set(&body, mesh);
    check_body(&body);
    eng_mesh_release(mesh);
}

/* If it failed: a feature would be tested twice, or not at all; memory would not be that
 * which is promised, 64 bytes a triangle. */
CASE(tree__has_each_leaf_once)
{
    static const double x[3][3] = {{1, 2, 3}, {1, 2, 3}, {1e9, 2, 3}};
    static const uint32_t same[9][3] = {{0, 1, 0}, {1, 0, 1}, {1, 1, 0},
                                        {0, 1, 2}, {0, 0, 1}, {0, 1, 0},
                                        {2, 1, 0}, {0, 0, 0}, {1, 1, 1}};
    struct prng random = {1};
    for (uint32_t n = 1; n <= 9; n++) {
        check_tree(kit_mesh(x, 3, same, n));
    }
    for (uint32_t n = 1; n < 3000; n = n * 2 + 1) {
        check_tree(kit_soup(&random, n));
    }
    check_tree(kit_sheet(40, 0.5));
}

/* If it failed: what a mesh is far from its own origin, or as long as a needle, would be
 * outside of its boxes. */
CASE(boxes__hold_their_leaves_wherever_they_are)
{
    struct prng random = {prng_seed()};
    for (int n = 0; n < 200; n++) {
        struct eng_mesh *mesh = random_mesh(&random);
        uint32_t count = mesh->info.vertex_count;
        double(*x)[3] = test_room(2 * count * sizeof *x);
        double scale = ldexp(1, (int)prng_u32(&random, 80) - 40);
        for (uint32_t i = 0; i < 2 * count; i++) {
            for (int k = 0; k < 3; k++) {
                double far = n % 3 == 0 ? ldexp(1, (int)prng_u32(&random, 50)) : 0;
                x[i][k] = scale * (prng_between(&random, -1, 1) + far);
            }
        }
        struct eng_body body = {0};
        assert_ok(
            fit(&body, mesh, (const double(*)[3])x, (const double(*)[3])(x + count)));
        assert_true(body.boxes[0] != body.boxes[1]);
        check_body(&body);
        assert_ok(fit(&body, mesh, (const double(*)[3])x, (const double(*)[3])x));
        assert_true(body.boxes[0] == body.boxes[1]);
        check_body(&body);
        assert_ok(
            fit(&body, mesh, (const double(*)[3])mesh->x, (const double(*)[3])mesh->x));
        assert_true(body.boxes[0] == eng_body_tree_of(mesh)->boxes);
        eng_body_deinit(&body);
        eng_mesh_release(mesh);
        free(x);
    }
}

/* ---- candidates -------------------------------------------------------------------- */

#define FOUND_MAX 65536u

struct hunt {
    struct eng_sweep sweep;
    struct eng_poses poses;
    struct eng_path path;
    struct eng_body body[2];
    struct eng_mesh *mesh[2];
    struct eng_distances distances;
    uint32_t found_count;
    struct eng_sweep_pair found[FOUND_MAX];
    uint64_t looks; /* when should_stop was asked last */
    uint64_t looks_most;
    uint64_t asked;
    uint64_t stop_at;
};

static bool take(void *owner, const struct eng_sweep_pair *pair)
{
    struct hunt *hunt = owner;
    assert_true(hunt->found_count < FOUND_MAX);
    hunt->found[hunt->found_count++] = *pair;
    return true;
}

static bool should_stop(void *owner)
{
    struct hunt *hunt = owner;
    uint64_t looks = hunt->sweep.box_tests + hunt->sweep.leaf_tests * 4;
    hunt->looks_most =
        looks - hunt->looks > hunt->looks_most ? looks - hunt->looks : hunt->looks_most;
    hunt->looks = looks;
    return ++hunt->asked == hunt->stop_at;
}

static struct hunt *hunt_new(void)
{
    struct hunt *hunt = test_room(sizeof *hunt);
    assert_ok(eng_sweep()->init(&hunt->sweep));
    assert_ok(eng_distances_init(&hunt->distances));
    hunt->sweep.take = take;
    hunt->sweep.should_stop = should_stop;
    hunt->sweep.owner = hunt;
    hunt->sweep.t_end = 1;
    hunt->sweep.t_last = 1;
    hunt->sweep.tests_most = UINT64_MAX;
    hunt->sweep.poses = &hunt->poses;
    for (int i = 0; i < 2; i++) {
        hunt->sweep.body[i] = &hunt->body[i];
    }
    return hunt;
}

static void hunt_free(struct hunt *hunt)
{
    for (int i = 0; i < 2; i++) {
        eng_body_deinit(&hunt->body[i]);
        eng_mesh_release(hunt->mesh[i]);
    }
    eng_sweep()->deinit(&hunt->sweep);
    eng_distances_deinit(&hunt->distances);
    free(hunt);
}

static void hunt_begin(struct hunt *hunt)
{
    eng_poses_begin(&hunt->poses, &hunt->path);
    hunt->found_count = 0;
    eng_sweep()->begin(&hunt->sweep);
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, offsetof(struct eng_sweep_pair, span));
}

static void sort_found(struct hunt *hunt)
{
    qsort(hunt->found, hunt->found_count, sizeof *hunt->found, compare);
    for (uint32_t i = 1; i < hunt->found_count; i++) {
        assert_true(compare(&hunt->found[i - 1], &hunt->found[i]) < 0); /* once each */
    }
}

static void place(const struct hunt *hunt, const struct eng_path_pose *pose, double t,
                  int side, uint32_t vertex, double x[3])
{
    const struct eng_body *body = &hunt->body[side];
    const double *x0 = body->x[0][vertex];
    const double *x1 = body->x[1][vertex];
    for (size_t k = 0; k < 3; k++) {
        x[k] = side == 0 ? (1 - t) * x0[k] + t * x1[k]
                         : eng_dot(pose->m + 4 * k, x0) + pose->m[4 * k + 3];
    }
}

static uint32_t points_of(const struct hunt *hunt, const struct eng_sweep_pair *pair,
                          int i, uint32_t v[3])
{
    uint32_t side = i == 0 ? pair->side_a : 1 - pair->side_a;
    const struct eng_face *leaf = &hunt->mesh[side]->leaves[pair->leaf[i]];
    uint32_t points = common_kinds[pair->kind].points[i];
    for (uint32_t k = 0; k < points; k++) {
        v[k] = leaf->v[(pair->place[i] + k) % 3];
    }
    return points;
}

/* A pair that is within keep at a time is a candidate for that time. */
static void check_pair(const struct hunt *hunt, const struct eng_path_pose *pose,
                       double t, const struct eng_sweep_pair *pair)
{
    double x[4][3];
    uint32_t count = 0;
    for (int i = 0; i < 2; i++) {
        uint32_t v[3];
        uint32_t points = points_of(hunt, pair, i, v);
        for (uint32_t k = 0; k < points; k++) {
            place(hunt, pose, t, (int)(i == 0 ? pair->side_a : 1 - pair->side_a), v[k],
                  x[count++]);
        }
    }
    for (; count < 4; count++) {
        memcpy(x[count], x[count - 1], sizeof x[count]);
    }
    struct eng_distance_bounds bounds;
    if (eng_distance_bound(pair->kind, (const double(*)[3])x, &bounds) &&
        bounds.hi <= hunt->sweep.keep) {
        const struct eng_sweep_pair *found =
            bsearch(pair, hunt->found, hunt->found_count, sizeof *hunt->found, compare);
        assert_non_null(found);
        assert_true(found->span[0] <= t && t <= found->span[1]);
    }
}

static uint32_t owned(const struct eng_face *leaf, uint32_t points)
{
    return points == 1   ? leaf->owns & 7u
           : points == 2 ? leaf->owns >> 3 & 7u
                         : leaf->owns / ENG_OWNS_FACE & 1u;
}

static void check_leaves(const struct hunt *hunt, const struct eng_path_pose *pose,
                         double t, enum pccd_kind kind, uint32_t side_a, uint32_t a,
                         uint32_t b)
{
    uint32_t of_a = owned(&hunt->mesh[side_a]->leaves[a], common_kinds[kind].points[0]);
    uint32_t of_b =
        owned(&hunt->mesh[1 - side_a]->leaves[b], common_kinds[kind].points[1]);
    for (uint32_t i = 0; i < 9; i++) {
        if (of_a >> i / 3 & of_b >> i % 3 & 1) {
            struct eng_sweep_pair pair;
            memset(&pair, 0, sizeof pair);
            pair.kind = kind;
            pair.side_a = side_a;
            pair.leaf[0] = a;
            pair.leaf[1] = b;
            pair.place[0] = i / 3;
            pair.place[1] = i % 3;
            check_pair(hunt, pose, t, &pair);
        }
    }
}

static bool is_free(const struct eng_mesh *mesh, uint32_t leaf, uint32_t points)
{
    uint32_t faces = mesh->info.triangle_count;
    uint32_t edges = faces + mesh->info.free_edge_count;
    return points == 2 ? leaf >= faces && leaf < edges : leaf >= edges;
}

static void check_moment(const struct hunt *hunt, double t)
{
    struct eng_path_pose pose;
    eng_path_pose(&hunt->path, t, &pose);
    for (uint32_t a = 0; a < hunt->mesh[0]->leaf_count; a++) {
        for (uint32_t b = 0; b < hunt->mesh[1]->leaf_count; b++) {
            check_leaves(hunt, &pose, t, PCCD_VF, 0, a, b);
            check_leaves(hunt, &pose, t, PCCD_VF, 1, b, a);
            check_leaves(hunt, &pose, t, PCCD_EE, 0, a, b);
            if (is_free(hunt->mesh[0], a, 1) && is_free(hunt->mesh[1], b, 1)) {
                check_leaves(hunt, &pose, t, PCCD_VV, 0, a, b);
            }
            if (is_free(hunt->mesh[0], a, 1) && is_free(hunt->mesh[1], b, 2)) {
                check_leaves(hunt, &pose, t, PCCD_VE, 0, a, b);
            }
            if (is_free(hunt->mesh[0], a, 2) && is_free(hunt->mesh[1], b, 1)) {
                check_leaves(hunt, &pose, t, PCCD_VE, 1, b, a);
            }
        }
    }
}

/* Where the points of a mesh are at the end of a step. */
static double (*random_end(struct prng *random, const struct eng_mesh *mesh))[3]
{
    double(*x)[3] = test_room(mesh->info.vertex_count * sizeof *x);
    for (uint32_t i = 0; i < mesh->info.vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            x[i][k] = mesh->x[i][k] + prng_between(random, -0.5, 0.5);
        }
    }
    return x;
}

/* Joints whose values change by less than a turn or so. */
static void random_joints(struct prng *random, struct pccd_joint *joints, uint32_t count)
{
    turns_random(random, joints, count, 1.5);
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            double by = joints[i].to[k] - joints[i].from[k];
            joints[i].to[k] = joints[i].from[k] + eng_least(eng_most(by, -5), 5);
        }
    }
}

/* All instruction sets find the same, in the same spans. */
static void check_sets(struct hunt *hunt)
{
    const uint32_t count = hunt->found_count;
    struct eng_sweep_pair *found = test_room((count + 1) * sizeof *found);
    memcpy(found, hunt->found, count * sizeof *found);
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        if (eng_kernels_of((enum eng_isa)isa)) {
            hunt_begin(hunt);
            assert_ok(eng_sweep_of((enum eng_isa)isa)->run(&hunt->sweep, ENG_SWEEP_ALL));
            assert_int_equal(hunt->found_count, count);
            for (uint32_t i = 0; i < count; i++) {
                assert_int_equal(compare(&hunt->found[i], &found[i]), 0);
                assert_true(hunt->found[i].span[0] == found[i].span[0]);
                assert_true(hunt->found[i].span[1] == found[i].span[1]);
            }
        }
    }
    free(found);
}

/* If it failed: contacts would be missed, or depend on the processor. */
CASE(sweep__finds_all_that_comes_near)
{
    struct prng random = {prng_seed()};
    uint64_t found = 0;
    uint64_t all = 0;
    for (int n = 0; n < 400; n++) {
        struct hunt *hunt = hunt_new();
        struct pccd_joint joints[6];
        uint32_t count = 2 + prng_u32(&random, 5);
        random_joints(&random, joints, count);
        for (int i = 0; i < 2; i++) {
            hunt->mesh[i] = random_mesh(&random);
            eng_body_set(&hunt->body[i], hunt->mesh[i]);
        }
        bool deforms = n % 3 == 0;
        double(*end)[3] = random_end(&random, hunt->mesh[0]);
        if (deforms) {
            assert_ok(fit(&hunt->body[0], hunt->mesh[0],
                          (const double(*)[3])hunt->mesh[0]->x, (const double(*)[3])end));
        }
        assert_ok(eng_path_between(joints, deforms ? PCCD_NO_JOINT : count - 2, count - 1,
                                   &hunt->path));
        hunt->sweep.keep = n % 4 == 0 ? 0.3 : n % 4 == 1 ? 1e-3 : 0.03;
        hunt->sweep.wants_free = true;
        hunt->sweep.fineness = 1e-6;
        hunt_begin(hunt);
        assert_ok(eng_sweep()->run(&hunt->sweep, ENG_SWEEP_ALL));
        check_sets(hunt);
        sort_found(hunt);
        for (int i = 0; i <= 24; i++) {
            check_moment(hunt, i / 24.0);
            check_moment(hunt, prng_between(&random, 0, 1));
        }
        found += hunt->found_count;
        all += (uint64_t)hunt->mesh[0]->leaf_count * hunt->mesh[1]->leaf_count * 3;
        hunt_free(hunt);
        free(end);
    }
    print_message("# %llu candidates of some %llu pairs\n", (unsigned long long)found,
                  (unsigned long long)all);
}

/* A wall of 8 x 8 squares across x. */
static struct eng_mesh *wall_at(double x)
{
    double v[81][3];
    uint32_t t[128][3];
    for (uint32_t i = 0; i < 81; i++) {
        v[i][0] = x;
        v[i][1] = i % 9 / 8.0 - 0.5;
        v[i][2] = i / 9 / 8.0 - 0.5;
    }
    for (uint32_t i = 0; i < 64; i++) {
        uint32_t at = i + i / 8;
        const uint32_t both[2][3] = {{at, at + 1, at + 9}, {at + 1, at + 10, at + 9}};
        memcpy(t[2 * i], both, sizeof both);
    }
    return kit_mesh(v, 81, t, 128);
}

/* If it failed: a wall that is beside a box at both ends of a span, and goes through it
 * on its way round in between, always parallel to itself, would be missed. */
CASE(sweep__finds_what_comes_near_between_the_ends)
{
    static const double low[3] = {0.98, -0.02, -0.02};
    static const double high[3] = {1.02, 0.02, 0.02};
    const struct pccd_joint joints[2] = {{.kind = PCCD_JOINT_TURN,
                                          .parent = PCCD_NO_JOINT,
                                          .rotation = {0, 0, 0, 1},
                                          .axis = {0, 0, 1},
                                          .from = {-0.3},
                                          .to = {0.3}},
                                         {.kind = PCCD_JOINT_TURN,
                                          .parent = 0,
                                          .position = {1, 0, 0},
                                          .rotation = {0, 0, 0, 1},
                                          .axis = {0, 0, 1},
                                          .from = {0.3},
                                          .to = {-0.3}}};
    for (int box = 0; box < 2; box++) { /* its side: the one that stands, or turns */
        struct hunt *hunt = hunt_new();
        hunt->mesh[box] = kit_box(low, high, false);
        hunt->mesh[1 - box] = wall_at(0);
        for (int i = 0; i < 2; i++) {
            assert_ok(eng_body_tree_prepare(hunt->mesh[i], NULL, NULL));
            eng_body_set(&hunt->body[i], hunt->mesh[i]);
        }
        assert_ok(eng_path_between(joints, box == 0 ? PCCD_NO_JOINT : 1,
                                   box == 0 ? 1 : PCCD_NO_JOINT, &hunt->path));
        hunt->sweep.keep = 1e-3;
        hunt->sweep.fineness = 1e-6;
        hunt_begin(hunt);
        assert_ok(eng_sweep()->run(&hunt->sweep, ENG_SWEEP_ALL));
        assert_true(hunt->found_count > 8);
        sort_found(hunt);
        for (int i = 0; i <= 256; i++) {
            check_moment(hunt, i / 256.0);
        }
        hunt_free(hunt);
    }
}

static void hunt_sheets(struct hunt *hunt, uint32_t side, double above, double angle)
{
    struct pccd_joint joint = {.kind = PCCD_JOINT_TURN,
                               .parent = PCCD_NO_JOINT,
                               .position = {0.5, 0.5, 0},
                               .rotation = {0, 0, 0, 1},
                               .axis = {0, 0, 1},
                               .to = {angle}};
    for (int i = 0; i < 2; i++) {
        hunt->mesh[i] = kit_sheet(side, i == 0 ? 0 : above);
        assert_ok(eng_body_tree_prepare(hunt->mesh[i], NULL, NULL));
        eng_body_set(&hunt->body[i], hunt->mesh[i]);
    }
    assert_ok(eng_path_between(&joint, PCCD_NO_JOINT, 0, &hunt->path));
    hunt->sweep.keep = 1e-5;
    hunt->sweep.fineness = 1e-6;
    hunt_begin(hunt);
}

/* If it failed: two threads would test a pair both, or none of them would. */
CASE(tasks__have_each_pair_once)
{
    struct hunt *hunt = hunt_new();
    uint64_t tasks[64];
    hunt_sheets(hunt, 6, 0, 0.3);
    assert_ok(eng_sweep()->run(&hunt->sweep, ENG_SWEEP_ALL));
    sort_found(hunt);
    uint32_t whole = hunt->found_count;
    struct eng_sweep_pair *all = test_copy(hunt->found, whole * sizeof *all);
    for (uint32_t most = 1; most <= 64; most *= 2) {
        hunt_begin(hunt);
        uint32_t count = eng_sweep()->split(&hunt->sweep, most, tasks);
        assert_true(count >= 1 && count <= most && 4 * count >= most);
        for (uint32_t i = 0; i < count; i++) {
            assert_ok(eng_sweep()->run(&hunt->sweep, tasks[i]));
        }
        sort_found(hunt);
        assert_int_equal(hunt->found_count, whole);
        for (uint32_t i = 0; i < whole; i++) {
            assert_int_equal(compare(&all[i], &hunt->found[i]), 0);
        }
    }
    free(all);
    hunt_free(hunt);
}

/* If it failed: a deadline would be late: of two sheets that slide on each other all the
 * time, which is the worst there is, each pair of nodes and each span has to be looked
 * at. Some 4 * 2048 boxes are 0.1 ms. */
CASE(sweep__asks_often_whether_it_should_stop)
{
    struct hunt *hunt = hunt_new();
    hunt_sheets(hunt, 24, 0, 100);
    hunt->stop_at = 50;
    assert_ok(eng_sweep()->run(&hunt->sweep, ENG_SWEEP_ALL));
    assert_int_equal(hunt->asked, 50);
    assert_true(hunt->looks_most <= 5 * 2048);
    hunt_free(hunt);
}

/* If it failed: the boxes of what stays 0.05 above the other would be looked at down to
 * the leaves, and each of these at many times. */
CASE(sweep__is_short_where_there_is_a_clearance)
{
    struct hunt *hunt = hunt_new();
    hunt_sheets(hunt, 32, 0.05, 1);
    assert_ok(eng_sweep()->run(&hunt->sweep, ENG_SWEEP_ALL));
    assert_int_equal(hunt->found_count, 0);
    print_message("# %llu tests of boxes\n", (unsigned long long)hunt->sweep.box_tests);
    assert_true(hunt->sweep.box_tests < 100);
    hunt_free(hunt);
}

/* If it failed: bodies below the range of floats would be looked at in all spans that
 * there is room for, for half a minute. */
CASE(sweep__is_short_for_the_smallest_bodies)
{
    struct hunt *hunt = hunt_new();
    struct pccd_joint joint = {.kind = PCCD_JOINT_TURN,
                               .parent = PCCD_NO_JOINT,
                               .rotation = {0, 0, 0, 1},
                               .axis = {0, 0, 1},
                               .to = {3}};
    const double x[4][3] = {{0}, {1e-300, 0, 0}, {0, 1e-300, 0}, {0, 0, 1e-300}};
    const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int i = 0; i < 2; i++) {
        hunt->mesh[i] = kit_mesh(x, 4, triangles, 2);
        assert_ok(eng_body_tree_prepare(hunt->mesh[i], NULL, NULL));
        eng_body_set(&hunt->body[i], hunt->mesh[i]);
    }
    assert_ok(eng_path_between(&joint, PCCD_NO_JOINT, 0, &hunt->path));
    hunt->sweep.keep = 1e-305;
    hunt->sweep.fineness = 1e-306;
    hunt_begin(hunt);
    hunt->sweep.tests_most = 100000;
    assert_ok(eng_sweep()->run(&hunt->sweep, ENG_SWEEP_ALL));
    assert_true(hunt->found_count > 0);
    assert_true(hunt->sweep.box_tests < 1000);
    hunt_free(hunt);
}

/* Ask for a tree until it is there, each time until it has asked once. Returns how
 * often. */
static uint32_t make_in_parts(struct hunt *hunt, struct eng_mesh *mesh)
{
    uint32_t parts = 1;
    for (;; parts++) {
        hunt->stop_at = hunt->asked + 1;
        if (eng_body_tree_prepare(mesh, should_stop, hunt) == PCCD_OK) {
            return parts;
        }
        assert_null(eng_body_tree_of(mesh));
        assert_true(eng_mesh_bytes(mesh) > 0 && parts < 100000);
    }
}

static void check_equal(const struct eng_body_tree *a, const struct eng_body_tree *b)
{
    assert_int_equal(a->node_count, b->node_count);
    assert_memory_equal(a->children, b->children, a->node_count * sizeof *a->children);
    assert_memory_equal(a->boxes, b->boxes, a->node_count * sizeof *a->boxes);
    assert_memory_equal(&a->box, &b->box, sizeof a->box);
}

/* If it failed: a step would not end at its deadline while it makes the tree of a mesh,
 * or begin anew with each step and never have it, or have another one. */
CASE(tree__is_made_in_parts)
{
    struct hunt *hunt = hunt_new();
    struct prng random = {2};
    for (int n = 0; n < 2; n++) {
        /* The leaves of the other lie in one place: only halves are left. */
        static const double x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        static uint32_t same[20000][3];
        for (uint32_t i = 0; i < 20000; i++) {
            memcpy(same[i], (uint32_t[3]){0, 1, 2}, sizeof same[i]);
        }
        struct eng_mesh *mesh[2];
        for (int i = 0; i < 2; i++) {
            random.state = 2;
            mesh[i] = n == 0 ? kit_soup(&random, 20000) : kit_mesh(x, 3, same, 20000);
        }
        uint32_t leaves = mesh[0]->leaf_count;
        hunt->asked = 0;
        hunt->stop_at = UINT32_MAX;
        assert_ok(eng_body_tree_prepare(mesh[0], should_stop, hunt));
        /* On each of the seven levels above the leaves all are looked at three times, or
         * in halves twice: 8192 a look. */
        assert_true(hunt->asked >= 7 * 2 * leaves / 8192);
        uint64_t asked = hunt->asked;
        uint32_t parts = make_in_parts(hunt, mesh[1]);
        assert_true(parts > asked / 2 && parts <= asked + 1);
        check_equal(eng_body_tree_of(mesh[0]), eng_body_tree_of(mesh[1]));
        assert_int_equal(eng_mesh_bytes(mesh[0]), eng_mesh_bytes(mesh[1]));
        eng_mesh_release(mesh[0]);
        eng_mesh_release(mesh[1]);
    }
    hunt_free(hunt);
}

/* If it failed: a mesh that goes would leave behind what there is of its tree. */
CASE(tree__goes_with_its_mesh_unmade)
{
    struct hunt *hunt = hunt_new();
    struct prng random = {3};
    uint64_t before = eng_alloc_bytes();
    for (uint32_t part = 1; part < 60; part += 7) {
        struct eng_mesh *mesh = kit_soup(&random, 20000);
        hunt->stop_at = hunt->asked + part;
        (void)eng_body_tree_prepare(mesh, should_stop, hunt);
        eng_mesh_release(mesh);
    }
    assert_int_equal(eng_alloc_bytes(), before);
    hunt_free(hunt);
}

/* If it failed: a deadline would be late beside what is large and deforms. */
CASE(boxes__ask_often_whether_to_stop)
{
    enum { SIDE = 150, VERTICES = (SIDE + 1) * (SIDE + 1) };
    struct hunt *hunt = hunt_new();
    struct eng_body *body = &hunt->body[0];
    double(*x)[3] = test_room(VERTICES * sizeof *x);
    hunt->mesh[0] = kit_sheet(SIDE, 0);
    assert_ok(eng_body_tree_prepare(hunt->mesh[0], NULL, NULL));
    body->should_stop = should_stop;
    body->owner = hunt;
    const double(*x0)[3] = (const double(*)[3])hunt->mesh[0]->x;
    assert_ok(fit(body, hunt->mesh[0], x0, (const double(*)[3])x));
    /* Two times a node for each one to four leaves, 1024 nodes a look. */
    assert_true(hunt->asked >= 2 * (2 * SIDE * SIDE / 4 / 1024));
    hunt->stop_at = hunt->asked + 2;
    assert_int_equal(fit(body, hunt->mesh[0], x0, (const double(*)[3])x), PCCD_E_AGAIN);
    free(x);
    hunt_free(hunt);
}
