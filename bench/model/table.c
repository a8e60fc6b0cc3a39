/* table.c - predictions as lines of CSV. */
#include "table.h"

#include <stddef.h>
#include <string.h>

/* Times of struct model_output. */
static const struct {
    const char *name;
    size_t offset;
} columns[] = {
    {"ms", offsetof(struct model_output, total)},
    {"refit_ms", offsetof(struct model_output, refit)},
    {"low_ms", offsetof(struct model_output, low)},
    {"high_ms", offsetof(struct model_output, high)},
    {"merge_ms", offsetof(struct model_output, merge)},
    {"serial_ms", offsetof(struct model_output, serial)},
    {"wait_ms", offsetof(struct model_output, wait)},
    {"refit_work_ms", offsetof(struct model_output, refit_work)},
    {"low_work_ms", offsetof(struct model_output, low_work)},
    {"high_work_ms", offsetof(struct model_output, high_work)},
    {"merge_work_ms", offsetof(struct model_output, merge_work)},
    {"critical_ms", offsetof(struct model_output, critical)},
    {"largest_ms", offsetof(struct model_output, largest)},
};
#define COLUMNS (sizeof columns / sizeof columns[0])

void model_table_begin(FILE *out)
{
    fprintf(out, "scene,scheduler,high_level,refit,p,speedup");
    for (size_t i = 0; i < COLUMNS; i++) {
        fprintf(out, ",%s", columns[i].name);
    }
    fprintf(out, ",hand_overs,sleeps\n");
}

void model_table_row(FILE *out, const struct model_row *row)
{
    fprintf(out, "%s,%s,%s,%s,%u,%.3f", row->scene, row->scheduler, row->high_level,
            row->refit, row->threads, row->speedup);
    for (size_t i = 0; i < COLUMNS; i++) {
        double ns;
        memcpy(&ns, (const char *)row->output + columns[i].offset, sizeof ns);
        fprintf(out, ",%.4f", ns * 1e-6);
    }
    fprintf(out, ",%llu,%llu\n", (unsigned long long)row->output->hand_overs,
            (unsigned long long)row->output->sleeps);
    fflush(out);
}
