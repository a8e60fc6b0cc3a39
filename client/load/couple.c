/* couple.c - a client that shares its scene with a second one of the same process. */
#include "actor.h"

#include <stdio.h>
#include <unistd.h>

int load_couple_open(struct load_actor *actor, const struct pccd_options *options)
{
    static uint32_t names; /* one that was left may still be there */
    char name[64];
    snprintf(name, sizeof name, "pccd-load %ld.%u.%u", (long)getpid(), actor->number,
             ++names);
    struct pccd_scene_settings settings = {.name = name, .share = PCCD_SHARE_CREATE};
    int status = pccd_scene_create(actor->client, &settings, &actor->scene);
    status = status == 0 ? pccd_connect(options, &actor->second) : status;
    if (status != 0) {
        return status;
    }
    actor->tally->opened++;
    /* Whoever comes back first after a crash makes it: else the second would wait there
     * for the first, which has to wait for the second's call to return. */
    settings.share = PCCD_SHARE_OPEN;
    return pccd_scene_create(actor->second, &settings, &actor->second_scene);
}

static uint64_t reconnects(const struct load_actor *actor)
{
    struct pccd_link_info first;
    struct pccd_link_info second;
    return pccd_link(actor->client, &first) == 0 && pccd_link(actor->second, &second) == 0
               ? (uint64_t)first.reconnects + second.reconnects
               : 0;
}

/* The daemon may have been killed before the sheet was added: the next one may have given
 * the sheet the floor's number, and one of the two that come back cannot have its own. */
int load_couple_settle(struct load_actor *actor)
{
    uint64_t before;
    int status;
    do {
        before = reconnects(actor);
        status = pccd_ping(actor->second, NULL);
        status = status == 0 ? pccd_ping(actor->client, NULL) : status;
    } while (status == 0 && reconnects(actor) != before);
    return status;
}

void load_couple_close(struct load_actor *actor)
{
    pccd_close(actor->second);
    actor->second = NULL;
    actor->second_step = 0;
    actor->is_held_answered = false;
    actor->is_masked = false;
}

/* Told again to another daemon, too: a pair with another client's object would not be. */
int load_couple_set(struct load_actor *actor, bool may_meet)
{
    struct pccd_object_settings settings = {.what = PCCD_OBJECT_MASK | PCCD_OBJECT_SELF,
                                            .self_collision = may_meet,
                                            .mask = may_meet ? UINT64_MAX : 0};
    if (actor->is_masked == !may_meet) {
        return 0;
    }
    actor->is_masked = !may_meet;
    return pccd_object_set(actor->client, actor->scene, actor->sheet, &settings);
}

int load_couple_step(struct load_actor *actor)
{
    int mode = actor->load->settings.mode;
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings),
        .mode = mode >= 0 ? (enum pccd_mode)mode : PCCD_MODE_ALL};
    int status = pccd_submit_still(actor->second, actor->second_scene, &settings,
                                   &actor->second_step);
    return status == PCCD_E_BUSY ? PCCD_E_STATE : status; /* nothing of it is in flight */
}

/* Both have come, or the second's is of another daemon than the first's was. */
static void judge(struct load_actor *actor, const struct pccd_answer *records)
{
    struct pccd_answer answer = actor->held_answer;
    bool is_one = records->number == answer.number &&
                  records->hash[0] == answer.hash[0] &&
                  records->hash[1] == answer.hash[1];
    if (is_one) {
        answer = *records;
        answer.step = actor->held_answer.step;
    }
    actor->is_held_answered = false;
    load_judge(actor, &answer);
}

int load_couple_take(struct load_actor *actor, bool *moved)
{
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_answer records = PCCD_ANSWER_INIT;
    /* In this order: what a step took along is answered before the step. */
    int status =
        actor->second_step != 0 ? pccd_poll(actor->second, &records) : PCCD_E_AGAIN;
    bool has_records = status == 0;
    if (status != 0 && status != PCCD_E_AGAIN) {
        return status;
    }
    status = pccd_poll(actor->client, &held);
    if (status == 0) {
        actor->held_answer = held;
        actor->is_held_answered = true;
        pccd_answer_release(actor->client, &held);
    } else if (status != PCCD_E_AGAIN) {
        return status;
    }
    *moved = *moved || has_records || status == 0;
    if (!has_records) {
        return 0;
    }
    actor->second_step = 0;
    actor->is_blocked = false;
    status = records.status;
    if (status == 0 && actor->is_held_answered) {
        judge(actor, &records);
    } else if (status == 0 &&
               actor->pending_count > 0) { /* it came before what was held */
        status = load_couple_step(actor);
    }
    pccd_answer_release(actor->second, &records);
    return status;
}
