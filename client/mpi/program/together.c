/* together.c - what ranks do together.
 *
 * Room:     client/mpi/program.
 * Threads:  one.
 * Source:   together.h.
 */
#include "together.h"

#include <mpi.h>
#include <stdio.h>
#include <string.h>

#include "pccd_types.h"
#include "shown.h"

int together_rank(void)
{
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

int together_size(void)
{
    int size = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    return size;
}

int together_agree(int status, struct ctl_error *error)
{
    struct {
        int status, rank;
    } mine = {status == PCCD_OK, together_rank()}, all;
    int verdict = status;
    MPI_Allreduce(&mine, &all, 1, MPI_2INT, MPI_MINLOC, MPI_COMM_WORLD);
    if (all.status != 0) {
        return PCCD_OK;
    }
    MPI_Bcast(&verdict, 1, MPI_INT, all.rank, MPI_COMM_WORLD);
    MPI_Bcast(error->text, CTL_ERROR_TEXT_BYTES, MPI_CHAR, all.rank, MPI_COMM_WORLD);
    if (strncmp(error->text, "rank ", 5) != 0) {
        struct ctl_error why = *error;
        (void)ctl_error_set(error, verdict, "rank %d: %.990s", all.rank, why.text);
    }
    return verdict;
}

void together_complain(const struct ctl_error *error)
{
    if (together_is_root() && error->text[0] != '\0') {
        fprintf(stderr, "pccd-mpi: %s\n", tool_shown(error->text));
    }
}
