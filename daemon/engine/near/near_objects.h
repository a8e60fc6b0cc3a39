/* near_objects.h - what is asked of objects two by two: which of their features are
 * nearest, and how deep one is in the other.
 */
#ifndef ENG_NEAR_OBJECTS_H
#define ENG_NEAR_OBJECTS_H

#include "near_search.h"
#include "topology.h"

/* A mesh that is not closed: of the object of that id. */
struct eng_open_mesh_error {
    uint32_t object;
    struct eng_open_edge edge;
};

/* Which features of two objects were the nearest last time, by their objects. They are
 * looked at first, so that all that is farther is left out from the beginning: what is
 * nearest does not depend on it. */
struct eng_nearest_cache {
    struct pccd_pair *entries; /* [capacity] by a hash of the objects; all 0: none */
    uint32_t capacity;         /* 0 or a power of two */
    uint32_t count;
};

struct eng_near_objects {
    const struct eng_scene *scene;
    struct eng_question ask; /* NEAREST or DEPTH, which has no gap */
    uint32_t chosen[2];      /* indices, or ENG_NO_OBJECT */
    struct eng_nearest_cache cache;
    struct eng_near_share *shares; /* [share_capacity]; NEAREST: by x */
    uint32_t share_count;
    uint32_t share_capacity;
    atomic_uint next;               /* of the shares */
    atomic_uint_fast64_t crossings; /* DEPTH: so far */
    struct eng_near_search *searches[ENG_THREADS_MAX];
    uint32_t search_count;
};

void eng_near_objects_deinit(struct eng_near_objects *objects);
uint64_t eng_near_objects_bytes(const struct eng_near_objects *objects);

/* Get ready, for that many threads; where the scene stands does not matter yet.
 * PCCD_E_HANDLE: no object of an id; PCCD_E_NOMEM; PCCD_E_INVAL: an object beside itself;
 * or DEPTH of a mesh that is not closed: of all that are asked for and may meet another
 * *open is that of the least id, else open->object is 0. [compute] */
int eng_near_objects_prepare(struct eng_near_objects *objects,
                             const struct eng_scene *scene,
                             const struct eng_question *ask, uint32_t threads,
                             struct eng_open_mesh_error *open);

/* Begin a search, after the positions have moved on. [compute] */
void eng_near_objects_begin(struct eng_near_objects *objects);

/* Do a thread's part, after the refit; boxes are those of `method`. [team] */
void eng_near_objects_perform(struct eng_near_objects *objects,
                              const struct eng_method_calls *method,
                              struct eng_worker *worker);

/* Return the crossings of DEPTH; after the search. [compute] */
uint64_t eng_near_objects_crossings(const struct eng_near_objects *objects);

/* Forget where the next search begins, as objects came, went or have another mesh.
 * [compute] */
void eng_near_objects_forget(struct eng_near_objects *objects);

/* Keep from the records of a complete answer where the next search begins. [compute] */
void eng_near_objects_learn(struct eng_near_objects *objects, const void *records,
                            uint64_t count);

#endif
