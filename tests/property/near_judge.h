/* near_judge.h - compares the engine's answers about what is near with brute force in
 * exact arithmetic.
 */
#ifndef NEAR_JUDGE_H
#define NEAR_JUDGE_H

#include "eng_answer.h"
#include "oracle_near.h"

/* Sums over everything judged, for the report. */
struct near_sums {
    uint64_t judged; /* answers */
    uint64_t queries;
    uint64_t pairs;
    uint64_t types[PCCD_KINDS_MAX]; /* of these, by PCCD_NEAR_TYPE */
    uint64_t touching;
    uint64_t at_distance; /* exactly as far away as was asked for */
    uint64_t thick;       /* farther, but not by more than their radii */
    uint64_t features;
    uint64_t merged; /* pairs beyond the first of each */
    uint64_t bounds; /* below the distance */
    uint64_t crossings;
    uint64_t beside;           /* of these, beside pairs or bounds */
    uint64_t free;             /* states without an intersection */
    uint64_t parts;            /* records of incomplete answers */
    uint64_t nearest;          /* of two objects */
    uint64_t ties;             /* pairs as near as the one of these that was reported */
    uint64_t touching_objects; /* records .. */
    uint64_t crossed;          /* .. of edges that pass through faces */
    uint64_t gaps;             /* records of answers with a gap .. */
    uint64_t others;           /* .. that are not the nearest */
    uint64_t inside;           /* vertices in other objects */
    uint64_t through;          /* edges through their faces */
};

/* Print them, as a comment. */
void near_sums_tell(const struct near_sums *sums);

/* The objects of a player as the oracle takes them, by increasing id, with both ends of
 * the last motion. Valid until the player changes. */
struct near_objects {
    struct oracle_object items[PLAYER_OBJECTS_MAX];
};
void near_objects_list(const struct player *player, struct near_objects *objects);
/* Return whether two objects may meet, by their ids. `context`: the player. */
bool near_may_meet(const void *context, uint32_t a, uint32_t b);

/* Return what is wrong with an answer about that moment, whose objects are by increasing
 * id. NULL: nothing, or it would take more than `queries_max` exact decisions to know. Of
 * an answer with a gap: some pair of each two objects that have a nearest one, not much
 * farther. */
const char *near_judge(const struct oracle_moment *asked,
                       const struct eng_question *settings,
                       const struct eng_step_result *result, uint64_t queries_max,
                       struct near_sums *sums);
/* The same of the player's scene at the end of its last step that was asked about. */
const char *near_judge_player(const struct player *player,
                              const struct eng_question *settings,
                              const struct eng_step_result *result, uint64_t queries_max,
                              struct near_sums *sums);

#endif
