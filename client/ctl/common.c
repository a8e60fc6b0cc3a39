/* common.c - messages and numbers of the command line. */
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "error.h"
#include "pccd_types.h"
#include "shown.h"
#include "terminal.h"

#define MESSAGE_BYTES 4096u /* of one message; more is cut */

static const char *program_name = "pccdctl";

void ctl_name_program(const char *name)
{
    program_name = name;
}

int ctl_complain(const char *format, ...)
{
    char text[MESSAGE_BYTES];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fprintf(stderr, "%s: %s\n", program_name, tool_shown(text));
    return CTL_FAILED;
}

void ctl_error_tell(const struct ctl_error *error)
{
    if (error->text[0] != '\0') {
        ctl_complain("%s", error->text);
    }
}

enum ctl_exit ctl_exit_of(int status, bool is_right)
{
    return status == PCCD_E_NODAEMON ? CTL_NO_DAEMON
           : status != PCCD_OK       ? CTL_FAILED
           : is_right                ? CTL_DONE
                                     : CTL_NEGATIVE;
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
        tool_misused(state,
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
        tool_misused(state, "--%s: \"%s\" is not a number from %g to %g", name, text, low,
                     high);
    }
    return value;
}

/* The place of `text`, or -1 with all names written to list[bytes]. */
static int find_name(const char *text, const char *const *names, int count, char *list,
                     size_t bytes)
{
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        if (strcmp(text, names[i]) == 0) {
            return i;
        }
        int more =
            snprintf(list + used, bytes - used, "%s%s", i > 0 ? ", " : "", names[i]);
        used = more > 0 && used + (size_t)more < bytes ? used + (size_t)more : used;
    }
    return -1;
}

int ctl_option_name(const struct argp_state *state, const char *name, const char *text,
                    const char *const *names, int count)
{
    char list[256] = "";
    int found = find_name(text, names, count, list, sizeof list);
    if (found < 0) {
        tool_misused(state, "--%s: \"%s\" is none of %s", name, text, list);
    }
    return found;
}

int ctl_argument_name(const struct argp_state *state, const char *text,
                      const char *const *names, int count)
{
    char list[256] = "";
    int found = find_name(text, names, count, list, sizeof list);
    if (found < 0) {
        tool_misused(state, "\"%s\" is none of %s", text, list);
    }
    return found;
}

uint32_t ctl_option_handle(const struct argp_state *state, const char *name,
                           const char *text)
{
    char *stop;
    errno = 0;
    unsigned long long value = strtoull(text, &stop, 0);
    if (text[0] < '0' || text[0] > '9' || *stop != '\0' || errno != 0 || value == 0 ||
        value > UINT32_MAX) {
        tool_misused(state, "--%s: \"%s\" is no handle; pccdctl list shows them", name,
                     text);
    }
    return (uint32_t)value;
}

/* ---- options of every command ------------------------------------------------------ */

enum { OPTION_NO_COLOR = 256 + 32 };

static const struct argp_option common_options[] = {
    {"no-color", OPTION_NO_COLOR, NULL, 0,
     "No colours on a terminal, as with NO_COLOR in the environment", 0},
    {NULL, 'h', NULL, OPTION_HIDDEN, NULL, -1},
    {0},
};

static error_t parse_common(int key, char *text, struct argp_state *state)
{
    (void)text;
    switch (key) {
    case OPTION_NO_COLOR:
        terminal_forbid_colours();
        return 0;
    case 'h':
        argp_state_help(state, stdout, ARGP_HELP_STD_HELP);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp ctl_common_argp = {.options = common_options, .parser = parse_common};
