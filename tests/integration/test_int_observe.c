/* test_int_observe.c - lists, histograms, settings and steps that others are told of. */
#include "cases.h"

#include <grp.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixture.h"
#include "must.h"
#include "proto_limits.h"
#include "raw.h"

#define NOBODY 65534
#define TURNS  5

/* ---- lists ------------------------------------------------------------------------- */

/* The session that is looked for, and how many came. */
struct sessions {
    uint64_t wanted;
    uint32_t count;
    struct pccd_session_info found; /* session 0: it did not come */
    char client[64];
};

static void take_session(void *context, const struct pccd_session_info *info)
{
    struct sessions *sessions = context;

    sessions->count++;
    if (info->session == sessions->wanted) {
        sessions->found = *info;
        (void)snprintf(sessions->client, sizeof sessions->client, "%s", info->client);
    }
}

struct scenes {
    uint32_t count;
    struct pccd_scene_info last;
};

static void take_scene(void *context, const struct pccd_scene_info *info)
{
    struct scenes *scenes = context;

    scenes->count++;
    scenes->last = *info;
}

struct objects {
    uint32_t count;
    uint32_t handles[4];
    uint32_t meshes[4];
    char names[4][PROTO_STR_MAX + 1];
};

static void take_object(void *context, const struct pccd_object_info *info)
{
    struct objects *objects = context;

    if (objects->count < 4) {
        objects->handles[objects->count] = info->object;
        objects->meshes[objects->count] = info->mesh;
        strcpy(objects->names[objects->count], info->name);
    }
    objects->count++;
    assert_int_equal(info->triangles, 1);
}

static void take_mesh(void *context, const struct pccd_registered_mesh *info)
{
    uint32_t *count = context;

    assert_int_equal(info->vertex_count, 3);
    assert_int_equal(info->triangle_count, 1);
    assert_int_equal(info->objects, 1);
    assert_int_equal(info->generation, 1);
    assert_true(info->committed);
    assert_false(info->replacing);
    ++*count;
}

/* If it failed, pccdctl would tell of other sessions, scenes or meshes than there are. */
CASE_CROSSING(list__has_what_a_session_has)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *other = test_client_at(test_shared.url);
    struct pccd_daemon_info self;
    struct sessions sessions = {.count = 0};
    struct scenes scenes = {.count = 0};
    struct objects objects = {.count = 0};
    uint32_t meshes = 0;
    for (int i = 0; i < TURNS; i++) {
        assert_true(test_crossing_turn(crossing));
    }
    assert_ok(pccd_daemon(crossing->client, &self));
    assert_true(strncmp(self.name, "pccdd ", 6) == 0);
    sessions.wanted = self.session;
    assert_ok(pccd_list_sessions(other, take_session, &sessions));
    assert_int_equal(sessions.count, 2);
    assert_int_equal(sessions.found.session, self.session);
    assert_int_equal(sessions.found.pid, getpid());
    assert_int_equal(sessions.found.uid, getuid());
    assert_true(sessions.client[0] != '\0');
    assert_int_equal(sessions.found.steps, TURNS);
    assert_int_equal(sessions.found.scenes, 1);
    assert_int_equal(sessions.found.objects, 2);
    assert_int_equal(sessions.found.meshes, 2);
    assert_int_equal(sessions.found.triangles, 2);
    assert_true(sessions.found.contacts >= TURNS);
    assert_true(sessions.found.upload_bytes >= TURNS * 36);
    assert_int_equal(sessions.found.result_bytes, sessions.found.contacts * 64);
    assert_true(sessions.found.ns_step > 0 && sessions.found.ns_open > 0);
    assert_false(sessions.found.waiting);

    assert_ok(pccd_list_scenes(other, self.session, take_scene, &scenes));
    assert_int_equal(scenes.count, 1);
    assert_int_equal(scenes.last.scene, crossing->scene);
    assert_int_equal(scenes.last.objects, 2);
    assert_int_equal(scenes.last.steps, TURNS);
    assert_true(scenes.last.number >= TURNS && scenes.last.total > 0);

    assert_ok(
        pccd_list_objects(other, self.session, crossing->scene, take_object, &objects));
    assert_int_equal(objects.count, 2);
    assert_int_equal(objects.handles[0], crossing->floor);
    assert_int_equal(objects.handles[1], crossing->object);
    assert_int_equal(objects.meshes[0], crossing->floor_mesh);
    assert_int_equal(objects.meshes[1], crossing->mesh);
    assert_ok(pccd_list_meshes(other, self.session, take_mesh, &meshes));
    assert_int_equal(meshes, 2);

    assert_ok(pccd_mesh_destroy(crossing->client, crossing->mesh));
    assert_ok(pccd_scene_remove(crossing->client, crossing->scene, crossing->floor));
    objects.count = 0;
    assert_ok(
        pccd_list_objects(crossing->client, 0, crossing->scene, take_object, &objects));
    assert_int_equal(objects.count, 1);
    assert_int_equal(objects.meshes[0], 0);
    assert_ok(pccd_list_sessions(other, take_session, &sessions));
    assert_int_equal(sessions.found.triangles, 1);
    assert_int_equal(pccd_list_scenes(other, self.session + 1000, take_scene, &scenes),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_list_objects(other, 0, 77, take_object, &objects),
                     PCCD_E_HANDLE);
    pccd_close(other);
}

/* Return what the list calls an object. */
static const char *name_of(const struct test_crossing *crossing, uint32_t object)
{
    static struct objects objects;
    uint32_t i = 0;

    objects.count = 0;
    assert_ok(
        pccd_list_objects(crossing->client, 0, crossing->scene, take_object, &objects));
    while (i < objects.count && objects.handles[i] != object) {
        i++;
    }
    assert_true(i < objects.count);
    return objects.names[i];
}

/* If it failed, pccdctl would call an object by another's name, or by an earlier one. */
CASE_CROSSING(list__tells_names_of_objects)
{
    const struct test_crossing *crossing = *state;
    const char *longest = memset((char[PROTO_STR_MAX + 1]){""}, '"', PROTO_STR_MAX);
    const char *names[] = {"floor", longest, "f", "", NULL, "again"};

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        assert_ok(pccd_object_name(crossing->client, crossing->scene, crossing->floor,
                                   names[i]));
        assert_string_equal(name_of(crossing, crossing->floor),
                            names[i] != NULL ? names[i] : "");
        assert_string_equal(name_of(crossing, crossing->object), "");
    }
}

/* ---- histograms -------------------------------------------------------------------- */

static uint64_t sum_of(const struct pccd_histogram_info *info)
{
    uint64_t sum = 0;

    for (int i = 0; i < PCCD_HISTOGRAM_BUCKETS; i++) {
        sum += info->bucket[i];
    }
    return sum;
}

/* If it failed, a latency that is plotted would be another than the clients'. */
CASE_CROSSING(histogram__counts_every_step_and_request)
{
    struct test_crossing *crossing = *state;
    struct pccd_histogram_info steps0, steps1, requests0, requests1;
    uint64_t span_ns;

    assert_ok(pccd_histogram(crossing->client, PCCD_HISTOGRAM_STEPS, &steps0));
    assert_ok(pccd_histogram(crossing->client, PCCD_HISTOGRAM_REQUESTS, &requests0));
    uint64_t begin_us = test_now_us();
    for (int i = 0; i < TURNS; i++) {
        assert_true(test_crossing_turn(crossing));
    }
    span_ns = (test_now_us() - begin_us + 1) * 1000;
    assert_ok(pccd_histogram(crossing->client, PCCD_HISTOGRAM_STEPS, &steps1));
    assert_ok(pccd_histogram(crossing->client, PCCD_HISTOGRAM_REQUESTS, &requests1));
    assert_int_equal(steps1.count - steps0.count, TURNS);
    assert_int_equal(sum_of(&steps1), steps1.count);
    assert_true(steps1.ns_sum > steps0.ns_sum);
    assert_true(steps1.ns_sum - steps0.ns_sum <= span_ns);
    assert_true(requests1.count - requests0.count >= TURNS + 2);
    assert_int_equal(sum_of(&requests1), requests1.count);
    assert_int_equal(pccd_histogram(crossing->client, PCCD_HISTOGRAM_COUNT, &steps1),
                     PCCD_E_INVAL);
}

/* ---- settings ---------------------------------------------------------------------- */

struct settings {
    uint32_t count;
    char value[64]; /* of the last one */
    bool changed;
};

static void take_setting(void *context, const struct pccd_setting *setting)
{
    struct settings *settings = context;

    assert_true(setting->name[0] != '\0' && setting->text[0] != '\0');
    settings->count++;
    settings->changed = setting->changed;
    (void)snprintf(settings->value, sizeof settings->value, "%s", setting->value);
}

static void expect_setting(struct pccd_client *client, const char *name,
                           const char *value, bool changed)
{
    struct settings settings = {.count = 0};

    assert_ok(pccd_config_get(client, name, take_setting, &settings));
    assert_int_equal(settings.count, 1);
    assert_string_equal(settings.value, value);
    assert_int_equal(settings.changed, changed);
}

/* A new client may have so many scenes, or, if that is 100, more. */
static void expect_scenes(uint32_t count)
{
    struct pccd_client *client = test_client_at(test_shared.url);
    uint32_t scene = 0;

    for (uint32_t i = 0; i < count; i++) {
        scene = test_scene(client);
    }
    assert_int_equal(pccd_scene_create(client, NULL, &scene),
                     count < 100 ? PCCD_E_LIMIT : 0);
    pccd_close(client);
}

/* If it failed, a daemon could not be tuned without losing its clients, or would be told
 * nonsense. */
CASE_CROSSING(config__settings_change_and_hold)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *client = crossing->client;
    struct settings settings = {.count = 0};
    uint32_t mesh = 0;

    if (test_is_direct()) {
        test_skip("with direct: there are other quotas to begin with");
    }
    assert_ok(pccd_config_get(client, NULL, take_setting, &settings));
    assert_true(settings.count >= 14);
    assert_int_equal(pccd_config_get(client, "no-such", take_setting, &settings),
                     PCCD_E_INVAL);
    expect_setting(client, "meshes-max", "131072", false);
    assert_ok(pccd_config_set(client, "meshes-max", "2")); /* as it has */
    expect_setting(client, "meshes-max", "2", true);
    assert_int_equal(pccd_mesh_create(client, test_triangle_x, PCCD_FORMAT_F32, 3,
                                      test_triangle, 1, &mesh, NULL),
                     PCCD_E_QUOTA);
    assert_ok(pccd_config_set(client, "meshes-max", "1")); /* less than that */
    assert_int_equal(pccd_mesh_create(client, test_triangle_x, PCCD_FORMAT_F32, 3,
                                      test_triangle, 1, &mesh, NULL),
                     PCCD_E_QUOTA);
    assert_true(test_crossing_turn(crossing));
    assert_ok(pccd_config_set(client, "meshes-max", "131072"));
    expect_setting(client, "meshes-max", "131072", false);
    mesh = test_mesh(client, test_triangle_x, PCCD_FORMAT_F32, 3, test_triangle, 1);

    expect_setting(client, "scenes-max", "65536", false);
    assert_ok(pccd_config_set(client, "scenes-max", "2"));
    expect_scenes(2); /* of whoever connects from now on */
    assert_ok(pccd_config_set(client, "scenes-max", "65536"));
    expect_scenes(100);

    assert_ok(pccd_config_set(client, "log-level", "debug"));
    expect_setting(client, "log-level", "debug", true);
    assert_int_equal(pccd_config_set(client, "log-level", "loud"), PCCD_E_INVAL);
    assert_ok(pccd_config_set(client, "log-level", "info"));
    assert_int_equal(pccd_config_set(client, "threads", "0"), PCCD_E_INVAL);
    assert_int_equal(pccd_config_set(client, "threads", "4096"), PCCD_E_INVAL);
    assert_ok(pccd_config_set(client, "threads", "1"));
    assert_true(test_crossing_turn(crossing));
    assert_int_equal(pccd_config_set(client, "queue-max", "-1"), PCCD_E_INVAL);
    assert_int_equal(pccd_config_set(client, "queue-max", "9 "), PCCD_E_INVAL);
    assert_ok(pccd_config_set(client, "contacts-max", "1"));
    assert_true(test_daemon_logged(&test_shared, "meshes-max: 131072, was 1"));
    assert_ok(pccd_config_set(client, "contacts-max", "16777216"));
}

/* ---- watching ---------------------------------------------------------------------- */

/* If it failed, who watches would be told of other steps than there are, or of none. */
CASE_CROSSING(watch__tells_every_step_of_another_session)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *other = test_client_at(test_shared.url);
    struct pccd_daemon_info self;
    struct pccd_step_event event;
    uint64_t number = 0;

    assert_ok(pccd_daemon(crossing->client, &self));
    assert_int_equal(pccd_watch_next(other, 0, &event), PCCD_E_STATE);
    assert_int_equal(pccd_watch_start(other, self.session + 1000, 0), PCCD_E_HANDLE);
    assert_ok(pccd_watch_start(other, self.session, 0));
    assert_int_equal(pccd_watch_next(other, 0, &event), PCCD_E_AGAIN);
    assert_int_equal(pccd_watch_next(other, 20, &event), PCCD_E_TIMEOUT);
    for (int i = 0; i < TURNS; i++) {
        assert_true(test_crossing_turn(crossing));
        assert_ok(pccd_watch_next(other, -1, &event));
        assert_int_equal(event.session, self.session);
        assert_int_equal(event.scene, crossing->scene);
        assert_int_equal(event.status, 0);
        assert_int_equal(event.lost, 0);
        assert_true(event.total > 0 && (event.hash[0] != 0 || event.hash[1] != 0));
        assert_true(event.ns_step > 0 && event.number > number);
        number = event.number;
    }
    assert_ok(pccd_watch_start(other, 0, 77)); /* of a scene that is not there */
    assert_true(test_crossing_turn(crossing));
    assert_int_equal(pccd_watch_next(other, 20, &event), PCCD_E_TIMEOUT);
    assert_ok(pccd_watch_stop(other));
    pccd_close(other);
}

/* If it failed, a watcher that does not read would hold up steps, take the daemon's
 * memory, be dropped, or not hear that it has missed something. */
CASE_CROSSING(watch__who_does_not_read_hears_what_was_lost)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *other = test_client_at(test_shared.url);
    struct pccd_step_event event;
    const int turns = 3000;
    uint64_t told = 0, lost = 0;
    static struct test_raw raw; /* reads the messages themselves */
    struct proto_WATCH_STOP_result stopped;
    uint64_t sent = 0;

    assert_ok(test_raw_session(&raw, test_shared.socket, 0, 0));
    assert_ok(RAW_CALL(&raw, WATCH_START, NULL, .session = 0));
    assert_ok(pccd_watch_start(other, 0, 0));
    for (int i = 0; i < turns; i++) {
        assert_true(test_crossing_turn(crossing));
    }
    assert_int_not_equal(RAW_SEND(&raw, WATCH_STOP, .reserved = 0), 0);
    while (test_raw_receive(&raw) == 0 && raw.envelope.kind == PROTO_NOTIFICATION) {
        sent++;
    }
    assert_ok(proto_decode_body(&raw.envelope,
                                &proto_messages[PROTO_METHOD_WATCH_STOP].result, &stopped,
                                &raw.error));
    assert_in_range(sent + stopped.lost, turns - (int)PROTO_WATCH_ROOM, turns);
    test_raw_close(&raw);
    /* What waits comes before the answer: more than the library keeps; with the next step
     * it hears what the daemon has lost, and has no room for that either. */
    assert_ok(pccd_ping(other, NULL));
    assert_true(test_crossing_turn(crossing));
    assert_ok(pccd_ping(other, NULL));
    for (int more = 0; more < 2; more++) {
        while (pccd_watch_next(other, 100, &event) == 0) {
            told++;
            lost += event.lost;
        }
        assert_true(test_crossing_turn(crossing)); /* the last are told with one */
    }
    assert_int_equal(told + lost, turns + 2);
    assert_true(lost > 0 && told >= PROTO_WATCH_ROOM);
    assert_true(test_crossing_turn(crossing));
    pccd_close(other);
}

/* If it failed, who reads late would wait for the next step to hear of the last one. */
CASE_CROSSING(watch__who_reads_late_hears_of_all_that_fits)
{
    struct test_crossing *crossing = *state;
    struct pccd_client *other = test_client_at(test_shared.url);
    struct pccd_step_event event;
    const int turns = 300; /* less than what the way and the daemon keep */

    assert_ok(pccd_watch_start(other, 0, 0));
    for (int i = 0; i < turns; i++) {
        assert_true(test_crossing_turn(crossing));
    }
    for (int i = 0; i < turns; i++) {
        assert_ok(pccd_watch_next(other, -1, &event));
        assert_int_equal(event.lost, 0);
    }
    pccd_close(other);
}

/* ---- other users ------------------------------------------------------------------- */

/* [child] 0: everything that another user asks for is refused or empty. */
static int ask_as_nobody(uint64_t session)
{
    static struct test_raw raw;
    struct proto_LIST_SESSION_result listed = {.session = 0};
    int status = 0;

    if (setgroups(0, NULL) != 0 || setgid(NOBODY) != 0 || setuid(NOBODY) != 0 ||
        test_raw_session(&raw, test_shared.socket, 0, 0) != 0) {
        return 1;
    }
    if (RAW_CALL(&raw, LIST_SESSION, &listed, .before = 0) != 0 ||
        listed.session == session || listed.uid != NOBODY) {
        status |= 2;
    }
    if (RAW_CALL(&raw, LIST_SESSION, &listed, .before = listed.session) != 0 ||
        listed.session != 0) {
        status |= 4; /* its own is the only one */
    }
    if (RAW_CALL(&raw, LIST_SCENE, NULL, .session = session) != PCCD_E_HANDLE ||
        RAW_CALL(&raw, WATCH_START, NULL, .session = session) != PCCD_E_HANDLE) {
        status |= 8;
    }
    if (RAW_CALL(&raw, WATCH_START, NULL, .session = 0) != PCCD_E_ACCESS) {
        status |= 16;
    }
    if (RAW_CALL(&raw, CONFIG_SET, NULL, .name = "grace", .value = "1") !=
            PCCD_E_ACCESS ||
        RAW_CALL(&raw, CONFIG_GET, NULL, .name = "grace") != 0) {
        status |= 32;
    }
    test_raw_close(&raw);
    return status;
}

/* If it failed, a user could see what another one does, or change a daemon of another. */
CASE_CROSSING(observe__other_users_are_refused)
{
    struct test_crossing *crossing = *state;
    struct pccd_daemon_info self;
    int status = 0;

    if (geteuid() != 0 || test_is_direct()) {
        test_skip("only root can act as another user, and only to a daemon");
    }
    assert_ok(pccd_daemon(crossing->client, &self));
    assert_int_equal(chmod(test_shared.directory, 0711), 0);
    assert_int_equal(chmod(test_shared.socket, 0666), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(ask_as_nobody(self.session));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(chmod(test_shared.directory, 0700), 0);
    assert_int_equal(chmod(test_shared.socket, 0600), 0);
}

/* If it failed, an operator who has let more clients in would find them refused again
 * after a crash. */
CASE_DAEMON(config__outlives_a_crash, "--supervise")
{
    pid_t worker;

    struct pccd_client *client = test_client_at(test_own.url);
    assert_ok(pccd_config_set(client, "clients-max", "7"));
    assert_ok(pccd_config_set(client, "log-level", "warn"));
    for (int i = 0; i < 2; i++) {
        worker = (pid_t)pccd_daemon_pid(client);
        assert_int_equal(kill(worker, SIGKILL), 0);
        assert_ok(pccd_ping(client, NULL));
        assert_true((pid_t)pccd_daemon_pid(client) != worker);
        expect_setting(client, "clients-max", "7", true);
        expect_setting(client, "log-level", "warn", true);
        expect_setting(client, "meshes-max", "131072", false);
    }
    pccd_close(client);
}

CASES_WITH(test_shared_start, test_shared_stop);
