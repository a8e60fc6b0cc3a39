/* together.h - what the ranks of pccd-mpi do together that is not the library's. */
#ifndef PROGRAM_TOGETHER_H
#define PROGRAM_TOGETHER_H

#include <mpi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "option_table.h"

int together_rank(void);
int together_size(void);
static inline bool together_is_root(void)
{
    return together_rank() == 0;
}

/* Wait for something of MPI, without keeping a processor from those that compute, as
 * MPI_Wait would. */
void together_wait(MPI_Request *request);
/* Collective. Send what the root has to all. */
void together_tell(void *what, size_t bytes);
/* Collective. Set *count to the sum over all ranks. */
void together_add(uint32_t *count);

/* Collective. Return the status of the lowest rank that has one, and its text, which
 * begins with "rank N: " then. */
int together_agree(int status, struct ctl_error *error);

/* Collective. Check that all ranks have the same bytes, 64 at most. If not, PCCD_E_STATE:
 * "`path``what` than on rank 0". */
int together_compare(const void *mine, size_t bytes, const char *path, const char *what,
                     struct ctl_error *error);

/* Read a command line, as all ranks do; the root alone speaks. Returns an exit status;
 * wrong usage and --help end the program on every rank. */
int together_parse(const struct option_table *table, int argc, char **argv, void *to);

/* Have all that is written from here on go nowhere, but for the root's. MPI may not be
 * there: then this process is the root. */
void together_mute(void);

/* Print one line on the standard error of the root, after "pccd-mpi: ". */
void together_complain(const struct ctl_error *error);

/* ---- The commands of pccd-mpi. */

/* X(name, "what it does"), in the order of the help text. */
#define PROGRAM_COMMANDS(X)                                                              \
    X(check, "find the contacts between two or more frames of a mesh")                   \
    X(near, "tell what is near: pairs, nearest, crossings, depth")                       \
    X(replay, "repeat recordings and compare every answer")                              \
    X(verify, "check the answers of recordings by exact arithmetic")                     \
    X(completion, "print what a shell needs to complete commands and options")

#define PROGRAM_PROTOTYPE(name, text)                                                    \
    int program_##name(int argc, char **argv);                                           \
    extern const struct option_table program_table_##name;
PROGRAM_COMMANDS(PROGRAM_PROTOTYPE)
#undef PROGRAM_PROTOTYPE

#endif
