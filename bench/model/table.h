/* table.h - writes the model's predictions as CSV.
 *
 * Threads: one.
 */
#ifndef MODEL_TABLE_H
#define MODEL_TABLE_H

#include <stdio.h>

#include "sim.h"

struct model_row {
    const char *scene;
    const char *scheduler;
    const char *high_level;
    const char *refit;
    uint32_t threads;
    double speedup;
    const struct model_output *output;
};

void model_table_begin(FILE *out);
void model_table_row(FILE *out, const struct model_row *row);

#endif
