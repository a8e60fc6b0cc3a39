/* judge.h - compares the engine's answers on a scene with brute force in exact
 * arithmetic.
 *
 * Threads: one; the engine's steps by one to four.
 */
#ifndef JUDGE_H
#define JUDGE_H

#include "eng_filters.h"
#include "eng_player.h"
#include "eng_way.h"
#include "oracle_scene.h"
#include "scenes.h"
#include "step.h"

#define JUDGE_OBJECTS_MAX PLAYER_OBJECTS_MAX

struct judge_object {
    struct scenes_mesh mesh; /* positions of the step that was staged last */
    double (*registered)[3];
    uint32_t (*edges)[2];
    uint32_t edge_count;
    uint32_t object_id;
    uint32_t object_idx;
};

/* Sums over everything judged, for the report. */
struct judge_sums {
    uint64_t steps;
    uint64_t truths;
    uint64_t records;
    uint64_t possible; /* records that are not proved */
    uint64_t extra;    /* of these, pairs that do not touch */
    uint64_t initial;
    uint64_t queries; /* answered by the oracle */
    uint64_t team_steps;
};

struct judge {
    struct eng_scene *scene;
    struct judge_object objects[JUDGE_OBJECTS_MAX];
    uint32_t object_count;
    struct filters filters;
    char context[160]; /* kind, size, seed: printed with a failure */
    double tolerance;
    struct judge_sums *sums;
    struct prng ways; /* how the next steps are taken, however small they are */
    struct eng_question settings; /* of the last step */
};

/* A seed of its own for each judge: every step is taken by another method, instruction
 * set, scheduler and team of one to four. */
void judge_init(struct judge *judge, struct judge_sums *sums, double tolerance);
void judge_deinit(struct judge *judge);

/* Without a scene of its own: it sees what a player has staged or stepped last, as it is
 * at each call. */
void judge_watch_init(struct judge *judge, struct judge_sums *sums, double tolerance);
void judge_watch(struct judge *judge, const struct player *player);
/* Compare a step of a play with all that the oracle finds, from the start on. */
void judge_check_play(struct judge_sums *sums, const struct player *player,
                      double tolerance, uint64_t seed, uint32_t step,
                      struct eng_step_result *result);

/* Register a copy of the mesh at its x0. The id is the caller's. */
void judge_add(struct judge *judge, const struct scenes_mesh *mesh, uint32_t object_id);
void judge_remove(struct judge *judge, uint32_t at);

/* Change groups, masks, ignored pairs and self-collision of the scene and the copies. */
void judge_draw_filters(struct judge *judge, struct prng *prng);

/* Stage both ends of every object: the motion that the copies describe. */
void judge_stage_whole(struct judge *judge);

/* eng_step with what is staged; complete, or the test fails. */
void judge_step(struct judge *judge, enum pccd_mode mode, struct eng_step_result *result);

/* All contacts of the copies. */
void judge_find(const struct judge *judge, struct oracle_contacts *truth);

/* The laws of an answer. `all` is a copy of the records of mode ALL. */
struct judge_records {
    struct pccd_contact *items;
    uint64_t count;
};
void judge_check_all(struct judge *judge, const struct eng_step_result *result,
                     const struct oracle_contacts *truth);
void judge_check_first(const struct judge *judge, const struct eng_step_result *result,
                       const struct judge_records *all);
void judge_check_any(const struct judge *judge, const struct eng_step_result *result,
                     const struct judge_records *all);
void judge_check_pairs(const struct judge *judge, const struct eng_step_result *result,
                       const struct oracle_contacts *truth,
                       const struct judge_records *all);

/* Copy of the records of an answer with contacts. Freed by the caller. */
struct judge_records judge_copy(const struct eng_step_result *result);

/* Judge what is staged in mode ALL, then the same motion in every mode. */
void judge_everything(struct judge *judge);

void judge_fail(const struct judge *judge, const char *what,
                const struct pccd_contact *about) __attribute__((noreturn));

#endif
