/* test_int_crossed.c - what passes through what where a step begins, and beside
 * questions about what is near, through a real daemon and in this process. */
#include "cases.h"
#include "fixture.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

#define PAIRS 15u /* of two triangles: six of a vertex and a face, nine of edges */

static const float floor_at[3][3] = {{-30, -30, 0}, {30, -30, 0}, {0, 30, 0}};
static const float through[3][3] = {{0, 0, -2}, {1, 0, 6}, {0, 1, 6}};
static const float above[3][3] = {{0, 0, 1}, {1, 0, 6}, {0, 1, 6}};

/* A floor, and a spike that is moved. */
struct place {
    struct pccd_client *client;
    uint32_t scene, floor, spike;
};

static void add(struct place *place, const float x[3][3], uint32_t *object)
{
    static const uint32_t triangle[1][3] = {{0, 1, 2}};

    uint32_t mesh = test_mesh(place->client, x, PCCD_FORMAT_F32, 3, triangle, 1);
    *object = test_object(place->client, place->scene, mesh);
}

static void make(struct place *place)
{
    place->scene = test_scene(place->client);
    add(place, floor_at, &place->floor);
    add(place, through, &place->spike);
}

static void begin(struct place *place, const char *url)
{
    *place = (struct place){.client = test_client_at(url)};
    make(place);
}

static void move(const struct place *place, const float from[3][3], const float to[3][3],
                 const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    const struct pccd_motion motion = {.object = place->spike,
                                       .count = 3,
                                       .format = PCCD_FORMAT_F32,
                                       .x0 = from,
                                       .x1 = to};

    *answer = (struct pccd_answer)PCCD_ANSWER_INIT;
    assert_ok(pccd_step(place->client, place->scene, &motion, 1, settings, answer));
    assert_int_equal(answer->incomplete, PCCD_COMPLETE);
    pccd_answer_release(place->client, answer);
}

static const char *const urls[] = {NULL, "direct:"};

static const char *url_of(size_t i)
{
    return urls[i] != NULL ? urls[i] : test_shared.url;
}

/* If it failed, a step of surfaces that pass through each other from its beginning to its
 * end would be taken for free, or what a program of before gets would change. */
CASE(crossed__from_the_start_is_told_and_not_free)
{
    for (size_t i = 0; i < 2; i++) {
        struct place place;
        begin(&place, url_of(i));
        for (int mode = 0; mode < PCCD_MODE_COUNT; mode++) {
            struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
            struct pccd_answer plain, told, free;
            settings.mode = (enum pccd_mode)mode;
            move(&place, through, through, &settings, &plain);
            settings.tells_start = true;
            move(&place, through, through, &settings, &told);
            move(&place, above, above, &settings, &free);
            assert_int_equal(plain.crossings + plain.start_inside, 0);
            assert_int_equal(told.crossings, 2);
            assert_int_equal(told.start_inside, 0);
            assert_int_equal(told.total, plain.total);
            assert_true(told.safe_step == 0);
            assert_int_equal(free.crossings + free.start_inside, 0);
            if (mode == PCCD_MODE_ANY) {
                assert_int_equal(plain.verdict, PCCD_VERDICT_NO);
                assert_int_equal(told.verdict, PCCD_VERDICT_YES);
                assert_int_equal(free.verdict, PCCD_VERDICT_NO);
            } else {
                assert_memory_equal(told.hash, plain.hash, sizeof told.hash);
            }
            assert_true(mode == PCCD_MODE_PAIRS || plain.safe_step == 1);
            assert_true(mode == PCCD_MODE_PAIRS || free.safe_step == 1);
        }
        pccd_close(place.client);
    }
}

/* If it failed, what begins within its thickness and comes no nearer would be taken for
 * what never was there. */
CASE(crossed__inside_with_an_approach_is_told)
{
    for (size_t i = 0; i < 2; i++) {
        struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
        struct pccd_answer answer;
        struct place place;
        begin(&place, url_of(i));
        settings.separation = 100;
        settings.approach = 0.5;
        settings.tells_start = true;
        move(&place, above, above, &settings, &answer);
        assert_int_equal(answer.total, 0);
        assert_int_equal(answer.crossings, 0);
        assert_int_equal(answer.start_inside, PAIRS);
        assert_true(answer.safe_step == 1);
        settings.mode = PCCD_MODE_ANY;
        move(&place, above, above, &settings, &answer);
        assert_int_equal(answer.verdict, PCCD_VERDICT_YES);
        settings.approach = 0; /* then they are contacts */
        settings.mode = PCCD_MODE_ALL;
        move(&place, above, above, &settings, &answer);
        assert_int_equal(answer.initial, PAIRS);
        assert_int_equal(answer.start_inside, 0);
        pccd_close(place.client);
    }
}

static void ask(const struct place *place, enum pccd_near_what what, double distance,
                bool tells, struct pccd_answer *answer)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;

    settings.what = what;
    settings.distance = distance;
    settings.tells_crossings = tells;
    *answer = (struct pccd_answer)PCCD_ANSWER_INIT;
    assert_ok(pccd_ask_near(place->client, place->scene, NULL, 0, &settings, answer));
    assert_int_equal(answer->incomplete, PCCD_COMPLETE);
    pccd_answer_release(place->client, answer);
}

/* If it failed, a spike through a floor would be 2 away from it, and nothing would be
 * wrong with it beside pairs and bounds. */
CASE(crossed__beside_what_is_near_is_counted)
{
    for (size_t i = 0; i < 2; i++) {
        struct pccd_answer answer, plain;
        struct place place;
        begin(&place, url_of(i));
        ask(&place, PCCD_NEAR_NEAREST, 0, false, &answer);
        assert_int_equal(answer.counts[PCCD_EF], 1);
        assert_true(answer.distance_max == 0);
        for (int what = PCCD_NEAR_PAIRS; what <= PCCD_NEAR_VERTICES; what++) {
            for (int distance = 0; distance < 3; distance++) {
                ask(&place, (enum pccd_near_what)what, distance, false, &plain);
                ask(&place, (enum pccd_near_what)what, distance, true, &answer);
                assert_int_equal(plain.crossings, 0);
                assert_int_equal(answer.crossings, 2);
                assert_int_equal(answer.total, plain.total);
                assert_memory_equal(answer.hash, plain.hash, sizeof answer.hash);
                assert_true(answer.distance_min == plain.distance_min);
            }
        }
        pccd_close(place.client);
    }
}

/* If it failed, a batch would be asked for what its answers have no place for. */
CASE(crossed__is_not_told_of_a_batch)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch *batch = NULL;
    struct place place;

    begin(&place, test_shared.url);
    const struct pccd_batch_part part = {.scene = place.scene,
                                         .object = place.spike,
                                         .format = PCCD_FORMAT_F32,
                                         .count = 3};
    const void *const x1[1] = {through};
    settings.tells_start = true;
    assert_ok(pccd_batch_create(place.client, &part, 1, &batch));
    assert_int_equal(pccd_batch_step(batch, NULL, x1, &settings, &answer), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(place.client), "tells_start: a batch"));
    pccd_batch_destroy(batch);
    pccd_close(place.client);
}

/* If it failed, what crosses would not be asked for again when a recording is repeated,
 * or a wrong count would be found right. */
CASE(crossed__is_recorded_repeated_and_verified)
{
    const struct pccd_record_settings kept = {.contacts = 1};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct place place = {.client = test_client_at(test_shared.url)};
    struct pccd_answer answer;
    char said[4096];

    test_recording_clear();
    assert_ok(pccd_record_start(place.client, test_recording, &kept));
    make(&place);
    settings.tells_start = true;
    move(&place, through, through, &settings, &answer);
    settings.mode = PCCD_MODE_ANY;
    move(&place, through, through, &settings, &answer);
    move(&place, above, above, &settings, &answer);
    settings.separation = 100;
    settings.approach = 0.5;
    move(&place, above, above, &settings, &answer);
    settings = (struct pccd_step_settings)PCCD_STEP_SETTINGS_INIT;
    settings.mode = PCCD_MODE_ANY;
    move(&place, through, through, &settings, &answer); /* the option was of one step */
    ask(&place, PCCD_NEAR_NEAREST, 0, false, &answer);
    ask(&place, PCCD_NEAR_PAIRS, 2, true, &answer);
    ask(&place, PCCD_NEAR_VERTICES, 2, true, &answer);
    ask(&place, PCCD_NEAR_PAIRS, 2, false, &answer);
    pccd_close(place.client);
    assert_int_equal(test_ctl("replay", "--json", test_recording, said, sizeof said), 0);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    assert_ok(test_ctl("verify", "--repeat --json", test_recording, said, sizeof said));
}

CASES_WITH(test_recording_start, test_recording_stop);
