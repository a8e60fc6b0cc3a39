/* turns.c - whose job runs next. */
#include "turns.h"

#include <stddef.h>

#include "invariant.h"

/* ---- turns ------------------------------------------------------------------------- */

void srv_turns_update(struct srv_turns *turns, struct srv_lane *lane)
{
    struct srv_group *group = lane->group;
    bool lane_waits = lane->first != NULL && !lane->serving && !lane->is_background;
    if (lane_waits && !lane->turn.queued) {
        srv_fair_push(&group->lanes, &lane->turn);
    } else if (!lane_waits && lane->turn.queued) {
        srv_fair_remove(&group->lanes, &lane->turn);
    }
    bool group_waits = group->lanes.count > 0;
    if (group_waits && !group->turn.queued) {
        srv_fair_push(&turns->groups, &group->turn);
    } else if (!group_waits && group->turn.queued) {
        srv_fair_remove(&turns->groups, &group->turn);
    }
}

/* ---- lanes that wait for a claim --------------------------------------------------- */

/* A lane that is taken out of its queue: its first job must wait. */
static void put_aside(struct srv_turns *turns, struct srv_lane *lane)
{
    lane->is_background = true;
    lane->next_aside = turns->aside;
    turns->aside = lane;
}

void srv_turns_take_from_aside(struct srv_turns *turns, struct srv_lane *lane)
{
    struct srv_lane **at = &turns->aside;
    while (*at != lane) {
        at = &(*at)->next_aside;
    }
    *at = lane->next_aside;
    lane->is_background = false;
}

void srv_turns_empty_aside(struct srv_turns *turns)
{
    struct srv_lane *lane = turns->aside;
    turns->aside = NULL;
    while (lane != NULL) {
        struct srv_lane *next = lane->next_aside;
        lane->is_background = false;
        srv_turns_update(turns, lane);
        lane = next;
    }
}

/* ---- choosing ---------------------------------------------------------------------- */

/* The lane of a group, taken out of the queue, whose turn it is; NULL: all have to wait
 * for what they claim. */
static struct srv_lane *choose_lane(struct srv_turns *turns, struct srv_group *group)
{
    while (group->lanes.count > 0) {
        struct srv_lane *lane = (struct srv_lane *)srv_fair_take(&group->lanes);
        PCCD_ASSERT(lane->first != NULL);
        if (srv_claims_are_free(lane->first->claims, lane->first->claim_count)) {
            return lane;
        }
        put_aside(turns, lane);
    }
    return NULL;
}

struct srv_lane *srv_turns_choose(struct srv_turns *turns, uint32_t running,
                                  uint32_t place_max)
{
    struct srv_group *served = NULL;
    struct srv_lane *lane = NULL;
    while (lane == NULL && turns->groups.count > 0) {
        struct srv_group *group = (struct srv_group *)srv_fair_take(&turns->groups);
        if (group->running > 0 && group->running + running >= place_max) {
            group->next_served = served;
            served = group;
        } else {
            lane = choose_lane(turns, group);
        }
    }
    for (; served != NULL; served = served->next_served) {
        srv_fair_push(&turns->groups, &served->turn);
    }
    return lane;
}
