/* background.c - large subtrees, built in the background and swapped in. */
#include "background.h"

#include <assert.h>
#include <string.h>

#include "memory.h"
#include "rebuild.h"
#include "refit.h"

/* The share of a step, at least: less than this is not worth beginning. */
#define BUDGET_MIN_NS 200000u

/* Part of the last step's time that a share takes: for one thread, which pays for all of
 * it; and for one of several, which the others relieve of other work meanwhile. */
#define BUDGET_ALONE    4u
#define BUDGET_TOGETHER 2u

/* Part of the share that goes to listing, which everybody waits for. */
#define BUDGET_LISTING 4u

void eng_background_init(struct eng_background *background)
{
    memset(background, 0, sizeof *background);
    background->budget_ns = BUDGET_MIN_NS;
}

void eng_background_deinit(struct eng_background *background)
{
    eng_free(background->items);
    background->items = NULL;
    background->capacity = 0;
}

uint64_t eng_background_bytes(const struct eng_background *background)
{
    return (uint64_t)background->capacity * sizeof *background->items;
}

/* Nothing of the old batch is needed any more. */
static bool reserve(struct eng_background *background, uint32_t capacity)
{
    if (capacity <= background->capacity) {
        return true;
    }
    eng_background_deinit(background);
    background->items = eng_alloc(capacity, sizeof *background->items);
    background->capacity = background->items ? capacity : 0;
    return background->items != NULL;
}

void eng_background_forget(struct eng_background *background, struct eng_range nodes)
{
    for (uint32_t i = 0; i < background->part_count; i++) {
        struct eng_background_part *part = &background->parts[i];
        if (part->root - nodes.first < nodes.count) {
            part->state = ENG_BACKGROUND_GONE;
        }
    }
}

static struct eng_range nodes_of(const struct eng_background_part *part)
{
    return (struct eng_range){part->root, 2 * part->count - 1};
}

void eng_background_swap(struct eng_background *background, struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    background->swaps = 0;
    background->swapped_triangles = 0;
    for (uint32_t i = 0; i < background->part_count; i++) {
        struct eng_background_part *part = &background->parts[i];
        if (part->state == ENG_BACKGROUND_BUILT) {
            eng_grow_leaves(trees, nodes_of(part), background->items + part->first);
            if (trees->has_foreign) {
                eng_foreign_mark(trees, nodes_of(part));
            }
            part->state = ENG_BACKGROUND_FRESH;
            background->swaps++;
            background->swapped_triangles += part->count;
        }
    }
}

/* Take the largest poor subtrees of an object into the batch. */
static void examine_object(struct eng_background *background,
                           const struct eng_scene *scene, struct eng_range nodes)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t end = nodes.first + nodes.count;
    for (uint32_t i = nodes.first; i < end;) {
        const struct eng_node *node = &trees->nodes[i];
        bool is_high = node->count > scene->settings.region_triangles;
        bool is_poor = is_high && node->count >= ENG_EXAMINE_MIN &&
                       eng_metric_is_poor(eng_metric(trees->nodes, node),
                                          trees->upkeep[i].built_ratio,
                                          (float)scene->settings.rebuild_ratio);
        if (is_poor && background->part_count < ENG_BACKGROUND_PARTS_MAX) {
            background->parts[background->part_count++] = (struct eng_background_part){
                .state = ENG_BACKGROUND_FOUND, .root = i, .count = node->count};
        }
        i += is_high && !is_poor ? 1 : 2 * node->count - 1;
    }
}

/* Look for poor subtrees; room for them is needed at once. */
static void find_parts(struct eng_background *background, const struct eng_scene *scene)
{
    uint32_t triangles = 0;
    background->part_count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh) {
            examine_object(background, scene,
                           eng_paper_object_of(&scene->objects[i])->nodes);
        }
    }
    for (uint32_t i = 0; i < background->part_count; i++) {
        background->parts[i].first = triangles;
        triangles += background->parts[i].count;
    }
    if (!reserve(background, triangles)) {
        background->part_count = 0;
    }
    background->listing = 0;
    background->next_node = background->part_count > 0 ? background->parts[0].root : 0;
    background->next_item = 0;
    background->building = 0;
    background->has_begun = false;
}

static void list_leaf(struct eng_background *background, const struct eng_node *leaf)
{
    assert(leaf->left == ENG_LEAF);
    uint32_t first = background->parts[background->listing].first;
    background->items[first + background->next_item++] =
        eng_split_item_of(leaf, leaf->right);
}

/* The next node above regions, or the next region as a whole: later steps may move
 * triangles within it. */
static void list_some(struct eng_background *background, const struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    uint32_t first = background->next_node;
    uint32_t count = trees->nodes[first].count;
    bool is_high = count > scene->settings.region_triangles;
    background->next_node += is_high ? 1 : 2 * count - 1;
    for (uint32_t i = first; i < background->next_node; i++) {
        if (trees->nodes[i].left == ENG_LEAF) {
            list_leaf(background, &trees->nodes[i]);
        }
    }
}

static void list(struct eng_background *background, const struct eng_scene *scene,
                 uint64_t end_ns)
{
    while (background->listing < background->part_count && common_now_ns() < end_ns) {
        struct eng_background_part *part = &background->parts[background->listing];
        if (part->state == ENG_BACKGROUND_FOUND && background->next_item < part->count) {
            list_some(background, scene);
            continue;
        }
        if (part->state == ENG_BACKGROUND_FOUND) {
            part->state = ENG_BACKGROUND_LISTED;
        }
        if (++background->listing < background->part_count) {
            background->next_node = background->parts[background->listing].root;
            background->next_item = 0;
        }
    }
}

/* Note the metric of what is new in place; return whether anything is left to do in the
 * batch. */
static bool end_swaps(struct eng_background *background, struct eng_scene *scene)
{
    bool is_busy = false;
    for (uint32_t i = 0; i < background->part_count; i++) {
        struct eng_background_part *part = &background->parts[i];
        if (part->state == ENG_BACKGROUND_FRESH) {
            eng_metric_note_built(scene, nodes_of(part));
            part->state = ENG_BACKGROUND_GONE;
        }
        is_busy = is_busy || part->state != ENG_BACKGROUND_GONE;
    }
    return is_busy;
}

void eng_background_examine(struct eng_background *background, struct eng_worker *worker)
{
    assert(background->part_count <= ENG_BACKGROUND_PARTS_MAX);
    struct eng_scene *scene = worker->scene;
    uint64_t begin_ns = common_now_ns();
    if (scene->settings.rebuild_ratio <= 0) {
        return;
    }
    if (!end_swaps(background, scene)) {
        find_parts(background, scene);
    }
    list(background, scene, begin_ns + background->budget_ns / BUDGET_LISTING);
    worker->record.rebuild_ns += common_now_ns() - begin_ns;
}

static void begin_part(struct eng_background *background,
                       const struct eng_background_part *part)
{
    struct eng_grower *grower = &background->grower;
    grower->items = background->items + part->first;
    grower->nodes = NULL;
    grower->over_roots = false;
    eng_grow_begin(grower, part->count, part->root);
    background->has_begun = true;
}

/* Work on one part until it is built or the time is over. */
static void build_part(struct eng_background *background, struct eng_worker *worker,
                       uint64_t end_ns)
{
    struct eng_background_part *part = &background->parts[background->building];
    uint64_t begin_ns = eng_worker_slice(worker);
    if (!background->has_begun) {
        begin_part(background, part);
    }
    while (common_now_ns() < end_ns) {
        if (!eng_grow_piece(&background->grower)) {
            part->state = ENG_BACKGROUND_BUILT;
            background->has_begun = false;
            background->building++;
            break;
        }
    }
    eng_worker_trace(worker, PCCD_TRACE_BACKGROUND, begin_ns, part->root, part->count);
}

void eng_background_share(struct eng_background *background, struct eng_worker *worker)
{
    assert(background->building <= background->part_count);
    uint64_t begin_ns = common_now_ns();
    uint64_t end_ns = begin_ns + background->budget_ns;
    while (background->building < background->part_count && common_now_ns() < end_ns &&
           !eng_stop_is_set(worker->stop)) {
        enum eng_background_state state = background->parts[background->building].state;
        if (state == ENG_BACKGROUND_FOUND) {
            break; /* not listed yet */
        }
        if (state == ENG_BACKGROUND_LISTED) {
            build_part(background, worker, end_ns);
        } else {
            background->has_begun = false; /* its object went away */
            background->building++;
        }
    }
    uint64_t share_ns = common_now_ns() - begin_ns;
    worker->record.low_ns += share_ns;
    worker->record.rebuild_ns += share_ns;
}

void eng_background_end_step(struct eng_background *background, uint64_t step_ns,
                             uint32_t threads)
{
    assert(threads >= 1);
    uint64_t budget_ns = step_ns / (threads > 1 ? BUDGET_TOGETHER : BUDGET_ALONE);
    background->budget_ns = budget_ns > BUDGET_MIN_NS ? budget_ns : BUDGET_MIN_NS;
}
