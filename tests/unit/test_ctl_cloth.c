/* test_ctl_cloth.c - the demo's scene. */
#include "cases.h"

#include "cloth.h"
#include "pccd.h"

#define FRAMES 100
#define FEW    30 /* some of them with contacts */

static struct cloth *new_cloth(void)
{
    struct cloth *cloth = cloth_new();
    assert_non_null(cloth);
    return cloth;
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
    struct cloth *cloth = new_cloth();
    for (uint32_t i = 0; i < CLOTH_BALL_VERTICES; i++) {
        const float *x = cloth->ball[i];
        double length = sqrt((double)x[0] * (double)x[0] + (double)x[1] * (double)x[1] +
                             (double)x[2] * (double)x[2]);
        assert_true(fabs(length - CLOTH_BALL_RADIUS) < 1e-6);
    }
    for (uint32_t t = 0; t < CLOTH_BALL_TRIANGLES; t++) {
        const uint32_t *v = cloth->triangles[CLOTH_BALL][t];
        double a[3], b[3], out = 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            assert_in_range(v[k], 0, CLOTH_BALL_VERTICES - 1);
            a[k] = (double)cloth->ball[v[1]][k] - (double)cloth->ball[v[0]][k];
            b[k] = (double)cloth->ball[v[2]][k] - (double)cloth->ball[v[0]][k];
        }
        for (uint32_t k = 0; k < 3; k++) {
            out += (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]) *
                   (double)cloth->ball[v[0]][k];
        }
        assert_true(out > 0.0);
    }
    assert_ok(edge_balance((const uint32_t(*)[3])cloth->triangles[CLOTH_BALL],
                           CLOTH_BALL_TRIANGLES));
    free(cloth);
}

/* If it failed: vertices or triangles of the cloth would be missing or doubled. */
CASE(cloth__grid_uses_every_vertex_and_faces_up)
{
    struct cloth *cloth = new_cloth();
    static uint8_t uses[CLOTH_VERTICES];
    double area = 0.0;
    memset(uses, 0, sizeof uses);
    for (uint32_t t = 0; t < CLOTH_TRIANGLES; t++) {
        const uint32_t *v = cloth->triangles[CLOTH_SHEET][t];
        for (uint32_t k = 0; k < 3; k++) {
            assert_in_range(v[k], 0, CLOTH_VERTICES - 1);
            uses[v[k]]++;
        }
        const double *a = cloth->x[v[0]], *b = cloth->x[v[1]], *c = cloth->x[v[2]];
        double up = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
        assert_true(up > 0.0);
        area += up / 2.0;
    }
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        assert_in_range(uses[i], 1, 8);
    }
    assert_true(fabs(area - 4.0) < 1e-4); /* a square of 2 m */
    free(cloth);
}

/* ---- with a daemon ----------------------------------------------------------------- */

/* Positions of cloth and ball after each frame, as they were taken. */
struct way {
    float (*cloth)[CLOTH_VERTICES][3]; /* [FRAMES + 1] */
    double pose[FRAMES + 1][12];
    uint64_t asked, contacts, left;
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

static void note_place(struct way *way, const struct cloth *cloth, uint32_t frame)
{
    cloth_positions(cloth, CLOTH_SHEET, 0, way->cloth[frame]);
    cloth_ball_pose(cloth, 0, way->pose[frame]);
}

static struct cloth *new_registered(void)
{
    struct ctl_error error = {.text = ""};
    struct cloth *cloth = new_cloth();
    if (cloth_register(cloth, connect_private(), &error) != PCCD_OK) {
        fail_msg("%s", error.text);
    }
    return cloth;
}

static void drop(struct cloth *cloth)
{
    pccd_close(cloth->client);
    free(cloth);
}

/* `count` frames of the demo. */
static struct way *walk(struct cloth *cloth, uint32_t count)
{
    struct ctl_error error = {.text = ""};
    struct way *way = test_room(sizeof *way);
    way->cloth = test_room((count + 1) * sizeof *way->cloth);
    note_place(way, cloth, 0);
    for (uint32_t frame = 0; frame < count; frame++) {
        if (cloth_frame(cloth, count_answer, way, &error) != PCCD_OK) {
            fail_msg("%s", error.text);
        }
        note_place(way, cloth, frame + 1);
    }
    return way;
}

static void free_way(struct way *way)
{
    free(way->cloth);
    free(way);
}

/* Return what is met between two places that were noted, as another scene has it. */
static uint64_t met_between(const struct cloth *fresh, const struct way *way,
                            uint32_t frame)
{
    struct pccd_client *client = fresh->client;
    struct pccd_frame slot;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    void *x0, *x1;
    uint64_t step;
    const uint32_t bytes = 2 * sizeof *way->cloth + 2 * sizeof *way->pose;
    assert_int_equal(pccd_frame_begin(client, fresh->scene, 2, bytes, &slot), PCCD_OK);
    assert_int_equal(pccd_frame_x0x1(&slot, fresh->objects[CLOTH_SHEET], PCCD_FORMAT_F32,
                                     0, CLOTH_VERTICES, &x0, &x1),
                     PCCD_OK);
    assert_int_equal(pccd_frame_rigid(&slot, fresh->objects[CLOTH_BALL], 0,
                                      CLOTH_BALL_VERTICES, way->pose[frame],
                                      way->pose[frame + 1]),
                     PCCD_OK);
    memcpy(x0, way->cloth[frame], sizeof *way->cloth);
    memcpy(x1, way->cloth[frame + 1], sizeof *way->cloth);
    assert_int_equal(pccd_frame_commit(&slot, NULL, &step), PCCD_OK);
    assert_int_equal(pccd_wait(client, step, -1, &answer), PCCD_OK);
    assert_int_equal(answer.incomplete, PCCD_COMPLETE);
    uint64_t total = answer.total;
    pccd_answer_release(client, &answer);
    return total;
}

/* If it failed: the demo would show a cloth that passes through the ball or itself,
 * fly off, tear, stand still, or not lie on the ball. */
CASE(cloth__holds_on_every_way_that_it_took)
{
    struct cloth *cloth = new_registered(), *fresh = new_registered();
    uint32_t near = 0;
    double lowest = 0.0, stretch = 0.0;
    struct way *way = walk(cloth, FRAMES);
    assert_int_equal(way->left, 0);
    assert_true(way->contacts > 10000);
    assert_in_range(way->asked, FRAMES + 1, 8 * FRAMES);
    assert_in_range(cloth->cut, 0, FRAMES / 10);
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        assert_int_equal(met_between(fresh, way, frame), 0);
        assert_memory_not_equal(way->cloth[frame], way->cloth[frame + 1],
                                sizeof *way->cloth);
    }
    drop(fresh);
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        const double *x = cloth->x[i];
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        assert_true(isfinite(distance));
        assert_true(distance > 0.99 * CLOTH_BALL_RADIUS && distance < 2.0);
        near += distance < 1.01 * CLOTH_BALL_RADIUS;
        lowest = fmin(lowest, x[1]);
    }
    for (uint32_t i = 0; i < cloth->spring_count; i++) {
        const struct cloth_spring *spring = &cloth->springs[i];
        const double *a = cloth->x[spring->a], *b = cloth->x[spring->b];
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
    free_way(way);
    drop(cloth);
}

/* If it failed: two runs of the demo would not print the same hash. */
CASE(cloth__two_runs_give_the_same_bytes)
{
    struct cloth *cloths[2] = {new_registered(), new_registered()};
    struct way *ways[2] = {walk(cloths[0], FEW), walk(cloths[1], FEW)};
    assert_int_equal(ways[0]->asked, ways[1]->asked);
    assert_int_equal(ways[0]->contacts, ways[1]->contacts);
    assert_memory_equal(ways[0]->cloth, ways[1]->cloth,
                        (FEW + 1) * sizeof *ways[0]->cloth);
    for (int i = 0; i < 2; i++) {
        free_way(ways[i]);
        drop(cloths[i]);
    }
}

/* If it failed: what is in the way would not be pushed aside, or be pulled, or be shown
 * elsewhere. */
CASE(cloth__contact_is_pushed_apart)
{
    struct cloth *cloth = new_cloth();
    double(*end)[3] = cloth->end;
    /* Vertex 0 of the cloth has gone 2 cm below a face of the cloth. */
    const uint32_t face = 300, *corners = cloth->triangles[CLOTH_SHEET][face];
    const struct pccd_contact contact = {
        .kind = PCCD_VF, .feature_b = face, .param = {0.25f, 0.25f}, .normal = {0, 1, 0}};
    float at[3];
    for (uint32_t i = 0; i < 3; i++) {
        end[corners[i]][1] = 1.0;
    }
    end[0][1] = 0.98;
    cloth_push(cloth, &contact);
    double gap = end[0][1] - 0.5 * end[corners[0]][1] - 0.25 * end[corners[1]][1] -
                 0.25 * end[corners[2]][1];
    assert_true(gap > 0.0009 && gap < 0.0011);
    double before = end[0][1];
    cloth_push(cloth, &contact); /* they are apart already */
    assert_true(fabs(end[0][1] - before) < 1e-12);
    cloth_locate(cloth, &contact, at);
    for (uint32_t k = 0; k < 3; k++) {
        double middle = 0.5 * cloth->x[corners[0]][k] + 0.25 * cloth->x[corners[1]][k] +
                        0.25 * cloth->x[corners[2]][k];
        assert_true(fabs((double)at[k] - middle) < 1e-6);
    }
    free(cloth);
}
