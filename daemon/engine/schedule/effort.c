/* daemon/engine/schedule/effort.c - does a team pay for a step?
 *
 * Room:     engine.
 * Does:     compare the expected work with what it costs to wake a team.
 * Threads:  [compute].
 */
#include "effort.h"

#include <string.h>

/* Work from which a team is woken, and below which it is not any more: between them the
 * last answer stands, so that a scene at the border does not go to and fro. */
#define PAYS_FROM_NS          300000u
#define PAYS_NO_MORE_BELOW_NS 150000u

/* Work of a triangle in a scene of which nothing is known yet: that of a mesh that is
 * near nothing but itself. */
#define TRIANGLE_NS 500u

bool eng_effort_pays(struct eng_effort *effort, enum eng_mode mode, uint32_t triangles)
{
    uint64_t work_ns = effort->work_ns[mode];
    if (work_ns == 0) { /* a guess, which what comes of it must not cling to */
        return (uint64_t)triangles * TRIANGLE_NS >= PAYS_FROM_NS;
    }
    effort->paid = work_ns >= (effort->paid ? PAYS_NO_MORE_BELOW_NS : PAYS_FROM_NS);
    return effort->paid;
}

void eng_effort_learn(struct eng_effort *effort, enum eng_mode mode, uint64_t work_ns)
{
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

void eng_effort_forget(struct eng_effort *effort)
{
    memset(effort, 0, sizeof *effort);
}
