/* test_zoo_idle.c - a daemon that nobody asks anything does nothing. */
#include "cases.h"

#include <dirent.h>
#include <sys/resource.h>
#include <unistd.h>

#include "daemon.h"
#include "grid.h"
#include "raw.h"

#define CLIENTS_MAX 20000u
#define THREADS_MAX 4096
#define FDS_BESIDE  100u

static unsigned long option(const char *name, unsigned long otherwise)
{
    const char *text = getenv(name);

    return text != NULL ? strtoul(text, NULL, 10) : otherwise;
}

/* Times that one thread has been put to sleep or off its processor. */
static uint64_t switches_of(const struct test_daemon *daemon, const char *thread)
{
    char path[320];
    char line[256];
    unsigned long long sum = 0;
    FILE *file;

    (void)snprintf(path, sizeof path, "/proc/%ld/task/%s/status", (long)daemon->pid,
                   thread);
    file = fopen(path, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        unsigned long long count = 0;

        if (sscanf(line, "voluntary_ctxt_switches: %llu", &count) == 1 ||
            sscanf(line, "nonvoluntary_ctxt_switches: %llu", &count) == 1) {
            sum += count;
        }
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return sum;
}

/* Return the switches of all threads; *threads says how many there are. */
static uint64_t switches(const struct test_daemon *daemon, unsigned *threads)
{
    char path[64];
    uint64_t sum = 0;
    DIR *entries;

    *threads = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/task", (long)daemon->pid);
    entries = opendir(path);
    assert_non_null(entries);
    for (int i = 0; i < THREADS_MAX; i++) {
        const struct dirent *entry = readdir(entries);

        if (entry == NULL) {
            break;
        }
        if (entry->d_name[0] != '.') {
            sum += switches_of(daemon, entry->d_name);
            ++*threads;
        }
    }
    (void)closedir(entries);
    return sum;
}

/* As many clients as the test may have descriptors for. */
static uint32_t client_count(void)
{
    struct rlimit limit;
    uint32_t count = (uint32_t)option("IDLE_CLIENTS", 200);

    count = count > CLIENTS_MAX ? CLIENTS_MAX : count;
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
    if (limit.rlim_cur < count + FDS_BESIDE) {
        count = (uint32_t)limit.rlim_cur - FDS_BESIDE;
        printf("# only %u clients: no more descriptors\n", count);
    }
    return count;
}

/* A client that has had an answer of 6 MiB, and is silent from then on. */
static struct pccd_client *have_large_answer(const char *url, struct test_grid *grid)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    uint64_t step = 0;

    memset(&options, 0, sizeof options);
    options.url = url;
    assert_ok(pccd_connect(&options, &client));
    assert_ok(test_grid_make(client, 300, grid));
    assert_ok(test_grid_submit(grid, NULL, &step));
    assert_ok(test_grid_await(grid, step));
    return client;
}

/* If it failed, a machine with clients that do nothing would never come to rest. */
CASE(idle__daemon_is_not_woken_by_silent_clients)
{
    static const char *const options[] = {"--clients-max", "20000", "--connections-max",
                                          "20000", NULL};
    uint32_t count = client_count();
    unsigned seconds = (unsigned)option("IDLE_SECONDS", 2);
    static struct test_raw raw;
    struct test_daemon daemon;
    struct test_grid grid;
    unsigned threads = 0;
    uint64_t before;
    uint64_t woken;
    int *sockets = calloc(count, sizeof *sockets);

    if (TEST_HAS_FOREIGN_THREAD) {
        free(sockets);
        test_skip("a sanitizer's thread wakes the daemon ten times a second");
    }
    assert_non_null(sockets);
    assert_true(test_daemon_start(&daemon, options));
    for (uint32_t i = 0; i < count; i++) {
        assert_ok(test_raw_session(&raw, daemon.socket, 0, 0));
        sockets[i] = dup(raw.socket); /* the rest of a peer is not needed any more */
        assert_true(sockets[i] >= 0);
        test_raw_close(&raw);
    }
    struct pccd_client *client = have_large_answer(daemon.url, &grid);
    test_sleep_ms(2000); /* the last ones have been served, memory was given back */
    before = switches(&daemon, &threads);
    test_sleep_ms(seconds * 1000);
    woken = switches(&daemon, &threads) - before;
    printf("# idle with %u clients: %u threads, %llu context switches in %u s\n", count,
           threads, (unsigned long long)woken, seconds);
    assert_int_equal(woken, 0);
    for (uint32_t i = 0; i < count; i++) {
        (void)close(sockets[i]);
    }
    free(sockets);
    test_grid_free(&grid);
    pccd_close(client);
    assert_true(test_daemon_finish(&daemon));
}
