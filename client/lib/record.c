/* record.c - when a client is recorded. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "recorder.h"
#include "recorder_shared.h"

#define SEGMENTS_MAX 64u
#define LEVEL        1
#define LEVEL_MAX    19
#define BYTES_MIN    4096u /* of a segment */
#define FILES_MAX    999u  /* that $PCCD_RECORD may name one after the other */

/* ---- start and stop ---------------------------------------------------------------- */

static int check_settings(struct pccd_client *client,
                          const struct pccd_record_settings *settings)
{
    if (settings->segments > SEGMENTS_MAX || settings->level > LEVEL_MAX ||
        settings->contacts > 1 || settings->up > RECORD_UP_MASK) {
        return cli_fail(client, PCCD_E_INVAL,
                        "record: segments %u (up to %u), level %d (up to %d), contacts "
                        "%u (0 or 1), up %u (0 .. 3)",
                        settings->segments, SEGMENTS_MAX, (int)settings->level, LEVEL_MAX,
                        settings->contacts, settings->up);
    }
    if (settings->segments > 1 && settings->max_bytes == 0) {
        return cli_fail(client, PCCD_E_INVAL, "record: segments without max_bytes");
    }
    if (settings->max_bytes != 0 &&
        settings->max_bytes / (settings->segments > 1 ? settings->segments : 1) <
            BYTES_MIN) {
        return cli_fail(client, PCCD_E_INVAL, "record: max_bytes %llu is too little",
                        (unsigned long long)settings->max_bytes);
    }
    return 0;
}

static void fill_recorder(struct cli_recorder *made,
                          const struct pccd_record_settings *settings)
{
    int level = settings->level == 0 ? LEVEL : settings->level;

    made->writer.fd = -1;
    made->writer.level = level < 0 || !record_has_zstd() ? 0 : level;
    made->segments_max = settings->segments > 1 ? settings->segments : 1;
    made->segment_bytes_max = settings->max_bytes / made->segments_max;
    made->has_records = settings->contacts != 0;
    made->up = settings->up;
}

static void free_recorder(struct pccd_client *client)
{
    if (client->recorder != NULL) {
        cli_journal_stop(client);
        record_writer_deinit(&client->recorder->writer);
        free(client->recorder->path);
        free(client->recorder);
    }
    client->recorder = NULL;
}

int pccd_record_start(struct pccd_client *client, const char *path,
                      const struct pccd_record_settings *settings)
{
    const struct pccd_record_settings defaults = {.max_bytes = 0};
    struct cli_recorder *made;
    bool keeps;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (path == NULL || path[0] == '\0') {
        return cli_fail(client, PCCD_E_INVAL, "record: no path");
    }
    if (client->recorder != NULL) {
        return cli_fail(client, PCCD_E_STATE, "record: %s is being written",
                        client->recorder->path);
    }
    keeps = client->keeps;
    if (!keeps && client->has_made) {
        return cli_fail(client, PCCD_E_STATE,
                        "record: what there is was not kept (options.no_keep, "
                        "reconnect_ms, direct:); a recording can be begun before "
                        "anything is made, or by $PCCD_RECORD");
    }
    settings = settings != NULL ? settings : &defaults;
    status = check_settings(client, settings);
    if (status != 0) {
        return status;
    }
    made = calloc(1, sizeof *made);
    if (made == NULL || (made->path = strdup(path)) == NULL) {
        free(made);
        return cli_fail(client, PCCD_E_NOMEM, "record: no memory");
    }
    fill_recorder(made, settings);
    client->recorder = made;
    client->keeps = true; /* from here on, where there is nothing before */
    status = cli_record_open(client);
    if (status != 0) {
        client->keeps = keeps;
        (void)cli_fail(client, status, "%s", made->text);
        free_recorder(client);
    }
    return status;
}

int pccd_record(const struct pccd_client *client, struct pccd_record_info *info)
{
    /* The state of a call is no part of what the caller sees of a client. */
    CLI_ENTER_OR_RETURN((struct pccd_client *)(uintptr_t)client);
    if (info == NULL) {
        return PCCD_E_INVAL;
    }
    if (client->recorder == NULL) {
        return PCCD_E_STATE;
    }
    *info = client->recorder->info;
    info->bytes += client->recorder->writer.bytes;
    info->raw_bytes += client->recorder->writer.raw_bytes;
    return 0;
}

int pccd_record_stop(struct pccd_client *client, struct pccd_record_info *info)
{
    struct pccd_record_info last;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (client->recorder == NULL) {
        return cli_fail(client, PCCD_E_STATE, "record: nothing is recorded");
    }
    cli_journal_stop(client);
    if (cli_record_is_on(client)) {
        cli_record_end(client, RECORD_STOPPED);
    }
    (void)pccd_record(client, &last);
    status = last.status;
    if (status != 0) {
        (void)cli_fail(client, status, "%s", client->recorder->text);
    }
    free_recorder(client);
    if (info != NULL) {
        *info = last;
    }
    return status;
}

void cli_record_close(struct pccd_client *client)
{
    if (client->recorder != NULL) {
        (void)pccd_record_stop(client, NULL);
    }
}

/* ---- the environment --------------------------------------------------------------- */

/* "max_bytes=N,segments=N,contacts=1,level=N,up=3" */
static int parse_options(struct pccd_client *client, const char *text,
                         struct pccd_record_settings *settings)
{
    while (text != NULL && *text != '\0') {
        char name[16] = "";
        long long value = 0;
        int used = 0;

        if (sscanf(text, "%15[a-z_]=%lld%n", name, &value, &used) != 2 ||
            (text[used] != ',' && text[used] != '\0')) {
            name[0] = '\0';
        }
        text += used + (text[used] == ',');
        if (strcmp(name, "max_bytes") == 0 && value >= 0) {
            settings->max_bytes = (uint64_t)value;
        } else if (strcmp(name, "segments") == 0 && value >= 0 && value <= UINT32_MAX) {
            settings->segments = (uint32_t)value;
        } else if (strcmp(name, "contacts") == 0 && (value == 0 || value == 1)) {
            settings->contacts = (uint32_t)value;
        } else if (strcmp(name, "up") == 0 && value >= 0 && value <= RECORD_UP_MASK) {
            settings->up = (uint32_t)value;
        } else if (strcmp(name, "level") == 0 && value >= -1 && value <= LEVEL_MAX) {
            settings->level = (int32_t)value;
        } else {
            return cli_fail(client, PCCD_E_INVAL,
                            "PCCD_RECORD_OPTIONS is not max_bytes=N,segments=N,"
                            "contacts=1,level=N,up=1|2|3");
        }
    }
    return 0;
}

/* PATH, or the first of PATH-2, PATH-3, ... that does not exist: several clients of one
 * program, or several programs, record beside each other. */
static int start_beside(struct pccd_client *client, const char *path,
                        const struct pccd_record_settings *settings)
{
    size_t room = strlen(path) + 16;
    char *name = malloc(room);
    int status = PCCD_E_NOMEM;

    for (uint32_t i = 1; name != NULL; i++) {
        if (i > FILES_MAX) {
            status = cli_fail(client, PCCD_E_LIMIT,
                              "PCCD_RECORD=%.250s: this file and those that end in -2 to "
                              "-%u exist: remove some",
                              path, FILES_MAX);
            break;
        }
        (void)snprintf(name, room, i == 1 ? "%s" : "%s-%u", path, i);
        if (access(name, F_OK) != 0) {
            status = pccd_record_start(client, name, settings);
            if (status != PCCD_E_SYSTEM || access(name, F_OK) != 0) {
                break; /* else somebody has made it just now */
            }
        }
    }
    free(name);
    return status;
}

int cli_record_environment(struct pccd_client *client)
{
    struct pccd_record_settings settings = {.max_bytes = 0};
    const char *path = getenv("PCCD_RECORD");
    int status;

    if (path == NULL || path[0] == '\0') {
        return 0;
    }
    status = parse_options(client, getenv("PCCD_RECORD_OPTIONS"), &settings);
    return status != 0 ? status : start_beside(client, path, &settings);
}
