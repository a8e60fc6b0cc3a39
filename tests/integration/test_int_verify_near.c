/* test_int_verify_near.c - wrong answers about what is near, and whether pccdctl verify
 * and replay find that. */
#include "cases.h"

#include <unistd.h>

#include "fixture.h"
#include "forge.h"
#include "run_ctl.h"

static char folder[] = "/tmp/pccd-test-verify-near-XXXXXX";
static char honest[96], forged[96];

/* A floor, and a needle above it that goes down through it. */
static const double floor_x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
static const double needle_x[3][3] = {{.25, .25, .5}, {.25, .25, 3}, {.375, .25, 3}};
static const uint32_t face[1][3] = {{0, 1, 2}};

/* Two tetrahedra, a corner of each in the other. */
static const double closed_x[2][4][3] = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
                                         {{.5, .5, .5}, {5, 1, 1}, {1, 5, 1}, {1, 1, 5}}};
static const uint32_t closed_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

static int ask(struct pccd_client *client, uint32_t scene, enum pccd_near_what what,
               uint32_t end, const struct pccd_motion *motion)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings.what = what;
    settings.distance = what == PCCD_NEAR_CROSSINGS ? 0 : 1;
    settings.gap = what == PCCD_NEAR_NEAREST && end == 1 ? 0 : .125; /* else no use */
    settings.end = end;
    settings.tells_crossings = what == PCCD_NEAR_VERTICES;
    int status = pccd_ask_near(client, scene, motion, motion != NULL, &settings, &answer);
    pccd_answer_release(client, &answer);
    return status == 0 && answer.total > 0 ? 0 : -1;
}

/* Ask what is asked of objects two by two. */
static int ask_two(struct pccd_client *client)
{
    uint32_t scene, mesh, object;
    if (pccd_scene_create(client, NULL, &scene) != 0) {
        return -1;
    }
    for (int i = 0; i < 2; i++) {
        if (pccd_mesh_create(client, closed_x[i], PCCD_FORMAT_F64, 4, closed_faces, 4,
                             &mesh, NULL) != 0 ||
            pccd_scene_add(client, scene, mesh, &object) != 0) {
            return -1;
        }
    }
    return ask(client, scene, PCCD_NEAR_NEAREST, 1, NULL) != 0 ||
                   ask(client, scene, PCCD_NEAR_NEAREST, 0, NULL) != 0 ||
                   ask(client, scene, PCCD_NEAR_DEPTH, 1, NULL) != 0
               ? -1
               : 0;
}

/* Ask what is at most 3/10 beyond radii: pairs, closest features, and the nearest of the
 * first two objects. These are 1/2 apart, with radii that add up to 1/4; a third object
 * is both, and its parts are left thin. */
static int ask_thick(struct pccd_client *client, const uint32_t mesh[2])
{
    static const uint32_t faces[2][3] = {{0, 1, 2}, {3, 4, 5}};
    struct pccd_object_settings thick = {.struct_bytes = sizeof thick,
                                         .what = PCCD_OBJECT_RADIUS |
                                                 PCCD_OBJECT_REST_DISTANCE,
                                         .radius = .125,
                                         .rest_distance = .75};
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    double x[6][3];
    uint32_t scene, both, object[3];
    memcpy(x, floor_x, sizeof floor_x);
    memcpy(x + 3, needle_x, sizeof needle_x);
    for (int i = 0; i < 6; i++) {
        x[i][0] += 100; /* far from the others */
    }
    if (pccd_scene_create(client, NULL, &scene) != 0 ||
        pccd_mesh_create(client, x, PCCD_FORMAT_F64, 6, faces, 2, &both, NULL) != 0 ||
        pccd_scene_add(client, scene, mesh[0], &object[0]) != 0 ||
        pccd_scene_add(client, scene, mesh[1], &object[1]) != 0 ||
        pccd_scene_add(client, scene, both, &object[2]) != 0) {
        return -1;
    }
    for (int i = 0; i < 3; i++) {
        if (pccd_object_set(client, scene, object[i], &thick) != 0) {
            return -1;
        }
    }
    settings.distance = .3;
    settings.object_a = object[0];
    settings.object_b = object[1];
    for (int i = 0; i < 4; i++) {
        static const enum pccd_near_what whats[4] = {
            PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES, PCCD_NEAR_NEAREST, PCCD_NEAR_NEAREST};
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        settings.what = whats[i];
        settings.gap = i == 3 ? .125 : 0;
        if (pccd_ask_near(client, scene, NULL, 0, &settings, &answer) != 0 ||
            answer.total != 1) {
            return -1;
        }
        pccd_answer_release(client, &answer);
    }
    return 0;
}

static int set_up(void **state)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_client *client = NULL;
    uint32_t scene, mesh[2], object[2];
    double x1[3][3];
    struct pccd_motion motion = {.count = 3, .format = PCCD_FORMAT_F64, .x1 = x1};
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    (void)snprintf(honest, sizeof honest, "%s/honest.rec", folder);
    (void)snprintf(forged, sizeof forged, "%s/forged.rec", folder);
    if (test_shared_connect(state, 0, &client) != 0 ||
        pccd_record_start(client, honest, &settings) != 0 ||
        pccd_scene_create(client, NULL, &scene) != 0 ||
        pccd_mesh_create(client, floor_x, PCCD_FORMAT_F64, 3, face, 1, &mesh[0], NULL) ||
        pccd_mesh_create(client, needle_x, PCCD_FORMAT_F64, 3, face, 1, &mesh[1], NULL) ||
        pccd_scene_add(client, scene, mesh[0], &object[0]) != 0 ||
        pccd_scene_add(client, scene, mesh[1], &object[1]) != 0) {
        return -1;
    }
    motion.object = object[1];
    memcpy(x1, needle_x, sizeof x1);
    x1[0][2] = -.25; /* now it goes through the floor */
    if (ask(client, scene, PCCD_NEAR_PAIRS, 1, NULL) != 0 ||
        ask(client, scene, PCCD_NEAR_CROSSINGS, 1, &motion) != 0 ||
        ask(client, scene, PCCD_NEAR_FEATURES, 0, NULL) != 0 ||
        ask(client, scene, PCCD_NEAR_VERTICES, 1, NULL) != 0) {
        return -1;
    }
    x1[0][2] = .75;
    if (ask(client, scene, PCCD_NEAR_PAIRS, 1, &motion) != 0 || ask_two(client) != 0 ||
        ask_thick(client, mesh) != 0 ||
        pccd_step(client, scene, NULL, 0, NULL, &answer) != 0) {
        return -1;
    }
    pccd_answer_release(client, &answer);
    pccd_close(client);
    return 0;
}

static int tear_down(void **state)
{
    (void)unlink(honest);
    (void)unlink(forged);
    (void)rmdir(folder);
    return test_shared_stop(state);
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
    FORGE_COUNT,
    FORGE_HASH = FORGE_COUNT
};

/* Return whether the question is one that a forgery needs. */
static bool is_about(enum forgery forgery, const struct record_near *asked)
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
    struct record_near_answer answer;
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
    struct record_near near;
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
    struct record_near asked; /* the last question, which the next answer is to */
    bool is_done, is_short;
};

static bool forge_chunk(void *context, struct forge_chunk *chunk)
{
    struct forger *forger = context;
    const enum forgery forgery = forger->forgery;

    if (chunk->kind == RECORD_NEAR_RECORDS && forger->is_done &&
        forgery == FORGE_MISSING && !forger->is_short) {
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
            chunk->kind == RECORD_NEAR_RECORDS  ? forge_records(forgery, chunk->payload)
            : chunk->kind == RECORD_NEAR_ANSWER ? forge_answer(forgery, chunk->payload)
            : chunk->kind == RECORD_NEAR && forgery == FORGE_MOTION
                ? forge_motion(chunk->payload)
                : false;
    }
    return true;
}

static void forge(enum forgery forgery)
{
    struct forger forger = {.forgery = forgery};

    forge_recording(honest, forged, forge_chunk, &forger);
    assert_true(forger.is_done);
}

/* ---- judging ----------------------------------------------------------------------- */

/* If this failed, right answers would be called wrong, or nothing would be checked; or
 * the scene would not follow questions that move it, of which the step after them
 * tells. */
CASE(verify__passes_what_is_near)
{
    char said[4096];

    assert_int_equal(test_ctl("verify", "", honest, said, sizeof said), 0);
    assert_non_null(strstr(said, "PASS: 1 step"));
    assert_non_null(strstr(said, "12 questions about what is near with "));
    assert_null(strstr(said, "not checked"));
    assert_int_equal(
        test_ctl("verify", "--repeat --method paper", honest, said, sizeof said), 0);
    assert_non_null(strstr(said, "12 questions about what is near with "));
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
        [FORGE_MOTION] = "what is near: record "};
    char said[4096];

    for (int forgery = 0; forgery < FORGE_COUNT; forgery++) {
        forge((enum forgery)forgery);
        int status = test_ctl("verify", "", forged, said, sizeof said);
        if (status != 1 || strstr(said, says[forgery]) == NULL) {
            print_message("forgery %d: %s\n", forgery, said);
        }
        assert_int_equal(status, 1);
        assert_non_null(strstr(said, says[forgery]));
    }
}

/* If this failed, a daemon that answers otherwise than one before would not be
 * noticed. */
CASE(replay__compares_what_is_near)
{
    char said[4096];

    assert_int_equal(test_ctl("replay", "", honest, said, sizeof said), 0);
    /* With a gap any pair is right. */
    assert_non_null(strstr(said, "11 the same, 0 not"));
    forge(FORGE_HASH);
    assert_int_equal(test_ctl("replay", "", forged, said, sizeof said), 1);
    assert_non_null(strstr(said, "what is near, question 1 has another hash"));
    assert_int_equal(test_ctl("replay", "--steps 2..", forged, said, sizeof said), 0);
    assert_non_null(strstr(said, "10 the same, 0 not"));
}

CASES_WITH(set_up, tear_down);
