/* config.h - the settings that an operator may change while the daemon runs (`pccdctl
 * config`).
 *
 * Room:     service. May include: the protocol's headers.
 * Does:     read them by the names of pccdd's options, and change them. A change holds
 *           for everything that comes later, until the daemon ends.
 * Does not: decide who may change them (handlers_config.c).
 * Threads:  [loop]
 */
#ifndef SRV_CONFIG_H
#define SRV_CONFIG_H

#include <stdint.h>

#include "codec.h"
#include "messages.h"

struct srv_service;

uint32_t srv_config_count(void);
/* The place of a setting in their order; srv_config_count(): there is none. */
uint32_t srv_config_find(const char *name);

/* Everything but `count`. */
void srv_config_describe(const struct srv_service *service, uint32_t index,
                         struct proto_CONFIG_GET_result *result);

/* Returns 0, PCCD_E_INVAL with *error set: no such value. */
int srv_config_set(struct srv_service *service, uint32_t index, const char *value,
                   struct proto_error *error);

#endif
