/* test_int_filter.c - which objects a real daemon tests, changed while it works. */
#include "cases.h"

#include <signal.h>

#include "crossing.h"
#include "daemon.h"
#include "must.h"
#include "object_attributes.h"
#include "raw.h"

static struct test_daemon daemon_;
static struct pccd_client *client;
static struct test_crossing crossing;

static int setup(void **state)
{
    const char *const options[] = {"--supervise", "--threads", "1", NULL};

    (void)state;
    if (!test_daemon_start(&daemon_, options)) {
        return -1;
    }
    client = test_connect(daemon_.url);
    return client != NULL ? test_crossing_make(client, &crossing) : -1;
}

static int teardown(void **state)
{
    (void)state;
    pccd_close(client);
    (void)test_daemon_end(&daemon_, SIGTERM, 10000);
    (void)test_daemon_finish(&daemon_);
    return 0;
}

/* The triangle goes through the floor, or back; step number `*step`. */
static void submit(uint64_t *step)
{
    struct pccd_frame frame;
    void *x1;

    crossing.z = -crossing.z;
    assert_ok(pccd_frame_begin(client, crossing.scene, 1, sizeof(float[3][3]), &frame));
    assert_ok(pccd_frame_x1(&frame, crossing.object, PCCD_FORMAT_F32, 0, 3, &x1));
    test_crossing_positions(x1, crossing.z);
    assert_ok(pccd_frame_commit(&frame, NULL, step));
}

static uint64_t contacts_of(uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t total;

    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    total = answer.total;
    pccd_answer_release(client, &answer);
    return total;
}

static uint64_t turn(void)
{
    uint64_t step;

    submit(&step);
    return contacts_of(step);
}

static void set(uint32_t what, uint64_t group, uint64_t mask, bool self)
{
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                            .what = what,
                                            .self_collision = self,
                                            .group = group,
                                            .mask = mask};

    assert_ok(pccd_object_set(client, crossing.scene, crossing.object, &settings));
}

static void check_object(uint64_t group, uint64_t mask, bool self)
{
    struct pccd_object_settings settings = {.struct_bytes = 0};

    assert_ok(pccd_object_get(client, crossing.scene, crossing.object, &settings));
    assert_int_equal(settings.what, PCCD_OBJECT_ALL);
    assert_true(settings.group == group && settings.mask == mask &&
                settings.self_collision == self);
}

static int ignore(bool ignored)
{
    return pccd_pair_ignore(client, crossing.scene, crossing.object, crossing.floor,
                            ignored);
}

/* If it failed, a change would reach steps that were submitted before it, or not those
 * that were submitted after it. */
CASE_WITH(filter__changes_between_steps_in_flight, setup, teardown)
{
    uint64_t steps[4];

    check_object(1, UINT64_MAX, true);
    for (int round = 0; round < 20; round++) {
        submit(&steps[0]);
        set(PCCD_OBJECT_MASK, 77, 2, true); /* the group is not named */
        submit(&steps[1]);
        set(PCCD_OBJECT_MASK, 77, 3, true);
        submit(&steps[2]);
        assert_int_equal(ignore(true), 0);
        submit(&steps[3]);
        assert_true(contacts_of(steps[0]) > 0);
        assert_int_equal(contacts_of(steps[1]), 0);
        assert_true(contacts_of(steps[2]) > 0);
        assert_int_equal(contacts_of(steps[3]), 0);
        assert_int_equal(ignore(true), 0); /* twice is as once */
        assert_int_equal(ignore(false), 0);
        assert_true(turn() > 0);
    }
    check_object(1, 3, true);
    check_object(1, 3, true);
}

/* If it failed, an object would meet others again when its mesh is replaced, or the next
 * one in its place would ignore what it did. */
CASE_WITH(filter__stays_with_its_object, setup, teardown)
{
    set(PCCD_OBJECT_GROUP | PCCD_OBJECT_SELF, 4, 0, false);
    assert_int_equal(ignore(true), 0);
    assert_ok(pccd_mesh_replace(client, crossing.mesh, test_triangle_x, PCCD_FORMAT_F32,
                                3, test_triangle, 1, NULL));
    crossing.z = 1;
    check_object(4, UINT64_MAX, false);
    assert_int_equal(turn(), 0);
    assert_ok(pccd_scene_remove(client, crossing.scene, crossing.object));
    assert_int_equal(ignore(false), PCCD_E_HANDLE);
    crossing.object = test_object(client, crossing.scene, crossing.mesh);
    check_object(1, UINT64_MAX, true);
    crossing.z = 1;
    assert_true(turn() > 0);
}

/* If it failed, a client would have contacts after a crash that it had ruled out, or none
 * where it had taken that back. */
CASE_WITH(filter__comes_back_with_another_daemon, setup, teardown)
{
    struct pccd_link_info info;

    for (int round = 0; round < 4; round++) {
        set(PCCD_OBJECT_SELF, 0, 0, false);
        set(PCCD_OBJECT_MASK, 0, round % 2 == 0 ? 6 : 7, true);
        assert_int_equal(ignore(true), 0);
        assert_int_equal(ignore(round > 1), 0);
        uint64_t before = turn();
        assert_int_equal(before > 0, round == 1);
        assert_int_equal(kill((pid_t)pccd_daemon_pid(client), SIGKILL), 0);
        assert_int_equal(turn(), before);
        check_object(1, round % 2 == 0 ? 6 : 7, false);
        assert_int_equal(ignore(false), 0);
        set(PCCD_OBJECT_MASK, 0, 1, true);
        assert_true(turn() > 0);
    }
    assert_ok(pccd_link(client, &info));
    assert_int_equal(info.reconnects, 4);
}

struct seen {
    uint32_t objects, filtered, pairs, ignored;
    struct pccd_ignored_pair pair;
};

static void see_scene(void *context, const struct pccd_scene_info *info)
{
    ((struct seen *)context)->ignored = info->ignored;
}

static void see_object(void *context, const struct pccd_object_info *info)
{
    struct seen *seen = context;

    seen->objects++;
    seen->filtered += info->object == crossing.object && info->group == 6 &&
                      info->mask == 9 && !info->self_collision;
    seen->filtered += info->object == crossing.floor && info->group == 1 &&
                      info->mask == UINT64_MAX && info->self_collision;
}

static void see_pair(void *context, const struct pccd_ignored_pair *pair)
{
    struct seen *seen = context;

    seen->pairs++;
    seen->pair = *pair;
}

static struct seen look(struct pccd_client *at)
{
    struct pccd_daemon_info daemon;
    struct seen seen = {.objects = 0};

    assert_ok(pccd_daemon(client, &daemon));
    assert_ok(pccd_list_scenes(at, daemon.session, see_scene, &seen));
    assert_ok(pccd_list_objects(at, daemon.session, crossing.scene, see_object, &seen));
    assert_ok(pccd_list_pairs(at, daemon.session, crossing.scene, see_pair, &seen));
    return seen;
}

/* If it failed, nobody could see why two objects do not meet. */
CASE_WITH(filter__is_listed, setup, teardown)
{
    struct pccd_client *other = test_client_at(daemon_.url);
    struct seen seen;

    seen = look(other);
    assert_true(seen.objects == 2 && seen.filtered == 1 && seen.pairs == 0);
    set(PCCD_OBJECT_ALL, 6, 9, false);
    assert_int_equal(ignore(true), 0);
    seen = look(other);
    assert_true(seen.objects == 2 && seen.filtered == 2);
    assert_int_equal(seen.pairs, 1);
    assert_int_equal(seen.ignored, 1);
    assert_int_equal(seen.pair.object_a + seen.pair.object_b,
                     crossing.object + crossing.floor);
    assert_ok(pccd_scene_remove(client, crossing.scene, crossing.floor));
    seen = look(client);
    assert_true(seen.objects == 1 && seen.pairs == 0 && seen.ignored == 0);
    assert_int_equal(pccd_list_pairs(other, 9999, crossing.scene, see_pair, &seen),
                     PCCD_E_HANDLE);
    pccd_close(other);
}

/* If it failed, a game would be told that another of its bodies was hit: also after the
 * daemon was lost. */
CASE_WITH(filter__user_data_is_given_back, setup, teardown)
{
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                            .what = PCCD_OBJECT_USER_DATA,
                                            .user_data = UINT64_MAX - 6};
    const uint32_t objects[3] = {crossing.object, crossing.floor, 77};
    uint64_t is[3] = {9, 9, 9};
    struct { /* of a program of before */
        struct pccd_object_settings settings;
    } old = {.settings = {.user_data = 5}};

    assert_ok(pccd_user_data(client, crossing.scene, objects, 3, is));
    assert_true(is[0] == 0 && is[1] == 0 && is[2] == 0);
    assert_ok(pccd_object_set(client, crossing.scene, crossing.object, &settings));
    set(PCCD_OBJECT_GROUP, 1, 0, true);
    assert_ok(kill((pid_t)pccd_daemon_pid(client), SIGKILL));
    assert_true(turn() > 0);
    settings.user_data = 0;
    assert_ok(pccd_object_get(client, crossing.scene, crossing.object, &settings));
    assert_true(settings.user_data == UINT64_MAX - 6 && settings.group == 1);
    assert_ok(pccd_object_get(client, crossing.scene, crossing.object, &old.settings));
    assert_true(old.settings.user_data == 5 && old.settings.group == 1);
    assert_ok(pccd_user_data(client, crossing.scene, objects, 3, is));
    assert_true(is[0] == UINT64_MAX - 6 && is[1] == 0 && is[2] == 0);
    assert_ok(pccd_user_data(client, crossing.scene + 1, objects, 3, is));
    assert_true(is[0] == 0);
    assert_ok(pccd_scene_remove(client, crossing.scene, crossing.object));
    assert_ok(pccd_user_data(client, crossing.scene, objects, 3, is));
    assert_true(is[0] == 0);
}

/* If it failed, a caller's mistake would change something, or not be told. */
CASE_WITH(filter__refuses_what_cannot_be, setup, teardown)
{
    struct {
        struct pccd_object_settings settings;
        uint64_t of_a_newer_release;
    } newer = {.settings.what = PCCD_OBJECT_USER_DATA, .of_a_newer_release = 1};
    struct pccd_object_settings settings = {.what = COMMON_OBJECT_KNOWN + 1};
    char bit[16];
    const uint32_t scene = crossing.scene;
    const uint32_t object = crossing.object;

    assert_int_equal(pccd_object_set(client, scene, object, &settings), PCCD_E_INVAL);
    (void)snprintf(bit, sizeof bit, "0x%x", COMMON_OBJECT_KNOWN + 1);
    assert_non_null(strstr(pccd_error_text(client), bit));
    settings.what = 0;
    assert_int_equal(pccd_object_set(client, scene, object, &settings), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(client), "names nothing"));
    assert_int_equal(pccd_object_set(client, scene, object, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_object_get(client, scene, object, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_object_set(NULL, scene, object, &settings), PCCD_E_INVAL);
    settings.what = PCCD_OBJECT_ALL;
    settings.struct_bytes = 8;
    assert_int_equal(pccd_object_set(client, scene, object, &settings), PCCD_E_INVAL);
    newer.settings.struct_bytes = sizeof newer;
    assert_int_equal(pccd_object_set(client, scene, object, &newer.settings),
                     PCCD_E_INVAL);
    newer.of_a_newer_release = 0;
    assert_ok(pccd_object_set(client, scene, object, &newer.settings));
    settings.struct_bytes = sizeof settings;
    assert_int_equal(pccd_object_set(client, scene, object + 1, &settings),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_object_set(client, scene + 1, object, &settings),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_pair_ignore(client, scene, object, object, true), PCCD_E_INVAL);
    assert_int_equal(pccd_pair_ignore(client, scene, object, 0, true), PCCD_E_HANDLE);
    assert_int_equal(pccd_pair_ignore(client, scene + 1, object, crossing.floor, true),
                     PCCD_E_HANDLE);
    assert_int_equal(pccd_pair_ignore(NULL, scene, object, crossing.floor, true),
                     PCCD_E_INVAL);
    check_object(1, UINT64_MAX, true);
    assert_true(turn() > 0);
}

/* If it failed, a client that does not use the library could write past what there is, or
 * be misunderstood by a daemon that is older than it. */
CASE_WITH(filter__refuses_what_the_library_would_not_send, setup, teardown)
{
    static const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static struct test_raw raw;
    struct proto_OBJECT_SET_request request = {.what = 0x80000000u};
    struct proto_OBJECT_SET_result now;
    uint32_t mesh, ids[2];

    assert_true(test_raw_open(&raw, daemon_.socket));
    assert_int_equal(test_raw_call(&raw, PROTO_METHOD_OBJECT_SET, &request, NULL),
                     PCCD_E_NOHELLO);
    assert_ok(test_raw_hello(&raw));
    assert_int_equal(test_raw_call(&raw, PROTO_METHOD_OBJECT_SET, &request, NULL),
                     PCCD_E_HANDLE);
    assert_ok(test_raw_attach(&raw, 1, 4096));
    assert_ok(test_raw_mesh(&raw, x, 3, test_triangle, 1, &mesh));
    assert_ok(test_raw_scene(&raw, "", &request.scene));
    assert_ok(test_raw_add(&raw, request.scene, mesh, &request.object));
    assert_int_equal(test_raw_call(&raw, PROTO_METHOD_OBJECT_SET, &request, NULL),
                     PCCD_E_INVAL);
    assert_int_equal(RAW_CALL(&raw, SCENE_IGNORE, NULL, .scene = request.scene,
                              .a = request.object, .b = request.object, .ignored = true),
                     PCCD_E_INVAL);
    request.what = PCCD_OBJECT_GROUP;
    request.group = UINT64_MAX;
    assert_ok(test_raw_call(&raw, PROTO_METHOD_OBJECT_SET, &request, &now));
    assert_true(now.group == UINT64_MAX && now.mask == UINT64_MAX && now.self_collision);
    /* Asked for behind its removal, before that is answered. */
    ids[0] =
        RAW_SEND(&raw, SCENE_REMOVE, .scene = request.scene, .object = request.object);
    ids[1] = test_raw_request(&raw, PROTO_METHOD_OBJECT_SET, &request);
    assert_ok(test_raw_answer(&raw, ids[0], PROTO_METHOD_SCENE_REMOVE, NULL));
    assert_int_equal(test_raw_answer(&raw, ids[1], PROTO_METHOD_OBJECT_SET, NULL),
                     PCCD_E_HANDLE);
    test_raw_close(&raw);
}
