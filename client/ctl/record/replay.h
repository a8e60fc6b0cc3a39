/* replay.h - whether a step that was computed again has the recorded answer. */
#ifndef CTL_REPLAY_H
#define CTL_REPLAY_H

#include <stdbool.h>
#include <stdint.h>

#include "play.h"

/* X(NAME, "name"): what came of a step or question. Only answers that were and are
 * complete must be equal. */
#define REPLAY_OUTCOMES(X)                                                               \
    X(SAME, "same")                                                                      \
    X(DIFFERS, "differs")                                                                \
    X(UNANSWERED, "unanswered") /* there is no recorded answer */                        \
    X(INCOMPLETE, "incomplete") /* one of the two is; or any answer is right */          \
    X(SKIPPED, "skipped")       /* it had failed by chance */
enum replay_outcome {
#define REPLAY_ENUM(name, text) REPLAY_##name,
    REPLAY_OUTCOMES(REPLAY_ENUM)
#undef REPLAY_ENUM
        REPLAY_OUTCOME_COUNT
};
extern const char *const replay_outcome_names[REPLAY_OUTCOME_COUNT];

struct replay_side {
    int32_t status; /* enum pccd_status; else than 0: the rest is 0 */
    uint64_t total;
    uint64_t hash[2];
    double toi_first; /* not of a question */
};

/* Outcome of one step or question; without pointers, so that other processes can be
 * told. */
struct replay_item {
    uint64_t step;
    uint32_t outcome; /* enum replay_outcome */
    uint32_t what;    /* DIFFERS: in what; a place in replay_whats */
    bool is_near;
    struct replay_side expected; /* zeros without a recorded answer */
    struct replay_side got;      /* zeros when it is skipped */
};

/* Names of what can differ, in the order in which it is looked at. */
#define REPLAY_WHAT_COUNT 8
extern const char *const replay_whats[REPLAY_WHAT_COUNT];

void replay_judge(const struct play_step *step, struct replay_item *item);

struct replay_counts {
    uint64_t of[REPLAY_OUTCOME_COUNT];
    struct replay_item first; /* of those that differ */
};
void replay_count(struct replay_counts *counts, const struct replay_item *item);

/* Return PCCD_OK, or PCCD_E_STATE: there is no answer that could be compared. */
int replay_judge_counts(const struct replay_counts *counts,
                        const struct play_summary *summary, const char *path,
                        struct ctl_error *error);

/* Print the outcome on the standard output, as text or as JSON. False: it could not be
 * written. */
void replay_print_text(const struct replay_counts *counts,
                       const struct play_summary *summary);
bool replay_print_json(const struct replay_counts *counts,
                       const struct play_summary *summary);

#endif
