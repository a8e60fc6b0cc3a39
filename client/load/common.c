/* common.c - the clock, and what is said. */
#include <stdarg.h>
#include <stdio.h>
#include <time.h>

#include "load.h"
#include "shown.h"

/* What one process may say: after that it only counts. */
#define LINES_MAX 20u

void load_sleep_ms(uint32_t ms)
{
    struct timespec pause = {ms / 1000, ms % 1000 * 1000000L};
    nanosleep(&pause, NULL);
}

void load_say(const char *format, ...)
{
    static unsigned said; /* of this process */
    char line[1024];
    if (++said > LINES_MAX) {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    fprintf(stderr, "pccd-load: %s%s\n", tool_shown(line),
            said == LINES_MAX ? " (and so on)" : "");
}
