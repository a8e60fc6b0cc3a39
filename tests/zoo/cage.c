/* cage.c - one hostile client, in a process of its own. */
#include "cage.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "daemon.h"

#define READY_MS 20000
#define END_MS   20000

bool zoo_fail(struct zoo_cage *cage, int line, const char *what)
{
    (void)snprintf(cage->what, sizeof cage->what, "%s", what);
    atomic_store(&cage->line, line);
    return false;
}

/* In the child: act until the keeper says that it is enough. */
static void live(struct zoo_cage *cage, const struct zoo_animal *animal)
{
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (!atomic_load(&cage->stop)) {
        if (!animal->act(cage)) {
            _exit(1);
        }
        atomic_fetch_add(&cage->acts, 1);
        while (animal->sleeps && !atomic_load(&cage->stop)) {
            test_sleep_ms(5);
        }
    }
    _exit(0);
}

static uint64_t microseconds(struct timeval time)
{
    return (uint64_t)time.tv_sec * 1000000u + (uint64_t)time.tv_usec;
}

static bool all_ready(const struct zoo_den *den)
{
    for (unsigned i = 0; i < den->each; i++) {
        if (atomic_load(&den->cages[i].acts) == 0 &&
            atomic_load(&den->cages[i].line) == 0) {
            return false;
        }
    }
    return true;
}

static bool none_failed(const struct zoo_den *den)
{
    for (unsigned i = 0; i < den->each; i++) {
        if (atomic_load(&den->cages[i].line) != 0) {
            return false;
        }
    }
    return true;
}

bool zoo_open(struct zoo_den *den, const struct zoo_animal *animal, const char *socket,
              unsigned each, bool patient, unsigned pause_ms)
{
    uint64_t until_ms = test_now_ms() + READY_MS + (patient ? 2 * pause_ms : 0);

    memset(den, 0, sizeof *den);
    den->begin_us = test_now_us();
    den->cages = mmap(NULL, ZOO_EACH_MAX * sizeof *den->cages, PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (den->cages == MAP_FAILED) {
        return false;
    }
    for (; den->each < each; den->each++) {
        struct zoo_cage *cage = &den->cages[den->each];
        pid_t pid;

        *cage = (struct zoo_cage){.socket = socket,
                                  .number = den->each,
                                  .patient = patient,
                                  .pause_ms = pause_ms,
                                  .burst_us = animal->burst_us,
                                  .rest_us = animal->rest_us};
        pid = fork();
        if (pid == 0) {
            live(cage, animal);
        }
        if (pid < 0) {
            return false;
        }
        den->pids[den->each] = pid;
    }
    while (!all_ready(den) && test_now_ms() < until_ms) {
        test_sleep_ms(1);
    }
    return all_ready(den) && none_failed(den);
}

unsigned zoo_close(struct zoo_den *den)
{
    uint64_t until_ms = test_now_ms() + END_MS + den->cages[0].pause_ms;
    unsigned acts = 0;
    bool right = none_failed(den);

    for (unsigned i = 0; i < den->each; i++) {
        atomic_store(&den->cages[i].stop, true);
        (void)kill(den->pids[i], SIGCONT);
    }
    for (unsigned i = 0; i < den->each; i++) {
        struct rusage used = {.ru_utime = {0, 0}};
        int status = 0;

        while (wait4(den->pids[i], &status, WNOHANG, &used) == 0) {
            if (test_now_ms() >= until_ms) {
                (void)kill(den->pids[i], SIGKILL);
                (void)zoo_fail(&den->cages[i], __LINE__, "it ends when it is told to");
            }
            test_sleep_ms(1);
        }
        right = right && WIFEXITED(status) && WEXITSTATUS(status) == 0;
        acts += atomic_load(&den->cages[i].acts);
        den->work_us += microseconds(used.ru_utime) + microseconds(used.ru_stime);
    }
    den->wall_us = test_now_us() - den->begin_us;
    return right ? acts : 0;
}

/* ---- what an animal takes by being there ------------------------------------------- */

static uint64_t worked_us(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000;
}

static bool burn(struct zoo_cage *cage)
{
    uint64_t until_us = worked_us() + cage->burst_us;

    while (worked_us() < until_us) {
    }
    (void)usleep(cage->rest_us);
    return true;
}

struct zoo_animal zoo_burner(const struct zoo_den *den, unsigned acts)
{
    uint64_t burst_us = den->work_us / (acts > 0 ? acts : 1);
    double share = (double)den->work_us / (double)(den->wall_us * den->each);

    burst_us = burst_us < 20 ? 20 : burst_us > 1000 ? 1000 : burst_us;
    share = share < 0.001 ? 0.001 : share > 1 ? 1 : share;
    return (struct zoo_animal){
        .name = "burns",
        .act = burn,
        .burst_us = (unsigned)burst_us,
        .rest_us = (unsigned)((double)burst_us * (1 / share - 1)),
    };
}

void zoo_say(const struct zoo_den *den, const struct zoo_animal *animal)
{
    for (unsigned i = 0; i < den->each; i++) {
        const struct zoo_cage *cage = &den->cages[i];

        if (atomic_load(&cage->line) != 0) {
            fprintf(stderr, "# %s %u: after %u acts, line %d: not %s\n", animal->name, i,
                    atomic_load(&cage->acts), atomic_load(&cage->line), cage->what);
        }
    }
}

/* ---- what most begin with ---------------------------------------------------------- */

bool zoo_enter(struct zoo_cage *cage, struct test_raw *raw, uint64_t slot_bytes)
{
    EXPECT(cage, test_raw_open(raw, cage->socket));
    EXPECT(cage, test_raw_hello(raw) == 0);
    EXPECT(cage, slot_bytes == 0 || test_raw_attach(raw, 2, slot_bytes) == 0);
    return true;
}
