/* verify_meeting.h - when the features of a pair meet first in a recorded step, by exact
 * arithmetic.
 *
 * Threads: one.
 * Source: the definition of a contact in oracle.h, of a thick one in oracle_thick.h;
 * PROTOCOL.md, "How thick objects are".
 */
#ifndef CTL_VERIFY_MEETING_H
#define CTL_VERIFY_MEETING_H

#include "oracle.h"
#include "play.h"

struct verify_meeting {
    double p[8][3];             /* of the pair, as oracle.h orders them */
    double r;                   /* above 0: they are thick, and meet about there */
    struct oracle_first *first; /* NULL: they never meet; the caller's to free */
    uint32_t flags;             /* PCCD_INITIAL and PCCD_INSIDE, as a record of it has */
};

/* The eight points of a pair of features that exist, in the order of oracle.h; a kind of
 * fewer repeats the last. */
void verify_points(const struct registry_scene *scene, const struct pccd_pair *pair,
                   double p[8][3]);
/* The mesh of either object has its edges (world_edges). */
void verify_meet(const struct play_step *step, const struct pccd_pair *pair,
                 struct verify_meeting *meeting);
/* Whether mode pairs has the pair: no axis separates it, by the given coordinates, and
 * its kind has a meaning where it is thin. The same meshes. */
bool verify_is_beside(const struct play_step *step, const struct pccd_pair *pair);

#endif
