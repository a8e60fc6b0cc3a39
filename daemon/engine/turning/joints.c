/* joints.c - which joint of a table is none: as joints.h of proto/common says. */
#include "path.h"

#include "joints.h"

bool eng_joints_check(const struct pccd_joint *joints, uint32_t count, uint32_t *joint,
                      const char **why)
{
    for (uint32_t i = 0; i < count; i++) {
        const char *fault = common_joint_fault(&joints[i], i);
        if (fault != NULL) {
            *joint = i;
            *why = fault;
            return false;
        }
    }
    return true;
}
