/* together.c - what ranks do together. */
#include "together.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "ctl.h"
#include "pccd_types.h"

#define PAUSE_NS     20000      /* between two looks for what was waited for: at first, */
#define PAUSE_NS_MAX 1000000    /* and at most */
#define CHUNK_BYTES  (1u << 30) /* of a message: MPI counts them by an int */

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

void together_wait(MPI_Request *request)
{
    struct timespec pause = {0, PAUSE_NS};
    int is_there = 0;
    MPI_Test(request, &is_there, MPI_STATUS_IGNORE);
    while (!is_there) {
        nanosleep(&pause, NULL);
        pause.tv_nsec = pause.tv_nsec < PAUSE_NS_MAX ? 2 * pause.tv_nsec : PAUSE_NS_MAX;
        MPI_Test(request, &is_there, MPI_STATUS_IGNORE);
    }
}

void together_tell(void *what, size_t bytes)
{
    for (size_t done = 0; done < bytes; done += CHUNK_BYTES) {
        MPI_Request request;
        int length = (int)(bytes - done < CHUNK_BYTES ? bytes - done : CHUNK_BYTES);
        MPI_Ibcast((char *)what + done, length, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
        together_wait(&request);
    }
}

void together_add(uint32_t *count)
{
    MPI_Request request;
    MPI_Iallreduce(MPI_IN_PLACE, count, 1, MPI_UINT32_T, MPI_SUM, MPI_COMM_WORLD,
                   &request);
    together_wait(&request);
}

int together_agree(int status, struct ctl_error *error)
{
    struct {
        int status, rank;
    } mine = {status == PCCD_OK, together_rank()}, all;
    int verdict = status;
    MPI_Request request;
    MPI_Iallreduce(&mine, &all, 1, MPI_2INT, MPI_MINLOC, MPI_COMM_WORLD, &request);
    together_wait(&request);
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

int together_compare(const void *mine, size_t bytes, const char *path, const char *what,
                     struct ctl_error *error)
{
    unsigned char its[64];
    memcpy(its, mine, bytes);
    together_tell(its, bytes);
    int status =
        memcmp(its, mine, bytes) == 0
            ? PCCD_OK
            : ctl_error_set(error, PCCD_E_STATE, "%s%s than on rank 0", path, what);
    return together_agree(status, error);
}

/* Send the standard outputs of others than the root nowhere while options are read. */
static void hush(int kept[2])
{
    int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (int i = 0; i < 2; i++) {
        kept[i] = dup(1 + i);
        dup2(nowhere, 1 + i);
    }
    close(nowhere);
}

static void speak(const int kept[2])
{
    fflush(NULL);
    for (int i = 0; i < 2; i++) {
        dup2(kept[i], 1 + i);
        close(kept[i]);
    }
}

int together_parse(const struct option_table *table, int argc, char **argv, void *to)
{
    int kept[2] = {-1, -1};
    if (!together_is_root()) {
        hush(kept);
    }
    int error = option_parse(table, argc, argv, to);
    if (!together_is_root()) {
        speak(kept);
    }
    return error == 0 ? CTL_DONE : CTL_FAILED;
}

void together_mute(void)
{
    int is_there = 0, kept[2];
    MPI_Initialized(&is_there);
    if (is_there && !together_is_root()) {
        hush(kept);
    }
}

void together_complain(const struct ctl_error *error)
{
    if (together_is_root()) {
        ctl_error_tell(error);
    }
}
