/* thick_work.h - what one thread needs to test pairs that meet at a distance.
 *
 * Of a chunk of candidates test those whose features have a distance (thickness.h) and
 * are not left thin by rest, and keep what the mode of the step wants; leave the others.
 *
 * Threads: [team]; it belongs to one thread.
 */
#ifndef ENG_THICK_WORK_H
#define ENG_THICK_WORK_H

#include "distance.h"
#include "finding.h"
#include "thick_batch.h"
#include "thickness.h"

struct eng_thick_work {
    struct eng_thick thick;
    struct eng_distances distances; /* of registered positions */
    struct eng_thick_batch batch;
    uint64_t candidates; /* tested in this step */
    uint64_t survivors;
    uint32_t rest[ENG_CHUNK_MAX]; /* the candidates that are left */
    uint32_t pair[ENG_CHUNK_MAX]; /* those that are tested */
    uint32_t quads[ENG_CHUNK_MAX][4];
    double radius[ENG_CHUNK_MAX][3];
    double reach[ENG_CHUNK_MAX];
    uint32_t left[ENG_CHUNK_MAX]; /* of those taken, by place */
    bool is_thin[ENG_CHUNK_MAX];  /* of the candidates: is it left? */
};

static inline struct eng_thick_work *eng_thick_work_of(const struct eng_worker *worker)
{
    return worker->thick_work;
}

/* Memory for a worker, once. PCCD_E_NOMEM. [compute] */
int eng_thick_work_reserve(struct eng_worker *worker);
void eng_thick_work_free(struct eng_worker *worker);
uint64_t eng_thick_work_bytes(const struct eng_worker *worker);

/* Get ready for a step. [compute] */
void eng_thick_work_begin(struct eng_worker *worker);

/* In a step with thickness: take those of `count` candidates, at most ENG_CHUNK_MAX, that
 * have a distance. The others, work->rest[..], are left; returns how many. is_sifted: the
 * method has left out many already. Words of the points: as for eng_near_test. */
uint32_t eng_thick_test(struct eng_worker *worker, enum pccd_kind kind,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        uint32_t count, bool is_sifted, eng_names_fn names);

/* Of what is near: is a pair whose distance is *found within that of the question and its
 * radii, and not left out for its rest? Exactly. VERTICES: found->lo becomes its bound,
 * and what is left thin has no radii. */
bool eng_thick_is_near(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_point *points, const uint32_t quad[4],
                       struct eng_distance *found);

/* Mode pairs: is a pair left out, as along an axis all points of one feature lie more
 * than r above all points of the other, at both ends of the step? Decided exactly. */
bool eng_thick_is_apart(const struct eng_point *const points[4], uint32_t points_a,
                        uint32_t points_b, const double radius[3]);

#endif
