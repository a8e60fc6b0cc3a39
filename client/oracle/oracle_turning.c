/* oracle_turning.c - when two features that turn first meet: by doubles, then by more. */
#include "oracle_turning_parts.h"
#include "oracle_turning_search.h"

void oracle_turning_find(const struct oracle_turning *pair,
                         const struct oracle_turning_asked *asked,
                         struct oracle_turning_answer *answer)
{
    struct oracle_turning_answer more;
    oracle_turning_search(pair, asked, asked->spans, answer);
    double met_by = answer->met_by < asked->to ? answer->met_by : asked->to;
    if (answer->is_free || asked->fine == 0 || answer->spans >= asked->spans ||
        (answer->met_by <= asked->to && met_by - answer->free_until <= asked->width)) {
        return;
    }
    struct oracle_turning_asked rest = *asked;
    rest.from = answer->free_until;
    rest.to = met_by;
    oracle_turning_search_fine(pair, &rest, asked->fine, &more);
    answer->spans += more.spans;
    answer->is_free = more.is_free && answer->met_by == ORACLE_TURNING_NEVER;
    answer->free_until = more.free_until;
    answer->met_by = more.met_by < answer->met_by ? more.met_by : answer->met_by;
}

bool oracle_turning_place(const struct pccd_joint *joints,
                          const struct oracle_turning_side *side, double t,
                          double x[3][3])
{
    /* Nothing cancels against what hangs on no joint. */
    const struct oracle_turning alone = {.joints = joints,
                                         .side = {*side, {.joint = PCCD_NO_JOINT}}};
    struct body bodies[2];
    struct jet places[3][3];
    if (!set_bodies(bodies, &alone)) {
        return false;
    }
    place_body(&bodies[0], ball_exact(t), places);
    for (uint32_t i = 0; i < 3 * side->points; i++) {
        x[i / 3][i % 3] = places[i / 3][i % 3].c[0].m;
    }
    return true;
}
