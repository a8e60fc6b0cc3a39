/* bench/workload.h - the scenes that are measured.
 *
 * Room:     bench. May include: the C library.
 * Does:     make meshes and their positions in consecutive frames, the same bytes at
 *           every run; read the recorded frames of $PCCD_DATA.
 * Does not: know the engine.
 * Threads:  one.
 */
#ifndef BENCH_WORKLOAD_H
#define BENCH_WORKLOAD_H

#include <stdbool.h>
#include <stdint.h>

#define BENCH_OBJECTS_MAX 2

struct bench_object {
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t (*triangles)[3];
    uint32_t first_vertex; /* in a frame */
};

struct bench_scene {
    const char *name;
    uint32_t object_count;
    struct bench_object objects[BENCH_OBJECTS_MAX];
    uint32_t vertex_count; /* of all objects */
    uint32_t frame_count;  /* at least 2; step i goes from frame i to i + 1 */
    double (*x)[3];        /* [frame_count][vertex_count] */
};

/* Scenes 0 .. bench_scene_total() - 1. */
unsigned bench_scene_total(void);
const char *bench_scene_name(unsigned index);

/* Make a scene; `small` for a run that only asks whether everything works. False: its
 * frames are not there (recorded scenes; none of them is small). */
bool bench_scene_make(unsigned index, bool small, struct bench_scene *scene);
void bench_scene_free(struct bench_scene *scene);

/* Positions of one object in one frame. */
static inline double (*bench_scene_x(const struct bench_scene *scene, uint32_t frame,
                                     uint32_t object))[3]
{
    return scene->x + (uint64_t)frame * scene->vertex_count +
           scene->objects[object].first_vertex;
}

#endif
