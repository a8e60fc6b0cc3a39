/* health.c - what a daemon's counters say is wrong. */
#include "counters.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

#include "printable.h"

/* More that wait are seconds of work, whatever they are. */
#define QUEUE_MAX 1000u

static void __attribute__((format(printf, 2, 3)))
say(struct health *health, const char *format, ...)
{
    va_list arguments;
    if (health->count == HEALTH_MAX) {
        return;
    }
    va_start(arguments, format);
    vsnprintf(health->text[health->count++], HEALTH_TEXT_BYTES, format, arguments);
    va_end(arguments);
}

void health_judge(const struct counters *counters, struct health *health)
{
    uint64_t queued = counters_get(counters, "jobs_queued_now");
    uint64_t denied = counters_get(counters, "sessions_denied");
    uint64_t refused = counters_get(counters, "sessions_refused") - denied;
    uint64_t torn = counters_get(counters, "slots_torn");
    uint64_t stale = counters_get(counters, "slots_stale");
    uint64_t unlogged = counters_get(counters, "log_lines_lost");
    uint64_t errors = counters_get(counters, "errors");
    uint64_t messages = counters_get(counters, "messages");
    uint64_t steps = counters_get(counters, "steps");
    uint64_t incomplete = counters_get(counters, "steps_incomplete");
    health->count = 0;
    if (queued > QUEUE_MAX) {
        say(health, "%" PRIu64 " %s: pccdctl top tells whose", queued,
            proto_plural(queued, "request waits", "requests wait"));
    }
    if (denied > 0) {
        say(health,
            "%" PRIu64 " %s of users whom pccdd --allow-uid and --allow-gid do not name",
            denied, proto_plural(denied, "connection was", "connections were"));
    }
    if (refused > 0) {
        say(health,
            "%" PRIu64 " %s refused: pccdctl config set clients-max N admits more",
            refused, proto_plural(refused, "connection was", "connections were"));
    }
    if (torn + stale > 0) {
        say(health,
            "%" PRIu64 " %s while being read: a client writes into slots that it has "
            "submitted",
            torn + stale, proto_plural(torn + stale, "slot changed", "slots changed"));
    }
    if (unlogged > 0) {
        say(health,
            "%" PRIu64 " %s of the log could not be written: is there room on the disk?",
            unlogged, proto_plural(unlogged, "line", "lines"));
    }
    if (messages > 100 && errors > messages / 100) {
        say(health,
            "%" PRIu64 " of %" PRIu64 " requests failed: pccdctl config set log-level "
            "debug lets the daemon log why",
            errors, messages);
    }
    if (steps > 100 && incomplete > steps / 10) {
        say(health,
            "%" PRIu64 " of %" PRIu64 " steps were incomplete: deadlines are too short, "
            "or result regions too small",
            incomplete, steps);
    }
}
