/* settings_file.h - the configuration file of the daemon: lines "NAME = VALUE".
 *
 * The names are those of the options, without dashes. Blank lines, and what is behind a
 * # at the beginning of a line, say nothing.
 *
 * Threads: [any]
 */
#ifndef SRV_SETTINGS_FILE_H
#define SRV_SETTINGS_FILE_H

#include <stdbool.h>
#include <stdint.h>

#define SRV_SETTINGS_LINES_MAX   128u
#define SRV_SETTINGS_NAME_BYTES  32u
#define SRV_SETTINGS_VALUE_BYTES 256u
#define SRV_SETTINGS_ERROR_BYTES 512u

struct srv_settings_line {
    uint32_t number; /* of the line, from 1 */
    bool is_refused; /* by whoever took it; false when it is read */
    char name[SRV_SETTINGS_NAME_BYTES];
    char value[SRV_SETTINGS_VALUE_BYTES];
};

struct srv_settings_file {
    uint32_t count;
    struct srv_settings_line lines[SRV_SETTINGS_LINES_MAX]; /* in their order */
};

/* Read a file. False: it cannot be read, or a line is none of these; `error` says what is
 * wrong and in which line, and `file` is half filled. */
bool srv_settings_file_read(struct srv_settings_file *file, const char *path,
                            char error[SRV_SETTINGS_ERROR_BYTES]);

/* Return the last line that a name has there; NULL: none. */
const struct srv_settings_line *
srv_settings_file_last(const struct srv_settings_file *file, const char *name);

#endif
