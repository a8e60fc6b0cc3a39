/* late.c - how long after its deadline, or its cancel, the answer of a large step comes.
 *
 * Each scene is one of the worst for some phase of a step. A ping beside such a step says
 * how much of the time is that of sockets and processors.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "asker.h"
#include "prng.h"
#include "sections.h"

#define PI            3.14159265358979323846
#define JOINTS_MAX    4000u
#define BODIES_MAX    2000u
#define SCENES        1000u /* of a batch, at most */
#define ANGLE_MOST    (0x1p20 * 2 * PI)
#define PAUSE_MOST_NS 100000000u /* of a step that takes longer */
#define SETTLE_NS     20000000u  /* in which a step takes along what is held */

struct late {
    struct pccd_client *client;
    struct prng prng;
    uint32_t scene, count; /* of motions */
    struct pccd_motion motions[BODIES_MAX];
    struct pccd_joint joints[JOINTS_MAX];
    uint32_t joint_count;
    struct pccd_step_settings settings;
    double (*x1[2])[3]; /* of bodies that deform, in turn; NULL: none does */
    uint32_t turn;
    struct pccd_batch *batch; /* of scenes like `scene`; NULL: that one alone */
    uint32_t scene_count;     /* of the batch */
    uint32_t scenes[SCENES];  /* its, but for the first */
    struct late *other;       /* member of the scene, whose steps take along what this
                                 one holds; NULL: none does */
    uint64_t other_step;
    struct pccd_near_settings near; /* of a question in the place of a step, if .. */
    bool asks;                      /* .. it is one */
};

/* ---- bodies ------------------------------------------------------------------------ */

struct shape {
    double (*x)[3];
    uint32_t (*faces)[3];
    uint32_t vertices, triangles;
};

/* A sheet of side * side cells over [-1, 1], at the height 0. */
static struct shape make_sheet(uint32_t side)
{
    struct shape shape = {.vertices = (side + 1) * (side + 1),
                          .triangles = 2 * side * side};
    shape.x = bench_alloc(shape.vertices, sizeof *shape.x);
    shape.faces = bench_alloc(shape.triangles, sizeof *shape.faces);
    for (uint32_t v = 0; v < shape.vertices; v++) {
        shape.x[v][0] = 2.0 * (v / (side + 1)) / side - 1;
        shape.x[v][1] = 2.0 * (v % (side + 1)) / side - 1;
        shape.x[v][2] = 0;
    }
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t v = i / side * (side + 1) + i % side;
        const uint32_t cell[2][3] = {{v, v + 1, v + side + 1},
                                     {v + 1, v + side + 2, v + side + 1}};
        memcpy(shape.faces[2 * i], cell, sizeof cell);
    }
    return shape;
}

/* The same around the axis z, of radius 1 and with its ends open, and a rough surface. */
static struct shape make_roll(uint32_t side)
{
    struct shape shape = make_sheet(side);
    for (uint32_t v = 0; v < shape.vertices; v++) {
        double *x = shape.x[v];
        double angle = 3.14 * x[0];
        double radius = 1 + 0.01 * sin(40 * angle) * sin(40 * x[1]);
        x[2] = x[1];
        x[0] = radius * cos(angle);
        x[1] = radius * sin(angle);
    }
    return shape;
}

static struct shape make_box(double size)
{
    static const uint32_t corners[12][3] = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5},
                                            {0, 4, 5}, {0, 5, 1}, {2, 3, 7}, {2, 7, 6},
                                            {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    struct shape shape = {.vertices = 8, .triangles = 12};
    shape.x = bench_alloc(8, sizeof *shape.x);
    shape.faces = bench_alloc(12, sizeof *shape.faces);
    for (uint32_t i = 0; i < 24; i++) {
        shape.x[i / 3][i % 3] = i / 3 >> i % 3 & 1 ? size : -size;
    }
    memcpy(shape.faces, corners, sizeof corners);
    return shape;
}

static uint32_t register_shape(struct late *late, const struct shape *shape)
{
    uint32_t mesh;
    bench_must(pccd_mesh_create(late->client, shape->x, PCCD_FORMAT_F64, shape->vertices,
                                (const uint32_t(*)[3])shape->faces, shape->triangles,
                                &mesh, NULL),
               "mesh", late->client);
    return mesh;
}

static void free_shape(struct shape *shape)
{
    free(shape->x);
    free(shape->faces);
}

/* Add an object; the next motion is its, if it moves. */
static uint32_t add(struct late *late, uint32_t mesh)
{
    uint32_t object;
    bench_must(pccd_scene_add(late->client, late->scene, mesh, &object), "object",
               late->client);
    return object;
}

static void turn(struct late *late, uint32_t mesh, uint32_t vertices, uint32_t joint)
{
    late->motions[late->count++] = (struct pccd_motion){
        .object = add(late, mesh), .first = joint, .count = vertices};
}

static uint32_t joint(struct late *late, enum pccd_joint_kind kind, uint32_t parent,
                      const double from[3], const double to[3])
{
    struct pccd_joint *at = &late->joints[late->joint_count];
    *at = (struct pccd_joint){.kind = kind, .parent = parent, .rotation = {0, 0, 0, 1}};
    if (kind == PCCD_JOINT_TURN) {
        at->axis[2] = 1;
        at->from[0] = from[0];
        at->to[0] = to[0];
    } else {
        memcpy(at->from, from, sizeof at->from);
        memcpy(at->to, to, sizeof at->to);
    }
    return late->joint_count++;
}

static uint32_t hinge(struct late *late, uint32_t parent, double angle)
{
    const double from[3] = {0}, to[3] = {angle};
    return joint(late, PCCD_JOINT_TURN, parent, from, to);
}

/* ---- scenes ------------------------------------------------------------------------ */

/* Boxes in a heap, each of which flies and tumbles. */
static void make_boxes(struct late *late, uint32_t count)
{
    struct shape box = make_box(1);
    uint32_t mesh = register_shape(late, &box);
    double room = 2 * cbrt(count);
    for (uint32_t i = 0; i < count; i++) {
        double value[4][3];
        for (uint32_t k = 0; k < 12; k++) {
            double most = k < 3 ? room : 1;
            value[k / 3][k % 3] = prng_between(&late->prng, -most, most);
        }
        for (uint32_t k = 0; k < 3; k++) {
            value[1][k] += value[0][k];
        }
        uint32_t fly = joint(late, PCCD_JOINT_SHIFT, PCCD_NO_JOINT, value[0], value[1]);
        turn(late, mesh, 8, joint(late, PCCD_JOINT_VECTOR, fly, value[2], value[3]));
    }
    free_shape(&box);
}

static void make_pile(struct late *late, bool smoke)
{
    make_boxes(late, smoke ? 50 : BODIES_MAX);
}

/* Two bodies of a million triangles, or fewer, in one place, one of which turns. */
static void make_twins(struct late *late, struct shape shape, double angle)
{
    uint32_t mesh = register_shape(late, &shape);
    (void)add(late, mesh);
    turn(late, mesh, shape.vertices, hinge(late, PCCD_NO_JOINT, angle));
    free_shape(&shape);
}

static void make_large(struct late *late, bool smoke)
{
    make_twins(late, make_roll(smoke ? 30 : 708), 0.3);
}

static void make_undecided(struct late *late, bool smoke)
{
    make_twins(late, make_sheet(smoke ? 5 : 50), 0.3);
}

static void make_often(struct late *late, bool smoke)
{
    make_twins(late, make_roll(smoke ? 10 : 50), 1e5);
}

struct arm {
    uint32_t links;
    double angle, along, height; /* of a link's turn; to the next link; of the first */
};

/* Links about one another, in a shape that stands. Both shapes are freed. */
static void make_links(struct late *late, struct shape link, struct shape standing,
                       const struct arm *arm)
{
    uint32_t mesh = register_shape(late, &link), last = PCCD_NO_JOINT;
    (void)add(late, register_shape(late, &standing));
    for (uint32_t i = 0; i < arm->links; i++) {
        last = hinge(late, last, arm->angle);
        late->joints[last].position[0] = arm->along;
        late->joints[last].position[2] = i == 0 ? arm->height : 0;
        turn(late, mesh, link.vertices, last);
    }
    free_shape(&link);
    free_shape(&standing);
}

/* In a rough floor. */
static void make_chain(struct late *late, bool smoke)
{
    make_links(late, make_roll(smoke ? 5 : 40), make_roll(smoke ? 10 : 200),
               &(struct arm){.links = 64, .angle = 0.5, .along = 0.5});
}

/* Triangles without joints that deform through as many that stand. */
static void make_deforming(struct late *late, uint32_t side)
{
    struct shape roll = make_roll(side);
    uint32_t mesh = register_shape(late, &roll);
    (void)add(late, mesh);
    for (uint32_t i = 0; i < 2 && late->x1[1] == NULL; i++) {
        late->x1[i] = bench_alloc(roll.vertices, sizeof *late->x1[i]);
        for (uint32_t v = 0; v < 3 * roll.vertices; v++) {
            late->x1[i][v / 3][v % 3] = roll.x[v / 3][v % 3] + 0.01 * i * (v % 3);
        }
    }
    late->motions[late->count++] = (struct pccd_motion){
        .object = add(late, mesh), .count = roll.vertices, .format = PCCD_FORMAT_F64};
    free_shape(&roll);
}

static void make_straight(struct late *late, bool smoke)
{
    make_deforming(late, smoke ? 30 : 708);
}

/* Each joint from 2^20 turns to as many in the other direction. */
static void make_turns(struct late *late, bool smoke)
{
    make_links(late, make_roll(smoke ? 5 : 40), make_roll(smoke ? 10 : 200),
               &(struct arm){.links = 64, .angle = -2 * ANGLE_MOST, .along = 0.5});
    for (uint32_t i = 0; i < late->joint_count; i++) {
        late->joints[i].from[0] += ANGLE_MOST;
        late->joints[i].to[0] += ANGLE_MOST;
    }
}

/* 10^5 triangles that turn in 10^5, all of which are nearer than the distance, to the
 * narrowest bracket; or just as far, throughout. */
static void make_near(struct late *late, bool smoke)
{
    make_twins(late, make_roll(smoke ? 10 : 224), 3);
}

static void make_just_as_far(struct late *late, bool smoke)
{
    make_twins(late, make_sheet(smoke ? 5 : 224), 3);
    late->joints[0].position[2] = late->settings.separation;
}

/* Triangles whose numbers are as far apart as doubles may be, in some of few planes: for
 * integers. */
static void make_exponents(struct late *late, bool smoke)
{
    make_deforming(late, smoke ? 5 : 30);
    for (uint32_t i = 0; i < 6 * late->motions[0].count; i++) {
        double *x = &late->x1[i & 1][i / 6][i / 2 % 3];
        double mantissa = prng_between(&late->prng, -1, 1);
        uint32_t kind = prng_u32(&late->prng, 4);
        *x = kind == 0 ? 0 : ldexp(mantissa, kind == 1 ? -1060 : 59);
    }
}

/* Points that fly through a roll, as rays do. */
static void make_cast(struct late *late, bool smoke)
{
    struct shape roll = make_roll(smoke ? 30 : 708), cloud = make_sheet(smoke ? 30 : 708);
    uint32_t *points = bench_alloc(cloud.vertices, sizeof *points), mesh = 0;
    const struct pccd_mesh_data data = {.x = cloud.x,
                                        .format = PCCD_FORMAT_F64,
                                        .vertex_count = cloud.vertices,
                                        .points = points,
                                        .point_count = cloud.vertices};
    (void)add(late, register_shape(late, &roll));
    late->x1[1] = bench_alloc(cloud.vertices, sizeof *cloud.x);
    for (uint32_t v = 0; v < cloud.vertices; v++) {
        double x[3] = {cloud.x[v][0], cloud.x[v][1], 2 + cloud.x[v][0]};
        points[v] = v;
        memcpy(late->x1[1][v], x, sizeof x);
        x[2] = -2;
        memcpy(cloud.x[v], x, sizeof x);
    }
    bench_must(pccd_mesh_put(late->client, &data, &mesh, NULL), "mesh", late->client);
    late->motions[late->count++] = (struct pccd_motion){
        .object = add(late, mesh), .count = cloud.vertices, .format = PCCD_FORMAT_F64};
    late->x1[0] = cloud.x;
    free(cloud.faces);
    free(points);
    free_shape(&roll);
}

/* ---- questions --------------------------------------------------------------------- */

/* A torus in the place of a roll: it is closed. */
static struct shape make_torus(uint32_t side)
{
    struct shape shape = make_sheet(side);
    for (uint32_t v = 0; v < shape.vertices; v++) {
        double a = PI * shape.x[v][0], b = PI * shape.x[v][1];
        double radius = 1 + 0.3 * cos(b) + 0.001 * sin(40 * a) * sin(40 * b);
        shape.x[v][0] = radius * cos(a);
        shape.x[v][1] = radius * sin(a);
        shape.x[v][2] = 0.3 * sin(b);
    }
    for (uint32_t i = 0; i < 3 * shape.triangles; i++) { /* its ends are one */
        uint32_t *v = &shape.faces[i / 3][i % 3];
        *v = *v / (side + 1) % side * (side + 1) + *v % (side + 1) % side;
    }
    return shape;
}

/* Ask about two of these, far into one another, which stand. */
static void ask(struct late *late, bool smoke)
{
    struct shape torus = make_torus(smoke ? 12 : 708);
    (void)add(late, register_shape(late, &torus));
    for (uint32_t v = 0; v < torus.vertices; v++) {
        torus.x[v][0] += late->near.what == PCCD_NEAR_NEAREST ? 2.61 : 0.2;
    }
    (void)add(late, register_shape(late, &torus));
    free_shape(&torus);
    late->asks = true;
}

/* ---- batches ----------------------------------------------------------------------- */

/* Have a batch of so many scenes; `make` makes one of them, all alike, of 256 bodies at
 * most. */
static void make_batch(struct late *late, uint32_t scenes, bool smoke,
                       void (*make)(struct late *late, bool smoke))
{
    struct pccd_batch_part *parts = bench_alloc(scenes * 256u, sizeof *parts);
    uint32_t joint_counts[SCENES], first = late->scene, part_count = 0;
    for (uint32_t s = 0; s < scenes; s++) {
        late->count = late->joint_count = 0;
        if (s > 0) {
            bench_must(pccd_scene_create(late->client, NULL, &late->scenes[s]), "scene",
                       late->client);
            late->scene = late->scenes[s];
        }
        make(late, smoke);
        joint_counts[s] = late->joint_count;
        for (uint32_t i = 0; i < late->count; i++) {
            const struct pccd_motion *motion = &late->motions[i];
            parts[part_count++] = (struct pccd_batch_part){
                .scene = late->scene,
                .object = motion->object,
                .first = motion->first,
                .count = motion->count,
                .format = motion->format,
                .way = late->joint_count > 0 ? PCCD_BATCH_TURNING : PCCD_BATCH_X1};
        }
    }
    late->scene = first;
    late->scene_count = scenes;
    bench_must(pccd_batch_create_turning(late->client, parts, part_count, joint_counts,
                                         scenes, &late->batch),
               "batch", late->client);
    free(parts);
}

/* An arm in a cell. */
static void make_arm(struct late *late, bool smoke)
{
    make_links(late, make_roll(smoke ? 5 : 16), make_sheet(smoke ? 5 : 76),
               &(struct arm){.links = 6, .angle = 0.8, .along = 1, .height = 1.5});
}

/* 16 000 triangles that deform through as many that stand. */
static void make_small(struct late *late, bool smoke)
{
    make_deforming(late, smoke ? 10 : 90);
}

/* A part of a heap: those of all scenes have 10 240 boxes. */
static void make_heap(struct late *late, bool smoke)
{
    make_boxes(late, smoke ? 10 : 160);
}

/* ---- held frames ------------------------------------------------------------------- */

/* A million triangles whose frame is held, and another member's body, which turns about
 * itself and takes it along. */
static void make_held(struct late *late, bool smoke)
{
    const struct pccd_scene_settings share = {.name = "late", .share = PCCD_SHARE_OPEN};
    struct shape roll = make_roll(smoke ? 10 : 50);
    struct late *other = bench_alloc(1, sizeof *other);
    *other = (struct late){.client = bench_connect(0, pccd_url(late->client)),
                           .settings = PCCD_STEP_SETTINGS_INIT};
    bench_must(pccd_scene_destroy(late->client, late->scene), "scene", late->client);
    bench_must(pccd_scene_create(late->client, &share, &late->scene), "scene",
               late->client);
    make_straight(late, smoke);
    bench_must(pccd_scene_create(other->client, &share, &other->scene), "scene",
               other->client);
    turn(other, register_shape(other, &roll), roll.vertices,
         hinge(other, PCCD_NO_JOINT, 1e5));
    late->settings.hold = true;
    late->other = other;
    free_shape(&roll);
}

static const struct {
    const char *name;
    void (*make)(struct late *late, bool smoke);
    uint32_t batch; /* of so many scenes; 0: it is none */
    enum pccd_method method;
    enum pccd_mode mode;
    double separation, tolerance;
    bool tells_start;
    enum pccd_near_what what; /* of a question, and its distance */
    double distance;
} scenes[] = {
    {"pile of boxes", make_pile, .batch = 0},
    {"large twins", make_large, .batch = 0},
    {"undecided", make_undecided, .batch = 0},
    {"10^5 rad", make_often, .batch = 0},
    {"64 joints", make_chain, .batch = 0},
    {"straight", make_straight, .batch = 0},
    {"a batch of arms", make_arm, .batch = 64},
    {"a batch, straight", make_small, .batch = 64},
    {"a held frame", make_held, .batch = 0},
    {"64 joints, thick", make_chain, .separation = 0.05},
    {"64 joints, 2^20 turns", make_turns, .batch = 0},
    {"near, 1e-12", make_near, .separation = 0.5, .tolerance = 1e-12},
    {"just as far, 1e-12", make_just_as_far, .separation = 0.125, .tolerance = 1e-12},
    {"exponents", make_exponents, .batch = 0},
    {"exponents, thick", make_exponents, .separation = 0x1p50},
    {"a roadmap", make_arm, .batch = SCENES}, /* an edge each */
    {"straight, paper", make_straight, .method = PCCD_METHOD_PAPER},
    /* Thicker than the cells are wide. */
    {"straight, thick", make_straight, .separation = 0.01},
    {"straight, its start", make_straight, .tells_start = true},
    /* Records of 8 bytes, tens of millions of them. */
    {"straight, pairs", make_straight, .mode = PCCD_MODE_PAIRS},
    {"points through it", make_cast, .batch = 0},
    {"a batch of heaps", make_heap, .batch = 64},
    {"a batch of arms, paper", make_arm, .batch = 64, .method = PCCD_METHOD_PAPER},
    {"a batch, straight, paper", make_small, .batch = 64, .method = PCCD_METHOD_PAPER},
    {"near, pairs", ask, .what = PCCD_NEAR_PAIRS, .distance = 0.01},
    {"near, vertices", ask, .what = PCCD_NEAR_VERTICES, .distance = 0.01},
    {"nearest", ask, .what = PCCD_NEAR_NEAREST, .distance = INFINITY},
    {"depth", ask, .what = PCCD_NEAR_DEPTH},
};

/* ---- what is measured -------------------------------------------------------------- */

/* Submit a step of each scene of the batch; they move alike. */
static uint64_t submit_batch(struct late *late, const struct pccd_step_settings *settings)
{
    const uint32_t parts = pccd_batch_scenes(late->batch) * late->count;
    const void **x1 = bench_alloc(parts, sizeof *x1);
    uint64_t step = 0;
    for (uint32_t i = 0; i < parts; i++) {
        x1[i] = late->joint_count > 0 ? (const void *)late->joints
                                      : (const void *)late->x1[late->turn];
    }
    bench_must(pccd_batch_submit(late->batch, NULL, x1, settings, &step), "submit",
               late->client);
    free(x1);
    return step;
}

static uint64_t submit(struct late *late, uint64_t budget_ns)
{
    struct pccd_step_settings settings = late->settings;
    uint64_t step = 0;
    settings.deadline_ns = budget_ns;
    late->turn = 1 - late->turn;
    if (late->batch != NULL) {
        return submit_batch(late, &settings);
    }
    if (late->asks) {
        struct pccd_near_settings near = late->near;
        near.threads = settings.threads;
        near.deadline_ns = budget_ns;
        bench_must(pccd_submit_near(late->client, late->scene, NULL, 0, &near, &step),
                   "submit", late->client);
        return step;
    }
    settings.joints = late->joint_count > 0 ? late->joints : NULL;
    settings.joint_count = late->joint_count;
    late->motions[0].x1 = late->x1[late->turn];
    bench_must(pccd_submit(late->client, late->scene, late->motions, late->count,
                           &settings, &step),
               "submit", late->client);
    late->other_step = late->other != NULL ? submit(late->other, 0) : 0;
    return step;
}

/* Wait for it; returns whether it was not done before it had to end. */
static bool wait_for(struct late *late, uint64_t step)
{
    struct pccd_batch_answer all = PCCD_BATCH_ANSWER_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    bool ended;
    if (late->batch != NULL) {
        bench_must(pccd_batch_wait(late->client, step, -1, &all), "step", late->client);
        ended = all.incomplete > 0;
        pccd_batch_release(late->client, &all);
    } else {
        int status = pccd_wait(late->client, step, -1, &answer);
        if (status == PCCD_E_BUSY && late->other != NULL) {
            return false; /* what was held before is still being moved */
        }
        bench_must(status, "step", late->client);
        ended = answer.incomplete == PCCD_INCOMPLETE_DEADLINE ||
                answer.incomplete == PCCD_INCOMPLETE_CANCELLED;
        pccd_answer_release(late->client, &answer);
    }
    return ended;
}

/* End another member's step. What is held may have come too late for it, and goes along
 * with the next. */
static void end_other(struct late *late)
{
    if (late->other != NULL) {
        (void)pccd_cancel(late->other->client, late->other_step);
        (void)wait_for(late->other, late->other_step);
        (void)wait_for(late->other, submit(late->other, SETTLE_NS));
    }
}

static double us_since(uint64_t ns)
{
    uint64_t now_ns = common_now_ns();
    return now_ns > ns ? 1e-3 * (double)(now_ns - ns) : 0;
}

static bool is_direct(const struct late *late)
{
    return strcmp(pccd_url(late->client), "direct:") == 0;
}

/* Submit a step that ends after the budget, or nanoseconds 0: is cancelled after a pause.
 * Add to `samples` how long after that its answer comes; or, if these are a ping's, how
 * long a ping takes then. */
static void measure_one(struct late *late, uint64_t budget_ns, uint32_t pause_us,
                        struct bench_samples *samples, struct bench_samples *ping)
{
    uint64_t begin_ns = common_now_ns(), step = submit(late, budget_ns);
    /* With direct: the submission is the step. */
    uint64_t end_ns = (is_direct(late) ? begin_ns : common_now_ns()) + budget_ns;
    if (budget_ns == 0) {
        (void)usleep(pause_us);
        end_ns = common_now_ns();
    }
    if (ping != NULL) {
        bench_add(ping, bench_ping_us(late->client));
    }
    if (budget_ns == 0) {
        (void)pccd_cancel(late->client, step); /* or it is done */
    }
    if (wait_for(late, step) && samples != NULL) {
        bench_add(samples, us_since(end_ns));
    }
    end_other(late);
}

/* Returns how many steps were not done before they had to end. */
static uint32_t measure_rounds(struct late *late, const char *name, bool smoke,
                               uint32_t threads)
{
    const uint32_t rounds = smoke ? 3 : 20;
    struct bench_samples cancel = {NULL, 0, 0}, deadline = {NULL, 0, 0},
                         ping = {NULL, 0, 0}, bare = {NULL, 0, 0};
    late->settings.threads = threads;
    uint64_t begin_ns = common_now_ns();
    measure_one(late, smoke ? 2000000 : PAUSE_MOST_NS, 0, NULL, NULL);
    uint32_t most_us = (uint32_t)us_since(begin_ns) + 1;
    for (uint32_t i = 0; i < rounds; i++) {
        if (!is_direct(late)) { /* where cancel comes too late */
            measure_one(late, 0, prng_u32(&late->prng, most_us), &cancel, NULL);
        }
        measure_one(late, 1 + 1000ull * prng_u32(&late->prng, most_us), 0, &deadline,
                    NULL);
        measure_one(late, is_direct(late) ? 1000000 : 0, prng_u32(&late->prng, most_us),
                    NULL, &ping);
        (void)usleep(1000); /* as one who waits: processors sleep */
        bench_add(&bare, bench_ping_us(late->client));
    }
    const uint32_t late_count = (uint32_t)(cancel.count + deadline.count);
    /* The scenes of a smoke are so small that one by itself may always be in time. */
    bench_check(smoke || late_count > 0, name, "every step was done in time");
    struct bench_side rows[] = {
        {.what = "cancel", .unit = "us", .threads = threads, .samples = cancel},
        {.what = "deadline", .unit = "us", .threads = threads, .samples = deadline},
        {.what = "ping beside it", .unit = "us", .threads = threads, .samples = ping},
        {.what = "ping alone", .unit = "us", .threads = threads, .samples = bare}};
    bench_sides_end(name, rows, sizeof rows / sizeof rows[0], true);
    return late_count;
}

static void unmake(struct late *late)
{
    for (uint32_t s = 0; s == 0 || s < late->scene_count; s++) {
        uint32_t scene = s == 0 ? late->scene : late->scenes[s];
        if (scene != 0) {
            bench_must(pccd_scene_destroy(late->client, scene), "scene", late->client);
        }
    }
    if (late->other != NULL) {
        pccd_close(late->other->client);
    }
    pccd_batch_destroy(late->batch);
    free(late->other);
    free(late->x1[0]);
    free(late->x1[1]);
    free(late);
}

int section_late(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    struct pccd_client *client = bench_connect(0, NULL);
    uint32_t scene_count = 0, late_count = 0;
    bench_heading("late");
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        if (!bench_is_wanted(options, scenes[i].name)) {
            continue;
        }
        struct late *late = bench_alloc(1, sizeof *late);
        *late = (struct late){.client = client,
                              .prng = {17},
                              .settings = PCCD_STEP_SETTINGS_INIT,
                              .near = PCCD_NEAR_SETTINGS_INIT};
        late->settings.method = scenes[i].method;
        late->settings.mode = scenes[i].mode;
        late->settings.separation = scenes[i].separation;
        late->settings.tells_start = scenes[i].tells_start;
        if (scenes[i].tolerance > 0) {
            late->settings.tolerance = scenes[i].tolerance;
        }
        late->near.what = scenes[i].what;
        late->near.distance = scenes[i].distance;
        bench_must(pccd_scene_create(client, NULL, &late->scene), "scene", client);
        if (scenes[i].batch > 0) {
            make_batch(late, options->smoke ? 3 : scenes[i].batch, options->smoke,
                       scenes[i].make);
        } else {
            scenes[i].make(late, options->smoke);
        }
        scene_count++;
        late_count += measure_rounds(late, scenes[i].name, options->smoke, 1);
        late_count += measure_rounds(late, scenes[i].name, options->smoke, 2);
        unmake(late);
    }
    if (bench_check(scene_count > 0, "late", "there is no such scene")) {
        bench_check(late_count > 0, "late", "every step of every scene was done in time");
    }
    pccd_close(client);
    return 0;
}
