/* wide_sweep.h - the candidate pairs of plain swept boxes, as other libraries find them.
 *
 * Steps themselves use moving boxes, and skip what may not meet.
 * Threads: [compute]; it opens a parallel region when `threads` > 1.
 */
#ifndef ENG_WIDE_SWEEP_H
#define ENG_WIDE_SWEEP_H

#include "pccd_types.h"
#include "scene.h"

/* Called by any thread of the region with up to ENG_CHUNK_MAX pairs of keys (object id
 * << 32 | local index), in the order of records. */
typedef void (*eng_wide_visit)(void *context, enum pccd_kind kind, const uint64_t *a,
                               const uint64_t *b, uint32_t count);

struct eng_wide_sweep {
    uint64_t counts[PCCD_KIND_COUNT]; /* pairs */
    uint64_t box_tests;               /* of a box against a block of 16 */
    uint64_t refit_ns;
    uint64_t pairs_ns; /* with everything that `visit` does */
};

/* Boxes from the positions of the last step of `scene` (both ends where it stands
 * before the first), then all pairs, no pair twice, none that share a vertex.
 * `visit` NULL: pairs are counted and go no further than the chunk that the tests would
 * read. The scene's next step makes the boxes anew. PCCD_E_NOMEM. */
int eng_wide_sweep(struct eng_scene *scene, uint32_t threads, eng_wide_visit visit,
                   void *context, struct eng_wide_sweep *sweep);

#endif
