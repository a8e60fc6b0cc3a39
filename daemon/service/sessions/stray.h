/* stray.h - finds memory that clients take without having been given it.
 *
 * Look at what the rings of all sessions hold (ringio.h), a second after a client has
 * asked for something, and every half a minute otherwise; end a session that goes on to
 * take what its user's quota does not bear.
 */
#ifndef SRV_STRAY_H
#define SRV_STRAY_H

#include <stdbool.h>

struct srv_service;

/* Prepare to look. Returns 0 or PCCD_E_NOMEM. Only for a host whose timers fire by
 * themselves. */
int srv_stray_init(struct srv_service *service);
void srv_stray_deinit(struct srv_service *service);
bool srv_stray_looks(const struct srv_service *service);

/* Look soon, as a client with a ring has been answered. */
void srv_stray_use(struct srv_service *service);

#endif
