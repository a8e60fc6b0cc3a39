/* client/ctl/completion.h - completes the commands and options of pccdctl in a shell.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     walk the table of commands and their tables of options, which also make
 *           --help, and write them as a script for a shell.
 * Does not: name a command or an option itself.
 * Threads:  one.
 * Source:   an option's argument "a|b|c" is one of those words; FILE, PATH, PROGRAM and
 *           MESH are names of files; others are the user's own. So it is for arguments.
 */
#ifndef CTL_COMPLETION_H
#define CTL_COMPLETION_H

#include <stdio.h>

void completion_print_bash(FILE *to);
void completion_print_zsh(FILE *to);
void completion_print_fish(FILE *to);

#endif
