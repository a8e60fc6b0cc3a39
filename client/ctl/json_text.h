/* json_text.h - makes a JSON string of any bytes, such as a file name that is not UTF-8.
 *
 * Threads: one.
 */
#ifndef CTL_JSON_TEXT_H
#define CTL_JSON_TEXT_H

#include <jansson.h>

#include "shown.h"

/* How commands print JSON for people and programs: in ASCII, so that no terminal takes a
 * part of a string for a command. */
#define JSON_TEXT_FLAGS (JSON_INDENT(2) | JSON_ENSURE_ASCII)

static inline json_t *json_text(const char *text)
{
    json_t *value = json_string(text);
    return value != NULL ? value : json_string(tool_shown(text));
}

#endif
