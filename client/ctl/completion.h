/* client/ctl/completion.h - commands and options as shells complete them.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     walk the manifest of commands and their tables of options, which --help
 *           prints, too, and write them down as a script of a shell.
 * Does not: know a command or an option.
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
