/* loop.c - everything there is one of.
 *
 * Room:     service. See loop.h.
 * Does:     make it and free it.
 * Threads:  [loop]
 */
#include "loop.h"

#include <stdlib.h>
#include <sys/random.h>
#include <unistd.h>

#include "invariant.h"
#include "now.h"
#include "pccd_types.h"

/* A number that differs from start to start. */
static uint64_t make_epoch(void)
{
    uint64_t epoch = 0;
    if (getrandom(&epoch, sizeof epoch, GRND_NONBLOCK) != (ssize_t)sizeof epoch) {
        epoch = srv_now_ns() ^ (uint64_t)getpid() << 32;
    }
    return epoch == 0 ? 1 : epoch; /* 0 means none */
}

int srv_loop_init(struct srv_loop *loop, const struct srv_options *options)
{
    loop->live = *options;
    loop->options = &loop->live;
    loop->start_options = options;
    loop->epoch = make_epoch();
    srv_quota_init(&loop->quota, options->quota);
    srv_quota_bound_memory(&loop->quota, options->memory_total_max);
    loop->decoder = proto_decoder_new();
    loop->encoder = malloc(sizeof *loop->encoder);
    if (loop->decoder == NULL || loop->encoder == NULL ||
        srv_desk_init(loop->desks, 0) != 0) {
        return PCCD_E_NOMEM;
    }
    int status = srv_linger_init(loop);
    if (status == 0) {
        status = srv_relief_init(loop);
    }
    return status != 0 ? status : srv_overdue_init(&loop->overdue, loop);
}

void srv_loop_deinit(struct srv_loop *loop)
{
    PCCD_ASSERT(loop->sessions == NULL);
    srv_linger_deinit(loop);
    srv_relief_deinit(loop);
    srv_overdue_deinit(&loop->overdue);
    srv_quota_deinit(&loop->quota);
    srv_laststep_set(&loop->spare_step, &loop->last_step, NULL);
    srv_laststep_deinit(&loop->spare_step);
    proto_decoder_free(loop->decoder);
    free(loop->encoder);
    srv_desk_deinit(loop->desks);
}
