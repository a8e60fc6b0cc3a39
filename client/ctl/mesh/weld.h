/* client/ctl/mesh/weld.h - vertices that are one, though a file has them apart.
 *
 * Room:     client/ctl. May include: meshfile.h.
 * Does:     find vertices that are at one place in every frame: exporters split them at
 *           normals and seams of textures.
 * Does not: renumber: a vertex that is joined stays, and nothing names it any more.
 * Threads:  one at a time.
 */
#ifndef CTL_WELD_H
#define CTL_WELD_H

#include <stdbool.h>
#include <stdint.h>

#include "meshfile.h"

/* Which vertices are one. */
struct ctl_weld {
    double distance; /* at most so far apart; 0: not at all; -0 is 0 */
    uint32_t *to;    /* [vertex_count]: the least vertex that each is joined to */
    uint32_t *list;  /* those that may be joined yet, and to which, ascending */
    uint32_t list_count;
    uint32_t first_joined; /* in the first frame */
    uint32_t joined;       /* in all frames so far */
};

/* Positions of all vertices of a frame. */
struct ctl_places {
    enum pccd_format format;
    const void *x;
    uint32_t count;
};

/* Each vertex of the first frame that is_used (NULL: all are) is joined to the least
 * other one that is within the distance and is joined to none. Errors: E_NOMEM. */
int ctl_weld_begin(struct ctl_weld *weld, double distance,
                   const struct ctl_places *places, const bool *is_used,
                   struct ctl_error *error);
/* The same with vertices that are one already: `to` of each, which is the least of them,
 * is taken. */
int ctl_weld_begin_joined(struct ctl_weld *weld, uint32_t *to, uint32_t count,
                          struct ctl_error *error);
/* Part what is farther apart in another frame. */
int ctl_weld_frame(struct ctl_weld *weld, const struct ctl_places *places,
                   struct ctl_error *error);
void ctl_weld_deinit(struct ctl_weld *weld);

/* Which vertices a mesh names; NULL: no memory. */
bool *ctl_weld_used(const struct ctl_mesh *mesh);
/* The largest side of the box of those, times 2^-40: nearer than that nobody puts two
 * vertices on purpose. */
double ctl_weld_closeness(const struct ctl_places *places, const bool *is_used);
/* Copy the shape of `from` to `mesh`, with the least vertex of each; *flat: how many
 * triangles have one vertex twice now. `mesh` is empty before. Errors: E_NOMEM. */
int ctl_weld_apply(const struct ctl_weld *weld, const struct ctl_mesh *from,
                   struct ctl_mesh *mesh, uint32_t *flat, struct ctl_error *error);

#endif
