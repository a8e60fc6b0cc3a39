/* client/ctl/record/verify_meeting.h - when the features of a pair meet first in a
 * recorded step, by exact arithmetic.
 *
 * Room:     client/ctl. May include: play.h, oracle.h, oracle_thick.h, oracle_distance.h.
 * Does:     find the radii of a pair, leave out what rest excludes, and ask the oracle.
 * Threads:  one.
 * Source:   the definition of a contact in oracle.h, of a thick one in oracle_thick.h;
 *           PROTOCOL.md, "How thick objects are".
 */
#ifndef CTL_VERIFY_MEETING_H
#define CTL_VERIFY_MEETING_H

#include "oracle.h"
#include "play.h"

struct verify_meeting {
    double p[8][3];             /* of the pair, as oracle.h orders them */
    struct oracle_first *first; /* NULL: they never meet; the caller's to free */
    uint32_t flags;             /* PCCD_INITIAL and PCCD_INSIDE, as a record of it has */
};

/* Is a vertex (points 1) or an edge (2) free: an edge that no triangle has, a vertex that
 * no triangle and no edge has? Its edges were made (world_edges). */
bool verify_is_free(const struct registry_mesh *mesh, uint32_t points, uint32_t feature);
/* Features of a mesh that have so many points: how many, and the vertices of one; NULL if
 * there is none of that index. A vertex is its own. */
uint32_t verify_feature_count(const struct registry_mesh *mesh, uint32_t points);
const uint32_t *verify_feature(const struct registry_mesh *mesh, uint32_t points,
                               const uint32_t *feature);
/* The eight points of a pair of features that exist, in the order of oracle.h; a kind of
 * fewer repeats the last. */
void verify_points(const struct registry_scene *scene, const struct pccd_pair *pair,
                   double p[8][3]);
/* The mesh of either object has its edges (world_edges). */
void verify_meet(const struct play_step *step, const struct pccd_pair *pair,
                 struct verify_meeting *meeting);

/* Of a feature of an object that has these vertices. */
double verify_radius(const struct registry_object *object, const uint32_t *v,
                     uint32_t count);

#endif
