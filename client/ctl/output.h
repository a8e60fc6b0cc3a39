/* output.h - the files and the JSON that commands write. */
#ifndef CTL_OUTPUT_H
#define CTL_OUTPUT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "error.h"
#include "shown.h"
#include "whole_file.h"

/* Open a file before the work, so that a name which cannot be written is told at once.
 * `path` may be "-", the standard output, where `takes_stdout`. Errors: E_SYSTEM. */
int output_open(struct whole_file *file, const char *path, bool takes_stdout,
                struct ctl_error *error);
/* Give it its name; after an error there is none. Errors: E_SYSTEM. */
int output_finish(struct whole_file *file, const char *path, struct ctl_error *error);

/* Give it its name only if it `is_whole`; then let go of it, also if it was never opened.
 * Errors: E_SYSTEM, also when something could not be written earlier. */
int output_close(struct whole_file *file, const char *path, bool is_whole,
                 struct ctl_error *error);

/* Return the name of a file to write whose name nobody gave: that of the first file or
 * program, without folders, its ending and the number of a pattern, in the current
 * folder. The caller's to free; NULL: no memory. */
char *output_name(const char *first, const char *ending);

/* ---- Makes JSON, and prints it. */

/* Return text of any bytes as a string; what is not UTF-8, as a file name may be, is
 * written as tool_shown shows it. NULL: no memory. */
static inline json_t *json_text(const char *text)
{
    json_t *value = json_string(text);
    return value != NULL ? value : json_string(tool_shown(text));
}

/* Set a member to a value that is ours to give. jansson takes the value also where it
 * fails, and fails on a NULL value, so `ok` is all that has to be looked at. */
static inline void json_set(json_t *object, const char *key, json_t *value, bool *ok)
{
    if (json_object_set_new(object, key, value) != 0) {
        *ok = false;
    }
}

static inline void json_set_count(json_t *object, const char *key, uint64_t value,
                                  bool *ok)
{
    json_set(object, key, json_integer((json_int_t)value), ok);
}

/* Append a value as json_set sets one. */
static inline void json_append(json_t *array, json_t *value, bool *ok)
{
    if (json_array_append_new(array, value) != 0) {
        *ok = false;
    }
}

/* Print an object or array that is ours to give back, and a newline: in ASCII, so that no
 * terminal takes a part of a string for a command. NULL or !ok: there was no memory for
 * all of it. False if it was not printed. */
bool output_json(json_t *value, bool ok, FILE *to);

#endif
