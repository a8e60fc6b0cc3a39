/* test_int_death.c - clients and daemons that leave or die, and what is left of them. */
#include "cases.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon.h"
#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "raw.h"
#include "witness.h"

/* ---- clients that leave ------------------------------------------------------------ */

/* Requests that nobody waits for the answers to. */
static void ask_in_vain(struct test_raw *raw)
{
    const struct proto_PING_request request = {.token = 0};

    assert_int_not_equal(test_raw_request(raw, PROTO_METHOD_PING, &request), 0);
}

static void say_goodbye(struct test_raw *raw)
{
    const struct proto_BYE_request request = {.reserved = 0};

    assert_int_not_equal(test_raw_request(raw, PROTO_METHOD_BYE, &request), 0);
}

/* If it failed, every program that ends in order would look like one that the daemon had
 * to give up, and its session wait for somebody who has said goodbye. */
CASE_DAEMON(leaving__with_an_answer_unsent_is_an_ordinary_end, "--log-level", "debug")
{
    const struct proto_HELLO_request hello = {.version_min = PROTO_VERSION_MIN,
                                              .version_max = PROTO_VERSION_MAX,
                                              .resumable = true};
    struct proto_HELLO_result result;
    struct test_raw raw;

    assert_true(test_raw_open(&raw, test_own.socket));
    assert_ok(test_raw_call(&raw, PROTO_METHOD_HELLO, &hello, &result));
    assert_int_equal(kill(test_own.pid, SIGSTOP), 0);
    ask_in_vain(&raw);
    say_goodbye(&raw);
    test_raw_close(&raw);
    assert_int_equal(kill(test_own.pid, SIGCONT), 0);
    assert_true(
        test_raw_open(&raw, test_own.socket)); /* is served behind the other one */
    assert_ok(test_raw_hello(&raw));
    test_raw_close(&raw);
    assert_true(WIFEXITED(test_daemon_end(&test_own, SIGTERM, 10000)));
    assert_true(test_daemon_logged(&test_own, "disconnected"));
    assert_false(test_daemon_logged(&test_own, "closing"));
    assert_false(test_daemon_logged(&test_own, "waits for its client"));
}

/* If it failed, nobody would learn that the daemon has given a client up that is there
 * and takes no answers. */
CASE_DAEMON(leaving__is_not_what_a_client_does_that_cannot_be_sent_to, NULL)
{
    struct test_raw raw;

    assert_ok(test_raw_session(&raw, test_own.socket, 0, 0));
    assert_int_equal(shutdown(raw.socket, SHUT_RD), 0);
    ask_in_vain(&raw);
    for (int i = 0; i < 1000 && !test_daemon_logged(&test_own, "cannot be sent to");
         i++) {
        test_sleep_ms(10);
    }
    assert_true(test_daemon_logged(&test_own, "closing: the client cannot be sent to"));
    test_raw_close(&raw);
}

/* ---- clients and daemons that die -------------------------------------------------- */

#define CLIENTS_KILLED 50
#define DEATH_MS       1000 /* generous: it takes well below a millisecond */

/* ---- clients die ------------------------------------------------------------------- */

/* A client that never stops: steps in flight, meshes half-way up. Killed from outside. */
static void work_until_killed(const char *url, int started_fd, unsigned seed)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    struct test_grid grid;
    struct test_grid extra;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    pccd_options_init(&options);
    options.url = url;
    options.result_bytes = 65536;
    options.slot_bytes =
        seed % 2 == 0 ? 4096 : 65536; /* even ones upload in many chunks */
    if (pccd_connect(&options, &client) != 0 || test_grid_make(client, 40, &grid) != 0) {
        _exit(1);
    }
    (void)!write(started_fd, "x", 1);
    for (;;) {
        if (seed % 4 > 1 && test_grid_replace(&grid) != 0) {
            _exit(4);
        }
        for (int i = 0; i < 4; i++) {
            if (test_grid_submit(&grid, NULL, &step) != 0) {
                _exit(2);
            }
        }
        if (seed % 3 != 0 && test_grid_make(client, 60, &extra) == 0) {
            (void)pccd_scene_destroy(client, extra.scene);
            (void)pccd_mesh_destroy(client, extra.mesh);
            test_grid_free(&extra);
        }
        for (int i = 0; i < 4; i++) {
            if (pccd_wait(client, step - (uint64_t)(3 - i), -1, &answer) != 0) {
                _exit(3);
            }
            pccd_answer_release(client, &answer);
        }
    }
}

/* The counters that say what the daemon holds. */
static const char *const held[] = {"sessions_now",    "meshes_now",      "scenes_now",
                                   "objects_now",     "triangles_now",   "shm_bytes_now",
                                   "jobs_queued_now", "engine_bytes_now"};
#define HELD (sizeof held / sizeof held[0])

/* If it failed, every client that crashes would cost the daemon memory for ever. */
CASE(death__of_clients_leaves_nothing_behind)
{
    struct pccd_client *client = test_witness.crossing.client;
    uint64_t before[HELD];
    int fds_before;

    test_witness_turn();
    test_witness_turn();
    fds_before = test_witness_fd_count();
    for (size_t i = 0; i < HELD; i++) {
        before[i] = test_stat(client, held[i]);
    }
    for (unsigned round = 0; round < CLIENTS_KILLED; round++) {
        int fds[2];
        int status = 0;
        char byte;
        pid_t child;

        assert_int_equal(pipe(fds), 0);
        child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            test_end_with_parent();
            work_until_killed(test_witness.daemon.url, fds[1], round);
        }
        (void)close(fds[1]);
        assert_int_equal(read(fds[0], &byte, 1), 1);
        (void)close(fds[0]);
        test_sleep_ms(round * 7 % 19); /* at another moment of its work each time */
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status)); /* it was still at work */
        test_witness_turn();
    }
    for (size_t i = 0; i < HELD; i++) {
        uint64_t after = test_stat_await(client, held[i], before[i]);

        if (after != before[i]) {
            fail_msg("%s: %llu before, %llu after", held[i],
                     (unsigned long long)before[i], (unsigned long long)after);
        }
    }
    assert_true(test_witness_fd_count() <= fds_before);
    test_witness_turn();
}

/* If it failed, a client that closes in the midst of its work would leave some of it. */
CASE(death__by_close_with_steps_in_flight_is_clean)
{
    struct pccd_client *witness = test_witness.crossing.client;
    uint64_t bytes = test_stat(witness, "engine_bytes_now");
    uint64_t shm = test_stat(witness, "shm_bytes_now");

    for (int round = 0; round < 10; round++) {
        struct pccd_client *client = test_client_at(test_witness.daemon.url);
        struct pccd_frame frame;
        struct test_grid grid;
        uint64_t step = 0;

        assert_ok(test_grid_make(client, 50, &grid));
        for (int i = 0; i < 3; i++) {
            assert_ok(test_grid_submit(&grid, NULL, &step));
        }
        assert_ok(pccd_frame_begin(client, grid.scene, 1, 100, &frame));
        pccd_close(client);
        test_grid_free(&grid);
    }
    assert_int_equal(test_stat_await(witness, "engine_bytes_now", bytes), bytes);
    assert_int_equal(test_stat_await(witness, "shm_bytes_now", shm), shm);
    test_witness_turn();
}

/* ---- the daemon dies --------------------------------------------------------------- */

/* Every public call of a client whose daemon is gone fails at once, with a text. */
static void expect_all_disconnected(struct pccd_client *client, struct test_grid *grid,
                                    uint64_t step)
{
    uint64_t begin_ms = test_now_ms();
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_edge edges[2];
    struct pccd_frame frame;
    uint32_t handle = 0;

#define GONE(call)                                                                       \
    do {                                                                                 \
        assert_int_equal(call, PCCD_E_DISCONNECTED);                                     \
        assert_true(pccd_error_text(client)[0] != '\0');                                 \
    } while (0)
    GONE(pccd_ping(client, NULL));
    GONE(pccd_scene_create(client, NULL, &handle));
    GONE(pccd_scene_destroy(client, grid->scene));
    GONE(pccd_scene_add(client, grid->scene, grid->mesh, &handle));
    GONE(pccd_scene_remove(client, grid->scene, grid->object));
    GONE(pccd_mesh_create(client, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle, 1,
                          &handle, NULL));
    GONE(pccd_mesh_edges(client, grid->mesh, edges, 2));
    GONE(pccd_mesh_destroy(client, grid->mesh));
    GONE(pccd_frame_begin(client, grid->scene, 1, 64, &frame));
    GONE(pccd_submit_still(client, grid->scene, NULL, &step));
    GONE(pccd_poll(client, &answer));
    GONE(pccd_wait(client, step, -1, &answer));
    GONE(pccd_fetch(client, grid->scene, step, 0, &answer));
    GONE(pccd_cancel(client, step));
    GONE(pccd_step_x1(client, grid->scene, grid->object, grid->x, PCCD_FORMAT_F32,
                      grid->vertex_count, NULL, &answer));
#undef GONE
    assert_int_equal(test_stat(client, "pid"), UINT64_MAX);
    assert_true(test_now_ms() - begin_ms < DEATH_MS);
}

/* Kill `victim` in a while, from another process; when it did so is left in
 * *killed_us. */
static pid_t kill_later(pid_t victim, volatile uint64_t *killed_us)
{
    pid_t killer = fork();

    assert_true(killer >= 0);
    if (killer == 0) {
        test_sleep_ms(50);
        *killed_us = test_now_us();
        _exit(kill(victim, SIGKILL) == 0 ? 0 : 1);
    }
    return killer;
}

/* If it failed, a dead daemon would hang its clients until a timeout. */
CASE(death__of_the_daemon_is_an_error_at_once)
{
    volatile uint64_t *killed_us =
        mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    struct test_daemon daemon;
    struct pccd_answer kept = PCCD_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_frame slots[4];
    struct pccd_frame frame;
    struct test_grid grid;
    uint64_t steps[3];
    uint64_t took_us;
    pid_t killer;

    assert_ptr_not_equal((void *)(uintptr_t)killed_us, MAP_FAILED);
    assert_true(test_daemon_start(&daemon, NULL));
    struct pccd_client *client = test_connect_once(daemon.url);
    assert_non_null(client);
    assert_ok(test_grid_make(client, 30, &grid));
    for (int i = 0; i < 4; i++) { /* every slot has memory then */
        assert_ok(
            pccd_frame_begin(client, grid.scene, 1, sizeof(float[3]) * 900, &slots[i]));
    }
    for (int i = 0; i < 4; i++) {
        pccd_frame_abort(&slots[i]);
    }
    assert_ok(test_grid_submit(&grid, NULL, &steps[0]));
    assert_ok(pccd_wait(client, steps[0], -1, &kept));
    assert_ok(pccd_frame_begin(client, grid.scene, 1, 64, &frame));
    assert_int_equal(kill(daemon.pid, SIGSTOP), 0); /* nothing is answered from here on */
    for (int i = 0; i < 3; i++) {
        assert_ok(test_grid_submit(&grid, NULL, &steps[i]));
    }
    killer = kill_later(daemon.pid, killed_us);
    memset(&answer, 0, sizeof answer);
    assert_int_equal(pccd_wait(client, steps[1], 20000, &answer), PCCD_E_DISCONNECTED);
    took_us = test_now_us() - *killed_us;
    print_message("# E_DISCONNECTED %llu us after kill -9\n",
                  (unsigned long long)took_us);
    assert_true(took_us < DEATH_MS * 1000u);
    assert_int_equal(answer.status, PCCD_E_DISCONNECTED);
    assert_int_equal(waitpid(killer, NULL, 0), killer);
    /* The others fail too, each once, oldest first. */
    assert_ok(pccd_poll(client, &answer));
    assert_int_equal(answer.step, steps[0]);
    assert_int_equal(answer.status, PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_wait(client, steps[2], -1, &answer), PCCD_E_DISCONNECTED);
    assert_int_equal(pccd_frame_commit(&frame, NULL, &steps[0]), PCCD_E_DISCONNECTED);
    expect_all_disconnected(client, &grid, steps[0]);
    /* What was handed out before is still there to be read. */
    assert_true(test_grid_is_right(&grid, &kept));
    pccd_answer_release(client, &kept);
    test_grid_close(&grid);
    (void)test_daemon_end(&daemon, 0, 5000);
    (void)test_daemon_finish(&daemon);
    (void)munmap((void *)(uintptr_t)killed_us, 4096);
}

/* If it failed, a call that is not a step would hang when the daemon dies under it. */
CASE(death__of_the_daemon_ends_a_ping_and_an_upload)
{
    volatile uint64_t *killed_us =
        mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);

    assert_ptr_not_equal((void *)(uintptr_t)killed_us, MAP_FAILED);
    for (int upload = 0; upload < 2; upload++) {
        struct test_daemon daemon;
        struct test_grid grid;
        pid_t killer;
        int status;

        memset(&grid, 0, sizeof grid);
        assert_true(test_daemon_start(&daemon, NULL));
        struct pccd_client *client = test_connect_once(daemon.url);
        assert_non_null(client);
        assert_ok(pccd_ping(client, NULL));
        if (!upload) {
            assert_int_equal(kill(daemon.pid, SIGSTOP), 0);
        }
        killer = kill_later(daemon.pid, killed_us);
        do {
            test_grid_free(&grid);
            status =
                upload ? test_grid_make(client, 200, &grid) : pccd_ping(client, NULL);
        } while (status == 0);
        assert_true(status == PCCD_E_DISCONNECTED);
        assert_int_equal(waitpid(killer, NULL, 0), killer);
        assert_true(test_now_us() - *killed_us < DEATH_MS * 1000u);
        assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
        test_grid_free(&grid);
        pccd_close(client);
        (void)test_daemon_end(&daemon, 0, 5000);
        (void)test_daemon_finish(&daemon);
    }
    (void)munmap((void *)(uintptr_t)killed_us, 4096);
}

/* If it failed, the socket and lock that a dead daemon leaves would keep the next one
 * out. */
CASE_DAEMON(death__of_the_daemon_leaves_the_path_usable, NULL)
{
    struct pccd_client *client;
    struct test_crossing crossing;

    for (int round = 0; round < 3; round++) {
        client = test_connect_once(test_own.url);
        assert_non_null(client);
        assert_ok(test_crossing_make(client, &crossing));
        assert_true(test_crossing_turn(&crossing));
        (void)test_daemon_end(&test_own, SIGKILL, 5000);
        assert_int_equal(access(test_own.socket, F_OK), 0);
        assert_true(test_daemon_restart(&test_own, NULL));
        assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
        pccd_close(client);
    }
}

/* ---- private daemons --------------------------------------------------------------- */

/* A process that has ended but whom nobody has collected yet (an orphan, where process 1
 * is no init) does not run. */
static bool is_running(pid_t pid)
{
    char path[64];
    char state = 'Z';
    FILE *file;

    if (kill(pid, 0) != 0) {
        return false;
    }
    (void)snprintf(path, sizeof path, "/proc/%ld/stat", (long)pid);
    file = fopen(path, "r");
    if (file != NULL && fscanf(file, "%*d (%*[^)]) %c", &state) != 1) {
        state = 'Z';
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    return state != 'Z';
}

static void await_gone(pid_t pid)
{
    for (int i = 0; i < 2500 && is_running(pid); i++) {
        test_sleep_ms(2);
    }
    assert_false(is_running(pid));
}

static int connect_private_of(const char *daemon, struct pccd_client **client)
{
    struct pccd_options options;

    pccd_options_init(&options);
    options.private_daemon = true;
    options.reconnect_ms = -1;
    options.daemon = daemon;
    options.result_bytes = 65536;
    return pccd_connect(&options, client);
}

static int connect_private(struct pccd_client **client)
{
    return connect_private_of(getenv("PCCDD"), client);
}

/* If it failed, programs would leave daemons, folders or zombies behind. */
CASE(private__daemon_goes_with_its_client)
{
    struct pccd_client *client = NULL;
    struct test_crossing crossing;
    char socket_path[160];
    pid_t daemon;
    pid_t copy;
    int status = 0;

    assert_int_equal(connect_private(&client), 0);
    daemon = (pid_t)pccd_daemon_pid(client);
    (void)snprintf(socket_path, sizeof socket_path, "%s", pccd_url(client) + 5);
    assert_int_equal(access(socket_path, F_OK), 0);
    assert_ok(test_crossing_make(client, &crossing));
    assert_true(test_crossing_turn(&crossing));
    /* A forked copy that closes does not take it away. */
    copy = fork();
    assert_true(copy >= 0);
    if (copy == 0) {
        pccd_close(client);
        _exit(0);
    }
    assert_int_equal(waitpid(copy, &status, 0), copy);
    assert_true(test_crossing_turn(&crossing));
    pccd_close(client);
    assert_int_equal(kill(daemon, 0), -1); /* ended and reaped before close returned */
    assert_int_equal(errno, ESRCH);
    *strrchr(socket_path, '/') = '\0';
    assert_int_not_equal(access(socket_path, F_OK), 0);
}

/* If it failed, a daemon would start, find an environment that its OpenMP cannot use, and
 * start a second time: it takes twice as long. */
CASE(private__daemon_gets_the_environment_that_it_needs)
{
    char folder[] = "/tmp/pccd-test-XXXXXX";
    char script[64];
    char line[4096];
    struct pccd_client *client = NULL;
    bool has_spin = false;
    FILE *file;

    assert_non_null(mkdtemp(folder));
    (void)snprintf(script, sizeof script, "%s/pccdd", folder);
    file = fopen(script, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\nenv > %s/environment\nexec %s \"$@\"\n", folder,
            getenv("PCCDD"));
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(script, 0700), 0);
    assert_int_equal(setenv("OMP_PROC_BIND", "true", 1), 0);
    assert_int_equal(connect_private_of(script, &client), 0);
    assert_int_equal(unsetenv("OMP_PROC_BIND"), 0);
    pccd_close(client);
    (void)snprintf(line, sizeof line, "%s/environment", folder);
    file = fopen(line, "r");
    assert_non_null(file);
    assert_int_equal(unlink(line), 0);
    while (fgets(line, sizeof line, file) != NULL) {
        assert_int_not_equal(strncmp(line, "OMP_PROC_BIND=", 14), 0);
        has_spin = has_spin || strncmp(line, "GOMP_SPINCOUNT=", 15) == 0;
    }
    assert_true(has_spin);
    (void)fclose(file);
    assert_int_equal(unlink(script), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* Return how many descriptors a process has whose link begins so. */
static int count_descriptors(pid_t pid, const char *link)
{
    char path[300];
    char target[64];
    int count = 0;
    DIR *folder;

    (void)snprintf(path, sizeof path, "/proc/%ld/fd", (long)pid);
    folder = opendir(path);
    assert_non_null(folder);
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        memset(target, 0, sizeof target);
        (void)snprintf(path, sizeof path, "/proc/%ld/fd/%s", (long)pid, entry->d_name);
        if (readlink(path, target, sizeof target - 1) > 0) {
            count += strncmp(target, link, strlen(link)) == 0;
        }
    }
    (void)closedir(folder);
    return count;
}

/* If it failed, a client's end would wait 8 ms for the kernel to stop watching the file
 * of a socket that nobody else looks for. */
CASE(private__daemon_does_not_watch_its_socket)
{
    struct pccd_client *client = NULL;

    assert_int_equal(connect_private(&client), 0);
    assert_ok(count_descriptors((pid_t)pccd_daemon_pid(client), "anon_inode:inotify"));
    pccd_close(client);
}

/* If it failed, programs that crash would leave private daemons or their folders. */
CASE(private__daemon_goes_when_its_client_is_killed)
{
    struct {
        pid_t pid;
        char folder[160];
    } daemon = {0};
    pid_t child;
    int fds[2];

    assert_int_equal(pipe(fds), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct pccd_client *client = NULL;

        test_end_with_parent();
        if (connect_private(&client) != 0) {
            _exit(1);
        }
        daemon.pid = (pid_t)pccd_daemon_pid(client);
        (void)snprintf(daemon.folder, sizeof daemon.folder, "%s", pccd_url(client) + 5);
        *strrchr(daemon.folder, '/') = '\0';
        (void)!write(fds[1], &daemon, sizeof daemon);
        (void)pause();
        _exit(2);
    }
    (void)close(fds[1]);
    assert_int_equal(read(fds[0], &daemon, sizeof daemon), sizeof daemon);
    (void)close(fds[0]);
    assert_true(is_running(daemon.pid));
    assert_int_equal(access(daemon.folder, F_OK), 0);
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, NULL, 0), child);
    await_gone(daemon.pid);
    assert_int_not_equal(access(daemon.folder, F_OK), 0);
}

/* If it failed, a private daemon that crashed would hang its client's close. */
CASE(private__daemon_that_is_killed_is_an_error)
{
    struct pccd_client *client = NULL;
    uint64_t begin_ms;

    assert_int_equal(connect_private(&client), 0);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
    begin_ms = test_now_ms();
    while (pccd_ping(client, NULL) == 0 && test_now_ms() - begin_ms < DEATH_MS) {
        ;
    }
    assert_int_equal(pccd_ping(client, NULL), PCCD_E_DISCONNECTED);
    pccd_close(client);
    assert_true(test_now_ms() - begin_ms < DEATH_MS);
}

CASES_WITH(test_witness_start, test_witness_stop);

/* ---- a test that dies -------------------------------------------------------------- */

#define END_MS 10000

/* Numbers that the child tells before it is killed. */
struct told {
    struct test_daemon daemon;
    pid_t worker;
};

/* In the child: a daemon whose worker is stopped. */
static void start_and_stop(int fd)
{
    static const char *const options[] = {"--supervise", "--threads", "1", NULL};
    static struct test_raw raw;
    static struct told told;
    const struct proto_HELLO_request hello = {.version_min = 1, .version_max = 1};
    struct proto_HELLO_result result;

    if (!test_daemon_start(&told.daemon, options) ||
        !test_raw_open(&raw, told.daemon.socket) ||
        test_raw_call(&raw, PROTO_METHOD_HELLO, &hello, &result) != 0) {
        _exit(1);
    }
    told.worker = (pid_t)result.pid;
    if (kill(told.worker, SIGSTOP) != 0 ||
        write(fd, &told, sizeof told) != (ssize_t)sizeof told) {
        _exit(1);
    }
    (void)pause();
    _exit(1);
}

/* Wait for the end of a child, or of an orphan, which is ours once its parent is gone. */
static int await_end(pid_t pid)
{
    uint64_t until_ms = test_now_ms() + END_MS;
    int status = -1;

    while (waitpid(pid, &status, WNOHANG) != pid && test_now_ms() < until_ms) {
        test_sleep_ms(1);
    }
    return status;
}

/* If it failed, a test that dies while a worker is stopped would leave that worker for
 * ever, and whoever reads what the test says would wait for its end as long. */
CASE(orphan__workers_end_with_their_test)
{
    struct told told = {.worker = 0};
    int fds[2];

    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    assert_int_equal(pipe(fds), 0);
    pid_t test = fork();
    assert_true(test >= 0);
    if (test == 0) {
        start_and_stop(fds[1]);
    }
    (void)close(fds[1]);
    ssize_t got = read(fds[0], &told, sizeof told);
    (void)close(fds[0]);
    (void)kill(test, SIGKILL);
    (void)await_end(test);
    assert_int_equal(got, sizeof told);
    int status = await_end(told.worker);
    told.daemon.pid = 0; /* not ours to end; its folder is */
    told.daemon.guard = 0;
    (void)test_daemon_finish(&told.daemon);
    assert_true(WIFSIGNALED(status));
}
