/* lifeline.c - a pipe that ends when a worker does, before it is gone.
 *
 * Room:     server. See lifeline.h.
 * Does:     pass the number of the descriptor in a variable of the environment.
 * Threads:  [main].
 */
#include "lifeline.h"

#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <unistd.h>

#include "activate.h"
#include "log.h"

#define NAME "PCCD_LIFELINE"

static int held_fd = -1; /* -1: nobody supervises us */

int srv_lifeline_give(int fd)
{
    return srv_number_give(NAME, fd);
}

void srv_lifeline_take(void)
{
    long fd = srv_number_of(NAME);
    unsetenv(NAME);
    if (fd >= SRV_GIVEN_FD_FLOOR && fd <= INT_MAX &&
        fcntl((int)fd, F_SETFD, FD_CLOEXEC) == 0) {
        held_fd = (int)fd;
    }
}

void srv_lifeline_raise(uint32_t count)
{
    /* Where the number is taken nothing is lost but time. */
    int raised = held_fd < 0 || count == 0 || count > INT_MAX
                     ? -1
                     : fcntl(held_fd, F_DUPFD_CLOEXEC, (int)count - 1);
    if (raised >= 0) {
        close(held_fd);
        held_fd = raised;
    }
}

void srv_lifeline_say_end(void)
{
    if (held_fd >= 0 && write(held_fd, "e", 1) != 1) {
        srv_log(SRV_LOG_WARN, 0, "the supervisor cannot be told of the end");
    }
}
