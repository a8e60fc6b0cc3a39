/* test_int_record_filter.c - what objects may meet, in recordings. */
#include "cases.h"

#include "fixture.h"
#include "forge.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

#define BODIES 3u

/* Bodies that go through each other, and each through itself, in every step. */
struct play {
    struct pccd_client *client;
    uint32_t scene, mesh;
    uint32_t bodies[BODIES];
    float z;
    uint64_t steps;
    uint64_t total; /* of the last answer */
};

/* Two triangles, one across the other, which change sides at half of the step. */
static void positions(float x[6][3], uint32_t body, float z)
{
    const float at[6][3] = {{-1, -1, 0}, {1, -1, 0},        {0, 1, 0},
                            {0, 0, z},   {0.25f, 0, 2 * z}, {0, 0.25f, 2 * z}};

    memcpy(x, at, sizeof at);
    for (uint32_t v = 0; v < 6; v++) {
        x[v][0] += 0.05f * (float)body;
        x[v][2] += (v < 3 ? 0.1f : 0.2f) * z * (float)body;
    }
}

/* Its scene, in a client that is connected. */
static void make_play(struct play *play)
{
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 5}};
    float x[6][3];

    positions(x, 0, 1);
    play->scene = test_scene(play->client);
    play->mesh = test_mesh(play->client, x, PCCD_FORMAT_F32, 6, triangles, 2);
    for (uint32_t i = 0; i < BODIES; i++) {
        play->bodies[i] = test_object(play->client, play->scene, play->mesh);
    }
}

static void open_play(struct play *play)
{
    *play = (struct play){.client = test_client_at(test_shared.url), .z = 1};
    make_play(play);
}

/* The same, recorded from the beginning. */
static void begin_play(struct play *play, const struct pccd_record_settings *settings)
{
    *play = (struct play){.client = test_client_at(test_shared.url), .z = 1};
    assert_ok(pccd_record_start(play->client, test_recording, settings));
    make_play(play);
}

static void step(struct play *play)
{
    struct pccd_frame frame;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t number;

    play->z = -play->z;
    assert_ok(pccd_frame_begin(play->client, play->scene, BODIES,
                               BODIES * sizeof(float[6][3]), &frame));
    for (uint32_t i = 0; i < BODIES; i++) {
        void *x1;

        assert_ok(pccd_frame_x1(&frame, play->bodies[i], PCCD_FORMAT_F32, 0, 6, &x1));
        positions(x1, i, play->z);
    }
    assert_ok(pccd_frame_commit(&frame, NULL, &number));
    assert_ok(pccd_wait(play->client, number, -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    play->total = answer.total;
    play->steps++;
    pccd_answer_release(play->client, &answer);
}

static void set(struct play *play, uint32_t body, uint32_t what, uint64_t group,
                uint64_t mask, bool self)
{
    const struct pccd_object_settings settings = {
        .what = what, .self_collision = self, .group = group, .mask = mask};

    assert_ok(pccd_object_set(play->client, play->scene, play->bodies[body], &settings));
}

static void ignore(struct play *play, uint32_t a, uint32_t b, bool ignored)
{
    assert_ok(pccd_pair_ignore(play->client, play->scene, play->bodies[a],
                               play->bodies[b], ignored));
}

static void call(struct play *play, uint32_t body, const char *name)
{
    assert_ok(pccd_object_name(play->client, play->scene, play->bodies[body], name));
}

/* If this failed, who looks at a recording would be told of other objects, or of none. */
static void assert_names(const struct play *play, const char *file)
{
    static const char *const names[BODIES] = {"sleeve \"left\"", "", "collar"};

    for (uint32_t i = 0; i < BODIES; i++) {
        assert_string_equal(forge_name(file, play->bodies[i]), names[i]);
    }
}

/* All that there is to be set, with a step after each: so that the masks of one would be
 * wrong for the next. */
static void change(struct play *play)
{
    uint64_t all;

    step(play);
    step(play);
    all = play->total;
    assert_true(all > 0);
    set(play, 0, PCCD_OBJECT_SELF, 0, 0, false);
    call(play, 0, "sleeve \"left\"");
    call(play, 1, "pocket");
    step(play);
    assert_in_range(play->total, 1, all - 1);
    set(play, 1, PCCD_OBJECT_GROUP | PCCD_OBJECT_MASK, 2, 4, true);
    set(play, 2, PCCD_OBJECT_GROUP, 4, 0, true);
    step(play);
    ignore(play, 2, 0, true);
    ignore(play, 1, 2, true);
    step(play);
    ignore(play, 2, 1, false);
    call(play, 1, NULL);
    set(play, 2, PCCD_OBJECT_ALL, UINT64_MAX, UINT64_MAX, false);
    step(play);
}

/* One object goes, and what it ignored with it. */
static void exchange(struct play *play)
{
    assert_ok(pccd_scene_remove(play->client, play->scene, play->bodies[2]));
    play->bodies[2] = test_object(play->client, play->scene, play->mesh);
    call(play, 2, "collar");
    step(play);
    step(play);
}

/* Repeated and found right, with a daemon and without. */
static void assert_repeats(const char *file, uint64_t steps)
{
    static const char *const options[] = {"--json", "--json --url direct:"};

    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(test_recording_repeats(options[i], file, steps), steps);
    }
    test_ctl_says(0, "verify", "--sample 100000", file, "PASS", NULL);
    test_ctl_says(0, "verify", "--repeat --method paper", file, "PASS", NULL);
}

/* If this failed, a session that sets a mask would be repeated without it, or contacts
 * that it forbids would be missed by who verifies it. */
CASE(record__holds_masks_and_pairs)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_record_info info;
    struct play play;

    test_recording_clear();
    begin_play(&play, &settings);
    change(&play);
    exchange(&play);
    assert_ok(pccd_record_stop(play.client, &info));
    assert_int_equal(info.status, 0);
    pccd_close(play.client);
    assert_repeats(test_recording, play.steps);
    assert_names(&play, test_recording);
}

/* If this failed, what held when a recording began would be missing in it; to begin it
 * in any other state must do, too. */
CASE(record__begins_with_masks_and_pairs)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct play play;
    uint64_t before;

    test_recording_clear();
    open_play(&play);
    change(&play);
    before = play.steps;
    if (test_is_direct()) { /* nothing was kept for another daemon */
        assert_int_equal(pccd_record_start(play.client, test_recording, &settings),
                         PCCD_E_STATE);
        pccd_close(play.client);
        return;
    }
    assert_ok(pccd_record_start(play.client, test_recording, &settings));
    step(&play);
    step(&play);
    exchange(&play);
    pccd_close(play.client);
    assert_repeats(test_recording, play.steps - before);
    assert_names(&play, test_recording);
}

/* If this failed, the newest part of a long session would not stand by itself. */
CASE(record__segments_have_masks_and_pairs)
{
    const struct pccd_record_settings settings = {.max_bytes = 16384, .segments = 2};
    char older[128], said[4096];
    struct pccd_record_info info;
    struct play play;

    test_recording_clear();
    (void)snprintf(older, sizeof older, "%s.1", test_recording);
    begin_play(&play, &settings);
    change(&play);
    call(&play, 2, "collar");
    do {
        step(&play);
        ignore(&play, 0, 1, play.steps % 2 == 0);
        assert_ok(pccd_record(play.client, &info));
    } while (info.segments < 4 && play.steps < 1000);
    step(&play);
    pccd_close(play.client);
    assert_int_equal(info.segments, 4);
    assert_int_equal(test_ctl("replay", "--json", test_recording, said, sizeof said), 0);
    assert_int_equal(test_ctl("replay", "--json", older, said, sizeof said), 0);
    assert_in_range(test_ctl_number(said, "same"), 5, 1000);
    assert_int_equal(test_ctl("verify", "--repeat", older, said, sizeof said), 0);
    assert_names(&play, older);
}

/* If this failed, a recording would have a name that no reader takes, or a mistake would
 * be let by. */
CASE(name__is_refused_where_it_cannot_be_kept)
{
    struct play play;
    char text[257];

    memset(text, 'x', sizeof text);
    text[256] = '\0';
    open_play(&play);
    assert_int_equal(pccd_object_name(play.client, play.scene, play.bodies[0], text),
                     PCCD_E_INVAL);
    text[255] = '\0';
    assert_ok(pccd_object_name(play.client, play.scene, play.bodies[0], text));
    assert_int_equal(pccd_object_name(play.client, play.scene, 12345, "a"),
                     PCCD_E_HANDLE);
    pccd_close(play.client);
}

CASES_WITH(test_recording_start, test_recording_stop);
