/* commandline.h - reads the command line of pccdd into the struct of options. */
#ifndef SRV_COMMANDLINE_H
#define SRV_COMMANDLINE_H

#include "options.h"

/* Fill from the command line; prints to stderr and exits on a wrong one, as argp does. */
void srv_options_parse(struct srv_options *options, int argc, char **argv);

/* Return what would end the program at its next start, in a line of the configuration
 * file; NULL: nothing, or what only that start can look at (a path, a user, a group). */
const char *srv_option_wrong(const struct srv_settings_line *line);

#endif
