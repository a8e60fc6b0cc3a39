/* near_line.c - where a record of what is near lies in a scene. */
#include "near_line.h"

#include <string.h>

#include "kinds.h"

/* The weights of a record's features. Those of EF are of a point of the edge, and nobody
 * asks for them. */
static void near_weights(const struct pccd_near *near, double w[2][3])
{
    if (near->kind != PCCD_EF) {
        common_contact_weights((enum pccd_kind)near->kind, near->param, w);
    }
}

bool near_line(const struct registry_scene *scene, const struct pccd_near *near,
               uint32_t end, double ends[2][3])
{
    const uint32_t handles[2] = {near->object_a, near->object_b};
    const uint32_t features[2] = {near->feature_a, near->feature_b};
    double w[2][3] = {{0}};
    if (near->kind >= COMMON_KIND_COUNT) {
        return false;
    }
    near_weights(near, w);
    memset(ends, 0, 6 * sizeof(double));
    for (uint32_t side = 0; side < 2; side++) {
        const struct registry_object *object = registry_object(scene, handles[side]);
        uint32_t points = common_kinds[near->kind].points[side];
        const uint32_t *corners =
            object != NULL ? world_feature(object->mesh, points, &features[side]) : NULL;
        if (corners == NULL) {
            return false;
        }
        double(*x)[3] = end == 0 ? object->x0 : object->x1;
        for (uint32_t i = 0; i < points; i++) {
            for (uint32_t k = 0; k < 3; k++) {
                if (near->kind != PCCD_EF) {
                    ends[side][k] += w[side][i] * x[corners[i]][k];
                } else if (side == 0) {
                    ends[i][k] = x[corners[i]][k];
                }
            }
        }
    }
    return true;
}
