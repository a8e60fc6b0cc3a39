/* test_rank_moving.c - boxes that go on as vertices go. */
#include "cases.h"
#include "moving_boxes.h"
#include "prng.h"

#define ROUNDS   40000u
#define STEPS    12u
#define VERTICES 3u

struct vertex {
    double x0[3], x1[3], now[3], next[3];
    float cover[6];
};

/* A leaf, and its promise. */
struct leaf {
    struct ranks_margin margin;
    struct vertex vertices[VERTICES];
    struct ranks_moving_box promise;
};

static struct prng prng;

/* Lengths of all kinds: near 1 as a rule, far from it sometimes. */
static double random_size(void)
{
    static const double sizes[] = {1, 1, 1, 1, 1e-12, 1e6, 1e15, 1e18, 0};
    return sizes[prng_below(&prng, sizeof sizes / sizeof *sizes)];
}

static void make_leaf(struct leaf *leaf, bool is_whole, double scale, double far)
{
    *leaf = (struct leaf){.margin.steps = STEPS, .margin.is_whole = is_whole};
    ranks_moving_box_begin(&leaf->promise);
    for (int k = 0; k < 3; k++) {
        leaf->margin.follows[k] = prng_below(&prng, 3) > 0;
        leaf->margin.more[k] = scale * (prng_below(&prng, 4) > 0 ? 0.1 : 0);
    }
    double way[3], at[3];
    for (int k = 0; k < 3; k++) {
        way[k] = scale * prng_between(&prng, -0.4, 0.4);
        at[k] = far + scale * prng_between(&prng, -2, 2);
    }
    for (uint32_t v = 0; v < VERTICES; v++) {
        struct vertex *vertex = &leaf->vertices[v];
        struct ranks_moving_box box;
        for (int k = 0; k < 3; k++) {
            vertex->x0[k] = at[k] + scale * prng_between(&prng, -0.3, 0.3);
            vertex->x1[k] =
                vertex->x0[k] + way[k] + scale * prng_between(&prng, -0.1, 0.1);
        }
        ranks_cover(vertex->x0, vertex->x1, &leaf->margin, vertex->cover);
        ranks_vertex_box(vertex->x0, vertex->x1, &leaf->margin, &box);
        ranks_moving_box_add(&leaf->promise, &box);
        memcpy(vertex->next, vertex->x0, sizeof vertex->next);
    }
}

/* Place a vertex where the cover allows it to be after `t` steps: anywhere, and at its
 * edge often. */
static void place(const struct leaf *leaf, struct vertex *vertex, double t)
{
    for (int k = 0; k < 3; k++) {
        double low = (double)vertex->cover[k], high = (double)vertex->cover[k + 3];
        if (leaf->margin.follows[k]) {
            double near = low + t * high;
            double most =
                leaf->margin.more[k] + ranks_blur(vertex->cover[k], vertex->cover[k + 3]);
            low = near - most;
            high = near + most;
        }
        double part = fmin(1, fmax(0, prng_between(&prng, -0.5, 1.5)));
        vertex->next[k] = part < 1 ? low + part * (high - low) : high;
    }
}

/* Vertices go on by a step. */
static void go(struct leaf *leaf, uint32_t step)
{
    for (uint32_t v = 0; v < VERTICES; v++) {
        struct vertex *vertex = &leaf->vertices[v];
        memcpy(vertex->now, vertex->next, sizeof vertex->now);
        if (step == 0) {
            memcpy(vertex->next, vertex->x1, sizeof vertex->next);
        } else {
            place(leaf, vertex, step + 1);
        }
        assert_true(ranks_is_covered(vertex->now, step, &leaf->margin, vertex->cover));
        assert_true(
            ranks_is_covered(vertex->next, step + 1, &leaf->margin, vertex->cover));
    }
}

/* The box of the leaf from one part of the step to another one. */
static void bound(const struct leaf *leaf, double from, double to, double low[3],
                  double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (uint32_t v = 0; v < VERTICES; v++) {
            double now = leaf->vertices[v].now[k], next = leaf->vertices[v].next[k];
            double a = from < 1 ? now + from * (next - now) : next;
            double b = to < 1 ? now + to * (next - now) : next;
            low[k] = fmin(low[k], fmin(a, b));
            high[k] = fmax(high[k], fmax(a, b));
        }
    }
}

static bool meet(const struct leaf *a, const struct leaf *b, double from, double to)
{
    double a_low[3], a_high[3], b_low[3], b_high[3];
    bool meets = true;
    bound(a, from, to, a_low, a_high);
    bound(b, from, to, b_low, b_high);
    for (int k = 0; k < 3; k++) {
        meets = meets && a_low[k] <= b_high[k] && b_low[k] <= a_high[k];
    }
    return meets;
}

/* If it failed, a rank would not get a leaf that one of its own meets some steps after
 * ghosts were chosen, and a contact would be missed. */
CASE(rank_moving__boxes_meet_whenever_vertices_do)
{
    uint32_t met = 0, apart = 0;
    prng.state = prng_seed();
    for (uint32_t round = 0; round < ROUNDS; round++) {
        struct leaf a, b;
        double far = random_size(), scale = random_size();
        bool is_whole = prng_below(&prng, 2) == 0, meets = false;
        make_leaf(&a, is_whole, scale, far);
        make_leaf(&b, is_whole, scale, far);
        for (uint32_t s = 0; s < STEPS; s++) {
            go(&a, s);
            go(&b, s);
            for (int part = 0; part <= 4; part++) {
                meets = meets || (is_whole ? meet(&a, &b, 0, 1)
                                           : meet(&a, &b, 0.25 * part, 0.25 * part));
            }
        }
        double time = ranks_margin_time(&a.margin);
        bool promised = ranks_moving_boxes_meet(&a.promise, &b.promise, time);
        assert_true(promised || !meets);
        assert_true(promised == ranks_moving_boxes_meet(&b.promise, &a.promise, time));
        met += meets;
        apart += !promised;
    }
    /* Otherwise nothing was shown, or boxes would be of no use. */
    assert_true(met > ROUNDS / 20 && apart > ROUNDS / 20);
}

/* If it failed, what falls side by side would be a ghost of its neighbours, however far
 * they are: boxes around their ways overlap. */
CASE(rank_moving__what_goes_side_by_side_does_not_meet)
{
    const struct ranks_margin margin = {
        .more = {0.1, 0.1, 0.1}, .follows = {true, true, true}, .steps = 40};
    const double a0[3] = {0, 0, 10}, a1[3] = {0.1, 0, 9}, b0[3] = {0, 0, 8},
                 b1[3] = {0.1, 0, 7};
    const double up[3] = {0, 0, 9};
    struct ranks_moving_box a, b, c;
    ranks_vertex_box(a0, a1, &margin, &a);
    ranks_vertex_box(b0, b1, &margin, &b);
    ranks_vertex_box(b0, up, &margin, &c); /* against the others' way */
    assert_false(ranks_moving_boxes_meet(&a, &b, margin.steps));
    assert_true(ranks_moving_boxes_meet(&b, &c, margin.steps));
    assert_true(ranks_moving_boxes_meet(&a, &c, margin.steps));
    const double away[3] = {0, 0, 7.5};
    ranks_vertex_box(a0, up, &margin, &a); /* slower than what is below it */
    ranks_vertex_box(b0, away, &margin, &b);
    assert_true(ranks_moving_boxes_meet(&a, &b, margin.steps));
    assert_false(ranks_moving_boxes_meet(&a, &b, 0));
}

/* If it failed, a box would be smaller than what is in it by a rounding, or larger by
 * more than one. */
CASE(rank_moving__floats_are_rounded_outward)
{
    static const double some[] = {0, 1, 1e-50, 1e-42, 3e38, 3.5e38, 1e300, 0.1, 1 + 1e-9};
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            double x = sign * some[i];
            float f = (float)x;
            assert_true(ranks_float_below(x) ==
                        ((double)f > x ? nextafterf(f, -INFINITY) : f));
            assert_true(ranks_float_above(x) ==
                        ((double)f < x ? nextafterf(f, INFINITY) : f));
            assert_true((double)ranks_float_below(x) <= x);
            assert_true((double)ranks_float_above(x) >= x);
        }
    }
}

/* If it failed, a rank would keep its ghosts though a vertex is where they were not
 * chosen for, and a contact would be missed; or it would choose them anew each step. */
CASE(rank_moving__a_vertex_that_leaves_its_box_is_noticed)
{
    const double x0[3] = {0, 0, 10}, x1[3] = {1, -1, 9}; /* by 1 along each axis */
    const double more = 0.25, beside = 0.26, within = 0.24, later = 5;
    for (int axis = 0; axis < 3; axis++) {
        for (int follows = 0; follows < 2; follows++) {
            const struct ranks_margin margin = {
                .more = {more, more, more},
                .follows = {follows == 1, follows == 1, follows == 1},
                .steps = later};
            float cover[6];
            ranks_cover(x0, x1, &margin, cover);
            for (int side = -1; side <= 1; side += 2) {
                /* Later it has gone on, or stands at the end that is on this side. */
                double t = follows == 1 ? later : 1;
                double x[3];
                for (int k = 0; k < 3; k++) {
                    x[k] = x0[k] + t * (x1[k] - x0[k]);
                }
                if (follows == 0) {
                    x[axis] =
                        side < 0 ? fmin(x0[axis], x1[axis]) : fmax(x0[axis], x1[axis]);
                }
                const double is = x[axis];
                x[axis] = is + side * within;
                assert_true(ranks_is_covered(x, later, &margin, cover));
                x[axis] = is + side * beside;
                assert_false(ranks_is_covered(x, later, &margin, cover));
            }
            /* What stands still at x1 is soon not where it would have gone on to. */
            assert_true(ranks_is_covered(x1, 1, &margin, cover));
            assert_true(ranks_is_covered(x1, later, &margin, cover) == (follows == 0));
        }
    }
}
