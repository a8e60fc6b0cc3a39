/* config.h - the settings that an operator may change while the daemon runs (`pccdctl
 * config`).
 *
 * Read them by the names of pccdd's options, and change them. A change holds for
 * everything that comes later, until the daemon ends; what is kept is there for one that
 * takes its place.
 */
#ifndef SRV_CONFIG_H
#define SRV_CONFIG_H

#include <stdint.h>

#include "codec.h"
#include "messages.h"

struct srv_service;

#define SRV_CONFIG_KEPT_MAX 64u

/* Changed settings, in memory that outlives the process: by index, one more than the
 * value, 0: as at the start. Another process has written them: they are checked anew. */
struct srv_config_kept {
    _Atomic uint64_t plus_one[SRV_CONFIG_KEPT_MAX];
};

uint32_t srv_config_count(void);
/* The place of a setting in their order; srv_config_count(): there is none. */
uint32_t srv_config_find(const char *name);

/* Everything but `count`. */
void srv_config_describe(const struct srv_service *service, uint32_t index,
                         struct proto_CONFIG_GET_result *result);

/* Returns 0, PCCD_E_INVAL with *error set: no such value. */
int srv_config_set(struct srv_service *service, uint32_t index, const char *value,
                   struct proto_error *error);

/* Change all settings as they were kept, and keep what is changed from now on. NULL:
 * nothing. */
void srv_config_restore(struct srv_service *service, struct srv_config_kept *kept);

#endif
