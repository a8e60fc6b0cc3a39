/* bench_scene.h - a benchmark scene: meshes, and their positions at every frame.
 *
 * Threads: one for one scene.
 */
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct bench_object {
    uint32_t vertex_count;
    uint32_t triangle_count;
    uint32_t (*triangles)[3];
    uint32_t first_vertex; /* in a frame */
    /* Named by themselves, in thin.c alone; NULL: none. */
    uint32_t edge_count;
    uint32_t point_count;
    uint32_t (*edges)[2];
    uint32_t *points;
    double radius;       /* of all features; of the rest only where this is above 0 */
    uint32_t rest_rings; /* struct pccd_object_settings has it */
    bool is_not_self;    /* it is not tested against itself */
};

struct bench_scene {
    const char *name;
    uint32_t object_count;
    uint32_t object_capacity;
    struct bench_object *objects;
    uint32_t vertex_count; /* of all objects */
    uint32_t frame_count;  /* at least 2; step i goes from frame i to i + 1 */
    uint32_t break_frame;  /* whole until then, in pieces after it; 0: never */
    uint32_t hard_frame;   /* the step that stands for it where there is time for few */
    /* Where it breaks into other triangles: the scene that is told up to break_frame,
     * which has the same objects but for `break_object`. NULL: none. Freed with it. */
    struct bench_scene *before;
    uint32_t break_object;
    /* Write frame 0 .. frame_count - 1 to x[vertex_count]; in any order. */
    void (*place)(const struct bench_scene *scene, uint32_t frame, double (*x)[3]);
    /* For those who move objects by poses: the pose (rows of [R | t]) of one that only
     * turns and shifts takes it to a frame, bit for bit where `place` does, from where it
     * has to be registered for that, which goes to rest[vertex_count] unless NULL. False:
     * the object bends. NULL: all do. */
    bool (*pose)(const struct bench_scene *scene, uint32_t object, uint32_t frame,
                 double m[12], double (*rest)[3]);
    void *state; /* what `place` needs */
    void (*free_state)(void *state);
};

/* Two consecutive frames of a scene; memory is reused from one seek to the next. */
struct bench_frames {
    const struct bench_scene *told;  /* the whole story */
    const struct bench_scene *scene; /* whose frames these are: `told`, or its `before` */
    uint32_t from;
    double (*x[2])[3]; /* frames `from` and `from` + 1 */
};

void bench_frames_init(struct bench_frames *frames, const struct bench_scene *scene,
                       uint32_t from);
void bench_frames_deinit(struct bench_frames *frames);
/* `from` 0 .. frame_count - 2. One frame is made where the last seek was to the one
 * before, both otherwise. */
void bench_frames_seek(struct bench_frames *frames, uint32_t from);
/* Start (`end` 0) or end (1) positions of an object. */
static inline double (*bench_frames_x(const struct bench_frames *frames, int end,
                                      uint32_t object))[3]
{
    return frames->x[end] + frames->scene->objects[object].first_vertex;
}

/* Return the diagonal of the box around all start positions. */
double bench_frames_diagonal(const struct bench_frames *frames);
/* Return the median length of the sides of all triangles at the start. */
double bench_frames_median_edge(const struct bench_frames *frames);

uint64_t bench_scene_triangles(const struct bench_scene *scene);
void bench_scene_free(struct bench_scene *scene);

/* For those who make scenes. */

/* malloc that ends the process with 2 when there is no memory. */
void *bench_scene_alloc(size_t count, size_t bytes);
/* The next object; its triangles are to be filled in. Pointers to others are stale. */
struct bench_object *bench_scene_add(struct bench_scene *scene, uint32_t vertex_count,
                                     uint32_t triangle_count);
/* The next object with these triangles, copied. */
struct bench_object *bench_scene_add_mesh(struct bench_scene *scene,
                                          uint32_t vertex_count, uint32_t triangle_count,
                                          const uint32_t (*triangles)[3]);
/* All objects are known: room for `frame_count` frames, to be filled in, which `place`
 * will copy. For small scenes. */
double (*bench_scene_store(struct bench_scene *scene, uint32_t frame_count))[3];

/* From one frame of $PCCD_DATA to another with the same faces, in `steps` of equal
 * length. False: they are not there. */
bool bench_read_recorded(struct bench_scene *scene, const char *const names[2],
                         uint32_t steps);

#endif
