/* daemon/engine/tree/aside.c - large subtrees, built aside and swapped in.
 *
 * Room:     engine.
 * Does:     keep a batch of poor subtrees; list, build and swap them one after the other.
 * Threads:  aside.h.
 * Source:   aside.h.
 */
#include "aside.h"

#include <string.h>

#include "build.h"
#include "memory.h"
#include "metric.h"
#include "rebuild.h"

/* The share of a step, at least: less than this is not worth beginning. */
#define BUDGET_MIN_NS 200000u

/* Part of the last step's time that a share takes: for one thread, which pays for all of
 * it; and for one of several, which the others relieve of other work meanwhile. */
#define BUDGET_ALONE    4u
#define BUDGET_TOGETHER 2u

/* Part of the share that goes to listing, which everybody waits for. */
#define BUDGET_LISTING 4u

void eng_aside_init(struct eng_aside *aside)
{
    memset(aside, 0, sizeof *aside);
    aside->budget_ns = BUDGET_MIN_NS;
}

static void free_arrays(struct eng_aside *aside)
{
    eng_free(aside->items);
    eng_free(aside->triangles);
    eng_free(aside->links);
    eng_free(aside->boxes);
    aside->items = NULL;
    aside->triangles = NULL;
    aside->links = NULL;
    aside->boxes = NULL;
    aside->capacity = 0;
}

void eng_aside_deinit(struct eng_aside *aside)
{
    free_arrays(aside);
}

uint64_t eng_aside_bytes(const struct eng_aside *aside)
{
    return (uint64_t)aside->capacity *
           (sizeof *aside->items + sizeof *aside->triangles + 2 * sizeof *aside->links +
            (aside->boxes ? sizeof *aside->boxes : 0));
}

/* Nothing of the old batch is needed any more. */
static bool reserve(struct eng_aside *aside, const struct eng_scene *scene,
                    uint32_t capacity)
{
    bool by_sah = scene->settings.quality == ENG_QUALITY_SAH;
    if (capacity <= aside->capacity) {
        return true;
    }
    free_arrays(aside);
    aside->items = eng_alloc(capacity, sizeof *aside->items);
    aside->triangles = eng_alloc(capacity, sizeof *aside->triangles);
    aside->links = eng_alloc(capacity, 2 * sizeof *aside->links);
    aside->boxes = by_sah ? eng_alloc(capacity, sizeof *aside->boxes) : NULL;
    if (!aside->items || !aside->triangles || !aside->links ||
        (by_sah && !aside->boxes)) {
        free_arrays(aside);
        return false;
    }
    aside->capacity = capacity;
    return true;
}

void eng_aside_forget(struct eng_aside *aside, struct eng_range nodes)
{
    for (uint32_t i = 0; i < aside->part_count; i++) {
        struct eng_aside_part *part = &aside->parts[i];
        if (part->root - nodes.first < nodes.count) {
            part->state = ENG_ASIDE_GONE;
        }
    }
}

/* Write the links of a subtree over those of its old self. */
static void put_in_place(struct eng_aside *aside, struct eng_scene *scene,
                         const struct eng_aside_part *part)
{
    const struct eng_link *links = aside->links + 2 * (size_t)part->first;
    const uint32_t *triangles = aside->triangles + part->first;
    for (uint32_t i = 0; i < 2 * part->count - 1; i++) {
        struct eng_node *node = &scene->nodes[part->root + i];
        bool is_leaf = links[i].count == 1;
        node->left = is_leaf ? ENG_LEAF : part->root + i + 1;
        node->right = is_leaf ? triangles[links[i].right] : part->root + links[i].right;
        node->count = links[i].count;
        node->gate = ENG_GATE_NONE;
    }
}

static struct eng_range nodes_of(const struct eng_aside_part *part)
{
    return (struct eng_range){part->root, 2 * part->count - 1};
}

bool eng_aside_swap(struct eng_aside *aside, struct eng_scene *scene)
{
    aside->swaps = 0;
    aside->swapped_triangles = 0;
    for (uint32_t i = 0; i < aside->part_count; i++) {
        struct eng_aside_part *part = &aside->parts[i];
        if (part->state == ENG_ASIDE_BUILT) {
            put_in_place(aside, scene, part);
            eng_regions_mark(scene, nodes_of(part));
            part->state = ENG_ASIDE_FRESH;
            aside->swaps++;
            aside->swapped_triangles += part->count;
        }
    }
    return aside->swaps > 0;
}

/* Levels between the root of an object and a node of it. */
static uint32_t depth_of(const struct eng_scene *scene, uint32_t root, uint32_t node_idx)
{
    uint32_t depth = 0;
    for (uint32_t i = root; i != node_idx; depth++) {
        const struct eng_node *node = &scene->nodes[i];
        i = node_idx < node->right ? node->left : node->right;
    }
    return depth;
}

/* Take the largest poor subtrees of an object into the batch. */
static void examine_object(struct eng_aside *aside, const struct eng_scene *scene,
                           struct eng_range nodes)
{
    uint32_t levels = eng_object_levels(scene, scene->nodes[nodes.first].count);
    uint32_t end = nodes.first + nodes.count;
    for (uint32_t i = nodes.first; i < end;) {
        const struct eng_node *node = &scene->nodes[i];
        bool is_high = node->count > scene->settings.rebuild_triangles_max;
        bool is_poor = is_high && node->count >= ENG_EXAMINE_MIN &&
                       eng_metric_is_poor(eng_metric(scene->nodes, node),
                                          scene->upkeep[i].built_ratio,
                                          (float)scene->settings.rebuild_ratio);
        if (is_poor && aside->part_count < ENG_ASIDE_PARTS_MAX) {
            aside->parts[aside->part_count++] = (struct eng_aside_part){
                .state = ENG_ASIDE_FOUND,
                .root = i,
                .count = node->count,
                .levels = levels - depth_of(scene, nodes.first, i)};
        }
        i += is_high && !is_poor ? 1 : 2 * node->count - 1;
    }
}

/* Look for poor subtrees; room for them is needed at once. */
static void find_parts(struct eng_aside *aside, const struct eng_scene *scene)
{
    uint32_t triangles = 0;
    aside->part_count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            examine_object(aside, scene, scene->objects[i].nodes);
        }
    }
    for (uint32_t i = 0; i < aside->part_count; i++) {
        aside->parts[i].first = triangles;
        triangles += aside->parts[i].count;
    }
    if (!reserve(aside, scene, triangles)) {
        aside->part_count = 0;
    }
    aside->listing = 0;
    aside->next_node = aside->part_count > 0 ? aside->parts[0].root : 0;
    aside->next_item = 0;
    aside->building = 0;
    aside->has_begun = false;
}

static void list_leaf(struct eng_aside *aside, const struct eng_node *leaf)
{
    uint32_t own = aside->next_item++;
    uint32_t place = aside->parts[aside->listing].first + own;
    const struct eng_box *box = eng_box_of_const(leaf);
    aside->items[place] = eng_split_item_of(leaf, own);
    aside->triangles[place] = leaf->right;
    if (aside->boxes) {
        eng_f4 lo = eng_min4(eng_bounds(box, 0), eng_bounds(box, 2));
        eng_f4 hi = eng_max4(eng_bounds(box, 1), eng_bounds(box, 3));
        for (int k = 0; k < 3; k++) {
            aside->boxes[place].lo[k] = lo[k];
            aside->boxes[place].hi[k] = hi[k];
        }
    }
}

/* The next node above regions, or the next region as a whole: later steps may move
 * triangles within it. */
static void list_some(struct eng_aside *aside, const struct eng_scene *scene)
{
    uint32_t first = aside->next_node;
    uint32_t count = scene->nodes[first].count;
    bool is_high = count > scene->settings.rebuild_triangles_max;
    aside->next_node += is_high ? 1 : 2 * count - 1;
    for (uint32_t i = first; i < aside->next_node; i++) {
        if (scene->nodes[i].left == ENG_LEAF) {
            list_leaf(aside, &scene->nodes[i]);
        }
    }
}

static void list(struct eng_aside *aside, const struct eng_scene *scene, uint64_t end_ns)
{
    while (aside->listing < aside->part_count && eng_now_ns() < end_ns) {
        struct eng_aside_part *part = &aside->parts[aside->listing];
        if (part->state == ENG_ASIDE_FOUND && aside->next_item < part->count) {
            list_some(aside, scene);
            continue;
        }
        if (part->state == ENG_ASIDE_FOUND) {
            part->state = ENG_ASIDE_LISTED;
        }
        if (++aside->listing < aside->part_count) {
            aside->next_node = aside->parts[aside->listing].root;
            aside->next_item = 0;
        }
    }
}

/* Note the metric of what is new in place; is anything left to do in the batch? */
static bool end_swaps(struct eng_aside *aside, struct eng_scene *scene)
{
    bool is_busy = false;
    for (uint32_t i = 0; i < aside->part_count; i++) {
        struct eng_aside_part *part = &aside->parts[i];
        if (part->state == ENG_ASIDE_FRESH) {
            eng_rebuild_note(scene, nodes_of(part));
            part->state = ENG_ASIDE_GONE;
        }
        is_busy = is_busy || part->state != ENG_ASIDE_GONE;
    }
    return is_busy;
}

void eng_aside_examine(struct eng_aside *aside, struct eng_worker *worker)
{
    struct eng_scene *scene = worker->scene;
    uint64_t begin_ns = eng_now_ns();
    if (scene->settings.rebuild_ratio <= 0) {
        return;
    }
    if (!end_swaps(aside, scene)) {
        find_parts(aside, scene);
    }
    list(aside, scene, begin_ns + aside->budget_ns / BUDGET_LISTING);
    worker->record.rebuild_ns += eng_now_ns() - begin_ns;
}

static void begin_part(struct eng_aside *aside, const struct eng_aside_part *part)
{
    struct eng_grower *grower = &aside->grower;
    grower->items = aside->items + part->first;
    grower->nodes = NULL;
    grower->links = aside->links + 2 * (size_t)part->first;
    grower->base = 0;
    grower->over_roots = false;
    grower->sah.boxes = aside->boxes ? aside->boxes + part->first : NULL;
    grower->sah.first_id = 0;
    eng_grow_begin(grower, part->count, 0, part->levels);
    aside->has_begun = true;
}

/* Work on one part until it is built or the time is over. */
static void build_part(struct eng_aside *aside, struct eng_worker *worker,
                       uint64_t end_ns)
{
    struct eng_aside_part *part = &aside->parts[aside->building];
    uint64_t begin_ns = eng_worker_slice(worker);
    if (!aside->has_begun) {
        begin_part(aside, part);
    }
    while (eng_now_ns() < end_ns) {
        if (!eng_grow_piece(&aside->grower)) {
            part->state = ENG_ASIDE_BUILT;
            aside->has_begun = false;
            aside->building++;
            break;
        }
    }
    eng_worker_trace(worker, ENG_TRACE_ASIDE, begin_ns, part->root, part->count);
}

void eng_aside_share(struct eng_aside *aside, struct eng_worker *worker)
{
    uint64_t begin_ns = eng_now_ns();
    uint64_t end_ns = begin_ns + aside->budget_ns;
    while (aside->building < aside->part_count && eng_now_ns() < end_ns &&
           !eng_stop_is_set(worker->stop)) {
        enum eng_aside_state state = aside->parts[aside->building].state;
        if (state == ENG_ASIDE_FOUND) {
            break; /* not listed yet */
        }
        if (state == ENG_ASIDE_LISTED) {
            build_part(aside, worker, end_ns);
        } else {
            aside->has_begun = false; /* its object went away */
            aside->building++;
        }
    }
    uint64_t share_ns = eng_now_ns() - begin_ns;
    worker->record.low_ns += share_ns;
    worker->record.rebuild_ns += share_ns;
}

void eng_aside_end_step(struct eng_aside *aside, uint64_t step_ns, uint32_t threads)
{
    uint64_t budget_ns = step_ns / (threads > 1 ? BUDGET_TOGETHER : BUDGET_ALONE);
    aside->budget_ns = budget_ns > BUDGET_MIN_NS ? budget_ns : BUDGET_MIN_NS;
}
