/* cloth_scene.c - the demo: a cloth falls over a turning ball.
 *
 * Source: extended position-based dynamics with small steps (Macklin et al. 2019).
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
            memcpy(scene->cloth_triangles[triangle++], first, sizeof first);
            memcpy(scene->cloth_triangles[triangle++], second, sizeof second);
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
    memset(middles, 0, sizeof *middles * CLOTH_BALL_VERTICES);
    for (uint32_t i = triangle_count; i-- > 0;) {
        uint32_t v[3], m[3];
        memcpy(v, scene->ball_triangles[i], sizeof v);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t ends[2] = {v[k], v[(k + 1) % 3]};
            m[k] = middle_vertex(scene, middles, vertex_count, ends);
        }
        const uint32_t parts[4][3] = {{v[0], m[0], m[2]},
                                      {m[0], v[1], m[1]},
                                      {m[2], m[1], v[2]},
                                      {m[0], m[1], m[2]}};
        memcpy(scene->ball_triangles[(size_t)i * 4], parts, sizeof parts);
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
    scene->springs = malloc(springs_max * sizeof *scene->springs);
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
            scene->start[i][axis] = scene->end[i][axis];
            scene->end[i][axis] += scene->v[i][axis] * keep * dt;
        }
    }
}

static void pull(struct cloth_scene *scene, double dt)
{
    const double inverse_mass = 1.0 / VERTEX_MASS;
    for (uint32_t i = 0; i < scene->spring_count; i++) {
        const struct cloth_spring *spring = &scene->springs[i];
        double *a = scene->end[spring->a];
        double *b = scene->end[spring->b];
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

/* The ball turned by `share` of a frame from where it is. */
static void turn_ball(struct cloth_scene *scene, double share)
{
    /* Rational rotation: tan(angle / 2) is close enough to angle / 2 for a small angle,
     * and the result is a rotation for any value. */
    double half = share * spin(scene) * FRAME_SECONDS / 2.0;
    double norm = 1.0 + half * half;
    double c = (1.0 - half * half) / norm;
    double s = 2.0 * half / norm;
    double turned_cos = scene->turn[0][0] * c - scene->turn[0][1] * s;
    double turned_sin = scene->turn[0][1] * c + scene->turn[0][0] * s;
    double length = sqrt(turned_cos * turned_cos + turned_sin * turned_sin);
    scene->turn[1][0] = turned_cos / length;
    scene->turn[1][1] = turned_sin / length;
}

void cloth_scene_predict(struct cloth_scene *scene)
{
    const double dt = FRAME_SECONDS / SMALL_STEPS;
    memcpy(scene->end, scene->x, sizeof scene->end);
    memset(scene->push, 0, sizeof scene->push);
    for (uint32_t step = 0; step < SMALL_STEPS; step++) {
        fall(scene, dt);
        pull(scene, dt);
        for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
            for (uint32_t axis = 0; axis < 3; axis++) {
                scene->v[i][axis] = (scene->end[i][axis] - scene->start[i][axis]) / dt;
            }
        }
    }
    scene->share = 1.0;
    turn_ball(scene, scene->share);
}

void cloth_scene_shorten(struct cloth_scene *scene, double share)
{
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        for (uint32_t axis = 0; axis < 3; axis++) {
            double way = scene->end[i][axis] - scene->x[i][axis];
            scene->end[i][axis] = scene->x[i][axis] + share * way;
            scene->v[i][axis] *= share;
        }
    }
    scene->share *= share;
    turn_ball(scene, scene->share);
}

void cloth_scene_take(struct cloth_scene *scene)
{
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        double out = 0.0, size = 0.0;
        for (uint32_t axis = 0; axis < 3; axis++) {
            scene->v[i][axis] += scene->push[i][axis] / FRAME_SECONDS;
            scene->x[i][axis] = (double)(float)scene->end[i][axis];
            out += scene->v[i][axis] * scene->push[i][axis];
            size += scene->push[i][axis] * scene->push[i][axis];
        }
        /* What was pushed aside does not fly off: nothing is elastic here. */
        for (uint32_t axis = 0; axis < 3 && out > 0.0; axis++) {
            scene->v[i][axis] -= out / size * scene->push[i][axis];
        }
    }
    memcpy(scene->turn[0], scene->turn[1], sizeof scene->turn[0]);
    scene->frame++;
}

/* ---- contacts -----------------------------------------------------------------------
 */

/* A vertex of a contact: where it is at both ends of the frame, and what part it has in
 * the distance of the two features. */
struct corner {
    double weight;
    double inverse_mass; /* of vertices of the cloth; 0: the ball gives way to nothing */
    double from[3], to[3];
    uint32_t vertex;
};

static struct corner corner_of(const struct cloth_scene *scene, bool is_cloth,
                               uint32_t vertex, double weight)
{
    struct corner corner = {
        .weight = weight, .inverse_mass = is_cloth ? 1.0 : 0.0, .vertex = vertex};
    if (is_cloth) {
        memcpy(corner.from, scene->x[vertex], sizeof corner.from);
        memcpy(corner.to, scene->end[vertex], sizeof corner.to);
        return corner;
    }
    const float *x = scene->ball_start[vertex];
    for (uint32_t end = 0; end < 2; end++) {
        double c = scene->turn[end][0], s = scene->turn[end][1];
        double *to = end == 0 ? corner.from : corner.to;
        to[0] = c * (double)x[0] + s * (double)x[2];
        to[1] = (double)x[1];
        to[2] = c * (double)x[2] - s * (double)x[0];
    }
    return corner;
}

static void find_corners(const struct cloth_scene *scene,
                         const struct cloth_contact *contact, struct corner corners[4])
{
    double p = contact->param[0], q = contact->param[1];
    if (contact->is_vf) {
        const uint32_t *face = contact->b;
        corners[0] = corner_of(scene, contact->a_is_cloth, contact->a[0], 1.0);
        corners[1] = corner_of(scene, contact->b_is_cloth, face[0], p + q - 1.0);
        corners[2] = corner_of(scene, contact->b_is_cloth, face[1], -p);
        corners[3] = corner_of(scene, contact->b_is_cloth, face[2], -q);
        return;
    }
    corners[0] = corner_of(scene, contact->a_is_cloth, contact->a[0], 1.0 - p);
    corners[1] = corner_of(scene, contact->a_is_cloth, contact->a[1], p);
    corners[2] = corner_of(scene, contact->b_is_cloth, contact->b[0], q - 1.0);
    corners[3] = corner_of(scene, contact->b_is_cloth, contact->b[1], -q);
}

void cloth_scene_push(struct cloth_scene *scene, const struct cloth_contact *contact)
{
    struct corner corners[4];
    double gap = 0.0, sum = 0.0, along = 0.0, slip = 0.0, slide[3] = {0, 0, 0};
    find_corners(scene, contact, corners);
    for (uint32_t i = 0; i < 4; i++) {
        sum += corners[i].weight * corners[i].weight * corners[i].inverse_mass;
        for (uint32_t axis = 0; axis < 3; axis++) {
            gap += corners[i].weight * corners[i].to[axis] * contact->normal[axis];
            slide[axis] +=
                corners[i].weight * (corners[i].to[axis] - corners[i].from[axis]);
        }
    }
    double depth = GAP - gap;
    if (depth <= 0.0 || sum <= 0.0) {
        return; /* an earlier push has done it */
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        along += slide[axis] * contact->normal[axis];
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        slide[axis] -= along * contact->normal[axis];
        slip += slide[axis] * slide[axis];
    }
    slip = sqrt(slip);
    double hold = FRICTION * depth >= slip ? 1.0 : FRICTION * depth / slip;
    for (uint32_t i = 0; i < 4; i++) {
        double share = corners[i].weight * corners[i].inverse_mass / sum;
        for (uint32_t axis = 0; axis < 3 && share != 0.0; axis++) {
            double push = share * (depth * contact->normal[axis] - hold * slide[axis]);
            scene->end[corners[i].vertex][axis] += push;
            scene->push[corners[i].vertex][axis] += push;
        }
    }
}

/* ---- what is told -------------------------------------------------------------------
 */

void cloth_scene_positions(const struct cloth_scene *scene, uint32_t end, float (*x)[3])
{
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        for (uint32_t axis = 0; axis < 3; axis++) {
            x[i][axis] = (float)(end == 0 ? scene->x : scene->end)[i][axis];
        }
    }
}

void cloth_scene_ball_pose(const struct cloth_scene *scene, uint32_t end, double pose[12])
{
    const double c = scene->turn[end][0], s = scene->turn[end][1];
    const double rows[12] = {c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0};
    memcpy(pose, rows, sizeof rows);
}

int cloth_scene_new(struct cloth_scene **scene, struct ctl_error *error)
{
    struct cloth_scene *made = calloc(1, sizeof *made);
    struct middle *middles = calloc(CLOTH_BALL_VERTICES, sizeof *middles);
    int status = PCCD_OK;
    if (made == NULL || middles == NULL) {
        status = ctl_error_set(error, PCCD_E_NOMEM, "no memory for the scene");
    } else {
        status = build_springs(made, error);
    }
    if (status == PCCD_OK) {
        made->turn[0][0] = made->turn[1][0] = 1.0;
        build_cloth(made);
        build_ball(made, middles);
        cloth_scene_positions(made, 0, made->cloth_start);
        for (uint32_t i = 0; i < CLOTH_VERTICES * 3; i++) {
            made->x[i / 3][i % 3] = (double)made->cloth_start[i / 3][i % 3];
        }
        memcpy(made->end, made->x, sizeof made->end);
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
