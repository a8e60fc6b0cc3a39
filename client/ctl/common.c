/* common.c - messages and options of every command. */
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

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

void ctl_take_handle(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to)
{
    char *stop;
    errno = 0;
    bool is_hexadecimal = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
    unsigned long long value = strtoull(text, &stop, is_hexadecimal ? 16 : 10);
    if (text[0] < '0' || text[0] > '9' || *stop != '\0' || errno != 0 || value == 0 ||
        value > UINT32_MAX) {
        option_misused(state, "--%s: \"%s\" is no handle; pccdctl list shows them",
                       row->name, text);
    }
    *(uint32_t *)((char *)to + row->at) = (uint32_t)value;
}

static void take_no_color(struct argp_state *state, const struct option_row *row,
                          const char *text, void *to)
{
    (void)state;
    (void)row;
    (void)text;
    (void)to;
    terminal_forbid_colours();
}

const struct option_table ctl_common_table = {
    .name = "",
    .rows = (const struct option_row[]){
        CTL_OUTPUT,
        {"no-color",
         .help = "No colours on a terminal, as with NO_COLOR in the environment",
         .type = OPTION_OWN, .take = take_no_color},
        {0}}};
