/* rebase.c - the corner from which a query is measured. */
#include "rebase.h"

#include <string.h>

#include "vec.h"

/* Largest coordinate of the difference of two points over the step. */
static double distance(const struct eng_query *query, int i, int j)
{
    double d0[3];
    double d1[3];
    eng_sub(d0, query->x[0][i], query->x[0][j]);
    eng_sub(d1, query->x[1][i], query->x[1][j]);
    double size0 = eng_size(d0);
    double size1 = eng_size(d1);
    return size0 > size1 ? size0 : size1;
}

eng_base_t eng_query_rebase(const struct eng_query *query, struct eng_query *rebased)
{
    int order[4] = {0, 1, 2, 3};
    eng_base_t base = 0;
    if (query->kind == PCCD_VF) {
        double best = distance(query, 0, 1);
        for (unsigned corner = 1; corner < 3; corner++) {
            double d = distance(query, 0, 1 + (int)corner);
            if (d < best) {
                best = d;
                base = corner;
            }
        }
        for (int k = 0; k < 3; k++) {
            order[1 + k] = 1 + ((int)base + k) % 3;
        }
    } else {
        double best = distance(query, 0, 2);
        for (unsigned ends = 1; ends < 4; ends++) {
            double d = distance(query, ends & 1 ? 1 : 0, ends & 2 ? 3 : 2);
            if (d < best) {
                best = d;
                base = ends;
            }
        }
        if (base & 1) {
            order[0] = 1;
            order[1] = 0;
        }
        if (base & 2) {
            order[2] = 3;
            order[3] = 2;
        }
    }
    rebased->kind = query->kind;
    for (int i = 0; i < 4; i++) {
        memcpy(rebased->x[0][i], query->x[0][order[i]], sizeof rebased->x[0][i]);
        memcpy(rebased->x[1][i], query->x[1][order[i]], sizeof rebased->x[1][i]);
    }
    return base;
}

/* A weight that rounding left a little outside 0 .. 1 (1 - beta - gamma) is put back. */
static float to_unit(double weight)
{
    return (float)(weight < 0 ? 0 : weight > 1 ? 1 : weight);
}

void eng_rebase_params(enum pccd_kind kind, eng_base_t base, double beta, double gamma,
                       float param[2])
{
    if (kind == PCCD_VF) {
        double weight[3];
        weight[base] = 1 - beta - gamma;
        weight[(base + 1) % 3] = beta;
        weight[(base + 2) % 3] = gamma;
        param[0] = to_unit(weight[1]);
        param[1] = to_unit(weight[2]);
    } else {
        param[0] = to_unit(base & 1 ? 1 - beta : beta);
        param[1] = to_unit(base & 2 ? 1 - gamma : gamma);
    }
}
