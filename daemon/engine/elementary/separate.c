/* separate.c - fixed directions between two features: the rejections of the kernels, of
 * one pair. */
#include "separate.h"

#include "kinds.h"
#include "reject.h"

ENG_INLINE bool separates(enum pccd_kind kind, const struct eng_query *query)
{
    struct eng_v d[2][DIFFERENCES];
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_v x[4];
#pragma GCC unroll 4
        for (int i = 0; i < 4; i++) {
            const double *at = query->x[end][i];
            x[i] = (struct eng_v){at[0], at[1], at[2]};
        }
        subtract(kind, x, d[end]);
    }
    return are_beyond(kind, d, 0, AXES, 0) ||
           are_beyond(kind, d, AXES, DIRECTIONS, diagonal_margin(kind, d));
}

bool eng_query_separates(const struct eng_query *query)
{
    return common_kinds[query->kind].points[0] == 1 ? separates(PCCD_VF, query)
                                                    : separates(PCCD_EE, query);
}
