/* setup.h - creates a service with all its parts, and frees it. */
#ifndef SRV_SETUP_H
#define SRV_SETUP_H

#include "service.h"

/* All but the queues, which the host starts, and is_pinned. `service` is zeroed, and
 * srv_service_deinit follows in any case. Returns 0 or PCCD_E_NOMEM. */
int srv_service_init(struct srv_service *service, const struct srv_options *options);
/* No session is left. */
void srv_service_deinit(struct srv_service *service);

#endif
