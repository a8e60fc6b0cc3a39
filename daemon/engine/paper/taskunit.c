/* taskunit.c - the self-CD task unit.
 *
 * Source: paper section 4.1. The pair queue is taken from the end (the paper allows a
 * queue or a stack, section 3.2), which bounds its length by the depth of the trees.
 */
#include "paper_work.h"

#include <assert.h>

#include "question.h"
#include "rebuild.h"

/* Features of that sort that one triangle has; it need not own each. */
ENG_FEATURE_INLINE uint32_t feature_count(uint32_t points)
{
    return points == 3 ? 1 : 3;
}

/* Return whether the leaf owns its feature k. Its face, which it has to have
 * (feature_has_face), and of the others those that no leaf before it has. */
ENG_FEATURE_INLINE bool feature_is_owned(const struct eng_triangle *triangle,
                                         uint32_t points, uint32_t k)
{
    return points == 1   ? (triangle->owns & ENG_OWNS_VERTEX(k)) != 0
           : points == 2 ? (triangle->owns & ENG_OWNS_EDGE(k)) != 0
                         : true;
}

/* Return whether a vertex or an edge that it owns is foreign (mesh.h). */
ENG_FEATURE_INLINE bool feature_is_foreign(const struct eng_triangle *triangle,
                                           uint32_t points, uint32_t k)
{
    return (triangle->owns &
            (points == 1 ? ENG_FOREIGN_VERTEX(k) : ENG_FOREIGN_EDGE(k))) != 0;
}

static inline bool feature_has_face(const struct eng_triangle *triangle)
{
    return (triangle->owns & ENG_OWNS_FACE) != 0;
}

/* Return whether it is a free point, or a free edge. */
static inline bool feature_is_free_point(const struct eng_triangle *triangle)
{
    return (triangle->owns & ENG_OWNS_BITS) == ENG_OWNS_VERTEX(0) &&
           triangle->v[0] == triangle->v[1];
}

static inline bool feature_is_free_edge(const struct eng_triangle *triangle)
{
    return !feature_has_face(triangle) && triangle->v[0] != triangle->v[1];
}

/* The index of feature k of the triangle below `leaf`. */
ENG_FEATURE_INLINE uint32_t feature_of(const struct eng_trees *trees, uint32_t points,
                                       const struct eng_node *leaf, uint32_t k)
{
    const struct eng_triangle *triangle = &trees->triangles[leaf->right];
    return points == 1 ? triangle->v[k] : points == 2 ? triangle->e[k] : leaf->right;
}

/* Its box: that of a face is its leaf's. */
ENG_FEATURE_INLINE const struct eng_box *feature_box(const struct eng_trees *trees,
                                                     uint32_t points,
                                                     const struct eng_node *leaf,
                                                     uint32_t feature)
{
    return points == 1   ? eng_box_of_const(&trees->vertices[feature])
           : points == 2 ? eng_box_of_const(&trees->edges[feature])
                         : eng_box_of_const(leaf);
}

/* Pairs of one task unit between two looks at the clock, when no chunk fills up. */
#define PAIRS_PER_LOOK 65536u

static inline bool overlap(const struct eng_worker *worker, const void *a, const void *b)
{
    const struct eng_box *box_a = eng_box_of_const(a);
    const struct eng_box *box_b = eng_box_of_const(b);
    const struct eng_question *question = worker->question;
    if (eng_asks_near(question)) {
        return eng_box_is_near(box_a, box_b, question->end, question->sought.growth);
    }
    if (!eng_box_overlap(box_a, box_b)) {
        return false;
    }
    return worker->box_bound >= 1 ||
           eng_box_overlap_until(box_a, box_b, worker->box_bound);
}

/* Return whether features below the one node may meet features below the other, or, of
 * one node twice, features below it each other. Pairs between objects come from above
 * them, so that what an object may not meet is left out where the trees of the two meet.
 */
static bool is_allowed(const struct eng_scene *scene, uint32_t n, uint32_t m)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint32_t a = trees->upkeep[n].object;
    uint32_t b = trees->upkeep[m].object;
    return a == ENG_NO_OBJECT || b == ENG_NO_OBJECT ||
           (eng_masks_allows(&scene->masks, a, b) &&
            !eng_masks_keep_apart(&scene->masks, a, b));
}

/* Return whether a pair of nodes is to be refined, or of leaves to be tested. */
static inline bool may_meet(const struct eng_worker *worker, uint32_t n, uint32_t m)
{
    const struct eng_scene *scene = worker->scene;
    struct eng_trees *trees = eng_trees_of(scene);
    return overlap(worker, &trees->nodes[n], &trees->nodes[m]) &&
           (!eng_masks_is_on(&scene->masks) || is_allowed(scene, n, m));
}

/* Return whether the pair is left out because all of both is foreign. Nothing is in most
 * scenes. */
static inline bool are_foreign(const struct eng_worker *worker, uint32_t n, uint32_t m)
{
    const struct eng_trees *trees = eng_trees_of(worker->scene);
    return trees->has_foreign && trees->nodes[n].foreign && trees->nodes[m].foreign;
}

bool eng_taskunit_is_wanted(struct eng_worker *worker, uint32_t node)
{
    const struct eng_scene *scene = worker->scene;
    if (are_foreign(worker, node, node)) {
        return false;
    }
    return !eng_masks_is_on(&scene->masks) || is_allowed(scene, node, node);
}

static void emit(struct eng_worker *worker, enum pccd_kind kind, uint32_t a, uint32_t b)
{
    struct eng_chunk *chunk = &eng_paper_work_of(worker)->chunks[kind];
    chunk->a[chunk->count] = a;
    chunk->b[chunk->count] = b;
    if (++chunk->count == ENG_CHUNK_MAX) {
        eng_test_chunk(worker, kind);
    }
}

/* The order in which records name two features of one sort. */
static bool comes_first(const struct eng_scene *scene, uint32_t points, uint32_t a,
                        uint32_t b)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    uint32_t object_a = eng_feature_object(trees, points, a);
    uint32_t object_b = eng_feature_object(trees, points, b);
    return object_a == object_b
               ? a < b
               : scene->objects[object_a].id < scene->objects[object_b].id;
}

/* Return whether a feature with vertices v has any of the vertices w. */
ENG_FEATURE_INLINE bool have_common(const uint32_t *v, uint32_t v_count,
                                    const uint32_t *w, uint32_t w_count)
{
#pragma GCC unroll 3
    for (uint32_t i = 0; i < v_count; i++) {
#pragma GCC unroll 3
        for (uint32_t k = 0; k < w_count; k++) {
            if (v[i] == w[k]) {
                return true;
            }
        }
    }
    return false;
}

/* Return whether the one that comes first of feature i of the triangle ta and k of tb is
 * foreign. */
ENG_FEATURE_INLINE bool is_first_foreign(enum pccd_kind kind, bool a_is_first,
                                         const struct eng_triangle *ta, uint32_t i,
                                         const struct eng_triangle *tb, uint32_t k)
{
    return a_is_first ? feature_is_foreign(ta, common_kinds[kind].points[0], i)
                      : feature_is_foreign(tb, common_kinds[kind].points[1], k);
}

/* Features that the triangle below n owns, as a, against those of the one below m, as b.
 * `kind` is a constant of the code. */
ENG_FEATURE_INLINE void features_against(struct eng_worker *worker, enum pccd_kind kind,
                                         const struct eng_node *n,
                                         const struct eng_node *m)
{
    const struct eng_scene *scene = worker->scene;
    const struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_triangle *ta = &trees->triangles[n->right];
    const struct eng_triangle *tb = &trees->triangles[m->right];
    const uint32_t points_a = common_kinds[kind].points[0];
    const uint32_t points_b = common_kinds[kind].points[1];
    uint32_t v[3];
    uint32_t w[3];
    for (uint32_t i = 0; i < feature_count(points_a); i++) {
        if (!feature_is_owned(ta, points_a, i)) {
            continue;
        }
        uint32_t a = feature_of(trees, points_a, n, i);
        const struct eng_box *box_a = feature_box(trees, points_a, n, a);
        eng_feature_vertices(trees, points_a, a, v);
        for (uint32_t k = 0; k < feature_count(points_b); k++) {
            if (!feature_is_owned(tb, points_b, k)) {
                continue;
            }
            uint32_t b = feature_of(trees, points_b, m, k);
            eng_feature_vertices(trees, points_b, b, w);
            if (have_common(v, points_a, w, points_b) ||
                !overlap(worker, box_a, feature_box(trees, points_b, m, b))) {
                continue;
            }
            bool a_is_first = points_a != points_b || comes_first(scene, points_a, a, b);
            if (trees->has_foreign && is_first_foreign(kind, a_is_first, ta, i, tb, k)) {
                continue;
            }
            if (a_is_first) {
                emit(worker, kind, a, b);
            } else {
                emit(worker, kind, b, a);
            }
        }
    }
}

/* Free points and edges, where they have a distance to keep. */
static void free_pair(struct eng_worker *worker, const struct eng_node *n,
                      const struct eng_node *m)
{
    const struct eng_triangle *triangles = eng_trees_of(worker->scene)->triangles;
    const struct eng_triangle *ta = &triangles[n->right];
    const struct eng_triangle *tb = &triangles[m->right];
    if (!eng_asks_near(worker->question) && !worker->scene->thickness.is_on) {
        return;
    }
    if (feature_is_free_point(ta) && feature_is_free_point(tb)) {
        features_against(worker, PCCD_VV, n, m);
    } else if (feature_is_free_point(ta) && feature_is_free_edge(tb)) {
        features_against(worker, PCCD_VE, n, m);
    } else if (feature_is_free_edge(ta) && feature_is_free_point(tb)) {
        features_against(worker, PCCD_VE, m, n);
    }
}

/* A leaf is not tested against itself: of VF, EE and EF two features of a triangle have a
 * common vertex, as they have four points or more together; VE and VV are of leaves that
 * have one feature each. */
#define HAVE_COMMON(NAME, points_a, points_b)                                            \
    static_assert((points_a) + (points_b) > 3, "else they may meet within a triangle");
HAVE_COMMON(VF, 1, 3)
HAVE_COMMON(EE, 2, 2)
HAVE_COMMON(EF, 2, 3)
#undef HAVE_COMMON

/* Return whether the question is about edges of one that pass through the other, and
 * their boxes meet. */
static inline bool may_cross(const struct eng_worker *worker, const struct eng_node *n,
                             const struct eng_node *m)
{
    const struct eng_question *question = worker->question;
    return eng_asks_near(question) && question->sought.kinds >> PCCD_EF & 1 &&
           eng_box_is_near(eng_box_of_const(n), eng_box_of_const(m), question->end,
                           eng_near_growth_of(question, PCCD_EF));
}

/* Return whether other pairs are asked for than edges that pass through faces. */
static inline bool wants_pairs(const struct eng_worker *worker)
{
    const struct eng_question *question = worker->question;
    return !eng_asks_near(question) || question->sought.kinds & 1u << PCCD_VF;
}

/* Two leaves of which one at least is no triangle. Not inline, so that the code of
 * triangles is as it is without. */
static __attribute__((noinline)) void
mixed_pair(struct eng_worker *worker, const struct eng_node *n, const struct eng_node *m)
{
    const struct eng_triangle *triangles = eng_trees_of(worker->scene)->triangles;
    bool n_has_face = feature_has_face(&triangles[n->right]);
    bool m_has_face = feature_has_face(&triangles[m->right]);
    if (!n_has_face && !m_has_face) {
        if (wants_pairs(worker)) {
            free_pair(worker, n, m);
            features_against(worker, PCCD_EE, n, m);
        }
        return;
    }
    const struct eng_node *face = n_has_face ? n : m;
    const struct eng_node *other = n_has_face ? m : n;
    if (may_cross(worker, n, m)) {
        features_against(worker, (enum pccd_kind)PCCD_EF, other, face);
    }
    if (wants_pairs(worker)) {
        features_against(worker, PCCD_VF, other, face);
        features_against(worker, PCCD_EE, n, m);
    }
}

static void leaf_pair(struct eng_worker *worker, const struct eng_node *n,
                      const struct eng_node *m)
{
    const struct eng_triangle *triangles = eng_trees_of(worker->scene)->triangles;
    worker->tally.leaf_pairs++;
    if (!(triangles[n->right].owns & triangles[m->right].owns & ENG_OWNS_FACE)) {
        mixed_pair(worker, n, m);
        return;
    }
    if (may_cross(worker, n, m)) {
        features_against(worker, (enum pccd_kind)PCCD_EF, n, m);
        features_against(worker, (enum pccd_kind)PCCD_EF, m, n);
    }
    if (!wants_pairs(worker)) {
        return;
    }
    features_against(worker, PCCD_VF, n, m);
    features_against(worker, PCCD_VF, m, n);
    features_against(worker, PCCD_EE, n, m);
}

/* BV overlap test of a pair: what passes waits for its refinement, or, between two
 * leaves, is a pair of those. Testing before queueing halves the nodes fetched: a
 * refinement meets four boxes and tests each twice. */
static inline void test_pair(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    const struct eng_node *nodes = eng_trees_of(worker->scene)->nodes;
    struct eng_pair_queue *pairs = &eng_paper_work_of(worker)->pairs;
    if (are_foreign(worker, n, m)) {
        return;
    }
    worker->record.box_tests++;
    if (!may_meet(worker, n, m)) {
        return;
    }
    if (nodes[n].left == ENG_LEAF && nodes[m].left == ENG_LEAF) {
        leaf_pair(worker, &nodes[n], &nodes[m]);
        return;
    }
    assert(pairs->count < ENG_PAIRS_MAX);
    pairs->n[pairs->count] = n;
    pairs->m[pairs->count] = m;
    pairs->count++;
}

/* Refine both nodes of a pair; a leaf stands for itself. */
static inline uint32_t refine(struct eng_worker *worker, uint32_t n, uint32_t m,
                              uint32_t n_out[4], uint32_t m_out[4])
{
    const struct eng_node *node_n = eng_node_open(worker, n);
    const struct eng_node *node_m = eng_node_open(worker, m);
    uint32_t ns[2] = {n, n};
    uint32_t ms[2] = {m, m};
    uint32_t n_count = 1;
    uint32_t m_count = 1;
    if (node_n->left != ENG_LEAF) {
        ns[0] = node_n->left;
        ns[1] = node_n->right;
        n_count = 2;
    }
    if (node_m->left != ENG_LEAF) {
        ms[0] = node_m->left;
        ms[1] = node_m->right;
        m_count = 2;
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < n_count; i++) {
        for (uint32_t j = 0; j < m_count; j++) {
            n_out[count] = ns[i];
            m_out[count++] = ms[j];
        }
    }
    return count;
}

void eng_taskunit_pairs(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    struct eng_pair_queue *pairs = &eng_paper_work_of(worker)->pairs;
    uint64_t refined = 0;
    test_pair(worker, n, m);
    while (pairs->count > 0 && !eng_stop_is_set(worker->stop)) {
        uint32_t n_out[4];
        uint32_t m_out[4];
        pairs->count--;
        uint32_t count =
            refine(worker, pairs->n[pairs->count], pairs->m[pairs->count], n_out, m_out);
        for (uint32_t i = 0; i < count; i++) {
            test_pair(worker, n_out[i], m_out[i]);
        }
        if (++refined % PAIRS_PER_LOOK == 0) {
            eng_worker_should_stop(worker);
        }
    }
    pairs->count = 0;
    worker->record.pairs += refined;
}

uint32_t eng_taskunit_refine(struct eng_worker *worker, uint32_t n, uint32_t m,
                             uint32_t n_out[4], uint32_t m_out[4])
{
    assert(n != m);
    const struct eng_node *nodes = eng_trees_of(worker->scene)->nodes;
    if (are_foreign(worker, n, m)) {
        return 0;
    }
    worker->record.box_tests++;
    if (!may_meet(worker, n, m)) {
        return 0;
    }
    if (nodes[n].left == ENG_LEAF && nodes[m].left == ENG_LEAF) {
        leaf_pair(worker, &nodes[n], &nodes[m]);
        return 0;
    }
    worker->record.pairs++;
    return refine(worker, n, m, n_out, m_out);
}

uint32_t eng_taskunit_peek(struct eng_worker *worker, uint32_t n, uint32_t m,
                           uint32_t n_out[4], uint32_t m_out[4])
{
    const struct eng_node *nodes = eng_trees_of(worker->scene)->nodes;
    bool are_leaves = nodes[n].left == ENG_LEAF && nodes[m].left == ENG_LEAF;
    if (are_leaves || are_foreign(worker, n, m) || !may_meet(worker, n, m)) {
        return 0;
    }
    return refine(worker, n, m, n_out, m_out);
}

static void push_unit(struct eng_worker *worker, uint32_t node)
{
    if (eng_taskunit_is_wanted(worker, node)) {
        eng_units_push(&eng_paper_work_of(worker)->units, node);
    }
}

void eng_taskunit_perform(struct eng_worker *worker, uint32_t node, bool push_children)
{
    assert(node != ENG_NO_NODE);
    if (!eng_taskunit_is_wanted(worker, node)) {
        return;
    }
    const struct eng_node *opened = eng_node_open(worker, node);
    if (opened->left == ENG_LEAF) {
        return;
    }
    uint64_t begin_ns = eng_worker_slice(worker);
    worker->record.task_units++;
    if (push_children) {
        push_unit(worker, opened->left);
        push_unit(worker, opened->right);
    }
    eng_taskunit_pairs(worker, opened->left, opened->right);
    eng_worker_trace(worker, PCCD_TRACE_UNIT, begin_ns, node, opened->count);
}

void eng_taskunit_flush(struct eng_worker *worker)
{
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        eng_test_chunk(worker, kind);
    }
}

void eng_taskunit_perform_all(struct eng_worker *worker)
{
    uint32_t root = eng_trees_of(worker->scene)->root;
    struct eng_unit_queue *units = &eng_paper_work_of(worker)->units;
    if (root == ENG_NO_NODE) {
        return;
    }
    eng_taskunit_perform(worker, root, true);
    while (eng_units_count(units) > 0 && !eng_stop_is_set(worker->stop)) {
        eng_taskunit_perform(worker, eng_units_take_newest(units), true);
    }
    eng_taskunit_flush(worker);
}
