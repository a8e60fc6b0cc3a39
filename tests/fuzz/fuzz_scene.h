/* fuzz_scene.h - the contacts of a few objects, found by brute force and exact
 * arithmetic.
 */
#ifndef FUZZ_SCENE_H
#define FUZZ_SCENE_H

#include <stddef.h>
#include <stdint.h>

/* Objects 0 .. count - 1 with the same triangles; the vertices of object i are x0[i
 * vertex_count] .. at t = 0, x1[..] at t = 1. */
struct fuzz_scene {
    uint32_t count;
    uint32_t vertex_count;
    uint32_t triangle_count;
    const uint32_t (*triangles)[3];
    const double (*x0)[3];
    const double (*x1)[3];
};

struct fuzz_scene_truth {
    /* [count] kind, object, feature, object, feature: as records name them, in order */
    uint32_t (*contacts)[5];
    size_t count;
    uint64_t beside; /* pairs that no axis separates */
};

void fuzz_scene_find(const struct fuzz_scene *scene, struct fuzz_scene_truth *truth);
void fuzz_scene_forget(struct fuzz_scene_truth *truth);

#endif
