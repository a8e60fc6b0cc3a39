/* log.h - what the daemon says about itself.
 *
 * Room:     service. May include: the C library.
 * Does:     one line to stderr per event: ISO time, level, session, text.
 * Does not: rotate, buffer or filter by anything but the level, or wait: what stderr has
 *           no room for is lost.
 * Threads:  [any]; a line is one write, so lines never mix.
 */
#ifndef SRV_LOG_H
#define SRV_LOG_H

#include <stdint.h>

enum srv_level {
    SRV_LOG_ERROR = 0, /* the daemon or the machine cannot do what it should */
    SRV_LOG_WARN = 1,  /* a peer was refused or dropped */
    SRV_LOG_INFO = 2,  /* starts, ends, sessions */
    SRV_LOG_DEBUG = 3, /* every refused request */
    SRV_LOG_COUNT = 4
};

/* Lines above `level` are dropped from now on. */
void srv_log_set_level(enum srv_level level);

/* The level of that name ("error", "warn", "info", "debug"), or -1. */
int srv_log_level_by_name(const char *name);

/* `session` 0: not about one. Control characters in the text are shown as '?', because
 * some of it comes from peers. */
void srv_log(enum srv_level level, uint64_t session, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
