/* sweep.c - two trees against each other, over spans of time; compiled once for every
 * instruction set, as kernels are (kernel/local.mk). */
#include "sweep.h"

#include <math.h>
#include <string.h>

#include "four_leaves.h"
#include "kinds.h"
#include "memory.h"
#include "vec.h"

/* A span is divided before a node if the motion leaves its chord by more than this part
 * of the larger box, or moves it by that part of its size. */
#define BEND_PART   0.5f
#define MOTION_PART 1.0f

/* The same of two leaves, beside the smaller one, or that part of the larger one. */
#define LEAF_BEND_PART   0.125f
#define LEAF_MOTION_PART 2.0f
#define LARGER_PART      0.125f

#define DEPTH_MAX 30u

/* Added to half of a box: what is smaller than that is not looked at more closely, nor
 * are spans divided for it. As the boxes of nodes have it. */
#define LEAST 0x1p-120

/* Spans of nodes are not shorter than 2^-this: there would be too many of them, where a
 * body turns very often. This leaves more to be decided. */
#define NODES_DEPTH_MAX 18u

/* Spans of the stack: a run ends that needs more; so many are kept for the next two
 * bodies. */
#define SPANS_MOST (1u << 22)
#define SPANS_KEPT (1u << 14)

/* Nodes and spans that are looked at before should_stop is asked: some 20 ns each, and a
 * span whose frame has to be made. */
#define LOOKS          2048u
#define LOOKS_OF_FRAME 32u

#define FRAMES 256u /* a power of two */

#define AXES 8 /* x, y, z of side 0, one unused; of side 1 at the middle, one unused */

/* Numbers by axis. A point b of side 1 lies at rb[end] b + off[end] along it, one of side
 * 0, a, at ra a. */
struct eng_sweep_frame {
    float t[2];
    float slack;
    _Alignas(16) float rb[2][3][AXES];
    float rb_most[3][AXES]; /* the larger magnitude of both ends */
    float off[2][AXES];
    float ra[3][4]; /* of the last four */
    float ra_abs[3][4];
    /* A point b is off its chord, in the middle, by bow b + bow_off along an axis, and
     * elsewhere by a part of that; bow_error is for what is not so, in any direction. */
    float bow[3][AXES];
    float bow_off[AXES];
    float bow_error;
    float bow_most; /* how far any point of side 1 is off its chord */
};

/* Frames that are kept, and of which spans; a depth of UINT16_MAX: of none. */
struct eng_sweep_frames {
    struct eng_sweep_span span[FRAMES];
    struct eng_sweep_frame frame[FRAMES];
};

/* A node or a leaf of a side, with its box at both ends of the step. */
struct item {
    uint32_t ref;   /* 0: the root; else its place + 1 among the children of all nodes */
    uint32_t child; /* body_tree.h */
    float size;     /* half of the longest side */
    f4 centre[2];
    f4 half[2];
};

/* ---- vectors ----------------------------------------------------------------------- */

static inline float least(float a, float b)
{
    return a < b ? a : b;
}

static inline float most(float a, float b)
{
    return a > b ? a : b;
}

static inline f4 load4(const float *x)
{
    return *(const f4 *)(const void *)x;
}

/* Return which are apart by more than `reach`, on the same side at both ends. */
static inline eng_i4 are_apart(f4 d0, f4 d1, f4 reach)
{
    return eng_max4(eng_min4(d0, d1), eng_min4(-d0, -d1)) > reach;
}

/* ---- spans of time ---------------------------------------------------------------- */

/* Return how long a span is. */
static double length_of(struct eng_sweep_span span)
{
    return 1.0 / (double)(1u << span.depth);
}

static double begin_of(struct eng_sweep_span span)
{
    return span.index * length_of(span);
}

static struct eng_sweep_span half_of(struct eng_sweep_span span, uint32_t which)
{
    return (struct eng_sweep_span){span.index * 2 + which, (uint16_t)(span.depth + 1), 0};
}

/* ---- where the sides are in a span ------------------------------------------------- */

/* The pose as side 1 has it, measured from both origins. */
static void shift_pose(const struct eng_sweep *sweep, double t, double r[3][3],
                       double off[3])
{
    const struct eng_path_pose *pose = eng_poses_at(sweep->poses, t);
    const double *from = sweep->body[1]->origin;
    for (int i = 0; i < 3; i++) {
        const double *row = pose->m + 4 * (size_t)i;
        memcpy(r[i], row, sizeof r[i]);
        off[i] = (row[3] - sweep->body[0]->origin[i]) + eng_dot(row, from);
    }
}

/* Return how far points of a body may be from its origin along an axis. */
static double half_of_root(const struct eng_body *body, int k)
{
    return eng_most(body->box.hi[k] - body->origin[k], body->origin[k] - body->box.lo[k]);
}

static void set_bow(const struct eng_sweep *sweep, double t0, double t1,
                    const double u[3][3], struct eng_sweep_frame *frame)
{
    struct eng_path_pose pose[3];
    struct eng_path_span span;
    double r[4][3]; /* by column, off last */
    pose[0] = *eng_poses_at(sweep->poses, t0);
    pose[1] = *eng_poses_at(sweep->poses, 0.5 * (t0 + t1));
    pose[2] = *eng_poses_at(sweep->poses, t1);
    eng_path_span(sweep->poses->path, t0, t1, pose, &span);
    for (int k = 0; k < 3; k++) {
        const double *row = span.m + 4 * (size_t)k;
        for (int c = 0; c < 3; c++) {
            r[c][k] = row[c];
        }
        r[3][k] = row[3] + eng_dot(row, sweep->body[1]->origin);
    }
    for (int c = 0; c < 4; c++) {
        float *to = c < 3 ? frame->bow[c] : frame->bow_off;
        for (int k = 0; k < 3; k++) {
            to[k] = (float)r[c][k];
            to[4 + k] =
                (float)(r[c][0] * u[0][k] + r[c][1] * u[1][k] + r[c][2] * u[2][k]);
        }
    }
    double error = span.error[0] + span.error[1] * sweep->size;
    frame->bow_error = eng_round_up(eng_least(error, 0x1p100));
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double along = fabs((double)frame->bow_off[k]);
        for (int c = 0; c < 3; c++) {
            along += fabs(r[c][k]) * half_of_root(sweep->body[1], c);
        }
        most += along * along;
    }
    frame->bow_most = eng_round_up(sqrt(most)) + frame->bow_error;
}

static void make_frame(const struct eng_sweep *sweep, struct eng_sweep_span span,
                       struct eng_sweep_frame *frame)
{
    double h = length_of(span);
    double u[3][3];
    double off[3];
    memset(frame, 0, sizeof *frame);
    shift_pose(sweep, (span.index + 0.5) * h, u, off);
    double far = eng_size(off);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            frame->ra[i][j] = (float)u[i][j];
            frame->ra_abs[i][j] = fabsf(frame->ra[i][j]);
        }
    }
    for (uint32_t end = 0; end < 2; end++) {
        double r[3][3];
        frame->t[end] = (float)((span.index + end) * h);
        shift_pose(sweep, (span.index + end) * h, r, off);
        far = eng_most(far, eng_size(off));
        for (int k = 0; k < 3; k++) {
            double along = off[0] * u[0][k] + off[1] * u[1][k] + off[2] * u[2][k];
            frame->off[end][k] = (float)off[k];
            frame->off[end][4 + k] = (float)along;
            for (int c = 0; c < 3; c++) {
                double to = r[0][c] * u[0][k] + r[1][c] * u[1][k] + r[2][c] * u[2][k];
                frame->rb[end][c][k] = (float)r[k][c];
                frame->rb[end][c][4 + k] = (float)to;
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < AXES; k++) {
            frame->rb_most[c][k] =
                most(fabsf(frame->rb[0][c][k]), fabsf(frame->rb[1][c][k]));
        }
    }
    frame->slack = sweep->slack + 0x1p-18f * (float)far;
    set_bow(sweep, span.index * h, (span.index + 1) * h, (const double(*)[3])u, frame);
}

/* Ask whether to stop when so much has been looked at. */
static void ask(struct eng_sweep *sweep, uint32_t looks)
{
    if (sweep->looks_left > looks) {
        sweep->looks_left -= looks;
        return;
    }
    sweep->looks_left = LOOKS;
    sweep->stops |= sweep->should_stop(sweep->owner);
}

/* Count what is looked at. A run of too many tests ends here, whatever was looked at
 * before it, and whichever frames are kept. */
static void look(struct eng_sweep *sweep, uint32_t looks)
{
    ask(sweep, looks);
    if (sweep->box_tests + sweep->leaf_tests > sweep->tests_most && !sweep->stops) {
        sweep->status = PCCD_E_LIMIT;
        sweep->stops = true;
    }
}

/* Make the frame of a span in the place of another one. */
static __attribute__((noinline)) void keep_frame(struct eng_sweep *sweep,
                                                 struct eng_sweep_span span,
                                                 uint32_t place)
{
    ask(sweep, LOOKS_OF_FRAME);
    make_frame(sweep, span, &sweep->frames->frame[place]);
    sweep->frames->span[place] = span;
}

static inline const struct eng_sweep_frame *frame_of(struct eng_sweep *sweep,
                                                     struct eng_sweep_span span)
{
    uint32_t place = ((1u << span.depth) + span.index) % FRAMES;
    const struct eng_sweep_span *kept = &sweep->frames->span[place];
    if (kept->index != span.index || kept->depth != span.depth) {
        keep_frame(sweep, span, place);
    }
    return &sweep->frames->frame[place];
}

static float norm_of(f4 x)
{
    f4 square = x * x;
    return sqrtf(square[0] + square[1] + square[2]);
}

/* Return how far points of a box of side 1 leave their chords along four axes. */
static inline f4 bow_along(const struct eng_sweep_frame *frame, int from,
                           const struct item *b)
{
    f4 middle = load4(frame->bow_off + from);
    f4 around = all4(0);
#pragma GCC unroll 3
    for (int c = 0; c < 3; c++) {
        f4 bow = load4(frame->bow[c] + from);
        middle += bow * all4(b->centre[0][c]);
        around += abs4(bow) * all4(b->half[0][c]);
    }
    return (abs4(middle) + around) * all4(1 + 0x1p-18f);
}

static float bow_of(const struct eng_sweep_frame *frame, const struct item *b)
{
    return norm_of(bow_along(frame, 0, b)) + frame->bow_error;
}

/* Return how far its middle goes in the span. */
static float way_of(const struct eng_sweep_frame *frame, const struct item *b)
{
    f4 way = load4(frame->off[1]) - load4(frame->off[0]);
#pragma GCC unroll 3
    for (int c = 0; c < 3; c++) {
        way += (load4(frame->rb[1][c]) - load4(frame->rb[0][c])) * all4(b->centre[0][c]);
    }
    return norm_of(way);
}

/* By how much the boxes have to be apart at both ends of a span, the rounding of that
 * included, but for what points leave their chords. */
static float margin_of(const struct eng_sweep *sweep, const struct eng_sweep_frame *frame)
{
    return (sweep->margin + frame->bow_error) * (1 + 0x1p-18f) + frame->slack;
}

/* ---- nodes ------------------------------------------------------------------------- */

static bool is_leaf(const struct item *item)
{
    return (item->child & ENG_BODY_LEAF) != 0;
}

static void set_boxes(struct item *item, const struct eng_body *body, uint32_t node,
                      uint32_t which)
{
    item->size = 0;
    for (int end = 0; end < 2; end++) {
        const struct eng_body_boxes *boxes = &body->boxes[end][node];
        f4 half = {boxes->half[0][which], boxes->half[1][which],
                   boxes->half[2][which], 0};
        item->centre[end] = (f4){boxes->centre[0][which], boxes->centre[1][which],
                                 boxes->centre[2][which], 0};
        item->half[end] = half;
        item->size = most(item->size, most(most(half[0], half[1]), half[2]));
        if (body->boxes[0] == body->boxes[1]) {
            item->centre[1] = item->centre[0];
            item->half[1] = half;
            return;
        }
    }
}

static struct item child_of(const struct eng_sweep *sweep, uint32_t side,
                            const struct item *item, uint32_t which)
{
    const struct eng_body *body = sweep->body[side];
    struct item child;
    child.ref = item->child * 4 + which + 1;
    child.child = eng_body_tree_of(body->mesh)->children[item->child][which];
    set_boxes(&child, body, item->child, which);
    return child;
}

static struct item root_of(const struct eng_sweep *sweep, uint32_t side)
{
    const struct eng_body *body = sweep->body[side];
    struct item root = {.ref = 0, .child = 0};
    for (int k = 0; k < 3; k++) {
        root.half[0][k] = root.half[1][k] =
            eng_round_up(half_of_root(body, k) * (1 + 0x1p-20) + LEAST);
        root.size = most(root.size, root.half[0][k]);
    }
    return root;
}

/* Return the item that a task names. */
static struct item item_of(const struct eng_sweep *sweep, uint32_t side, uint32_t ref)
{
    struct item item = root_of(sweep, side);
    if (ref > 0) {
        const struct eng_body *body = sweep->body[side];
        uint32_t node = (ref - 1) / 4;
        item.ref = ref;
        item.child = eng_body_tree_of(body->mesh)->children[node][(ref - 1) % 4];
        set_boxes(&item, body, node, (ref - 1) % 4);
    }
    return item;
}

/* ---- boxes in a span --------------------------------------------------------------- */

/* A box at both ends of a span; of side 1, whose frame turns, the same. */
struct moving_box {
    f4 centre[2];
    f4 half;
};

static inline f4 mix(f4 x0, f4 x1, float t)
{
    return x0 + (x1 - x0) * all4(t);
}

static struct moving_box box_in(const struct eng_sweep *sweep,
                                const struct eng_sweep_frame *frame,
                                const struct item *item)
{
    const struct eng_body *body = sweep->body[0];
    if (body->boxes[0] == body->boxes[1]) {
        return (struct moving_box){{item->centre[0], item->centre[0]}, item->half[0]};
    }
    struct moving_box box;
    f4 half[2];
    for (int end = 0; end < 2; end++) {
        box.centre[end] = mix(item->centre[0], item->centre[1], frame->t[end]);
        half[end] = mix(item->half[0], item->half[1], frame->t[end]);
    }
    box.half = eng_max4(half[0], half[1]);
    return box;
}

/* Along four axes, which begin at `from`. */
struct shadow {
    f4 centre[2];
    f4 half;
};

/* With what its points leave their chords. */
static inline struct shadow shadow_of_b(const struct eng_sweep_frame *frame, int from,
                                        const struct item *b)
{
    struct shadow shadow = {{load4(frame->off[0] + from), load4(frame->off[1] + from)},
                            bow_along(frame, from, b)};
#pragma GCC unroll 3
    for (int c = 0; c < 3; c++) {
        f4 at = all4(b->centre[0][c]);
        shadow.centre[0] += load4(frame->rb[0][c] + from) * at;
        shadow.centre[1] += load4(frame->rb[1][c] + from) * at;
        shadow.half += load4(frame->rb_most[c] + from) * all4(b->half[0][c]);
    }
    return shadow;
}

static inline struct shadow shadow_of_a(const struct eng_sweep_frame *frame, int from,
                                        const struct moving_box *a)
{
    if (from == 0) {
        return (struct shadow){{a->centre[0], a->centre[1]}, a->half};
    }
    struct shadow shadow = {{all4(0), all4(0)}, all4(0)};
#pragma GCC unroll 3
    for (int c = 0; c < 3; c++) {
        f4 ra = load4(frame->ra[c]);
        shadow.centre[0] += ra * all4(a->centre[0][c]);
        shadow.centre[1] += ra * all4(a->centre[1][c]);
        shadow.half += load4(frame->ra_abs[c]) * all4(a->half[c]);
    }
    return shadow;
}

/* Return whether two boxes may come within keep of each other in a span. */
static bool may_meet(struct eng_sweep *sweep, struct eng_sweep_span span,
                     const struct item *a, const struct item *b)
{
    const struct eng_sweep_frame *frame = frame_of(sweep, span);
    struct moving_box box = box_in(sweep, frame, a);
    f4 margin = all4(margin_of(sweep, frame));
    unsigned apart = 0;
    sweep->box_tests++;
#pragma GCC unroll 2
    for (int from = 0; from < AXES && apart == 0; from += 4) {
        struct shadow of_a = shadow_of_a(frame, from, &box);
        struct shadow of_b = shadow_of_b(frame, from, b);
        apart = bits_of(are_apart(of_b.centre[0] - of_a.centre[0],
                                  of_b.centre[1] - of_a.centre[1],
                                  of_a.half + of_b.half + margin)) &
                7u;
    }
    return apart == 0;
}

/* Return which children of a node of side 0, whose boxes are given, may meet b. */
static unsigned may_meet_of_a(struct eng_sweep *sweep, struct eng_sweep_span span,
                              const struct eng_body_boxes *const boxes[2],
                              const struct item *b)
{
    const struct eng_sweep_frame *frame = frame_of(sweep, span);
    const struct eng_body_boxes *at[2] = {boxes[0], boxes[1]};
    struct eng_body_boxes between[2];
    f4 margin = all4(margin_of(sweep, frame));
    f4 half[3];
    eng_i4 apart = {0, 0, 0, 0};
    sweep->box_tests += 4;
    for (int end = 0; end < 2 && boxes[0] != boxes[1]; end++) {
        for (int k = 0; k < 3; k++) {
            f4 t = all4(frame->t[end]);
            between[end].centre[k] =
                boxes[0]->centre[k] + (boxes[1]->centre[k] - boxes[0]->centre[k]) * t;
            between[end].half[k] =
                boxes[0]->half[k] + (boxes[1]->half[k] - boxes[0]->half[k]) * t;
        }
        at[end] = &between[end];
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        half[k] = eng_max4(at[0]->half[k], at[1]->half[k]);
    }
#pragma GCC unroll 2
    for (int from = 0; from < AXES; from += 4) {
        struct shadow of_b = shadow_of_b(frame, from, b);
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            f4 c0 = at[0]->centre[k];
            f4 c1 = at[1]->centre[k];
            f4 h = half[k];
            if (from > 0) {
                f4 r[3] = {all4(frame->ra[0][k]), all4(frame->ra[1][k]),
                           all4(frame->ra[2][k])};
                c0 = r[0] * at[0]->centre[0] + r[1] * at[0]->centre[1] +
                     r[2] * at[0]->centre[2];
                c1 = c0;
                if (at[0] != at[1]) {
                    c1 = r[0] * at[1]->centre[0] + r[1] * at[1]->centre[1] +
                         r[2] * at[1]->centre[2];
                }
                h = abs4(r[0]) * half[0] + abs4(r[1]) * half[1] + abs4(r[2]) * half[2];
            }
            apart |= are_apart(all4(of_b.centre[0][k]) - c0, all4(of_b.centre[1][k]) - c1,
                               h + (all4(of_b.half[k]) + margin));
        }
        if (bits_of(apart) == 15u) {
            break;
        }
    }
    return ~bits_of(apart) & 15u;
}

/* Return which children of a node of side 1 may meet a. */
static unsigned may_meet_of_b(struct eng_sweep *sweep, struct eng_sweep_span span,
                              const struct item *a, const struct item *b,
                              const struct eng_body_boxes *boxes)
{
    const struct eng_sweep_frame *frame = frame_of(sweep, span);
    struct moving_box box = box_in(sweep, frame, a);
    f4 margin = all4(margin_of(sweep, frame));
    eng_i4 apart = {0, 0, 0, 0};
    sweep->box_tests += 4;
#pragma GCC unroll 2
    for (int from = 0; from < AXES; from += 4) {
        struct shadow of_a = shadow_of_a(frame, from, &box);
        of_a.half += bow_along(frame, from, b);
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            f4 c0 = all4(frame->off[0][from + k] - of_a.centre[0][k]);
            f4 c1 = all4(frame->off[1][from + k] - of_a.centre[1][k]);
            f4 h = all4(of_a.half[k]) + margin;
#pragma GCC unroll 3
            for (int c = 0; c < 3; c++) {
                c0 += all4(frame->rb[0][c][from + k]) * boxes->centre[c];
                c1 += all4(frame->rb[1][c][from + k]) * boxes->centre[c];
                h += all4(frame->rb_most[c][from + k]) * boxes->half[c];
            }
            apart |= are_apart(c0, c1, h);
        }
        if (bits_of(apart) == 15u) {
            break;
        }
    }
    return ~bits_of(apart) & 15u;
}

/* ---- which spans are left ---------------------------------------------------------- */

static void push(struct eng_sweep *sweep, struct eng_sweep_span span)
{
    int status = sweep->span_count == SPANS_MOST
                     ? PCCD_E_LIMIT
                     : eng_array_extend(&sweep->spans, &sweep->span_capacity,
                                        sweep->span_count + 1, sizeof *sweep->spans);
    if (status != PCCD_OK) {
        sweep->status = status;
        sweep->stops = true;
        return;
    }
    sweep->spans[sweep->span_count++] = span;
}

/* Return whether a span is to be divided for a box of that size of side 1. */
static bool is_long(struct eng_sweep *sweep, struct eng_sweep_span span,
                    const struct item *b, float bend_most, float motion_most)
{
    const struct eng_sweep_frame *frame = frame_of(sweep, span);
    float finest = (float)sweep->fineness;
    bend_most = most(bend_most, finest);
    return span.depth < DEPTH_MAX &&
           ((frame->bow_most > bend_most && bow_of(frame, b) > bend_most) ||
            way_of(frame, b) > most(motion_most, finest));
}

/* Push the parts of a span, in which the two may meet, that are short beside the two and
 * in which they still may, in the order of time; but for what begins after t_end. */
static void push_parts(struct eng_sweep *sweep, const struct item *a,
                       const struct item *b, struct eng_sweep_span span, double t_end)
{
    float size = most(most(a->size, b->size), sweep->margin);
    look(sweep, 1);
    if (begin_of(span) > t_end || sweep->stops) {
        return;
    }
    if (span.depth >= NODES_DEPTH_MAX ||
        !is_long(sweep, span, b, BEND_PART * size, MOTION_PART * size)) {
        push(sweep, span);
        return;
    }
    for (uint32_t i = 0; i < 2 && !sweep->stops; i++) {
        if (may_meet(sweep, half_of(span, i), a, b)) {
            push_parts(sweep, a, b, half_of(span, i), t_end);
        }
    }
}

/* ---- two leaves -------------------------------------------------------------------- */

/* Pairs of features of two leaves are bits, in groups of three, one for each corner i of
 * side 0, but for BACK. Group s < 3: edges i and (i + s) % 3, or the points that leaves
 * are; FORTH: vertex i and the face of side 1; BACK: the face of side 0 and vertex i of
 * side 1. */
enum { FORTH = 3, BACK = 4, GROUPS = 5 };

#define LEAF_PAIRS (3 * GROUPS)
#define EDGE_PAIRS 0x1ffu

struct leaves {
    const struct item *item[2];
    const struct eng_face *face[2];
    bool is_point[2]; /* and has no edges */
    float scale[2];   /* 1 / size */
    f4 a[2][3];       /* corners from the origins: at both ends of the step */
    f4 b[3];
    uint32_t found;
    double span[LEAF_PAIRS][2]; /* of those that are found */
};

static uint32_t owned_of(const struct eng_face *leaf, uint32_t points)
{
    return points == 1 ? leaf->owns & 7u : leaf->owns >> 3 & 7u;
}

static bool is_face(const struct eng_face *leaf)
{
    return (leaf->owns & ENG_OWNS_FACE) != 0;
}

static bool is_point(const struct eng_face *leaf)
{
    return !is_face(leaf) && leaf->v[0] == leaf->v[1];
}

/* Return the pairs of features that two leaves own. */
static uint32_t list_pairs(const struct eng_sweep *sweep, struct leaves *leaves)
{
    uint32_t owned[2];
    uint32_t pairs = 0;
    for (uint32_t side = 0; side < 2; side++) {
        const struct eng_face *leaf = leaves->face[side];
        const bool meets_face = is_face(leaves->face[1 - side]);
        leaves->is_point[side] = sweep->wants_free && is_point(leaf) && !meets_face;
        owned[side] = owned_of(leaf, leaves->is_point[side] ? 1 : 2);
        pairs |= meets_face ? owned_of(leaf, 1) << 3 * (FORTH + side) : 0;
    }
    for (uint32_t s = 0; s < 3; s++) {
        pairs |= (owned[0] & (owned[1] >> s | owned[1] << (3 - s))) << 3 * s;
    }
    return pairs;
}

/* Name the pair of a bit. */
static struct eng_sweep_pair pair_of(const struct leaves *leaves, uint32_t bit)
{
    const uint32_t group = bit / 3;
    const uint32_t corner = bit % 3;
    const bool *is_point = leaves->is_point;
    const uint32_t place[2] = {group == BACK ? 0 : corner,
                               group == FORTH ? 0 : (corner + group % BACK) % 3};
    struct eng_sweep_pair pair = {.kind = PCCD_VF, .side_a = group == BACK};
    if (group < FORTH) {
        pair.kind = is_point[0] && is_point[1]   ? PCCD_VV
                    : is_point[0] || is_point[1] ? PCCD_VE
                                                 : PCCD_EE;
        pair.side_a = is_point[1] && !is_point[0];
    }
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t side = i == 0 ? pair.side_a : 1 - pair.side_a;
        pair.leaf[i] = leaves->item[side]->child & ~ENG_BODY_LEAF;
        pair.place[i] = place[side];
        pair.span[i] = leaves->span[bit][i];
    }
    return pair;
}

static inline f4 corner_of(const struct eng_body *body, unsigned end, uint32_t vertex)
{
    return eng_body_place(body->x[end][vertex], body->origin);
}

static void load_leaves(const struct eng_sweep *sweep, struct leaves *leaves)
{
    for (uint32_t side = 0; side < 2; side++) {
        const struct eng_body *body = sweep->body[side];
        const uint32_t leaf = leaves->item[side]->child & ~ENG_BODY_LEAF;
        const bool stands = body->boxes[0] == body->boxes[1];
        leaves->face[side] = &body->mesh->leaves[leaf];
        leaves->scale[side] = 1 / leaves->item[side]->size;
        for (int i = 0; i < 3; i++) {
            uint32_t vertex = leaves->face[side]->v[i];
            f4 x = corner_of(body, 0, vertex);
            if (side == 1) {
                leaves->b[i] = x;
            } else {
                leaves->a[0][i] = x;
                leaves->a[1][i] = stands ? x : corner_of(body, 1, vertex);
            }
        }
    }
}

/* Corners in a span, at both ends of it. */
struct corners {
    f4 a[2][3];
    f4 b[2][3];
    f4 bow; /* of the middle of the box of side 1, and what is around it */
    f4 bow_around;
    float margin;
};

static void set_bow_of(const struct eng_sweep_frame *frame, const struct item *b,
                       struct corners *corners)
{
    corners->bow = load4(frame->bow_off);
    corners->bow_around = all4(0);
#pragma GCC unroll 3
    for (int c = 0; c < 3; c++) {
        corners->bow += load4(frame->bow[c]) * all4(b->centre[0][c]);
        corners->bow_around += abs4(load4(frame->bow[c])) * all4(b->half[0][c]);
    }
}

static void set_corners(const struct eng_sweep_frame *frame, const struct leaves *leaves,
                        struct corners *corners)
{
    set_bow_of(frame, leaves->item[1], corners);
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const f4 off = load4(frame->off[end]);
        const f4 x = load4(frame->rb[end][0]);
        const f4 y = load4(frame->rb[end][1]);
        const f4 z = load4(frame->rb[end][2]);
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            const f4 b = leaves->b[i];
            corners->a[end][i] = mix(leaves->a[0][i], leaves->a[1][i], frame->t[end]);
            corners->b[end][i] = off + x * all4(b[0]) + y * all4(b[1]) + z * all4(b[2]);
        }
    }
}

/* Return whether an axis of side 0 keeps two leaves apart. */
static bool are_leaves_apart(const struct corners *corners)
{
    f4 above = all4(INFINITY); /* how far b is above a, and below it */
    f4 below = all4(INFINITY);
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const f4 *a = corners->a[end];
        const f4 *b = corners->b[end];
        f4 low_a = eng_min4(eng_min4(a[0], a[1]), a[2]);
        f4 high_a = eng_max4(eng_max4(a[0], a[1]), a[2]);
        f4 low_b = eng_min4(eng_min4(b[0], b[1]), b[2]);
        f4 high_b = eng_max4(eng_max4(b[0], b[1]), b[2]);
        above = eng_min4(above, low_b - high_a);
        below = eng_min4(below, low_a - high_b);
    }
    f4 margin = (abs4(corners->bow) + corners->bow_around) * all4(1 + 0x1p-18f) +
                all4(corners->margin);
    return (bits_of(eng_max4(above, below) > margin) & 7u) != 0;
}

static inline struct vectors vectors_of(const f4 x[3])
{
    struct vectors v;
    eng_body_transpose(x[0], x[1], x[2], x[2], v.x);
    return v;
}

/* Move lanes, so that each has that of the next corner. */
static inline f4 next4(f4 x)
{
    return __builtin_shufflevector(x, x, 1, 2, 0, 1);
}

static inline struct vectors next_of(const struct vectors *v)
{
    return (struct vectors){{next4(v->x[0]), next4(v->x[1]), next4(v->x[2])}};
}

/* Two leaves in a span, at both ends of it, by corners. */
struct shapes {
    struct vectors a[2];
    struct vectors b[2];
    struct vectors edge[2]; /* of either side, of unit size, about: the mean of ends */
};

static void set_shapes(const struct leaves *leaves, const struct corners *corners,
                       struct shapes *shapes)
{
    for (int end = 0; end < 2; end++) {
        shapes->a[end] = vectors_of(corners->a[end]);
        shapes->b[end] = vectors_of(corners->b[end]);
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        f4 a = shapes->a[0].x[k] + shapes->a[1].x[k];
        f4 b = shapes->b[0].x[k] + shapes->b[1].x[k];
        shapes->edge[0].x[k] = (next4(a) - a) * all4(leaves->scale[0]);
        shapes->edge[1].x[k] = (next4(b) - b) * all4(leaves->scale[1]);
    }
}

/* Return how far apart corners of both have to be along an axis in each lane. */
static inline f4 margin_along(const struct corners *corners, const struct vectors *n)
{
    f4 bow = all4(0);
    f4 around = all4(0);
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        bow += n->x[k] * all4(corners->bow[k]);
        around += abs4(n->x[k]) * all4(corners->bow_around[k]);
    }
    return (abs4(bow) + around) * all4(1 + 0x1p-18f) + all4(corners->margin);
}

static inline f4 least_corner(f4 x)
{
    return eng_min4(eng_min4(x, next4(x)), next4(next4(x)));
}

static inline f4 most_corner(f4 x)
{
    return eng_max4(eng_max4(x, next4(x)), next4(next4(x)));
}

/* Return the pairs that are apart by more than the margin at both ends, on the same side,
 * along an axis on which corners of either lie there. */
static uint32_t apart_along(const f4 a[2], const f4 b[2], f4 margin)
{
    f4 above[GROUPS]; /* how far b is above a, and below it */
    f4 below[GROUPS];
    uint32_t apart = 0;
#pragma GCC unroll 5
    for (int i = 0; i < GROUPS; i++) {
        above[i] = below[i] = all4(INFINITY);
    }
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        f4 x = a[end];
        f4 y = b[end];
        f4 low = eng_min4(y, next4(y));
        f4 high = eng_max4(y, next4(y));
        above[FORTH] = eng_min4(above[FORTH], least_corner(y) - x);
        below[FORTH] = eng_min4(below[FORTH], x - most_corner(y));
        above[BACK] = eng_min4(above[BACK], y - most_corner(x));
        below[BACK] = eng_min4(below[BACK], least_corner(x) - y);
#pragma GCC unroll 3
        for (int s = 0; s < 3; s++) {
            above[s] = eng_min4(above[s], low - eng_max4(x, next4(x)));
            below[s] = eng_min4(below[s], eng_min4(x, next4(x)) - high);
            low = next4(low);
            high = next4(high);
        }
    }
#pragma GCC unroll 5
    for (int i = 0; i < GROUPS; i++) {
        apart |= (bits_of(eng_max4(above[i], below[i]) > margin) & 7u) << 3 * i;
    }
    return apart;
}

/* Return those of the pairs that are not apart along an axis, the same in all lanes. */
static inline uint32_t near_along(const struct corners *corners,
                                  const struct shapes *shapes, const struct vectors *n,
                                  uint32_t pairs)
{
    const f4 a[2] = {dot4(n, &shapes->a[0]), dot4(n, &shapes->a[1])};
    const f4 b[2] = {dot4(n, &shapes->b[0]), dot4(n, &shapes->b[1])};
    return pairs & ~apart_along(a, b, margin_along(corners, n));
}

static inline struct vectors all_of(const struct vectors *v, int i)
{
    return (struct vectors){{all4(v->x[0][i]), all4(v->x[1][i]), all4(v->x[2][i])}};
}

/* Return those of the pairs that are not apart across either leaf. */
static uint32_t near_across(const struct corners *corners, const struct shapes *shapes,
                            uint32_t pairs)
{
    for (int side = 0; side < 2 && pairs != 0; side++) {
        struct vectors next = next_of(&shapes->edge[side]);
        struct vectors n = across4(&shapes->edge[side], &next);
        n = all_of(&n, 0);
        pairs = near_along(corners, shapes, &n, pairs);
    }
    return pairs;
}

/* Return those of the pairs that are not apart beside an edge of either leaf: along what
 * is across the edge, in the plane of the leaf. */
static uint32_t near_beside(const struct corners *corners, const struct shapes *shapes,
                            uint32_t pairs)
{
    for (int side = 0; side < 2 && pairs != 0; side++) {
        struct vectors next = next_of(&shapes->edge[side]);
        struct vectors n = across4(&shapes->edge[side], &next);
        struct vectors aside = across4(&n, &shapes->edge[side]);
        for (int k = 0; k < 3 && pairs != 0; k++) {
            n = all_of(&aside, k);
            pairs = near_along(corners, shapes, &n, pairs);
        }
    }
    return pairs;
}

/* Return those of the pairs that are not apart along an axis of side 0. */
static uint32_t near_by_axes(const struct corners *corners, const struct shapes *shapes,
                             uint32_t pairs)
{
    for (int k = 0; k < 3 && pairs != 0; k++) {
        const f4 a[2] = {shapes->a[0].x[k], shapes->a[1].x[k]};
        const f4 b[2] = {shapes->b[0].x[k], shapes->b[1].x[k]};
        float bow = fabsf(corners->bow[k]) + corners->bow_around[k];
        pairs &= ~apart_along(a, b, all4(bow * (1 + 0x1p-18f) + corners->margin));
    }
    return pairs;
}

/* Return those of the pairs that are not apart along what is across two edges. */
static uint32_t near_across_edges(const struct corners *corners,
                                  const struct shapes *shapes, uint32_t pairs)
{
    struct vectors b[2] = {shapes->b[0], shapes->b[1]};
    struct vectors edge = shapes->edge[1];
    uint32_t apart = 0;
    for (int s = 0; s < 3 && (pairs & EDGE_PAIRS) != 0; s++) {
        const struct vectors n = across4(&shapes->edge[0], &edge);
        f4 above = all4(INFINITY);
        f4 below = all4(INFINITY);
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            const struct vectors a_next = next_of(&shapes->a[end]);
            const struct vectors b_next = next_of(&b[end]);
            f4 a0 = dot4(&n, &shapes->a[end]);
            f4 a1 = dot4(&n, &a_next);
            f4 b0 = dot4(&n, &b[end]);
            f4 b1 = dot4(&n, &b_next);
            above = eng_min4(above, eng_min4(b0, b1) - eng_max4(a0, a1));
            below = eng_min4(below, eng_min4(a0, a1) - eng_max4(b0, b1));
            b[end] = b_next;
        }
        edge = next_of(&edge);
        apart |= (bits_of(eng_max4(above, below) > margin_along(corners, &n)) & 7u)
                 << 3 * s;
    }
    return pairs & ~apart;
}

/* Return those of the pairs that may meet in a span, if `closely`; else rather more. */
static uint32_t near_in(struct eng_sweep *sweep, const struct leaves *leaves,
                        struct eng_sweep_span span, uint32_t pairs, bool closely)
{
    struct corners corners;
    struct shapes shapes;
    const struct eng_sweep_frame *frame = frame_of(sweep, span);
    corners.margin = margin_of(sweep, frame);
    set_corners(frame, leaves, &corners);
    if (are_leaves_apart(&corners)) {
        return 0;
    }
    set_shapes(leaves, &corners, &shapes);
    pairs = near_across(&corners, &shapes, pairs);
    if (closely) {
        pairs = is_face(leaves->face[0]) && is_face(leaves->face[1])
                    ? near_beside(&corners, &shapes, pairs)
                    : near_by_axes(&corners, &shapes, pairs);
        pairs = near_across_edges(&corners, &shapes, pairs);
    }
    return pairs;
}

/* Return those of the pairs that may meet in a span up to t_end: ask of shorter and
 * shorter first parts of it. Pairs that a later t_end leaves out an earlier one does,
 * too. */
static uint32_t near_early(struct eng_sweep *sweep, const struct leaves *leaves,
                           struct eng_sweep_span span, uint32_t pairs)
{
    while (pairs != 0 && span.depth < DEPTH_MAX &&
           sweep->t_end < begin_of(half_of(span, 1))) {
        span = half_of(span, 0);
        pairs = near_in(sweep, leaves, span, pairs, true);
    }
    return pairs;
}

/* Find which pairs of two leaves may meet in a span in which their boxes may. */
static void look_at_leaves(struct eng_sweep *sweep, struct leaves *leaves, uint32_t pairs,
                           struct eng_sweep_span span)
{
    const struct item *a = leaves->item[0];
    const struct item *b = leaves->item[1];
    if (begin_of(span) > sweep->t_end || sweep->stops) {
        return;
    }
    look(sweep, 4);
    sweep->leaf_tests++;
    float size = most(most(least(a->size, b->size), sweep->margin),
                      LARGER_PART * most(a->size, b->size));
    bool is_cut = is_long(sweep, span, b, LEAF_BEND_PART * size, LEAF_MOTION_PART * size);
    pairs = near_in(sweep, leaves, span, pairs, !is_cut);
    if (is_cut && pairs != 0) {
        look_at_leaves(sweep, leaves, pairs, half_of(span, 0));
        look_at_leaves(sweep, leaves, pairs, half_of(span, 1));
        return;
    }
    pairs = near_early(sweep, leaves, span, pairs);
    for (uint32_t left = pairs; left != 0; left &= left - 1) {
        double *found = leaves->span[__builtin_ctz(left)];
        found[0] = leaves->found & left & -left ? found[0] : begin_of(span);
        found[1] = begin_of(span) + length_of(span); /* they come in the order of time */
    }
    leaves->found |= pairs;
}

static void join_leaves(struct eng_sweep *sweep, const struct item *a,
                        const struct item *b, uint32_t first)
{
    struct leaves leaves;
    leaves.item[0] = a;
    leaves.item[1] = b;
    leaves.found = 0;
    load_leaves(sweep, &leaves);
    const uint32_t pairs = list_pairs(sweep, &leaves);
    for (uint32_t i = first; i < sweep->span_count && pairs != 0; i++) {
        look_at_leaves(sweep, &leaves, pairs, sweep->spans[i]);
    }
    for (uint32_t left = leaves.found; left != 0 && !sweep->stops; left &= left - 1) {
        const struct eng_sweep_pair pair =
            pair_of(&leaves, (uint32_t)__builtin_ctz(left));
        if (pair.span[0] <= sweep->t_end && !sweep->take(sweep->owner, &pair)) {
            sweep->stops = true;
        }
    }
}

/* ---- a leaf and four --------------------------------------------------------------- */

/* Corners of leaves from the origins, those of one leaf in each lane. */
struct four {
    struct vectors a[2][3]; /* at both ends of the step, or of a span */
    struct vectors b[2][3];
};

static struct leaf_corners corners_in(const struct eng_body *body, unsigned end)
{
    return (struct leaf_corners){body->x[end], body->origin, body->mesh->leaves};
}

static void place_four(const struct eng_sweep_frame *frame, bool stands,
                       const struct four *from, struct four *to)
{
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            f4 x = all4(frame->rb[end][0][k]);
            f4 y = all4(frame->rb[end][1][k]);
            f4 z = all4(frame->rb[end][2][k]);
            f4 off = all4(frame->off[end][k]);
#pragma GCC unroll 3
            for (int i = 0; i < 3; i++) {
                const struct vectors *b = &from->b[0][i];
                f4 a = from->a[0][i].x[k];
                to->a[end][i].x[k] =
                    stands ? a : mix(a, from->a[1][i].x[k], frame->t[end]);
                to->b[end][i].x[k] = off + x * b->x[0] + y * b->x[1] + z * b->x[2];
            }
        }
    }
}

/* Take from the children that may meet a leaf in spans the leaves that are apart from it
 * along the way between both, or across either; returns those that are left in any of
 * the spans. */
static unsigned near_leaves(struct eng_sweep *sweep, const struct item *a,
                            const struct item *b, uint32_t first, uint32_t end)
{
    const bool opens_a = !is_leaf(a);
    const struct eng_body *const *body = sweep->body;
    const bool stands = body[0]->boxes[0] == body[0]->boxes[1];
    const struct eng_body_tree *tree = eng_body_tree_of(body[opens_a ? 0 : 1]->mesh);
    const uint32_t *children = tree->children[opens_a ? a->child : b->child];
    struct four leaves;
    struct four placed;
    unsigned others = 0; /* that are no leaves */
    unsigned any = 0;
    for (unsigned i = 0; i < 4; i++) {
        others |= (children[i] & ENG_BODY_LEAF ? 0u : 1u) << i;
    }
    for (unsigned at = 0; at < (stands ? 1 : 2); at++) {
        const struct leaf_corners own = corners_in(body[0], at);
        if (opens_a) {
            load_four(&own, children, leaves.a[at]);
        } else {
            load_one(&own, a->child, leaves.a[at]);
        }
    }
    const struct leaf_corners own = corners_in(body[1], 0);
    if (opens_a) {
        load_one(&own, b->child, leaves.b[0]);
    } else {
        load_four(&own, children, leaves.b[0]);
    }
    for (uint32_t i = first; i < end; i++) {
        struct eng_sweep_span *span = &sweep->spans[i];
        unsigned near = span->children;
        if ((near & ~others) != 0) {
            const struct eng_sweep_frame *frame = frame_of(sweep, *span);
            struct corners corners;
            corners.margin = margin_of(sweep, frame);
            set_bow_of(frame, b, &corners);
            place_four(frame, stands, &leaves, &placed);
            struct vectors way = ways_between(placed.a, placed.b, all4(1 / a->size));
            near &= others | ~are_four_apart(placed.a, placed.b, &way,
                                             margin_along(&corners, &way));
            for (int side = 0; side < 2 && (near & ~others) != 0; side++) {
                float size = side == 0 ? a->size : b->size;
                struct vectors n =
                    normals_of(side == 0 ? placed.a : placed.b, all4(1 / size));
                near &= others | ~are_four_apart(placed.a, placed.b, &n,
                                                 margin_along(&corners, &n));
            }
        }
        span->children = (uint16_t)near;
        any |= near;
    }
    return any;
}

/* ---- two nodes --------------------------------------------------------------------- */

static void join(struct eng_sweep *sweep, const struct item *a, const struct item *b,
                 uint32_t first);

/* Go on with a child of either, in those of the spans in which it may meet. */
static void join_child(struct eng_sweep *sweep, const struct item *a,
                       const struct item *b, uint32_t first, uint32_t end, uint32_t which)
{
    for (uint32_t i = first; i < end; i++) {
        if (sweep->spans[i].children >> which & 1) {
            push_parts(sweep, a, b, sweep->spans[i], sweep->t_end);
        }
    }
    if (sweep->span_count > end && !sweep->stops) {
        join(sweep, a, b, end);
    }
    sweep->span_count = end;
}

/* Return which of some children, one at least, may meet first. */
static uint32_t soonest(const struct eng_sweep *sweep, uint32_t first, uint32_t end,
                        unsigned children)
{
    for (uint32_t i = first; i < end; i++) {
        unsigned those = sweep->spans[i].children & children;
        if (those != 0) {
            return (uint32_t)__builtin_ctz(those);
        }
    }
    return (uint32_t)__builtin_ctz(children);
}

/* Join what is below a and b in the spans from `first` to the end of the stack, which
 * are short beside the two. */
static void join(struct eng_sweep *sweep, const struct item *a, const struct item *b,
                 uint32_t first)
{
    uint32_t end = sweep->span_count;
    unsigned any = 0;
    if (is_leaf(a) && is_leaf(b)) {
        join_leaves(sweep, a, b, first);
        return;
    }
    bool opens_a = !is_leaf(a) && (is_leaf(b) || a->size >= b->size);
    const struct item *opened = opens_a ? a : b;
    const struct eng_body *body = sweep->body[opens_a ? 0 : 1];
    const struct eng_body_boxes *boxes[2] = {&body->boxes[0][opened->child],
                                             &body->boxes[1][opened->child]};
    for (uint32_t i = first; i < end && !sweep->stops; i++) {
        struct eng_sweep_span *span = &sweep->spans[i];
        span->children =
            (uint16_t)(opens_a ? may_meet_of_a(sweep, *span, boxes, b)
                               : may_meet_of_b(sweep, *span, a, b, boxes[0]));
        any |= span->children;
        look(sweep, 1);
    }
    if (any != 0 && is_leaf(opens_a ? b : a)) {
        any = near_leaves(sweep, a, b, first, end);
    }
    while (any != 0 && !sweep->stops) {
        uint32_t which = soonest(sweep, first, end, any);
        struct item child = child_of(sweep, opens_a ? 0 : 1, opened, which);
        join_child(sweep, opens_a ? &child : a, opens_a ? b : &child, first, end, which);
        any &= ~(1u << which);
    }
}

/* ---- all of it --------------------------------------------------------------------- */

static int init(struct eng_sweep *sweep)
{
    memset(sweep, 0, sizeof *sweep);
    sweep->frames = eng_alloc(1, sizeof *sweep->frames);
    return sweep->frames ? PCCD_OK : PCCD_E_NOMEM;
}

static void deinit(struct eng_sweep *sweep)
{
    eng_free(sweep->frames);
    eng_free(sweep->spans);
    memset(sweep, 0, sizeof *sweep);
}

static uint64_t bytes_of(const struct eng_sweep *sweep)
{
    return sizeof *sweep->frames +
           (uint64_t)sweep->span_capacity * sizeof *sweep->spans;
}

/* The sum of all that coordinates along an axis are made of, but for where side 1 is. */
static double reach_of(const struct eng_body *body)
{
    double reach = 0;
    for (int k = 0; k < 3; k++) {
        double far = eng_most(fabs(body->box.lo[k]), fabs(body->box.hi[k]));
        reach += 0.5 * (body->box.hi[k] - body->box.lo[k]) + 0x1p-30 * far;
    }
    return reach;
}

static void begin(struct eng_sweep *sweep)
{
    const struct eng_path_box *box = &sweep->body[1]->box;
    sweep->size = eng_most(eng_size(box->lo), eng_size(box->hi));
    const struct eng_path_pose *pose = eng_poses_at(sweep->poses, 0);
    double error = pose->error[0] + pose->error[1] * sweep->size;
    double reach = reach_of(sweep->body[0]) + reach_of(sweep->body[1]);
    sweep->margin = eng_round_up(sweep->keep + 2 * error);
    sweep->slack = eng_round_up(0x1p-18 * reach);
    for (uint32_t i = 0; i < FRAMES; i++) {
        sweep->frames->span[i].depth = UINT16_MAX;
    }
    if (sweep->span_capacity > SPANS_KEPT) {
        eng_free(sweep->spans);
        sweep->spans = NULL;
        sweep->span_capacity = 0;
    }
    sweep->root_count = 0;
    sweep->root_tests = 0;
    sweep->has_roots = false;
    sweep->looks_left = LOOKS;
}

/* Begin a run, or to divide one: nothing is left of those before. */
static void begin_run(struct eng_sweep *sweep)
{
    sweep->span_count = sweep->root_count;
    sweep->stops = false;
    sweep->status = PCCD_OK;
    sweep->box_tests = sweep->root_tests;
    sweep->leaf_tests = 0;
}

/* Push the parts of a span in which the two may meet. */
static void push_span(struct eng_sweep *sweep, const struct item *a, const struct item *b,
                      struct eng_sweep_span span, double t_end)
{
    look(sweep, 1);
    if (begin_of(span) <= t_end && !sweep->stops && may_meet(sweep, span, a, b)) {
        push_parts(sweep, a, b, span, t_end);
    }
}

/* Push the spans in which the roots may meet, up to t_last: all tasks of two bodies begin
 * with them, and each counts what they took, whichever task has found them. */
static void push_roots(struct eng_sweep *sweep)
{
    const struct eng_sweep_span whole = {0, 0, 0};
    const struct item a = root_of(sweep, 0);
    const struct item b = root_of(sweep, 1);
    push_span(sweep, &a, &b, whole, sweep->t_last);
    if (!sweep->stops) {
        sweep->root_count = sweep->span_count;
        sweep->root_tests = sweep->box_tests;
        sweep->has_roots = true;
    }
}

/* Push the spans in which the two may meet. */
static bool push_all(struct eng_sweep *sweep, const struct item *a, const struct item *b)
{
    if (!sweep->has_roots) {
        push_roots(sweep);
    }
    sweep->span_count = sweep->root_count;
    for (uint32_t i = 0; i < sweep->root_count; i++) {
        if (a->ref == 0 && b->ref == 0) {
            push(sweep, sweep->spans[i]);
        } else {
            push_span(sweep, a, b, sweep->spans[i], sweep->t_end);
        }
    }
    return sweep->span_count > sweep->root_count;
}

static uint64_t task_of(const struct item *a, const struct item *b)
{
    return (uint64_t)a->ref << 32 | b->ref;
}

/* Divide a task in at most four; returns how many of them may have pairs. */
static uint32_t divide(void *owner, uint64_t task, uint64_t parts[4])
{
    struct eng_sweep *sweep = owner;
    struct item a = item_of(sweep, 0, (uint32_t)(task >> 32));
    struct item b = item_of(sweep, 1, (uint32_t)task);
    uint32_t count = 0;
    if ((is_leaf(&a) && is_leaf(&b)) || sweep->stops) {
        parts[0] = task;
        return 1;
    }
    uint32_t side = !is_leaf(&a) && (is_leaf(&b) || a.size >= b.size) ? 0 : 1;
    for (uint32_t which = 0; which < 4; which++) {
        struct item child = child_of(sweep, side, side == 0 ? &a : &b, which);
        if (child.child != ENG_BODY_NONE &&
            push_all(sweep, side == 0 ? &child : &a, side == 0 ? &b : &child)) {
            parts[count++] = side == 0 ? task_of(&child, &b) : task_of(&a, &child);
        }
    }
    return count;
}

static uint32_t split(struct eng_sweep *sweep, uint32_t limit, uint64_t *tasks)
{
    begin_run(sweep);
    return eng_body_split(limit, tasks, divide, sweep);
}

static int run(struct eng_sweep *sweep, uint64_t task)
{
    struct item a = item_of(sweep, 0, (uint32_t)(task >> 32));
    struct item b = item_of(sweep, 1, (uint32_t)task);
    begin_run(sweep);
    if (push_all(sweep, &a, &b)) {
        join(sweep, &a, &b, sweep->root_count);
    }
    return sweep->status;
}

const struct eng_sweep_calls ENG_SWEEP(ENG_ISA) = {init,  deinit, bytes_of,
                                                   begin, split,  run};
