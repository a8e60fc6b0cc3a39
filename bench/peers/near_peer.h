/* near_peer.h - the interface through which another library is asked what is near. */
#ifndef NEAR_PEER_H
#define NEAR_PEER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Numbers as enum pccd_kind and enum pccd_near_kind have. */
enum near_kind { NEAR_VF = 0, NEAR_EE = 1, NEAR_VE = 2, NEAR_VV = 3 };

/* Two features, by their numbers in the scene. EE, VV: a < b. */
struct near_name {
    uint32_t kind;
    uint32_t a;
    uint32_t b;
};

/* VF or EE, and what is said of it. */
struct near_pair {
    struct near_name name;
    struct near_name closest;
    double squared; /* the distance */
};

/* Closest features, and of how many pairs they are. */
struct near_feature {
    struct near_name name;
    uint32_t count;
};

/* A scene at one moment. The last corner of an edge is repeated. */
struct near_input {
    uint32_t vertex_count;
    uint32_t edge_count;
    uint32_t face_count;
    const double (*x)[3];
    const uint32_t (*edges)[3];
    const uint32_t (*faces)[3];
};

struct near_peer {
    const char *name;
    void (*version)(char *text, size_t capacity);
    /* Take the scene; not timed. */
    void *(*open)(const struct near_input *input);
    void (*close)(void *self);
    /* All from the positions on: find the boxes that are near, and of these .. */
    /* .. keep the pairs that are nearer than d; returns how many. */
    uint64_t (*pairs)(void *self, double d);
    /* .. the closest features; returns how many. */
    uint64_t (*features)(void *self, double d);
    /* .. find for each vertex the least distance of its pairs, at most d. */
    void (*vertices)(void *self, double d, double *bounds);
    /* What `pairs` and `features` have found; not timed. Where a library calls two edges
     * the closest features because they are nearly parallel, their own closest features
     * are told, and *relabelled counts them. */
    void (*take_pairs)(void *self, struct near_pair *pairs);
    void (*take_features)(void *self, struct near_feature *features,
                          uint64_t *relabelled);
};

/* Ways in which ipc-toolkit tests a pair that moves. */
enum near_way { NEAR_ADDITIVE, NEAR_TIGHT_INCLUSION, NEAR_WAYS };

extern const struct near_peer near_ipc_toolkit;

/* Return which share of the way, 0 .. 1, straight from the scene's positions to x1, is
 * allowed if all pairs are to stay farther apart than r. The whole computation is in it:
 * boxes, candidates, tests. self: of near_ipc_toolkit.open. */
double near_ipc_toolkit_allowed(void *self, const double (*x1)[3], double r,
                                enum near_way way);

#ifdef __cplusplus
}
#endif

#endif
