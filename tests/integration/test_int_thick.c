/* test_int_thick.c - thickness through a real daemon: radii, separation, approach, and
 * the step that is safe. */
#include "cases.h"

#include <signal.h>

#include "daemon.h"
#include "fixture.h"
#include "format.h"
#include "must.h"
#include "raw.h"
#include "recording.h"
#include "run_ctl.h"

/* Times are known to a cell of 2^-30. */
#define CELL 0x1p-30

#define PAIRS 15u /* of two triangles: six of a vertex and a face, nine of edges */

/* Two triangles, one above the other, of which the upper one comes down. */
struct pile {
    struct pccd_client *client;
    uint32_t scene, mesh;
    uint32_t lower, upper;
    float height; /* where the upper one is */
};

static void triangle_at(float x[3][3], float height)
{
    const float at[3][3] = {{0, 0, height}, {1, 0, height}, {0, 1, height}};

    memcpy(x, at, sizeof at);
}

static void make(struct pile *pile)
{
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    float x[3][3];

    triangle_at(x, 0);
    pile->scene = test_scene(pile->client);
    pile->mesh = test_mesh(pile->client, x, PCCD_FORMAT_F32, 3, triangle, 1);
    pile->lower = test_object(pile->client, pile->scene, pile->mesh);
    pile->upper = test_object(pile->client, pile->scene, pile->mesh);
}

static void begin(struct pile *pile, const char *url)
{
    *pile = (struct pile){.client = test_client_at(url)};
    make(pile);
}

static int set_radius(struct pile *pile, uint32_t object, double radius)
{
    const struct pccd_object_settings settings = {
        .struct_bytes = sizeof settings, .what = PCCD_OBJECT_RADIUS, .radius = radius};

    return pccd_object_set(pile->client, pile->scene, object, &settings);
}

/* The upper triangle goes from `from` to `to`. Returns the step's status; its records are
 * given back, the first of them is *first. */
static int move(struct pile *pile, float from, float to,
                const struct pccd_step_settings *settings, struct pccd_answer *answer,
                struct pccd_contact *first)
{
    struct pccd_motion motion = {
        .object = pile->upper, .count = 3, .format = PCCD_FORMAT_F32};
    float x0[3][3], x1[3][3];
    uint64_t step;

    triangle_at(x0, from);
    triangle_at(x1, to);
    motion.x0 = x0;
    motion.x1 = x1;
    *answer = (struct pccd_answer)PCCD_ANSWER_INIT;
    int status = pccd_submit(pile->client, pile->scene, &motion, 1, settings, &step);
    if (status != 0) {
        return status;
    }
    status = pccd_wait(pile->client, step, -1, answer);
    pile->height = to;
    if (answer->count > 0 && first != NULL) {
        *first = answer->contacts[0];
    }
    pccd_answer_release(pile->client, answer);
    return status;
}

/* If it failed, features would meet at another distance than their radii and the
 * separation make, or the step that a program takes would go through one of them. */
CASE(thick__meets_at_the_sum_of_radii_and_separation)
{
    const struct {
        double lower, upper, separation, time; /* time 2: they do not meet */
    } cases[] = {{0.3, 0.3, 0, 0.8},   {0.3, 0.3, 0.2, 0.4},
                 {0, 0, 0.6, 0.8},     {0.6, 0, 0, 0.8},
                 {0, 0, 0, 2},         {0.25, 0.125, 0, 2},
                 {0.25, 0.25, 0, 1.0}, {0.125, 0.125, 0.25, 1.0}};
    struct pccd_answer answer;
    struct pccd_contact first;
    struct pile pile;

    begin(&pile, test_shared.url);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct pccd_step_settings settings = {.struct_bytes = sizeof settings,
                                                    .separation = cases[i].separation};

        assert_int_equal(set_radius(&pile, pile.lower, cases[i].lower), 0);
        assert_int_equal(set_radius(&pile, pile.upper, cases[i].upper), 0);
        assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, &first), 0);
        assert_int_equal(answer.incomplete, PCCD_COMPLETE);
        assert_false(answer.crowded);
        assert_int_equal(answer.initial + answer.inside, 0);
        if (cases[i].time > 1) {
            assert_int_equal(answer.total, 0);
            assert_true(answer.safe_step == 1);
            continue;
        }
        assert_int_equal(answer.total, PAIRS);
        assert_int_equal(first.flags, PCCD_PROVED);
        assert_true(first.toi <= cases[i].time && first.toi_hi >= cases[i].time);
        assert_true(answer.toi_first >= cases[i].time - 2 * CELL);
        assert_true(answer.safe_step < answer.toi_first);
        assert_true(answer.safe_step > answer.toi_first - CELL);
    }
    pccd_close(pile.client);
}

/* If it failed, cloth that begins within its thickness would stand still for ever, or
 * would be let through. */
CASE(thick__says_what_begins_within_the_distance)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer;
    struct pccd_contact first;
    struct pile pile;

    begin(&pile, test_shared.url);
    assert_int_equal(set_radius(&pile, pile.lower, 1), 0);
    assert_int_equal(set_radius(&pile, pile.upper, 0.5), 0);
    assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, &first), 0);
    assert_int_equal(answer.total, PAIRS);
    assert_int_equal(answer.initial, PAIRS);
    assert_int_equal(answer.inside, 0);
    assert_int_equal(first.flags, PCCD_PROVED | PCCD_INITIAL);
    assert_true(answer.toi_first == 0 && answer.safe_step == 0 && answer.crowded);
    settings.approach = 0.75; /* the nearest is 1 away, and may come to 0.75 */
    assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, &first), 0);
    assert_int_equal(answer.total, PAIRS);
    assert_int_equal(answer.initial, 0);
    assert_int_equal(answer.inside, PAIRS);
    assert_true((first.flags & PCCD_INSIDE) != 0 && answer.crowded);
    assert_true(answer.toi_first <= 0.5 && answer.toi_first > 0.5 - 2 * CELL);
    settings.approach = 0.25;
    assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, NULL), 0);
    assert_int_equal(answer.total, 0);
    assert_true(answer.safe_step == 1 && !answer.crowded);
    assert_int_equal(move(&pile, 0, 0.5f, &settings, &answer, &first), 0);
    assert_true(answer.initial > 0 && answer.safe_step == 0); /* at a distance of 0 */
    pccd_close(pile.client);
}

/* If it failed, a length that cannot be one would be taken, or one that was refused would
 * count all the same. */
CASE(thick__refuses_what_cannot_be)
{
    const double bad[] = {-1, NAN, INFINITY, -INFINITY};
    const double approaches[] = {-0.25, 1, 2, NAN, INFINITY};
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings};
    struct pccd_step_settings step = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer;
    struct pile pile;

    begin(&pile, test_shared.url);
    assert_int_equal(set_radius(&pile, pile.lower, 0.125), 0);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(set_radius(&pile, pile.lower, bad[i]), PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(pile.client), "radius"));
        settings.what = PCCD_OBJECT_REST_DISTANCE;
        settings.rest_distance = bad[i];
        assert_int_equal(pccd_object_set(pile.client, pile.scene, pile.lower, &settings),
                         PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(pile.client), "rest_distance"));
        step.separation = bad[i];
        assert_int_equal(move(&pile, 1, 1, &step, &answer, NULL), PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(pile.client), "separation"));
    }
    assert_int_equal(set_radius(&pile, pile.lower, 2e18), PCCD_E_LIMIT);
    settings.rest_distance = 2e18;
    assert_int_equal(pccd_object_set(pile.client, pile.scene, pile.lower, &settings),
                     PCCD_E_LIMIT);
    settings.what = PCCD_OBJECT_REST_RINGS;
    settings.rest_rings = 9;
    assert_int_equal(pccd_object_set(pile.client, pile.scene, pile.lower, &settings),
                     PCCD_E_LIMIT);
    step.separation = 2e18;
    assert_int_equal(move(&pile, 1, 1, &step, &answer, NULL), PCCD_E_LIMIT);
    step.separation = 0;
    for (size_t i = 0; i < 5; i++) {
        step.approach = approaches[i];
        assert_int_equal(move(&pile, 1, 1, &step, &answer, NULL), PCCD_E_INVAL);
        assert_non_null(strstr(pccd_error_text(pile.client), "approach"));
    }
    assert_ok(pccd_object_get(pile.client, pile.scene, pile.lower, &settings));
    assert_true(settings.radius == 0.125 && settings.rest_distance == 0 &&
                settings.rest_rings == 0);
    assert_int_equal(set_radius(&pile, pile.lower, 1e18), 0); /* the greatest there is */
    assert_int_equal(move(&pile, 1, 0.5f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.initial, PAIRS);
    pccd_close(pile.client);
}

/* If it failed, who goes where he is told to would touch what he must not, or go nowhere
 * where he could. */
CASE(thick__goes_as_far_as_is_safe)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x0[3][3], x1[3][3], x[3][3] = {{0}};
    struct pccd_motion motion = {
        .count = 3, .format = PCCD_FORMAT_F32, .x0 = x0, .x1 = x1};
    void *to[1] = {x};
    struct pile pile;
    double part = 2;

    begin(&pile, test_shared.url);
    motion.object = pile.upper;
    assert_int_equal(set_radius(&pile, pile.lower, 0.3), 0);
    triangle_at(x0, 1);
    triangle_at(x1, -1);
    assert_ok(pccd_step_safe(pile.client, pile.scene, &motion, 1, &settings, to, &part,
                             &answer));
    assert_int_equal(answer.total, PAIRS);
    assert_true(part > 0.35 - 1e-6 && part < 0.35);
    for (int v = 0; v < 3; v++) {
        assert_true((double)x[v][2] > 0.3 && (double)x[v][2] < 0.3 + 1e-6);
    }
    pccd_answer_release(pile.client, &answer);
    /* Nothing meets where it stands now. */
    assert_ok(pccd_step(pile.client, pile.scene, NULL, 0, NULL, &answer));
    assert_int_equal(answer.total, 0);
    pccd_answer_release(pile.client, &answer);
    triangle_at(x0, 0.25f); /* within the radius: no way, but by an approach */
    assert_ok(pccd_step_safe(pile.client, pile.scene, &motion, 1, &settings, to, &part,
                             &answer));
    pccd_answer_release(pile.client, &answer);
    assert_true(part == 0 && memcmp(x, x0, sizeof x) == 0);
    settings.approach = 0.5;
    assert_ok(pccd_step_safe(pile.client, pile.scene, &motion, 1, &settings, to, &part,
                             &answer));
    assert_int_equal(answer.inside, PAIRS);
    pccd_answer_release(pile.client, &answer);
    assert_true((double)x[0][2] > 0.125 && (double)x[0][2] < 0.125 + 1e-6);
    settings.hold = true; /* would wait for somebody else's step */
    assert_int_equal(pccd_step_safe(pile.client, pile.scene, &motion, 1, &settings, to,
                                    &part, &answer),
                     PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(pile.client), "tried again"));
    settings.hold = false;
    to[0] = NULL;
    assert_int_equal(pccd_step_safe(pile.client, pile.scene, &motion, 1, &settings, to,
                                    &part, &answer),
                     PCCD_E_INVAL);
    pccd_close(pile.client);
}

/* If it failed, a body that is moved by transforms would go into what it must not. */
CASE(thick__goes_as_far_as_is_safe_by_transforms)
{
    static const double m0[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1};
    static const double m1[12] = {0, -1, 0, 0.25, 1, 0, 0, 0, 0, 0, 1, -1};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    double m[12] = {0}, part = 2;
    struct pccd_motion motion = {.count = 3, .m0 = m0, .m1 = m1};
    void *to[1] = {m};
    struct pile pile;

    begin(&pile, test_shared.url);
    motion.object = pile.upper;
    assert_int_equal(set_radius(&pile, pile.lower, 0.3), 0);
    assert_ok(
        pccd_step_safe(pile.client, pile.scene, &motion, 1, NULL, to, &part, &answer));
    assert_true(answer.total > 0);
    pccd_answer_release(pile.client, &answer);
    assert_true(part > 0.35 - 1e-6 && part < 0.35);
    assert_true(m[11] == 1 - 2 * part && m[0] == 1 - part && m[1] == -part);
    assert_ok(pccd_step(pile.client, pile.scene, NULL, 0, NULL, &answer));
    assert_int_equal(answer.total, 0);
    pccd_answer_release(pile.client, &answer);
    motion.m1 = NULL;
    assert_int_equal(
        pccd_step_safe(pile.client, pile.scene, &motion, 1, NULL, to, &part, &answer),
        PCCD_E_INVAL);
    motion.m1 = m;
    assert_int_equal(
        pccd_step_safe(pile.client, pile.scene, &motion, 1, NULL, to, &part, &answer),
        PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(pile.client), "x lies in m0 or m1"));
    pccd_close(pile.client);
}

/* The mesh again, with radii of its vertices. */
static int put_radii(struct pile *pile, const double radii[3])
{
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    float x[3][3];
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = x,
                                        .format = PCCD_FORMAT_F32,
                                        .vertex_count = 3,
                                        .triangle_count = 1,
                                        .triangles = triangle[0],
                                        .radii = radii};

    triangle_at(x, 0);
    return pccd_mesh_put(pile->client, &data, &pile->mesh, NULL);
}

/* If it failed, a cloth with a thick hem would be as thick everywhere, or nowhere. */
CASE(thick__vertices_have_radii)
{
    const double radii[3] = {0.25, 0.125, 0}, bad[3] = {0, -1, 0},
                 large[3] = {0, 0, 2e18};
    struct pccd_answer answer;
    struct pile pile;

    begin(&pile, test_shared.url);
    assert_int_equal(put_radii(&pile, radii), 0);
    assert_int_equal(move(&pile, 1, 0.25f, NULL, &answer, NULL), 0);
    /* The face has 1/4, the edges 1/4, 1/4 and 1/8, the vertices 1/4, 1/8 and 0. All sums
     * are 1/4 at least, which is the height in the end. */
    assert_int_equal(answer.counts[PCCD_VF], 6);
    assert_int_equal(answer.counts[PCCD_EE], 9);
    assert_true(answer.toi_first <= 2.0 / 3 && answer.toi_first > 2.0 / 3 - 2 * CELL);
    assert_int_equal(move(&pile, 1, 0.3125f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.counts[PCCD_VF], 4); /* vertex 2 has 1/4 in all */
    assert_int_equal(answer.counts[PCCD_EE], 8);
    /* An object's own radius takes their place, and gives it back. */
    assert_int_equal(set_radius(&pile, pile.lower, 0.0625), 0);
    assert_int_equal(set_radius(&pile, pile.upper, 0.0625), 0);
    assert_int_equal(move(&pile, 1, 0.3125f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, 0);
    assert_int_equal(set_radius(&pile, pile.lower, 0), 0);
    assert_int_equal(set_radius(&pile, pile.upper, 0), 0);
    assert_int_equal(move(&pile, 1, 0.3125f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, 12);
    assert_int_equal(put_radii(&pile, bad), PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(pile.client), "radius"));
    assert_int_equal(put_radii(&pile, large), PCCD_E_LIMIT);
    assert_int_equal(move(&pile, 1, 0.3125f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, 12); /* as before */
    assert_int_equal(put_radii(&pile, NULL), 0);
    assert_int_equal(move(&pile, 1, 0.3125f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, 0);
    pccd_close(pile.client);
}

static void note_radius(void *context, const struct pccd_object_info *info)
{
    double *radius = context;

    *radius = info->radius > 0 ? info->radius : *radius;
}

/* If it failed, a daemon that takes the place of one that crashed would let everything
 * come nearer than before. */
CASE_DAEMON(thick__comes_back_with_another_daemon, "--supervise", "--threads", "1")
{
    struct pccd_answer answer;
    struct pile pile;
    double listed = 0;

    begin(&pile, test_own.url);
    assert_int_equal(set_radius(&pile, pile.lower, 0.75), 0);
    assert_ok(pccd_list_objects(pile.client, 0, pile.scene, note_radius, &listed));
    assert_true(listed == 0.75);
    assert_int_equal(move(&pile, 1, 0.5f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, PAIRS);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(pile.client), SIGKILL), 0);
    assert_int_equal(move(&pile, 1, 0.5f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, PAIRS);
    assert_true(answer.toi_first <= 0.5 && answer.toi_first > 0.5 - 2 * CELL);
    pccd_close(pile.client);
    (void)test_daemon_end(&test_own, SIGTERM, 10000);
}

/* If it failed, a session with thickness would be repeated without it, found right though
 * it is not, or be read by a program that knows of none. */
CASE(thick__is_recorded_repeated_and_verified)
{
    const struct pccd_record_settings kept = {.contacts = 1};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_object_settings rest = {
        .struct_bytes = sizeof rest, .what = PCCD_OBJECT_REST_RINGS, .rest_rings = 2};
    struct pccd_answer answer;
    struct pile pile = {.client = test_client_at(test_shared.url)};
    char said[4096];

    test_recording_clear();
    assert_ok(pccd_record_start(pile.client, test_recording, &kept));
    make(&pile);
    assert_int_equal(move(&pile, 1, 0.5f, NULL, &answer, NULL), 0);
    assert_int_equal(set_radius(&pile, pile.lower, 0.25), 0);
    assert_ok(pccd_object_set(pile.client, pile.scene, pile.lower, &rest));
    settings.separation = 0.5;
    assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, NULL), 0);
    assert_int_equal(answer.total, PAIRS);
    settings.separation = 1; /* within it at first */
    assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, NULL), 0);
    assert_int_equal(answer.initial, PAIRS);
    settings.approach = 0.75;
    assert_int_equal(move(&pile, 1, 0.5f, &settings, &answer, NULL), 0);
    assert_int_equal(answer.inside, PAIRS);
    assert_int_equal(move(&pile, 1, 0.375f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, 0); /* the separation was of one step */
    assert_int_equal(set_radius(&pile, pile.lower, 0), 0);
    assert_int_equal(put_radii(&pile, (const double[3]){0.25, 0.125, 0}), 0);
    assert_int_equal(move(&pile, 1, 0.3125f, NULL, &answer, NULL), 0);
    assert_int_equal(answer.total, 12);
    pccd_close(pile.client);
    assert_int_equal(test_recording_repeats("--json", test_recording, 6), 6);
    assert_int_equal(
        test_recording_repeats("--json --url direct: --method paper", test_recording, 6),
        6);
    assert_ok(
        test_ctl("verify", "--sample 1000 --json", test_recording, said, sizeof said));
    assert_int_equal(test_ctl_number(said, "contacts"), 3 * PAIRS + 12);
    assert_in_range(test_ctl_number(said, "non_contacts"), 2 * PAIRS, 5000);
}

#define KNOT 1500u /* vertices, each of which an edge joins with each other one */

/* The triangles i, j, j + 1 have the edges of a knot; other vertices have none, so that
 * lists of neighbours are short on average. The mesh in a scene. */
static void make_knot(struct test_raw *raw, struct proto_OBJECT_SET_request *set)
{
    const uint32_t vertices = KNOT * KNOT / 128;
    uint32_t(*triangles)[3] = calloc(KNOT * KNOT / 2, sizeof *triangles);
    float(*x)[3] = calloc(vertices, sizeof *x);
    uint32_t mesh, count = 0;

    assert_true(triangles != NULL && x != NULL);
    for (uint32_t i = 0; i < KNOT; i++) {
        x[i][0] = (float)i;
        x[i][1] = (float)(i * i % 1009);
        for (uint32_t j = i + 1; j + 1 < KNOT; j += 2, count++) {
            memcpy(triangles[count], (uint32_t[3]){i, j, j + 1}, sizeof triangles[0]);
        }
    }
    assert_ok(test_raw_scene(raw, "", &set->scene));
    assert_ok(test_raw_mesh(raw, (const float(*)[3])x, vertices,
                            (const uint32_t(*)[3])triangles, count, &mesh));
    assert_ok(test_raw_add(raw, set->scene, mesh, &set->object));
    free(triangles);
    free(x);
}

/* If it failed, to ask which vertices few edges join would keep a thread of the daemon
 * for long, whoever does not want to know it any more. */
CASE(thick__rings_are_not_looked_for_to_the_end_if_cancelled)
{
    static struct test_raw raw;
    struct proto_OBJECT_SET_request set = {.what = PCCD_OBJECT_REST_RINGS |
                                                   PCCD_OBJECT_RADIUS,
                                           .radius = 1,
                                           .rest_rings = 2};
    struct proto_OBJECT_SET_result is = {.radius = -1};
    uint32_t id;

    if (test_is_direct()) {
        test_skip("without a daemon it is done before the cancel is sent");
    }
    assert_ok(test_raw_session(&raw, test_shared.socket, 2, 8 << 20));
    make_knot(&raw, &set);
    id = test_raw_request(&raw, PROTO_METHOD_OBJECT_SET, &set);
    assert_true(id != 0);
    test_sleep_ms(50); /* it has begun */
    assert_true(RAW_SEND(&raw, CANCEL, .id = id) != 0);
    assert_int_equal(test_raw_answer(&raw, id, PROTO_METHOD_OBJECT_SET, NULL),
                     PCCD_E_CANCELLED);
    set.what = 0; /* nothing has changed */
    assert_ok(test_raw_call(&raw, PROTO_METHOD_OBJECT_SET, &set, &is));
    assert_true(is.radius == 0 && is.rest_rings == 0);
    test_raw_close(&raw);
}

CASES_WITH(test_recording_start, test_recording_stop);
