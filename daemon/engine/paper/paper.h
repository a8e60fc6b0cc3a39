/* paper.h - everything that the method `paper` keeps for a scene.
 *
 * Threads: [compute]; inside a step as each part says.
 */
#ifndef ENG_PAPER_H
#define ENG_PAPER_H

#include "assignment.h"
#include "background.h"
#include "refit.h"
#include "trees.h"

struct eng_paper {
    struct eng_trees trees; /* first: eng_trees_of finds them by it */
    struct eng_refit_plan plan;
    struct eng_assignment assignment;
    struct eng_background background;
};

static_assert(offsetof(struct eng_paper, trees) == 0, "eng_trees_of");

static inline struct eng_paper *eng_paper_of(const struct eng_scene *scene)
{
    return scene->slots[ENG_SLOT_PAPER];
}

extern const struct eng_slot_calls eng_paper_slot;

/* The functions that a step calls. */
extern const struct eng_method_calls eng_method_paper;

#endif
