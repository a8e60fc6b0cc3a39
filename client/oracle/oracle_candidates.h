/* oracle_candidates.h - pairs of features that may be near, and their records. */
#ifndef ORACLE_ORACLE_CANDIDATES_H
#define ORACLE_ORACLE_CANDIDATES_H

#include "oracle_features.h"
#include "oracle_near.h"

/* Two features that boxes do not keep apart, in the order of their record. */
struct oracle_candidate {
    const struct oracle_feature *a;
    const struct oracle_feature *b;
    bool is_thin; /* it has no radii */
};

struct oracle_candidates {
    struct oracle_candidate *items;
    size_t count;
    size_t capacity;
};

/* Pairs of one of `left` and one of `right`, of two that may meet, that share no vertex
 * and are not left thin; `left` and `right` may be the same. Added to *candidates. */
void oracle_candidates_find(const struct oracle_moment *moment,
                            const struct oracle_features *left,
                            const struct oracle_features *right, double distance,
                            struct oracle_candidates *candidates);
void oracle_candidates_deinit(struct oracle_candidates *candidates);

/* Points of a candidate, and the order of (object, vertex); of one that is there twice,
 * the first comes first. */
void oracle_candidate_load(const struct oracle_moment *moment,
                           const struct oracle_candidate *candidate, double p[5][3],
                           uint8_t rank[5]);
/* The names of near->record, of enum pccd_kind or pccd_near_kind, near->object and
 * near->radius. */
void oracle_candidate_name(const struct oracle_moment *moment, uint32_t kind,
                           const struct oracle_candidate *candidate,
                           struct oracle_near *near);
void oracle_near_write(const struct oracle_distance *distance, struct oracle_near *near);

/* One more, of zeros. */
struct oracle_near *oracle_nears_add(struct oracle_nears *nears);
void oracle_nears_sort(struct oracle_nears *nears);

#endif
