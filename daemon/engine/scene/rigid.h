/* rigid.h - which objects need not be tested against themselves in a step, because the
 * poses that move them prove that they do not meet themselves.
 *
 * Compare, for each object, what rounding can bring together in this step (blur.h) with
 * how near its features lie to each other (spacing.h), and enter in the masks what
 * follows. Have spacings found out that are missing.
 *
 * An object is eligible while nothing but poses, each of all its vertices, has moved it:
 * both ends of the step are such poses; or it stands where the last one took it; or it
 * never moved. Anything else written to one of its vertices ends that, until the next
 * pose. What is left out has no contact, so answers stay as they are; mode `pairs`, whose
 * records are pairs of boxes, leaves nothing out. Nor is an object eligible if its
 * features meet each other at a distance, which poses do not keep (thickness.h).
 */
#ifndef ENG_RIGID_H
#define ENG_RIGID_H

#include "world.h"

/* Before a step: see which spacings are known, so that the step goes by these, whatever
 * becomes known meanwhile. [compute] */
void eng_rigid_prepare(struct eng_scene *scene);

/* The positions are those of the step: which objects need no tests against themselves?
 * None if not `may_leave_out`. [compute] */
void eng_rigid_choose(struct eng_scene *scene, bool may_leave_out);

/* Will a step that writes nothing find no spacing that has become known, and search for
 * none? [compute] */
bool eng_rigid_is_settled(const struct eng_scene *scene);

/* While others traverse: a share of the search for a spacing that was missed. By one
 * thread; later steps have what it finds. [team] */
void eng_rigid_share(struct eng_scene *scene);

#endif
