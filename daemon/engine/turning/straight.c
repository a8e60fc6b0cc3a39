/* straight.c - two trees against each other, both of which go straight, or nearly;
 * compiled once for every instruction set, as kernels are (kernel/local.mk). */
#include "straight.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "four_leaves.h"
#include "kinds.h"
#include "memory.h"
#include "narrow.h"
#include "vec.h"

/* The axes: three of side 0, then three of side 1, where those of its frame lie; then, if
 * the two go far beside their sizes, two that are across that way, and the way itself. */
#define AXES     9
#define AXES_OWN 6

/* Far, as a part of the size of the smaller body. */
#define FAR_PART 0.125

/* The range of vectors whose squares are well within that of doubles. */
#define LENGTH_LEAST 0x1p-200
#define LENGTH_MOST  0x1p200

/* The part of what coordinates are made of that floats round off. */
#define ROUNDING 0x1p-18

/* The part of ROUNDING that doubles round off: positions in the world are such. */
#define DOUBLES 0x1p-29

/* More than what is too small for floats adds up to. */
#define LEAST 0x1p-120

/* Nodes that are opened, some 50 ns each, before it is asked whether to stop. */
#define LOOKS 1024u

/* Corners of leaves whose pairs wait, and what two leaves add at most. */
#define POINTS      2048u
#define LEAF_POINTS 3u
#define LEAF_PAIRS  9u /* of one kind */

#define KINDS 2 /* PCCD_VF and PCCD_EE */

/* Nodes of a side of which is kept what is known of their children. */
#define OPENED    64u
#define NODE_NONE UINT32_MAX

/* A side of the pair. A point b of its frame, measured from the origin of its boxes, lies
 * at r[end] b + off[end] along an axis. What deforms has points of its own at each end,
 * in the frame of the world. */
struct view {
    const struct eng_object *object;
    uint32_t index; /* of the object */
    const struct eng_body *body;
    const struct eng_body_tree *tree;
    const struct eng_body_boxes *boxes[2];
    const struct eng_path_box *box; /* around all of these */
    const double *origin;
    const double *pose[2];
    const double (*x[2])[3]; /* positions at both ends .. */
    bool is_placed;          /* .. once the poses have taken them there */
    float r[2][AXES][3];
    float most[AXES][3]; /* the larger magnitude of both ends */
    float off[2][AXES];
    float m[2][3][4]; /* the same along the axes of the world, off last */
    struct leaf_corners own[2];
    bool deforms; /* boxes and own are not the same at both ends */
    bool turns;   /* r is not */
    bool rests;   /* nothing of it moves: own and m are the same */
};

/* Intervals of the children of a node along the axes: middles at both ends, and halves
 * that hold at all times. */
struct shadows {
    f4 middle[2][AXES];
    f4 half[AXES]; /* of side 1 with the margin */
    f4 size;       /* half of the longest side, about */
};

/* The children of a node as the two objects lie: kept, as a node is opened beside many
 * of the other side. */
struct opened {
    uint32_t node;     /* NODE_NONE: of none */
    uint32_t users;    /* that look at them now */
    unsigned children; /* bits: which there are .. */
    unsigned leaves;   /* .. and which are leaves */
    int known;         /* along so many axes there are shadows */
    bool is_placed;    /* leaves are: */
    struct shadows shadows;
    struct vectors x[2][3]; /* corners of leaves, at both ends */
    struct vectors normals; /* across these */
    uint32_t first[4];      /* the corners of a leaf are points first .. */
    uint64_t round[4];      /* .. of that round */
};

/* A node or a leaf of a side: child `which` of a node. */
struct item {
    struct opened *opened; /* that node */
    uint32_t which;
    uint32_t ref;   /* 0: the root; else its place + 1 among the children of all nodes */
    uint32_t child; /* body_tree.h */
};

/* A feature of a candidate. */
struct feature {
    uint32_t object; /* index */
    uint32_t leaf;   /* that owns it .. */
    uint32_t place;  /* .. and which vertex, or edge, of that it is */
};

struct chunk {
    uint32_t count;
    struct feature features[ENG_CHUNK_MAX][2];
    uint32_t quads[ENG_CHUNK_MAX][4];
};

struct eng_straight {
    struct eng_worker *worker;
    struct view side[2];
    int axes;     /* AXES_OWN or AXES */
    float margin; /* for the rounding of a gap, and of positions; and reach of chords */
    bool bends;   /* one of the two turns; then these are its chords */
    struct eng_straight_chords chords;
    uint32_t looks;
    bool stops;
    struct opened opened[2][OPENED]; /* of either side, by node */
    struct {
        uint32_t leaf; /* where that is at both ends, in all lanes */
        bool is_there;
        struct vectors x[2][3];
        struct vectors normal;
    } alone[2];
    uint64_t round; /* of points: one ends with each test of all that waits */
    uint32_t point_count;
    struct eng_point points[POINTS];
    struct chunk chunks[KINDS];
    uint32_t kept[ENG_CHUNK_MAX]; /* of a chunk */
    double reaches[ENG_CHUNK_MAX];
};

static int make(struct eng_straight **straight)
{
    struct eng_straight *made = eng_alloc(1, sizeof *made);
    if (!made) {
        return PCCD_E_NOMEM;
    }
    made->point_count = 0;
    made->stops = false;
    made->looks = 0;
    made->round = 1;
    made->chunks[PCCD_VF].count = made->chunks[PCCD_EE].count = 0;
    *straight = made;
    return PCCD_OK;
}

static void free_all(struct eng_straight *straight)
{
    eng_free(straight);
}

static uint64_t bytes_of(const struct eng_straight *straight)
{
    return straight ? sizeof *straight : 0;
}

/* ---- two objects ------------------------------------------------------------------- */

static const double stands[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

static void shorten(double x[3])
{
    double length = sqrt(eng_dot(x, x));
    for (int k = 0; k < 3; k++) {
        x[k] /= length;
    }
}

/* Where an axis of its frame lies half way; one of the world if it has no direction. */
static void set_axis(const struct view *view, int k, double axis[3])
{
    for (int i = 0; i < 3; i++) {
        axis[i] = 0.5 * view->pose[0][4 * i + k] + 0.5 * view->pose[1][4 * i + k];
    }
    double size = eng_size(axis);
    if (size > LENGTH_LEAST && size < LENGTH_MOST) {
        shorten(axis);
    } else {
        memset(axis, 0, 3 * sizeof *axis);
        axis[k] = 1;
    }
}

/* Set two axes across a way, which has a length, and one along it. */
static void set_along(const double way[3], double axes[3][3])
{
    int least = fabs(way[0]) < fabs(way[1]) ? 0 : 1;
    least = fabs(way[2]) < fabs(way[least]) ? 2 : least;
    const double other[3] = {least == 0, least == 1, least == 2};
    eng_cross(axes[0], way, other);
    shorten(axes[0]);
    eng_cross(axes[1], way, axes[0]);
    shorten(axes[1]);
    memcpy(axes[2], way, sizeof axes[2]);
    shorten(axes[2]);
}

static void place(const double m[12], const double x[3], double at[3])
{
    for (int i = 0; i < 3; i++) {
        at[i] = eng_dot(m + 4 * (size_t)i, x) + m[4 * i + 3];
    }
}

/* Set how it lies along the axes; `from`: what positions are measured from. */
static void set_view(struct view *view, const double axes[AXES][3],
                     const double from[2][3])
{
    view->turns = memcmp(view->pose[0], view->pose[1], 12 * sizeof(double)) != 0;
    for (int end = 0; end < 2; end++) {
        const double *m = view->pose[end];
        double at[3];
        place(m, view->origin, at);
        eng_sub(at, at, from[end]);
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < 3; c++) {
                view->m[end][k][c] = (float)m[4 * k + c];
            }
            view->m[end][k][3] = (float)at[k];
        }
        for (int k = 0; k < AXES; k++) {
            view->off[end][k] = (float)eng_dot(axes[k], at);
            for (int c = 0; c < 3 && (end == 0 || view->turns); c++) {
                view->r[end][k][c] = (float)(axes[k][0] * m[c] + axes[k][1] * m[4 + c] +
                                             axes[k][2] * m[8 + c]);
            }
        }
    }
    view->rests =
        !view->deforms && memcmp(view->m[0], view->m[1], sizeof view->m[0]) == 0;
    if (!view->turns) {
        memcpy(view->r[1], view->r[0], sizeof view->r[1]);
    }
    for (int k = 0; k < AXES; k++) {
        for (int c = 0; c < 3; c++) {
            float r0 = fabsf(view->r[0][k][c]);
            float r1 = fabsf(view->r[1][k][c]);
            view->most[k][c] = r0 > r1 ? r0 : r1;
        }
    }
}

/* Return the sum of all that coordinates of a side along an axis are made of, but for
 * where it is. */
static double reach_of(const struct view *view)
{
    const struct eng_path_box *box = view->box;
    double half = 0;
    double far = 0;
    double reach = 0;
    for (int k = 0; k < 3; k++) {
        half += 0.5 * (box->hi[k] - box->lo[k]);
        far += eng_most(fabs(box->lo[k]), fabs(box->hi[k]));
    }
    for (int end = 0; end < 2; end++) {
        const double *m = view->pose[end];
        double squares = 0;
        double shift = 0;
        for (int i = 0; i < 3; i++) {
            squares += eng_dot(m + 4 * (size_t)i, m + 4 * (size_t)i);
            shift += fabs(m[4 * i + 3]);
        }
        double size = sqrt(squares) + FLT_MIN; /* below that, floats have fewer bits */
        reach = eng_most(reach, size * (half + DOUBLES * far) + DOUBLES * shift);
    }
    return reach;
}

static void set_side(struct view *view, const struct eng_turning_side *side)
{
    view->object = side->object;
    view->body = side->body;
    view->tree = eng_body_tree_of(side->object->mesh);
    view->box = side->poses ? &view->tree->box : &side->body->box;
    view->origin = side->poses ? view->tree->origin : side->body->origin;
    for (int end = 0; end < 2; end++) {
        view->x[end] = side->body->x[end];
        view->boxes[end] = side->poses ? view->tree->boxes : side->body->boxes[end];
        view->pose[end] = side->poses ? side->poses[end] : stands;
        view->own[end] = (struct leaf_corners){
            side->poses ? (const double(*)[3])side->object->mesh->x : view->x[end],
            view->origin, side->object->mesh->leaves};
    }
    view->deforms = view->boxes[0] != view->boxes[1];
    view->is_placed = side->joint != PCCD_NO_JOINT;
}

static void begin(struct eng_straight *straight, const struct eng_turning_side side[2],
                  const struct eng_straight_chords *chords)
{
    double axes[AXES][3] = {{0}};
    double from[2][3];
    double to[2][3];
    double way[3] = {0, 0, 0};
    double apart = 0;
    double size = INFINITY;
    straight->bends = chords != NULL;
    if (chords) {
        straight->chords = *chords;
    }
    straight->stops = false;
    for (int i = 0; i < 2; i++) {
        struct view *view = &straight->side[i];
        set_side(view, &side[i]);
        straight->alone[i].is_there = false;
        for (uint32_t k = 0; k < OPENED; k++) {
            straight->opened[i][k].node = NODE_NONE;
            straight->opened[i][k].users = 0;
        }
        for (int k = 0; k < 3; k++) {
            set_axis(view, k, axes[3 * i + k]);
        }
        size = eng_least(size, eng_bounds_size(&view->object->bounds[0]));
    }
    for (int end = 0; end < 2; end++) {
        double far = 0;
        place(straight->side[0].pose[end], straight->side[0].origin, from[end]);
        place(straight->side[1].pose[end], straight->side[1].origin, to[end]);
        for (int k = 0; k < 3; k++) {
            far += fabs(to[end][k] - from[end][k]);
            way[k] += (to[end][k] - from[end][k]) * (end == 1 ? 1 : -1);
        }
        apart = eng_most(apart, far);
    }
    double length = eng_size(way);
    straight->axes = AXES_OWN;
    if (length > FAR_PART * size && length > LENGTH_LEAST && length < LENGTH_MOST) {
        straight->axes = AXES;
        set_along(way, axes + AXES_OWN);
    }
    set_view(&straight->side[0], (const double(*)[3])axes, (const double(*)[3])from);
    set_view(&straight->side[1], (const double(*)[3])axes, (const double(*)[3])from);
    double reach = reach_of(&straight->side[0]) + reach_of(&straight->side[1]) + apart;
    double least = chords ? chords->reach * (1 + ROUNDING) : 0;
    straight->margin = eng_round_up(ROUNDING * reach + LEAST + least);
}

/* ---- nodes ------------------------------------------------------------------------- */

static inline f4 turned(const float r[3], const f4 x[3])
{
    return all4(r[0]) * x[0] + all4(r[1]) * x[1] + all4(r[2]) * x[2];
}

/* Set the intervals of the children of a node along an axis; `boxes`: theirs at both
 * ends. */
static inline void set_shadow(const struct view *view,
                              const struct eng_body_boxes *const boxes[2], int k,
                              struct shadows *shadows)
{
    const bool differs = view->turns || view->deforms;
    f4 x = turned(view->r[0][k], boxes[0]->centre);
    shadows->middle[0][k] = x + all4(view->off[0][k]);
    x = differs ? turned(view->r[1][k], boxes[1]->centre) : x;
    shadows->middle[1][k] = x + all4(view->off[1][k]);
    x = turned(view->most[k], boxes[0]->half);
    shadows->half[k] =
        view->deforms ? eng_max4(x, turned(view->most[k], boxes[1]->half)) : x;
}

/* Have the shadows of the children along the first axes, a multiple of three. */
static void know(const struct eng_straight *straight, int side, struct opened *opened,
                 const struct eng_body_boxes *const boxes[2], int axes)
{
    struct shadows *shadows = &opened->shadows;
    for (; opened->known < axes; opened->known++) {
        set_shadow(&straight->side[side], boxes, opened->known, shadows);
        shadows->half[opened->known] += all4(side == 1 ? straight->margin : 0);
    }
    if (axes == straight->axes) {
        const f4 *own = shadows->half + 3 * side;
        shadows->size = eng_max4(eng_max4(own[0], own[1]), own[2]);
    }
}

/* Have what is known of a node: where it is kept, or, while another one is in use there,
 * in `own`. Who has it closes it. */
static struct opened *open_node(struct eng_straight *straight, int side, uint32_t node,
                                struct opened *own)
{
    struct opened *opened = &straight->opened[side][node % OPENED];
    if (opened->node != node) {
        const uint32_t *children = straight->side[side].tree->children[node];
        opened = opened->users == 0 ? opened : own;
        opened->node = node;
        opened->users = 0;
        opened->known = 0;
        opened->is_placed = false;
        memset(opened->round, 0, sizeof opened->round);
        eng_i4 each;
        memcpy(&each, children, sizeof each);
        opened->children = ~bits_of(each == -1) & 15u; /* ENG_BODY_NONE */
        opened->leaves = bits_of(each) & opened->children; /* ENG_BODY_LEAF */
    }
    opened->users++;
    return opened;
}

static void close_node(struct opened *opened)
{
    opened->users--;
}

/* As know(), of a node that is opened. */
static void know_node(const struct eng_straight *straight, int side,
                      struct opened *opened, int axes)
{
    const struct view *view = &straight->side[side];
    const struct eng_body_boxes *boxes[2] = {view->boxes[0] + opened->node,
                                             view->boxes[1] + opened->node};
    struct eng_body_boxes made[2];
    const bool lacks =
        view->deforms && view->body->lacks_lowest && opened->leaves == opened->children;
    for (int end = 0; end < 2 && lacks; end++) {
        eng_body_bound_lowest(view->body, end, opened->node, &made[end]);
        boxes[end] = &made[end];
    }
    know(straight, side, opened, boxes, lacks ? straight->axes : axes);
}

/* Return which children of a node of a side may meet an item of the other one; of these
 * all shadows are known. */
static unsigned may_meet(struct eng_straight *straight, int side, struct opened *opened,
                         const struct item *other)
{
    const float bound = straight->worker->box_bound;
    const struct shadows *of = &other->opened->shadows;
    const struct shadows *shadows = &opened->shadows;
    eng_i4 apart = {0, 0, 0, 0};
    straight->worker->record.box_tests += 4;
    for (int first = 0; first < straight->axes; first += 3) {
        if (opened->known == first) {
            know_node(straight, side, opened, first + 3);
        }
#pragma GCC unroll 3
        for (int k = first; k < first + 3; k++) {
            f4 d0 = all4(of->middle[0][k][other->which]) - shadows->middle[0][k];
            f4 d1 = all4(of->middle[1][k][other->which]) - shadows->middle[1][k];
            if (bound < 1) {
                d1 = d0 + (d1 - d0) * all4(bound);
            }
            f4 reach = shadows->half[k] + all4(of->half[k][other->which]);
            apart |= eng_max4(eng_min4(d0, d1), -eng_max4(d0, d1)) > reach;
        }
        if (bits_of(apart) == 15u) {
            return 0;
        }
    }
    return ~bits_of(apart) & opened->children;
}

/* Return child `which` of a node, whose shadows are known. */
static struct item child_of(const struct view *view, struct opened *opened,
                            uint32_t which)
{
    return (struct item){.opened = opened,
                         .which = which,
                         .ref = 4 * opened->node + which + 1,
                         .child = view->tree->children[opened->node][which]};
}

/* Return the item that a task names; who has it closes its node. `own`: as for that. */
static struct item item_of(struct eng_straight *straight, int side, uint32_t ref,
                           struct opened *own)
{
    const struct view *view = &straight->side[side];
    if (ref > 0) {
        struct opened *opened = open_node(straight, side, (ref - 1) / 4, own);
        know_node(straight, side, opened, straight->axes);
        return child_of(view, opened, (ref - 1) % 4);
    }
    struct eng_body_boxes root = {{{0}}, {{0}}};
    for (int k = 0; k < 3; k++) {
        double half = eng_most(view->box->hi[k] - view->origin[k],
                               view->origin[k] - view->box->lo[k]);
        root.half[k][0] = eng_round_up(half * (1 + 0x1p-20) + LEAST);
    }
    own->node = NODE_NONE;
    own->users = 1;
    own->known = 0;
    know(straight, side, own, (const struct eng_body_boxes *const[2]){&root, &root},
         straight->axes);
    return (struct item){.opened = own};
}

static bool is_leaf(const struct item *item)
{
    return (item->child & ENG_BODY_LEAF) != 0;
}

/* ---- a leaf and the leaves of a node ----------------------------------------------- */

/* Place corners of four leaves where they are at an end. */
static void place_four(const struct view *view, int end, const struct vectors from[3],
                       struct vectors to[3])
{
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        const f4 x = all4(view->m[end][k][0]);
        const f4 y = all4(view->m[end][k][1]);
        const f4 z = all4(view->m[end][k][2]);
        const f4 off = all4(view->m[end][k][3]);
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++) {
            const f4 *b = from[i].x;
            to[i].x[k] = off + x * b[0] + y * b[1] + z * b[2];
        }
    }
}

/* Have the leaves of a node of a side placed. */
static void place_leaves(const struct view *view, struct opened *opened)
{
    const uint32_t *children = view->tree->children[opened->node];
    if (opened->is_placed) {
        return;
    }
    struct vectors own[3];
    load_four(&view->own[0], children, own);
    place_four(view, 0, own, opened->x[0]);
    if (view->rests) {
        memcpy(opened->x[1], opened->x[0], sizeof opened->x[1]);
    } else {
        if (view->deforms) {
            load_four(&view->own[1], children, own);
        }
        place_four(view, 1, own, opened->x[1]);
    }
    opened->normals =
        normals_of((const struct vectors(*)[3])opened->x, all4(1) / opened->shadows.size);
    opened->is_placed = true;
}

/* Set all four vectors to one of four. */
static void spread(const struct vectors *v, uint32_t which, struct vectors *to)
{
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        float x;
        memcpy(&x, (const char *)&v->x[k] + which * sizeof x, sizeof x);
        to->x[k] = all4(x);
    }
}

/* Have a leaf of a side placed, in all lanes of `alone`. */
static void place_alone(struct eng_straight *straight, int side, const struct item *leaf)
{
    if (!straight->alone[side].is_there || straight->alone[side].leaf != leaf->child) {
        place_leaves(&straight->side[side], leaf->opened);
        for (int i = 0; i < 6; i++) {
            spread(&leaf->opened->x[i / 3][i % 3], leaf->which,
                   &straight->alone[side].x[i / 3][i % 3]);
        }
        spread(&leaf->opened->normals, leaf->which, &straight->alone[side].normal);
        straight->alone[side].is_there = true;
        straight->alone[side].leaf = leaf->child;
    }
}

/* Take from the children of a node of a side that may meet a leaf of the other one the
 * leaves that are apart from it along the way between both, or across either. */
static unsigned near_leaves(struct eng_straight *straight, int side,
                            struct opened *opened, unsigned meet,
                            const struct item *leaf)
{
    const unsigned leaves = opened->leaves;
    const f4 margin = all4(straight->margin);
    if ((meet & leaves) == 0) {
        return meet;
    }
    place_leaves(&straight->side[side], opened);
    place_alone(straight, 1 - side, leaf);
    const struct vectors(*placed)[3] = (const struct vectors(*)[3])opened->x;
    const struct vectors(*alone)[3] =
        (const struct vectors(*)[3])straight->alone[1 - side].x;
    struct vectors n = ways_between(placed, alone, all4(1) / opened->shadows.size);
    meet &= ~(leaves & are_four_apart(placed, alone, &n, margin));
    if ((meet & leaves) != 0) {
        meet &= ~(leaves & are_four_apart(placed, alone, &opened->normals, margin));
    }
    if ((meet & leaves) != 0) {
        n = straight->alone[1 - side].normal;
        meet &= ~(leaves & are_four_apart(placed, alone, &n, margin));
    }
    return meet;
}

/* Return the side of two items, not both of them leaves, that is opened: the larger. */
static int opened_of(const struct item *a, const struct item *b)
{
    return !is_leaf(a) && (is_leaf(b) || a->opened->shadows.size[a->which] >=
                                             b->opened->shadows.size[b->which])
               ? 0
               : 1;
}

/* ---- candidates -------------------------------------------------------------------- */

static uint32_t number_of(const struct eng_mesh *mesh, const struct feature *feature,
                          uint32_t points)
{
    const uint32_t *v = mesh->leaves[feature->leaf].v;
    const uint32_t first = v[feature->place];
    const uint32_t second = v[(feature->place + 1) % 3];
    return points == 1      ? first
           : points == 3    ? feature->leaf
           : first < second ? eng_mesh_edge(mesh, first, second)
                            : eng_mesh_edge(mesh, second, first);
}

static void name_pairs(const struct eng_worker *worker, enum pccd_kind kind,
                       const uint32_t *index, uint32_t count, struct pccd_pair *names)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct feature *features =
            worker->straight->chunks[kind].features[index[i]];
        uint32_t id[2];
        uint32_t number[2];
        for (int side = 0; side < 2; side++) {
            const struct eng_object *object =
                &worker->scene->objects[features[side].object];
            id[side] = object->id;
            number[side] =
                number_of(object->mesh, &features[side], common_kinds[kind].points[side]);
        }
        names[i] = (struct pccd_pair){kind, id[0], number[0], id[1], number[1]};
    }
}

/* Have those pairs of a chunk taken, one by one, whose chords come near. */
static void take_near(struct eng_straight *straight, enum pccd_kind kind)
{
    const struct chunk *chunk = &straight->chunks[kind];
    const struct eng_straight_chords *chords = &straight->chords;
    const struct eng_quads quads = {kind, straight->points,
                                    (const uint32_t(*)[4])chunk->quads};
    for (uint32_t i = 0; i < chunk->count; i++) {
        straight->reaches[i] = chords->reach;
    }
    const uint32_t count = straight->worker->kernels->reject_thick(
        quads, chunk->count, straight->reaches, straight->kept);
    for (uint32_t i = 0; i < count && !straight->stops; i++) {
        const struct feature *features = chunk->features[straight->kept[i]];
        const struct eng_sweep_pair pair = {
            .kind = kind,
            .side_a = features[0].object == straight->side[0].index ? 0 : 1,
            .leaf = {features[0].leaf, features[1].leaf},
            .place = {features[0].place, features[1].place}};
        straight->stops = !chords->take(chords->owner, &pair);
    }
}

static void test(struct eng_straight *straight, enum pccd_kind kind)
{
    struct eng_worker *worker = straight->worker;
    struct chunk *chunk = &straight->chunks[kind];
    struct eng_pairs pairs = {.kind = kind,
                              .known = ENG_KNOWN_NOTHING,
                              .count = chunk->count,
                              .points = straight->points,
                              .quads = (const uint32_t(*)[4])chunk->quads};
    if (chunk->count > 0 && !eng_stop_is_set(worker->stop)) {
        uint64_t begin_ns = common_now_ns();
        if (straight->bends) {
            take_near(straight, kind);
        } else {
            eng_count_candidates(worker, kind, chunk->count);
            eng_narrow_test(worker, &pairs, name_pairs);
        }
        eng_count_test_time(worker, kind, chunk->count, begin_ns);
    }
    chunk->count = 0;
}

/* Test all that waits. */
static void flush(struct eng_straight *straight)
{
    test(straight, PCCD_VF);
    test(straight, PCCD_EE);
    straight->point_count = 0;
    straight->round++;
    straight->stops |= eng_worker_should_stop(straight->worker);
}

/* Have the corners of a leaf among the points; returns where. */
static uint32_t corners_of(struct eng_straight *straight, int side,
                           const struct item *leaf)
{
    const struct view *view = &straight->side[side];
    struct opened *opened = leaf->opened;
    if (opened->round[leaf->which] == straight->round) {
        return opened->first[leaf->which];
    }
    const uint32_t *v = view->object->mesh->leaves[leaf->child & ~ENG_BODY_LEAF].v;
    uint32_t first = straight->point_count;
    for (uint32_t i = 0; i < LEAF_POINTS; i++) {
        struct eng_point *point = &straight->points[first + i];
        uint32_t vertex = view->object->vertices.first + v[i];
        memcpy(point->x0, view->x[0][v[i]], sizeof point->x0);
        memcpy(point->x1, view->x[1][v[i]], sizeof point->x1);
        if (view->is_placed) {
            place(view->pose[0], view->x[0][v[i]], point->x0);
            place(view->pose[1], view->x[1][v[i]], point->x1);
        }
        point->word0 = (uint64_t)view->index << 32 | vertex;
        point->word1 = (uint64_t)view->object->id << 32 | v[i];
    }
    straight->point_count += LEAF_POINTS;
    opened->round[leaf->which] = straight->round;
    opened->first[leaf->which] = first;
    return first;
}

/* A leaf of a side, and its corners among the points. */
struct leaf {
    const struct eng_face *face;
    uint32_t number;
    uint32_t object;
    uint32_t first;
};

static void add_vf(struct chunk *chunk, const struct leaf *a, const struct leaf *b)
{
    uint32_t owned = b->face->owns & ENG_OWNS_FACE ? a->face->owns & 7u : 0;
    for (; owned != 0; owned &= owned - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(owned);
        uint32_t *quad = chunk->quads[chunk->count];
        struct feature *features = chunk->features[chunk->count++];
        features[0] = (struct feature){a->object, a->number, i};
        features[1] = (struct feature){b->object, b->number, 0};
        quad[0] = a->first + i;
        for (uint32_t k = 0; k < 3; k++) {
            quad[1 + k] = b->first + k;
        }
    }
}

/* Write an edge of a leaf, its lower end first. */
static void put_edge(const struct leaf *leaf, uint32_t i, struct feature *feature,
                     uint32_t quad[2])
{
    uint32_t k = (i + 1) % 3;
    bool is_turned = leaf->face->v[i] > leaf->face->v[k];
    *feature = (struct feature){leaf->object, leaf->number, i};
    quad[0] = leaf->first + (is_turned ? k : i);
    quad[1] = leaf->first + (is_turned ? i : k);
}

/* `a` is of the object with the lower id. */
static void add_ee(struct chunk *chunk, const struct leaf *a, const struct leaf *b)
{
    for (uint32_t of_a = a->face->owns >> 3 & 7u; of_a != 0; of_a &= of_a - 1) {
        for (uint32_t of_b = b->face->owns >> 3 & 7u; of_b != 0; of_b &= of_b - 1) {
            uint32_t *quad = chunk->quads[chunk->count];
            struct feature *features = chunk->features[chunk->count++];
            put_edge(a, (uint32_t)__builtin_ctz(of_a), &features[0], quad);
            put_edge(b, (uint32_t)__builtin_ctz(of_b), &features[1], quad + 2);
        }
    }
}

static bool has_room(const struct eng_straight *straight)
{
    return straight->point_count + 2 * LEAF_POINTS <= POINTS &&
           straight->chunks[PCCD_VF].count + LEAF_PAIRS <= ENG_CHUNK_MAX &&
           straight->chunks[PCCD_EE].count + LEAF_PAIRS <= ENG_CHUNK_MAX;
}

static void join_leaves(struct eng_straight *straight, const struct item *a,
                        const struct item *b)
{
    const struct item *const items[2] = {a, b};
    struct leaf leaf[2];
    straight->worker->tally.leaf_pairs++;
    if (!has_room(straight)) {
        flush(straight);
    }
    for (int i = 0; i < 2; i++) {
        const struct view *view = &straight->side[i];
        leaf[i].number = items[i]->child & ~ENG_BODY_LEAF;
        leaf[i].object = view->index;
        leaf[i].face = &view->object->mesh->leaves[leaf[i].number];
        leaf[i].first = corners_of(straight, i, items[i]);
    }
    bool in_order = straight->side[0].object->id < straight->side[1].object->id;
    add_vf(&straight->chunks[PCCD_VF], &leaf[0], &leaf[1]);
    add_vf(&straight->chunks[PCCD_VF], &leaf[1], &leaf[0]);
    add_ee(&straight->chunks[PCCD_EE], &leaf[in_order ? 0 : 1], &leaf[in_order ? 1 : 0]);
}

/* ---- two nodes --------------------------------------------------------------------- */

/* Join what is below two items, whose boxes may meet. */
static void join(struct eng_straight *straight, const struct item *a,
                 const struct item *b)
{
    struct opened own;
    if (is_leaf(a) && is_leaf(b)) {
        join_leaves(straight, a, b);
        return;
    }
    if (++straight->looks >= LOOKS) {
        straight->looks = 0;
        straight->stops |= eng_worker_should_stop(straight->worker);
    }
    int side = opened_of(a, b);
    const struct item *other = side == 0 ? b : a;
    struct opened *opened =
        open_node(straight, side, side == 0 ? a->child : b->child, &own);
    unsigned meet = may_meet(straight, side, opened, other);
    if (straight->bends && meet != 0 && is_leaf(other)) {
        meet = near_leaves(straight, side, opened, meet, other);
    }
    for (; meet != 0 && !straight->stops; meet &= meet - 1) {
        struct item child =
            child_of(&straight->side[side], opened, (uint32_t)__builtin_ctz(meet));
        join(straight, side == 0 ? &child : a, side == 0 ? b : &child);
    }
    close_node(opened);
}

/* ---- tasks ------------------------------------------------------------------------- */

/* Divide a task in at most four; returns how many of them may have pairs. */
static uint32_t divide(void *owner, uint64_t task, uint64_t parts[4])
{
    struct eng_straight *straight = owner;
    struct opened own[3];
    struct item a = item_of(straight, 0, (uint32_t)(task >> 32), &own[0]);
    struct item b = item_of(straight, 1, (uint32_t)task, &own[1]);
    uint32_t count = 0;
    if (is_leaf(&a) && is_leaf(&b)) {
        parts[count++] = task;
    } else {
        int side = opened_of(&a, &b);
        uint32_t node = side == 0 ? a.child : b.child;
        struct opened *opened = open_node(straight, side, node, &own[2]);
        unsigned meet = may_meet(straight, side, opened, side == 0 ? &b : &a);
        for (; meet != 0; meet &= meet - 1) {
            uint64_t ref = 4 * (uint64_t)node + (uint32_t)__builtin_ctz(meet) + 1;
            parts[count++] = side == 0 ? ref << 32 | b.ref : (uint64_t)a.ref << 32 | ref;
        }
        close_node(opened);
    }
    close_node(a.opened);
    close_node(b.opened);
    return count;
}

static void set_worker(struct eng_straight *straight, struct eng_worker *worker)
{
    straight->worker = worker;
    for (int i = 0; i < 2; i++) {
        struct view *view = &straight->side[i];
        view->index = (uint32_t)(view->object - worker->scene->objects);
    }
}

static uint32_t split(struct eng_straight *straight, struct eng_worker *worker,
                      uint32_t most, uint64_t *tasks)
{
    set_worker(straight, worker);
    return eng_body_split(most, tasks, divide, straight);
}

static void perform(struct eng_straight *straight, struct eng_worker *worker,
                    uint64_t task)
{
    struct opened own[2];
    set_worker(straight, worker);
    struct item a = item_of(straight, 0, (uint32_t)(task >> 32), &own[0]);
    struct item b = item_of(straight, 1, (uint32_t)task, &own[1]);
    join(straight, &a, &b);
    close_node(a.opened);
    close_node(b.opened);
    if (straight->bends) {
        flush(straight);
    }
}

static void end(struct eng_straight *straight, struct eng_worker *worker)
{
    straight->worker = worker;
    flush(straight);
}

const struct eng_straight_calls ENG_STRAIGHT(ENG_ISA) = {make,  free_all, bytes_of, begin,
                                                         split, perform,  end};
