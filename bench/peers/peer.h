/* peer.h - the interface through which every compared library finds pairs of boxes.
 *
 * A library is asked for the candidates of a step: a vertex and a face, or two edges,
 * whose boxes overlap (touching counts) and that share no vertex. A box encloses a
 * feature at both ends of the step; every library gets the same floats.
 * Threads: a sink belongs to one thread of the library.
 */
#ifndef PEERS_PEER_H
#define PEERS_PEER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct peer_box {
    float lo[3];
    float hi[3];
};

/* All vertices, all edges or all faces of a scene; the last corner is repeated where a
 * feature has fewer than three. */
struct peer_features {
    uint32_t count;
    struct peer_box *boxes;
    uint32_t (*corners)[3];
};

enum peer_group { PEER_VERTICES, PEER_EDGES, PEER_FACES, PEER_GROUPS };

struct peer_input {
    struct peer_features groups[PEER_GROUPS];
};

enum peer_kind { PEER_VF = 0, PEER_EE = 1 };

#define PEER_SINK_MAX 16u
#define PEER_RING     1024u /* pairs: ENG_CHUNK_MAX, what is tested at a time */

/* Pairs of one thread. Where pairs alone are asked for, what a caller would do with them
 * is none of the library's time: they are written to a ring that stays in the first
 * cache, and are summed up only when the sets are compared. */
struct peer_sink {
    uint64_t count[2]; /* by enum peer_kind */
    uint64_t sum[2];   /* of a hash of each pair: equal for equal sets */
    bool is_summed;
    /* Called with each ring that is full. NULL: rings are only overwritten. */
    void (*test)(void *tester, enum peer_kind kind, const uint32_t (*pairs)[2],
                 uint32_t count);
    void *tester;
    uint32_t ring[2][PEER_RING][2];
} __attribute__((aligned(128)));

static inline uint64_t peer_mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* VF: vertex, face. EE: in any order. */
static inline void peer_take(struct peer_sink *sink, enum peer_kind kind, uint32_t a,
                             uint32_t b)
{
    uint32_t *slot = sink->ring[kind][sink->count[kind]++ % PEER_RING];
    slot[0] = a;
    slot[1] = b;
    if (sink->test && sink->count[kind] % PEER_RING == 0) {
        sink->test(sink->tester, kind, sink->ring[kind], PEER_RING);
    }
    if (sink->is_summed) {
        bool swap = kind == PEER_EE && a > b;
        sink->sum[kind] += peer_mix(((uint64_t)(swap ? b : a) << 32 | (swap ? a : b)) +
                                    0x9e3779b97f4a7c15u);
    }
}

/* Boolean sums, not chains of branches: which is true cannot be foreseen. */
static inline bool peer_face_has(const uint32_t face[3], uint32_t vertex)
{
    return ((face[0] == vertex) | (face[1] == vertex) | (face[2] == vertex)) != 0;
}

static inline bool peer_edges_meet(const uint32_t a[3], const uint32_t b[3])
{
    return ((a[0] == b[0]) | (a[0] == b[1]) | (a[1] == b[0]) | (a[1] == b[1])) != 0;
}

/* Two features whose boxes overlap: a pair, unless they share a vertex. */
static inline void peer_offer(const struct peer_input *input, enum peer_kind kind,
                              struct peer_sink *sink, uint32_t a, uint32_t b)
{
    if (kind == PEER_VF ? !peer_face_has(input->groups[PEER_FACES].corners[b], a)
                        : !peer_edges_meet(input->groups[PEER_EDGES].corners[a],
                                           input->groups[PEER_EDGES].corners[b])) {
        peer_take(sink, kind, a, b);
    }
}

static inline bool peer_overlap(const struct peer_box *a, const struct peer_box *b)
{
    return ((a->lo[0] <= b->hi[0]) & (b->lo[0] <= a->hi[0]) & (a->lo[1] <= b->hi[1]) &
            (b->lo[1] <= a->hi[1]) & (a->lo[2] <= b->hi[2]) & (b->lo[2] <= a->hi[2])) !=
           0;
}

struct peer {
    const char *name;
    bool is_parallel; /* can use more than one thread */
    void (*version)(char *text, size_t capacity);
    /* Build what is kept from step to step; not timed. `input` outlives the answer; its
     * boxes may change before an update. NULL: it cannot be done, and has said why. */
    void *(*open)(const struct peer_input *input, uint32_t threads);
    /* Take the boxes as they are now. */
    void (*update)(void *self);
    /* Give every candidate once, to sinks 0 .. PEER_SINK_MAX - 1. */
    void (*collide)(void *self, struct peer_sink *sinks);
    void (*close)(void *self);
    /* Where `collide` updates as well: what that took the last time. NULL: update did. */
    uint64_t (*update_ns)(void *self);
};

extern const struct peer peer_embree;
extern const struct peer peer_fcl;
extern const struct peer peer_bullet;
extern const struct peer peer_cgal;

#ifdef __cplusplus
}

/* The peer that a class is: made of the input and a number of threads; with `version`,
 * `update` and `collide`. */
template <class T> constexpr peer peer_of(const char *name, bool is_parallel)
{
    return {name,
            is_parallel,
            T::version,
            [](const peer_input *input, uint32_t threads) -> void * {
                return new T(input, threads);
            },
            [](void *self) { static_cast<T *>(self)->update(); },
            [](void *self, peer_sink *sinks) { static_cast<T *>(self)->collide(sinks); },
            [](void *self) { delete static_cast<T *>(self); },
            nullptr};
}
#endif

#endif
