/* keeper.c - a daemon in a world that fails on order, and whoever looks after it. */
#include "keeper.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "cases.h"
#include "witness.h"

#define WAIT_MS 10000u
/* Calls before it may be those of hello: a session that nobody has the secret of would
 * wait for its client for seconds. */
#define KNOWN_FROM 5

struct fault_page *keeper_page;
static char page_path[64];

/* Holdings of the daemon when only the honest client is there. */
struct holdings {
    uint64_t counters[6];
    int64_t blocks;
    int descriptors;
    int mappings; /* of shared memory */
};

static const char *const counter_names[6] = {"sessions_now",  "meshes_now",
                                             "scenes_now",    "objects_now",
                                             "shm_bytes_now", "engine_bytes_now"};
static struct holdings before;

int keeper_pid(void)
{
    return test_witness.daemon.pid;
}

const char *keeper_socket(void)
{
    return test_witness.daemon.socket;
}

int keeper_connect(void)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", keeper_socket());
    if (connect(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        (void)close(fd);
        return -1;
    }
    return fd;
}

uint64_t keeper_stride(uint64_t sample)
{
    const char *every = getenv("FAULT_EVERY");
    uint64_t stride = every != NULL ? strtoull(every, NULL, 10) : sample;
    return stride > 0 ? stride : 1;
}

bool keeper_make_page(void)
{
    char program[4096];
    (void)snprintf(page_path, sizeof page_path, "/tmp/pccd-fault-XXXXXX");
    int fd = mkstemp(page_path);
    if (fd < 0 || ftruncate(fd, sizeof *keeper_page) != 0) {
        return false;
    }
    void *page =
        mmap(NULL, sizeof *keeper_page, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    (void)close(fd);
    if (page == MAP_FAILED) {
        return false;
    }
    keeper_page = page;
    (void)snprintf(program, sizeof program, "%s/tests/fault/pccdd-faulty",
                   getenv("top_builddir"));
    /* With the spin count set the daemon does not start itself anew. */
    return setenv("PCCD_FAULT_PAGE", page_path, 1) == 0 &&
           setenv("PCCDD", program, 1) == 0 && setenv("GOMP_SPINCOUNT", "2000", 1) == 0;
}

void keeper_drop_page(void)
{
    (void)unlink(page_path);
    (void)munmap(keeper_page, sizeof *keeper_page);
}

static int count_mappings(void)
{
    char path[64];
    char line[512];
    int count = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/maps", keeper_pid());
    FILE *maps = fopen(path, "r");
    while (maps != NULL && fgets(line, sizeof line, maps) != NULL) {
        count += strstr(line, "/memfd:pccd-") != NULL;
    }
    if (maps != NULL) {
        (void)fclose(maps);
    }
    return count;
}

static void look(struct holdings *now)
{
    for (size_t i = 0; i < 6; i++) {
        now->counters[i] = test_stat(test_witness.crossing.client, counter_names[i]);
    }
    now->blocks = (int64_t)atomic_load(&keeper_page->held);
    now->descriptors = test_witness_fd_count();
    now->mappings = count_mappings();
}

static void tell(const char *what, const struct holdings *now)
{
    for (size_t i = 0; i < 6; i++) {
        if (now->counters[i] != before.counters[i]) {
            print_message("# %s: %s is %llu, was %llu\n", what, counter_names[i],
                          (unsigned long long)now->counters[i],
                          (unsigned long long)before.counters[i]);
        }
    }
    if (now->blocks != before.blocks) {
        print_message("# %s: %lld blocks are allocated, were %lld\n", what,
                      (long long)now->blocks, (long long)before.blocks);
    }
    if (now->descriptors != before.descriptors || now->mappings != before.mappings) {
        print_message("# %s: %d descriptors and %d mappings, were %d and %d\n", what,
                      now->descriptors, now->mappings, before.descriptors,
                      before.mappings);
    }
}

void keeper_expect_peace(const char *what)
{
    uint64_t until_ms = test_now_ms() + WAIT_MS;
    struct holdings now;
    if (!test_crossing_turn(&test_witness.crossing)) {
        fail_msg("%s: the honest client is not served", what);
    }
    do { /* what the last client left is freed behind its back */
        look(&now);
        if (memcmp(&now, &before, sizeof now) == 0) {
            return;
        }
        test_sleep_ms(1);
    } while (test_now_ms() < until_ms);
    tell(what, &now);
    fail_msg("%s: the daemon holds something else than before", what);
}

/* A life without faults, which everything shall come back to. */
static void live_in_peace(const char *what)
{
    struct life life;
    life_run(&life, keeper_socket(), LIFE_RESUMABLE);
    if (life.wrong[0] != '\0' || life.is_lost || life.refusals > 0) {
        fail_msg("%s: without a fault: %s, %u refusals%s", what, life.wrong,
                 life.refusals, life.is_lost ? ", connection lost" : "");
    }
}

static uint64_t count_calls(void)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < FAULT_CALL_COUNT; i++) {
        sum += atomic_load(&keeper_page->counts[i]);
    }
    return sum;
}

/* Until the daemon sleeps: what it still does for the honest client shall not fail. */
static void await_sleep(void)
{
    const struct timespec pause = {.tv_nsec = 300000};
    uint64_t calls = count_calls();
    for (int quiet = 0; quiet < 3; quiet++) {
        (void)nanosleep(&pause, NULL);
        uint64_t now = count_calls();
        quiet = now == calls ? quiet : -1;
        calls = now;
    }
}

uint64_t keeper_try(enum fault_call call, uint64_t first, uint64_t length, int error)
{
    struct life life;
    char what[96];
    (void)snprintf(what, sizeof what, "%s %llu.. (%llu), errno %d", fault_name(call),
                   (unsigned long long)first, (unsigned long long)length, error);
    await_sleep();
    fault_order(keeper_page, call, first, length, error);
    life_run(&life, keeper_socket(),
             length > 1           ? LIFE_PATIENT
             : first < KNOWN_FROM ? LIFE_ONCE
                                  : LIFE_RESUMABLE);
    uint64_t hits = fault_recall(keeper_page);
    if (life.wrong[0] != '\0') {
        fail_msg("%s: %s", what, life.wrong);
    }
    if (hits == 0 && (life.is_lost || life.refusals + life.resumptions > 0)) {
        fail_msg("%s: nothing failed, and the client was refused", what);
    }
    if (life.is_lost) {
        live_in_peace(what);
    }
    keeper_expect_peace(what);
    return hits;
}

void keeper_settle(void)
{
    struct holdings last;
    look(&before);
    do { /* on a busy machine the last client is freed late */
        last = before;
        test_sleep_ms(50);
        look(&before);
    } while (memcmp(&last, &before, sizeof last) != 0);
}

int keeper_start(void **state)
{
    if (!keeper_make_page() || test_witness_start(state) != 0) {
        return -1;
    }
    /* What is made once, and stays: answers of steps of both methods, and their team; and
     * the answers that the daemon keeps for a client that may come back. */
    for (int i = 0; i < 3; i++) {
        live_in_peace("warm-up");
    }
    for (uint32_t i = 0; i < 2 * PROTO_REPLIES_KEPT; i++) {
        test_witness_turn();
    }
    (void)test_stat_await(test_witness.crossing.client, "sessions_now", 1);
    keeper_settle();
    return 0;
}

int keeper_stop(void **state)
{
    int status = test_witness_stop(state);
    keeper_drop_page();
    return status;
}
