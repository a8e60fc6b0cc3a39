/* client/ctl/common.c - messages and numbers of the command line.
 *
 * Room:     client/ctl.
 * Does:     what every command does in the same way.
 * Does not: talk to a daemon; see link.c.
 * Threads:  one.
 * Source:   ctl.h.
 */
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "ctl.h"

int ctl_complain(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("pccdctl: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    return CTL_FAILED;
}

uint64_t ctl_option_count(const struct argp_state *state, const char *name,
                          const char *text, uint64_t low, uint64_t high)
{
    char *stop;
    errno = 0;
    /* strtoull takes a minus sign; only digits are meant here. */
    unsigned long long value = strtoull(text, &stop, 10);
    if (text[0] < '0' || text[0] > '9' || *stop != '\0' || errno != 0 || value < low ||
        value > high) {
        argp_error(state,
                   "--%s: \"%s\" is not a whole number from %" PRIu64 " to %" PRIu64,
                   name, text, low, high);
    }
    return value;
}

double ctl_option_real(const struct argp_state *state, const char *name, const char *text,
                       double low, double high)
{
    char *stop;
    double value = strtod(text, &stop);
    if (stop == text || *stop != '\0' || !(value >= low && value <= high)) {
        argp_error(state, "--%s: \"%s\" is not a number from %g to %g", name, text, low,
                   high);
    }
    return value;
}
