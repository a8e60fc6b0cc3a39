/* options.h - the command line of pccd-load.
 *
 * Threads: one.
 */
#ifndef LOAD_OPTIONS_H
#define LOAD_OPTIONS_H

#include "load.h"

/* Exit statuses, those of pccdctl. */
enum load_exit {
    LOAD_DONE = 0,
    LOAD_NEGATIVE = 1, /* something is not as it must be */
    LOAD_USAGE = 2,
    LOAD_NO_DAEMON = 3, /* none could be started or reached */
    LOAD_FAILED = 4
};

/* Ends the program where the command line is wrong or asks for help. */
void load_options_parse(int argc, char **argv, struct load_settings *settings);

#endif
