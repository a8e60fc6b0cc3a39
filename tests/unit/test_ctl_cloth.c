/* tests/unit/test_ctl_cloth.c - the demo's scene.
 *
 * Room:     client/ctl (cloth_scene.h).
 * Does:     the meshes are sound, the motion is the same every time, finite, and drapes.
 * Does not: need a daemon.
 * Threads:  one.
 * Source:   client/ctl/cloth_scene.h.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cloth_scene.h"

#define FRAMES 150

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
static void cloth__ball_is_a_closed_sphere(void **state)
{
    struct cloth_scene *scene = new_scene();
    (void)state;
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
static void cloth__grid_uses_every_vertex_and_faces_up(void **state)
{
    struct cloth_scene *scene = new_scene();
    static uint8_t uses[CLOTH_VERTICES];
    double area = 0.0;
    (void)state;
    memset(uses, 0, sizeof(uses));
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

/* If it failed: two runs of the demo would not print the same hash. */
static void cloth__two_runs_give_the_same_bytes(void **state)
{
    static float a[CLOTH_VERTICES][3], b[CLOTH_VERTICES][3];
    double pose_a[12], pose_b[12];
    struct cloth_scene *first = new_scene();
    struct cloth_scene *second = new_scene();
    (void)state;
    for (uint32_t i = 0; i < FRAMES; i++) {
        cloth_scene_advance(first);
    }
    for (uint32_t i = 0; i < FRAMES; i++) {
        cloth_scene_advance(second);
    }
    cloth_scene_positions(first, a);
    cloth_scene_positions(second, b);
    cloth_scene_ball_pose(first, pose_a);
    cloth_scene_ball_pose(second, pose_b);
    assert_memory_equal(a, b, sizeof(a));
    assert_memory_equal(pose_a, pose_b, sizeof(pose_a));
    cloth_scene_free(first);
    cloth_scene_free(second);
}

/* If it failed: the cloth would explode, stretch, fall through the ball or past it. */
static void cloth__falls_and_drapes_over_the_ball(void **state)
{
    struct cloth_scene *scene = new_scene();
    uint32_t touching = 0;
    double lowest = 0.0, stretch = 0.0;
    (void)state;
    for (uint32_t i = 0; i < FRAMES; i++) {
        cloth_scene_advance(scene);
    }
    for (uint32_t i = 0; i < CLOTH_VERTICES; i++) {
        const double *x = scene->x[i];
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        assert_true(isfinite(distance));
        assert_true(distance > 0.999 * CLOTH_BALL_RADIUS);
        touching += distance < 1.001 * CLOTH_BALL_RADIUS;
        lowest = fmin(lowest, x[1]);
    }
    for (uint32_t i = 0; i < scene->spring_count; i++) {
        const struct cloth_spring *spring = &scene->springs[i];
        const double *a = scene->x[spring->a], *b = scene->x[spring->b];
        double length =
            sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                 (a[2] - b[2]) * (a[2] - b[2]));
        if (spring->compliance == 0.0) {
            stretch = fmax(stretch, length / spring->length);
        }
    }
    assert_in_range(touching, CLOTH_VERTICES / 20, CLOTH_VERTICES);
    assert_true(lowest < -0.3);
    assert_true(stretch < 1.25);
    cloth_scene_free(scene);
}

/* If it failed: the ball's pose would not be a rotation, and the ball would change size.
 */
static void cloth__ball_turns_without_growing(void **state)
{
    struct cloth_scene *scene = new_scene();
    double pose[12];
    (void)state;
    for (uint32_t i = 0; i < FRAMES; i++) {
        cloth_scene_advance(scene);
    }
    cloth_scene_ball_pose(scene, pose);
    assert_true(fabs(pose[0] * pose[0] + pose[2] * pose[2] - 1.0) < 1e-12);
    assert_true(pose[8] == -pose[2] && pose[10] == pose[0]);
    assert_true(pose[5] == 1.0 && pose[3] == 0.0 && pose[7] == 0.0 && pose[11] == 0.0);
    assert_true(fabs(pose[2]) > 0.1);
    cloth_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cloth__ball_is_a_closed_sphere),
        cmocka_unit_test(cloth__grid_uses_every_vertex_and_faces_up),
        cmocka_unit_test(cloth__two_runs_give_the_same_bytes),
        cmocka_unit_test(cloth__falls_and_drapes_over_the_ball),
        cmocka_unit_test(cloth__ball_turns_without_growing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
