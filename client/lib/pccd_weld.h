/* pccd_weld.h - vertices of a mesh that are one, though it has several of them.
 *
 * Find vertices that are at one place in every frame: exporters split them at normals and
 * seams of textures, and what was split touches itself there. It needs no client. Nothing
 * is renumbered: a vertex that is joined to another one stays where it is, and nothing
 * names it any more.
 *
 * Threads: a weld belongs to one thread at a time; several threads may have one each.
 *
 *     struct pccd_weld *weld;
 *     pccd_weld_begin(&mesh, 0, false, &weld);
 *     for (each frame) {
 *         pccd_weld_frame(weld, x, PCCD_FORMAT_F64);
 *     }
 *     to = pccd_weld_read(weld, NULL);
 *     for (each corner of a triangle) {
 *         triangles[i] = to[triangles[i]];
 *     }
 *     pccd_weld_end(weld);
 *
 * A function that returns int returns 0 or a negative status, and pccd_error_text(NULL)
 * says then what was wrong.
 */
#ifndef PCCD_WELD_H
#define PCCD_WELD_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

struct pccd_mesh_data; /* pccd.h */
struct pccd_weld;

/* Counts of what became of the vertices in the frames so far. */
struct pccd_weld_counts {
    uint32_t joined; /* vertices that another one stands for */
    uint32_t
        apart;     /* another one stood for them in the first frame, but has moved away */
    uint32_t more; /* would be joined at more_distance */
    double more_distance; /* 2^-40 of the longest side of the box of the first frame: so
                             near nobody puts two vertices on purpose */
};

/* Begin, with the triangles, edges and points of `mesh`; nothing of it is kept, and x,
 * format and radii are not read. Of the vertices that these name, or of all, where there
 * are none of them, each one is joined to the least other one that is at most `distance`
 * away and is joined to none itself. `distance` is finite, in the unit of x; 0: they are
 * equal, as 0 and -0 are. `tells_more`, with the distance 0: count `more`, too, at the
 * price of a second search. Memory: 12 bytes a vertex, and 16 more in a frame; with
 * tells_more 12 more. Errors: E_INVAL, E_INDEX, E_NOMEM. */
int pccd_weld_begin(const struct pccd_mesh_data *mesh, double distance, bool tells_more,
                    struct pccd_weld **weld);

/* Begin with the first frame, or go on with another one: part what is farther apart
 * there. `x` is [vertex_count][3], of `format`. What was parted is not joined again:
 * once joined + more is 0, no frame changes that. Two whose common one has gone stay
 * one if both were so near to it that they have never been farther apart than the
 * distance either. Errors: E_INVAL; E_NOTFINITE: a coordinate is not, or is above
 * 1e18; E_NOMEM: only pccd_weld_end is of use then. */
int pccd_weld_frame(struct pccd_weld *weld, const void *x, enum pccd_format format);

/* Return the vertex that stands for each, [vertex_count]: the least of those that are one
 * with it. NULL before the first frame; then it stays, and frames change it, until
 * pccd_weld_end. `counts` may be NULL. */
const uint32_t *pccd_weld_read(const struct pccd_weld *weld,
                               struct pccd_weld_counts *counts);

/* Free it; NULL is allowed. */
void pccd_weld_end(struct pccd_weld *weld);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
