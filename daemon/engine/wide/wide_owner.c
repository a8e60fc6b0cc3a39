/* wide_owner.c - whose features are below a node of the wide trees. */
#include "wide_owner.h"

#include <assert.h>

#include "memory.h"

struct eng_wide_owner {
    uint64_t groups; /* of all objects below, together; nobody: 0 */
    uint64_t masks;
    uint32_t first; /* of the objects in their order in the trees; nobody: 1 .. 0 */
    uint32_t last;
    uint32_t object;  /* the only one; of several: ENG_NO_OBJECT */
    bool has_self;    /* an object below may meet itself */
    bool has_crowded; /* something below is crowded in its object (wide_crowded.h) */
};

static const struct eng_wide_owner nobody = {
    .first = 1, .last = 0, .object = ENG_NO_OBJECT};

void eng_wide_owners_deinit(struct eng_wide_owners *owners)
{
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        eng_free(owners->of[kind]);
    }
}

uint64_t eng_wide_owners_bytes(const struct eng_wide_owners *owners)
{
    uint64_t bytes = 0;
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        bytes += (uint64_t)owners->capacity[kind] * sizeof *owners->of[kind];
    }
    return bytes;
}

static int reserve(struct eng_wide_owners *owners, const struct eng_wide *wide)
{
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        const struct eng_wide_tree *tree = &wide->trees[kind];
        uint32_t top = wide->level_count - 1;
        int status = eng_array_extend(&owners->of[kind], &owners->capacity[kind],
                                      tree->first[top] + tree->block_count[top],
                                      sizeof *owners->of[kind]);
        if (status != PCCD_OK) {
            return status;
        }
    }
    return PCCD_OK;
}

/* Return whether any of a block's features is crowded. */
static bool block_has_crowded(const struct eng_object *object, enum pccd_tree kind,
                              uint32_t first)
{
    const struct eng_wide_order *order = eng_wide_order_of(object);
    bool has_crowded = false;
    for (uint32_t i = first; i < first + ENG_WIDE && i < order->count[kind]; i++) {
        uint32_t feature = order->feature[kind][i];
        has_crowded |= feature != ENG_WIDE_NO_FEATURE &&
                       eng_mesh_is_crowded(object->mesh, kind, feature);
    }
    return has_crowded;
}

/* The blocks of features, object by object. */
static void own_blocks(struct eng_wide_owners *owners, const struct eng_wide *wide,
                       const struct eng_scene *scene, enum pccd_tree kind)
{
    struct eng_wide_owner *owner = owners->of[kind];
    uint32_t block = 0;
    uint32_t end = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        uint32_t object = wide->items[i].id;
        const struct eng_masks_entry *entry = &scene->masks.entries[object];
        bool can_have_crowded = scene->objects[object].has_crowded;
        uint32_t count = eng_wide_order_of(&scene->objects[object])->count[kind];
        uint32_t first = eng_wide_first_slot(end, count);
        end = first + count;
        for (; block < first / ENG_WIDE; block++) {
            owner[block] = nobody;
        }
        for (; block * ENG_WIDE < end; block++) {
            owner[block] = (struct eng_wide_owner){.groups = entry->group,
                                                   .masks = entry->mask,
                                                   .first = i,
                                                   .last = i,
                                                   .object = object,
                                                   .has_self = entry->self};
            owner[block].has_crowded =
                can_have_crowded && block_has_crowded(&scene->objects[object], kind,
                                                      block * ENG_WIDE - first);
        }
    }
    for (; block < wide->trees[kind].block_count[0]; block++) {
        owner[block] = nobody;
    }
}

/* All that is below `count` nodes of the same level. */
static struct eng_wide_owner unite(const struct eng_wide_owner *below, uint32_t count)
{
    struct eng_wide_owner all = nobody;
    for (uint32_t i = 0; i < count; i++) {
        if (below[i].first > below[i].last) {
            continue;
        }
        bool is_first = all.first > all.last;
        all.groups |= below[i].groups;
        all.masks |= below[i].masks;
        all.has_self |= below[i].has_self;
        all.has_crowded |= below[i].has_crowded;
        all.first = is_first ? below[i].first : all.first;
        all.last = below[i].last;
        all.object =
            is_first || all.object == below[i].object ? below[i].object : ENG_NO_OBJECT;
    }
    return all;
}

static void own_nodes(struct eng_wide_owners *owners, const struct eng_wide *wide,
                      enum pccd_tree kind)
{
    const struct eng_wide_tree *tree = &wide->trees[kind];
    for (uint32_t level = 1; level < wide->level_count; level++) {
        const struct eng_wide_owner *below = owners->of[kind] + tree->first[level - 1];
        struct eng_wide_owner *owner = owners->of[kind] + tree->first[level];
        uint32_t left = tree->block_count[level - 1];
        for (uint32_t i = 0; i < tree->block_count[level]; i++) {
            owner[i] = unite(below + i * ENG_WIDE, left < ENG_WIDE ? left : ENG_WIDE);
            left -= left < ENG_WIDE ? left : ENG_WIDE;
        }
    }
}

int eng_wide_owners_prepare(struct eng_wide_owners *owners, const struct eng_wide *wide,
                            const struct eng_scene *scene, bool *has_changed)
{
    assert(!wide->is_stale);
    bool is_on = eng_masks_is_on(&scene->masks) || scene->rigid.is_possible ||
                 eng_scene_turns(scene);
    *has_changed = owners->version != scene->masks.version;
    bool is_old = *has_changed || !owners->masks ||
                  owners->assembled != wide->assembled ||
                  owners->rigid_version != scene->rigid.version;
    if (is_on && is_old) {
        int status = reserve(owners, wide);
        if (status != PCCD_OK) {
            return status;
        }
        for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
            own_blocks(owners, wide, scene, kind);
            own_nodes(owners, wide, kind);
        }
    }
    owners->wide = wide;
    owners->assembled = wide->assembled;
    owners->masks = is_on ? &scene->masks : NULL;
    owners->version = scene->masks.version;
    owners->rigid_version = scene->rigid.version;
    return PCCD_OK;
}

bool eng_wide_owners_are_on(const struct eng_wide_owners *owners)
{
    return owners->masks && eng_masks_is_on(owners->masks);
}

/* Two nodes, or one twice, of one object alone. */
static bool may_meet_within(const struct eng_masks *masks, const struct eng_wide_owner *a,
                            const struct eng_wide_owner *b)
{
    assert(a->object == b->object);
    switch (masks->entries[a->object].left_out) {
    case ENG_SELF_TESTED:
        return a->has_self;
    case ENG_SELF_CROWDED:
        return a->has_self && a->has_crowded && b->has_crowded;
    case ENG_SELF_EXEMPT:
    case ENG_SELF_APART:
        break;
    }
    return false;
}

/* Return whether the step looks for no pair of the one object below a node. */
static bool is_apart(const struct eng_masks *masks, const struct eng_wide_owner *owner)
{
    return owner->object != ENG_NO_OBJECT &&
           masks->entries[owner->object].left_out == ENG_SELF_APART;
}

bool eng_wide_owners_is_apart(const struct eng_wide_owners *owners, enum pccd_tree kind,
                              uint32_t block)
{
    return owners->masks && is_apart(owners->masks, &owners->of[kind][block]);
}

/* A node of an object has its bits; the groups of several are those of any of them, and
 * that an object is below both nodes is seen by their places in the order, which are
 * without gaps. Then pairs of the one object may be left, besides. */
static bool may_meet(const struct eng_masks *masks, const struct eng_wide_owner *a,
                     const struct eng_wide_owner *b)
{
    bool have_common = a->first <= b->last && b->first <= a->last;
    bool are_objects = a->object != ENG_NO_OBJECT && b->object != ENG_NO_OBJECT;
    if (are_objects && have_common) {
        return may_meet_within(masks, a, b);
    }
    if (have_common && a->has_self && b->has_self) {
        return true;
    }
    if (is_apart(masks, a) || is_apart(masks, b)) {
        return false;
    }
    return (a->groups & b->masks) != 0 && (b->groups & a->masks) != 0 &&
           !(are_objects && eng_masks_ignores(masks, a->object, b->object));
}

/* Return the owners of the nodes of a level, of the tree of a kind's side. */
static const struct eng_wide_owner *owners_of(const struct eng_wide_owners *owners,
                                              enum pccd_kind kind, int side,
                                              uint32_t level)
{
    enum pccd_tree tree = eng_wide_tree_of(kind, side);
    return owners->of[tree] + owners->wide->trees[tree].first[level];
}

bool eng_wide_owners_allow(const struct eng_wide_owners *owners, enum pccd_kind kind,
                           uint32_t level, uint32_t n, uint32_t m)
{
    return !owners->masks ||
           may_meet(owners->masks, owners_of(owners, kind, 0, level) + n,
                    owners_of(owners, kind, 1, level) + m);
}

void eng_wide_owners_keep(const struct eng_wide_owners *owners, enum pccd_kind kind,
                          uint32_t level, uint32_t n, uint32_t m,
                          struct eng_wide_list *below)
{
    assert(level >= 1);
    const struct eng_masks *masks = owners->masks;
    if (!masks) {
        return;
    }
    uint32_t a_object = owners_of(owners, kind, 0, level)[n].object;
    uint32_t b_object = owners_of(owners, kind, 1, level)[m].object;
    bool is_one = a_object == b_object && a_object != ENG_NO_OBJECT;
    if (a_object != ENG_NO_OBJECT && b_object != ENG_NO_OBJECT &&
        !(is_one && masks->entries[a_object].left_out == ENG_SELF_CROWDED)) {
        return; /* what is below two objects' nodes is theirs */
    }
    const struct eng_wide_owner *of_a = owners_of(owners, kind, 0, level - 1);
    const struct eng_wide_owner *of_b = owners_of(owners, kind, 1, level - 1);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < below->count; i++) {
        uint32_t a = below->a[i];
        uint32_t b = below->b[i];
        below->a[kept] = a;
        below->b[kept] = b;
        kept += may_meet(masks, &of_a[a], &of_b[b]);
    }
    below->count = kept;
}
