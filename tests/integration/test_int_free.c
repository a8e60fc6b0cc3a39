/* test_int_free.c - edges and points that no triangle has, through a real daemon. */
#include "cases.h"

#include <signal.h>

#include "daemon.h"
#include "fixture.h"
#include "format.h"
#include "must.h"
#include "recording.h"
#include "run_ctl.h"

/* Mesh that lies below: a triangle, a rod of two edges and a point. */
#define BELOW 7u
static const double below[BELOW][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {10, 0, 0},
                                       {11, 0, 0}, {12, 0, 0}, {20, 0, 0}};
static const uint32_t triangles[1][3] = {{0, 1, 2}};
static const uint32_t edges[2][2] = {{4, 3}, {4, 5}};
static const uint32_t points[2] = {6, 0}; /* a corner is a vertex of the triangle */

/* Above: a point over each of them, and a rod across the rod, of its own. */
#define ABOVE 5u

struct play {
    struct pccd_client *client;
    uint32_t scene;
    uint32_t mesh[2]; /* below, above */
    uint32_t object[2];
};

static void above_at(double x[ABOVE][3], double height)
{
    const double at[ABOVE][3] = {{0.25, 0.25, height},
                                 {10.5, 0, height},
                                 {20, 0, height},
                                 {11.5, -1, height},
                                 {11.5, 1, height}};

    memcpy(x, at, sizeof at);
}

static struct pccd_mesh_data data_below(void)
{
    return (struct pccd_mesh_data){.struct_bytes = sizeof(struct pccd_mesh_data),
                                   .x = below,
                                   .format = PCCD_FORMAT_F64,
                                   .vertex_count = BELOW,
                                   .triangle_count = 1,
                                   .triangles = triangles[0],
                                   .edges = edges[0],
                                   .points = points,
                                   .edge_count = 2,
                                   .point_count = 2};
}

static struct pccd_mesh_data data_above(const double x[ABOVE][3])
{
    static const uint32_t rod[1][2] = {{3, 4}};
    static const uint32_t cloud[3] = {2, 0, 1};

    return (struct pccd_mesh_data){.struct_bytes = sizeof(struct pccd_mesh_data),
                                   .x = x,
                                   .format = PCCD_FORMAT_F64,
                                   .vertex_count = ABOVE,
                                   .edges = rod[0],
                                   .points = cloud,
                                   .edge_count = 1,
                                   .point_count = 3};
}

static void add(struct play *play, int which, const struct pccd_mesh_data *data)
{
    assert_ok(pccd_mesh_put(play->client, data, &play->mesh[which], NULL));
    play->object[which] = test_object(play->client, play->scene, play->mesh[which]);
}

static void begin(struct play *play, const char *url,
                  const struct pccd_scene_settings *settings)
{
    const struct pccd_mesh_data data = data_below();
    double x[ABOVE][3];

    *play = (struct play){.client = test_client_at(url)};
    assert_ok(pccd_scene_create(play->client, settings, &play->scene));
    above_at(x, 2);
    const struct pccd_mesh_data above = data_above((const double(*)[3])x);
    add(play, 0, &data);
    add(play, 1, &above);
}

/* The cloud goes from `from` to `to`. The records go to contacts[8]. */
static struct pccd_answer move(struct play *play, double from, double to,
                               double separation, struct pccd_contact *contacts)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    double x0[ABOVE][3], x1[ABOVE][3];
    const struct pccd_motion motion = {.object = play->object[1],
                                       .count = ABOVE,
                                       .format = PCCD_FORMAT_F64,
                                       .x0 = x0,
                                       .x1 = x1};
    uint64_t step;

    above_at(x0, from);
    above_at(x1, to);
    settings.separation = separation;
    assert_ok(pccd_submit(play->client, play->scene, &motion, 1, &settings, &step));
    assert_ok(pccd_wait(play->client, step, -1, &answer));
    assert_in_range(answer.count, 0, 8);
    if (contacts != NULL && answer.count > 0) {
        memcpy(contacts, answer.contacts, answer.count * sizeof *contacts);
    }
    pccd_answer_release(play->client, &answer);
    return answer;
}

static void note_mesh(void *context, const struct pccd_registered_mesh *info)
{
    struct pccd_registered_mesh *meshes = context;

    meshes[meshes[0].mesh != 0] = *info;
}

/* If it failed, a kind would be lost or invented on its way to a client, or a point that
 * keeps no distance be tested. */
CASE(free__meets_in_every_kind)
{
    struct pccd_contact contacts[8];
    struct pccd_mesh_info info;
    struct play play;

    begin(&play, test_shared.url, NULL);
    const struct pccd_mesh_data data = data_below();
    assert_ok(pccd_mesh_put(play.client, &data, &play.mesh[0], &info));
    assert_int_equal(info.edge_count, 5);
    assert_int_equal(info.free_edge_count, 2);
    assert_int_equal(info.free_point_count, 1);
    assert_int_equal(info.isolated_count, 0);
    struct pccd_registered_mesh listed[2] = {{.mesh = 0}};
    assert_ok(pccd_list_meshes(play.client, 0, note_mesh, listed));
    assert_true(listed[0].edge_count == 2 && listed[0].point_count == 2);
    assert_true(listed[1].edge_count == 1 && listed[1].point_count == 3);
    struct pccd_answer answer = move(&play, 1, -1, 0.25, contacts);
    assert_int_equal(answer.total, 4);
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        assert_int_equal(answer.counts[kind], 1);
        assert_int_equal(contacts[kind].kind, kind);
        assert_true(contacts[kind].toi <= 0.375 && contacts[kind].toi_hi >= 0.375);
        assert_int_equal(answer.counters.candidates[kind] > 0, 1);
    }
    assert_int_equal(contacts[PCCD_VE].object_a, play.object[1]);
    assert_int_equal(contacts[PCCD_VE].feature_a, 1);
    assert_int_equal(contacts[PCCD_VE].object_b, play.object[0]);
    assert_true(contacts[PCCD_VE].param[0] == 0 && contacts[PCCD_VE].param[1] == 0.5F);
    assert_true(contacts[PCCD_VE].normal[2] == 1);
    assert_int_equal(contacts[PCCD_VV].object_a, play.object[0]);
    assert_int_equal(contacts[PCCD_VV].feature_a, 6);
    assert_int_equal(contacts[PCCD_VV].feature_b, 2);
    answer = move(&play, 1, -1, 0, contacts);
    assert_int_equal(answer.total, 2);
    assert_true(answer.counts[PCCD_VF] == 1 && answer.counts[PCCD_EE] == 1);
    struct pccd_near_settings nearest = PCCD_NEAR_SETTINGS_INIT;
    nearest.what = PCCD_NEAR_NEAREST;
    nearest.distance = 1;
    assert_ok(pccd_ask_near(play.client, play.scene, NULL, 0, &nearest, &answer));
    assert_true(answer.total == 1 && answer.near[0].kind == PCCD_VF &&
                answer.near[0].d_lo == 1);
    pccd_answer_release(play.client, &answer);
    pccd_close(play.client);
}

static int put(struct play *play, const struct pccd_mesh_data *data, const char *why)
{
    uint32_t mesh = 0;
    int status = pccd_mesh_put(play->client, data, &mesh, NULL);

    assert_non_null(strstr(pccd_error_text(play->client), why));
    return status;
}

/* If it failed, a mesh would be taken that is not what its client meant, or an answer be
 * given that leaves out what the scene has. */
CASE(free__refuses_what_cannot_be)
{
    static const uint32_t bad[2] = {1, BELOW};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_mesh_data data = data_below();
    struct play play;

    begin(&play, test_shared.url, NULL);
    data.points = bad;
    assert_int_equal(put(&play, &data, "point 1 names vertex 7; the mesh has 7 vertices"),
                     PCCD_E_INDEX);
    data.points = NULL;
    assert_int_equal(put(&play, &data, "points is NULL"), PCCD_E_INVAL);
    data = data_below();
    data.edges = bad;
    data.edge_count = 1;
    assert_int_equal(put(&play, &data, "edge 0 names vertex 7; the mesh has 7 vertices"),
                     PCCD_E_INDEX);
    data.edge_count = data.point_count = data.triangle_count = 0;
    assert_int_equal(put(&play, &data, "no triangles"), PCCD_E_INVAL);
    data = data_below();
    data.point_count = UINT32_MAX; /* not the memory of a copy is short */
    assert_int_equal(put(&play, &data, "more than 2147483647"), PCCD_E_INVAL);
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = PCCD_NEAR_DEPTH;
    assert_int_equal(pccd_ask_near(play.client, play.scene, NULL, 0, &settings, &answer),
                     PCCD_E_INVAL);
    assert_non_null(strstr(pccd_error_text(play.client), "is not closed"));
    pccd_close(play.client);
}

/* If it failed, rods and clouds would not be there any more in a daemon that takes the
 * place of one that crashed. */
CASE_DAEMON(free__comes_back_with_another_daemon, "--supervise", "--threads", "1")
{
    struct play play;

    begin(&play, test_own.url, NULL);
    assert_int_equal(move(&play, 1, -1, 0.25, NULL).total, 4);
    assert_int_equal(kill((pid_t)pccd_daemon_pid(play.client), SIGKILL), 0);
    assert_int_equal(move(&play, 1, -1, 0.25, NULL).total, 4);
    pccd_close(play.client);
}

/* ---- recordings -------------------------------------------------------------------- */

static void ask(struct play *play, enum pccd_near_what what, uint64_t count)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    settings.what = what;
    settings.distance = 1;
    assert_ok(pccd_ask_near(play->client, play->scene, NULL, 0, &settings, &answer));
    assert_int_equal(answer.total, count);
    pccd_answer_release(play->client, &answer);
}

/* If it failed, a session would be repeated without its rods and points, found right
 * though it is not, or be read by a program that knows of none. */
CASE(free__is_recorded_repeated_and_verified)
{
    const struct pccd_record_settings kept = {.contacts = 1};
    struct play play;
    char said[4096];

    if (test_is_direct()) {
        test_skip("without a daemon a recording begins before its scenes");
    }
    test_recording_clear();
    begin(&play, test_shared.url, NULL);
    assert_ok(pccd_record_start(play.client, test_recording, &kept));
    const struct pccd_mesh_data data = data_below();
    assert_ok(pccd_mesh_put(play.client, &data, &play.mesh[0], NULL));
    assert_int_equal(move(&play, 1, -1, 0.25, NULL).total, 4);
    assert_int_equal(move(&play, -1, 1, 0, NULL).total, 2);
    ask(&play, PCCD_NEAR_PAIRS, 5); /* one of the rod above and a point beside it */
    ask(&play, PCCD_NEAR_FEATURES, 5);
    ask(&play, PCCD_NEAR_VERTICES, BELOW + ABOVE);
    ask(&play, PCCD_NEAR_CROSSINGS, 0);
    pccd_close(play.client);
    assert_int_equal(test_recording_repeats("--json", test_recording, 6), 6);
    assert_int_equal(
        test_recording_repeats("--json --url direct: --method paper", test_recording, 6),
        6);
    assert_ok(
        test_ctl("verify", "--sample 1000 --json", test_recording, said, sizeof said));
    assert_int_equal(test_ctl_number(said, "contacts"), 6);
    assert_in_range(test_ctl_number(said, "non_contacts"), 1, 5000);
    assert_int_equal(test_ctl_number(said, "nears"), 4);
}

/* If it failed, what others have in a shared scene would be left out of a recording. */
CASE(free__of_others_is_recorded_in_shared_scenes)
{
    const struct pccd_scene_settings shared = {.name = "rods", .share = PCCD_SHARE_OPEN};
    const struct pccd_record_settings kept = {.contacts = 1};
    struct play play;
    struct play other = {.client = test_client_at(test_shared.url)};
    char said[4096];

    test_recording_clear();
    assert_ok(pccd_record_start(other.client, test_recording, &kept));
    assert_ok(pccd_scene_create(other.client, &shared, &other.scene));
    begin(&play, test_shared.url, &shared);
    double x[ABOVE][3];
    above_at(x, 4);
    const struct pccd_mesh_data above = data_above((const double(*)[3])x);
    add(&other, 1, &above);
    assert_int_equal(move(&play, 1, -1, 0.25, NULL).total, 4);
    assert_int_equal(move(&other, 2, 0.125, 0.25, NULL).total, 4);
    pccd_close(other.client);
    pccd_close(play.client);
    assert_int_equal(test_recording_repeats("--json", test_recording, 1), 1);
    assert_ok(
        test_ctl("verify", "--sample 1000 --json", test_recording, said, sizeof said));
    assert_int_equal(test_ctl_number(said, "contacts"), 4);
}

CASES_WITH(test_recording_start, test_recording_stop);
