/* affinity.c - where the threads of a team run. */
#include "affinity.h"

#include <assert.h>
#include <omp.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stddef.h>
#include <time.h>

/* Where a thread may be bound besides on one processor: on all of the places, or on all
 * but the n-th (KEPT_OFF - n); UNKNOWN is none of them. */
enum { KEPT_OFF = -3, UNKNOWN = -2, ANYWHERE = -1 };

/* ---- processors -------------------------------------------------------------------- */

/* List the processors of the process. OMP_PROC_BIND has the runtime bind the first thread
 * to one of them before main: the others are still there. */
static bool list_processors(cpu_set_t *set)
{
    int ids[ENG_PROCESSORS_MAX];
    if (sched_getaffinity(0, sizeof *set, set) != 0) {
        return false;
    }
    int bound = omp_get_proc_bind() == omp_proc_bind_false ? 0 : omp_get_num_places();
    for (int place = 0; place < bound; place++) {
        int count = omp_get_place_num_procs(place);
        if (count > 0 && count <= (int)ENG_PROCESSORS_MAX) {
            omp_get_place_proc_ids(place, ids);
            for (int i = 0; i < count; i++) {
                CPU_SET((size_t)ids[i], set); /* beyond the set: nothing */
            }
        }
    }
    return true;
}

void eng_affinity_init(struct eng_affinity *affinity)
{
    cpu_set_t set;
    affinity->count = 0;
    affinity->team = 0;
    affinity->is_guest = false;
    affinity->first_on = 0;
    (void)omp_get_max_threads();
    if (!list_processors(&set)) {
        return;
    }
    for (uint32_t cpu = 0; cpu < CPU_SETSIZE && affinity->count < ENG_PROCESSORS_MAX;
         cpu++) {
        if (CPU_ISSET(cpu, &set)) {
            affinity->cpu[affinity->count++] = (uint16_t)cpu;
        }
    }
}

void eng_affinity_for_team(const struct eng_affinity *first, uint32_t team,
                           struct eng_affinity *affinity)
{
    assert(team < ENG_TEAMS_MAX);
    *affinity = *first;
    affinity->team = team;
    for (uint32_t i = 0; i < first->count; i++) {
        affinity->cpu[i] = first->cpu[(i + team) % first->count];
    }
}

/* Bind `thread` to that processor, which is one of the places, or as above. */
static bool bind_to(const struct eng_affinity *affinity, int cpu, pthread_t thread)
{
    assert(affinity->count <= ENG_PROCESSORS_MAX);
    cpu_set_t set;
    CPU_ZERO(&set);
    for (uint32_t i = 0; i < affinity->count; i++) {
        bool is_meant = cpu == ANYWHERE || affinity->cpu[i] == cpu ||
                        (cpu <= KEPT_OFF && affinity->cpu[i] != KEPT_OFF - cpu);
        if (is_meant) {
            CPU_SET(affinity->cpu[i], &set);
        }
    }
    return pthread_setaffinity_np(thread, sizeof set, &set) == 0;
}

bool eng_affinity_unbind_thread(const struct eng_affinity *affinity)
{
    return bind_to(affinity, ANYWHERE, pthread_self());
}

uint32_t eng_affinity_processors(const struct eng_affinity *affinity)
{
    static atomic_uint known;
    if (affinity) {
        return affinity->count;
    }
    uint32_t count = atomic_load_explicit(&known, memory_order_relaxed);
    if (count == 0) {
        cpu_set_t set;
        count = list_processors(&set) ? (uint32_t)CPU_COUNT(&set) : 1;
        atomic_store_explicit(&known, count, memory_order_relaxed);
    }
    return count;
}

/* ---- teammates: the threads of a team, as they see each other --------------------- */

/* There is one table for the process, with a row for each team: a runtime may end its
 * threads after everything else of theirs is gone. Teams with the same number would take
 * each other's teammates, and lend nothing. */
#define TEAMMATES_MAX 256u /* threads of a team */

/* One that waits sleeps for 160 us at most (wait.c), and runs for some then. Longer: what
 * it waits for has come or not, it cannot look, because somebody else has its processor;
 * and the others wait for it, 4 ms of a tick where one burns. */
#define ASLEEP_NS 400000u

/* The teammate of one thread of a team. */
struct teammate {
    _Alignas(128) _Atomic(const struct eng_affinity *) affinity; /* NULL: empty */
    atomic_bool is_waiting;
    atomic_bool is_away; /* on a processor that was lent */
    pthread_t thread;    /* alive while the teammate is not empty and the lock is held */
};

static struct teammate teammates[ENG_TEAMS_MAX][TEAMMATES_MAX];
static pthread_mutex_t teammates_lock =
    PTHREAD_MUTEX_INITIALIZER; /* who sits; the last lock */
static pthread_once_t teammates_once = PTHREAD_ONCE_INIT;
static pthread_key_t teammates_key; /* a thread's own teammate, left when it ends */
static bool has_key;
static _Thread_local struct teammate *own_entry;

/* The thread ends, or sits down elsewhere. */
static void leave_team(void *context)
{
    struct teammate *teammate = context;
    pthread_mutex_lock(&teammates_lock);
    if (pthread_equal(teammate->thread, pthread_self())) {
        atomic_store_explicit(&teammate->affinity, NULL, memory_order_relaxed);
    }
    pthread_mutex_unlock(&teammates_lock);
}

static void make_key(void)
{
    has_key = pthread_key_create(&teammates_key, leave_team) == 0;
}

/* Without the memory for it nobody is lent a processor, and all else goes on. */
static void join_team(const struct eng_affinity *affinity, struct teammate *teammate)
{
    pthread_once(&teammates_once, make_key);
    if (!has_key || pthread_setspecific(teammates_key, teammate) != 0) {
        return;
    }
    if (own_entry && own_entry != teammate) {
        leave_team(own_entry);
    }
    pthread_mutex_lock(&teammates_lock);
    teammate->thread = pthread_self();
    atomic_store_explicit(&teammate->is_waiting, false, memory_order_relaxed);
    atomic_store_explicit(&teammate->is_away, false, memory_order_relaxed);
    atomic_store_explicit(&teammate->affinity, affinity, memory_order_relaxed);
    pthread_mutex_unlock(&teammates_lock);
    own_entry = teammate;
}

/* NULL: none, as nobody has a processor of its own. */
static struct teammate *teammate_of(const struct eng_affinity *affinity, uint32_t thread,
                                    uint32_t team_count)
{
    bool has_own = affinity && !affinity->is_guest && team_count <= affinity->count;
    return has_own && thread < TEAMMATES_MAX ? &teammates[affinity->team][thread] : NULL;
}

/* The calling thread is the `thread`-th of a team, until it ends or is another. Nothing
 * without places, or where there are fewer than threads. */
static void join_as_teammate(const struct eng_affinity *affinity, uint32_t thread,
                             uint32_t team_count)
{
    struct teammate *teammate = teammate_of(affinity, thread, team_count);
    if (teammate &&
        (teammate != own_entry ||
         atomic_load_explicit(&teammate->affinity, memory_order_relaxed) != affinity)) {
        join_team(affinity, teammate);
    }
}

/* True: it was lent a processor, and is to go back to its own. */
static bool end_loan(const struct eng_affinity *affinity, uint32_t thread,
                     uint32_t team_count)
{
    struct teammate *teammate = teammate_of(affinity, thread, team_count);
    if (!teammate || !atomic_load_explicit(&teammate->is_away, memory_order_relaxed)) {
        return false;
    }
    atomic_store_explicit(&teammate->is_away, false, memory_order_relaxed);
    return true;
}

void eng_processor_set_waiting(const struct eng_affinity *affinity, uint32_t thread,
                               bool is_waiting)
{
    assert(!affinity || affinity->team < ENG_TEAMS_MAX);
    if (affinity && thread < TEAMMATES_MAX) {
        atomic_store_explicit(&teammates[affinity->team][thread].is_waiting, is_waiting,
                              memory_order_relaxed);
    }
}

/* Nanoseconds of a processor that it has had; 0: unknown. Locked, it sits. */
static uint64_t time_of(const struct teammate *teammate)
{
    clockid_t clock;
    struct timespec time;
    if (pthread_getcpuclockid(teammate->thread, &clock) != 0 ||
        clock_gettime(clock, &time) != 0) {
        return 0;
    }
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

/* Look at one that sits; true: it was moved. Locked. */
static bool look_at(const struct eng_affinity *affinity, struct teammate *teammate,
                    uint64_t now_ns, struct eng_processor_look *look)
{
    uint64_t ran_ns = time_of(teammate);
    if (look->ran_ns == 0) {
        look->ran_ns = ran_ns; /* the next look tells */
        look->since_ns = now_ns;
        return false;
    }
    bool has_run = ran_ns != look->ran_ns;
    if (!has_run && now_ns - look->since_ns < ASLEEP_NS &&
        atomic_load_explicit(&teammate->is_waiting, memory_order_relaxed)) {
        return false; /* it may be asleep */
    }
    look->ran_ns = 0;
    look->mate++;
    if (has_run) {
        return false;
    }
    /* The flag first: the thread may run at once, and is to find it. */
    atomic_store_explicit(&teammate->is_away, true, memory_order_relaxed);
    return bind_to(affinity, sched_getcpu(), teammate->thread);
}

/* The mate to look at, from that of `look` on: one that works, or if none does, one that
 * waits, maybe for nothing that is still to come. Not while a look at it has begun. */
static struct teammate *choose(const struct eng_affinity *affinity, uint32_t thread,
                               uint32_t team_count, struct eng_processor_look *look)
{
    uint32_t others = team_count - 1;
    look->mate %= others;
    for (uint32_t i = 0; i < others && look->ran_ns == 0; i++) {
        uint32_t mate = (look->mate + i) % others;
        const struct teammate *teammate =
            teammate_of(affinity, (thread + 1 + mate) % team_count, team_count);
        if (teammate &&
            !atomic_load_explicit(&teammate->is_waiting, memory_order_relaxed)) {
            look->mate = mate;
            break;
        }
    }
    return teammate_of(affinity, (thread + 1 + look->mate) % team_count, team_count);
}

bool eng_processor_lend(const struct eng_affinity *affinity, uint32_t thread,
                        uint32_t team_count, uint64_t now_ns,
                        struct eng_processor_look *look)
{
    assert(look && team_count >= 1);
    if (!teammate_of(affinity, thread, team_count) || team_count < 2) {
        return false;
    }
    struct teammate *teammate = choose(affinity, thread, team_count, look);
    if (!teammate || pthread_mutex_trylock(&teammates_lock) != 0) {
        return false;
    }
    bool is_moved = false;
    if (atomic_load_explicit(&teammate->affinity, memory_order_relaxed) == affinity &&
        !atomic_load_explicit(&teammate->is_away, memory_order_relaxed)) {
        is_moved = look_at(affinity, teammate, now_ns, look);
    } else {
        look->ran_ns = 0;
        look->mate++;
    }
    pthread_mutex_unlock(&teammates_lock);
    return is_moved;
}

/* ---- threads ----------------------------------------------------------------------- */

/* Where this thread was bound. A new one inherits the mask of the thread that opened the
 * region, not this. */
static _Thread_local int placed_on = UNKNOWN;

void eng_affinity_bind_thread(const struct eng_affinity *affinity, uint32_t thread,
                              uint32_t team_count)
{
    assert(thread < team_count);
    if (!affinity || affinity->count == 0) {
        return;
    }
    if (affinity->is_guest && thread == 0) {
        return;
    }
    join_as_teammate(affinity, thread, team_count);
    if (end_loan(affinity, thread, team_count)) {
        placed_on = UNKNOWN;
    }
    int place = team_count > affinity->count ? ANYWHERE
                : affinity->is_guest         ? KEPT_OFF - affinity->first_on
                                             : affinity->cpu[thread];
    if (placed_on != place && bind_to(affinity, place, pthread_self())) {
        placed_on = place;
    }
}

void eng_affinity_return(const struct eng_affinity *affinity, uint32_t thread,
                         uint32_t team_count)
{
    if (end_loan(affinity, thread, team_count)) {
        placed_on = UNKNOWN;
        eng_affinity_bind_thread(affinity, thread, team_count);
    }
}
