/* client/ctl/picture/cloth_scene.c - the demo: a cloth falls over a turning ball.
 *
 * Room:     client/ctl.
 * Does:     builds the meshes and integrates the springs.
 * Does not: detect collisions between triangles.
 * Threads:  one at a time; nothing is shared.
 * Source:   extended position-based dynamics with small steps (Macklin et al. 2019).
 */
#include "cloth_scene.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"

#define SIDE                CLOTH_SIDE_VERTICES
#define CLOTH_WIDTH         2.0  /* of the square */
#define CLOTH_HEIGHT        0.75 /* above the ball's centre at the start */
#define VERTEX_MASS         1e-4 /* kilograms: half a kilogram of cloth */
#define GRAVITY             9.81 /* metres per second squared */
#define FRAME_SECONDS       0.01
#define SMALL_STEPS         10  /* per frame */
#define AIR_DRAG            0.6 /* share of the speed lost per second */
#define FRICTION            0.3 /* tangential over normal displacement on the ball */
#define SHEAR_COMPLIANCE    2e-4
#define BEND_COMPLIANCE     4e-2
#define ROUGHNESS           1e-3 /* unevenness of the start, so that it folds */
#define SPIN_DELAY_FRAMES   60   /* the ball stands still until the cloth lies on it */
#define SPIN_QUARTER_FRAMES 16   /* then it swings to and fro: a quarter of the period */
#define SPIN_MAX            4.0  /* radians per second */

/* ---- meshes -------------------------------------------------------------------------
 */

static uint32_t grid_index(uint32_t row, uint32_t column)
{
    return row * SIDE + column;
}

/* A number in -1 .. 1 that depends on the state alone. Numerical Recipes' generator. */
static double noise(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 8388608.0 - 1.0;
}

static void build_cloth(struct cloth_scene *scene)
{
    uint32_t state = 1;
    uint32_t triangle = 0;
    for (uint32_t row = 0; row < SIDE; row++) {
        for (uint32_t column = 0; column < SIDE; column++) {
            double *x = scene->x[grid_index(row, column)];
            x[0] = CLOTH_WIDTH * ((double)column / (SIDE - 1) - 0.5);
            x[1] = CLOTH_HEIGHT + ROUGHNESS * noise(&state);
            x[2] = CLOTH_WIDTH * ((double)row / (SIDE - 1) - 0.5);
        }
    }
    for (uint32_t row = 0; row + 1 < SIDE; row++) {
        for (uint32_t column = 0; column + 1 < SIDE; column++) {
            uint32_t a = grid_index(row, column), b = grid_index(row, column + 1);
            uint32_t c = grid_index(row + 1, column), d = grid_index(row + 1, column + 1);
            /* Diagonals alternate so that the cloth has no grain. */
            bool is_even = (row + column) % 2 == 0;
            uint32_t first[3] = {a, c, is_even ? d : b};
            uint32_t second[3] = {is_even ? a : c, d, b};
            memcpy(scene->cloth_triangles[triangle++], first, sizeof(first));
            memcpy(scene->cloth_triangles[triangle++], second, sizeof(second));
        }
    }
}

static void normalize(float x[3], const double from[3])
{
    double length = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
    for (uint32_t axis = 0; axis < 3; axis++) {
        x[axis] = (float)(from[axis] / length * CLOTH_BALL_RADIUS);
    }
}

/* The vertex in the middle of an edge, made on first use. `middles[low]` lists what has
 * been made for edges that begin at their lower vertex `low`; a vertex has at most 6
 * edges. */
struct middle {
    uint32_t high[6], vertex[6], count;
};

static uint32_t middle_vertex(struct cloth_scene *scene, struct middle *middles,
                              uint32_t *vertex_count, const uint32_t ends[2])
{
    uint32_t low = ends[0] < ends[1] ? ends[0] : ends[1];
    uint32_t high = ends[0] < ends[1] ? ends[1] : ends[0];
    struct middle *middle = &middles[low];
    for (uint32_t i = 0; i < middle->count; i++) {
        if (middle->high[i] == high) {
            return middle->vertex[i];
        }
    }
    uint32_t vertex = (*vertex_count)++;
    double sum[3];
    for (uint32_t axis = 0; axis < 3; axis++) {
        sum[axis] =
            (double)scene->ball_start[low][axis] + (double)scene->ball_start[high][axis];
    }
    normalize(scene->ball_start[vertex], sum);
    middle->high[middle->count] = high;
    middle->vertex[middle->count] = vertex;
    middle->count++;
    return vertex;
}

/* Split every triangle into four; from the back, so that it can be done in place. */
static void subdivide(struct cloth_scene *scene, struct middle *middles,
                      uint32_t triangle_count, uint32_t *vertex_count)
{
    memset(middles, 0, sizeof(*middles) * CLOTH_BALL_VERTICES);
    for (uint32_t i = triangle_count; i-- > 0;) {
        uint32_t v[3], m[3];
        memcpy(v, scene->ball_triangles[i], sizeof(v));
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t ends[2] = {v[k], v[(k + 1) % 3]};
            m[k] = middle_vertex(scene, middles, vertex_count, ends);
        }
        const uint32_t parts[4][3] = {{v[0], m[0], m[2]},
                                      {m[0], v[1], m[1]},
                                      {m[2], m[1], v[2]},
                                      {m[0], m[1], m[2]}};
        memcpy(scene->ball_triangles[(size_t)i * 4], parts, sizeof(parts));
    }
}

static void build_ball(struct cloth_scene *scene, struct middle *middles)
{
    static const uint8_t faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10},
                                         {0, 10, 11}, {1, 5, 9},  {5, 11, 4}, {11, 10, 2},
                                         {10, 7, 6},  {7, 1, 8},  {3, 9, 4},  {3, 4, 2},
                                         {3, 2, 6},   {3, 6, 8},  {3, 8, 9},  {4, 9, 5},
                                         {2, 4, 11},  {6, 2, 10}, {8, 6, 7},  {9, 8, 1}};
    double golden = (1.0 + sqrt(5.0)) / 2.0;
    uint32_t vertex_count = 12;
    uint32_t triangle_count = 20;
    for (uint32_t i = 0; i < 12; i++) {
        /* The corners are (+-1, +-golden, 0) and its two rotations of the axes. */
        double corner[3];
        double one = i % 2 == 0 ? -1.0 : 1.0;
        double long_one = i % 4 < 2 ? golden : -golden;
        uint32_t turn = i / 4;
        corner[turn] = one;
        corner[(turn + 1) % 3] = long_one;
        corner[(turn + 2) % 3] = 0.0;
        normalize(scene->ball_start[i], corner);
    }
    for (uint32_t i = 0; i < 20; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            scene->ball_triangles[i][k] = faces[i][k];
        }
    }
    for (uint32_t level = 0; level < CLOTH_BALL_SUBDIVISIONS; level++) {
        subdivide(scene, middles, triangle_count, &vertex_count);
        triangle_count *= 4;
    }
}

/* ---- springs ------------------------------------------------------------------------
 */

/* Springs from every vertex to the one `rows` and `columns` further, if there is one. */
static void add_springs(struct cloth_scene *scene, int rows, int columns,
                        double compliance)
{
    for (int row = 0; row + rows < SIDE; row++) {
        for (int column = 0; column < SIDE; column++) {
            int other = column + columns;
            if (other < 0 || other >= SIDE) {
                continue;
            }
            double across = (double)columns * CLOTH_WIDTH / (SIDE - 1);
            double along = (double)rows * CLOTH_WIDTH / (SIDE - 1);
            scene->springs[scene->spring_count++] = (struct cloth_spring){
                .a = grid_index((uint32_t)row, (uint32_t)column),
                .b = grid_index((uint32_t)(row + rows), (uint32_t)other),
                .length = sqrt(across * across + along * along),
                .compliance = compliance};
        }
    }
}

static int build_springs(struct cloth_scene *scene, struct ctl_error *error)
{
    size_t springs_max = (size_t)6 * CLOTH_VERTICES;
    scene->springs = malloc(springs_max * sizeof(*scene->springs));
    if (scene->springs == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the cloth");
    }
    add_springs(scene, 0, 1, 0.0);
    add_springs(scene, 1, 0, 0.0);
    add_springs(scene, 1, 1, SHEAR_COMPLIANCE);
    add_springs(scene, 1, -1, SHEAR_COMPLIANCE);
    add_springs(scene, 0, 2, BEND_COMPLIANCE);
    add_springs(scene, 2, 0, BEND_COMPLIANCE);
    return PCCD_OK;
}

/* ---- motion -------------------------------------------------------------------------
 */

/* Radians per second in the frame at hand: a triangular wave, so that the cloth, which
 * lags behind, slips over the ball again and again without being carried off it. */
static double spin(const struct cloth_scene *scene)
{
    if (scene->frame < SPIN_DELAY_FRAMES) {
        return 0.0;
    }
    uint64_t phase = (scene->frame - SPIN_DELAY_FRAMES) % (4 * SPIN_QUARTER_FRAMES);
    double share = (double)phase / SPIN_QUARTER_FRAMES;
    if (share > 3.0) {
        return SPIN_MAX * (share - 4.0);
    }
    return SPIN_MAX * (share > 1.0 ? 2.0 - share : share);
}

static void fall(struct cloth_scene *scene, double dt)
{
    double keep = 1.0 - AIR_DRAG * dt;
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        scene->v[i][1] -= GRAVITY * dt;
        for (uint32_t axis = 0; axis < 3; axis++) {
            scene->start[i][axis] = scene->x[i][axis];
            scene->x[i][axis] += scene->v[i][axis] * keep * dt;
        }
    }
}

static void pull(struct cloth_scene *scene, double dt)
{
    const double inverse_mass = 1.0 / VERTEX_MASS;
    for (uint32_t i = 0; i < scene->spring_count; i++) {
        const struct cloth_spring *spring = &scene->springs[i];
        double *a = scene->x[spring->a];
        double *b = scene->x[spring->b];
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

/* Push what is inside the ball to its surface, and let friction take it along. */
static void meet_ball(struct cloth_scene *scene, double dt)
{
    double turn = spin(scene) * dt;
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        double *x = scene->x[i];
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        double depth = CLOTH_BALL_RADIUS - distance;
        if (depth <= 0.0 || distance <= 0.0) {
            continue;
        }
        double normal[3] = {x[0] / distance, x[1] / distance, x[2] / distance};
        /* How the surface moves below the vertex: about the y axis. */
        double surface[3] = {turn * x[2], 0.0, -turn * x[0]};
        double slide[3], along = 0.0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            slide[axis] = x[axis] - scene->start[i][axis] - surface[axis];
            along += slide[axis] * normal[axis];
        }
        double slip_squared = 0.0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            slide[axis] -= along * normal[axis];
            slip_squared += slide[axis] * slide[axis];
        }
        double slip = sqrt(slip_squared);
        double hold = FRICTION * depth >= slip ? 1.0 : FRICTION * depth / slip;
        for (uint32_t axis = 0; axis < 3; axis++) {
            x[axis] += depth * normal[axis] - hold * slide[axis];
        }
    }
}

static void turn_ball(struct cloth_scene *scene)
{
    /* Rational rotation: tan(angle / 2) is close enough to angle / 2 for a small angle,
     * and the result is a rotation for any value. */
    double half = spin(scene) * FRAME_SECONDS / 2.0;
    double norm = 1.0 + half * half;
    double c = (1.0 - half * half) / norm;
    double s = 2.0 * half / norm;
    double turned_cos = scene->turn_cos * c - scene->turn_sin * s;
    double turned_sin = scene->turn_sin * c + scene->turn_cos * s;
    double length = sqrt(turned_cos * turned_cos + turned_sin * turned_sin);
    scene->turn_cos = turned_cos / length;
    scene->turn_sin = turned_sin / length;
}

void cloth_scene_advance(struct cloth_scene *scene)
{
    const double dt = FRAME_SECONDS / SMALL_STEPS;
    for (uint32_t step = 0; step < SMALL_STEPS; step++) {
        fall(scene, dt);
        pull(scene, dt);
        meet_ball(scene, dt);
        for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
            for (uint32_t axis = 0; axis < 3; axis++) {
                scene->v[i][axis] = (scene->x[i][axis] - scene->start[i][axis]) / dt;
            }
        }
    }
    turn_ball(scene);
    scene->frame++;
}

void cloth_scene_positions(const struct cloth_scene *scene, float (*x)[3])
{
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        for (uint32_t axis = 0; axis < 3; axis++) {
            x[i][axis] = (float)scene->x[i][axis];
        }
    }
}

void cloth_scene_ball_pose(const struct cloth_scene *scene, double pose[12])
{
    const double c = scene->turn_cos, s = scene->turn_sin;
    const double rows[12] = {c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0};
    memcpy(pose, rows, sizeof(rows));
}

int cloth_scene_new(struct cloth_scene **scene, struct ctl_error *error)
{
    struct cloth_scene *made = calloc(1, sizeof(*made));
    struct middle *middles = calloc(CLOTH_BALL_VERTICES, sizeof(*middles));
    int status = PCCD_OK;
    if (made == NULL || middles == NULL) {
        status = ctl_error_set(error, PCCD_E_NOMEM, "no memory for the scene");
    } else {
        status = build_springs(made, error);
    }
    if (status == PCCD_OK) {
        made->turn_cos = 1.0;
        build_cloth(made);
        build_ball(made, middles);
        cloth_scene_positions(made, made->cloth_start);
        *scene = made;
        made = NULL;
    }
    free(middles);
    cloth_scene_free(made);
    return status;
}

void cloth_scene_free(struct cloth_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    free(scene->springs);
    free(scene);
}
