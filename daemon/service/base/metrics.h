/* metrics.h - the counters that `stats` reports. */
#ifndef SRV_METRICS_H
#define SRV_METRICS_H

#include <stdint.h>

#include "messages.h"
#include "pccd_daemon.h"

struct srv_metrics {
    struct proto_STATS_result counters;
    struct proto_STATS_HISTOGRAM_result histograms[PCCD_HISTOGRAM_COUNT];
};

/* Add how long something of that kind took. */
void srv_metrics_add_duration(struct srv_metrics *metrics, enum pccd_histogram_kind kind,
                              uint64_t took_ns);

/* Add what a finished step says of itself, and its failure if it has failed. */
void srv_metrics_add_step(struct srv_metrics *metrics, const struct proto_answer *answer);

/* Add all that was counted apart; what is of the last step is that of `more`, if it has
 * any. */
void srv_metrics_add_all(struct srv_metrics *metrics, const struct srv_metrics *more);

/* Add a step to what list.session tells of a session. */
void srv_stats_add_step(struct proto_LIST_SESSION_result *stats,
                        const struct proto_answer *answer);
/* Add to that all that was counted apart. */
void srv_stats_add_all(struct proto_LIST_SESSION_result *stats,
                       const struct proto_LIST_SESSION_result *more);

/* Add an answer about what is near. */
void srv_metrics_add_near(struct srv_metrics *metrics, const struct proto_answer *answer);

/* Add an error answer. */
void srv_metrics_add_error(struct srv_metrics *metrics, int status);

#endif
