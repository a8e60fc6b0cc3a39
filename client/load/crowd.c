/* crowd.c - processes with many clients each.
 *
 * Room:     client/load.
 * Does:     see crowd.h.
 * Threads:  crowd.h.
 */
#include "crowd.h"

#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "actor.h"

/* How long a process sleeps when none of its clients has anything to do: an answer wakes
 * it. */
#define NAP_MS 20

/* Or until some of them have thought enough. */
#define THINK_NAP_MS 2

struct crowd {
    const struct load *load;
    struct load_actor *actors;
    struct pollfd *fds;
    uint32_t count;
};

static bool open_all(struct crowd *crowd, uint32_t index)
{
    const struct load_settings *settings = &crowd->load->settings;
    struct load_tally *tally = &crowd->load->shared->crowd[index];
    for (uint32_t i = index; i < settings->clients; i += settings->processes) {
        struct load_actor *actor = &crowd->actors[crowd->count++];
        if (load_actor_open(actor, crowd->load, i, tally, false, true) != 0) {
            return false;
        }
    }
    return true;
}

static bool has_failed(const struct crowd *crowd)
{
    return atomic_load(&crowd->load->shared->failed);
}

/* One turn of each. Returns whether any of them goes on. */
static bool take_turns(struct crowd *crowd, bool *moved)
{
    bool enough = atomic_load(&crowd->load->shared->enough);
    bool goes_on = false;
    *moved = false;
    for (uint32_t i = 0; i < crowd->count && !has_failed(crowd); i++) {
        struct load_actor *actor = &crowd->actors[i];
        bool more = !enough || actor->next < crowd->load->settings.requests;
        *moved = load_actor_turn(actor, more) || *moved;
        goes_on = goes_on || more || actor->pending_count > 0;
    }
    return goes_on && !has_failed(crowd);
}

static void nap(struct crowd *crowd)
{
    for (uint32_t i = 0; i < crowd->count; i++) {
        crowd->fds[i] =
            (struct pollfd){.fd = pccd_fd(crowd->actors[i].client), .events = POLLIN};
    }
    (void)poll(crowd->fds, crowd->count,
               crowd->load->settings.think_ms > 0 ? THINK_NAP_MS : NAP_MS);
}

static int run(struct load *load, uint32_t index)
{
    struct load_shared *shared = load->shared;
    struct crowd crowd = {.load = load};
    bool moved;
    crowd.actors = calloc(load->settings.clients, sizeof *crowd.actors);
    crowd.fds = calloc(load->settings.clients, sizeof *crowd.fds);
    if (!crowd.actors || !crowd.fds || !open_all(&crowd, index)) {
        atomic_store(&shared->failed, true);
        return 1;
    }
    atomic_fetch_add(&shared->ready, 1);
    while (!atomic_load(&shared->go) && !has_failed(&crowd)) {
        load_sleep_ms(1);
    }
    while (take_turns(&crowd, &moved)) {
        if (!moved) {
            nap(&crowd);
        }
    }
    for (uint32_t i = 0; i < crowd.count; i++) {
        load_actor_close(&crowd.actors[i]);
    }
    free(crowd.actors);
    free(crowd.fds);
    return atomic_load(&shared->failed);
}

pid_t load_crowd_start(struct load *load, uint32_t index)
{
    pid_t parent = getpid();
    pid_t pid = fork();
    if (pid == 0) {
        bool is_orphan = prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent;
        _exit(is_orphan ? 1 : run(load, index));
    }
    return pid;
}

/* ---- the truth --------------------------------------------------------------------- */

static int go_round(const struct load *load, uint32_t number, bool sheet_first,
                    struct load_tally *tally)
{
    struct load_actor actor;
    int rc = load_actor_open(&actor, load, number, tally, sheet_first, true);
    actor.is_alone = true;
    while (rc == 0 && (actor.next < LOAD_FRAMES || actor.pending_count > 0)) {
        bool more = actor.next < LOAD_FRAMES;
        if (!load_actor_turn(&actor, more) && actor.pending_count > 0) {
            struct pollfd fd = {.fd = pccd_fd(actor.client), .events = POLLIN};
            (void)poll(&fd, 1, NAP_MS);
        }
        rc = tally->broken > 0 ? PCCD_E_DISCONNECTED : 0;
    }
    load_actor_close(&actor);
    return rc;
}

int load_crowd_find_truth(struct load *load, uint64_t *records)
{
    struct load_tally tally = {0};
    uint32_t count = load->settings.clients + load->settings.victims;
    int rc = 0;
    for (uint32_t i = 0; i < count && rc == 0; i++) {
        for (int order = 0; order < (int)LOAD_ORDERS && rc == 0; order++) {
            rc = go_round(load, i, order == 1, &tally);
        }
    }
    *records = tally.records;
    return rc;
}
