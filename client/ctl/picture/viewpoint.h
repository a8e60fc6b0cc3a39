/* viewpoint.h - chooses a camera direction from which a contact is visible. */
#ifndef CTL_VIEWPOINT_H
#define CTL_VIEWPOINT_H

#include "still.h"

/* `from`, unit, is the wanted direction from contact still->chosen to the eye, and
 * becomes the one of those with a free view that is least turned away from it; it
 * stays where none of them has a free view. */
void viewpoint_choose(const struct still *still, float from[3]);

#endif
