/* test_ctl_cloth.c - the demo's scene. */
#include "cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloth_scene.h"
#include "pccd.h"

#define FRAMES 100
#define FEW    30 /* some of them with contacts */

static struct cloth_scene *new_scene(void)
{
    struct cloth_scene *scene = NULL;
    struct ctl_error error = {.text = ""};
    assert_int_equal(cloth_scene_new(&scene, &error), 0);
    return scene;
}

/* A closed surface uses each edge once in each direction, so a number that depends on the
 * edge, added for one direction and taken away for the other, comes to zero. */
static int64_t edge_balance(const uint32_t (*triangles)[3], uint32_t count)
{
    int64_t balance = 0;
    for (uint32_t t = 0; t < count; t++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint64_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
            assert_int_not_equal(a, b);
            uint64_t low = a < b ? a : b, high = a < b ? b : a;
            uint64_t mixed = (low << 32 | high) * 0x9e3779b97f4a7c15u;
            balance += a < b ? (int64_t)(mixed >> 24) : -(int64_t)(mixed >> 24);
        }
    }
    return balance;
}

/* If it failed: the ball would have holes or triangles that face inwards. */
CASE(cloth__ball_is_a_closed_sphere)
{
    struct cloth_scene *scene = new_scene();
    for (uint32_t i = 0; i < CLOTH_BALL_VERTICES; i++) {
        const float *x = scene->ball_start[i];
        double length = sqrt((double)x[0] * (double)x[0] + (double)x[1] * (double)x[1] +
                             (double)x[2] * (double)x[2]);
        assert_true(fabs(length - CLOTH_BALL_RADIUS) < 1e-6);
    }
    for (uint32_t t = 0; t < CLOTH_BALL_TRIANGLES; t++) {
        const uint32_t *v = scene->ball_triangles[t];
        double a[3], b[3], out = 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            assert_in_range(v[k], 0, CLOTH_BALL_VERTICES - 1);
            a[k] =
                (double)scene->ball_start[v[1]][k] - (double)scene->ball_start[v[0]][k];
            b[k] =
                (double)scene->ball_start[v[2]][k] - (double)scene->ball_start[v[0]][k];
        }
        for (uint32_t k = 0; k < 3; k++) {
            out += (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]) *
                   (double)scene->ball_start[v[0]][k];
        }
        assert_true(out > 0.0);
    }
    assert_int_equal(
        edge_balance((const uint32_t(*)[3])scene->ball_triangles, CLOTH_BALL_TRIANGLES),
        0);
    cloth_scene_free(scene);
}

/* If it failed: vertices or triangles of the cloth would be missing or doubled. */
CASE(cloth__grid_uses_every_vertex_and_faces_up)
{
    struct cloth_scene *scene = new_scene();
    static uint8_t uses[CLOTH_VERTICES];
    double area = 0.0;
    memset(uses, 0, sizeof uses);
    for (uint32_t t = 0; t < CLOTH_TRIANGLES; t++) {
        const uint32_t *v = scene->cloth_triangles[t];
        for (uint32_t k = 0; k < 3; k++) {
            assert_in_range(v[k], 0, CLOTH_VERTICES - 1);
            uses[v[k]]++;
        }
        const float *a = scene->cloth_start[v[0]], *b = scene->cloth_start[v[1]];
        const float *c = scene->cloth_start[v[2]];
        double up = (double)(b[2] - a[2]) * (double)(c[0] - a[0]) -
                    (double)(b[0] - a[0]) * (double)(c[2] - a[2]);
        assert_true(up > 0.0);
        area += up / 2.0;
    }
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        assert_in_range(uses[i], 1, 8);
    }
    assert_true(fabs(area - 4.0) < 1e-4); /* a square of 2 m */
    cloth_scene_free(scene);
}

/* ---- with a daemon ----------------------------------------------------------------- */

/* Where cloth and ball were after each frame, as they were taken. */
struct way {
    float (*cloth)[CLOTH_VERTICES][3]; /* [FRAMES + 1] */
    double pose[FRAMES + 1][12];
    uint64_t asked, contacts, left, cut;
};

static struct pccd_client *connect_private(void)
{
    struct pccd_client *client = NULL;
    if (pccd_connect(&(struct pccd_options){.private_daemon = true}, &client) !=
        PCCD_OK) {
        fail_msg("%s", pccd_error_text(NULL));
    }
    return client;
}

static void count_answer(void *context, const struct pccd_answer *answer, bool is_taken)
{
    struct way *way = context;
    way->asked++;
    way->contacts += answer->total;
    way->left += is_taken ? answer->total : 0;
}

static void note_place(struct way *way, const struct cloth_scene *cloth, uint32_t frame)
{
    cloth_scene_positions(cloth, 0, way->cloth[frame]);
    cloth_scene_ball_pose(cloth, 0, way->pose[frame]);
}

/* `count` frames of the demo. */
static struct way *walk(struct cloth_hold *hold, uint32_t count)
{
    struct ctl_error error = {.text = ""};
    struct way *way = calloc(1, sizeof *way);
    assert_non_null(way);
    way->cloth = malloc((count + 1) * sizeof *way->cloth);
    assert_non_null(way->cloth);
    if (cloth_hold_init(hold, connect_private(), &error) != PCCD_OK) {
        fail_msg("%s", error.text);
    }
    note_place(way, hold->cloth, 0);
    for (uint32_t frame = 0; frame < count; frame++) {
        if (cloth_hold_frame(hold, count_answer, way, &error) != PCCD_OK) {
            fail_msg("%s", error.text);
        }
        note_place(way, hold->cloth, frame + 1);
    }
    way->cut = hold->cut;
    return way;
}

static void leave(struct cloth_hold *hold, struct way *way)
{
    pccd_close(hold->client);
    cloth_hold_deinit(hold);
    free(way->cloth);
    free(way);
}

/* What is met between two places that were noted, as another scene has it. */
static uint64_t met_between(const struct cloth_hold *fresh, const struct way *way,
                            uint32_t frame)
{
    struct pccd_client *client = fresh->client;
    struct pccd_frame slot;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    void *x0, *x1;
    uint64_t step;
    const uint32_t bytes = 2 * sizeof *way->cloth + 2 * sizeof *way->pose;
    assert_ok(pccd_frame_begin(client, fresh->scene, 2, bytes, &slot));
    assert_ok(pccd_frame_x0x1(&slot, fresh->objects[0].object, PCCD_FORMAT_F32, 0,
                              CLOTH_VERTICES, &x0, &x1));
    assert_ok(pccd_frame_rigid(&slot, fresh->objects[1].object, 0, CLOTH_BALL_VERTICES,
                               way->pose[frame], way->pose[frame + 1]));
    memcpy(x0, way->cloth[frame], sizeof *way->cloth);
    memcpy(x1, way->cloth[frame + 1], sizeof *way->cloth);
    assert_ok(pccd_frame_commit(&slot, NULL, &step));
    assert_ok(pccd_wait(client, step, -1, &answer));
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    uint64_t total = answer.total;
    pccd_answer_release(client, &answer);
    return total;
}

/* If it failed: the demo would show a cloth that passes through the ball or itself,
 * fly off, tear, stand still, or not lie on the ball. */
CASE(cloth__holds_on_every_way_that_it_took)
{
    struct cloth_hold hold, fresh;
    struct ctl_error error = {.text = ""};
    uint32_t near = 0;
    double lowest = 0.0, stretch = 0.0;
    struct way *way = walk(&hold, FRAMES);
    assert_int_equal(way->left, 0);
    assert_true(way->contacts > 10000);
    assert_in_range(way->asked, FRAMES + 1, 8 * FRAMES);
    assert_in_range(way->cut, 0, FRAMES / 10);
    assert_ok(cloth_hold_init(&fresh, connect_private(), &error));
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        assert_int_equal(met_between(&fresh, way, frame), 0);
        assert_memory_not_equal(way->cloth[frame], way->cloth[frame + 1],
                                sizeof *way->cloth);
    }
    pccd_close(fresh.client);
    cloth_hold_deinit(&fresh);
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        const double *x = hold.cloth->x[i];
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        assert_true(isfinite(distance));
        assert_true(distance > 0.99 * CLOTH_BALL_RADIUS && distance < 2.0);
        near += distance < 1.01 * CLOTH_BALL_RADIUS;
        lowest = fmin(lowest, x[1]);
    }
    for (uint32_t i = 0; i < hold.cloth->spring_count; i++) {
        const struct cloth_spring *spring = &hold.cloth->springs[i];
        const double *a = hold.cloth->x[spring->a], *b = hold.cloth->x[spring->b];
        double length =
            sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                 (a[2] - b[2]) * (a[2] - b[2]));
        if (spring->compliance == 0.0) {
            stretch = fmax(stretch, length / spring->length);
        }
    }
    assert_in_range(near, CLOTH_VERTICES / 20, CLOTH_VERTICES);
    assert_true(lowest < -0.3);
    assert_true(stretch < 1.5);
    /* The ball has turned, and not grown. */
    const double *pose = way->pose[FRAMES];
    assert_true(fabs(pose[0] * pose[0] + pose[2] * pose[2] - 1.0) < 1e-12);
    assert_true(pose[8] == -pose[2] && pose[10] == pose[0]);
    assert_true(pose[5] == 1.0 && pose[3] == 0.0 && pose[7] == 0.0 && pose[11] == 0.0);
    assert_true(fabs(pose[2]) > 0.05);
    leave(&hold, way);
}

/* If it failed: two runs of the demo would not print the same hash. */
CASE(cloth__two_runs_give_the_same_bytes)
{
    struct cloth_hold holds[2];
    struct way *ways[2] = {walk(&holds[0], FEW), walk(&holds[1], FEW)};
    assert_int_equal(ways[0]->asked, ways[1]->asked);
    assert_int_equal(ways[0]->contacts, ways[1]->contacts);
    assert_memory_equal(ways[0]->cloth, ways[1]->cloth,
                        (FEW + 1) * sizeof *ways[0]->cloth);
    leave(&holds[0], ways[0]);
    leave(&holds[1], ways[1]);
}

/* If it failed: what is in the way would not be pushed aside, or be pulled. */
CASE(cloth__contact_is_pushed_apart)
{
    struct cloth_scene *scene = new_scene();
    double(*end)[3] = scene->end;
    /* Vertex 0 of the cloth has gone 2 cm below the face of its vertices 5, 6 and 7. */
    struct cloth_contact contact = {.is_vf = true,
                                    .a_is_cloth = true,
                                    .b_is_cloth = true,
                                    .a = {0},
                                    .b = {5, 6, 7},
                                    .param = {0.25, 0.25},
                                    .normal = {0, 1, 0}};
    for (uint32_t i = 5; i < 8; i++) {
        memcpy(end[i], scene->x[i], sizeof end[i]);
        end[i][1] = 1.0;
    }
    end[0][1] = 0.98;
    cloth_scene_push(scene, &contact);
    double gap = end[0][1] - 0.5 * end[5][1] - 0.25 * end[6][1] - 0.25 * end[7][1];
    assert_true(gap > 0.0009 && gap < 0.0011);
    double before = end[0][1];
    cloth_scene_push(scene, &contact); /* they are apart already */
    assert_true(fabs(end[0][1] - before) < 1e-12);
    cloth_scene_free(scene);
}
