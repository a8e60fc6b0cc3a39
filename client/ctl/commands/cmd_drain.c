/* cmd_drain.c - pccdctl drain. */
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "columns.h"
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

/* A file, and what it was when it was seen. */
struct seen {
    char path[DOCTOR_PATH_BYTES + 8];
    dev_t device;
    ino_t inode; /* 0: there was none */
};

struct daemon {
    struct seen lock, socket;
    pid_t holder;      /* of the lock; 0: not known */
    int process;       /* descriptor of that; -1: not known */
    uint32_t sessions; /* besides ours */
};

static void count_session(void *context, const struct pccd_session_info *info)
{
    struct daemon *daemon = context;
    (void)info;
    daemon->sessions++;
}

static void see(struct seen *seen)
{
    struct stat info;
    bool is_there = lstat(seen->path, &info) == 0;
    seen->device = is_there ? info.st_dev : 0;
    seen->inode = is_there ? info.st_ino : 0;
}

/* Return whether a path leads to the file that was seen. */
static bool is_seen(const struct seen *seen, const char *path)
{
    struct stat info;
    return lstat(path, &info) == 0 && info.st_dev == seen->device &&
           info.st_ino == seen->inode;
}

/* Return whether the lock, which may have another name by now, is that of the daemon:
 * held without a break since it was seen, as its process lives. */
static bool is_held(const struct daemon *daemon, const char *path)
{
    struct pollfd ended = {.fd = daemon->process, .events = POLLIN};
    pid_t holder = 0;
    return is_seen(&daemon->lock, path) &&
           doctor_look_at_lock(path, &holder) == DOCTOR_LOCK_HELD &&
           holder == daemon->holder && poll(&ended, 1, 0) == 0;
}

/* See who holds the lock, before that daemon is asked. Returns whether one does. */
static bool see_holder(struct daemon *daemon, const struct pccd_options *asked)
{
    char path[DOCTOR_PATH_BYTES];
    if (asked->private_daemon || !doctor_find_path(asked, path)) {
        return false;
    }
    strcpy(daemon->socket.path, path);
    snprintf(daemon->lock.path, sizeof daemon->lock.path, "%s.lock", path);
    see(&daemon->socket);
    see(&daemon->lock);
    bool is_locked =
        doctor_look_at_lock(daemon->lock.path, &daemon->holder) == DOCTOR_LOCK_HELD;
    daemon->process =
        is_locked && daemon->holder > 0 ? pidfd_open(daemon->holder, 0) : -1;
    return is_locked;
}

/* Learn what there is, while it may be asked. Returns an exit status. */
static int learn(struct daemon *daemon, const struct ctl_link *link)
{
    struct pccd_options asked;
    struct pccd_client *client = NULL;
    ctl_link_options(link, &asked);
    bool is_locked = see_holder(daemon, &asked);
    int status = ctl_link_open(link, &client);
    if (status != CTL_DONE) {
        return status;
    }
    if (daemon->socket.path[0] == '\0') {
        status = ctl_complain("drain: %s has no path to give up",
                              tool_shown(pccd_url(client)));
    } else if (pccd_list_sessions(client, count_session, daemon) != PCCD_OK) {
        status = ctl_complain("drain: %s", pccd_error_text(client));
    } else if (!is_locked) {
        status = ctl_complain("drain: no daemon holds %s: systemd made this socket, or "
                              "another drain was here",
                              tool_shown(daemon->lock.path));
    }
    daemon->sessions -= daemon->sessions > 0; /* our own */
    pccd_close(client);
    return status;
}

/* Take a file away under another name, look at it, and put it back if it is not the one
 * that was seen. Returns an exit status, and whether it was that. */
static int take_away(const struct daemon *daemon, const struct seen *file, bool *was_seen)
{
    char aside[sizeof file->path + 32];
    bool is_lock = file == &daemon->lock;
    snprintf(aside, sizeof aside, "%s.drain-%ld", file->path, (long)getpid());
    *was_seen = false;
    if (rename(file->path, aside) != 0) {
        return errno == ENOENT ? CTL_DONE
                               : ctl_complain("drain: cannot remove %s: %s",
                                              tool_shown(file->path), strerror(errno));
    }
    *was_seen = is_lock ? is_held(daemon, aside) : is_seen(file, aside);
    if (!*was_seen) {
        (void)link(aside, file->path); /* unless a third one is there by now */
    }
    (void)unlink(aside);
    return CTL_DONE;
}

/* Remove the lock first: a daemon whose socket alone is gone listens anew (pccdd(8)). One
 * that has begun since then has another lock, and a socket of its own; both stay. */
static int give_up_path(const struct daemon *daemon)
{
    bool was_seen = false;
    int status = take_away(daemon, &daemon->lock, &was_seen);
    if (status == CTL_DONE && !was_seen) {
        return ctl_complain("drain: the daemon has ended, or another one has begun at %s",
                            tool_shown(daemon->socket.path));
    }
    return status == CTL_DONE ? take_away(daemon, &daemon->socket, &was_seen) : status;
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
        fprintf(columns_fitted(stdout),
                "%s is given up; the daemon has %" PRIu32 " %s, and ends with the last\n",
                tool_shown(daemon->socket.path), daemon->sessions,
                proto_plural(daemon->sessions, "client", "clients"));
        (void)fflush(stdout);
    }
    if (waits && daemon->process < 0) {
        return ctl_complain("drain: which process it is was not to be seen");
    }
    has_ended = waits && ends_within(daemon, options->wait_s);
    if (options->is_json) {
        json_t *object =
            json_pack("{s:s, s:I, s:b}", "socket", daemon->socket.path, "clients",
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
