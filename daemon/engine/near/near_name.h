/* daemon/engine/near/near_name.h - how a pair of features is named while it is looked at.
 *
 * Room:     engine. May include: pccd_types.h.
 * Does:     define the struct.
 * Threads:  [any]; types only.
 */
#ifndef ENG_NEAR_NAME_H
#define ENG_NEAR_NAME_H

#include "pccd_types.h"

/* A candidate as records name it, and the indices of its objects in the scene. */
struct eng_near_name {
    struct pccd_pair pair;
    uint32_t object[2];
};

#endif
