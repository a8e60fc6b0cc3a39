/* thickness.h - how thick objects are, and by how much their boxes grow for it.
 *
 * Threads: choose: [compute]; the rest [any], inside a step.
 *
 * A pair meets within r = radius of a + radius of b + separation, or, of two objects that
 * have one, clearance + separation. So the box of each vertex is larger by half of the
 * separation and the largest radius of the features that it is of, or half of the largest
 * clearance of its object, at both ends; every other box is a union of these. Where two
 * of them are apart in frames that keep distances (box_frames.h), the features are
 * farther apart than r.
 */
#ifndef ENG_THICKNESS_H
#define ENG_THICKNESS_H

#include "question.h"
#include "world.h"

/* Take a separation, and the radii as they are set now, for the coming step. */
void eng_thickness_begin(struct eng_scene *scene, double separation);

/* Note that an object is new, or has other thickness. */
void eng_thickness_look(struct eng_scene *scene, const struct eng_object *object);

/* Return whether each vertex of the object has a radius of its own. */
static inline bool eng_thickness_is_by_vertex(const struct eng_object *object)
{
    return !object->thickness.has_radius && object->mesh->radii;
}

/* Return what two objects have in the place of their radii; negative: nothing, or they
 * are one. */
static inline double eng_thickness_clearance(const struct eng_scene *scene, uint32_t a,
                                             uint32_t b)
{
    return a != b && eng_masks_have_clearances(&scene->masks)
               ? eng_masks_pair(&scene->masks, a, b)
               : ENG_PAIR_PLAIN;
}

/* Return the largest radius of the object's features. */
static inline double eng_thickness_most(const struct eng_object *object)
{
    return object->thickness.has_radius ? object->thickness.radius
                                        : object->mesh->radius_max;
}

/* Return the radius of a feature of the object; v[count]: its vertices in the mesh. */
static inline double eng_thickness_radius(const struct eng_object *object,
                                          const uint32_t *v, uint32_t count)
{
    if (!eng_thickness_is_by_vertex(object)) {
        return eng_thickness_most(object);
    }
    double most = object->mesh->radii[v[0]];
    for (uint32_t i = 1; i < count; i++) {
        most = fmax(most, object->mesh->radii[v[i]]);
    }
    return most;
}

/* Return whether two features of this object meet at a distance. */
bool eng_thickness_is_within(const struct eng_scene *scene,
                             const struct eng_object *object);

/* Return whether every pair has the same distance, the separation. */
static inline bool eng_thickness_is_plain(const struct eng_scene *scene)
{
    return !scene->thickness.may_have_radii && !scene->thickness.may_rest &&
           !eng_masks_have_clearances(&scene->masks);
}

/* Return a number that is not less than the distance at which any two features meet, in
 * the frames. */
static inline float eng_thickness_reach_growth(const struct eng_scene *scene)
{
    const struct eng_thickness *thickness = &scene->thickness;
    double most =
        thickness->separation + 2 * fmax(thickness->most, thickness->half_clearance);
    return eng_near_growth(nextafter(most, INFINITY), scene->framing.scale);
}

/* Return by how much the box of a vertex of the object is larger, in its frame: not less
 * than the largest radius of its features, or half of a clearance, and half of the
 * separation. */
static inline float eng_thickness_growth(const struct eng_scene *scene,
                                         const struct eng_object *object, uint32_t vertex)
{
    double half = 0.5 * scene->thickness.separation;
    double radius = eng_thickness_is_by_vertex(object) ? object->mesh->reach[vertex]
                                                       : eng_thickness_most(object);
    double reach = half + fmax(radius, object->half_clearance);
    /* Halves, which may be 0, and the sum are off by less than the next double. */
    return eng_near_growth(scene->thickness.separation > 0 ? nextafter(reach, INFINITY)
                                                           : reach,
                           scene->framing.scale);
}

/* Return the bound `outward`, a distance outward, of a box that is made larger by
 * `growth`: two roundings of 2^-24 are less than what is added for them. */
static inline float eng_thickness_grown(float outward, float growth)
{
    float sum = outward + growth;
    return sum + fabsf(sum) * 0x1p-22f;
}

#endif
