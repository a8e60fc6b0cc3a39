/* ctl.h - the list of pccdctl's commands.
 *
 * Threads: the program has one.
 */
#ifndef CTL_H
#define CTL_H

#include <stdbool.h>
#include <stdint.h>

#include "option_table.h"

struct ctl_error;

/* X(name, "what it does", "the group that it begins" or NULL), in the order of the help
 * text. */
#define CTL_COMMANDS(X)                                                                  \
    X(demo, "let a cloth fall on a ball, and draw its contacts", "To begin with")        \
    X(check, "find the contacts between two or more frames of a mesh", NULL)             \
    X(near, "tell what is near: pairs, nearest, crossings, depth", NULL)                 \
    X(render, "draw a step of frames or of a recording, or a film", NULL)                \
    X(inspect, "write frames or a recording as a page for a browser", NULL)              \
    X(sweep, "tell what meets while the joints of a robot or machine move",              \
      "Robots, scenes, other programs")                                                  \
    X(scene, "write a scene file, or its format", NULL)                                  \
    X(export, "write steps for Blender or ParaView", NULL)                               \
    X(mcp, "give agents tools, by the Model Context Protocol", NULL)                     \
    X(record, "run a program and record what it asks the daemon", "Recordings")          \
    X(replay, "repeat a recording and compare every answer", NULL)                       \
    X(verify, "check the answers of a recording by exact arithmetic", NULL)              \
    X(load, "play the frames of a mesh in a daemon", NULL)                               \
    X(doctor, "look for mistakes in a set-up", "A daemon")                               \
    X(status, "show the state of a daemon on one screen", NULL)                          \
    X(top, "show what the clients of a daemon do, again and again", NULL)                \
    X(list, "list sessions, scenes, objects, pairs or meshes", NULL)                     \
    X(watch, "print a line for each step that a daemon answers", NULL)                   \
    X(stats, "list the daemon's counters", NULL)                                         \
    X(metrics, "print counters and latencies for Prometheus", NULL)                      \
    X(trace, "trace what a daemon's threads do, for Perfetto", NULL)                     \
    X(config, "list, print or change settings of a running daemon", NULL)                \
    X(drain, "let a daemon end with its last client", NULL)                              \
    X(ping, "measure round trips through the daemon", NULL)                              \
    X(completion, "print what a shell needs to complete commands and options",           \
      "The rest")                                                                        \
    X(version, "print the versions of tool, library and daemon", NULL)

/* Exit statuses of every command. */
enum ctl_exit {
    CTL_DONE = 0,
    CTL_NEGATIVE = 1,  /* it was done, and something meets or is wrong */
    CTL_USAGE = 2,     /* an option or argument is wrong */
    CTL_NO_DAEMON = 3, /* no daemon could be reached or started, or it refused us */
    CTL_FAILED = 4,    /* anything else: a file, a refusal, the end of the daemon */
    CTL_UNDECIDED = 5  /* it was done, and what meets could not all be decided */
};

/* A command gets its own arguments; argv[0] is "pccdctl NAME". Returns an exit status.
 * Help, completion and synopsis come from its table of options. */
#define CTL_PROTOTYPE(name, text, group)                                                 \
    int ctl_cmd_##name(int argc, char **argv);                                           \
    extern const struct option_table ctl_table_##name;
CTL_COMMANDS(CTL_PROTOTYPE)
#undef CTL_PROTOTYPE

/* Set the name of the program that complains, if it is not pccdctl; the caller keeps
 * it. */
void ctl_name_program(const char *name);
/* Print one line on stderr, after the name of the program and ": ". What could control a
 * terminal, as a name may, is written as \xNN. Returns CTL_FAILED. */
int ctl_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Complain of an error, unless its text is empty: then it was told where it was found. */
void ctl_error_tell(const struct ctl_error *error);
/* Return what a command ends with that did its work with this status; is_right: what it
 * looked at was found right. */
enum ctl_exit ctl_exit_of(int status, bool is_right);

/* Take a handle, decimal or 0x hexadecimal, as the value of an option; refuse what is
 * none. */
void ctl_take_handle(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to);

/* The headings that the options of all commands stand under. */
#define CTL_QUESTION                                                                     \
    {                                                                                    \
        .help = "Question:", .at = 1                                                     \
    }
#define CTL_OUTPUT                                                                       \
    {                                                                                    \
        .help = "Output:", .at = 2                                                       \
    }
#define CTL_ENGINE                                                                       \
    {                                                                                    \
        .help = "Engine:", .at = 3                                                       \
    }
#define CTL_DAEMON                                                                       \
    {                                                                                    \
        .help = "Daemon:", .at = 4                                                       \
    }

/* Options that every command has: --no-color. Its struct is none. */
extern const struct option_table ctl_common_table;

#endif
