/* stray.c - memory that clients take without having been given it. */
#include "stray.h"

#include <stddef.h>

#include "host.h"
#include "log.h"
#include "pccd_types.h"
#include "ringio.h"
#include "service.h"
#include "session.h"

#define SOON_MS   1000u
#define SELDOM_MS 30000u

static void look(void *context)
{
    struct srv_service *service = context;
    bool has_ring = false;
    bool is_stray = false;
    for (struct srv_session *at = service->sessions; at != NULL;) {
        struct srv_session *next = at->next; /* one that ends may free itself */
        struct proto_error error = {0};
        has_ring = has_ring || at->ring != NULL;
        if (at->ring != NULL && srv_ring_look(at->ring, &error) != 0) {
            service->refuse(at, &error);
        } else {
            is_stray = is_stray || (at->ring != NULL && at->ring->was_stray);
        }
        at = next;
    }
    service->is_stray_soon = is_stray;
    if (has_ring) {
        srv_timer_start(service->stray, is_stray ? SOON_MS : SELDOM_MS, 0);
    }
}

int srv_stray_init(struct srv_service *service)
{
    service->stray = srv_timer_new(service, look, service);
    return service->stray != NULL ? 0 : PCCD_E_NOMEM;
}

void srv_stray_deinit(struct srv_service *service)
{
    srv_timer_free(service->stray);
    service->stray = NULL;
}

bool srv_stray_looks(const struct srv_service *service)
{
    return service->stray != NULL;
}

void srv_stray_use(struct srv_service *service)
{
    if (service->stray != NULL && !service->is_stray_soon) {
        service->is_stray_soon = true;
        srv_timer_start(service->stray, SOON_MS, 0);
    }
}
