/* turning_truth.c - what the oracle says of a pair that was drawn. */
#include "turning_truth.h"

#include <string.h>

#include "oracle_turning.h"

struct turning_truth turning_truth(const struct turning_drawn *drawn, double from,
                                   double to, double more, double width, uint32_t fine)
{
    struct oracle_turning pair = {.joints = drawn->joints};
    const struct oracle_turning_asked asked = {
        .from = from, .to = to, .width = width, .spans = 3000, .fine = fine};
    struct oracle_turning_answer answer;
    for (int side = 0; side < 2; side++) {
        uint32_t begin = side == 0 ? 0 : drawn->points[0];
        pair.side[side] =
            (struct oracle_turning_side){.points = drawn->points[side],
                                         .joint = drawn->link[side],
                                         .x = {&drawn->x[0][begin], &drawn->x[1][begin]}};
    }
    memcpy(pair.radius, drawn->radius, sizeof drawn->radius);
    pair.radius[3] = more;
    oracle_turning_find(&pair, &asked, &answer);
    return (struct turning_truth){answer.free_until, answer.met_by, answer.is_free,
                                  answer.spans};
}
