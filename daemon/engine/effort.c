/* effort.c - does a team pay for a step?
 *
 * Compare the expected work with what it costs to wake a team; where that is near, go by
 * the clock: beside other processes a team waits for a thread that has lost its
 * processor, and what it saves is less than that.
 */
#include "step_memory.h"

#include <assert.h>
#include <string.h>

/* Work from which a team is woken, and below which it is not any more: between them the
 * last answer stands, so that a scene at the border does not go to and fro. */
#define PAYS_FROM_NS          300000u
#define PAYS_NO_MORE_BELOW_NS 150000u

/* Work from which a team is woken whatever the clock says: one that must wait now and
 * then is lucky again soon, and has much to save. */
#define PAYS_SURELY_FROM_NS 2000000u

/* Between these the other way is tried again, every so many steps, and believed by so
 * much. */
#define TRY_EVERY 32u
#define SMOOTH    8u

/* Work of a triangle in a scene of which nothing is known yet: that of a mesh that is
 * near nothing but itself. */
#define TRIANGLE_NS 500u

/* Return whether the team is, by the clock. It is, until one thread has been tried. */
static bool is_quicker(struct eng_effort *effort, enum pccd_mode mode)
{
    struct eng_effort_took *took = &effort->took[mode];
    if (took->team_ns == 0) {
        return true;
    }
    bool quicker = took->alone_ns == 0 || took->team_ns < took->alone_ns;
    return ++took->turns % TRY_EVERY == 0 ? !quicker : quicker;
}

uint64_t eng_effort_expects(const struct eng_effort *effort, enum pccd_mode mode,
                            uint32_t triangles)
{
    uint64_t work_ns = effort->work_ns[mode];
    return work_ns > 0 ? work_ns : (uint64_t)triangles * TRIANGLE_NS;
}

bool eng_effort_is_enough(uint64_t work_ns)
{
    return work_ns >= PAYS_FROM_NS;
}

bool eng_effort_pays(struct eng_effort *effort, enum pccd_mode mode, uint32_t triangles)
{
    assert(mode < PCCD_MODE_COUNT);
    uint64_t work_ns = eng_effort_expects(effort, mode, triangles);
    if (effort->work_ns[mode] == 0) { /* which what comes of it must not cling to */
        return eng_effort_is_enough(work_ns);
    }
    effort->paid = work_ns >= (effort->paid ? PAYS_NO_MORE_BELOW_NS : PAYS_FROM_NS);
    return effort->paid && (work_ns >= PAYS_SURELY_FROM_NS || is_quicker(effort, mode));
}

bool eng_effort_pays_for(const struct eng_effort *effort, enum pccd_mode mode,
                         double part)
{
    assert(part >= 0 && part <= 1);
    return (double)effort->work_ns[mode] * part >= PAYS_FROM_NS;
}

void eng_effort_learn(struct eng_effort *effort, enum pccd_mode mode, uint64_t work_ns)
{
    assert(mode < PCCD_MODE_COUNT);
    uint64_t old_ns = effort->work_ns[mode];
    /* A thread that was off its processor for a while looks as if it had worked: believe
     * a factor of two for each step. */
    if (old_ns > 0 && work_ns / 2 > old_ns) {
        work_ns = 2 * old_ns;
    } else if (work_ns < old_ns / 2) {
        work_ns = old_ns / 2;
    }
    effort->work_ns[mode] = work_ns > 0 ? work_ns : 1;
}

void eng_effort_learn_part(struct eng_effort *effort, enum pccd_mode mode, double part,
                           uint64_t work_ns)
{
    assert(mode < PCCD_MODE_COUNT && part >= 0 && part <= 1);
    double most_ns = (double)effort->work_ns[mode];
    if ((double)work_ns < most_ns * part) {
        eng_effort_learn(effort, mode, (uint64_t)((double)work_ns / part));
    }
}

void eng_effort_time(struct eng_effort *effort, enum pccd_mode mode, bool by_team,
                     uint64_t took_ns)
{
    assert(mode < PCCD_MODE_COUNT);
    struct eng_effort_took *took = &effort->took[mode];
    uint64_t *smooth_ns = by_team ? &took->team_ns : &took->alone_ns;
    uint64_t most_ns = *smooth_ns > 0 ? SMOOTH * *smooth_ns : took_ns;
    uint64_t believed_ns = took_ns < most_ns ? took_ns : most_ns;
    *smooth_ns = *smooth_ns == 0 ? believed_ns
                                 : (*smooth_ns * (SMOOTH - 1) + believed_ns) / SMOOTH;
    *smooth_ns += *smooth_ns == 0; /* it is known now */
}

void eng_effort_forget(struct eng_effort *effort)
{
    memset(effort, 0, sizeof *effort);
}
