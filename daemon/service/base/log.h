/* log.h - the daemon's log.
 *
 * Write one line to stderr per event: ISO time, level, session, text; or a JSON object
 * with these as "time", "level", "session" (left out if it is about none) and "message".
 * Limit each kind of line that clients can cause as often as they like: a number at once,
 * then some a second; say how many were left out. Say, too, how many could not be
 * written, once that can be.
 *
 * Threads: [any]; a line is one write, so lines never mix.
 */
#ifndef SRV_LOG_H
#define SRV_LOG_H

#include <stdbool.h>
#include <stdint.h>

enum srv_level {
    SRV_LOG_ERROR = 0, /* the daemon or the machine cannot do what it should */
    SRV_LOG_WARN = 1,  /* a peer was refused or dropped */
    SRV_LOG_INFO = 2,  /* starts, ends, sessions */
    SRV_LOG_DEBUG = 3, /* every refused request */
    SRV_LOG_COUNT = 4
};

/* Drop lines above `level` from now on. */
void srv_log_set_level(enum srv_level level);

/* Return the level of that name ("error", "warn", "info", "debug"), or -1. */
int srv_log_level_by_name(const char *name);

/* The form of lines from now on. */
enum srv_log_format { SRV_LOG_TEXT = 0, SRV_LOG_JSON = 1 };
void srv_log_set_format(enum srv_log_format format);
bool srv_log_is_json(void);

/* Append to that file, which is made if there is none, instead of what stderr leads to;
 * `path` stays the caller's. Returns 0, or an errno: it cannot be opened, and lines go
 * where they went. */
int srv_log_open(const char *path);
/* Open it anew, as it may have been renamed: what is wrong is logged. Without a file do
 * nothing. */
void srv_log_reopen(void);

/* Say that it writes to a file that nobody else keeps: it begins anew when it has become
 * longer than that. */
void srv_log_own_file(uint32_t bytes_max);

/* Write a line. `session` 0: not about one. Control characters, and what is not UTF-8,
 * are written as \xNN, because some of it comes from peers. */
void srv_log(enum srv_level level, uint64_t session, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The lines of a kind, which is what has the same `format`, at the levels of warnings and
 * of infos: so many at once, and then so many a second. */
#define SRV_LOG_BURST 100u
#define SRV_LOG_PER_S 10u

/* Return how many lines could not be written, as the disk was full or nobody read. */
uint64_t srv_log_lost(void);

/* Write a line in the handler of a fatal signal, if the form is JSON: no memory is asked
 * for. False: it is text, or the line could not be written. */
bool srv_log_last_words(const char *said);

/* Return whether lines were left out that nobody has been told of. Costs one load. */
bool srv_log_owes_report(void);
/* Say how many, a line a kind. */
void srv_log_report(void);

#endif
