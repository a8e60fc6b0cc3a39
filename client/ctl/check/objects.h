/* objects.h - which objects of a file meet.
 *
 * Threads: one.
 */
#ifndef CTL_OBJECTS_H
#define CTL_OBJECTS_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"
#include "meshfile.h"
#include "pccd.h"
#include "report.h"

struct objects {
    const struct ctl_mesh *mesh;
    uint32_t *of_vertex, *of_edge; /* ours: object numbers; NULL: there is one object */
    struct report_pair *pairs;     /* of this step; a table by a hash of both objects */
    uint32_t pair_count, capacity; /* a power of 2, more than there are pairs */
};

/* Whether all of a mesh is of one object. */
bool objects_are_one(const struct ctl_mesh *mesh);
/* Of a mesh with objects, and its edges as they were registered, unless all are of one.
 * Both stay as they are until objects_deinit, which is called also on error. Errors:
 * E_NOMEM. */
int objects_init(struct objects *objects, const struct ctl_mesh *mesh,
                 const struct pccd_edge *edges, uint32_t edge_count,
                 struct ctl_error *error);
/* The object of a feature of so many points (1 a vertex, 2 an edge, 3 a face): its place
 * in mesh->objects, or CTL_NO_OBJECT before the first one. */
uint32_t objects_of(const struct objects *objects, uint32_t points, uint32_t feature);
/* Count the records of a page. False: no memory. */
bool objects_count(struct objects *objects, const struct pccd_answer *page);
/* What was counted, most first, to `step`, whose pairs are free()d by its owner; then
 * begin anew. Errors: E_NOMEM. */
int objects_take(struct objects *objects, struct report_step *step,
                 struct ctl_error *error);
void objects_deinit(struct objects *objects);

#endif
