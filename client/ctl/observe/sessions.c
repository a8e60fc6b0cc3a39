/* sessions.c - what the clients of a daemon have and do. */
#include "sessions.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "array.h"

static void take_session(void *context, const struct pccd_session_info *info)
{
    struct sessions *sessions = context;
    void *rows = sessions->rows;
    sessions->is_short =
        sessions->is_short || !array_reserve(&rows, sessions->count, &sessions->capacity,
                                             sizeof *sessions->rows);
    sessions->rows = rows;
    if (sessions->is_short) {
        return;
    }
    struct session_row *row = &sessions->rows[sessions->count++];
    row->info = *info;
    row->info.client = NULL; /* it moves; `name` is to be used */
    snprintf(row->name, sizeof row->name, "%s", info->client);
    row->state[0] = '\0';
    if (info->waiting) {
        snprintf(row->state, sizeof row->state, "waits");
    } else if (info->batch > 0) {
        snprintf(row->state, sizeof row->state, "batch %" PRIu32 " of %" PRIu32,
                 info->batch_done, info->batch);
    }
}

int sessions_read(struct pccd_client *client, struct sessions *sessions)
{
    sessions->count = 0;
    sessions->is_short = false;
    int status = pccd_list_sessions(client, take_session, sessions);
    return status == PCCD_OK && sessions->is_short ? PCCD_E_NOMEM : status;
}

void sessions_deinit(struct sessions *sessions)
{
    free(sessions->rows);
    *sessions = (struct sessions){.rows = NULL};
}

const struct session_row *sessions_find(const struct sessions *sessions, uint64_t number)
{
    for (uint32_t i = 0; i < sessions->count; i++) {
        if (sessions->rows[i].info.session == number) {
            return &sessions->rows[i];
        }
    }
    return NULL;
}

static void take_scene(void *context, const struct pccd_scene_info *info)
{
    struct scenes *scenes = context;
    void *rows = scenes->rows;
    scenes->is_short =
        scenes->is_short ||
        !array_reserve(&rows, scenes->count, &scenes->capacity, sizeof *scenes->rows);
    scenes->rows = rows;
    if (!scenes->is_short) {
        struct scene_row *row = &scenes->rows[scenes->count++];
        row->info = *info;
        row->info.name = NULL; /* as a session's */
        snprintf(row->name, sizeof row->name, "%s", info->name);
    }
}

int scenes_read(struct pccd_client *client, uint64_t session, struct scenes *scenes)
{
    scenes->count = 0;
    scenes->is_short = false;
    int status = pccd_list_scenes(client, session, take_scene, scenes);
    return status == PCCD_OK && scenes->is_short ? PCCD_E_NOMEM : status;
}

void scenes_deinit(struct scenes *scenes)
{
    free(scenes->rows);
    *scenes = (struct scenes){.rows = NULL};
}
