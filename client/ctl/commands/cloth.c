/* cloth.c - a cloth that falls over a turning ball and passes through nothing. */
#include "cloth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "link.h"

#define CLOTH_WIDTH         2.0  /* of the square */
#define CLOTH_HEIGHT        0.75 /* above the ball's centre at the start */
#define VERTEX_MASS         1e-4 /* kilograms: half a kilogram of cloth */
#define GRAVITY             9.81 /* metres per second squared */
#define FRAME_SECONDS       0.01
#define SMALL_STEPS         10   /* per frame */
#define AIR_DRAG            0.6  /* share of the speed lost per second */
#define FRICTION            0.3  /* tangential over normal displacement */
#define GAP                 1e-3 /* to which features are pushed apart that meet */
#define SHEAR_COMPLIANCE    2e-4
#define BEND_COMPLIANCE     4e-2
#define ROUGHNESS           1e-3 /* unevenness of the start, so that it folds */
#define SPIN_DELAY_FRAMES   60   /* the ball stands still until the cloth lies on it */
#define SPIN_QUARTER_FRAMES 16   /* then it swings to and fro: a quarter of the period */
#define SPIN_MAX            4.0  /* radians per second */
#define RIGID_BYTES         (2 * 12 * sizeof(double)) /* payload of a rigid segment */
#define PUSHES              12u /* times that contacts of a frame are pushed apart */
#define TRIES               24u /* then it is cut short; at last nothing moves at all */
#define CUT                 0.9 /* of the time until the first contact */

const struct cloth_counts cloth_counts[CLOTH_MESHES] = {
    {CLOTH_VERTICES, CLOTH_TRIANGLES, CLOTH_EDGES},
    {CLOTH_BALL_VERTICES, CLOTH_BALL_TRIANGLES, CLOTH_BALL_EDGES}};

/* ---- where things are ------------------------------------------------------------- */

static void place_vertex(const struct cloth *cloth, enum cloth_mesh mesh, uint32_t vertex,
                         uint32_t end, double at[3])
{
    if (mesh == CLOTH_SHEET) {
        memcpy(at, (end == 0 ? cloth->x : cloth->end)[vertex], sizeof cloth->x[0]);
        return;
    }
    const float *x = cloth->ball[vertex];
    double c = cloth->turn[end][0], s = cloth->turn[end][1];
    at[0] = c * (double)x[0] + s * (double)x[2];
    at[1] = (double)x[1];
    at[2] = c * (double)x[2] - s * (double)x[0];
}

void cloth_positions(const struct cloth *cloth, enum cloth_mesh mesh, uint32_t end,
                     float (*x)[3])
{
    for (uint32_t i = 0; i < cloth_counts[mesh].vertices; i++) {
        double at[3];
        place_vertex(cloth, mesh, i, end, at);
        for (uint32_t axis = 0; axis < 3; axis++) {
            x[i][axis] = (float)at[axis];
        }
    }
}

/* Round the cloth to the positions that the daemon is told. */
static void round_positions(struct cloth *cloth)
{
    float told[CLOTH_VERTICES][3];
    cloth_positions(cloth, CLOTH_SHEET, 0, told);
    for (uint32_t i = 0; i < 3 * CLOTH_VERTICES; i++) {
        cloth->x[i / 3][i % 3] = (double)told[i / 3][i % 3];
    }
}

/* ---- the two meshes ---------------------------------------------------------------- */

static uint32_t grid_index(int row, int column)
{
    return (uint32_t)(row * CLOTH_SIDE + column);
}

static void build_sheet(struct cloth *cloth)
{
    uint32_t(*triangle)[3] = cloth->triangles[CLOTH_SHEET];
    uint32_t random = 1; /* of Numerical Recipes' generator */
    for (int i = 0; i < CLOTH_VERTICES; i++) {
        int row = i / CLOTH_SIDE, column = i % CLOTH_SIDE;
        double *x = cloth->x[i];
        random = random * 1664525u + 1013904223u;
        x[0] = CLOTH_WIDTH * ((double)column / (CLOTH_SIDE - 1) - 0.5);
        x[1] = CLOTH_HEIGHT + ROUGHNESS * ((double)(random >> 8) / 8388608.0 - 1.0);
        x[2] = CLOTH_WIDTH * ((double)row / (CLOTH_SIDE - 1) - 0.5);
        if (row + 1 < CLOTH_SIDE && column + 1 < CLOTH_SIDE) {
            uint32_t a = grid_index(row, column), b = a + 1;
            uint32_t c = grid_index(row + 1, column), d = c + 1;
            /* Diagonals alternate so that the cloth has no grain. */
            bool is_even = (row + column) % 2 == 0;
            memcpy(*triangle++, (uint32_t[]){a, c, is_even ? d : b}, sizeof *triangle);
            memcpy(*triangle++, (uint32_t[]){is_even ? a : c, d, b}, sizeof *triangle);
        }
    }
}

static void put_on_ball(float x[3], const double from[3])
{
    double length = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
    for (int axis = 0; axis < 3; axis++) {
        x[axis] = (float)(from[axis] / length * CLOTH_BALL_RADIUS);
    }
}

/* The vertex over the middle of an edge: one of [first, *count), made on first use. */
static uint32_t middle_vertex(struct cloth *cloth, uint32_t first, uint32_t *count,
                              uint32_t a, uint32_t b)
{
    double sum[3];
    float x[3];
    uint32_t i = first;
    for (int axis = 0; axis < 3; axis++) {
        sum[axis] = (double)cloth->ball[a][axis] + (double)cloth->ball[b][axis];
    }
    put_on_ball(x, sum);
    while (i < *count && memcmp(cloth->ball[i], x, sizeof x) != 0) {
        i++;
    }
    if (i == *count) {
        memcpy(cloth->ball[(*count)++], x, sizeof x);
    }
    return i;
}

/* An icosahedron whose triangles are split into four again and again. */
static void build_ball(struct cloth *cloth)
{
    static const uint8_t faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10},
                                         {0, 10, 11}, {1, 5, 9},  {5, 11, 4}, {11, 10, 2},
                                         {10, 7, 6},  {7, 1, 8},  {3, 9, 4},  {3, 4, 2},
                                         {3, 2, 6},   {3, 6, 8},  {3, 8, 9},  {4, 9, 5},
                                         {2, 4, 11},  {6, 2, 10}, {8, 6, 7},  {9, 8, 1}};
    uint32_t(*triangles)[3] = cloth->triangles[CLOTH_BALL];
    double golden = (1.0 + sqrt(5.0)) / 2.0;
    uint32_t vertex_count = 12;
    for (uint32_t i = 0; i < 12; i++) {
        /* The corners are (+-1, +-golden, 0) and its two rotations of the axes. */
        double corner[3] = {0, 0, 0};
        corner[i / 4] = i % 2 == 0 ? -1.0 : 1.0;
        corner[(i / 4 + 1) % 3] = i % 4 < 2 ? golden : -golden;
        put_on_ball(cloth->ball[i], corner);
    }
    for (uint32_t i = 0; i < 60; i++) {
        triangles[i / 3][i % 3] = faces[i / 3][i % 3];
    }
    for (uint32_t count = 20; count < CLOTH_BALL_TRIANGLES; count *= 4) {
        uint32_t first = vertex_count;
        for (uint32_t i = count; i-- > 0;) { /* from the back: in place */
            uint32_t v[3], m[3];
            memcpy(v, triangles[i], sizeof v);
            for (uint32_t k = 0; k < 3; k++) {
                m[k] = middle_vertex(cloth, first, &vertex_count, v[k], v[(k + 1) % 3]);
            }
            const uint32_t parts[4][3] = {{v[0], m[0], m[2]},
                                          {m[0], v[1], m[1]},
                                          {m[2], m[1], v[2]},
                                          {m[0], m[1], m[2]}};
            memcpy(triangles[(size_t)i * 4], parts, sizeof parts);
        }
    }
}

/* Springs from every vertex to the one `rows` and `columns` further, if there is one. */
static void add_springs(struct cloth *cloth, int rows, int columns, double compliance)
{
    double across = (double)columns * CLOTH_WIDTH / (CLOTH_SIDE - 1);
    double along = (double)rows * CLOTH_WIDTH / (CLOTH_SIDE - 1);
    for (int i = 0; i < CLOTH_VERTICES; i++) {
        int row = i / CLOTH_SIDE + rows, column = i % CLOTH_SIDE + columns;
        if (row < CLOTH_SIDE && column >= 0 && column < CLOTH_SIDE) {
            cloth->springs[cloth->spring_count++] =
                (struct cloth_spring){.a = (uint32_t)i,
                                      .b = grid_index(row, column),
                                      .length = sqrt(across * across + along * along),
                                      .compliance = compliance};
        }
    }
}

struct cloth *cloth_new(void)
{
    struct cloth *cloth = calloc(1, sizeof *cloth);
    if (cloth != NULL) {
        cloth->turn[0][0] = cloth->turn[1][0] = 1.0;
        build_sheet(cloth);
        round_positions(cloth);
        build_ball(cloth);
        memcpy(cloth->end, cloth->x, sizeof cloth->end);
        add_springs(cloth, 0, 1, 0.0);
        add_springs(cloth, 1, 0, 0.0);
        add_springs(cloth, 1, 1, SHEAR_COMPLIANCE);
        add_springs(cloth, 1, -1, SHEAR_COMPLIANCE);
        add_springs(cloth, 0, 2, BEND_COMPLIANCE);
        add_springs(cloth, 2, 0, BEND_COMPLIANCE);
    }
    return cloth;
}

/* ---- motion ------------------------------------------------------------------------ */

/* Radians per second in the frame at hand: a triangular wave, so that the cloth, which
 * lags behind, slips over the ball again and again without being carried off it. */
static double spin(const struct cloth *cloth)
{
    if (cloth->frame < SPIN_DELAY_FRAMES) {
        return 0.0;
    }
    uint64_t phase = (cloth->frame - SPIN_DELAY_FRAMES) % (4 * SPIN_QUARTER_FRAMES);
    double quarters = (double)phase / SPIN_QUARTER_FRAMES;
    return SPIN_MAX * (quarters > 3.0   ? quarters - 4.0
                       : quarters > 1.0 ? 2.0 - quarters
                                        : quarters);
}

/* The ball turns by the share of the frame that is left. */
static void turn_ball(struct cloth *cloth)
{
    /* Rational rotation: tan(angle / 2) is close enough to angle / 2 for a small angle,
     * and the result is a rotation for any value. */
    double half = cloth->share * spin(cloth) * FRAME_SECONDS / 2.0;
    double norm = 1.0 + half * half;
    double c = (1.0 - half * half) / norm;
    double s = 2.0 * half / norm;
    double turned_cos = cloth->turn[0][0] * c - cloth->turn[0][1] * s;
    double turned_sin = cloth->turn[0][1] * c + cloth->turn[0][0] * s;
    double length = sqrt(turned_cos * turned_cos + turned_sin * turned_sin);
    cloth->turn[1][0] = turned_cos / length;
    cloth->turn[1][1] = turned_sin / length;
}

static void fall(struct cloth *cloth, double dt)
{
    double keep = 1.0 - AIR_DRAG * dt;
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        cloth->v[i][1] -= GRAVITY * dt;
        for (uint32_t axis = 0; axis < 3; axis++) {
            cloth->end[i][axis] += cloth->v[i][axis] * keep * dt;
        }
    }
}

static void pull(struct cloth *cloth, double dt)
{
    const double inverse_mass = 1.0 / VERTEX_MASS;
    for (uint32_t i = 0; i < cloth->spring_count; i++) {
        const struct cloth_spring *spring = &cloth->springs[i];
        double *a = cloth->end[spring->a];
        double *b = cloth->end[spring->b];
        double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        if (length <= 0.0) {
            continue;
        }
        double stiffness = 2.0 * inverse_mass + spring->compliance / (dt * dt);
        double pull = inverse_mass * (length - spring->length) / (stiffness * length);
        for (uint32_t axis = 0; axis < 3; axis++) {
            a[axis] += pull * d[axis];
            b[axis] -= pull * d[axis];
        }
    }
}

/* Move cloth and ball to where they would be at the end of the frame if nothing were in
 * the way. */
static void predict(struct cloth *cloth)
{
    const double dt = FRAME_SECONDS / SMALL_STEPS;
    memcpy(cloth->end, cloth->x, sizeof cloth->end);
    memset(cloth->push, 0, sizeof cloth->push);
    for (uint32_t step = 0; step < SMALL_STEPS; step++) {
        memcpy(cloth->start, cloth->end, sizeof cloth->start);
        fall(cloth, dt);
        pull(cloth, dt);
        for (uint32_t i = 0; i < 3 * CLOTH_VERTICES; i++) {
            double way = cloth->end[i / 3][i % 3] - cloth->start[i / 3][i % 3];
            cloth->v[i / 3][i % 3] = way / dt;
        }
    }
    cloth->share = 1.0;
    turn_ball(cloth);
}

/* End the frame earlier: after `share` of its time, 0 .. 1. */
static void shorten(struct cloth *cloth, double share)
{
    for (uint32_t i = 0; i < 3 * CLOTH_VERTICES; i++) {
        double x = cloth->x[i / 3][i % 3], *end = &cloth->end[i / 3][i % 3];
        *end = x + share * (*end - x);
        cloth->v[i / 3][i % 3] *= share;
    }
    cloth->share *= share;
    turn_ball(cloth);
}

/* Go to the end of the frame; the next one begins there. */
static void take(struct cloth *cloth)
{
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        double out = 0.0, size = 0.0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            cloth->v[i][axis] += cloth->push[i][axis] / FRAME_SECONDS;
            out += cloth->v[i][axis] * cloth->push[i][axis];
            size += cloth->push[i][axis] * cloth->push[i][axis];
        }
        /* What was pushed aside does not fly off: nothing is elastic here. */
        for (uint32_t axis = 0; axis < 3 && out > 0.0; axis++) {
            cloth->v[i][axis] -= out / size * cloth->push[i][axis];
        }
    }
    memcpy(cloth->x, cloth->end, sizeof cloth->x);
    round_positions(cloth);
    memcpy(cloth->turn[0], cloth->turn[1], sizeof cloth->turn[0]);
    cloth->frame++;
}

/* ---- contacts ---------------------------------------------------------------------- */

/* A vertex of a contact, and its part in the distance from feature b to feature a. */
struct corner {
    enum cloth_mesh mesh;
    uint32_t vertex;
    double weight;
};

/* Those of feature a first. Returns how many it has. */
static uint32_t find_corners(const struct cloth *cloth,
                             const struct pccd_contact *contact, struct corner corners[4])
{
    const uint32_t sheet = cloth->objects[CLOTH_SHEET];
    const enum cloth_mesh a = contact->object_a == sheet ? CLOTH_SHEET : CLOTH_BALL;
    const enum cloth_mesh b = contact->object_b == sheet ? CLOTH_SHEET : CLOTH_BALL;
    double p = (double)contact->param[0], q = (double)contact->param[1];
    if (contact->kind == PCCD_VF) {
        const uint32_t *face = cloth->triangles[b][contact->feature_b];
        corners[0] = (struct corner){a, contact->feature_a, 1.0};
        corners[1] = (struct corner){b, face[0], p + q - 1.0};
        corners[2] = (struct corner){b, face[1], -p};
        corners[3] = (struct corner){b, face[2], -q};
        return 1;
    }
    const struct pccd_edge *first = &cloth->edges[a][contact->feature_a];
    const struct pccd_edge *second = &cloth->edges[b][contact->feature_b];
    corners[0] = (struct corner){a, first->a, 1.0 - p};
    corners[1] = (struct corner){a, first->b, p};
    corners[2] = (struct corner){b, second->a, q - 1.0};
    corners[3] = (struct corner){b, second->b, -q};
    return 2;
}

void cloth_push(struct cloth *cloth, const struct pccd_contact *contact)
{
    struct corner corners[4];
    double gap = 0.0, sum = 0.0, along = 0.0, slip = 0.0, slide[3] = {0, 0, 0};
    find_corners(cloth, contact, corners);
    for (uint32_t i = 0; i < 4; i++) {
        double weight = corners[i].weight, from[3], to[3];
        place_vertex(cloth, corners[i].mesh, corners[i].vertex, 0, from);
        place_vertex(cloth, corners[i].mesh, corners[i].vertex, 1, to);
        sum += corners[i].mesh == CLOTH_SHEET ? weight * weight : 0.0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            gap += weight * to[axis] * (double)contact->normal[axis];
            slide[axis] += weight * (to[axis] - from[axis]);
        }
    }
    double depth = GAP - gap;
    if (depth <= 0.0 || sum <= 0.0) {
        return; /* an earlier push has done it */
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        along += slide[axis] * (double)contact->normal[axis];
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        slide[axis] -= along * (double)contact->normal[axis];
        slip += slide[axis] * slide[axis];
    }
    slip = sqrt(slip);
    double hold = FRICTION * depth >= slip ? 1.0 : FRICTION * depth / slip;
    for (uint32_t i = 0; i < 4; i++) {
        double share = corners[i].weight / sum;
        /* The ball gives way to nothing. */
        for (uint32_t axis = 0; axis < 3 && corners[i].mesh == CLOTH_SHEET; axis++) {
            double push =
                share * (depth * (double)contact->normal[axis] - hold * slide[axis]);
            cloth->end[corners[i].vertex][axis] += push;
            cloth->push[corners[i].vertex][axis] += push;
        }
    }
}

void cloth_locate(const struct cloth *cloth, const struct pccd_contact *contact,
                  float at[3])
{
    struct corner corners[4];
    double sum[3] = {0, 0, 0};
    for (uint32_t i = find_corners(cloth, contact, corners); i < 4; i++) {
        double x[3];
        place_vertex(cloth, corners[i].mesh, corners[i].vertex, 0, x);
        for (uint32_t axis = 0; axis < 3; axis++) {
            sum[axis] -= corners[i].weight * x[axis];
        }
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        at[axis] = (float)sum[axis];
    }
}

/* ---- what the daemon is told and asked --------------------------------------------- */

void cloth_ball_pose(const struct cloth *cloth, uint32_t end, double pose[12])
{
    const double c = cloth->turn[end][0], s = cloth->turn[end][1];
    const double rows[12] = {c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0};
    memcpy(pose, rows, sizeof rows);
}

static int fail(const struct cloth *cloth, int status, const char *what,
                struct ctl_error *error)
{
    const char *text = pccd_error_text(cloth->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

int cloth_register(struct cloth *cloth, struct pccd_client *client,
                   struct ctl_error *error)
{
    static const char *const names[CLOTH_MESHES] = {"cloth", "ball"};
    cloth->client = client;
    int status = pccd_scene_create(client, NULL, &cloth->scene);
    for (int i = 0; i < CLOTH_MESHES && status == PCCD_OK; i++) {
        const struct cloth_counts *counts = &cloth_counts[i];
        float x[CLOTH_VERTICES][3];
        uint32_t mesh = 0;
        cloth_positions(cloth, (enum cloth_mesh)i, 0, x);
        status = pccd_mesh_create(client, x, PCCD_FORMAT_F32, counts->vertices,
                                  (const uint32_t(*)[3])cloth->triangles[i],
                                  counts->triangles, &mesh, NULL);
        if (status == PCCD_OK) {
            status = pccd_mesh_edges(client, mesh, cloth->edges[i], counts->edges);
        }
        if (status == PCCD_OK) {
            status = pccd_scene_add(client, cloth->scene, mesh, &cloth->objects[i]);
        }
        if (status == PCCD_OK) {
            status = ctl_name_object(client, cloth->scene, cloth->objects[i], names[i]);
        }
    }
    return status == PCCD_OK ? PCCD_OK
                             : fail(cloth, status, "a mesh was not accepted", error);
}

/* Ask what is met on the way from the one end of the frame to the other. */
static int ask(struct cloth *cloth, struct pccd_answer *answer, struct ctl_error *error)
{
    const uint64_t bytes = 2 * sizeof(float[CLOTH_VERTICES][3]) + RIGID_BYTES;
    struct pccd_step_settings settings = {
        .struct_bytes = sizeof(struct pccd_step_settings), .threads = cloth->threads};
    struct pccd_frame frame;
    double poses[2][12];
    void *x0, *x1;
    uint64_t step;
    cloth_ball_pose(cloth, 0, poses[0]);
    cloth_ball_pose(cloth, 1, poses[1]);
    int status = pccd_frame_begin(cloth->client, cloth->scene, 2, bytes, &frame);
    if (status != PCCD_OK) {
        return fail(cloth, status, "no slot for a step", error);
    }
    status = pccd_frame_x0x1(&frame, cloth->objects[CLOTH_SHEET], PCCD_FORMAT_F32, 0,
                             CLOTH_VERTICES, &x0, &x1);
    if (status == PCCD_OK) {
        status = pccd_frame_rigid(&frame, cloth->objects[CLOTH_BALL], 0,
                                  CLOTH_BALL_VERTICES, poses[0], poses[1]);
    }
    if (status != PCCD_OK) {
        pccd_frame_abort(&frame);
        return fail(cloth, status, "a step could not be written", error);
    }
    cloth_positions(cloth, CLOTH_SHEET, 0, x0);
    cloth_positions(cloth, CLOTH_SHEET, 1, x1);
    status = pccd_frame_commit(&frame, &settings, &step);
    if (status == PCCD_OK) {
        status = pccd_wait(cloth->client, step, -1, answer);
    }
    return status == PCCD_OK ? PCCD_OK : fail(cloth, status, "a step failed", error);
}

int cloth_frame(struct cloth *cloth, cloth_fn tell, void *context,
                struct ctl_error *error)
{
    bool is_free = false;
    predict(cloth);
    for (uint32_t i = 0; !is_free; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        int status = ask(cloth, &answer, error);
        if (status != PCCD_OK) {
            return status;
        }
        is_free = answer.total == 0 && answer.incomplete == PCCD_COMPLETE;
        for (uint64_t k = 0; i < PUSHES && k < answer.count; k++) {
            cloth_push(cloth, &answer.contacts[k]);
        }
        if (!is_free && i >= PUSHES) {
            cloth->cut += i == PUSHES;
            shorten(cloth, i < TRIES ? CUT * answer.toi_first : 0.0);
        }
        tell(context, &answer, is_free);
        pccd_answer_release(cloth->client, &answer);
        if (!is_free && i > TRIES) { /* the way that does not move was not free */
            return ctl_error_set(error, PCCD_E_INTERNAL,
                                 "what does not move is said to meet something");
        }
    }
    take(cloth);
    return PCCD_OK;
}
