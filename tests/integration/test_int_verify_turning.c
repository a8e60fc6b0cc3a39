/* test_int_verify_turning.c - answers about bodies that turn, right and wrong, and
 * whether pccdctl verify tells them apart. */
#include "cases.h"

#include "fixture.h"
#include "forge.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

#define PI    3.141592653589793
#define ANGLE 1.125 /* where the post stands, seen from the pin */
#define SHORT 1.03125

static double begins; /* the angle from which the door turns, and tells how; 0 */
static double approach;

CASES_WITH(test_recording_start, test_recording_stop);

/* A door that turns about z by `angle`, against a post whose upright edge is at ANGLE; a
 * clearance of the two, if it is not negative. */
static void record_clear(double angle, enum pccd_mode mode, double clearance,
                         uint64_t due)
{
    static const double door_x[4][3] = {
        {0.125, 0, -1}, {1, 0, -1}, {1, 0, 1}, {0.125, 0, 1}};
    static const uint32_t door_faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static const uint32_t post_face[1][3] = {{0, 1, 2}};
    const double post_x[3][3] = {{0.5 * cos(ANGLE), 0.5 * sin(ANGLE), -2},
                                 {0.5 * cos(ANGLE), 0.5 * sin(ANGLE), 2},
                                 {cos(ANGLE + 1), sin(ANGLE + 1), 0}};
    const struct pccd_record_settings kept = {.contacts = 1};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_joint joints[PCCD_JOINTS_MOST];
    uint32_t count = 0;
    struct pccd_client *client = test_client_at(test_shared.url);

    test_recording_clear();
    uint32_t scene = test_scene(client);
    uint32_t door = test_object(
        client, scene, test_mesh(client, door_x, PCCD_FORMAT_F64, 4, door_faces, 2));
    uint32_t post = test_object(
        client, scene, test_mesh(client, post_x, PCCD_FORMAT_F64, 3, post_face, 1));
    if (clearance >= 0) { /* before and in the recording */
        assert_ok(pccd_pair_clearance(client, scene, door, post, 0.25));
    }
    assert_ok(pccd_record_start(client, test_recording, &kept));
    if (clearance >= 0) {
        assert_ok(pccd_pair_clearance(client, scene, door, post, clearance));
    }
    assert_ok(pccd_joints_screw((double[3]){0, 0, 0}, (double[3]){0, 0, 1}, angle, 0,
                                PCCD_NO_JOINT, joints, PCCD_JOINTS_MOST, &count));
    const struct pccd_motion motion = {.object = door, .first = count - 1, .count = 4};
    for (uint32_t i = 0; i < count && begins != 0; i++) {
        joints[i].from[0] = joints[i].kind == PCCD_JOINT_TURN ? begins : 0;
    }
    settings.tells_start = begins != 0;
    settings.approach = approach;
    settings.mode = mode;
    settings.joints = joints;
    settings.joint_count = count;
    assert_ok(pccd_step(client, scene, &motion, 1, &settings, &answer));
    assert_int_equal(answer.total, due);
    pccd_answer_release(client, &answer);
    pccd_close(client);
}

static void record_door(double angle, enum pccd_mode mode, uint64_t due)
{
    record_clear(angle, mode, -1, due);
}

/* A number of a frame or clearance, and the one in its place. */
struct swap {
    double was, is;
    int changed;
};

static bool swap_one(void *context, struct forge_chunk *chunk)
{
    struct swap *swap = context;
    bool is_about = chunk->kind == RECORD_FRAME || chunk->kind == RECORD_PAIRS;

    for (uint64_t i = 0; is_about && i + 8 <= chunk->bytes; i += 8) {
        if (memcmp(chunk->payload + i, &swap->was, 8) == 0) {
            memcpy(chunk->payload + i, &swap->is, 8);
            swap->changed++;
        }
    }
    return true;
}

/* Copy the recording; the door turns by another angle there, or has another clearance,
 * and verify says that this is wrong. */
static void assert_wrong(double was, double is, const char *what)
{
    struct swap swap = {was, is, 0};

    forge_recording(test_recording, test_forged, swap_one, &swap);
    assert_int_equal(swap.changed, 1);
    test_ctl_says(1, "verify", "", test_forged, what, NULL);
}

/* If it failed, right answers would be called wrong, or nothing would be checked. */
CASE(verify_turning__says_that_right_answers_are)
{
    static const struct {
        enum pccd_mode mode;
        uint64_t due;
    } modes[] = {{PCCD_MODE_ALL, 3},
                 {PCCD_MODE_FIRST, 3},
                 {PCCD_MODE_FIRST_PER_PAIR, 1},
                 {PCCD_MODE_ANY, 0}};
    char said[8192];

    for (int i = 0; i < 4; i++) {
        record_door(PI / 2, modes[i].mode, modes[i].due);
        assert_ok(test_ctl("verify", "--json", test_recording, said, sizeof said));
        assert_int_equal(test_ctl_number(said, "contacts"), modes[i].due);
        assert_int_equal(test_ctl_number(said, "turning"), 0);
    }
    record_door(SHORT, PCCD_MODE_ALL, 0);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    assert_true(test_ctl_number(said, "non_contacts") > 0);
    assert_int_equal(test_ctl_number(said, "turning"), 0);
}

/* If it failed, a contact that is invented, late or missing would be taken for right. */
CASE(verify_turning__finds_what_is_wrong)
{
    record_door(PI / 2, PCCD_MODE_ALL, 3);
    assert_wrong(PI / 2, 2, "meet before the record's time");
    assert_wrong(PI / 2, 1.5, "are apart until after its time");
    assert_wrong(PI / 2, SHORT, "are apart until after its time");
    record_door(SHORT, PCCD_MODE_ALL, 0);
    assert_wrong(SHORT, PI / 2, "a contact is missing in the answer");
    record_door(SHORT, PCCD_MODE_ANY, 0);
    assert_wrong(SHORT, PI / 2, "a contact is missing in the answer");
    record_door(SHORT, PCCD_MODE_FIRST_PER_PAIR, 0);
    assert_wrong(SHORT, PI / 2, "a contact is missing in the answer");
}

/* If it failed, a contact that is no nearer than the clearance of its two objects, or one
 * that is missing, would be taken for right. */
CASE(verify_turning__knows_clearances)
{
    const double near = 0.0625;
    char said[8192];

    record_clear(PI / 2, PCCD_MODE_FIRST, near, 3);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    assert_int_equal(test_ctl_number(said, "contacts"), 3);
    assert_int_equal(test_recording_repeats("--json", test_recording, 1), 1);
    assert_wrong(near, 0.125, "meet before the record's time");
    assert_wrong(near, 0.03125, "are apart until after its time");
    record_clear(0.75, PCCD_MODE_ALL, near, 0);
    assert_wrong(near, 0.25, "a contact is missing in the answer");
    record_clear(0.75, PCCD_MODE_ANY, near, 0);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
}

/* If it failed, a door that begins within its clearance of the post, and may come to half
 * of that, would be taken to meet it sooner or later than it does. */
CASE(verify_turning__knows_what_comes_nearer_by_its_part)
{
    const double far = 0.75; /* some of it begins at 0.5 sin ANGLE = 0.45 */
    char said[8192];

    approach = 0.5;
    record_clear(PI / 2, PCCD_MODE_ALL, far, 13);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    assert_int_equal(test_ctl_number(said, "contacts"), 13);
    assert_wrong(far, 1.5, "within their distance is told wrongly");
    assert_wrong(PI / 2, 2, "meet before the record's time");
    assert_wrong(PI / 2, 1.5, "are apart until after its time");
    record_clear(0.28125, PCCD_MODE_ALL, far, 0);
    assert_int_equal(test_ctl("verify", "--json", test_recording, said, sizeof said), 0);
    approach = 0;
    assert_wrong(0.28125, PI / 2, "a contact is missing in the answer");
}

static bool is_called_free(void *context, struct forge_chunk *chunk)
{
    (void)context;
    if (chunk->kind == RECORD_ANSWER) {
        struct record_answer *answer = (struct record_answer *)(void *)chunk->payload;

        assert_int_equal(answer->verdict, PCCD_VERDICT_POSSIBLE);
        answer->verdict = PCCD_VERDICT_NO;
        record_verdict_hash(answer->verdict, answer->hash);
    }
    return true;
}

/* If it failed, nobody would see that a door which stands in its post when it begins to
 * turn is called free, or that another number of edges is told to pass through faces. */
CASE(verify_turning__knows_how_it_begins)
{
    char said[8192];

    begins = 1.25;
    for (int repeats = 0; repeats < 2; repeats++) {
        const char *options = repeats ? "--json --repeat" : "--json";

        record_door(1.26, repeats ? PCCD_MODE_ALL : PCCD_MODE_ANY, 0);
        assert_int_equal(test_ctl("verify", options, test_recording, said, sizeof said),
                         0);
        assert_null(strstr(said, "begins"));
    }
    record_door(1.26, PCCD_MODE_ANY, 0);
    forge_recording(test_recording, test_forged, is_called_free, NULL);
    begins = 0;
    test_ctl_says(1, "verify", "", test_forged, "it begins crossed", NULL);
}
