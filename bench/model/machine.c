/* machine.c - what it costs here that threads meet.
 *
 * See machine.h. What one thread does alone is timed in loops; what takes two, turn by
 * turn: one prepares, tells the other through a line of its own, and the other times one
 * operation.
 */
#include "machine.h"

#include <linux/futex.h>
#include <omp.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "clock.h"
#include "deque.h"
#include "relax.h"
#include "report.h"
#include "task.h"

#define LOOPS    20000
#define TURNS    2001
#define SLEEPS   201
#define SLEEPERS 8

static double median_of(struct bench_samples *samples)
{
    double p50 = bench_summarise(samples).p50;
    bench_clear(samples);
    return p50;
}

static double per(uint64_t begin_ns, uint32_t count)
{
    return (double)(common_now_ns() - begin_ns) / count;
}

/* ---- alone ----------------------------------------------------------------------- */

static void measure_alone(struct model_machine *machine)
{
    static struct eng_deque deque;
    static atomic_uint counter;
    struct bench_samples samples[5] = {0};
    pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    eng_deque_init(&deque);
    for (int repeat = 0; repeat < 21; repeat++) {
        uint64_t task;
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < LOOPS; i++) {
            atomic_fetch_add_explicit(&counter, 1, memory_order_relaxed);
        }
        bench_add(&samples[0], per(begin_ns, LOOPS));
        begin_ns = common_now_ns();
        for (uint32_t i = 0; i < 1000; i++) {
            eng_deque_push(&deque, i);
        }
        bench_add(&samples[1], per(begin_ns, 1000));
        begin_ns = common_now_ns();
        for (uint32_t i = 0; i < 1000; i++) {
            eng_deque_pop(&deque, &task);
        }
        bench_add(&samples[2], per(begin_ns, 1000));
        begin_ns = common_now_ns();
        for (uint32_t i = 0; i < LOOPS; i++) {
            eng_deque_steal(&deque, &task);
        }
        bench_add(&samples[3], per(begin_ns, LOOPS));
        begin_ns = common_now_ns();
        for (uint32_t i = 0; i < LOOPS; i++) {
            pthread_mutex_lock(&mutex);
            pthread_mutex_unlock(&mutex);
        }
        bench_add(&samples[4], per(begin_ns, LOOPS));
    }
    machine->local = median_of(&samples[0]);
    machine->push = median_of(&samples[1]);
    machine->pop = median_of(&samples[2]);
    machine->probe = median_of(&samples[3]);
    machine->lock = median_of(&samples[4]);
    for (int i = 0; i < 5; i++) {
        bench_free(&samples[i]);
    }
}

/* ---- by turns -------------------------------------------------------------------- */

enum turn { TURN_ADD, TURN_STEAL, TURN_LOCK, TURNS_COUNT };

static struct {
    const struct eng_affinity *affinity;
    _Alignas(128) atomic_uint ready; /* turns prepared */
    _Alignas(128) atomic_uint done;
    _Alignas(128) atomic_uint line;
    _Alignas(128) pthread_mutex_t mutex;
    struct eng_deque deque;
    enum turn turn;
    struct bench_samples samples;
} by_turns;

static void until(atomic_uint *flag, uint32_t value)
{
    while (atomic_load_explicit(flag, memory_order_acquire) < value) {
        sched_yield();
    }
}

static void *second_of_turns(void *arg)
{
    (void)arg;
    eng_affinity_bind_thread(by_turns.affinity, 1, 2);
    for (uint32_t i = 1; i <= TURNS; i++) {
        uint64_t task;
        while (atomic_load_explicit(&by_turns.ready, memory_order_acquire) < i) {
        }
        uint64_t begin_ns = common_now_ns();
        switch (by_turns.turn) {
        case TURN_ADD:
            atomic_fetch_add_explicit(&by_turns.line, 1, memory_order_seq_cst);
            break;
        case TURN_STEAL:
            eng_deque_steal(&by_turns.deque, &task);
            break;
        default:
            pthread_mutex_lock(&by_turns.mutex);
            pthread_mutex_unlock(&by_turns.mutex);
            break;
        }
        bench_add(&by_turns.samples, (double)(common_now_ns() - begin_ns));
        atomic_store_explicit(&by_turns.done, i, memory_order_release);
    }
    return NULL;
}

/* Median of what the second thread took, less the clock. */
static double measure_turn(const struct eng_affinity *affinity, enum turn turn,
                           double clock_ns)
{
    pthread_t second;
    by_turns.affinity = affinity;
    by_turns.turn = turn;
    atomic_init(&by_turns.ready, 0);
    atomic_init(&by_turns.done, 0);
    pthread_mutex_init(&by_turns.mutex, NULL);
    eng_deque_init(&by_turns.deque);
    if (pthread_create(&second, NULL, second_of_turns, NULL) != 0) {
        exit(2);
    }
    for (uint32_t i = 1; i <= TURNS; i++) {
        atomic_fetch_add_explicit(&by_turns.line, 1, memory_order_seq_cst);
        eng_deque_push(&by_turns.deque, i);
        pthread_mutex_lock(&by_turns.mutex);
        pthread_mutex_unlock(&by_turns.mutex);
        atomic_store_explicit(&by_turns.ready, i, memory_order_release);
        until(&by_turns.done, i);
    }
    pthread_join(second, NULL);
    double ns = median_of(&by_turns.samples) - clock_ns;
    bench_free(&by_turns.samples);
    pthread_mutex_destroy(&by_turns.mutex);
    return ns > 0 ? ns : 0;
}

/* Two threads taking one lock again and again. */
static void *fight(void *arg)
{
    eng_affinity_bind_thread(by_turns.affinity, arg ? 1 : 0, 2);
    for (uint32_t i = 0; i < LOOPS; i++) {
        pthread_mutex_lock(&by_turns.mutex);
        by_turns.turn = TURN_LOCK;
        pthread_mutex_unlock(&by_turns.mutex);
    }
    return NULL;
}

static double measure_fight(const struct eng_affinity *affinity)
{
    struct bench_samples samples = {0};
    by_turns.affinity = affinity;
    pthread_mutex_init(&by_turns.mutex, NULL);
    for (int repeat = 0; repeat < 11; repeat++) {
        pthread_t second;
        uint64_t begin_ns = common_now_ns();
        if (pthread_create(&second, NULL, fight, &samples) != 0) {
            exit(2);
        }
        fight(NULL);
        pthread_join(second, NULL);
        bench_add(&samples, per(begin_ns, 2 * LOOPS));
    }
    double ns = median_of(&samples);
    bench_free(&samples);
    pthread_mutex_destroy(&by_turns.mutex);
    return ns;
}

/* ---- sleep and wake -------------------------------------------------------------- */

static struct {
    const struct eng_affinity *affinity;
    pthread_mutex_t mutex;
    pthread_cond_t cond;
    uint32_t turn;         /* under the lock */
    uint64_t signalled_ns; /* under the lock */
    atomic_uint asleep;    /* turns in which the sleeper holds the lock, about to wait */
    struct bench_samples wake;
} sleeper = {.mutex = PTHREAD_MUTEX_INITIALIZER, .cond = PTHREAD_COND_INITIALIZER};

static void *sleep_by_turns(void *arg)
{
    (void)arg;
    eng_affinity_bind_thread(sleeper.affinity, 1, 2);
    pthread_mutex_lock(&sleeper.mutex);
    for (uint32_t i = 1; i <= SLEEPS; i++) {
        atomic_store_explicit(&sleeper.asleep, i, memory_order_release);
        while (sleeper.turn < i) {
            pthread_cond_wait(&sleeper.cond, &sleeper.mutex);
        }
        bench_add(&sleeper.wake, (double)(common_now_ns() - sleeper.signalled_ns));
    }
    pthread_mutex_unlock(&sleeper.mutex);
    return NULL;
}

static void measure_wake(struct model_machine *machine,
                         const struct eng_affinity *affinity)
{
    struct bench_samples samples = {0};
    pthread_t second;
    sleeper.affinity = affinity;
    if (pthread_create(&second, NULL, sleep_by_turns, NULL) != 0) {
        exit(2);
    }
    for (uint32_t i = 1; i <= SLEEPS; i++) {
        until(&sleeper.asleep, i);
        /* The lengths of a thread's sleep in a step: tens of microseconds and more. */
        nanosleep(&(struct timespec){0, 100000}, NULL);
        pthread_mutex_lock(&sleeper.mutex);
        uint64_t begin_ns = common_now_ns();
        sleeper.turn = i;
        sleeper.signalled_ns = begin_ns;
        pthread_cond_signal(&sleeper.cond);
        pthread_mutex_unlock(&sleeper.mutex);
        bench_add(&samples, (double)(common_now_ns() - begin_ns));
    }
    pthread_join(second, NULL);
    machine->signal = median_of(&samples) - machine->clock;
    machine->wake = median_of(&sleeper.wake) - machine->clock;
    bench_free(&samples);
    bench_free(&sleeper.wake);
}

static struct {
    atomic_uint word;
    atomic_uint waiting;
    atomic_bool over;
} common;

static long futex(int operation, uint32_t value)
{
    return syscall(SYS_futex, &common.word, operation | FUTEX_PRIVATE_FLAG, value, NULL,
                   NULL, 0);
}

static void *wait_together(void *arg)
{
    (void)arg;
    while (!atomic_load(&common.over)) {
        uint32_t word = atomic_load(&common.word);
        atomic_fetch_add(&common.waiting, 1);
        while (atomic_load(&common.word) == word) {
            futex(FUTEX_WAIT, word);
        }
    }
    return NULL;
}

/* Wake eight at once, one at once: the difference, by seven. */
static double measure_futex(void)
{
    struct bench_samples samples[2] = {0};
    pthread_t threads[SLEEPERS];
    for (int k = 0; k < 2; k++) {
        uint32_t count = k ? SLEEPERS : 1;
        atomic_store(&common.over, false);
        atomic_store(&common.waiting, 0);
        for (uint32_t i = 0; i < count; i++) {
            if (pthread_create(&threads[i], NULL, wait_together, NULL) != 0) {
                exit(2);
            }
        }
        for (uint32_t turn = 1; turn <= SLEEPS; turn++) {
            until(&common.waiting, count * turn);
            nanosleep(&(struct timespec){0, 100000}, NULL);
            atomic_store(&common.over, turn == SLEEPS);
            atomic_fetch_add(&common.word, 1);
            uint64_t begin_ns = common_now_ns();
            futex(FUTEX_WAKE, INT32_MAX);
            bench_add(&samples[k], (double)(common_now_ns() - begin_ns));
        }
        for (uint32_t i = 0; i < count; i++) {
            pthread_join(threads[i], NULL);
        }
    }
    /* Minima: eight woken threads compete with the waker for two processors. */
    double one = bench_summarise(&samples[0]).min;
    double all = bench_summarise(&samples[1]).min;
    bench_free(&samples[0]);
    bench_free(&samples[1]);
    return all > one ? (all - one) / (SLEEPERS - 1) : 0;
}

/* ---- the team -------------------------------------------------------------------- */

static void measure_team(struct model_machine *machine,
                         const struct eng_affinity *affinity)
{
    struct bench_samples barrier = {0};
    struct bench_samples region = {0};
    eng_affinity_warm_up(affinity, 2);
    for (int repeat = 0; repeat < 101; repeat++) {
        uint64_t second_ns = 0;
        nanosleep(&(struct timespec){0, 1000000}, NULL); /* the team falls asleep */
        uint64_t begin_ns = common_now_ns();
#pragma omp parallel num_threads(2)
        {
            if (omp_get_thread_num() == 1) {
                second_ns = common_now_ns();
            }
#pragma omp barrier
            uint64_t barrier_ns = common_now_ns();
            for (int i = 0; i < 50; i++) {
#pragma omp barrier
            }
            if (omp_get_thread_num() == 0) {
                bench_add(&barrier, per(barrier_ns, 50));
            }
        }
        if (second_ns > begin_ns) {
            bench_add(&region, (double)(second_ns - begin_ns));
        }
    }
    machine->barrier = median_of(&barrier);
    machine->region = median_of(&region) - machine->clock;
    bench_free(&barrier);
    bench_free(&region);
}

/* One turn of a waiting loop: look at a word, relax. */
static double measure_relax(void)
{
    struct bench_samples samples = {0};
    for (int repeat = 0; repeat < 21; repeat++) {
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < LOOPS; i++) {
            if (atomic_load_explicit(&common.word, memory_order_relaxed) == UINT32_MAX) {
                break;
            }
            eng_relax();
        }
        bench_add(&samples, per(begin_ns, LOOPS));
    }
    double ns = median_of(&samples);
    bench_free(&samples);
    return ns;
}

/* The runtime looks at the barrier's word and relaxes as often as it is told. */
static double spins(void)
{
    const char *text = getenv("GOMP_SPINCOUNT");
    return text ? (double)strtoul(text, NULL, 10) : 0;
}

void model_machine_measure(struct model_machine *machine,
                           const struct eng_affinity *affinity)
{
    eng_affinity_bind_thread(affinity, 0, 2);
    machine->clock = model_clock_ns();
    measure_alone(machine);
    machine->transfer = measure_turn(affinity, TURN_ADD, machine->clock);
    machine->steal = measure_turn(affinity, TURN_STEAL, machine->clock);
    machine->lock_transfer = measure_turn(affinity, TURN_LOCK, machine->clock);
    machine->lock_fought = measure_fight(affinity);
    measure_wake(machine, affinity);
    machine->futex_each = measure_futex();
    measure_team(machine, affinity);
    machine->relax = measure_relax();
    machine->spin = machine->relax * spins();
    machine->unit = model_loop_ns();
}

void model_machine_print(const struct model_machine *machine, FILE *out)
{
    const struct {
        const char *name;
        double ns;
    } rows[] = {{"clock", machine->clock},
                {"atomic, own line", machine->local},
                {"atomic, line of another", machine->transfer},
                {"deque push", machine->push},
                {"deque pop", machine->pop},
                {"deque probe, empty", machine->probe},
                {"deque steal", machine->steal},
                {"lock and unlock, own", machine->lock},
                {"lock and unlock, after another", machine->lock_transfer},
                {"lock and unlock, fought for", machine->lock_fought},
                {"signal, the caller", machine->signal},
                {"signal to running", machine->wake},
                {"turn of the paper's loop", machine->unit},
                {"barrier of two", machine->barrier},
                {"turn of a waiting loop", machine->relax},
                {"spin before sleep", machine->spin},
                {"region start, second thread", machine->region},
                {"futex wake, each sleeper", machine->futex_each}};
    fprintf(out, "cost,ns\n");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        fprintf(out, "\"%s\",%.1f\n", rows[i].name, rows[i].ns);
    }
}
