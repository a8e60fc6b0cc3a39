/* test_int_shared.c - scenes that clients share. */
#include "cases.h"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixture.h"
#include "must.h"

/* One client in the scene, with a triangle or the floor in it. */
struct member {
    struct pccd_client *client;
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
    const float (*rest)[3]; /* at height 0 for the floor, 1 for the triangle */
};

static void open_member(struct member *member, const char *name, const float rest[3][3])
{
    *member = (struct member){.client = test_client_at(test_shared.url), .rest = rest};
    assert_ok(test_take_part(member->client, name, PCCD_SHARE_OPEN, 0, &member->scene));
    member->mesh = test_mesh(member->client, rest, PCCD_FORMAT_F32, 3, test_triangle, 1);
    member->object = test_object(member->client, member->scene, member->mesh);
}

/* Submit its object's way to `up` above where it was registered. */
static int submit(struct member *member, uint32_t object, float up,
                  const struct pccd_step_settings *settings, uint64_t *step)
{
    struct pccd_frame frame;
    void *to = NULL;
    float x[3][3];
    int status = pccd_frame_begin(member->client, member->scene, 1, sizeof x, &frame);

    memcpy(x, member->rest, sizeof x);
    for (int i = 0; i < 3; i++) {
        x[i][2] += up;
    }
    status =
        status != 0 ? status : pccd_frame_x1(&frame, object, PCCD_FORMAT_F32, 0, 3, &to);
    if (status != 0) {
        return status;
    }
    memcpy(to, x, sizeof x);
    return pccd_frame_commit(&frame, settings, step);
}

static int move(struct member *member, float up, struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status = submit(member, member->object, up, NULL, &step);

    return status != 0 ? status : pccd_wait(member->client, step, -1, answer);
}

static uint64_t hold(struct member *member, float up, uint64_t deadline_ns)
{
    struct pccd_step_settings settings = {.struct_bytes =
                                              sizeof(struct pccd_step_settings),
                                          .hold = true,
                                          .deadline_ns = deadline_ns};
    uint64_t step = 0;

    assert_int_equal(submit(member, member->object, up, &settings, &step), 0);
    assert_ok(pccd_wait_held(member->client, step, -1));
    return step;
}

/* If it failed, objects of two processes would be moved one after the other, and what
 * they meet in between be missed; or who held a frame would not hear what came of it. */
CASE(shared__held_frames_move_over_the_same_time)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    uint64_t step;

    open_member(&cloth, "both", test_triangle_x);
    open_member(&obstacle, "both", test_floor_x);
    assert_int_not_equal(cloth.object, obstacle.object);
    /* The cloth comes from 1 to 0.5, the obstacle from 0 to 1: they meet at 2/3. */
    /* Another one's step answers it, which asks for nothing of this. */
    const struct pccd_step_settings tells = {
        .struct_bytes = sizeof tells, .hold = true, .tells_start = true};
    assert_int_equal(submit(&obstacle, obstacle.object, 1, &tells, &step), 0);
    assert_int_equal(pccd_wait(obstacle.client, step, -1, &held), PCCD_E_INVAL);
    step = hold(&obstacle, 1, 0);
    assert_int_equal(pccd_wait(obstacle.client, step, 0, &held), PCCD_E_AGAIN);
    assert_int_equal(move(&cloth, -0.5f, &answer), 0);
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    assert_int_equal(answer.number, 1);
    assert_true(answer.count == answer.total && answer.count > 0);
    for (uint64_t i = 0; i < answer.count; i++) {
        assert_true(fabs(answer.contacts[i].toi - 2.0 / 3.0) < 1e-5);
    }
    assert_ok(pccd_wait(obstacle.client, step, -1, &held));
    assert_int_equal(held.step, step);
    assert_int_equal(held.number, 1);
    assert_int_equal(held.total, answer.total);
    assert_int_equal(held.count, 0);
    assert_int_equal(held.incomplete, PCCD_INCOMPLETE_RESULT_FULL);
    assert_memory_equal(held.hash, answer.hash, sizeof held.hash);
    assert_ok(pccd_scene_read(obstacle.client, obstacle.scene, held.number, 0, &held));
    assert_int_equal(held.count, answer.count);
    assert_memory_equal(held.contacts, answer.contacts,
                        answer.count * sizeof *answer.contacts);
    pccd_answer_release(obstacle.client, &held);
    pccd_answer_release(cloth.client, &answer);
    /* Both stay where they are now. */
    assert_int_equal(move(&cloth, -0.5f, &answer), 0);
    assert_int_equal(answer.total, 0);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* Step the scene by a batch with another one, in which nothing moves. */
static int move_by_batch(struct member *member, uint32_t still, uint32_t object, float up,
                         struct pccd_batch_answer *answer)
{
    const struct pccd_batch_part parts[2] = {
        {.scene = still}, {.scene = member->scene, .object = object, .count = 3}};
    struct pccd_batch *batch = NULL;
    float x[3][3];
    const void *x1[2] = {NULL, x};
    int status = pccd_batch_create(member->client, parts, 2, &batch);

    memcpy(x, member->rest, sizeof x);
    for (int i = 0; i < 3; i++) {
        x[i][2] += up;
    }
    status = status != 0 ? status : pccd_batch_step(batch, NULL, x1, NULL, answer);
    pccd_batch_destroy(batch);
    return status;
}

/* If it failed, who steps many scenes at once could not let somebody look at one of them;
 * or what others hold for that one, or are to hear of its steps, would be forgotten; or a
 * batch could move what is another's. */
CASE(shared__a_batch_steps_it_as_a_step_does)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer held = PCCD_ANSWER_INIT;
    struct pccd_scene_news news = {.number = 0};
    uint64_t step;

    open_member(&cloth, "of many", test_triangle_x);
    open_member(&obstacle, "of many", test_floor_x);
    uint32_t own = test_scene(cloth.client);
    /* As above: the cloth comes from 1 to 0.5, the obstacle from 0 to 1. */
    step = hold(&obstacle, 1, 0);
    assert_int_equal(move_by_batch(&cloth, own, obstacle.object, 0, &all), 0);
    assert_int_equal(all.scenes[0].status, 0);
    assert_int_equal(all.scenes[1].status, PCCD_E_ACCESS);
    pccd_batch_release(cloth.client, &all);
    assert_int_equal(pccd_wait(obstacle.client, step, 0, &held), PCCD_E_AGAIN);
    assert_int_equal(move_by_batch(&cloth, own, cloth.object, -0.5f, &all), 0);
    assert_int_equal(all.failed, 0);
    assert_int_equal(all.scenes[0].number, 2);
    assert_int_equal(all.scenes[1].number, 1);
    assert_true(all.scenes[1].total > 0 && all.scenes[1].count == all.scenes[1].total);
    for (uint64_t i = 0; i < all.scenes[1].count; i++) {
        assert_true(fabs(pccd_batch_contacts(&all, 1)[i].toi - 2.0 / 3.0) < 1e-5);
    }
    assert_ok(pccd_wait(obstacle.client, step, -1, &held));
    assert_int_equal(held.number, 1);
    assert_int_equal(held.total, all.scenes[1].total);
    assert_memory_equal(held.hash, all.scenes[1].hash, sizeof held.hash);
    assert_ok(pccd_scene_wait(obstacle.client, obstacle.scene, -1, &news));
    assert_int_equal(news.number, 1);
    assert_int_equal(news.total, all.scenes[1].total);
    assert_ok(pccd_scene_read(obstacle.client, obstacle.scene, held.number, 0, &held));
    assert_memory_equal(held.contacts, pccd_batch_contacts(&all, 1),
                        held.count * sizeof *held.contacts);
    pccd_answer_release(obstacle.client, &held);
    pccd_batch_release(cloth.client, &all);
    /* Both stay where they are now, whoever steps. */
    own = test_scene(obstacle.client);
    assert_int_equal(move_by_batch(&obstacle, own, obstacle.object, 1, &all), 0);
    assert_int_equal(all.failed, 0);
    assert_int_equal(all.scenes[1].number, 2);
    assert_int_equal(all.scenes[1].total, 0);
    pccd_batch_release(obstacle.client, &all);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, one client could move or remove what is another's, or its bad step would
 * take with it what others hold for the next one. */
CASE(shared__an_object_has_one_writer)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .hold = true};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t held;
    uint64_t step = 0;

    open_member(&cloth, "writers", test_triangle_x);
    open_member(&obstacle, "writers", test_floor_x);
    assert_int_equal(submit(&cloth, obstacle.object, 1, NULL, &step), 0);
    assert_int_equal(pccd_wait(cloth.client, step, -1, &answer), PCCD_E_ACCESS);
    assert_int_equal(pccd_scene_remove(cloth.client, cloth.scene, obstacle.object),
                     PCCD_E_ACCESS);
    held = hold(&obstacle, 1, 0);
    /* A second one has to wait for the first. */
    assert_int_equal(submit(&obstacle, obstacle.object, 2, &settings, &step), 0);
    assert_int_equal(pccd_wait(obstacle.client, step, -1, &answer), PCCD_E_BUSY);
    assert_int_equal(move(&cloth, NAN, &answer), PCCD_E_NOTFINITE);
    assert_int_equal(pccd_wait(obstacle.client, held, 0, &answer), PCCD_E_AGAIN);
    assert_int_equal(move(&cloth, -0.5f, &answer), 0);
    assert_true(answer.total > 0);
    pccd_answer_release(cloth.client, &answer);
    assert_ok(pccd_wait(obstacle.client, held, -1, &answer));
    /* What is not finite is refused when it comes. */
    assert_int_equal(submit(&obstacle, obstacle.object, NAN, &settings, &step), 0);
    assert_int_equal(pccd_wait(obstacle.client, step, -1, &answer), PCCD_E_NOTFINITE);
    assert_int_equal(move(&cloth, 0, &answer), 0);
    pccd_answer_release(cloth.client, &answer);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, a held frame would be answered late or never, or not go along after its
 * deadline or cancel: a motion would be left out. */
CASE(shared__a_held_frame_is_answered_at_its_deadline_and_cancel)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step;

    open_member(&cloth, "late", test_triangle_x);
    open_member(&obstacle, "late", test_floor_x);
    step = hold(&obstacle, 2, 1000000);
    assert_ok(pccd_wait(obstacle.client, step, -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_int_equal(move(&cloth, 0, &answer), 0);
    assert_true(answer.total > 0); /* from 0 to 2, through it */
    pccd_answer_release(cloth.client, &answer);
    step = hold(&obstacle, 0, 0);
    assert_ok(pccd_cancel(obstacle.client, step));
    assert_ok(pccd_wait(obstacle.client, step, -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
    assert_int_equal(move(&cloth, 0, &answer), 0);
    assert_true(answer.total > 0);
    pccd_answer_release(cloth.client, &answer);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, a loop that watches descriptors would sleep over such a deadline, or turn
 * for ever after it. */
CASE(shared__a_held_frames_deadline_makes_readable)
{
    struct member cloth;
    struct member obstacle;
    struct pollfd ready = {.events = POLLIN};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t begin_ms;

    open_member(&cloth, "readable", test_triangle_x);
    open_member(&obstacle, "readable", test_floor_x);
    ready.fd = pccd_fd(obstacle.client);
    begin_ms = test_now_ms();
    (void)hold(&obstacle, 1, 50000000);
    assert_int_equal(poll(&ready, 1, 10000), 1);
    assert_in_range(test_now_ms() - begin_ms, 49, 9000);
    assert_ok(pccd_poll(obstacle.client, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_int_equal(poll(&ready, 1, 0), 0);
    ready.fd = pccd_fd(cloth.client);
    assert_int_equal(poll(&ready, 1, 0), 0);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, nobody could wait for a frame to be held and know that the next step
 * takes it along. */
CASE(shared__a_held_frame_is_told)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;

    open_member(&cloth, "told", test_triangle_x);
    open_member(&obstacle, "told", test_floor_x);
    assert_int_equal(submit(&cloth, cloth.object, 0, NULL, &step), 0);
    assert_int_equal(pccd_wait_held(cloth.client, step, 0), PCCD_E_INVAL);
    assert_ok(pccd_wait(cloth.client, step, -1, &answer));
    pccd_answer_release(cloth.client, &answer);
    for (int i = 0; i < 2; i++) {
        step = hold(&obstacle, 1, 0);
        assert_ok(pccd_wait_held(obstacle.client, step, 0)); /* still */
        assert_int_equal(pccd_wait_held(obstacle.client, step + 1, 0), PCCD_E_INVAL);
        assert_int_equal(move(&cloth, 1, &answer), 0);
        pccd_answer_release(cloth.client, &answer);
        assert_ok(pccd_wait_held(obstacle.client, step, 0));
        assert_ok(pccd_wait(obstacle.client, step, -1, &answer));
        assert_int_equal(pccd_wait_held(obstacle.client, step, 0), PCCD_E_INVAL);
    }
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

struct seen {
    struct pccd_scene_info info;
    uint32_t scenes, objects, foreign;
    uint64_t owner;
};

static void see_scene(void *context, const struct pccd_scene_info *info)
{
    struct seen *seen = context;

    if (strcmp(info->name, "listed") == 0) {
        seen->info = *info;
        seen->info.name = NULL;
        seen->scenes++;
    }
}

static void see_object(void *context, const struct pccd_object_info *info)
{
    struct seen *seen = context;

    seen->objects++;
    seen->foreign += info->owner != seen->owner;
}

/* If it failed, nobody could see who takes part in a scene, or whose an object is. */
CASE(shared__is_listed)
{
    struct pccd_client *reader = test_connect(test_shared.url);
    struct member cloth;
    struct member obstacle;
    struct seen seen = {.scenes = 0};
    struct pccd_daemon_info daemon;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step;

    open_member(&cloth, "listed", test_triangle_x);
    open_member(&obstacle, "listed", test_floor_x);
    step = hold(&obstacle, 1, 0);
    assert_ok(pccd_daemon(cloth.client, &daemon));
    seen.owner = daemon.session;
    assert_ok(pccd_list_scenes(reader, daemon.session, see_scene, &seen));
    assert_int_equal(seen.scenes, 1);
    assert_int_equal(seen.info.objects, 2);
    assert_int_equal(seen.info.rights, 0600);
    assert_int_equal(seen.info.uid, geteuid());
    assert_int_equal(seen.info.members, 2);
    assert_int_equal(seen.info.held, 1);
    assert_true(seen.info.writable);
    assert_ok(pccd_list_objects(reader, daemon.session, cloth.scene, see_object, &seen));
    assert_int_equal(seen.objects, 2);
    assert_int_equal(seen.foreign, 1);
    assert_int_equal(move(&cloth, 0, &answer), 0);
    pccd_answer_release(cloth.client, &answer);
    assert_ok(pccd_wait(obstacle.client, step, -1, &answer));
    assert_ok(pccd_list_scenes(reader, daemon.session, see_scene, &seen));
    assert_int_equal(seen.info.held, 0);
    pccd_close(obstacle.client);
    pccd_close(cloth.client);
    pccd_close(reader);
}

/* If it failed, a client that leaves a scene while a frame of its waits there would end
 * the daemon for all, or wait for ever. */
CASE(shared__leaving_ends_what_is_held)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step;

    open_member(&cloth, "left", test_triangle_x);
    open_member(&obstacle, "left", test_floor_x);
    step = hold(&obstacle, 2, 0);
    assert_ok(pccd_scene_destroy(obstacle.client, obstacle.scene));
    assert_ok(pccd_wait(obstacle.client, step, -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
    assert_int_equal(move(&cloth, -2, &answer), 0); /* the floor has gone, too */
    assert_int_equal(answer.total, 0);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, a reader would not hear of a step, read other records than the one who
 * made it, or be told of none after it had been slow. */
CASE(shared__readers_hear_of_every_last_step)
{
    enum { STEPS = 300 };
    struct member cloth;
    struct member obstacle;
    struct pccd_client *reader = test_client_at(test_shared.url);
    struct pccd_scene_news news = {.number = 0};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_answer read = PCCD_ANSWER_INIT;
    uint32_t scene = 0;

    open_member(&cloth, "news", test_triangle_x);
    open_member(&obstacle, "news", test_floor_x);
    assert_int_equal(test_take_part(reader, "news", PCCD_SHARE_ATTACH, 0, &scene), 0);
    assert_int_equal(pccd_scene_wait(reader, scene, 0, &news), PCCD_E_AGAIN);
    assert_int_equal(move(&cloth, -2, &answer), 0);
    assert_ok(pccd_scene_wait(reader, scene, -1, &news));
    assert_int_equal(news.number, answer.number);
    assert_int_equal(news.total, answer.total);
    assert_memory_equal(news.hash, answer.hash, sizeof news.hash);
    assert_ok(pccd_scene_read(reader, scene, news.number, 0, &read));
    assert_int_equal(read.count, answer.count);
    assert_memory_equal(read.contacts, answer.contacts,
                        answer.count * sizeof *answer.contacts);
    pccd_answer_release(reader, &read);
    pccd_answer_release(cloth.client, &answer);
    assert_int_equal(pccd_scene_wait(reader, scene, 0, &news), PCCD_E_AGAIN);
    /* More than its socket holds, before it reads on. */
    for (int i = 0; i < STEPS; i++) {
        assert_int_equal(move(&cloth, i % 2 == 0 ? 0.0f : -2.0f, &answer), 0);
        pccd_answer_release(cloth.client, &answer);
    }
    while (news.number < STEPS + 1) {
        assert_ok(pccd_scene_wait(reader, scene, -1, &news));
    }
    assert_int_equal(news.number, STEPS + 1);
    assert_int_equal(pccd_scene_read(reader, scene, news.number - 1, 0, &read),
                     PCCD_E_STATE);
    /* By the numbers of the scene, both: cloth's own are others. */
    char told[64];
    snprintf(told, sizeof told, "to its step %d, not to %d", STEPS + 1, STEPS);
    assert_non_null(strstr(pccd_error_text(reader), told));
    assert_ok(pccd_scene_read(reader, scene, news.number, 0, &read));
    assert_memory_equal(read.hash, answer.hash, sizeof read.hash);
    pccd_answer_release(reader, &read);
    pccd_close(reader);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

/* If it failed, a client that leaves would leave its objects behind or take others' with
 * it; or a scene would end with who made it, or never. */
CASE(shared__a_scene_lives_as_long_as_anybody_takes_part)
{
    struct pccd_client *watcher = test_client_at(test_shared.url);
    struct member maker;
    struct member other;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    static const char *const counters[] = {"scenes_now", "objects_now", "triangles_now",
                                           "shm_bytes_now"};
    uint32_t scene = 0;

    for (size_t i = 0; i < sizeof counters / sizeof counters[0]; i++) {
        assert_int_equal(test_stat_await(watcher, counters[i], 0), 0);
    }
    open_member(&maker, "home", test_triangle_x);
    open_member(&other, "home", test_floor_x);
    (void)hold(&maker, -2, 0);
    assert_int_equal(test_stat(watcher, "scenes_now"), 1);
    assert_int_equal(test_stat(watcher, "objects_now"), 2);
    pccd_close(maker.client); /* and what it held */
    assert_int_equal(test_stat_await(watcher, "objects_now", 1), 1);
    assert_int_equal(move(&other, 2, &answer), 0);
    assert_int_equal(answer.total, 0);
    open_member(&maker, "home", test_triangle_x);
    assert_int_equal(move(&maker, 2, &answer), 0);
    assert_true(answer.total > 0); /* the floor is at 2 */
    pccd_answer_release(maker.client, &answer);
    /* A name is taken once, and free again in the end. */
    assert_int_equal(test_take_part(watcher, "home", PCCD_SHARE_CREATE, 0, &scene),
                     PCCD_E_STATE);
    assert_int_equal(test_take_part(maker.client, "home", PCCD_SHARE_OPEN, 0, &scene),
                     PCCD_E_STATE);
    assert_ok(pccd_scene_destroy(other.client, other.scene));
    assert_int_equal(move(&maker, 4, &answer), 0);
    assert_int_equal(answer.total, 0);
    pccd_close(maker.client);
    pccd_close(other.client);
    for (size_t i = 0; i < sizeof counters / sizeof counters[0]; i++) {
        assert_int_equal(test_stat_await(watcher, counters[i], 0), 0);
    }
    assert_int_equal(test_take_part(watcher, "home", PCCD_SHARE_ATTACH, 0, &scene),
                     PCCD_E_AGAIN);
    assert_int_equal(test_take_part(watcher, "home", PCCD_SHARE_CREATE, 0, &scene), 0);
    assert_ok(pccd_scene_destroy(watcher, scene));
    pccd_close(watcher);
}

/* Nobody but root may act as another user, and only to a daemon: else skip the test. */
static void connect_two_users(struct pccd_client **mine, struct pccd_client **theirs)
{
    if (geteuid() != 0 || test_is_direct()) {
        test_skip("only root can act as another user, and only to a daemon");
    }
    *mine = test_connect(test_shared.url);
    *theirs = test_connect_as_other();
    assert_non_null(*mine);
    assert_non_null(*theirs);
}

/* If it failed, users who may not would see or change a scene, or those who may could
 * not; or each user would be charged for the other's memory. */
CASE(shared__rights_are_as_of_a_file)
{
    struct pccd_client *mine;
    struct pccd_client *theirs;
    struct member member;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    uint32_t secret = 0;
    uint32_t seen = 0;
    uint32_t open = 0;
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    uint32_t scene = 0;
    uint32_t object = 0;

    connect_two_users(&mine, &theirs);
    assert_int_equal(test_take_part(mine, "secret", PCCD_SHARE_CREATE, 0, &secret), 0);
    assert_int_equal(test_take_part(mine, "seen", PCCD_SHARE_CREATE, 0644, &seen), 0);
    assert_int_equal(test_take_part(mine, "open", PCCD_SHARE_CREATE, 0666, &open), 0);
    assert_int_equal(test_take_part(mine, "odd", PCCD_SHARE_CREATE, 0755, &scene),
                     PCCD_E_INVAL);
    assert_int_equal(pccd_scene_join(theirs, 0, "secret", &scene), PCCD_E_ACCESS);
    assert_int_equal(pccd_scene_join(theirs, 0, "odd", &scene), PCCD_E_AGAIN);
    uint32_t mesh = test_mesh(theirs, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    assert_ok(pccd_scene_join(theirs, 0, "seen", &scene));
    assert_int_equal(pccd_scene_add(theirs, scene, mesh, &object), PCCD_E_ACCESS);
    uint32_t own = test_scene(theirs);
    member = (struct member){.client = theirs, .scene = own, .rest = test_floor_x};
    assert_int_equal(move_by_batch(&member, scene, 1, 0, &all), 0);
    assert_int_equal(all.scenes[0].status, PCCD_E_ACCESS);
    assert_non_null(strstr(all.scenes[0].why, "only read"));
    pccd_batch_release(theirs, &all);
    assert_ok(pccd_submit_still(theirs, scene, NULL, &step));
    assert_int_equal(pccd_wait(theirs, step, -1, &answer), PCCD_E_ACCESS);
    assert_ok(pccd_scene_join(theirs, 0, "open", &scene));
    /* The memory is that of who made the scene: the guest's triangles bound it. */
    uint64_t triangles = test_stat(mine, "triangles_now");
    object = test_object(theirs, scene, mesh);
    assert_int_equal(test_stat(mine, "triangles_now"), triangles + 1);
    /* The object outlives its mesh; a mesh lent to another user's scene keeps its
     * shape. */
    assert_int_equal(pccd_mesh_replace(theirs, mesh, test_floor_x, PCCD_FORMAT_F32, 3,
                                       test_triangle, 1, NULL),
                     PCCD_E_STATE);
    assert_ok(pccd_mesh_destroy(theirs, mesh));
    mesh = test_mesh(mine, test_triangle_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    member = (struct member){
        .client = mine, .scene = open, .mesh = mesh, .rest = test_triangle_x};
    member.object = test_object(mine, open, mesh);
    assert_int_equal(move(&member, -2, &answer), 0);
    assert_true(answer.total > 0);
    pccd_answer_release(mine, &answer);
    assert_ok(pccd_scene_remove(theirs, scene, object));
    assert_int_equal(test_stat_await(mine, "triangles_now", triangles), triangles);
    assert_int_equal(move(&member, 0, &answer), 0);
    assert_int_equal(answer.total, 0);
    pccd_close(theirs);
    pccd_close(mine);
}

/* Lists of neighbours are the mesh's, and so its owner's to pay for, in whoever's scene
 * they are made. If this failed, a guest could end the daemon: it stops where it finds
 * that a user who has left holds memory, or has freed more than there was. */
CASE(shared__a_guest_pays_for_what_is_his)
{
    const struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                                  .what = PCCD_OBJECT_RADIUS |
                                                          PCCD_OBJECT_REST_RINGS,
                                                  .radius = 0.001,
                                                  .rest_rings = 2};
    struct pccd_client *mine;
    struct pccd_client *theirs;
    uint32_t scene = 0;

    connect_two_users(&mine, &theirs);
    assert_int_equal(test_take_part(mine, "guests", PCCD_SHARE_CREATE, 0666, &scene), 0);
    assert_ok(pccd_scene_join(theirs, 0, "guests", &scene));
    uint32_t mesh = test_mesh(theirs, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle, 1);
    uint32_t object = test_object(theirs, scene, mesh);
    assert_ok(pccd_object_set(theirs, scene, object, &settings));
    pccd_close(theirs);
    pccd_close(mine);
    mine = test_client_at(test_shared.url);
    assert_int_equal(test_stat_await(mine, "sessions_now", 1), 1);
    assert_int_equal(test_stat_await(mine, "meshes_now", 0), 0);
    pccd_close(mine);
}

/* If it failed, a crash of the daemon would lose a shared scene, or what somebody held
 * for its next step. */
CASE(shared__a_killed_daemon_loses_nothing)
{
    struct member cloth;
    struct member obstacle;
    struct pccd_link_info link;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t held;

    if (test_is_direct()) {
        test_skip("with direct: there is no daemon to kill");
    }
    open_member(&cloth, "again", test_triangle_x);
    open_member(&obstacle, "again", test_floor_x);
    assert_int_equal(move(&cloth, 1, &answer), 0);
    assert_int_equal(answer.total, 0);
    held = hold(&obstacle, 2, 0);
    assert_true(WIFSIGNALED(test_daemon_end(&test_shared, SIGKILL, 10000)));
    assert_true(test_daemon_restart(&test_shared, NULL));
    assert_ok(pccd_ping(obstacle.client, NULL));
    assert_ok(pccd_link(obstacle.client, &link));
    assert_int_equal(link.reconnects, 1);
    /* The cloth stood at 2, and comes to 1; the obstacle from 0 to 2. */
    assert_int_equal(move(&cloth, 0, &answer), 0);
    assert_true(answer.total > 0);
    for (uint64_t i = 0; i < answer.count; i++) {
        assert_true(fabs(answer.contacts[i].toi - 2.0 / 3.0) < 1e-5);
    }
    pccd_answer_release(cloth.client, &answer);
    assert_ok(pccd_wait(obstacle.client, held, -1, &answer));
    assert_int_equal(answer.status, 0);
    pccd_close(cloth.client);
    pccd_close(obstacle.client);
}

CASES_WITH(test_shared_start, test_shared_stop);
