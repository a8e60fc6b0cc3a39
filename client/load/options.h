/* options.h - what the command line of pccd-load says.
 *
 * Room:     client/load. May include: load.h.
 * Does:     the table of options (--help), and settings from it.
 * Threads:  one.
 */
#ifndef LOAD_OPTIONS_H
#define LOAD_OPTIONS_H

#include "load.h"

/* Ends the program where the command line is wrong or asks for help. */
void load_options_parse(int argc, char **argv, struct load_settings *settings);

#endif
