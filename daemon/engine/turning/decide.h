/* decide.h - the elementary test of a pair of features of which one turns: do they come
 * within a distance of each other during the step, and when first?
 *
 * Decide a pair of VF, EE, VE or VV over the whole step, by halves of it in the order of
 * time. The answer is a function of the pair and of the limits alone, whatever tree or
 * thread has found the pair, and whatever poses are kept.
 *
 * Threads: one thread for one struct eng_poses. Decisions allocate nothing.
 * Source: elementary/BOUNDS.md, "Features that turn".
 *
 * An example: a vertex goes half way round a circle of 1 m about a hinge, and through a
 * wall at 30 degrees: toi <= 1/6 <= toi_hi, PCCD_PROVED. If it stops just at the wall, as
 * far as sines and cosines tell, it is possible that it does not reach it: the same
 * times, without PCCD_PROVED.
 *
 * *Distance* is Euclidean, between the closed features, at one time; r is the exact sum
 * of three doubles; with an approach, of a pair that begins within that, which has
 * PCCD_INSIDE, this part of its first distance. Where it is free, the distance is more
 * than r.
 */
#ifndef ENG_TURNING_DECIDE_H
#define ENG_TURNING_DECIDE_H

#include <stdbool.h>

#include "poses.h"
#include "query.h"

/* One of the features is of the body that the path moves: `turning` is 0 if that is
 * feature a, 1 if it is b. The other one's points go straight in the frame that the path
 * is seen in; those of a body that stands there are the same at both ends. */
struct eng_turning_pair {
    enum pccd_kind kind;
    uint32_t turning;
    /* x[end][point], in the order of struct eng_query, of magnitude at most 1e18. Those
     * of the turning feature are in the frame of its body, and x[1] of them is not
     * read. A kind of fewer than four points repeats the last one. */
    double x[2][4][3];
    double radius[3]; /* each 0 .. 1e18: of feature a, of feature b, the separation */
    /* Known: before `from` the pair is farther apart than r + 4 delta, and after `to`, up
     * to a time that is later than t_end by more than the tolerance. The answer is the
     * same, but sooner. Zeros: nothing is known. */
    double from, to;
};

struct eng_turning_limits {
    double delta;       /* positive; how near is possible, see below */
    double tolerance;   /* 1e-12 .. 1, of the bracket of a contact that is proved */
    double approach;    /* of the question, 0 .. 1 (elementary/thick.h); 0: none */
    double t_end;       /* who begins later is not wanted */
    uint32_t looks_max; /* at spans of time, each some 0.05 to 3 microseconds */
    /* Asked every so many looks, at least every 0.2 ms; NULL: never. */
    bool (*should_stop)(void *owner);
    void *owner;
};

#define ENG_TURNING_LOOKS_MAX     65536u /* what a step allows a pair */
#define ENG_TURNING_LOOKS_BETWEEN 32u    /* two questions whether to stop */

enum eng_turning_verdict {
    ENG_TURNING_FREE,   /* more than r apart up to t_end */
    ENG_TURNING_MEETS,  /* *hit is set; PCCD_PROVED, or possible */
    ENG_TURNING_LIMIT,  /* looks_max looks were too few, or places are beyond 1e18 */
    ENG_TURNING_STOPPED /* should_stop said so */
};

/* The answer, and what is known whatever the verdict is.
 *
 * *Proved*: the distance is more than r before toi, and at most r at some time up to
 * toi_hi. The bracket is at most `tolerance` long, but where it begins with what is
 * possible, or the looks were too few. PCCD_INITIAL: it is at most r at t = 0;
 * toi = toi_hi = 0.
 *
 * *Possible*, without PCCD_PROVED: the distance is more than r before toi, and comes to
 * at most r + 2 delta in [toi, toi_hi], which is at most `tolerance` long. Whether the
 * pair meets there nobody knows; nor whether it does later, as far as was looked: to
 * ENG_TURNING_LOOKS_AHEAD more spans that are possible, or to the end of the step.
 *
 * A pair that stays farther apart than r + 4 delta is free: who looks for candidates may
 * leave out what does. For this delta has to be at least what eng_turning_delta_least
 * says; a smaller one is taken as it, by the pair's own size.
 *
 * param and normal are those of struct pccd_contact at toi, the normal in the frame that
 * the path is seen in, from b to a as they lie at toi. */
struct eng_turning_answer {
    enum eng_turning_verdict verdict;
    struct eng_hit hit; /* ENG_TURNING_MEETS */
    double free_until; /* before, the distance is more than r; FREE: beyond t_end, or 1 */
    uint32_t looks;
};

#define ENG_TURNING_LOOKS_AHEAD 64u

/* Decide a pair; `poses` has the path of its turning side. What is known of from and to
 * changes nothing but how many looks it takes, and so whether looks_max are enough: who
 * has limits must know the same in whatever way it has come to the pair (turning.h). */
enum eng_turning_verdict eng_turning_decide(struct eng_poses *poses,
                                            const struct eng_turning_pair *pair,
                                            const struct eng_turning_limits *limits,
                                            struct eng_turning_answer *answer);

/* Decide `count` pairs, at most ENG_TURNING_BATCH, with the same limits: each as if it
 * were alone, in less time. */
void eng_turning_decide_all(struct eng_poses *poses, const struct eng_turning_pair *pairs,
                            uint32_t count, const struct eng_turning_limits *limits,
                            struct eng_turning_answer *answers);

#define ENG_TURNING_BATCH 32u

/* Return the least delta that rounding leaves a meaning: `size` is the largest coordinate
 * that points of both sides have in their frames and where they are seen, `error` the
 * largest bound of the errors of poses for them. */
double eng_turning_delta_least(double size, double error);

#endif
