/* near_ours.h - what the engine says is near, as others say it, and who is right.
 *
 * Threads: one asks; a team answers.
 */
#ifndef NEAR_OURS_H
#define NEAR_OURS_H

#include "near_peer.h"
#include "pccd_types.h"
#include "report.h"
#include "steps.h"

/* ---- Who is right about what is near: exact integers decide.
 *
 * Take all pairs that ours and another library have found; ask the oracle of each whether
 * it is within the distance, how far apart it is, and between which features; merge
 * these, and bound each vertex; count the differences. */

/* Answer of one side. Memory is the caller's; the judge sorts what is there. */
struct near_answers {
    struct near_pair *pairs;
    uint64_t pair_count;
    struct near_feature *features;
    uint64_t feature_count;
    double *bounds; /* by vertex */
};

/* A record of ours under the names of the scene; where its bracket is. */
struct near_bracket {
    double lo;
    double hi;
};

/* Counts of what is wrong. */
struct near_verdict {
    uint64_t pairs;     /* that are within the distance */
    uint64_t features;  /* closest ones of these, each once */
    uint64_t missing;   /* pairs that are within it, and were not found */
    uint64_t at_bound;  /* of these: at the distance itself, or less than an ulp nearer */
    uint64_t surplus;   /* pairs that are not within it, and were found */
    uint64_t distances; /* ours: not the exact bracket; else: squares off by over 1e-6 */
    uint64_t closest; /* pairs of which others are the closest features, or the count.. */
    uint64_t merged;  /* ..of merged features that are not there, or too many or few */
    uint64_t bounds;  /* ours: vertices whose bound is another; else: whose bound is
                         * beyond the exact distance */
    double most;      /* else: by how much of the bound, at most */
};

struct near_ours {
    struct near_answers answers;
    struct near_bracket *brackets; /* of each pair */
};

/* Judge both. The pairs of ours are sorted by name, as features are. `theirs` NULL: there
 * is no other. */
void near_judge(const struct near_input *input, double d, const struct near_ours *of_us,
                struct near_answers *theirs, struct near_verdict *of_ours,
                struct near_verdict *of_theirs);

/* Measured times of one question. */
struct near_quantity {
    struct bench_samples ms;
    uint64_t spent_ns;
};

/* Add the time since begin_ns; as a sample only if `counts`. */
void near_keep(struct near_quantity *quantity, uint64_t begin_ns, bool counts);

/* Measure how much of a step is safe (allowed.c), of all scenes that are wanted. */
void near_allowed(const struct bench_options *options);

/* A scene at its hard frame, which has made a step to the end of that by the method
 * `paper`; and its start, as other libraries take it. */
struct near_scene {
    struct bench_frames frames;
    struct bench_world world;
    struct peer_input features;
    struct near_input input;
};

void near_scene_init(struct near_scene *scene, const struct bench_scene *source);
void near_scene_deinit(struct near_scene *scene);

/* Settings of a question, by the method `wide`. */
struct eng_question near_ours_settings(enum pccd_near_what what, double d,
                                       uint32_t threads);

/* The world has made a step by the method `paper`, and stands at the start of `frames` or
 * at its end; it stands at the start afterwards. */
void near_ours_ask(struct near_ours *ours, struct bench_world *world,
                   const struct bench_frames *frames, double d);
void near_ours_free(struct near_ours *ours);

#endif
