/* near_work.h - what one thread needs to find out what is near.
 *
 * Threads: [team]; it belongs to one thread.
 */
#ifndef ENG_NEAR_WORK_H
#define ENG_NEAR_WORK_H

#include "closest_features.h"
#include "distance.h"
#include "finding.h"
#include "question.h"
#include "worker.h"
#include "world.h"

/* Records of the last features, by key, to each of which others of its name are added
 * where it is: most of them follow soon. record NULL: none. */
#define ENG_NEAR_RECENT_BITS 10
#define ENG_NEAR_RECENT      (1u << ENG_NEAR_RECENT_BITS)

struct eng_near_recent {
    uint64_t key;
    struct pccd_near *record;
};

struct eng_near_work {
    struct eng_distances distances;
    struct eng_distance_batch batch;
    struct pccd_pair names[ENG_CHUNK_MAX]; /* of what the batch has found */
    bool has_recent;                       /* there is any */
    struct eng_near_recent recent[ENG_NEAR_RECENT];
    struct eng_edges_known edges;
    double least;    /* d_lo of what was found; 2e18: nothing was */
    double greatest; /* d_hi likewise; 0 */
    uint64_t pairs;  /* that were found, but for crossings */
    uint64_t crossings;
};

/* That of a worker, as long as it has one. */
static inline struct eng_near_work *eng_near_work_of(const struct eng_worker *worker)
{
    return worker->near_work;
}

/* Memory for a worker, once. PCCD_E_NOMEM. [compute] */
int eng_near_work_reserve(struct eng_worker *worker);
void eng_near_work_free(struct eng_worker *worker);
uint64_t eng_near_work_bytes(const struct eng_worker *worker);

/* The range of all names in a scene. */
struct eng_name_range eng_near_range(const struct eng_scene *scene);

/* Get ready for a query, names being within a range. [compute] */
void eng_near_work_begin(struct eng_worker *worker, const struct eng_name_range *range);

/* Test `count` candidates of VF or EE, at most ENG_CHUNK_MAX, as in distance.h, and
 * keep what is near; returns how many, of which work->batch tells. `is_sifted`: as there.
 * Words of the points: word0 is the index of
 * the object << 32 | the vertex's in the scene's arrays, word1 the id of the object << 32
 * | the vertex's in its mesh. */
uint32_t eng_near_test(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_point *points, const uint32_t (*quads)[4],
                       uint32_t count, bool is_sifted, eng_names_fn names);

/* The same of candidates of EF: the ends of the edge, the corners of the face. Beside
 * other questions than CROSSINGS they are counted alone. */
void eng_near_cross(struct eng_worker *worker, const struct eng_point *points,
                    const uint32_t (*fives)[5], uint32_t count, eng_names_fn names);

#endif
