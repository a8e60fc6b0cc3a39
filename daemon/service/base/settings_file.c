/* settings_file.c - the configuration file of the daemon. */
#include "settings_file.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define LINE_BYTES (SRV_SETTINGS_NAME_BYTES + SRV_SETTINGS_VALUE_BYTES + 64u)

/* Return where the text begins that is left without blanks around it. */
static char *trim(char *text)
{
    size_t length = strlen(text);
    while (length > 0 && isspace((unsigned char)text[length - 1])) {
        text[--length] = '\0';
    }
    return text + strspn(text, " \t");
}

/* Return what is wrong with a line that has something to say; NULL: it was taken. */
static const char *take_line(struct srv_settings_file *file, char *text, uint32_t number)
{
    char *equals = strchr(text, '=');
    if (equals == NULL) {
        return "is not NAME = VALUE";
    }
    *equals = '\0';
    const char *name = trim(text);
    const char *value = trim(equals + 1);
    struct srv_settings_line *line = &file->lines[file->count];
    if (name[0] == '\0' || strlen(name) >= sizeof line->name) {
        return "has no name of 1 to 31 bytes before the =";
    }
    if (value[0] == '\0' || strlen(value) >= sizeof line->value) {
        return "has no value of 1 to 255 bytes behind the =";
    }
    if (file->count == SRV_SETTINGS_LINES_MAX) {
        return "is one too many: there may be 128 settings";
    }
    strcpy(line->name, name);
    strcpy(line->value, value);
    line->number = number;
    line->is_refused = false;
    file->count++;
    return NULL;
}

bool srv_settings_file_read(struct srv_settings_file *file, const char *path,
                            char error[SRV_SETTINGS_ERROR_BYTES])
{
    char text[LINE_BYTES];
    const char *wrong = NULL;
    uint32_t number = 0;
    struct stat found;
    file->count = 0;
    if (stat(path, &found) == 0 && S_ISFIFO(found.st_mode)) { /* would keep us waiting */
        snprintf(error, SRV_SETTINGS_ERROR_BYTES, "%s: a pipe cannot be read again",
                 path);
        return false;
    }
    FILE *from = fopen(path, "re"); /* with the flags that the sandbox allows */
    while (from != NULL && wrong == NULL && fgets(text, sizeof text, from) != NULL) {
        const char *said = text + strspn(text, " \t\r\n");
        number++;
        if (strchr(text, '\n') == NULL && !feof(from)) {
            wrong = "is too long, or holds a zero byte";
        } else if (*said != '\0' && *said != '#') {
            wrong = take_line(file, text, number);
        }
    }
    if (wrong != NULL) {
        snprintf(error, SRV_SETTINGS_ERROR_BYTES, "%s:%u: the line %s", path, number,
                 wrong);
    } else if (from == NULL || ferror(from)) {
        wrong = strerror(errno);
        snprintf(error, SRV_SETTINGS_ERROR_BYTES, "%s: %s", path, wrong);
    }
    if (from != NULL) {
        fclose(from);
    }
    return wrong == NULL;
}

const struct srv_settings_line *
srv_settings_file_last(const struct srv_settings_file *file, const char *name)
{
    const struct srv_settings_line *last = NULL;
    for (uint32_t i = 0; i < file->count; i++) {
        last = strcmp(file->lines[i].name, name) == 0 ? &file->lines[i] : last;
    }
    return last;
}
