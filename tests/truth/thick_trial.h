/* thick_trial.h - judges an answer about a public scene with a thickness by exact
 * arithmetic.
 *
 * Walk through all pairs of an object's features that no axis keeps apart, by sorted
 * boxes and without the engine: whatever was answered must be among them. Of those that
 * were, and of those that were not, a share is judged by the oracle, and some pairs from
 * anywhere.
 */
#ifndef THICK_TRIAL_H
#define THICK_TRIAL_H

#include "fuzz_thick.h"
#include "oracle_near.h"
#include "pccd_types.h"

#define TRIAL_TOLERANCE 1e-6

/* A step, what it answered, and how it is judged. */
struct trial {
    const char *name;
    const struct oracle_object *object;
    double radius[3]; /* of a, of b, the separation */
    double approach;
    double reach; /* above r by more than rounding may hide */
    const struct pccd_contact *contacts;
    uint64_t count;
    uint32_t each_found;  /* one answered pair of so many is judged, .. */
    uint32_t each_absent; /* one other of so many, .. */
    uint32_t anywhere;    /* and so many from anywhere */
    struct prng prng;
    /* What was found: */
    uint64_t walked; /* pairs that no axis keeps apart */
    uint64_t met;    /* of these: answered */
    uint64_t judged_found;
    uint64_t judged_absent;
    uint64_t wrong;
};

/* r/4 of each feature, and r/2 as the separation: all three count, and the sum is r. */
void trial_radius(struct trial *trial, double r);

/* The query of two features; those of VF and EE have all points that it takes. */
struct fuzz_thick_case trial_case(const struct trial *trial,
                                  const struct oracle_feature *a,
                                  const struct oracle_feature *b);

/* If that fails, a contact was missed, invented or named twice, or told with a time or a
 * flag that is not true. */
void trial_judge(struct trial *trial);

#endif
