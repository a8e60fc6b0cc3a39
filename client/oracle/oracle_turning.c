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
