/* test_int_record_shared.c - recordings of sessions that share a scene with others. */
#include "cases.h"

#include <signal.h>
#include <unistd.h>

#include "fixture.h"
#include "forge.h"
#include "must.h"
#include "prng.h"
#include "recording.h"
#include "run_ctl.h"

#define BODY 6u /* vertices: two triangles, one across the other */

static struct prng prng;

/* One client, and what it has in the scene. */
struct member {
    struct pccd_client *client;
    uint32_t scene, mesh;
    uint32_t bodies[2]; /* 0: none */
    float height;
    uint64_t held; /* a step that waits; 0: none */
    uint64_t answered;
    uint64_t with_contacts; /* of these */
};

static uint64_t draw(uint64_t below)
{
    return prng_below(&prng, below);
}

static float near(void)
{
    return (float)draw(64) / 16 - 2;
}

static void shape(float x[BODY][3], float z)
{
    const float at[BODY][3] = {{-1, -1, 0}, {1, -1, 0},    {0, 1, 0},
                               {0, 0, -1},  {0.25f, 0, 1}, {0, 0.25f, 1}};

    for (uint32_t v = 0; v < BODY; v++) {
        x[v][0] = at[v][0] + 0.0625f * z;
        x[v][1] = at[v][1];
        x[v][2] = at[v][2] + z;
    }
}

static const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};

static void enter(struct member *member, const char *name)
{
    const struct pccd_scene_settings settings = {.name = name, .share = PCCD_SHARE_OPEN};
    float x[BODY][3];

    shape(x, member->height);
    assert_ok(pccd_scene_create(member->client, &settings, &member->scene));
    member->mesh = test_mesh(member->client, x, PCCD_FORMAT_F32, BODY, triangles, 2);
    member->bodies[0] = test_object(member->client, member->scene, member->mesh);
    assert_ok(pccd_object_name(member->client, member->scene, member->bodies[0],
                               member->height > 0 ? "upper" : "lower"));
}

static void connect_member(struct member *member, float height)
{
    *member =
        (struct member){.client = test_client_at(test_shared.url), .height = height};
}

/* ---- steps ------------------------------------------------------------------------- */

/* A way for one body, of one of the kinds of segments. */
static void write_way(struct pccd_frame *frame, uint32_t body)
{
    const double from[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, (double)near()};
    const double to[12] = {0.8, -0.6, 0, 0.125, 0.6, 0.8, 0, 0, 0, 0, 1, (double)near()};
    void *x0 = NULL, *x1 = NULL;
    double wide[2][BODY][3];
    float x[BODY][3];

    shape(x, near());
    switch (draw(4)) {
    case 0:
        assert_ok(pccd_frame_rigid(frame, body, 0, BODY, from, to));
        break;
    case 1:
        assert_ok(pccd_frame_x1(frame, body, PCCD_FORMAT_F32, 2, 3, &x1));
        memcpy(x1, x + 2, 3 * sizeof x[0]);
        break;
    case 2:
        for (uint32_t i = 0; i < 3 * BODY; i++) {
            wide[0][i / 3][i % 3] = (double)x[i / 3][i % 3] / 3;
            wide[1][i / 3][i % 3] = (double)near() / 7;
        }
        assert_ok(pccd_frame_x0x1(frame, body, PCCD_FORMAT_F64, 0, BODY, &x0, &x1));
        memcpy(x0, wide[0], sizeof wide[0]);
        memcpy(x1, wide[1], sizeof wide[1]);
        break;
    default:
        assert_ok(pccd_frame_x1(frame, body, PCCD_FORMAT_F32, 0, BODY, &x1));
        memcpy(x1, x, sizeof x);
        break;
    }
}

static uint64_t submit(struct member *member, bool hold)
{
    const struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings),
        .mode = hold ? PCCD_MODE_ALL : (enum pccd_mode)draw(PCCD_MODE_COUNT),
        .tolerance = hold || draw(2) == 0 ? 0 : 1e-9,
        .hold = hold};
    struct pccd_frame frame;
    uint64_t step = 0;

    assert_ok(pccd_frame_begin(member->client, member->scene, 2, 1024, &frame));
    for (uint32_t i = 0; i < 2; i++) {
        if (member->bodies[i] != 0 && (i == 0 || draw(2) == 0)) {
            write_way(&frame, member->bodies[i]);
        }
    }
    assert_ok(pccd_frame_commit(&frame, &settings, &step));
    return step;
}

static void collect(struct member *member, uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_ok(pccd_wait(member->client, step, -1, &answer));
    if (answer.count == 0 && answer.total > 0 && draw(2) == 0) { /* it was held */
        assert_ok(
            pccd_scene_read(member->client, member->scene, answer.number, 0, &answer));
    }
    member->with_contacts += answer.counts[PCCD_VF] + answer.counts[PCCD_EE] > 0;
    pccd_answer_release(member->client, &answer);
    member->answered++;
}

/* It holds a frame, which has been taken in when this returns. */
static void hold(struct member *member)
{
    if (member->held == 0) {
        member->held = submit(member, true);
        assert_ok(pccd_wait_held(member->client, member->held, -1));
    }
}

/* One step, by a batch. */
static void step_batch(struct member *member)
{
    const struct pccd_batch_part part = {
        .scene = member->scene, .object = member->bodies[0], .count = BODY};
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch *batch = NULL;
    float x[BODY][3];
    const void *x1 = x;

    shape(x, near());
    assert_ok(pccd_batch_create(member->client, &part, 1, &batch));
    assert_ok(pccd_batch_step(batch, NULL, &x1, NULL, &answer));
    assert_int_equal(answer.scenes[0].status, 0);
    member->with_contacts += answer.scenes[0].total > 0;
    member->answered++;
    pccd_batch_release(member->client, &answer);
    pccd_batch_destroy(batch);
}

/* One step, and the frames that wait for it. Who holds one moves nothing else. */
static void step(struct member *member, struct member *other)
{
    uint64_t number = 0;

    if (member->held == 0 && draw(3) == 0) {
        step_batch(member);
    } else if (member->held == 0) {
        number = submit(member, false);
    } else {
        assert_ok(pccd_submit_still(member->client, member->scene, NULL, &number));
    }
    if (number != 0) {
        collect(member, number);
    }
    if (other->held != 0) {
        collect(other, other->held);
        other->held = 0;
    }
    if (member->held != 0) {
        collect(member, member->held);
        member->held = 0;
    }
}

/* ---- everything else --------------------------------------------------------------- */

static void set(struct member *member)
{
    const struct pccd_object_settings settings = {.what = 1 + (uint32_t)draw(7),
                                                  .self_collision = draw(2) == 0,
                                                  .group = 1 + draw(3),
                                                  .mask = 1 + draw(3)};

    assert_ok(
        pccd_object_set(member->client, member->scene, member->bodies[0], &settings));
}

static void change(struct member *member, const struct member *other)
{
    float x[BODY][3];

    switch (draw(6)) {
    case 0:
        if (member->held != 0) {
            break; /* or what it holds could not go along */
        }
        shape(x, near());
        assert_ok(pccd_mesh_replace(member->client, member->mesh, x, PCCD_FORMAT_F32,
                                    BODY, triangles, 2, NULL));
        break;
    case 1:
        if (member->bodies[1] == 0 && member->held == 0) {
            member->bodies[1] = test_object(member->client, member->scene, member->mesh);
        } else if (member->held == 0) {
            assert_ok(
                pccd_scene_remove(member->client, member->scene, member->bodies[1]));
            member->bodies[1] = 0;
        }
        break;
    case 2:
        set(member);
        break;
    default:
        assert_ok(pccd_pair_ignore(member->client, member->scene, member->bodies[0],
                                   other->bodies[0], draw(3) == 0));
        break;
    }
}

static void play(struct member *a, struct member *b, int rounds)
{
    for (int i = 0; i < rounds; i++) {
        struct member *who = draw(2) == 0 ? a : b;
        struct member *other = who == a ? b : a;

        switch (draw(4)) {
        case 0:
            hold(who);
            break;
        case 1:
            change(who, other);
            break;
        default:
            step(who, other);
            break;
        }
    }
    step(a, b); /* nothing waits any more */
}

/* ---- judging ----------------------------------------------------------------------- */

static void assert_repeats(uint64_t least)
{
    static const char *const options[] = {
        "--json", "--json --url direct:", "--json --method paper"};
    char said[4096];

    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        test_recording_repeats(options[i], test_recording, least);
    }
    int status =
        test_ctl("verify", "--repeat --sample 20", test_recording, said, sizeof said);

    if (status != 0) {
        print_message("%s\n", said);
    }
    assert_int_equal(status, 0);
}

/* If this failed, what others move, or what their objects are, would be missing in a
 * recording, or stand in another order than the daemon did it. */
CASE(record__holds_what_others_do)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_record_info info;

    for (int round = 0; round < 6; round++) {
        struct member a, b;

        prng.state = prng_seed() + (uint64_t)round;
        test_recording_clear();
        connect_member(&a, 0);
        connect_member(&b, 1);
        assert_ok(pccd_record_start(a.client, test_recording, &settings));
        if (round % 2 == 0) {
            enter(&a, "both");
            enter(&b, "both");
        } else {
            enter(&b, "both");
            enter(&a, "both");
        }
        play(&a, &b, 100);
        assert_ok(pccd_record(a.client, &info));
        assert_int_equal(info.status, 0);
        if (round % 3 == 0) { /* who leaves has been recorded until then */
            assert_ok(pccd_scene_destroy(a.client, a.scene));
        } else if (round % 3 == 1) {
            pccd_close(b.client);
            b.client = NULL;
        }
        assert_ok(pccd_record_stop(a.client, &info));
        assert_int_equal(info.status, 0);
        pccd_close(a.client);
        pccd_close(b.client);
        assert_in_range(a.with_contacts, a.answered / 4, a.answered);
        assert_repeats(a.answered - a.answered / 4);
        assert_string_equal(forge_name(test_recording, a.bodies[0]), "lower");
        assert_string_equal(forge_name(test_recording, b.bodies[0]), "upper");
    }
}

/* If this failed, a game could not begin to record while others are there. */
CASE(record__begins_with_what_others_have_done)
{
    struct pccd_record_info info;

    if (test_is_direct()) {
        test_skip("with direct: nothing is kept of what was before");
    }
    for (int round = 0; round < 3; round++) {
        struct member a, b;
        uint64_t before;

        prng.state = prng_seed() + 100 + (uint64_t)round;
        test_recording_clear();
        connect_member(&a, 0);
        connect_member(&b, 1);
        enter(&b, "begun");
        enter(&a, "begun");
        play(&a, &b, 50);
        if (round > 0) {
            hold(round == 1 ? &a : &b);
        }
        before = a.answered;
        assert_ok(pccd_record_start(a.client, test_recording, NULL));
        play(&a, &b, 60);
        assert_ok(pccd_record_stop(a.client, &info));
        play(&a, &b, 5); /* the daemon keeps nothing more */
        pccd_close(a.client);
        pccd_close(b.client);
        assert_repeats((a.answered - before) / 2);
        assert_string_equal(forge_name(test_recording, b.bodies[0]), "upper");
    }
}

/* Ask what is near where the last step began. */
static void ask_start(struct member *member)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    settings.what = PCCD_NEAR_PAIRS;
    settings.distance = 1.5;
    settings.at_begin = true;
    assert_ok(pccd_ask_near(member->client, member->scene, NULL, 0, &settings, &answer));
    assert_true(answer.total > 0);
    pccd_answer_release(member->client, &answer);
    member->answered++;
}

/* Both move, in a step of that member, or only that one. */
static void move_both(struct member *member, struct member *other)
{
    hold(other);
    collect(member, submit(member, false));
    collect(other, other->held);
    other->held = 0;
}

/* If this failed, what is near where the last step began would be looked for, in a
 * recording, where it ended: a step from before it began, or a still one of another. */
CASE(record__knows_where_the_last_step_began)
{
    struct pccd_record_info info;
    struct member a, b;

    if (test_is_direct()) {
        test_skip("with direct: nothing is kept of what was before");
    }
    for (int still = 0; still < 2; still++) {
        uint64_t number = 0;

        prng.state = prng_seed() + 200;
        test_recording_clear();
        connect_member(&a, 0);
        connect_member(&b, 1);
        enter(&a, "start");
        enter(&b, "start");
        move_both(&a, &b);
        a.answered = 0;
        assert_ok(pccd_record_start(a.client, test_recording, NULL));
        if (still != 0) {
            move_both(&a, &b);
            assert_ok(pccd_submit_still(b.client, b.scene, NULL, &number));
            collect(&b, number);
        }
        ask_start(&a);
        assert_ok(pccd_record_stop(a.client, &info));
        pccd_close(a.client);
        pccd_close(b.client);
        assert_repeats(a.answered);
    }
}

/* If this failed, a recording that cannot be right would look as if it were. */
CASE(record__ends_where_it_would_not_be_whole)
{
    const struct pccd_record_settings ring = {.max_bytes = 1 << 20, .segments = 2};
    struct pccd_record_info info;
    struct member a;

    test_recording_clear();
    connect_member(&a, 0);
    assert_ok(pccd_record_start(a.client, test_recording, &ring));
    enter(&a, "ring");
    assert_int_equal(pccd_record_stop(a.client, &info), PCCD_E_STATE);
    assert_non_null(strstr(pccd_error_text(a.client), "ring of segments"));
    pccd_close(a.client);
}

/* If this failed, a daemon that takes the place of a lost one would be trusted to know
 * what others did before; or who looks at the recording be told that it wants room. */
CASE(record__ends_when_the_daemon_is_lost)
{
    static const char *const options[] = {"--supervise", NULL};
    struct test_daemon daemon;
    struct pccd_record_info info;
    struct member a, b;
    char said[4096];

    if (test_is_direct()) {
        test_skip("with direct: there is no daemon to lose");
    }
    test_recording_clear();
    prng.state = prng_seed();
    assert_true(test_daemon_start(&daemon, options));
    a = (struct member){.client = test_connect(daemon.url)};
    b = (struct member){.client = test_connect(daemon.url), .height = 1};
    assert_ok(pccd_record_start(a.client, test_recording, NULL));
    enter(&a, "lost");
    enter(&b, "lost");
    play(&a, &b, 20);
    (void)pccd_record(a.client, &info);
    (void)pccd_poll(a.client, &(struct pccd_answer){0}); /* what is due is asked for */
    assert_ok(pccd_ping(a.client, &(uint64_t){0}));      /* and comes before this */
    assert_int_equal(kill((pid_t)pccd_daemon_pid(a.client), SIGKILL), 0);
    collect(&a, submit(&a, false));
    assert_int_equal(pccd_record_stop(a.client, &info), PCCD_E_DISCONNECTED);
    assert_non_null(strstr(pccd_error_text(a.client), "its daemon was lost"));
    pccd_close(a.client);
    pccd_close(b.client);
    assert_repeats(3);
    assert_int_equal(test_ctl("replay", "", test_recording, said, sizeof said), 0);
    assert_non_null(strstr(said, "ends where what came next could not be repeated"));
    assert_null(strstr(said, "full"));
    (void)test_daemon_end(&daemon, SIGTERM, 10000);
    (void)test_daemon_finish(&daemon);
}

CASES_WITH(test_recording_start, test_recording_stop);
