/* config.c - settings of a daemon that may change while it runs; config.get and .set.
 *
 * Threads: [loop]. Threads that compute read some of the values: those are atomic.
 */
#include "config.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "call.h"
#include "invariant.h"
#include "log.h"
#include "service.h"
#include "session.h"
#include "settings.h"

enum setting {
#define ENUM(ID, ...) SETTING_##ID,
    SRV_SETTINGS(ENUM)
#undef ENUM
        SETTING_COUNT
};

_Static_assert(SETTING_COUNT <= SRV_CONFIG_KEPT_MAX, "all of them can be kept");

static const struct {
    const char *name;
    uint64_t least;
    uint64_t most; /* 0: the value at the start */
    const char *text, *later;
} settings[SETTING_COUNT] = {
#define START(most) 0
#define ROW(ID, name, letter, argument, form, member, least, most, unit, text, later,    \
            first)                                                                       \
    {name, least, most, text, later},
    SRV_SETTINGS(ROW)
#undef ROW
#undef START
};

static const char *const level_names[SRV_LOG_COUNT] = {"error", "warn", "info", "debug"};

/* The place of a setting in their order; SETTING_COUNT: there is none. */
static uint32_t find(const char *name)
{
    uint32_t index = 0;
    while (index < SETTING_COUNT && strcmp(settings[index].name, name) != 0) {
        index++;
    }
    return index;
}

static uint64_t read_value(const struct srv_options *options, enum setting setting)
{
    switch (setting) {
#define READ(ID, name, letter, argument, form, member, least, most, unit, ...)           \
    case SETTING_##ID:                                                                   \
        return (uint64_t)options->member / (unit);
        SRV_SETTINGS(READ)
#undef READ
    case SETTING_COUNT:
        break;
    }
    return 0;
}

/* In range. */
static void write_value(struct srv_service *service, enum setting setting, uint64_t value)
{
    struct srv_options *live = &service->live;
    switch (setting) {
#define TYPE_u32   uint32_t
#define TYPE_u64   uint64_t
#define TYPE_level enum srv_level
#define WRITE(ID, name, letter, argument, form, member, least, most, unit, ...)          \
    case SETTING_##ID:                                                                   \
        live->member = (TYPE_##form)(value * (unit));                                    \
        break;
        SRV_SETTINGS(WRITE)
#undef WRITE
    case SETTING_COUNT:
        break;
    }
    /* Others are looked at when they are needed. */
    switch (setting) {
    case SETTING_LOG_LEVEL:
        srv_log_set_level(live->log_level);
        break;
    case SETTING_QUEUE:
        srv_compute_resize(&service->compute, live->queue_max);
        srv_compute_resize(&service->pages, live->queue_max);
        break;
    case SETTING_CLIENTS:
    case SETTING_SHM:
    case SETTING_MESHES:
    case SETTING_TRIANGLES:
        for (int kind = 0; kind < SRV_QUOTA_COUNT; kind++) {
            srv_quota_set_limit(&service->quota, (enum srv_quota_kind)kind,
                                live->quota[kind]);
        }
        break;
    case SETTING_MEMORY:
        srv_quota_bound_engine(&service->quota, live->engine_bytes_max);
        break;
    case SETTING_MEMORY_TOTAL:
        srv_quota_bound_memory(&service->quota, live->memory_total_max);
        break;
    default:
        break;
    }
}

static uint64_t most_of(const struct srv_service *service, enum setting setting)
{
    uint64_t most = settings[setting].most;
    return most != 0 ? most : read_value(service->start_options, setting);
}

static void print_value(uint64_t value, enum setting setting, char *text, size_t bytes)
{
    if (setting == SETTING_LOG_LEVEL) {
        snprintf(text, bytes, "%s", level_names[value]);
    } else {
        snprintf(text, bytes, "%llu", (unsigned long long)value);
    }
}

/* Everything but `count`. */
static void describe(const struct srv_service *service, uint32_t index,
                     struct proto_CONFIG_GET_result *result)
{
    srv_assert_loop();
    PCCD_ASSERT(index < SETTING_COUNT);
    enum setting setting = (enum setting)index;
    uint64_t value = read_value(service->options, setting);
    snprintf(result->name, sizeof result->name, "%s", settings[index].name);
    snprintf(result->text, sizeof result->text, "%s%s", settings[index].text,
             settings[index].later);
    print_value(value, setting, result->value, sizeof result->value);
    result->changed = value != read_value(service->start_options, setting);
}

/* A number from its first to its last character, or the name of a level. */
static bool parse_value(const char *text, enum setting setting, uint64_t *value)
{
    if (setting == SETTING_LOG_LEVEL) {
        int level = srv_log_level_by_name(text);
        *value = (uint64_t)level;
        return level >= 0;
    }
    char *end = NULL;
    errno = 0;
    *value = strtoull(text, &end, 10);
    return text[0] >= '0' && text[0] <= '9' && *end == '\0' && errno == 0;
}

/* Returns 0, PCCD_E_INVAL with *error set: no such value. */
static int set(struct srv_service *service, uint32_t index, const char *text,
               struct proto_error *error)
{
    srv_assert_loop();
    PCCD_ASSERT(index < SETTING_COUNT);
    enum setting setting = (enum setting)index;
    uint64_t least = settings[index].least;
    uint64_t most = most_of(service, setting);
    uint64_t value = 0;
    if (!parse_value(text, setting, &value)) {
        return proto_error_set(error, PCCD_E_INVAL, "%s: \"%.64s\" is not %s",
                               settings[index].name, text,
                               setting == SETTING_LOG_LEVEL ? "error, warn, info or debug"
                                                            : "a whole number");
    }
    if (value < least || value > most) {
        return proto_error_set(error, PCCD_E_INVAL, "%s: %llu is not from %llu to %llu",
                               settings[index].name, (unsigned long long)value,
                               (unsigned long long)least, (unsigned long long)most);
    }
    write_value(service, setting, value);
    if (service->kept != NULL) {
        atomic_store(&service->kept->plus_one[index], value + 1);
    }
    return 0;
}

void srv_config_restore(struct srv_service *service, struct srv_config_kept *kept)
{
    srv_assert_loop();
    service->kept = kept;
    for (uint32_t i = 0; i < SETTING_COUNT && kept != NULL; i++) {
        enum setting setting = (enum setting)i;
        uint64_t value = atomic_load(&kept->plus_one[i]) - 1;
        if (value != UINT64_MAX && value >= settings[i].least &&
            value <= most_of(service, setting)) {
            char text[32];
            write_value(service, setting, value);
            print_value(value, setting, text, sizeof text);
            srv_log(SRV_LOG_INFO, 0, "%s: %s, as before the crash", settings[i].name,
                    text);
        }
    }
}

/* Take a line of the configuration file, or mark it as refused. */
static void reload_line(struct srv_service *service, srv_setting_check check,
                        struct srv_settings_line *line)
{
    struct proto_error error = {0};
    uint32_t index = find(line->name);
    const char *wrong = index == SETTING_COUNT ? check(line) : NULL;
    if (wrong != NULL) {
        line->is_refused = true;
        srv_log(SRV_LOG_ERROR, 0, "%s:%u: %s: %s; pccdd does not start with that",
                service->options->config_path, line->number, line->name, wrong);
    } else if (index == SETTING_COUNT) {
        srv_log(SRV_LOG_WARN, 0, "%s:%u: %s: this holds after a restart",
                service->options->config_path, line->number, line->name);
    } else if (set(service, index, line->value, &error) != 0) {
        line->is_refused = true;
        srv_log(SRV_LOG_ERROR, 0, "%s:%u: %s; it stays as it was",
                service->options->config_path, line->number, error.text);
    } else {
        srv_log(SRV_LOG_INFO, 0, "%s: %s, by the configuration file", line->name,
                line->value);
    }
}

/* Return whether a file has said the same as that line, and was heard: of a setting, the
 * last word counts; another option may stand there several times. */
static bool says(const struct srv_settings_file *file,
                 const struct srv_settings_line *line)
{
    const struct srv_settings_line *last = srv_settings_file_last(file, line->name);
    bool does =
        last != NULL && !last->is_refused && strcmp(last->value, line->value) == 0;
    for (uint32_t i = 0; i < file->count && find(line->name) == SETTING_COUNT; i++) {
        does = does || (!file->lines[i].is_refused &&
                        strcmp(file->lines[i].name, line->name) == 0 &&
                        strcmp(file->lines[i].value, line->value) == 0);
    }
    return does;
}

/* Return whether a line that was there leaves nothing of its kind behind. */
static bool is_gone(const struct srv_settings_file *now,
                    const struct srv_settings_line *line)
{
    return find(line->name) < SETTING_COUNT
               ? srv_settings_file_last(now, line->name) == NULL
               : !says(now, line);
}

void srv_config_reload(struct srv_service *service, srv_setting_check check)
{
    static struct srv_settings_file now;
    char error[SRV_SETTINGS_ERROR_BYTES];
    struct srv_settings_file *last = service->options->config;
    srv_assert_loop();
    if (!srv_settings_file_read(&now, service->options->config_path, error)) {
        srv_log(SRV_LOG_ERROR, 0, "%s; all stays as it was", error);
        return;
    }
    for (uint32_t i = 0; i < now.count; i++) {
        if (!says(last, &now.lines[i]) && says(&now, &now.lines[i])) {
            reload_line(service, check, &now.lines[i]);
        }
    }
    for (uint32_t i = 0; i < last->count; i++) {
        if (!last->lines[i].is_refused && is_gone(&now, &last->lines[i])) {
            srv_log(SRV_LOG_WARN, 0,
                    "%s = %s: no longer in %s; it stays as it was until a restart",
                    last->lines[i].name, last->lines[i].value,
                    service->options->config_path);
        }
    }
    *last = now;
}

/* ---- the messages ------------------------------------------------------------------ */

static int find_setting(struct srv_call *call, const char *name, uint32_t *index)
{
    *index = find(name);
    return *index < SETTING_COUNT
               ? 0
               : proto_error_set(&call->error, PCCD_E_INVAL,
                                 "there is no setting \"%.64s\"", name);
}

int srv_on_CONFIG_GET(struct srv_call *call)
{
    const struct proto_CONFIG_GET_request *request = &call->params.CONFIG_GET;
    uint32_t index = request->index;
    int status = request->name[0] != '\0' ? find_setting(call, request->name, &index) : 0;
    if (status != 0) {
        return status;
    }
    if (index >= SETTING_COUNT) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "setting %u is wanted, there are %u", index,
                               SETTING_COUNT);
    }
    call->result.CONFIG_GET.count = SETTING_COUNT;
    describe(call->session->service, index, &call->result.CONFIG_GET);
    return 0;
}

int srv_on_CONFIG_SET(struct srv_call *call)
{
    const struct proto_CONFIG_SET_request *request = &call->params.CONFIG_SET;
    struct srv_service *service = call->session->service;
    struct proto_CONFIG_GET_result before;
    uint32_t index = 0;
    int status = srv_session_refuse_stranger(call->session, &call->error);
    if (status == 0) {
        status = find_setting(call, request->name, &index);
    }
    if (status != 0) {
        return status;
    }
    describe(service, index, &before);
    status = set(service, index, request->value, &call->error);
    if (status == 0) {
        memcpy(call->result.CONFIG_SET.before, before.value, sizeof before.value);
        srv_log(SRV_LOG_INFO, call->session->id, "%s: %s, was %s", request->name,
                request->value, before.value);
    }
    return status;
}
