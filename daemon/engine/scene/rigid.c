/* rigid.c - objects that poses keep from meeting themselves. */
#include "rigid.h"

#include <assert.h>

#include "spacing.h"
#include "thickness.h"

/* Of a step's share of a search, in tests of 20 ns: some 0.1 ms, and for large scenes a
 * tenth of what a step takes. By number, not by time: so what is counted in a step does
 * not depend on how fast it was. */
#define SHARE_MIN           4096u
#define SHARE_PER_TRIANGLES 2u

/* Is it to be looked whether its spacing is known by now? Of most objects nothing but
 * these fields is read: what stands costs little. */
static bool may_find_spacing(const struct eng_object *object)
{
    return object->mesh && object->spacing == 0 && (object->is_posed || object->is_new);
}

void eng_rigid_prepare(struct eng_scene *scene)
{
    struct eng_rigid *rigid = &scene->rigid;
    rigid->is_possible = false;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_object *object = &scene->objects[i];
        if (may_find_spacing(object)) {
            object->spacing = eng_spacing_of(object->mesh);
            object->has_near = object->spacing > 0 && eng_spacing_has_near(object->mesh);
            rigid->version += object->spacing > 0;
        }
        rigid->is_possible |= object->mesh && object->spacing > 0;
    }
}

void eng_rigid_choose(struct eng_scene *scene, bool may_leave_out)
{
    struct eng_rigid *rigid = &scene->rigid;
    rigid->objects = 0;
    rigid->leaves = 0;
    rigid->wanted = ENG_NO_OBJECT;
    for (uint32_t i = scene->object_capacity; i-- > 0;) {
        const struct eng_object *object = &scene->objects[i];
        bool is_wanted = object->mesh && may_leave_out && scene->masks.entries[i].self &&
                         !eng_thickness_is_within(scene, object);
        enum eng_self self = ENG_SELF_TESTED;
        if (is_wanted && object->spacing > object->blur[0]) {
            self = object->has_near ? ENG_SELF_NEAR : ENG_SELF_APART;
            rigid->objects++;
            rigid->leaves += object->mesh->leaf_count;
        } else if (is_wanted && object->is_posed && object->spacing == 0 &&
                   !eng_spacing_is_known(object->mesh)) {
            rigid->wanted = i;
        }
        eng_masks_leave_out(&scene->masks, i, self);
    }
}

bool eng_rigid_is_settled(const struct eng_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (may_find_spacing(object) && eng_spacing_of(object->mesh) > 0) {
            return false;
        }
    }
    return scene->rigid.wanted == ENG_NO_OBJECT;
}

void eng_rigid_share(struct eng_scene *scene)
{
    uint64_t budget = SHARE_MIN + scene->leaf_count / SHARE_PER_TRIANGLES;
    uint64_t done = 0;
    /* From the one that is wanted on: those before are known, or not posed. */
    for (uint32_t i = scene->rigid.wanted; i < scene->object_capacity && done < budget;
         i++) {
        struct eng_object *object = &scene->objects[i];
        if (object->mesh && object->is_posed && scene->masks.entries[i].self) {
            done += eng_spacing_advance(object->mesh, budget - done);
        }
    }
}
