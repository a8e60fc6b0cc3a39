/* turns.c - whose job runs next. */
#include "turns.h"

#include <stddef.h>

#include "invariant.h"

/* ---- turns ------------------------------------------------------------------------- */

void srv_turns_update(struct srv_turns *turns, struct srv_job_list *list)
{
    struct srv_group *group = list->group;
    bool list_waits = list->first != NULL && !list->serving && !list->is_background;
    if (list_waits && !list->turn.queued) {
        srv_fair_push(&group->lists, &list->turn);
    } else if (!list_waits && list->turn.queued) {
        srv_fair_remove(&group->lists, &list->turn);
    }
    bool group_waits = group->lists.count > 0;
    if (group_waits && !group->turn.queued) {
        srv_fair_push(&turns->groups, &group->turn);
    } else if (!group_waits && group->turn.queued) {
        srv_fair_remove(&turns->groups, &group->turn);
    }
}

/* ---- lists that wait for a claim ------------------------------------------------- */

/* A list that is taken out of its queue: its first job must wait. */
static void put_aside(struct srv_turns *turns, struct srv_job_list *list)
{
    list->is_background = true;
    list->next_aside = turns->aside;
    turns->aside = list;
}

void srv_turns_take_from_aside(struct srv_turns *turns, struct srv_job_list *list)
{
    struct srv_job_list **at = &turns->aside;
    while (*at != list) {
        at = &(*at)->next_aside;
    }
    *at = list->next_aside;
    list->is_background = false;
}

void srv_turns_empty_aside(struct srv_turns *turns)
{
    struct srv_job_list *list = turns->aside;
    turns->aside = NULL;
    while (list != NULL) {
        struct srv_job_list *next = list->next_aside;
        list->is_background = false;
        srv_turns_update(turns, list);
        list = next;
    }
}

/* ---- choosing ---------------------------------------------------------------------- */

/* The list of a group, taken out of the queue, whose turn it is; NULL: all have to wait
 * for what they claim. */
static struct srv_job_list *choose_list(struct srv_turns *turns, struct srv_group *group)
{
    while (group->lists.count > 0) {
        struct srv_job_list *list = (struct srv_job_list *)srv_fair_take(&group->lists);
        PCCD_ASSERT(list->first != NULL);
        if (srv_claims_are_free(list->first->claims, list->first->claim_count)) {
            return list;
        }
        put_aside(turns, list);
    }
    return NULL;
}

struct srv_job_list *srv_turns_choose(struct srv_turns *turns, uint32_t running,
                                      uint32_t place_max)
{
    struct srv_group *served = NULL;
    struct srv_job_list *list = NULL;
    while (list == NULL && turns->groups.count > 0) {
        struct srv_group *group = (struct srv_group *)srv_fair_take(&turns->groups);
        if (group->running > 0 && group->running + running >= place_max) {
            group->next_served = served;
            served = group;
        } else {
            list = choose_list(turns, group);
        }
    }
    for (; served != NULL; served = served->next_served) {
        srv_fair_push(&turns->groups, &served->turn);
    }
    return list;
}
