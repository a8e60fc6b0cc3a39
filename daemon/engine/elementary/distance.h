/* distance.h - the exact distance of two features at one moment, for answers about what
 * is near: of a vertex and a face, an edge or a vertex, or of two edges; and whether an
 * edge passes through a face.
 *
 * Decide whether two closed features are within a distance, exactly, and say between
 * which of their points the distance is, how long, where and in which direction. Every
 * number is defined by the points alone, so it is the same whichever stage has found it:
 * doubles with margins, pairs of doubles or integers.
 *
 * Threads: one thread for one struct eng_distances. Decisions allocate nothing.
 * Source: BOUNDS.md, "Distances".
 *
 * Everywhere x are the points of a pair at one moment, finite, of magnitude at most 1e18.
 * VF: the vertex, then the face's corners. EE: the ends of one edge, then of the other.
 * A face may be a segment or a point, an edge a point. So VE and VV are VF of a face
 * whose last corner is repeated.
 */
#ifndef ENG_DISTANCE_H
#define ENG_DISTANCE_H

#include "number.h"
#include "pccd_types.h"
#include "query.h"

/* The stages that find a decision; the answer is the same. */
enum eng_distance_stage {
    ENG_DISTANCE_BY_DOUBLES,
    ENG_DISTANCE_BY_PAIRS,
    ENG_DISTANCE_BY_INTEGERS,
    ENG_DISTANCE_STAGES
};

/* Return the kind by whose rule pairs of a kind are decided. */
static inline enum pccd_kind eng_distance_form(enum pccd_kind kind)
{
    return kind == PCCD_EE ? PCCD_EE : PCCD_VF;
}

struct eng_distances {
    struct eng_numbers numbers;
    enum eng_distance_stage first; /* the stage to begin with; for tests */
    uint64_t decided[ENG_DISTANCE_STAGES];
};

/* Allocate the integers. PCCD_E_NOMEM: there is nothing to deinit. What follows never
 * fails for memory. */
int eng_distances_init(struct eng_distances *distances);
void eng_distances_deinit(struct eng_distances *distances);

/* Convert params found by the rule of a kind's form to those of the kind: VE param[1] is
 * where on the edge, 0 at its first end; VV has none. */
static inline void eng_distance_convert_params(enum pccd_kind kind,
                                               struct eng_distance *distance)
{
    if (kind == PCCD_VE || kind == PCCD_VV) {
        distance->param[1] =
            kind == PCCD_VE ? distance->param[0] + distance->param[1] : 0;
        distance->param[0] = 0;
    }
}

/* Return whether the distance is at most d, 0 <= d <= 1e18. Exactly d is within. */
bool eng_distance_within(struct eng_distances *distances, enum pccd_kind kind,
                         const double x[4][3], double d);

/* Return whether it is less than d. Exactly d is not. */
bool eng_distance_below(struct eng_distances *distances, enum pccd_kind kind,
                        const double x[4][3], double d);

/* Find the distance and between which points it is. rank: of each point, no two alike;
 * the order of (object, vertex); of one that is there more than once, the first comes
 * first. */
void eng_distance_find(struct eng_distances *distances, enum pccd_kind kind,
                       const double x[4][3], const uint8_t rank[4],
                       struct eng_distance *distance);

/* Bounds that doubles give of a distance. */
struct eng_distance_bounds {
    double lo, hi;   /* it is between them */
    uint32_t points; /* bit i: it is between these points, as in struct eng_distance */
};

/* Set *bounds by doubles. False: they do not know. */
bool eng_distance_bound(enum pccd_kind kind, const double x[4][3],
                        struct eng_distance_bounds *bounds);

/* Return whether the ends x[0], x[1] of an edge lie strictly on different sides of the
 * plane of the face x[2], x[3], x[4], and the edge passes strictly through its inside. */
bool eng_distance_crosses(struct eng_distances *distances, const double x[5][3]);
/* Return, for an edge that does, the nearest multiple of 2^-32 to the position along it
 * where it passes through, halves to even: 0 at x[0], 1 at x[1]. */
double eng_distance_crossing(struct eng_distances *distances, const double x[5][3]);

#endif
