/* run_ctl.c - pccdctl, run by a test. */
#include "run_ctl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "cases.h"

int test_ctl(const char *command, const char *options, const char *file, char *said,
             size_t room)
{
    char line[512];
    FILE *from;
    size_t got;
    int status;

    (void)snprintf(line, sizeof line,
                   "unset PCCD_URL PCCD_RECORD; timeout 120 \"$PCCDCTL\" %s %s %s 2>&1",
                   command, options, file);
    from = popen(line, "r");
    if (from == NULL) {
        return -1;
    }
    got = fread(said, 1, room - 1, from);
    said[got] = '\0';
    status = pclose(from);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void test_ctl_says(int status, const char *command, const char *options, const char *file,
                   ...)
{
    char said[8192];
    int got = test_ctl(command, options, file, said, sizeof said);
    va_list texts;

    va_start(texts, file);
    const char *text = "";
    do {
        if (got != status || strstr(said, text) == NULL) {
            fail_msg("%s %s %s: %d where %d is due, without \"%s\": %s", command, options,
                     file, got, status, text, said);
        }
        text = va_arg(texts, const char *);
    } while (text != NULL);
    va_end(texts);
}

uint64_t test_ctl_number(const char *said, const char *name)
{
    char key[64];
    const char *at;

    (void)snprintf(key, sizeof key, "\"%s\": ", name);
    at = strstr(said, key);
    return at != NULL ? strtoull(at + strlen(key), NULL, 10) : UINT64_MAX;
}
