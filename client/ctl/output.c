/* output.c - the files that commands write. */
#include "output.h"

#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"

static int fail(const char *path, int cause, struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                         strerror(cause));
}

int output_open(struct whole_file *file, const char *path, bool takes_stdout,
                struct ctl_error *error)
{
    bool is_stdout = takes_stdout && strcmp(path, "-") == 0;
    int cause = whole_file_open(file, is_stdout ? "/dev/stdout" : path);
    return cause == 0 ? PCCD_OK : fail(path, cause, error);
}

int output_finish(struct whole_file *file, const char *path, struct ctl_error *error)
{
    int cause = whole_file_finish(file);
    return cause == 0 ? PCCD_OK : fail(path, cause, error);
}

int output_close(struct whole_file *file, const char *path, bool is_whole,
                 struct ctl_error *error)
{
    int status =
        file->to != NULL && is_whole ? output_finish(file, path, error) : PCCD_OK;
    whole_file_discard(file);
    return status;
}

char *output_name(const char *first, const char *ending)
{
    const char *name = tool_base_name(first);
    const char *dot = strrchr(name, '.');
    size_t length = strcspn(name, "%"); /* of a pattern what is before its number */
    char *made = NULL;
    if (dot != NULL && dot > name && (size_t)(dot - name) < length) {
        length = (size_t)(dot - name);
    }
    while (length > 0 && strchr("._-", name[length - 1]) != NULL) {
        length--;
    }
    bool has_name = length > 0;
    return asprintf(&made, "%.*s%s", has_name ? (int)length : 4, has_name ? name : "pccd",
                    ending) < 0
               ? NULL
               : made;
}

bool output_json(json_t *value, bool ok, FILE *to)
{
    ok = ok && value != NULL &&
         json_dumpf(value, to, JSON_INDENT(2) | JSON_ENSURE_ASCII) == 0;
    ok = ok && fputc('\n', to) != EOF;
    json_decref(value);
    return ok;
}
