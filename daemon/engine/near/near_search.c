/* near_search.c - finds what is nearest in the trees of a method. */
#include "near_search.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "aabb.h"
#include "kernel.h"
#include "memory.h"
#include "winding.h"

/* The slack of a square of a distance of boxes, and of what it is compared with: more
 * than what their rounding takes and adds (BOUNDS.md). */
#define SQUARE_SLACK 0x1p-19
#define SQUARE_TINY  0x1p-120f

/* No box is as far from the origin of its frame, which lies among the objects. */
#define FAR       0x1p62f
#define SHIFT_MAX 0x1p100

/* Openings and looks between two looks at the clock: 20 us, as a rule; no look takes
 * more than half a millisecond. */
#define STEPS_PER_LOOK 64u

int eng_near_search_new(struct eng_near_search **out)
{
    struct eng_near_search *search = eng_alloc(1, sizeof *search);
    if (!search) {
        return PCCD_E_NOMEM;
    }
    memset(search, 0, offsetof(struct eng_near_search, items));
    if (eng_distances_init(&search->distances) != PCCD_OK) {
        eng_free(search);
        return PCCD_E_NOMEM;
    }
    if (eng_distance_order_init(&search->order) != PCCD_OK) {
        eng_distances_deinit(&search->distances);
        eng_free(search);
        return PCCD_E_NOMEM;
    }
    *out = search;
    return PCCD_OK;
}

void eng_near_search_free(struct eng_near_search *search)
{
    if (search) {
        eng_distance_order_deinit(&search->order);
        eng_distances_deinit(&search->distances);
        eng_free(search);
    }
}

void eng_near_search_at(struct eng_near_search *search,
                        const struct eng_method_calls *method, struct eng_worker *worker,
                        uint32_t end)
{
    const struct eng_scene *scene = worker->scene;
    assert(end <= 1);
    search->method = method;
    search->worker = worker;
    search->scene = scene;
    search->end = end;
    search->box_tests = 0;
    search->is_stopped = false;
    search->steps = 0;
    search->best.scene = scene;
    search->best.x = (const double(*)[3])scene->x[end == 1 ? scene->now : 1 - scene->now];
    search->best.distances = &search->distances;
    search->best.order = &search->order;
    search->best.looked = 0;
}

static bool is_stopped(struct eng_near_search *search)
{
    if (++search->steps >= STEPS_PER_LOOK) {
        search->steps = 0;
        search->is_stopped |= eng_worker_should_stop(search->worker);
    }
    return search->is_stopped;
}

/* Set the limit anew: what best found may leave more out. */
static void set_limit(struct eng_near_search *search)
{
    double reach = eng_near_best_reach(&search->best);
    if (reach == search->reach) {
        return;
    }
    double framed = reach * search->scale;
    double limit = framed * framed * (1 + SQUARE_SLACK) + SQUARE_TINY;
    search->reach = reach;
    search->limit = reach < 0 ? 0 : limit < (double)FLT_MAX ? (float)limit : INFINITY;
}

/* ---- frames ------------------------------------------------------------------------ */

static double origin_of(const struct eng_scene *scene, uint32_t object, uint32_t end,
                        int axis)
{
    return scene->framing.number == 0
               ? 0
               : scene->objects[object].frame.origin[4 * end + (uint32_t)axis];
}

/* Boxes of objects of different groups are nearer, as they are measured, than the objects
 * are, or hardly farther: they are put where they belong. */
static void set_frames(struct eng_near_search *search, uint32_t a, uint32_t b)
{
    const struct eng_scene *scene = search->scene;
    search->scale = scene->framing.number == 0 ? 1 : scene->framing.scale;
    search->has_shift = false;
    for (int k = 0; k < 3; k++) {
        double shift =
            (origin_of(scene, a, search->end, k) - origin_of(scene, b, search->end, k)) *
            search->scale;
        search->shift[k] = fmin(fmax(shift, -SHIFT_MAX), SHIFT_MAX);
        search->has_shift |= shift != 0;
    }
}

/* An outward distance moved by `shift`, rounded outward; no farther away than boxes may
 * be, where that makes the box larger. */
static float moved(float outward, double shift)
{
    double sum = (double)outward + shift;
    double error = 0x1p-50 * (fabs((double)outward) + fabs(shift));
    float out = nextafterf((float)fmin(sum + error, 0x1p100), INFINITY);
    return out < -FAR ? -FAR : out;
}

/* The box of a child, of the first object. */
static void box_of(const struct eng_near_search *search,
                   const struct eng_leaves_below *below, uint32_t child, float box[2][4])
{
    for (int k = 0; k < 3; k++) {
        box[0][k] = below->low[k][child];
        box[1][k] = below->high[k][child];
        if (search->has_shift && box[0][k] > ENG_NOWHERE) {
            box[0][k] = moved(box[0][k], -search->shift[k]);
            box[1][k] = moved(box[1][k], search->shift[k]);
        }
    }
}

/* ---- two objects ------------------------------------------------------------------- */

static void look(struct eng_near_search *search, const struct eng_near_pair *pair)
{
    eng_near_best_look(&search->best, pair);
}

/* The leaf of one side that a node of its tree is. */
static struct eng_face leaf_of(const struct eng_near_search *search, int side,
                               uint32_t node)
{
    const struct eng_leaves *leaves = &search->leaves[side];
    const struct eng_mesh *mesh = search->scene->objects[leaves->object].mesh;
    uint32_t index = search->method->leaves_index(leaves, node);
    if (leaves->tree == PCCD_TREE_FACES) {
        return mesh->leaves[index];
    }
    if (leaves->tree == PCCD_TREE_EDGES) {
        const uint32_t *ends = mesh->edges[index];
        return (struct eng_face){{ends[0], ends[1], ends[1]},
                                 ENG_OWNS_VERTEX(0) | ENG_OWNS_VERTEX(1) |
                                     ENG_OWNS_EDGE(0)};
    }
    return (struct eng_face){{index, index, index}, ENG_OWNS_VERTEX(0)};
}

/* Return whether the boxes of what waits meet, but for what their rounding adds. */
static bool may_cross(const struct eng_near_item *item)
{
    return item->square < SQUARE_TINY;
}

/* The edges that a leaf of one side owns, and a face of the other. */
static void look_at_passages(struct eng_near_search *search, int side,
                             const struct eng_face *own, uint32_t face)
{
    for (uint32_t k = 0; k < 3; k++) {
        if ((own->owns & ENG_OWNS_EDGE(k)) != 0) {
            const uint32_t edge[2] = {own->v[k], own->v[(k + 1) % 3]};
            struct eng_near_pair pair =
                eng_near_ef(search->scene, search->leaves[side].object, edge,
                            search->leaves[1 - side].object, face);
            look(search, &pair);
        }
    }
}

/* The vertices that a leaf of one side owns, and a face of the other; or a free point of
 * one side, and what is free of the other. */
static void look_at_vertices(struct eng_near_search *search, int side,
                             const struct eng_face *own, const struct eng_face *other,
                             uint32_t face)
{
    const struct eng_scene *scene = search->scene;
    uint32_t a = search->leaves[side].object;
    uint32_t b = search->leaves[1 - side].object;
    enum pccd_tree tree = search->leaves[1 - side].tree;
    bool is_point = search->leaves[side].tree == PCCD_TREE_VERTICES;
    for (uint32_t k = 0; k < 3; k++) {
        if ((own->owns & ENG_OWNS_VERTEX(k)) == 0 ||
            (tree != PCCD_TREE_FACES && !is_point)) {
            continue;
        }
        struct eng_near_pair pair =
            tree == PCCD_TREE_FACES   ? eng_near_vf(scene, a, own->v[k], b, face)
            : tree == PCCD_TREE_EDGES ? eng_near_ve(scene, a, own->v[k], b, other->v)
                                      : eng_near_vv(scene, a, own->v[k], b, other->v[0]);
        look(search, &pair);
    }
}

/* The features that two leaves own against each other, as in a step, and what passes
 * through what. */
static void look_at_leaves(struct eng_near_search *search,
                           const struct eng_near_item *item)
{
    struct eng_face leaf[2];
    uint32_t index[2];
    for (int side = 0; side < 2; side++) {
        leaf[side] = leaf_of(search, side, item->node[side]);
        index[side] =
            search->method->leaves_index(&search->leaves[side], item->node[side]);
    }
    for (int side = 0; side < 2 && may_cross(item); side++) {
        if (search->leaves[1 - side].tree == PCCD_TREE_FACES) {
            look_at_passages(search, side, &leaf[side], index[1 - side]);
        }
    }
    for (int side = 0; side < 2; side++) {
        look_at_vertices(search, side, &leaf[side], &leaf[1 - side], index[1 - side]);
    }
    for (uint32_t i = 0; i < 3; i++) {
        if ((leaf[0].owns & ENG_OWNS_EDGE(i)) == 0) {
            continue;
        }
        uint32_t edge_a[2] = {leaf[0].v[i], leaf[0].v[(i + 1) % 3]};
        for (uint32_t j = 0; j < 3; j++) {
            if ((leaf[1].owns & ENG_OWNS_EDGE(j)) != 0) {
                uint32_t edge_b[2] = {leaf[1].v[j], leaf[1].v[(j + 1) % 3]};
                struct eng_near_pair pair =
                    eng_near_ee(search->scene, search->leaves[0].object, edge_a,
                                search->leaves[1].object, edge_b);
                look(search, &pair);
            }
        }
    }
    set_limit(search);
}

/* Behind what lies in the stack from `begin` on, the nearest last. */
static void push(struct eng_near_search *search, uint32_t begin,
                 const struct eng_near_item *item)
{
    assert(search->item_count < ENG_NEAR_ITEMS);
    uint32_t at = search->item_count++;
    for (; at > begin && search->items[at - 1].square < item->square; at--) {
        search->items[at] = search->items[at - 1];
    }
    search->items[at] = *item;
}

static const struct eng_leaves_below *open_side(struct eng_near_search *search, int side,
                                                uint32_t node)
{
    search->method->leaves_open(&search->leaves[side], node, &search->below[side]);
    return &search->below[side];
}

static void open_both(struct eng_near_search *search, const uint32_t node[2])
{
    uint32_t begin = search->item_count;
    float square[ENG_WIDE];
    const struct eng_leaves_below *a = open_side(search, 0, node[0]);
    const struct eng_leaves_below *b = open_side(search, 1, node[1]);
    for (uint32_t left = a->children; left != 0; left &= left - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(left);
        float box[2][4];
        box_of(search, a, i, box);
        uint32_t bits = search->worker->kernels->box_gaps(
            b->low, b->high, (const float(*)[4])box, search->limit, square);
        search->box_tests += ENG_WIDE;
        for (bits &= b->children; bits != 0; bits &= bits - 1) {
            uint32_t j = (uint32_t)__builtin_ctz(bits);
            push(search, begin,
                 &(struct eng_near_item){
                     square[j],
                     {a->child[i], b->child[j]},
                     (uint8_t)((a->leaves >> i & 1u) | (b->leaves >> j & 1u) << 1)});
        }
    }
}

static void begin(struct eng_near_search *search, uint32_t a, uint32_t b,
                  const struct eng_near_limits *limits)
{
    assert(a != b);
    set_frames(search, a, b);
    eng_near_best_begin(&search->best, limits);
    search->reach = NAN; /* so that a limit is set */
    set_limit(search);
    search->item_count = 0;
}

/* Get ready to go down two trees of the objects; false: either has no leaf there. */
static bool begin_trees(struct eng_near_search *search, uint32_t a, enum pccd_tree tree_a,
                        uint32_t b, enum pccd_tree tree_b)
{
    const struct eng_method_calls *method = search->method;
    search->item_count = 0;
    if (!method->leaves_of(search->scene, a, tree_a, search->end, &search->leaves[0]) ||
        !method->leaves_of(search->scene, b, tree_b, search->end, &search->leaves[1])) {
        return false;
    }
    search->items[search->item_count++] =
        (struct eng_near_item){.node = {search->leaves[0].root, search->leaves[1].root}};
    return true;
}

/* Faces, edges, points: pairs of larger leaves first. */
#define TREES 3
static enum pccd_tree tree_of(uint32_t i)
{
    return (enum pccd_tree)(TREES - 1 - i);
}

bool eng_near_search_objects(struct eng_near_search *search, uint32_t a, uint32_t b,
                             const struct eng_near_limits *limits,
                             const struct eng_near_pair *first)
{
    begin(search, a, b, limits);
    if (first) {
        eng_near_best_look(&search->best, first);
        set_limit(search);
    }
    for (uint32_t i = 0; i < TREES * TREES; i++) {
        (void)begin_trees(search, a, tree_of(i / TREES), b, tree_of(i % TREES));
        while (search->item_count > 0 && !is_stopped(search)) {
            struct eng_near_item item = search->items[--search->item_count];
            if (item.square >= search->limit) {
                continue;
            }
            if (item.leaves == 3) {
                look_at_leaves(search, &item);
            } else {
                open_both(search, item.node);
            }
        }
    }
    return !search->is_stopped;
}

/* Return whether somebody else counts a side of a leaf. */
static bool is_foreign(const struct eng_near_search *search, int side,
                       const struct eng_face *leaf, uint32_t k)
{
    const struct eng_mesh *mesh =
        search->scene->objects[search->leaves[side].object].mesh;
    return eng_mesh_has_foreign(mesh) &&
           eng_mesh_is_foreign(mesh, PCCD_TREE_EDGES,
                               eng_mesh_edge(mesh, leaf->v[k], leaf->v[(k + 1) % 3]));
}

/* Count the edges owned by a leaf of one side that pass through a face of the other. */
static uint64_t count_crossings(struct eng_near_search *search, int side,
                                const struct eng_near_item *item)
{
    const struct eng_scene *scene = search->scene;
    const struct eng_face own = leaf_of(search, side, item->node[side]);
    const struct eng_face other = leaf_of(search, 1 - side, item->node[1 - side]);
    uint32_t first[2] = {scene->objects[search->leaves[side].object].vertices.first,
                         scene->objects[search->leaves[1 - side].object].vertices.first};
    uint64_t count = 0;
    double x[5][3];
    for (int i = 0; i < 3; i++) {
        memcpy(x[2 + i], search->best.x[first[1] + other.v[i]], sizeof x[0]);
    }
    for (uint32_t k = 0; k < 3; k++) {
        if ((own.owns & ENG_OWNS_EDGE(k)) != 0) {
            memcpy(x[0], search->best.x[first[0] + own.v[k]], sizeof x[0]);
            memcpy(x[1], search->best.x[first[0] + own.v[(k + 1) % 3]], sizeof x[0]);
            count += eng_distance_crosses(&search->distances, (const double(*)[3])x) &&
                     !is_foreign(search, side, &own, k);
        }
    }
    return count;
}

bool eng_near_search_crossings(struct eng_near_search *search, uint32_t a, uint32_t b,
                               uint64_t *crossings)
{
    static const enum pccd_tree trees[3][2] = {{PCCD_TREE_FACES, PCCD_TREE_FACES},
                                               {PCCD_TREE_EDGES, PCCD_TREE_FACES},
                                               {PCCD_TREE_FACES, PCCD_TREE_EDGES}};
    *crossings = 0;
    begin(search, a, b, &(struct eng_near_limits){0});
    for (int i = 0; i < 3; i++) {
        (void)begin_trees(search, a, trees[i][0], b, trees[i][1]);
        while (search->item_count > 0 && !is_stopped(search)) {
            struct eng_near_item item = search->items[--search->item_count];
            if (item.leaves != 3) {
                open_both(search, item.node);
                continue;
            }
            for (int side = 0; side < 2; side++) {
                if (trees[i][1 - side] == PCCD_TREE_FACES) {
                    *crossings += count_crossings(search, side, &item);
                }
            }
        }
    }
    return !search->is_stopped;
}

/* ---- a point and an object --------------------------------------------------------- */

/* The box of a point of the first object, as those of the second are measured. */
static void box_point(const struct eng_near_search *search, const double x[3],
                      float box[2][4])
{
    const struct eng_scene *scene = search->scene;
    const struct eng_box_frame *frame =
        scene->framing.number == 0 ? NULL
                                   : &scene->objects[search->leaves[1].object].frame;
    for (int k = 0; k < 3; k++) {
        float low;
        float high;
        eng_bounds_of(&low, &high, x[k], frame, (int)(4 * search->end) + k);
        box[0][k] = -low;
        box[1][k] = high;
    }
}

/* Open a node of the second object: add what is below it within the limit of a box. */
static void open_one(struct eng_near_search *search, float box[2][4], float limit,
                     uint32_t node)
{
    uint32_t begin = search->item_count;
    float square[ENG_WIDE];
    const struct eng_leaves_below *below = open_side(search, 1, node);
    uint32_t bits = search->worker->kernels->box_gaps(
        below->low, below->high, (const float(*)[4])box, limit, square);
    search->box_tests += ENG_WIDE;
    for (bits &= below->children; bits != 0; bits &= bits - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(bits);
        push(search, begin,
             &(struct eng_near_item){
                 square[i], {0, below->child[i]}, (uint8_t)(below->leaves >> i & 1u)});
    }
}

static void begin_point(struct eng_near_search *search, uint32_t of_vertex, uint32_t v,
                        uint32_t of_faces, float box[2][4])
{
    const struct eng_object *object = &search->scene->objects[of_vertex];
    begin(search, of_vertex, of_faces, &(struct eng_near_limits){.distance = INFINITY});
    (void)search->method->leaves_of(search->scene, of_faces, PCCD_TREE_FACES, search->end,
                                    &search->leaves[1]);
    search->items[search->item_count++] =
        (struct eng_near_item){.node = {0, search->leaves[1].root}};
    box_point(search, search->best.x[object->vertices.first + v], box);
}

static void look_at_face(struct eng_near_search *search, uint32_t of_vertex, uint32_t v,
                         uint32_t of_faces, uint32_t face)
{
    struct eng_near_pair pair = eng_near_vf(search->scene, of_vertex, v, of_faces, face);
    eng_near_best_look(&search->best, &pair);
    set_limit(search);
}

bool eng_near_search_vertex(struct eng_near_search *search, uint32_t of_vertex,
                            uint32_t v, uint32_t of_faces, uint32_t first)
{
    float box[2][4];
    begin_point(search, of_vertex, v, of_faces, box);
    if (first != ENG_NO_FACE) {
        look_at_face(search, of_vertex, v, of_faces, first);
    }
    while (search->item_count > 0 && !is_stopped(search)) {
        struct eng_near_item item = search->items[--search->item_count];
        if (item.square >= search->limit) {
            continue;
        }
        if (item.leaves == 0) {
            open_one(search, box, search->limit, item.node[1]);
        } else {
            look_at_face(search, of_vertex, v, of_faces,
                         search->method->leaves_index(&search->leaves[1], item.node[1]));
        }
    }
    return !search->is_stopped;
}

bool eng_near_search_winding(struct eng_near_search *search, uint32_t of_vertex,
                             uint32_t v, uint32_t of_faces, int64_t *winding, bool *is_on)
{
    const struct eng_object *object = &search->scene->objects[of_faces];
    const double(*x)[3] = search->best.x;
    const double *p = x[search->scene->objects[of_vertex].vertices.first + v];
    float box[2][4];
    *winding = 0;
    *is_on = false;
    begin_point(search, of_vertex, v, of_faces, box);
    box[1][0] = FAR; /* the ray's */
    while (search->item_count > 0 && !*is_on && !is_stopped(search)) {
        struct eng_near_item item = search->items[--search->item_count];
        if (item.leaves == 0) {
            open_one(search, box, SQUARE_TINY, item.node[1]);
            continue;
        }
        double face[3][3];
        uint32_t index = search->method->leaves_index(&search->leaves[1], item.node[1]);
        for (int i = 0; i < 3; i++) {
            memcpy(face[i], x[object->vertices.first + object->mesh->leaves[index].v[i]],
                   sizeof face[i]);
        }
        enum eng_sign sign =
            eng_winding(&search->distances.numbers, p, (const double(*)[3])face);
        *is_on = sign == ENG_UNSURE;
        *winding += *is_on ? 0 : (int64_t)sign;
    }
    return !search->is_stopped;
}
