/* refit_plan.h - divides the refit among the threads of a team.
 *
 * Threads: [compute]; the team changes `unfinished`.
 * Source: paper section 6.1.
 */
#ifndef ENG_REFIT_PLAN_H
#define ENG_REFIT_PLAN_H

#include <stdatomic.h>

#include "step_settings.h"
#include "trees.h"

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

#endif
