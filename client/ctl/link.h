/* link.h - connects a command to the daemon that its options name. */
#ifndef CTL_LINK_H
#define CTL_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "option_table.h"
#include "pccd.h"

/* Policy without --url and --socket. */
enum ctl_link_policy {
    CTL_LINK_EXISTING,          /* the user's daemon, if it runs */
    CTL_LINK_USER,              /* the user's daemon, started if it does not run */
    CTL_LINK_PRIVATE,           /* a daemon of our own */
    CTL_LINK_PRIVATE_UNLESS_ENV /* $PCCD_URL if set, else a daemon of our own */
};

struct ctl_link {
    enum ctl_link_policy policy; /* set before parsing */
    char *url;                   /* ours; NULL = none given */
    const char *daemon;
    int timeout_ms;
    bool is_private;       /* asked for */
    bool observes;         /* it only asks about the daemon, or sets it; before parsing */
    uint64_t result_bytes; /* 0 = the library's default */
};

/* Options that fill a struct ctl_link. */
extern const struct option_table ctl_link_table;

/* Options of a command that asks a daemon: where that is, and --json. */
struct ctl_query {
    struct ctl_link link;
    bool is_json;
};

/* Options that fill a struct ctl_query. */
extern const struct option_table ctl_query_table;

/* Set what to connect with, as it was asked for; `link` keeps the strings. */
void ctl_link_options(const struct ctl_link *link, struct pccd_options *asked);

/* Return whether direct: computes in this process; after it was opened. */
bool ctl_link_is_direct(const struct ctl_link *link);
/* Connect, or complain. Returns an exit status. */
int ctl_link_open(const struct ctl_link *link, struct pccd_client **client);
/* Run a command: read its options into a struct that begins with `link`, connect, and
 * call `run` with that struct. Returns an exit status, as `run` does. */
int ctl_link_command(const struct option_table *table, int argc, char **argv,
                     struct ctl_link *link,
                     int (*run)(struct pccd_client *client, void *options));
void ctl_link_deinit(struct ctl_link *link);

/* Say what an object is called, cut to what a name may have, as pccd_object_name does. */
int ctl_name_object(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const char *name);

#endif
