/* thick.c - thick features, by the first stage that is sure. */
#include "thick.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "kernel.h"
#include "kinds.h"
#include "solve.h"

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

int eng_thick_depth(double tolerance)
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

/* ---- the points of a query, as kernels have them ----------------------------------- */

static const uint32_t quads[1][4] = {{0, 1, 2, 3}};
static const uint32_t pairs[1] = {0};

static const struct eng_kernels *set_points(const struct eng_query *query,
                                            struct eng_point points[4])
{
    for (int i = 0; i < 4; i++) {
        memcpy(points[i].x0, query->x[0][i], sizeof points[i].x0);
        memcpy(points[i].x1, query->x[1][i], sizeof points[i].x1);
    }
    return eng_kernels_of(ENG_ISA_SCALAR);
}

/* By doubles. */
static void advance_alone(const struct eng_thick_query *query, int depth, double t_end,
                          struct eng_advance *advance)
{
    struct eng_point points[4];
    const struct eng_kernels *kernels = set_points(&query->query, points);
    const struct eng_advance_limits limits = {query->approach, t_end, depth};
    *advance = (struct eng_advance){.lo = eng_thick_sum(query->radius)};
    kernels->advance((struct eng_quads){(uint32_t)query->query.kind, points, quads},
                     pairs, 1, &limits, advance);
}

/* ---- decisions --------------------------------------------------------------------- */

static bool decide_exactly(struct eng_thick *thick, const struct eng_thick_query *query,
                           int depth, struct eng_hit *hit)
{
    struct eng_thick_verdict verdict;
    eng_thick_exact_decide(&thick->exact, query, depth, &verdict);
    thick->decided[ENG_THICK_BY_INTEGERS]++;
    if (!verdict.is_found) {
        return false;
    }
    if (verdict.is_initial) {
        *hit = (struct eng_hit){.flags = PCCD_PROVED | PCCD_INITIAL};
    } else {
        set_cell(hit, verdict.cell, depth);
    }
    hit->flags |= verdict.is_inside && query->approach > 0 ? PCCD_INSIDE : 0;
    return true;
}

bool eng_thick_decide(struct eng_thick *thick, const struct eng_thick_query *query,
                      const struct eng_advance *advance, double tolerance, double t_end,
                      struct eng_hit *hit)
{
    int depth = eng_thick_depth(tolerance);
    struct eng_hit found = {0};
    thick->decided[ENG_THICK_BY_DOUBLES] += advance->now != ENG_ADVANCE_UNDECIDED;
    switch ((enum eng_advanced)advance->now) {
    case ENG_ADVANCE_MISSES:
        return false;
    case ENG_ADVANCE_INITIALLY:
        found.flags = PCCD_PROVED | PCCD_INITIAL;
        break;
    case ENG_ADVANCE_MEETS:
        set_cell(&found, (int64_t)advance->cell, depth);
        found.flags |= advance->is_inside ? PCCD_INSIDE : 0;
        break;
    case ENG_ADVANCE_UNDECIDED:
        if (!decide_exactly(thick, query, depth, &found)) {
            return false;
        }
    }
    *hit = found;
    return found.toi <= t_end;
}

bool eng_thick_is_thin(uint32_t kind, const double radius[3])
{
    return radius[0] == 0 && radius[1] == 0 && radius[2] == 0 &&
           (kind == PCCD_VF || kind == PCCD_EE);
}

bool eng_thick_solve(struct eng_thick *thick, struct eng_exact *contacts,
                     const struct eng_thick_query *query, double tolerance, double t_end,
                     struct eng_hit *hit)
{
    uint32_t kind = (uint32_t)query->query.kind;
    struct eng_point points[4];
    struct eng_advance advance;
    struct eng_hit found;
    assert(query->approach >= 0 && query->approach < 1);
    if (eng_thick_is_thin(kind, query->radius)) {
        return eng_solve(&query->query, tolerance, t_end, contacts, hit);
    }
    advance_alone(query, eng_thick_depth(tolerance), t_end, &advance);
    if (thick->first == ENG_THICK_BY_INTEGERS) {
        advance.now = ENG_ADVANCE_UNDECIDED;
    }
    if (!eng_thick_decide(thick, query, &advance, tolerance, t_end, &found)) {
        return false;
    }
    set_points(&query->query, points)
        ->describe((struct eng_quads){kind, points, quads}, pairs, 1, &found);
    *hit = found;
    return true;
}
