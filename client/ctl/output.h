/* output.h - the files and the JSON that commands write.
 *
 * Threads: one.
 */
#ifndef CTL_OUTPUT_H
#define CTL_OUTPUT_H

#include <jansson.h>

#include "error.h"
#include "shown.h"
#include "whole_file.h"

/* Before the work, so that a name which cannot be written is told at once. `path` may be
 * "-", the standard output, where `takes_stdout`. Errors: E_SYSTEM. */
int output_open(struct whole_file *file, const char *path, bool takes_stdout,
                struct ctl_error *error);
/* Give it its name; after an error there is none. Errors: E_SYSTEM. */
int output_finish(struct whole_file *file, const char *path, struct ctl_error *error);

/* ---- Makes a JSON string of any bytes, such as a file name that is not UTF-8. */

/* How commands print JSON for people and programs: in ASCII, so that no terminal takes a
 * part of a string for a command. */
#define JSON_TEXT_FLAGS (JSON_INDENT(2) | JSON_ENSURE_ASCII)

static inline json_t *json_text(const char *text)
{
    json_t *value = json_string(text);
    return value != NULL ? value : json_string(tool_shown(text));
}

#endif
