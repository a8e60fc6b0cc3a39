/* daemon/engine/wide/wide_owner.c - whose features are below a node of the wide trees.
 *
 * Room:     engine.
 * Does:     see wide_owner.h.
 * Threads:  wide_owner.h.
 */
#include "wide_owner.h"

#include "memory.h"
#include "world.h"

static const struct eng_wide_owner nobody = {
    .first = 1, .last = 0, .object = ENG_NO_OBJECT};

void eng_wide_owners_deinit(struct eng_wide_owners *owners)
{
    for (int kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        eng_free(owners->of[kind]);
    }
}

uint64_t eng_wide_owners_bytes(const struct eng_wide_owners *owners)
{
    uint64_t bytes = 0;
    for (int kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        bytes += (uint64_t)owners->capacity[kind] * sizeof *owners->of[kind];
    }
    return bytes;
}

static int reserve(struct eng_wide *wide)
{
    struct eng_wide_owners *owners = &wide->owners;
    for (int kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        uint32_t capacity = wide->trees[kind].block_capacity;
        if (capacity > owners->capacity[kind]) {
            int status =
                eng_world_grow(&owners->of[kind], capacity, sizeof *owners->of[kind]);
            if (status != ENG_OK) {
                return status;
            }
            owners->capacity[kind] = capacity;
        }
    }
    return ENG_OK;
}

/* The blocks of features, object by object. */
static void own_blocks(struct eng_wide *wide, const struct eng_scene *scene,
                       enum eng_wide_kind kind)
{
    struct eng_wide_owner *owner = wide->owners.of[kind];
    uint32_t block = 0;
    uint32_t end = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        uint32_t object = wide->items[i].id;
        const struct eng_masks_entry *entry = &scene->masks.entries[object];
        uint32_t count = scene->objects[object].order->count[kind];
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
        all.first = is_first ? below[i].first : all.first;
        all.last = below[i].last;
        all.object =
            is_first || all.object == below[i].object ? below[i].object : ENG_NO_OBJECT;
    }
    return all;
}

static void own_nodes(struct eng_wide *wide, enum eng_wide_kind kind)
{
    const struct eng_wide_tree *tree = &wide->trees[kind];
    for (uint32_t level = 1; level < wide->level_count; level++) {
        const struct eng_wide_owner *below =
            wide->owners.of[kind] + tree->first[level - 1];
        struct eng_wide_owner *owner = wide->owners.of[kind] + tree->first[level];
        uint32_t left = tree->block_count[level - 1];
        for (uint32_t i = 0; i < tree->block_count[level]; i++) {
            owner[i] = unite(below + i * ENG_WIDE, left < ENG_WIDE ? left : ENG_WIDE);
            left -= left < ENG_WIDE ? left : ENG_WIDE;
        }
    }
}

int eng_wide_owners_prepare(struct eng_wide *wide, const struct eng_scene *scene,
                            bool *has_changed)
{
    struct eng_wide_owners *owners = &wide->owners;
    bool is_on = eng_masks_is_on(&scene->masks);
    *has_changed = owners->version != scene->masks.version;
    if (is_on && (*has_changed || !owners->masks)) {
        int status = reserve(wide);
        if (status != ENG_OK) {
            return status;
        }
        for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
            own_blocks(wide, scene, kind);
            own_nodes(wide, kind);
        }
    }
    owners->masks = is_on ? &scene->masks : NULL;
    owners->version = scene->masks.version;
    return ENG_OK;
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
        return a->has_self;
    }
    if (have_common && a->has_self && b->has_self) {
        return true;
    }
    return (a->groups & b->masks) != 0 && (b->groups & a->masks) != 0 &&
           !(are_objects && eng_masks_ignores(masks, a->object, b->object));
}

static const struct eng_wide_owner *owners_of(const struct eng_wide *wide,
                                              enum eng_wide_kind kind, uint32_t level)
{
    return wide->owners.of[kind] + wide->trees[kind].first[level];
}

bool eng_wide_owners_allow(const struct eng_wide *wide, enum eng_kind kind,
                           uint32_t level, uint32_t n, uint32_t m)
{
    const enum eng_wide_kind *trees = eng_wide_trees_of[kind];
    return !wide->owners.masks ||
           may_meet(wide->owners.masks, owners_of(wide, trees[0], level) + n,
                    owners_of(wide, trees[1], level) + m);
}

uint32_t eng_wide_owners_keep(const struct eng_wide *wide, enum eng_kind kind,
                              uint32_t level, uint32_t n, uint32_t m, uint32_t *a,
                              uint32_t *b, uint32_t count)
{
    const enum eng_wide_kind *trees = eng_wide_trees_of[kind];
    const struct eng_masks *masks = wide->owners.masks;
    if (!masks || (owners_of(wide, trees[0], level)[n].object != ENG_NO_OBJECT &&
                   owners_of(wide, trees[1], level)[m].object != ENG_NO_OBJECT)) {
        return count; /* what is below two objects' nodes is theirs */
    }
    const struct eng_wide_owner *of_a = owners_of(wide, trees[0], level - 1);
    const struct eng_wide_owner *of_b = owners_of(wide, trees[1], level - 1);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        a[kept] = a[i];
        b[kept] = b[i];
        kept += may_meet(masks, &of_a[a[i]], &of_b[b[i]]);
    }
    return kept;
}
