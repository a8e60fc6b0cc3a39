/* crowd.c - processes with many clients each. */
#include "load.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "actor.h"

/* The sleep of a process when nothing is due: an answer wakes it. */
#define NAP_NS 20000000u

struct crowd {
    const struct load *load;
    struct load_tally *tally;
    struct load_actor *actors; /* those that have joined have a client */
    struct pollfd *fds;        /* two of each */
    uint32_t index;
    uint32_t count;
    uint64_t enough_ns; /* when time was up; 0: it is not */
};

/* ---- when each request is due ------------------------------------------------------ */

static double luck(const struct load_pace *pace, const struct load *load, uint64_t what)
{
    uint64_t bits = load_mix(load->settings.seed ^ what, pace->client);
    return load_unit(load_mix(bits, pace->count));
}

uint64_t load_measured_from_ns(const struct load *load)
{
    const struct load_settings *settings = &load->settings;
    return atomic_load(&load->shared->go_ns) +
           (uint64_t)(1e9 * (settings->ramp_s + settings->warm_up_s));
}

void load_pace_begin(struct load_pace *pace, const struct load *load, uint32_t client)
{
    const struct load_settings *settings = &load->settings;
    double share = (double)client / settings->clients;
    double phase_s = settings->hz > 0 ? share / settings->hz : 0;
    *pace = (struct load_pace){.client = client};
    pace->due_ns = atomic_load(&load->shared->go_ns) +
                   (uint64_t)(1e9 * (settings->ramp_s * share + phase_s));
}

void load_pace_next(struct load_pace *pace, const struct load *load, uint64_t now_ns)
{
    const struct load_settings *settings = &load->settings;
    pace->count++;
    if (settings->hz > 0) {
        double periods = settings->poisson ? -log1p(-luck(pace, load, 0x9a1e)) : 1;
        pace->due_ns += (uint64_t)(periods * 1e9 / settings->hz);
    } else if (settings->think_ms > 0) {
        pace->due_ns = now_ns + (uint64_t)((0.5 + luck(pace, load, 0x781c)) * 1e6 *
                                           settings->think_ms);
    }
}

uint64_t load_pace_stall_ns(const struct load_pace *pace, const struct load *load)
{
    const struct load_settings *settings = &load->settings;
    bool stalls =
        settings->stall_share > 0 && luck(pace, load, 0x57a11) < settings->stall_share;
    return stalls ? settings->stall_ms * 1000000ull : 0;
}

/* ---- a process --------------------------------------------------------------------- */

static uint32_t number_of(const struct crowd *crowd, uint32_t i)
{
    return crowd->index + i * crowd->load->settings.processes;
}

static bool join(struct crowd *crowd, uint32_t i)
{
    crowd->actors[i] = (struct load_actor){
        .load = crowd->load, .tally = crowd->tally, .number = number_of(crowd, i)};
    return load_actor_open(&crowd->actors[i], true) == 0;
}

/* Those that do not join one after the other. */
static bool open_all(struct crowd *crowd)
{
    const struct load_settings *settings = &crowd->load->settings;
    bool good = true;
    for (uint32_t i = crowd->index; i < settings->clients; i += settings->processes) {
        good = good && (settings->ramp_s > 0 || join(crowd, crowd->count));
        crowd->count++;
    }
    return good;
}

static bool has_failed(const struct crowd *crowd)
{
    return atomic_load(&crowd->load->shared->failed);
}

/* Everybody's plan begins; who has joined already asks when it says. */
static void begin(struct crowd *crowd)
{
    for (uint32_t i = 0; i < crowd->count; i++) {
        load_pace_begin(&crowd->actors[i].pace, crowd->load, number_of(crowd, i));
    }
}

/* A client whose plan begins joins first. */
static void join_if_due(struct crowd *crowd, uint32_t i)
{
    struct load_pace pace = crowd->actors[i].pace;
    if (common_now_ns() >= pace.due_ns) {
        if (!join(crowd, i)) {
            atomic_store(&crowd->load->shared->failed, true);
        }
        crowd->actors[i].pace = pace;
    }
}

/* Count what overload has kept them from: no latency tells of what was not asked at all.
 * What has waited for less than is allowed might have been in time. */
static void count_unsent(struct crowd *crowd)
{
    const struct load_settings *settings = &crowd->load->settings;
    double allowed_ns = 1e6 * fmax(settings->deadline_ms, settings->p99_ms);
    for (uint32_t i = 0; i < crowd->count && settings->hz > 0; i++) {
        struct load_pace *pace = &crowd->actors[i].pace;
        while ((double)pace->due_ns + allowed_ns < (double)crowd->enough_ns) {
            crowd->tally->unsent++;
            load_pace_next(pace, crowd->load, crowd->enough_ns);
        }
    }
}

/* One turn of each that has something to do. Returns whether any of them goes on. */
static bool take_turns(struct crowd *crowd, uint64_t *wake_ns)
{
    bool enough = atomic_load(&crowd->load->shared->enough);
    bool goes_on = false;
    uint64_t now_ns = common_now_ns();
    *wake_ns = now_ns + NAP_NS;
    if (enough && crowd->enough_ns == 0) {
        crowd->enough_ns = now_ns;
    }
    for (uint32_t i = 0; i < crowd->count && !has_failed(crowd); i++) {
        struct load_actor *actor = &crowd->actors[i];
        bool more = !enough || actor->next < crowd->load->settings.requests;
        bool readable =
            crowd->fds[2 * i].revents != 0 || crowd->fds[2 * i + 1].revents != 0;
        if (!actor->client) {
            join_if_due(crowd, i);
        } else if (readable || load_actor_wake_ns(actor, more) <= now_ns) {
            (void)load_actor_turn(actor, more, readable);
        }
        load_actor_check(actor, now_ns);
        uint64_t next_ns =
            actor->client ? load_actor_wake_ns(actor, more) : actor->pace.due_ns;
        *wake_ns = next_ns < *wake_ns ? next_ns : *wake_ns;
        goes_on = goes_on || more || actor->pending_count > 0;
    }
    return goes_on && !has_failed(crowd);
}

/* Until something can be read or is due. */
static void nap(struct crowd *crowd, uint64_t wake_ns)
{
    uint64_t now_ns = common_now_ns();
    uint64_t left_ns = wake_ns > now_ns ? wake_ns - now_ns : 0;
    struct timespec left = {0, (long)(left_ns < NAP_NS ? left_ns : NAP_NS)};
    for (uint32_t i = 0; i < crowd->count; i++) {
        const struct load_actor *actor = &crowd->actors[i];
        bool reads = actor->client && now_ns >= actor->stall_until_ns;
        struct pollfd *fds = &crowd->fds[2 * (size_t)i];
        fds[0] = fds[1] = (struct pollfd){.fd = -1};
        if (reads) {
            load_actor_fds(actor, fds);
        }
    }
    (void)ppoll(crowd->fds, 2 * (nfds_t)crowd->count, &left, NULL);
}

static int run(struct load *load, uint32_t index)
{
    struct load_shared *shared = load->shared;
    struct crowd crowd = {.load = load, .tally = &shared->crowd[index], .index = index};
    uint64_t wake_ns;
    (void)prctl(PR_SET_TIMERSLACK, 1000, 0, 0, 0); /* requests go out when they are due */
    crowd.actors = calloc(load->settings.clients, sizeof *crowd.actors);
    crowd.fds = calloc(2 * (size_t)load->settings.clients, sizeof *crowd.fds);
    if (!crowd.actors || !crowd.fds || !open_all(&crowd)) {
        atomic_store(&shared->failed, true);
        return 1;
    }
    atomic_fetch_add(&shared->ready, 1);
    while (!atomic_load(&shared->go) && !has_failed(&crowd)) {
        load_sleep_ms(1);
    }
    begin(&crowd);
    while (take_turns(&crowd, &wake_ns)) {
        nap(&crowd, wake_ns);
    }
    count_unsent(&crowd);
    for (uint32_t i = 0; i < crowd.count; i++) {
        if (crowd.actors[i].client) {
            load_actor_close(&crowd.actors[i]);
        }
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
    struct load_actor actor = {.load = load,
                               .tally = tally,
                               .number = number,
                               .is_alone = true,
                               .sheet_first = sheet_first};
    int status = load_actor_open(&actor, true);
    while (status == 0 && (actor.next < LOAD_FRAMES || actor.pending_count > 0)) {
        bool more = actor.next < LOAD_FRAMES;
        if (!load_actor_turn(&actor, more, true) && actor.pending_count > 0) {
            struct pollfd fd = {.fd = pccd_fd(actor.client), .events = POLLIN};
            (void)poll(&fd, 1, NAP_NS / 1000000);
        }
        status = tally->broken > 0 ? PCCD_E_DISCONNECTED : 0;
    }
    load_actor_close(&actor);
    return status;
}

static int go_rounds(struct load *load)
{
    struct load_tally *tally = calloc(1, sizeof *tally);
    uint32_t count = load->settings.clients + load->settings.victims;
    int status = tally ? 0 : PCCD_E_NOMEM;
    for (uint32_t i = 0; i < count && status == 0; i++) {
        for (int order = 0; order < (int)LOAD_ORDERS && status == 0; order++) {
            status = go_round(load, i, order == 1, tally);
        }
    }
    atomic_store(&load->shared->truth_records, tally ? tally->records : 0);
    free(tally);
    return status;
}

bool load_crowd_find_truth(struct load *load)
{
    int status = -1;
    pid_t parent = getpid();
    pid_t pid = fork();
    if (pid == 0) {
        bool is_orphan = prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent;
        _exit(is_orphan || go_rounds(load) != 0 ? 1 : 0);
    }
    return pid > 0 && waitpid(pid, &status, 0) == pid && status == 0;
}
