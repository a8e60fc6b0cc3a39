/* cmd_drain.c - pccdctl drain. */
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <unistd.h>

#include "ctl.h"
#include "doctor.h"
#include "link.h"
#include "output.h"
#include "printable.h"
#include "shown.h"
#include "terminal.h"

#define SLICE_MS 100 /* between two looks for an interrupt */

struct drain_options {
    struct ctl_link link;
    double wait_s; /* 0: do not wait */
    bool is_json;
};

static const struct option_row rows[] = {
    CTL_QUESTION,
    {"wait", 0, "SECONDS",
     "Wait until the daemon has ended, at most so long; status 1: it has not",
     OPTION_REAL, .at = offsetof(struct drain_options, wait_s), .min = 0.001, .max = 1e9},
    CTL_OUTPUT,
    {"json", 0, NULL, "A JSON object: the socket, clients, and if it has ended",
     OPTION_FLAG, .at = offsetof(struct drain_options, is_json)},
    {0}};

const struct option_table ctl_table_drain = {
    .rows = rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct drain_options, link)}, {0}},
    .text = "Let a daemon serve the clients that it has, take no others, and end with "
            "the last one. Its socket is removed, so that another daemon may begin "
            "there at once: clients that come then reach that one.",
    .more = "A socket that systemd made stays: systemctl stop pccdd.socket first.",
    .examples = "  pccdctl drain\n"
                "  pccdctl drain --socket /run/pccd/pccd.sock --wait 60\n",
};

struct daemon {
    char path[256], lock[264]; /* of its socket */
    int process;               /* descriptor of what holds the lock; -1: not known */
    uint32_t sessions;         /* besides ours */
};

static void count_session(void *context, const struct pccd_session_info *info)
{
    struct daemon *daemon = context;
    (void)info;
    daemon->sessions++;
}

/* Open the process that holds the lock. Returns an exit status. */
static int find_process(struct daemon *daemon)
{
    pid_t pid = 0;
    if (doctor_look_at_lock(daemon->lock, &pid) != DOCTOR_LOCK_HELD) {
        return ctl_complain("drain: no daemon holds %s: systemd made this socket, or "
                            "another drain was here",
                            tool_shown(daemon->lock));
    }
    daemon->process = pid > 0 ? pidfd_open(pid, 0) : -1;
    return CTL_DONE;
}

/* Learn what there is, while it may be asked. Returns an exit status. */
static int learn(struct daemon *daemon, const struct ctl_link *link)
{
    struct pccd_client *client = NULL;
    int status = ctl_link_open(link, &client);
    if (status != CTL_DONE) {
        return status;
    }
    const char *url = pccd_url(client);
    if (strncmp(url, "unix:", 5) != 0 || strlen(url + 5) >= sizeof daemon->path) {
        status = ctl_complain("drain: %s is no socket's path", tool_shown(url));
    } else if (pccd_list_sessions(client, count_session, daemon) != PCCD_OK) {
        status = ctl_complain("drain: %s", pccd_error_text(client));
    } else {
        strcpy(daemon->path, url + 5);
        snprintf(daemon->lock, sizeof daemon->lock, "%s.lock", daemon->path);
        daemon->sessions--; /* our own */
        status = find_process(daemon);
    }
    pccd_close(client);
    return status;
}

/* Remove the lock first: a daemon whose socket alone is gone listens anew (pccdd(8)). */
static int give_up_path(const struct daemon *daemon)
{
    const char *const paths[] = {daemon->lock, daemon->path};
    for (int i = 0; i < 2; i++) {
        if (unlink(paths[i]) != 0 && errno != ENOENT) {
            return ctl_complain("drain: cannot remove %s: %s", tool_shown(paths[i]),
                                strerror(errno));
        }
    }
    return CTL_DONE;
}

/* Return whether the daemon ends before the time, or an interrupt. */
static bool ends_within(const struct daemon *daemon, double wait_s)
{
    double end_s = terminal_now_s() + wait_s;
    struct pollfd ended = {.fd = daemon->process, .events = POLLIN};
    terminal_catch_interrupts();
    while (poll(&ended, 1, SLICE_MS) <= 0) {
        if (terminal_was_interrupted() || terminal_now_s() >= end_s) {
            return false;
        }
    }
    return true;
}

/* Returns an exit status. */
static int finish(const struct daemon *daemon, const struct drain_options *options)
{
    bool waits = options->wait_s > 0, has_ended = false;
    if (!options->is_json) {
        printf("%s is given up; the daemon has %" PRIu32 " %s, and ends with the last\n",
               tool_shown(daemon->path), daemon->sessions,
               proto_plural(daemon->sessions, "client", "clients"));
        (void)fflush(stdout);
    }
    if (waits && daemon->process < 0) {
        return ctl_complain("drain: which process it is was not to be seen");
    }
    has_ended = waits && ends_within(daemon, options->wait_s);
    if (options->is_json) {
        json_t *object = json_pack("{s:s, s:I, s:b}", "socket", daemon->path, "clients",
                                   (json_int_t)daemon->sessions, "ended", has_ended);
        (void)output_json(object, true, stdout);
    } else if (waits) {
        puts(has_ended ? "ended" : "still serving; kill -TERM ends it");
    }
    return waits && !has_ended ? CTL_NEGATIVE : CTL_DONE;
}

int ctl_cmd_drain(int argc, char **argv)
{
    struct drain_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct daemon daemon = {.process = -1};
    if (option_parse(&ctl_table_drain, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    int status = learn(&daemon, &options.link);
    if (status == CTL_DONE) {
        status = give_up_path(&daemon);
    }
    if (status == CTL_DONE) {
        status = finish(&daemon, &options);
    }
    if (daemon.process >= 0) {
        close(daemon.process);
    }
    ctl_link_deinit(&options.link);
    return status;
}
