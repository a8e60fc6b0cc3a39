/* refit.h - updates every box of the trees to the new positions, from the leaves up.
 *
 * Threads: [compute], [team] where it says so. A box is written by one thread.
 * Source: paper section 6.1.
 */
#ifndef ENG_REFIT_H
#define ENG_REFIT_H

#include <stdatomic.h>

#include "team.h"
#include "thickness.h"
#include "trees.h"

/* ---- one box ----------------------------------------------------------------------- */

/* Return the frame that the boxes of a vertex of a binary hierarchy are measured in, or
 * NULL. */
static inline const struct eng_box_frame *
eng_box_frame_of_vertex(const struct eng_scene *scene, uint32_t vertex)
{
    return scene->framing.number > 0
               ? &scene->objects[eng_trees_of(scene)->vertices[vertex].object].frame
               : NULL;
}

/* Write the box of a vertex that goes from x0 to x1, with its thickness. */
static inline void eng_refit_vertex(const struct eng_scene *scene, uint32_t vertex,
                                    const double x0[3], const double x1[3],
                                    struct eng_box *box)
{
    eng_box_of_point(box, eng_box_frame_of_vertex(scene, vertex), x0, x1);
    if (scene->thickness.is_on) {
        const struct eng_object *object =
            &scene->objects[eng_trees_of(scene)->vertices[vertex].object];
        float growth =
            eng_thickness_growth(scene, object, vertex - object->vertices.first);
        /* Of an object that is not thick it is the same whether others are: it may be
         * kept when another one becomes thick. */
        for (int k = 0; k < 3 && growth > 0; k++) {
            box->lo0[k] = -eng_thickness_grown(-box->lo0[k], growth);
            box->hi0[k] = eng_thickness_grown(box->hi0[k], growth);
            box->lo1[k] = -eng_thickness_grown(-box->lo1[k], growth);
            box->hi1[k] = eng_thickness_grown(box->hi1[k], growth);
        }
    }
}

static inline void eng_refit_edge(struct eng_trees *trees, uint32_t e)
{
    struct eng_edge *edge = &trees->edges[e];
    eng_box_unite(eng_box_of(edge), eng_box_of(&trees->vertices[edge->a]),
                  eng_box_of(&trees->vertices[edge->b]));
}

/* Return whether all that could be first in a pair below a node is foreign. */
static inline bool eng_node_is_foreign(const struct eng_trees *trees,
                                       const struct eng_node *node)
{
    if (node->left != ENG_LEAF) {
        return trees->nodes[node->left].foreign && trees->nodes[node->right].foreign;
    }
    static_assert(ENG_FOREIGN_VERTEX(0) == 128 * ENG_OWNS_VERTEX(0) &&
                      ENG_FOREIGN_EDGE(0) == 128 * ENG_OWNS_EDGE(0),
                  "bits of what is owned, in the same order");
    uint32_t owns = trees->triangles[node->right].owns;
    return (owns & ~(owns / 128) & (ENG_OWNS_BITS - ENG_OWNS_FACE)) == 0;
}

/* Mark nodes whose children are marked; of a range the last first. */
static inline void eng_foreign_mark(struct eng_trees *trees, struct eng_range nodes)
{
    for (uint32_t i = nodes.count; i-- > 0;) {
        struct eng_node *node = &trees->nodes[nodes.first + i];
        node->foreign = eng_node_is_foreign(trees, node);
    }
}

static inline void eng_refit_node(struct eng_trees *trees, uint32_t idx)
{
    struct eng_node *node = &trees->nodes[idx];
    struct eng_box *box = eng_box_of(node);
    if (node->left == ENG_LEAF) {
        const uint32_t *v = trees->triangles[node->right].v;
        eng_box_unite(box, eng_box_of(&trees->vertices[v[0]]),
                      eng_box_of(&trees->vertices[v[1]]));
        eng_box_unite(box, box, eng_box_of(&trees->vertices[v[2]]));
    } else {
        eng_box_unite(box, eng_box_of(&trees->nodes[node->left]),
                      eng_box_of(&trees->nodes[node->right]));
    }
}

/* ---- who does what ----------------------------------------------------------------- */

/* Features taken at a time: 4 to 8 us of work against 0.1 us to take them. */
#define ENG_REFIT_CHUNK 512u

/* Subtrees for each thread. The paper takes two and measures a factor of four on eight
 * threads; ENG_REFIT_EVEN divides all triangles by sixteen, so that the last one to end
 * keeps the others waiting for a sixteenth of their time at most. */
#define ENG_REFIT_SUBTREES       16u
#define ENG_REFIT_SUBTREES_PAPER 2u

struct eng_refit_chunks {
    struct eng_range *ranges; /* [count], of at most ENG_REFIT_CHUNK */
    uint32_t count;
    uint32_t capacity;
};

/* Memory stays for the next step. */
struct eng_refit_plan {
    struct eng_refit_chunks vertices;
    struct eng_refit_chunks edges;
    /* The subtrees below `roots` go to the threads; the nodes above them are `opened`,
     * breadth-first. Whoever ends the second child of an opened node goes on with it. */
    uint32_t *roots;
    uint32_t *root_parent; /* place in `opened`, or ENG_NO_NODE above the root of all */
    uint32_t *opened;
    uint32_t *opened_parent;
    atomic_uint *unfinished; /* [opened_count] children that are not up to date yet */
    uint32_t root_count;
    uint32_t opened_count;
    uint32_t dealt;    /* the first so many roots are dealt out, the rest is on demand */
    uint32_t capacity; /* of `opened`; one more of `roots` */
};

void eng_refit_plan_deinit(struct eng_refit_plan *plan);
uint64_t eng_refit_plan_bytes(const struct eng_refit_plan *plan);

/* Cut the features anew: objects came or went. PCCD_E_NOMEM. */
int eng_refit_plan_features(struct eng_refit_plan *plan, const struct eng_scene *scene);

/* Divide the tree of `scene` for `threads` threads. PCCD_E_NOMEM. */
int eng_refit_plan_tree(struct eng_refit_plan *plan, const struct eng_scene *scene,
                        enum eng_refit_scheme scheme, uint32_t threads);

/* ---- the refit --------------------------------------------------------------------- */

/* Make boxes from x[1 - now] (t = 0), x[now] (t = 1): vertices from positions; edges from
 * vertices; nodes from vertices or their children, the last of the range first. [any] */
void eng_refit_vertices(struct eng_scene *scene, struct eng_range range);
void eng_refit_edges(struct eng_scene *scene, struct eng_range range);
void eng_refit_nodes(struct eng_scene *scene, struct eng_range range);

/* Make the boxes of nodes that may have got other children, and mark whether they are
 * foreign. [any] */
void eng_refit_anew(struct eng_scene *scene, struct eng_range nodes);

/* Make the boxes of the nodes of a subtree, which may hold nodes above objects. [any] */
void eng_refit_subtree(struct eng_scene *scene, uint32_t root);

/* Make all boxes of one object, by one thread. A step of `worker` that has to end leaves
 * some as they are; NULL: there is none. */
void eng_refit_object(struct eng_scene *scene, const struct eng_object *object,
                      struct eng_worker *worker);
/* Make all boxes of all objects and of the tree over them so. */
void eng_refit(struct eng_scene *scene, struct eng_worker *worker);

/* Make all boxes by all threads of the region, each of which calls it, as the plan says;
 * a step that has to end leaves some as they are.
 * True for the one thread that ended last, and sees every box (team.h says how it lets
 * the others go on). A thread that comes late holds nobody up: there is no barrier, work
 * is taken on demand. [team] */
bool eng_refit_by_team(struct eng_team *team, struct eng_worker *worker,
                       struct eng_refit_plan *plan);

#endif
