/* config.h - the settings that an operator may change while the daemon runs (`pccdctl
 * config`).
 *
 * A change holds for everything that comes later, until the daemon ends; what is kept is
 * there for one that takes its place.
 */
#ifndef SRV_CONFIG_H
#define SRV_CONFIG_H

#include <stdint.h>

#include "settings_file.h"

struct srv_service;

/* Return what is wrong with a line that config.set knows nothing of; NULL: nothing that
 * can be seen before a start. */
typedef const char *(*srv_setting_check)(const struct srv_settings_line *line);

#define SRV_CONFIG_KEPT_MAX 64u

/* Holds what outlives the process. Changed settings by index: one more than the value, 0:
 * as at the start; another process has written them, so they are checked anew. And the
 * configuration file as it was when the supervisor began, which was right: one that has
 * become wrong since ends no worker. */
struct srv_config_kept {
    _Atomic uint64_t plus_one[SRV_CONFIG_KEPT_MAX];
    struct srv_settings_file file;
};

/* Change all settings as they were kept, and keep what is changed from now on. NULL:
 * nothing. */
void srv_config_restore(struct srv_service *service, struct srv_config_kept *kept);

/* Take what has changed in the configuration file since it was read last, each as
 * config.set would, and log each: that it was taken, is wrong, or holds after a restart,
 * unless `check` says that it is wrong, too. A file that cannot be read changes nothing.
 */
void srv_config_reload(struct srv_service *service, srv_setting_check check);

#endif
