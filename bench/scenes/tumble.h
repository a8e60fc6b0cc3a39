/* tumble.h - simulates bodies that fall, collide and tumble.
 *
 * Threads: one.
 */
#ifndef BENCH_TUMBLE_H
#define BENCH_TUMBLE_H

#include <stdbool.h>
#include <stdint.h>

struct tumble_body {
    double centre[3];   /* at frame 0 */
    double before[3];   /* velocity until the release, when nothing else moves it */
    double velocity[3]; /* at the release; lengths a second */
    double spin[3];     /* likewise; radians a second */
    double radius;      /* of the ball that it collides as */
    double release;     /* seconds from frame 0 */
};

struct tumble_settings {
    uint32_t frame_count;
    uint32_t substeps; /* of a frame */
    double frame_s;    /* seconds a frame */
    double gravity;    /* downwards */
    double pull;       /* towards the vertical axis, a unit of distance from it */
    double restitution;
};

/* x' = m[0..2] . x + m[3] in each row: of the position at frame 0, to that of a frame. */
struct tumble_pose {
    double m[3][4];
};

struct tumble {
    uint32_t body_count;
    struct tumble_pose *poses; /* [frame_count][body_count] */
};

/* `bodies` are moved. Cost: body_count squared a substep. */
void tumble_init(struct tumble *tumble, struct tumble_body *bodies, uint32_t body_count,
                 const struct tumble_settings *settings);
void tumble_deinit(struct tumble *tumble);

static inline const struct tumble_pose *tumble_poses(const struct tumble *tumble,
                                                     uint32_t frame)
{
    return tumble->poses + (uint64_t)frame * tumble->body_count;
}

static inline void tumble_apply(const struct tumble_pose *pose, const double from[3],
                                double to[3])
{
    for (int k = 0; k < 3; k++) {
        const double *m = pose->m[k];
        to[k] = m[0] * from[0] + m[1] * from[1] + m[2] * from[2] + m[3];
    }
}

#endif
