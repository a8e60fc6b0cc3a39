/* commands.h - the commands of pccd-mpi.
 *
 * Threads: one.
 */
#ifndef PROGRAM_COMMANDS_H
#define PROGRAM_COMMANDS_H

#include <argp.h>

/* X(name, "what it does"), in the order of the help text. */
#define PROGRAM_COMMANDS(X)                                                              \
    X(check, "find the contacts between two or more frames of a mesh")                   \
    X(near, "tell what is near: pairs, nearest, crossings, depth")                       \
    X(replay, "repeat recordings and compare every answer")                              \
    X(verify, "check the answers of recordings by exact arithmetic")                     \
    X(completion, "print what a shell needs to complete commands and options")

#define PROGRAM_PROTOTYPE(name, text)                                                    \
    int program_##name(int argc, char **argv);                                           \
    extern const struct argp program_argp_##name;
PROGRAM_COMMANDS(PROGRAM_PROTOTYPE)
#undef PROGRAM_PROTOTYPE

#endif
