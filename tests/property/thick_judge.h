/* thick_judge.h - judges a step of a small scene by all pairs.
 *
 * Decide by the oracle of each pair of features, thick or not, whether and when they meet
 * in a step, and whether they are near at an end of it; say what is wrong with a complete
 * answer, in any mode.
 */
#ifndef TESTS_THICK_JUDGE_H
#define TESTS_THICK_JUDGE_H

#include "oracle_near.h"
#include "oracle_thick.h"
#include "step.h"

/* The scene, and how far its features keep apart. */
struct thick_step {
    const struct oracle_object *objects; /* by increasing id */
    uint32_t object_count;
    bool (*may_meet)(const void *context, uint32_t id_a, uint32_t id_b); /* NULL: all */
    const void *context;
    double separation;
    double approach;
    double tolerance;
};

struct thick_truth {
    struct pccd_pair name;
    struct oracle_feature a; /* as they are in the objects of the step */
    struct oracle_feature b;
    bool is_candidate; /* in mode pairs; never of free points that keep no distance */
    bool is_thick;
    bool is_inside;
    struct oracle_first *first; /* NULL: no contact */
};

struct thick_truths {
    struct thick_truth *items; /* in canonical order */
    size_t count;
    size_t capacity;
};

/* All pairs that are not farther apart than `reach` and what they keep, and others.
 * false, and there is nothing: there are more than `pairs_max` of them. */
bool thick_judge_decide(const struct thick_step *step, double reach, size_t pairs_max,
                        struct thick_truths *truths);
void thick_judge_forget(struct thick_truths *truths);

/* NULL: the answer is right; else what is wrong. Its contacts are added to contacts[..],
 * by kind. */
const char *thick_judge(const struct thick_step *step, const struct thick_truths *truths,
                        const struct eng_step_result *result,
                        uint64_t contacts[PCCD_KIND_COUNT]);

/* Return whether a pair is within the distance and its radii, as they are now, at an end
 * of the step, and not left thin for its rest. */
bool thick_judge_is_near(const struct thick_step *step, const struct thick_truth *truth,
                         double distance, uint32_t end);

#endif
