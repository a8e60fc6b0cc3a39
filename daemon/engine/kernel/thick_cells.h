/* thick_cells.h - the cells of time of thick contacts, a pair to each lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 */
#ifndef ENG_THICK_CELLS_H
#define ENG_THICK_CELLS_H

#include "lanes.h"

/* Into which part of a cell of plain halves a cell begins. */
#define ENG_THICK_CELLS_OFFSET (1365 / 4096.0)

/* Numbers of cells are doubles: whole, from -1 to 2^40. */
struct eng_thick_cells {
    eng_d count; /* in the step, and its inverse: powers of two */
    eng_d length;
    eng_d last;
};

/* Where a cell begins that is not the first; exactly. */
ENG_INLINE eng_d eng_thick_border(const struct eng_thick_cells *cells, eng_d cell)
{
    return (cell + ENG_THICK_CELLS_OFFSET) * cells->length;
}

/* Of a time, 0 <= t <= 1. What rounds to a whole number may be one too many. */
ENG_INLINE eng_d eng_thick_cell(const struct eng_thick_cells *cells, eng_d t)
{
    const eng_d whole = eng_d_all(0x1.8p52);
    eng_d near = (t * cells->count - ENG_THICK_CELLS_OFFSET + whole) - whole;
    return eng_d_select(eng_d_less(t, eng_thick_border(cells, near)), near - 1, near);
}

/* Its first time, and its last. */
ENG_INLINE eng_d eng_thick_begin(const struct eng_thick_cells *cells, eng_d cell)
{
    return eng_d_max(eng_thick_border(cells, cell), eng_d_all(0));
}

ENG_INLINE eng_d eng_thick_end(const struct eng_thick_cells *cells, eng_d cell)
{
    eng_d next = eng_thick_border(cells, cell + 1);
    return eng_d_min(eng_d_of(eng_di_of(next) - 1), eng_d_all(1));
}

ENG_INLINE struct eng_thick_cells eng_thick_cells_of(int depth, double t_end)
{
    struct eng_thick_cells cells = {.count = eng_d_all((double)(INT64_C(1) << depth))};
    cells.length = 1 / cells.count;
    cells.last = eng_thick_cell(&cells, eng_d_all(t_end));
    return cells;
}

#endif
