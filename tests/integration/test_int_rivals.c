/* test_int_rivals.c - clients that share a scene and do each other no good. */
#include "cases.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/wait.h>

#include "fixture.h"
#include "grid.h"
#include "raw.h"

#define SLOT_BYTES    65536u
#define SPOILT        5000
#define OBJECTS       1024u
#define PAIRS_OF_EACH 64u
#define IN_FLIGHT     24u
#define ROUNDS        20
#define SIDE          250u /* a step of 20 ms and more */
#define DEADLINE_NS   1000000u
#define RESULT_BYTES  (32u << 20)

/* One who takes part, by hand: with the floor or the triangle. */
struct rival {
    struct test_raw raw;
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
};

static struct rival first;
static struct rival second;
static struct test_grid grid;
static struct pccd_client *client;

static int call(struct rival *rival, int method, const void *request, void *result)
{
    return test_raw_call(&rival->raw, method, request, result);
}

static uint32_t request(struct rival *rival, int method, const void *request)
{
    uint32_t id = test_raw_request(&rival->raw, method, request);

    assert_int_not_equal(id, 0);
    return id;
}

static void enter(struct rival *rival, const char *name, const float x[3][3])
{
    assert_ok(test_raw_session(&rival->raw, test_shared.socket, 2, SLOT_BYTES));
    assert_ok(test_raw_scene(&rival->raw, name, &rival->scene));
    assert_ok(test_raw_mesh(&rival->raw, x, 3, test_triangle, 1, &rival->mesh));
    assert_ok(test_raw_add(&rival->raw, rival->scene, rival->mesh, &rival->object));
}

static void enter_both(const char *name)
{
    enter(&first, name, test_triangle_x);
    enter(&second, name, test_floor_x);
}

static void leave_both(void)
{
    test_raw_close(&first.raw);
    test_raw_close(&second.raw);
}

/* The request for a step of the object to where `x` is, out of a slot. */
static struct proto_FRAME_SUBMIT_request write_step(struct rival *rival, uint32_t slot,
                                                    const float x[3][3])
{
    return test_raw_move(&rival->raw, slot, rival->scene, rival->object, x, 3);
}

static int step_still(struct rival *rival, struct proto_FRAME_SUBMIT_result *answer)
{
    return RAW_CALL(&rival->raw, FRAME_SUBMIT, answer, .scene = rival->scene);
}

/* Hold the object's way to where it is already. Returns the request's number, once it
 * waits. */
static uint32_t hold(struct rival *rival, uint32_t slot, const float x[3][3])
{
    struct proto_FRAME_SUBMIT_request submit = write_step(rival, slot, x);
    uint32_t id;

    submit.hold = true;
    id = request(rival, PROTO_METHOD_FRAME_SUBMIT, &submit);
    /* Computed behind it. */
    assert_ok(RAW_CALL(&rival->raw, MESH_EDGES, NULL, .mesh = rival->mesh, .count = 3));
    return id;
}

static void leave_scene(struct rival *rival)
{
    assert_ok(RAW_CALL(&rival->raw, SCENE_DESTROY, NULL, .scene = rival->scene));
}

/* ---- leaving ----------------------------------------------------------------------- */

/* Leave and come back without waiting for an answer, and say to the scene what is asked
 * of it in the same breath. Returns the number of the last request. */
static uint32_t return_at_once(struct rival *rival, const char *name, uint32_t next_scene,
                               int method, const void *asked)
{
    struct proto_SCENE_CREATE_request create = {.want = next_scene,
                                                .share = PCCD_SHARE_ATTACH};

    strcpy(create.name, name);
    assert_true(RAW_SEND(&rival->raw, SCENE_DESTROY, .scene = rival->scene) != 0);
    (void)request(rival, PROTO_METHOD_SCENE_CREATE, &create);
    rival->scene = next_scene;
    return request(rival, method, asked);
}

static int start(void **state)
{
    static const char *const options[] = {"--grace", "20", NULL};

    return test_shared_start_with(options) == 0 &&
                   (client = test_connect(test_shared.url)) != NULL
               ? 0
               : ((void)state, -1);
}

static int teardown(void **state)
{
    pccd_close(client);
    return test_shared_stop(state);
}

static int start_with_grid(void **state)
{
    return test_shared_connect(state, RESULT_BYTES, &client) == 0
               ? test_grid_make(client, SIDE, &grid)
               : -1;
}

static int teardown_grid(void **state)
{
    test_grid_free(&grid);
    return teardown(state);
}

/* If it failed, a client that leaves a scene and comes back would lose what it has added
 * since; or, where that cannot be added, end the daemon for all. */
CASE_WITH(rivals__one_who_comes_back_has_what_it_adds, start, teardown)
{
    struct proto_SCENE_ADD_result added;
    struct proto_MESH_CREATE_result empty;
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;

    enter_both("returns");
    assert_ok(RAW_CALL(&second.raw, MESH_CREATE, &empty, .vertex_count = 3,
                       .triangle_count = 1));
    for (uint32_t round = 1; round <= ROUNDS; round++) {
        uint32_t scene = ((second.scene >> 20) + 1) << 20;
        struct proto_SCENE_ADD_request add = {.scene = scene, .mesh = second.mesh};
        uint32_t id;

        if (round % 2 == 0) {
            add.mesh = empty.mesh;
        }
        id = return_at_once(&second, "returns", scene, PROTO_METHOD_SCENE_ADD, &add);
        if (round % 2 == 0) {
            assert_int_equal(
                test_raw_answer(&second.raw, id, PROTO_METHOD_SCENE_ADD, &added),
                PCCD_E_STATE);
            add.mesh = second.mesh;
            id = request(&second, PROTO_METHOD_SCENE_ADD, &add);
        }
        assert_ok(test_raw_answer(&second.raw, id, PROTO_METHOD_SCENE_ADD, &added));
        second.object = added.object;
        submit = write_step(&second, 0, test_floor_x);
        assert_ok(call(&second, PROTO_METHOD_FRAME_SUBMIT, &submit, &answer));
    }
    assert_int_equal(test_stat(client, "objects_now"), 2);
    leave_both();
    assert_int_equal(test_stat_await(client, "objects_now", 0), 0);
    assert_int_equal(test_stat_await(client, "scenes_now", 0), 0);
}

/* If it failed, a client could hold two frames for one step, and with them make every
 * step of the others fail. */
CASE_WITH(rivals__one_who_comes_back_holds_one_frame, start, teardown)
{
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;

    enter_both("two frames");
    for (uint32_t round = 1; round <= ROUNDS; round++) {
        uint32_t scene = ((second.scene >> 20) + 1) << 20;
        struct proto_SCENE_ADD_request add = {
            .scene = scene, .mesh = second.mesh, .want = 1u << 20 | (16 + round)};

        (void)hold(&second, 0, test_floor_x);
        (void)return_at_once(&second, "two frames", scene, PROTO_METHOD_SCENE_ADD, &add);
        second.object = add.want;
        submit = write_step(&second, 1, test_floor_x);
        submit.hold = true;
        (void)request(&second, PROTO_METHOD_FRAME_SUBMIT, &submit); /* a turn's fourth */
        submit = write_step(&second, 0, test_floor_x);
        submit.hold = true;
        test_sleep_ms(2);
        assert_int_equal(call(&second, PROTO_METHOD_FRAME_SUBMIT, &submit, NULL),
                         PCCD_E_BUSY);
        assert_ok(step_still(&first, &answer));
        assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    }
    leave_both();
    assert_int_equal(test_stat_await(client, "objects_now", 0), 0);
}

/* Let each object of a scene ignore the `each` after it. */
static void ignore_many(struct rival *rival, const uint32_t *objects, uint32_t count,
                        uint32_t each)
{
    uint32_t all = count * each;

    for (uint32_t sent = 0, taken = 0; taken < all; taken++) {
        for (; sent < all && sent - taken < IN_FLIGHT; sent++) {
            uint32_t b = objects[(sent / each + 1 + sent % each) % count];

            assert_true(RAW_SEND(&rival->raw, SCENE_IGNORE, .scene = rival->scene,
                                 .a = objects[sent / each], .b = b,
                                 .ignored = true) != 0);
        }
        assert_ok(test_raw_receive(&rival->raw));
        assert_false(rival->raw.envelope.failed);
    }
}

/* If it failed, a client that leaves with many objects would keep all others waiting
 * until the last of them is out, or let them meet those that are not yet. */
CASE_WITH(rivals__one_who_leaves_with_much_delays_nobody, start, teardown)
{
    static uint32_t objects[OBJECTS];
    struct proto_FRAME_SUBMIT_result answer;
    uint64_t begin_us;
    uint64_t step_us;
    uint64_t leave_us;
    uint64_t ignore_us;

    enter_both("much");
    for (uint32_t i = 0; i < OBJECTS; i++) {
        assert_ok(test_raw_add(&second.raw, second.scene, second.mesh, &objects[i]));
    }
    begin_us = test_now_us();
    ignore_many(&second, objects, OBJECTS, PAIRS_OF_EACH);
    ignore_us = test_now_us() - begin_us;
    begin_us = test_now_us();
    leave_scene(&second);
    assert_ok(step_still(&first, &answer));
    step_us = test_now_us() - begin_us;
    assert_int_equal(answer.total, 0); /* the floors that are left lie on each other */
    assert_int_equal(test_stat_await(client, "objects_now", 1), 1);
    leave_us = test_now_us() - begin_us;
    printf("# a step beside: %llu us; all have left: %llu us, had come to ignore each "
           "other: %llu us\n",
           (unsigned long long)step_us, (unsigned long long)leave_us,
           (unsigned long long)ignore_us);
    assert_true(4 * step_us < ignore_us); /* to search for the pairs of each: as long */
    leave_both();
}

/* Until the answer to `last_id` has come. Whether that to `first_id` came before it. */
static bool receive_both(struct rival *rival, uint32_t first_id, uint32_t last_id)
{
    bool is_early = false;

    do {
        assert_ok(test_raw_receive(&rival->raw));
        assert_false(rival->raw.envelope.failed);
        is_early = is_early || rival->raw.envelope.id == first_id;
    } while (rival->raw.envelope.id != last_id);
    return is_early;
}

/* If it failed, a client that is gone before it was looked at would take the daemon
 * along. */
CASE_WITH(rivals__one_who_is_looked_at_may_leave, start_with_grid, teardown_grid)
{
    uint32_t late_count = 0;

    for (int i = 0; i < ROUNDS; i++) {
        struct proto_LIST_SESSION_result listed;
        struct proto_LIST_PAIR_result pair;
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t step = 0;
        uint32_t id;
        bool is_early;

        assert_ok(test_raw_session(&second.raw, test_shared.socket, 0, 0));
        assert_ok(test_raw_session(&first.raw, test_shared.socket, 0, 0));
        assert_ok(test_raw_scene(&first.raw, "", &first.scene));
        assert_ok(RAW_CALL(&second.raw, LIST_SESSION, &listed, .before = 0));
        assert_ok(test_grid_submit(&grid, NULL, &step));
        id = RAW_SEND(&second.raw, LIST_PAIR, .session = listed.session,
                      .scene = first.scene); /* behind it, mostly */
        is_early =
            receive_both(&second, id, RAW_SEND(&second.raw, LIST_SESSION, .before = 0));
        test_raw_close(&first.raw);
        if (!is_early) {
            assert_ok(test_raw_answer(&second.raw, id, PROTO_METHOD_LIST_PAIR, &pair));
            assert_int_equal(pair.a, 0);
            late_count++;
        }
        assert_ok(pccd_wait(grid.client, step, -1, &answer));
        pccd_answer_release(grid.client, &answer);
        test_raw_close(&second.raw);
        assert_int_equal(test_stat_await(client, "sessions_now", 1), 1);
        assert_int_equal(test_stat_await(client, "scenes_now", 1), 1);
    }
    assert_true(late_count > 0);
}

/* ---- coming back ------------------------------------------------------------------- */

/* If it failed, a client that adds an object after the daemon was lost, before another
 * one is back, would take the number of that one's, which could not come back then. */
CASE_WITH(rivals__one_who_is_not_back_keeps_its_numbers, start, teardown)
{
    struct proto_SCENE_CREATE_request create = {.share = PCCD_SHARE_OPEN,
                                                .name = "numbers"};
    struct proto_SCENE_ADD_request add = {0};
    struct proto_SCENE_ADD_result added;

    enter_both("elsewhere");
    for (uint32_t i = 0; i < 3; i++) { /* of a daemon that is lost */
        leave_scene(&first);
        leave_scene(&second);
        first.scene = second.scene = create.want = add.scene = (i + 5) << 20;
        assert_ok(call(&second, PROTO_METHOD_SCENE_CREATE, &create, NULL));
        add.mesh = second.mesh;
        add.want = 0;
        assert_ok(call(&second, PROTO_METHOD_SCENE_ADD, &add, &added));
        assert_ok(call(&second, PROTO_METHOD_SCENE_ADD, &add, &added));
        assert_ok(call(&first, PROTO_METHOD_SCENE_CREATE, &create, NULL));
        add.mesh = first.mesh;
        for (add.want = 1u << 20; add.want < (1u << 20) + 64; add.want++) {
            assert_ok(call(&first, PROTO_METHOD_SCENE_ADD, &add, &added));
            assert_int_equal(added.object, add.want);
        }
    }
    leave_both();
}

/* ---- what goes wrong --------------------------------------------------------------- */

/* If it failed, a client could make the steps of the others fail with errors of its own,
 * and would not hear of them itself. */
CASE_WITH(rivals__an_error_is_told_to_whose_it_is, start_with_grid, teardown_grid)
{
    struct proto_FRAME_SUBMIT_result answer;
    int status = PCCD_E_HANDLE;

    enter_both("owed");
    /* Once in a while the long step ends at once, and the error is told in its turn. */
    for (int i = 0; i < ROUNDS && status == PCCD_E_HANDLE; i++) {
        struct proto_FRAME_SUBMIT_request submit = write_step(&second, 0, test_floor_x);
        struct pccd_answer whole = PCCD_ANSWER_INIT;
        uint64_t step = 0;
        uint32_t id;

        submit.deadline_ns = DEADLINE_NS;
        assert_ok(test_grid_submit(&grid, NULL, &step));
        assert_true(RAW_SEND(&second.raw, SCENE_REMOVE, .scene = second.scene,
                             .object = second.object) != 0);
        id = request(&second, PROTO_METHOD_FRAME_SUBMIT, &submit);
        status = test_raw_answer(&second.raw, id, PROTO_METHOD_FRAME_SUBMIT, &answer);
        assert_ok(pccd_wait(grid.client, step, 60000, &whole));
        pccd_answer_release(grid.client, &whole);
        assert_ok(test_raw_add(&second.raw, second.scene, second.mesh, &second.object));
    }
    assert_int_equal(status, 0);
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_DEADLINE);
    assert_ok(step_still(&first, &answer));
    assert_int_equal(step_still(&second, &answer), PCCD_E_HANDLE);
    assert_ok(step_still(&second, &answer));
    leave_both();
}

static atomic_bool is_over;

/* Write nonsense where the daemon reads how far the results are released, and take it
 * back, without end. */
static void *spoil(void *context)
{
    struct proto_upload *upload = context;

    while (!atomic_load(&is_over)) {
        atomic_store(&upload->result_head.value, UINT64_MAX);
        atomic_store(&upload->result_head.value, 0);
    }
    return NULL;
}

/* Take the news that have come: of every step one. */
static void take_news(struct rival *rival, uint64_t *told)
{
    struct pollfd watched = {.fd = rival->raw.socket, .events = POLLIN};
    struct proto_SCENE_STEP_request note;

    while (poll(&watched, 1, 0) > 0) {
        assert_ok(test_raw_receive(&rival->raw));
        assert_int_equal(rival->raw.envelope.kind, PROTO_NOTIFICATION);
        assert_ok(proto_decode_body(&rival->raw.envelope,
                                    &proto_messages[PROTO_NOTE_SCENE_STEP].request, &note,
                                    &rival->raw.error));
        assert_int_equal(note.number, ++*told);
    }
}

/* If it failed, a client whose own results have no place could move what it moves without
 * that the others hear of it. */
CASE_WITH(rivals__every_step_that_has_run_is_told, start, teardown)
{
    struct proto_FRAME_SUBMIT_result answer;
    pthread_t spoiler;
    uint64_t told = 0;

    enter_both("told");
    atomic_store(&is_over, false);
    assert_ok(pthread_create(&spoiler, NULL, spoil, test_raw_upload(&first.raw)));
    for (int i = 0; i < SPOILT; i++) {
        int status = step_still(&first, &answer);

        assert_true(status == 0 || status == PCCD_E_INVAL);
        take_news(&second, &told); /* came before the answer */
    }
    atomic_store(&is_over, true);
    assert_int_equal(pthread_join(spoiler, NULL), 0);
    test_raw_release(&first.raw, 0);
    assert_ok(step_still(&first, &answer));
    take_news(&second, &told);
    assert_true(told > 1 && told == answer.number);
    leave_both();
}

/* If it failed, what contradicts itself would be done in one of the two ways. */
CASE_WITH(rivals__a_frame_that_is_held_is_not_placed, start, teardown)
{
    struct proto_FRAME_SUBMIT_request submit;
    struct proto_FRAME_SUBMIT_result answer;

    enter_both("both");
    submit = write_step(&second, 0, test_floor_x);
    submit.hold = submit.place = true;
    assert_int_equal(call(&second, PROTO_METHOD_FRAME_SUBMIT, &submit, &answer),
                     PCCD_E_INVAL);
    leave_both();
}

/* ---- the end ----------------------------------------------------------------------- */

/* If it failed, one frame that waits for a step that nobody will submit would keep the
 * daemon from ending for as long as it is patient. */
CASE_WITH(rivals__a_held_frame_does_not_delay_the_end, start, teardown)
{
    struct proto_FRAME_SUBMIT_result answer;
    uint64_t begin_ms;
    uint32_t id;
    int status;

    enter_both("end");
    id = hold(&second, 0, test_floor_x);
    begin_ms = test_now_ms();
    status = test_daemon_end(&test_shared, SIGTERM, 25000);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_true(test_now_ms() - begin_ms < 8000); /* its grace time: 20 s */
    assert_ok(test_raw_answer(&second.raw, id, PROTO_METHOD_FRAME_SUBMIT, &answer));
    assert_int_equal(answer.incomplete, PCCD_INCOMPLETE_CANCELLED);
    leave_both();
}
