/* kinds.h - the kinds of contact: which features meet, such as a vertex and a face, and
 * what the kind is called.
 *
 * Make a table of PCCD_KIND_LIST, so that code can go by the number of points of a side,
 * without a case for each kind. Where the kind is a constant in the code, so are the
 * numbers of its row.
 */
#ifndef COMMON_KINDS_H
#define COMMON_KINDS_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

/* Kinds of contact, then those that only answers about what is near have. */
#define COMMON_KIND_COUNT ((unsigned)PCCD_EF + 1)

static_assert(COMMON_KIND_COUNT <= PCCD_KINDS_MAX, "there is a count for each kind");

struct common_kind {
    const char *name;   /* "vf" */
    uint32_t points[2]; /* of the feature of a, and of that of b */
};

static const struct common_kind common_kinds[COMMON_KIND_COUNT] = {
#define COMMON_KIND(NAME, value, name, points_a, points_b, text)                         \
    [PCCD_##NAME] = {#name, {points_a, points_b}},
    PCCD_KIND_LIST(COMMON_KIND) PCCD_NEAR_KIND_LIST(COMMON_KIND)
#undef COMMON_KIND
};

/* By its points: "vertex", "edge", "face". */
static const char *const common_feature_names[4] = {"", "vertex", "edge", "face"};

/* Return whether a contact with these parameters is at a vertex of both features. */
static inline bool common_is_at_vertices(const float param[2])
{
    return (param[0] == 0 || param[0] == 1) && (param[1] == 0 || param[1] == 1);
}

/* Find where a contact with these parameters lies on its features: the weights of the
 * points of a, w[0], and of b, w[1]. The parameters are the weights of all points but the
 * first of either; VF: of the face's second and third, EE: of the second of each edge,
 * VE: the second parameter, of the edge's second. Not EF, which has more points than two
 * parameters tell. */
static inline void common_contact_weights(enum pccd_kind kind, const float param[2],
                                          double w[2][3])
{
    uint32_t next = kind == PCCD_VE;
    assert(common_kinds[kind].points[0] + common_kinds[kind].points[1] <= 4);
    for (int side = 0; side < 2; side++) {
        w[side][0] = 1;
        w[side][1] = 0;
        w[side][2] = 0;
        for (uint32_t i = 1; i < common_kinds[kind].points[side]; i++) {
            w[side][i] = (double)param[next++];
            w[side][0] -= w[side][i];
        }
    }
}

#endif
