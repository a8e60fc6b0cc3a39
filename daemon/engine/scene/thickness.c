/* thickness.c - how thick objects are. */
#include "thickness.h"

#include "topology.h"

static double largest(const struct eng_scene *scene)
{
    double most = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            most = fmax(most, eng_thickness_most(&scene->objects[i]));
        }
    }
    return most;
}

/* Find the clearances of objects anew, if what is said of pairs may have changed. Return
 * whether it did. */
static bool find_clearances(struct eng_scene *scene)
{
    struct eng_thickness *thickness = &scene->thickness;
    uint32_t from = 0;
    uint32_t pair[2];
    double clearance;
    if (scene->masks.version == thickness->masks_version ||
        (thickness->half_clearance == 0 && !eng_masks_have_clearances(&scene->masks))) {
        return false;
    }
    thickness->masks_version = scene->masks.version;
    thickness->half_clearance = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        scene->objects[i].half_clearance = 0;
    }
    while (eng_pairset_next(&scene->masks.pairs, &from, pair, &clearance)) {
        for (int side = 0; side < 2; side++) {
            double *half = &scene->objects[pair[side]].half_clearance;
            *half = fmax(*half, 0.5 * clearance); /* that of an ignored pair is less */
            thickness->half_clearance = fmax(thickness->half_clearance, *half);
        }
    }
    return true;
}

void eng_thickness_begin(struct eng_scene *scene, double separation)
{
    struct eng_thickness *thickness = &scene->thickness;
    bool has_changed = find_clearances(scene) || thickness->has_changed;
    thickness->number += has_changed || separation != thickness->separation;
    thickness->has_changed = false;
    thickness->separation = separation;
    thickness->most = thickness->may_have_radii ? largest(scene) : 0;
    thickness->may_have_radii = thickness->most > 0;
    thickness->is_on =
        separation > 0 || thickness->may_have_radii || thickness->half_clearance > 0;
}

bool eng_thickness_is_within(const struct eng_scene *scene,
                             const struct eng_object *object)
{
    return scene->thickness.separation > 0 || eng_thickness_most(object) > 0;
}

void eng_thickness_look(struct eng_scene *scene, const struct eng_object *object)
{
    scene->thickness.may_have_radii |= eng_thickness_most(object) > 0;
    scene->thickness.may_rest |=
        object->thickness.rest_distance > 0 || object->thickness.rest_rings > 0;
}

static int check(struct eng_mesh *mesh, const struct eng_object_thickness *thickness)
{
    int status = eng_mesh_check_radius(thickness->radius);
    if (status == PCCD_OK) {
        status = eng_mesh_check_radius(thickness->rest_distance);
    }
    if (status == PCCD_OK && thickness->rest_rings > ENG_RINGS_MAX) {
        status = PCCD_E_LIMIT;
    }
    return status == PCCD_OK ? eng_rings_prepare(mesh, thickness->rest_rings, NULL)
                             : status;
}

int eng_scene_prepare_rings(struct eng_scene *scene, uint32_t object_idx,
                            struct eng_mesh *mesh, uint32_t rings,
                            const atomic_bool *cancel)
{
    const struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!object) {
        return PCCD_E_INVAL;
    }
    return rings > ENG_RINGS_MAX
               ? PCCD_E_LIMIT
               : eng_rings_prepare(mesh ? mesh : object->mesh, rings, cancel);
}

int eng_scene_set_thickness(struct eng_scene *scene, uint32_t object_idx,
                            const struct eng_object_thickness *thickness)
{
    struct eng_object *object = eng_scene_object(scene, object_idx);
    int status = object ? check(object->mesh, thickness) : PCCD_E_INVAL;
    if (status != PCCD_OK) {
        return status;
    }
    const struct eng_object_thickness *before = &object->thickness;
    scene->thickness.has_changed |= before->radius != thickness->radius ||
                                    before->has_radius != thickness->has_radius ||
                                    before->rest_distance != thickness->rest_distance ||
                                    before->rest_rings != thickness->rest_rings;
    object->thickness = *thickness;
    eng_thickness_look(scene, object);
    return PCCD_OK;
}

int eng_scene_get_thickness(const struct eng_scene *scene, uint32_t object_idx,
                            struct eng_object_thickness *thickness)
{
    const struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!object) {
        return PCCD_E_INVAL;
    }
    *thickness = object->thickness;
    return PCCD_OK;
}
