/* daemon/engine/elementary/thick.c - thick features, by the first stage that is sure.
 *
 * Room:     engine.
 * Does:     see thick.h.
 * Threads:  one thread for one scratch.
 */
#include "thick.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "kernel.h"
#include "kinds.h"
#include "solve.h"
#include "thick_advance.h"

/* Cells are at most 2^-30 long whatever the tolerance: who advances to a contact wants to
 * come near. */
#define DEPTH_MIN 30
#define DEPTH_MAX 40

int eng_thick_init(struct eng_thick *thick)
{
    memset(thick, 0, sizeof *thick);
    return eng_thick_exact_init(&thick->exact);
}

void eng_thick_deinit(struct eng_thick *thick)
{
    eng_thick_exact_deinit(&thick->exact);
}

/* The depth of the longest cells that are not longer than the tolerance. */
static int depth_of(double tolerance)
{
    int exponent;
    double fraction = frexp(tolerance, &exponent); /* tolerance = fraction 2^exponent */
    int depth = 1 - exponent;
    assert(fraction > 0 && depth <= DEPTH_MAX);
    return depth > DEPTH_MIN ? depth : DEPTH_MIN;
}

static void set_cell(struct eng_hit *hit, int64_t cell, int depth)
{
    hit->flags = PCCD_PROVED;
    hit->toi = eng_thick_cell_begin(cell, depth);
    hit->toi_hi = eng_thick_cell_begin(cell + 1, depth);
}

/* Of a pair that integers gave up: before which time a batch would know of no contact; 2:
 * of none at all. */
static double reached_in_lanes(const struct eng_thick_query *query)
{
    static const uint32_t quads[1][4] = {{0, 1, 2, 3}};
    const struct eng_kernels *kernels = eng_kernels_of(ENG_ISA_SCALAR);
    uint32_t kind = (uint32_t)query->query.kind;
    struct eng_point points[4];
    uint32_t kept;
    double since = 0;
    double reach = eng_thick_reach(query->radius);
    for (int i = 0; i < 4; i++) {
        memcpy(points[i].x0, query->query.x[0][i], sizeof points[i].x0);
        memcpy(points[i].x1, query->query.x[1][i], sizeof points[i].x1);
    }
    uint32_t left = kernels->stay_beyond(common_kinds[kind].points[0], points, quads, 1,
                                         &reach, &kept);
    if (left > 0 && (kind == PCCD_VF || kind == PCCD_EE)) {
        left = kernels->advance((enum pccd_kind)kind, points, quads, &kept, left, &reach,
                                1, &since);
    }
    return left > 0 ? since : 2;
}

/* The same of doubles by themselves. */
static double reached_alone(const struct eng_thick_query *query, int depth)
{
    struct eng_thick_motion motion;
    struct eng_thick_advance advance = {0};
    eng_thick_motion_load(&motion, query);
    (void)eng_thick_advance(&motion, query->approach, depth, 0, 1, &advance);
    return advance.reached;
}

/* By integers. */
static bool decide_exactly(struct eng_thick *thick, const struct eng_thick_query *query,
                           int depth, struct eng_hit *hit)
{
    struct eng_thick_verdict verdict;
    eng_thick_exact_decide(&thick->exact, query, depth, &verdict);
    thick->decided[ENG_THICK_BY_INTEGERS]++;
    if (verdict.found == ENG_THICK_NONE) {
        return false;
    }
    if (verdict.found == ENG_THICK_GIVEN_UP) {
        double reached = reached_in_lanes(query);
        if (reached > 1) {
            return false;
        }
        if (thick->first == ENG_THICK_BY_DOUBLES) {
            reached = fmax(reached, reached_alone(query, depth));
        }
        thick->possible++;
        *hit = (struct eng_hit){.toi = reached, .toi_hi = 1};
    } else if (verdict.is_initial) {
        *hit = (struct eng_hit){.flags = PCCD_PROVED | PCCD_INITIAL};
    } else {
        set_cell(hit, verdict.cell, depth);
    }
    hit->flags |= verdict.is_inside && query->approach > 0 ? PCCD_INSIDE : 0;
    return true;
}

static bool solve(struct eng_thick *thick, const struct eng_thick_query *query,
                  struct eng_thick_motion *motion, int depth, double t_end,
                  struct eng_hit *hit)
{
    struct eng_thick_advance advance = {0};
    enum eng_thick_advanced advanced =
        thick->first == ENG_THICK_BY_DOUBLES
            ? eng_thick_advance(motion, query->approach, depth, query->since, t_end,
                                &advance)
            : ENG_THICK_UNSURE;
    thick->decided[ENG_THICK_BY_DOUBLES] += advanced != ENG_THICK_UNSURE;
    switch (advanced) {
    case ENG_THICK_MISSES:
        return false;
    case ENG_THICK_INITIALLY:
        *hit = (struct eng_hit){.flags = PCCD_PROVED | PCCD_INITIAL};
        return true;
    case ENG_THICK_MEETS:
        set_cell(hit, advance.cell, depth);
        hit->flags |= advance.is_inside ? PCCD_INSIDE : 0;
        return true;
    case ENG_THICK_UNSURE:
        break;
    }
    return decide_exactly(thick, query, depth, hit);
}

static bool is_contact(const struct eng_thick_query *query)
{
    return query->radius[0] == 0 && query->radius[1] == 0 && query->radius[2] == 0 &&
           ((uint32_t)query->query.kind == PCCD_VF ||
            (uint32_t)query->query.kind == PCCD_EE);
}

bool eng_thick_solve(struct eng_thick *thick, struct eng_exact *contacts,
                     const struct eng_thick_query *query, double tolerance, double t_end,
                     struct eng_hit *hit)
{
    assert(query->approach >= 0 && query->approach < 1);
    if (is_contact(query)) {
        return eng_solve(&query->query, tolerance, t_end, contacts, hit);
    }
    struct eng_thick_motion motion;
    struct eng_hit found = {0};
    int depth = depth_of(tolerance);
    eng_thick_motion_load(&motion, query);
    if (!solve(thick, query, &motion, depth, t_end, &found) || found.toi > t_end) {
        return false;
    }
    eng_thick_describe(&motion, (uint32_t)query->query.kind, found.toi, &found);
    *hit = found;
    return true;
}
