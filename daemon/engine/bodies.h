/* bodies.h - says which steps are taken in body space: where all that moves goes from one
 * pose to another, no box of the method is made anew, and the trees that each mesh has in
 * its own frame are searched (turning/straight.h). The answer is the same.
 *
 * A step can be one if it asks for contacts that are no nearer and no thicker than
 * registered, in mode all, first or any, by the method wide; if nothing moves but by
 * poses, each of all vertices of an object that is not tested against itself (rigid.h);
 * and if the last answer tells of what stands, or nothing does. It is one where that pays
 * (bodies.c), and no deadline is near: after one that ends early all boxes would be made.
 * Objects that turn may be beside those, but in mode any: they are tested in body space
 * in any step (turning/sweep.h).
 *
 * Threads: [compute], but for share.
 */
#ifndef ENG_BODIES_H
#define ENG_BODIES_H

#include "question.h"
#include "step_result.h"
#include "world.h"

/* Return whether the step that is staged may be one, as far as is known before anything
 * moves. Trees that the step before wanted (eng_bodies_share) are wanted no more. */
bool eng_bodies_may(const struct eng_scene *scene, const struct eng_question *question);

/* Return whether it is, if the last answer tells of what stands or nothing does, when the
 * positions have moved on and it is known what is tested against itself. */
bool eng_bodies_choose(struct eng_scene *scene, const struct eng_question *question);

/* Return whether nothing stands. */
bool eng_bodies_are_all(const struct eng_scene *scene);

/* Learn from a step in body space. */
void eng_bodies_end(struct eng_scene *scene, const struct eng_question *question,
                    const struct eng_step_result *result);

/* Note that the boxes of the method are wanted for a question: if the last step has made
 * none, all are made anew. So that this is rare, more and more steps make them each time;
 * and many, where a deadline is near. */
void eng_bodies_leave(struct eng_scene *scene, const struct eng_question *question);

/* Go on with trees of meshes that some step would have used, some 0.5 ms of it. [team],
 * one thread, while others search */
void eng_bodies_share(const struct eng_scene *scene);

#endif
