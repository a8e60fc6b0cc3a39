/* daemon/engine/kernel/table.h - the kernels of the instruction set being compiled.
 *
 * Room:     engine. May include: kernel.h, lanes.h.
 * Does:     declare what the files of this folder define and table.c lists.
 * Threads:  [any].
 */
#ifndef ENG_TABLE_H
#define ENG_TABLE_H

#include "kernel.h"
#include "lanes.h"

bool ENG_KERNEL(all_within)(const double *x, size_t count, double limit);
bool ENG_KERNEL(widen_within)(double *out, const float *x, size_t count, double limit);

#endif
