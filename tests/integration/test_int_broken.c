/* test_int_broken.c - recordings that cannot have been made, and what every command says
 * of them. */
#include "cases.h"

#include "fixture.h"
#include "forge.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

static const double shape[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const uint32_t face[1][3] = {{0, 1, 2}};
static const double turn[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, .5};

static void move(struct pccd_client *client, uint32_t scene,
                 const struct pccd_motion *motion)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    assert_ok(pccd_step(client, scene, motion, 1, NULL, &answer));
    pccd_answer_release(client, &answer);
}

/* Two objects that were moved, one by a pose; then a step of each form, and a
 * question. */
static int set_up(void **state)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_near_settings near = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_client *client = NULL;
    uint32_t object[2];

    assert_true(test_recording_begin());
    assert_ok(test_shared_connect(state, 0, &client));
    uint32_t scene = test_scene(client);
    uint32_t mesh = test_mesh(client, shape, PCCD_FORMAT_F64, 3, face, 1);
    object[0] = test_object(client, scene, mesh);
    object[1] = test_object(client, scene, mesh);
    const struct pccd_object_settings thick = {.struct_bytes = sizeof thick,
                                               .what = PCCD_OBJECT_RADIUS |
                                                       PCCD_OBJECT_REST_DISTANCE,
                                               .radius = .125,
                                               .rest_distance = .75};
    const struct pccd_motion freely = {
        .object = object[0], .count = 3, .format = PCCD_FORMAT_F64, .x1 = shape};
    struct pccd_motion both = freely;
    both.x0 = shape;
    const struct pccd_motion rigid = {
        .object = object[1], .count = 3, .m0 = turn, .m1 = turn};
    assert_ok(pccd_object_set(client, scene, object[0], &thick));
    move(client, scene, &freely);
    move(client, scene, &rigid);
    assert_ok(pccd_record_start(client, test_recording, &settings));
    move(client, scene, &freely);
    move(client, scene, &both);
    move(client, scene, &rigid);
    near.distance = 1;
    assert_ok(pccd_ask_near(client, scene, &freely, 1, &near, &answer));
    pccd_answer_release(client, &answer);
    move(client, scene, &freely);
    pccd_close(client);
    return 0;
}

/* ---- breaking ---------------------------------------------------------------------- */

/* The bytes at `at` of the n-th chunk of a kind, from 1. */
struct breaking {
    uint16_t kind;
    uint32_t number;
    size_t at;
    double value;     /* these bytes, or .. */
    bool is_word;     /* .. 0 as four of them */
    const char *says; /* behind "at byte N, KIND: " */
    uint32_t seen;
};

static bool break_one(void *context, struct forge_chunk *chunk)
{
    struct breaking *breaking = context;
    const uint32_t word = 0;
    breaking->seen += chunk->kind == breaking->kind;
    if (chunk->kind == breaking->kind && breaking->seen == breaking->number) {
        size_t bytes = breaking->is_word ? sizeof word : sizeof breaking->value;
        assert_true(breaking->at + bytes <= chunk->bytes);
        memcpy(chunk->payload + breaking->at,
               breaking->is_word ? (const void *)&word : &breaking->value, bytes);
    }
    return true;
}

#define PAYLOAD(head)    (sizeof(struct head))
#define SLOT(head)       (sizeof(struct head) + 64) /* positions, behind a table of one */
#define VERTEX(n)        ((n) * sizeof(double[3]))
#define STRAY(n, object) "vertex " #n object " is not finite or beyond 1e18"

/* The commands, but for the page where it was not built. */
static const char *const commands[] = {"replay",           "verify",
                                       "verify --repeat",  "render -o %s.svg",
                                       "export -o %s.glb", "inspect -o %s.html"};

/* Each says where it is, with 4. Those that ask a daemon show that it refuses the frame
 * that was taken then. */
static void assert_told(const struct breaking *breaking)
{
    struct breaking copy = *breaking;
    char command[192], place[64], said[4096];

    forge_recording(test_recording, test_forged, break_one, &copy);
    assert_true(copy.seen >= copy.number);
    (void)snprintf(place, sizeof place, ", %s: ", record_kind_name(breaking->kind));
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        (void)snprintf(command, sizeof command, commands[i], test_recording);
        int status = test_ctl(command, "", test_forged, said, sizeof said);
        bool asks = breaking->kind == RECORD_FRAME && (i == 0 || i == 2 || i == 5);
        int expected = !asks ? 4 : i == 5 ? 0 : 1;
        const char *says = !asks ? breaking->says : i == 5 ? "1 answer is" : "status";
        if (i == 5 && strstr(said, "built without") != NULL) {
            continue;
        }
        if (status != expected || strstr(said, says) == NULL) {
            print_message("%s, %s: %d, %s\n", commands[i], breaking->says, status, said);
        }
        assert_int_equal(status, expected);
        assert_non_null(strstr(said, says));
        assert_null(strstr(said, "nan"));
        if (!asks) {
            assert_non_null(strstr(said, "at byte "));
            assert_non_null(strstr(said, place));
        }
    }
}

/* If this failed, a coordinate that is none would end a command by a signal, or be drawn
 * as "-nan". */
CASE(broken__positions_are_told_with_their_vertex)
{
    static const struct breaking cases[] = {
        {RECORD_MESH, 1, PAYLOAD(record_mesh) + VERTEX(1), NAN, .says = STRAY(1, "")},
        {RECORD_MESH, 1, PAYLOAD(record_mesh) + VERTEX(2) + 16, 2e18,
         .says = STRAY(2, "")},
        {RECORD_PLACE, 1, PAYLOAD(record_place) + VERTEX(2), -INFINITY,
         .says = "vertex 2 of object 0x"},
        {RECORD_PLACE, 2, PAYLOAD(record_place), NAN, .says = "vertex 0 of object 0x"},
        {RECORD_FRAME, 1, SLOT(record_frame) + VERTEX(1), NAN,
         .says = "vertex 1 of object 0x"},
        {RECORD_FRAME, 2, SLOT(record_frame) + VERTEX(2), INFINITY,
         .says = "vertex 2 of object 0x"},
        {RECORD_FRAME, 2, SLOT(record_frame) + 64 + 8 + VERTEX(2), INFINITY,
         .says = "vertex 2 of object 0x"},
        {RECORD_FRAME, 3, SLOT(record_frame), 2e18, .says = "vertex 1 of object 0x"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_told(&cases[i]);
    }
}

/* If this failed, a handle that names nothing would end a command by an assertion. */
CASE(broken__handles_are_told)
{
    static const struct breaking cases[] = {
        {RECORD_SCENE, 1, offsetof(struct record_scene, scene), .is_word = true,
         .says = "a scene without handle"},
        {RECORD_OBJECT, 1, offsetof(struct record_object, scene), .is_word = true,
         .says = "an object without handle"},
        {RECORD_OBJECT, 1, offsetof(struct record_object, mesh), .is_word = true,
         .says = "an object without handle"},
        {RECORD_OBJECT, 1, offsetof(struct record_object, object), .is_word = true,
         .says = "an object without handle"},
        {RECORD_MESH, 1, offsetof(struct record_mesh, mesh), .is_word = true,
         .says = "a mesh without handle"},
        {RECORD_PLACE, 1, offsetof(struct record_place, scene), .is_word = true,
         .says = "which there is not"},
        {RECORD_PLACE, 1, offsetof(struct record_place, object), .is_word = true,
         .says = "which there is not"},
        {RECORD_FILTER, 1, offsetof(struct record_filter, object), .is_word = true,
         .says = "which there is not"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_told(&cases[i]);
    }
}

/* If this failed, a length that is none would end a command by a signal. */
CASE(broken__lengths_are_told)
{
    static const struct breaking cases[] = {
        {RECORD_FILTER, 1, offsetof(struct record_filter, words) + 3 * 8, NAN,
         .says = "a thickness that cannot be one"},
        {RECORD_FILTER, 1, offsetof(struct record_filter, words) + 4 * 8, -1,
         .says = "a thickness that cannot be one"},
    };
    struct breaking near = {RECORD_NEAR, 1, offsetof(struct record_frame, distance), NAN,
                            .says = ""};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_told(&cases[i]);
    }
    forge_recording(test_recording, test_forged, break_one, &near);
    test_ctl_says(4, "verify", "", test_forged,
                  ", NEAR: a distance or tolerance that cannot be one", NULL);
}

CASES_WITH(set_up, test_recording_stop);
