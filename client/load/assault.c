/* assault.c - random kills, of clients and of the daemon's worker. */
#include "target.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "actor.h"

/* The life of a victim: any octave of these is as likely. It connects, registers and
 * steps in some 2 ms when the daemon is idle, and in a hundred times that when it is not,
 * so that its end falls into any part of its life. */
#define LIFE_NS      100000u
#define LIFE_OCTAVES 12u

static uint64_t draw(struct load_assault *assault, uint64_t below)
{
    return load_mix(assault->load->settings.seed ^ 0xa55a, assault->luck++) % below;
}

/* In the child: a client, until it is killed. */
static void live(const struct load *load, uint32_t index, pid_t parent)
{
    const struct load_actor unborn = {.load = load,
                                      .tally = &load->shared->victims[index],
                                      .number = load->settings.clients + index};
    struct load_actor actor = unborn;
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent) {
        _exit(1);
    }
    while (load_actor_open(&actor, false) != 0) {
        load_actor_close(&actor); /* the worker may have been killed in the middle */
        load_sleep_ms(1);
        actor = unborn;
    }
    for (;;) {
        if (!load_actor_turn(&actor, true, true)) {
            struct pollfd fds[2];
            load_actor_fds(&actor, fds);
            (void)poll(fds, 2, 20);
        }
    }
}

static void renew(struct load_assault *assault, uint32_t index)
{
    struct load_victim *victim = &assault->victims[index];
    pid_t parent = getpid();
    victim->pid = fork();
    if (victim->pid == 0) {
        live(assault->load, index, parent);
        _exit(1);
    }
    if (victim->pid < 0) {
        victim->pid = 0;
        load_say("fork failed");
        atomic_store(&assault->load->shared->failed, true);
    }
    uint64_t octave = (uint64_t)LIFE_NS << draw(assault, LIFE_OCTAVES);
    victim->end_ns = common_now_ns() + octave + draw(assault, octave);
}

static void end(struct load_victim *victim, uint64_t *strays)
{
    int status;
    kill(victim->pid, SIGKILL);
    (void)waitpid(victim->pid, &status, 0);
    *strays += !(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    victim->pid = 0;
}

void load_assault_begin(struct load_assault *assault, struct load *load)
{
    *assault = (struct load_assault){.load = load, .begin_ns = common_now_ns()};
    assault->crash_ns = assault->begin_ns + (uint64_t)load->settings.pause_ms * 1000000u;
}

/* The part of a run that takes a set time in which workers are killed: how memory goes on
 * is seen over the rest, of one worker. */
#define CRASH_PART (1.0 / 6)

/* Return how many of `all` kills that are spread over a part of the run may have been
 * made. */
static uint64_t due(const struct load_assault *assault, uint64_t all, double part)
{
    double whole_ns = load_settings_ns(&assault->load->settings) * part;
    double share = (double)(common_now_ns() - assault->begin_ns) / fmax(whole_ns, 1);
    return share < 1 ? (uint64_t)ceil(share * (double)all) : all;
}

static void kill_victims(struct load_assault *assault)
{
    const struct load_settings *settings = &assault->load->settings;
    uint64_t now_ns = common_now_ns();
    for (uint32_t i = 0; i < settings->victims; i++) {
        struct load_victim *victim = &assault->victims[i];
        if (victim->pid > 0 && now_ns >= victim->end_ns) {
            end(victim, &assault->strays);
            assault->kills++;
        }
        if (victim->pid == 0 && assault->kills < due(assault, settings->kills, 1)) {
            renew(assault, i);
        }
    }
}

static void kill_worker(struct load_assault *assault)
{
    const struct load_settings *settings = &assault->load->settings;
    uint64_t pause_ns = (uint64_t)settings->pause_ms * 1000000u;
    if (assault->crashes >= due(assault, settings->crashes, CRASH_PART) ||
        common_now_ns() < assault->crash_ns) {
        return;
    }
    pid_t worker = load_target_pid(assault->load);
    if (worker > 0 && worker != assault->worker && kill(worker, SIGKILL) == 0) {
        assault->worker = worker;
        assault->crashes++;
        assault->crash_ns = common_now_ns() + pause_ns / 2 + draw(assault, pause_ns + 1);
    }
}

bool load_assault_turn(struct load_assault *assault)
{
    const struct load_settings *settings = &assault->load->settings;
    kill_victims(assault);
    kill_worker(assault);
    return assault->kills < settings->kills || assault->crashes < settings->crashes;
}

void load_assault_end(struct load_assault *assault)
{
    for (uint32_t i = 0; i < LOAD_VICTIM_MAX; i++) {
        if (assault->victims[i].pid > 0) {
            end(&assault->victims[i], &assault->strays);
        }
    }
}
