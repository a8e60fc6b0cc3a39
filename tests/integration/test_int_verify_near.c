/* test_int_verify_near.c - wrong answers about what is near, and whether pccdctl verify
 * and replay find that. */
#include "cases.h"

#include "fixture.h"
#include "forge.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

/* A floor, and a needle above it that goes down through it. */
static const double floor_x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const double needle_x[3][3] = {{.25, .25, .5}, {.25, .25, 3}, {.375, .25, 3}};
static const uint32_t face[1][3] = {{0, 1, 2}};

/* Two tetrahedra, a corner of each in the other. */
static const double closed_x[2][4][3] = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
                                         {{.5, .5, .5}, {5, 1, 1}, {1, 5, 1}, {1, 1, 5}}};
static const uint32_t closed_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

static void ask_with(struct pccd_client *client, uint32_t scene,
                     const struct pccd_motion *motion,
                     const struct pccd_near_settings *settings)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    assert_ok(
        pccd_ask_near(client, scene, motion, motion != NULL ? 1 : 0, settings, &answer));
    assert_true(answer.total > 0);
    pccd_answer_release(client, &answer);
}

static void ask(struct pccd_client *client, uint32_t scene, enum pccd_near_what what,
                uint32_t end, const struct pccd_motion *motion)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = what;
    settings.distance = what == PCCD_NEAR_CROSSINGS ? 0 : 1;
    settings.gap = what == PCCD_NEAR_NEAREST && end == 1 ? 0 : .125; /* else no use */
    settings.at_begin = end == 0;
    settings.tells_crossings = what == PCCD_NEAR_VERTICES;
    ask_with(client, scene, motion, &settings);
}

/* Ask what is asked of objects two by two. */
static void ask_two(struct pccd_client *client)
{
    uint32_t scene = test_scene(client);
    for (int i = 0; i < 2; i++) {
        (void)test_object(
            client, scene,
            test_mesh(client, closed_x[i], PCCD_FORMAT_F64, 4, closed_faces, 4));
    }
    ask(client, scene, PCCD_NEAR_NEAREST, 1, NULL);
    ask(client, scene, PCCD_NEAR_NEAREST, 0, NULL);
    ask(client, scene, PCCD_NEAR_DEPTH, 1, NULL);
}

/* Ask what is at most 3/10 beyond radii: pairs, closest features, and the nearest of the
 * first two objects. These are 1/2 apart, with radii that add up to 1/4; a third object
 * is both, and its parts are left thin. */
static void ask_thick(struct pccd_client *client, const uint32_t mesh[2])
{
    static const enum pccd_near_what whats[4] = {PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES,
                                                 PCCD_NEAR_NEAREST, PCCD_NEAR_NEAREST};
    static const uint32_t faces[2][3] = {{0, 1, 2}, {3, 4, 5}};
    struct pccd_object_settings thick = {.struct_bytes = sizeof thick,
                                         .what = PCCD_OBJECT_RADIUS |
                                                 PCCD_OBJECT_REST_DISTANCE,
                                         .radius = .125,
                                         .rest_distance = .75};
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    double x[6][3];
    uint32_t object[3];
    memcpy(x, floor_x, sizeof floor_x);
    memcpy(x + 3, needle_x, sizeof needle_x);
    for (int i = 0; i < 6; i++) {
        x[i][0] += 100; /* far from the others */
    }
    uint32_t both = test_mesh(client, x, PCCD_FORMAT_F64, 6, faces, 2);
    uint32_t scene = test_scene(client);
    for (int i = 0; i < 3; i++) {
        object[i] = test_object(client, scene, i < 2 ? mesh[i] : both);
        assert_ok(pccd_object_set(client, scene, object[i], &thick));
    }
    settings.distance = .3;
    for (int i = 0; i < 4; i++) {
        settings.what = whats[i];
        settings.object_a = whats[i] == PCCD_NEAR_NEAREST ? object[0] : 0;
        settings.object_b = whats[i] == PCCD_NEAR_NEAREST ? object[1] : 0;
        settings.gap = i == 3 ? .125 : 0;
        ask_with(client, scene, NULL, &settings);
    }
}

static int set_up(void **state)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_client *client = NULL;
    uint32_t mesh[2];
    double x1[3][3];
    struct pccd_motion motion = {.count = 3, .format = PCCD_FORMAT_F64, .x1 = x1};
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    assert_true(test_recording_begin());
    assert_ok(test_shared_connect(state, 0, &client));
    assert_ok(pccd_record_start(client, test_recording, &settings));
    uint32_t scene = test_scene(client);
    mesh[0] = test_mesh(client, floor_x, PCCD_FORMAT_F64, 3, face, 1);
    mesh[1] = test_mesh(client, needle_x, PCCD_FORMAT_F64, 3, face, 1);
    (void)test_object(client, scene, mesh[0]);
    motion.object = test_object(client, scene, mesh[1]);
    memcpy(x1, needle_x, sizeof x1);
    x1[0][2] = -.25; /* now it goes through the floor */
    ask(client, scene, PCCD_NEAR_PAIRS, 1, NULL);
    ask(client, scene, PCCD_NEAR_CROSSINGS, 1, &motion);
    ask(client, scene, PCCD_NEAR_FEATURES, 0, NULL);
    ask(client, scene, PCCD_NEAR_VERTICES, 1, NULL);
    x1[0][2] = .75;
    ask(client, scene, PCCD_NEAR_PAIRS, 1, &motion);
    ask_two(client);
    ask_thick(client, mesh);
    test_still(client, scene, NULL, &answer);
    pccd_answer_release(client, &answer);
    pccd_close(client);
    return 0;
}

/* ---- forging ----------------------------------------------------------------------- */

enum forgery {
    FORGE_DISTANCE,  /* one unit in the last place of a record's d_hi */
    FORGE_PARAM,     /* and of a weight */
    FORGE_BOUND,     /* and of a vertex's bound */
    FORGE_MISSING,   /* the last record left out */
    FORGE_VERDICT,   /* free of intersections, and it is not */
    FORGE_NEAREST,   /* another vertex is the nearest */
    FORGE_GAP,       /* one unit in the last place of a d_hi, with a gap */
    FORGE_DEPTH,     /* another vertex is inside */
    FORGE_CROSSINGS, /* one edge more passes through a face, of closed meshes */
    FORGE_BESIDE,    /* and beside bounds */
    FORGE_MOTION, /* the first question moved the needle, and the answer does not know */
    FORGE_HASH,
    FORGE_COUNT
};

/* Return whether the question is one that a forgery needs. */
static bool is_about(enum forgery forgery, const struct record_frame *asked)
{
    switch (forgery) {
    case FORGE_NEAREST:
        return asked->what == PCCD_NEAR_NEAREST && asked->gap == 0;
    case FORGE_GAP:
        return asked->what == PCCD_NEAR_NEAREST && asked->gap > 0;
    case FORGE_BESIDE:
        return asked->what == PCCD_NEAR_VERTICES;
    case FORGE_DEPTH:
    case FORGE_CROSSINGS:
        return asked->what == PCCD_NEAR_DEPTH;
    default:
        return true;
    }
}

/* Forge a chunk of records. Return whether it was one to forge. */
static bool forge_records(enum forgery forgery, uint8_t *payload)
{
    struct record_records head;
    struct pccd_near record;
    double bound;
    memcpy(&head, payload, sizeof head);
    if (head.record_bytes == sizeof bound) {
        if (forgery != FORGE_BOUND) {
            return false;
        }
        memcpy(&bound, payload + sizeof head, sizeof bound);
        bound = nextafter(bound, 2);
        memcpy(payload + sizeof head, &bound, sizeof bound);
        return true;
    }
    memcpy(&record, payload + sizeof head, sizeof record);
    if (forgery == FORGE_DISTANCE || forgery == FORGE_GAP) {
        record.d_hi = nextafter(record.d_hi, 2);
    } else if (forgery == FORGE_PARAM) {
        record.param[0] = nextafterf(record.param[0], 2);
    } else if (forgery == FORGE_NEAREST || forgery == FORGE_DEPTH) {
        record.feature_a ^= 1;
    } else {
        return false;
    }
    memcpy(payload + sizeof head, &record, sizeof record);
    return true;
}

static bool forge_answer(enum forgery forgery, uint8_t *payload)
{
    struct record_answer answer;
    memcpy(&answer, payload, sizeof answer);
    if (forgery == FORGE_MISSING) {
        answer.total--;
    } else if (forgery == FORGE_VERDICT && answer.what == PCCD_NEAR_CROSSINGS) {
        answer.verdict = PCCD_VERDICT_NO;
    } else if (forgery == FORGE_CROSSINGS || forgery == FORGE_BESIDE) {
        answer.crossings++;
    } else if (forgery == FORGE_HASH) {
        answer.hash[1] ^= 1;
    } else {
        return false;
    }
    memcpy(payload, &answer, sizeof answer);
    return true;
}

/* The needle's tip goes higher, and not through the floor. */
static bool forge_motion(uint8_t *payload)
{
    struct record_frame near;
    struct record_segment segment;
    const double up = 2;
    memcpy(&near, payload, sizeof near);
    if (near.segment_count == 0) {
        return false;
    }
    memcpy(&segment, payload + sizeof near, sizeof segment);
    memcpy(payload + sizeof near + segment.offset1 + 2 * sizeof up, &up, sizeof up);
    return true;
}

/* Chunks stay as they were but for one of them; FORGE_MISSING: an answer and its
 * records. */
struct forger {
    enum forgery forgery;
    struct record_frame asked; /* the last question, which the next answer is to */
    bool is_done, is_short;
};

static bool forge_chunk(void *context, struct forge_chunk *chunk)
{
    struct forger *forger = context;
    const enum forgery forgery = forger->forgery;

    if (chunk->kind == RECORD_RECORDS && forger->is_done && forgery == FORGE_MISSING &&
        !forger->is_short) {
        struct record_records head;
        memcpy(&head, chunk->payload, sizeof head);
        head.count--;
        chunk->bytes -= head.record_bytes;
        memcpy(chunk->payload, &head, sizeof head);
        forger->is_short = true;
    }
    if (chunk->kind == RECORD_NEAR) {
        memcpy(&forger->asked, chunk->payload, sizeof forger->asked);
    }
    if (!forger->is_done && is_about(forgery, &forger->asked)) {
        forger->is_done =
            chunk->kind == RECORD_RECORDS  ? forge_records(forgery, chunk->payload)
            : chunk->kind == RECORD_ANSWER ? forge_answer(forgery, chunk->payload)
            : chunk->kind == RECORD_NEAR && forgery == FORGE_MOTION
                ? forge_motion(chunk->payload)
                : false;
    }
    return true;
}

static void forge(enum forgery forgery)
{
    struct forger forger = {.forgery = forgery};

    forge_recording(test_recording, test_forged, forge_chunk, &forger);
    assert_true(forger.is_done);
}

/* ---- judging ----------------------------------------------------------------------- */

/* If this failed, right answers would be called wrong, or nothing would be checked; or
 * the scene would not follow questions that move it, of which the step after them
 * tells. */
CASE(verify__passes_what_is_near)
{
    const char *const all = "12 questions about what is near with ";
    char said[4096];

    test_ctl_says(0, "verify", "", test_recording, "PASS: 1 step", all, NULL);
    assert_ok(test_ctl("verify", "", test_recording, said, sizeof said));
    assert_null(strstr(said, "not checked"));
    test_ctl_says(0, "verify", "--repeat --method paper", test_recording, all, NULL);
}

/* If this failed, a daemon that is wrong about distances would be trusted. */
CASE(verify__shows_what_is_wrong_of_what_is_near)
{
    static const char *const says[FORGE_COUNT] = {
        [FORGE_DISTANCE] = "exact: ",
        [FORGE_PARAM] = "exact: ",
        [FORGE_BOUND] = "bound 0.",
        [FORGE_MISSING] = "it is missing",
        [FORGE_VERDICT] = "something intersects or touches, and it says no",
        [FORGE_NEAREST] = ", exact: ",
        [FORGE_GAP] = "its numbers are not those of its pair",
        [FORGE_DEPTH] = ", exact: ",
        [FORGE_CROSSINGS] = "edges pass through faces, exact: ",
        [FORGE_BESIDE] = "crossings: it is not that of the records",
        [FORGE_MOTION] = "what is near: record ",
        [FORGE_HASH] = "hash: it is not that of the records"};

    for (int forgery = 0; forgery < FORGE_COUNT; forgery++) {
        forge((enum forgery)forgery);
        test_ctl_says(1, "verify", "", test_forged, says[forgery], NULL);
    }
}

/* If this failed, a daemon that answers otherwise than one before would not be
 * noticed. */
CASE(replay__compares_what_is_near)
{
    /* With a gap any pair is right. */
    test_ctl_says(0, "replay", "", test_recording, "11 the same, 0 not", NULL);
    forge(FORGE_HASH);
    test_ctl_says(1, "replay", "", test_forged,
                  "what is near, question 1 has another hash", NULL);
    test_ctl_says(0, "replay", "--steps 2..", test_forged, "10 the same, 0 not", NULL);
}

CASES_WITH(set_up, test_recording_stop);
