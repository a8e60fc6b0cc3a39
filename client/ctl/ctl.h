/* client/ctl/ctl.h - the commands of pccdctl, and what they share.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     holds the manifest of commands: table, help and prototypes come from it.
 * Does not: anything itself.
 * Threads:  the program has one.
 * Source:   main.c runs what is listed here.
 */
#ifndef CTL_H
#define CTL_H

#include <argp.h>
#include <stdint.h>

/* X(name, "what it does"), in the order of the help text. */
#define CTL_COMMANDS(X)                                                                  \
    X(ping, "measure round trips through the daemon")                                    \
    X(stats, "list the daemon's counters")                                               \
    X(trace, "record what a daemon's threads do, for Perfetto")                          \
    X(check, "find the contacts between two or more frames of a mesh")                   \
    X(demo, "stream a falling cloth through a daemon and draw its contacts")             \
    X(version, "tell the versions of tool and library, and the daemon's process")

/* Exit statuses of every command. */
enum ctl_exit { CTL_DONE = 0, CTL_FAILED = 1 };

/* A command gets its own arguments; argv[0] is "pccdctl NAME". Returns an exit status. */
#define CTL_PROTOTYPE(name, text) int ctl_cmd_##name(int argc, char **argv);
CTL_COMMANDS(CTL_PROTOTYPE)
#undef CTL_PROTOTYPE

/* One line on stderr, after "pccdctl: ". Returns CTL_FAILED. */
int ctl_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* An option's number; ends the program with a usage message when it is none or out of
 * range. `name` is the option's, for the message. */
uint64_t ctl_option_count(const struct argp_state *state, const char *name,
                          const char *text, uint64_t low, uint64_t high);
double ctl_option_real(const struct argp_state *state, const char *name, const char *text,
                       double low, double high);

#endif
