/* setup.h - creates a service with all its parts, and frees it. */
#ifndef SRV_SETUP_H
#define SRV_SETUP_H

#include "service.h"

/* Prepare `service`, zeroed before: all but the queues, is_pinned, and the timers of
 * reclaim and stray, which the host sees to. srv_service_deinit follows in any case.
 * Returns 0 or PCCD_E_NOMEM. */
int srv_service_init(struct srv_service *service, const struct srv_options *options);
/* Free its parts, but for the queues. No session is left. */
void srv_service_deinit(struct srv_service *service);

#endif
