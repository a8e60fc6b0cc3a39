/* weigh.c - the weights of leaves.
 *
 * Room:     client/mpi.
 * Does:     sort the boxes of own leaves and ghosts along the curve, put boxes around
 *           each eight of them, and so on; ask for each own leaf what its box meets.
 * Threads:  one.
 * Source:   weigh.h.
 */
#include "weigh.h"

#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "curve.h"
#include "local.h"
#include "places.h"
#include "rank_sort.h"

#define FAN          8u
#define LEVELS_MAX   12u
#define WEIGHT_UNITS 16.0 /* of the work of a leaf that meets nothing */
#define WEIGHT_RATIO 4.0  /* that, in leaves that it meets, where nothing says so */
/* So that a heap of leaves in one place ends: it is cut anyway wherever it can be. */
#define WEIGHT_MAX 65535u

struct item {
    float box[6];
    uint32_t object;
    uint32_t leaf; /* of its own leaves; RANKS_NONE: a ghost */
    uint32_t v[3];
};

/* Items in the order of the curve, and boxes around FAN of the level below each. */
struct tree {
    struct item *items;
    uint64_t count;
    float (*boxes[LEVELS_MAX])[6]; /* [0] around items */
    uint64_t counts[LEVELS_MAX];
    uint32_t levels;
};

static void tree_deinit(struct tree *tree)
{
    free(tree->items);
    for (uint32_t i = 0; i < tree->levels; i++) {
        free(tree->boxes[i]);
    }
}

/* Boxes of one object's leaves, own and ghosts. */
static int add_items(struct pccd_mpi *world, uint32_t o, double growth,
                     const double (*x0)[3], const double (*x1)[3], struct item *items)
{
    const struct ranks_object *object = world->objects[o];
    uint32_t count = object->own_count + object->ghost_count;
    uint32_t(*corners)[3] = ranks_array(count, sizeof *corners);
    int status = corners == NULL ? ranks_no_memory(world)
                                 : ranks_local_corners(world, &object->local, object->own,
                                                       object->own_count, corners);
    if (status == PCCD_OK) {
        status = ranks_local_corners(world, &object->local, object->ghosts,
                                     object->ghost_count, corners + object->own_count);
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        items[i].object = o;
        items[i].leaf = i < object->own_count ? i : RANKS_NONE;
        memcpy(items[i].v, corners[i], sizeof items[i].v);
        ranks_leaf_box(x0, x1, corners[i], growth, items[i].box);
    }
    free(corners);
    return status;
}

static int sort_items(struct pccd_mpi *world, struct tree *tree)
{
    float whole[6];
    double low[3], high[3];
    struct ranks_key *keys = ranks_array(2 * tree->count, sizeof *keys);
    struct item *sorted = ranks_array(tree->count, sizeof *sorted);
    if (keys == NULL || sorted == NULL) {
        free(keys);
        free(sorted);
        return ranks_no_memory(world);
    }
    ranks_box_begin(whole);
    for (uint64_t i = 0; i < tree->count; i++) {
        ranks_box_add(whole, tree->items[i].box);
    }
    for (int k = 0; k < 3; k++) {
        low[k] = (double)whole[k];
        high[k] = (double)whole[k + 3];
    }
    for (uint64_t i = 0; i < tree->count; i++) {
        const float *box = tree->items[i].box;
        const double middle[3] = {0.5 * ((double)box[0] + (double)box[3]),
                                  0.5 * ((double)box[1] + (double)box[4]),
                                  0.5 * ((double)box[2] + (double)box[5])};
        keys[i] = (struct ranks_key){ranks_curve_place(middle, low, high), i};
    }
    const struct ranks_key *order = ranks_sort(keys, keys + tree->count, tree->count);
    for (uint64_t i = 0; i < tree->count; i++) {
        sorted[i] = tree->items[order[i].value];
    }
    free(keys);
    free(tree->items);
    tree->items = sorted;
    return PCCD_OK;
}

static const float *box_at(const struct tree *tree, uint32_t level, uint64_t i)
{
    return level == 0 ? tree->items[i].box : tree->boxes[level - 1][i];
}

/* Level n + 1 is made of level n, items being level 0, until one box is left. */
static int make_levels(struct pccd_mpi *world, struct tree *tree)
{
    uint64_t count = tree->count;
    while (count > 1 && tree->levels < LEVELS_MAX) {
        uint64_t above = (count + FAN - 1) / FAN;
        float(*boxes)[6] = ranks_array(above, sizeof *boxes);
        if (boxes == NULL) {
            return ranks_no_memory(world);
        }
        for (uint64_t i = 0; i < above; i++) {
            ranks_box_begin(boxes[i]);
            for (uint64_t j = i * FAN; j < (i + 1) * FAN && j < count; j++) {
                ranks_box_add(boxes[i], box_at(tree, tree->levels, j));
            }
        }
        tree->boxes[tree->levels] = boxes;
        tree->counts[tree->levels++] = above;
        count = above;
    }
    return PCCD_OK;
}

/* Leaves that share a vertex are not much work: most pairs of their features do, too. */
static bool are_joined(const struct item *a, const struct item *b)
{
    bool is_joined = false;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            is_joined = is_joined || a->v[i] == b->v[k];
        }
    }
    return is_joined && a->object == b->object;
}

/* How many other items meet one, and may. A walk over the tree without a stack: the next
 * box is the first one below, or the next beside, or beside one above. */
static uint32_t count_meeting(const struct pccd_mpi *world, const struct tree *tree,
                              const struct item *item)
{
    uint32_t met = 0, level = tree->levels;
    uint64_t at = 0;
    for (;;) {
        bool meets = ranks_boxes_meet(item->box, box_at(tree, level, at));
        if (meets && level > 0) {
            level--;
            at *= FAN;
            continue;
        }
        if (meets && &tree->items[at] != item) {
            met += !are_joined(item, &tree->items[at]) &&
                   ranks_may_meet(world, item->object, tree->items[at].object);
        }
        uint64_t count = level == 0 ? tree->count : tree->counts[level - 1];
        while (level < tree->levels && (at % FAN == FAN - 1 || at + 1 == count)) {
            at /= FAN;
            level++;
            count = tree->counts[level - 1];
        }
        if (level == tree->levels || met >= WEIGHT_MAX) {
            return met;
        }
        at++;
    }
}

static int weigh_items(struct pccd_mpi *world, struct tree *tree)
{
    int status = sort_items(world, tree);
    if (status == PCCD_OK) {
        status = make_levels(world, tree);
    }
    for (uint64_t i = 0; i < tree->count && status == PCCD_OK; i++) {
        const struct item *item = &tree->items[i];
        if (item->leaf != RANKS_NONE) {
            world->objects[item->object]->weights[item->leaf] =
                count_meeting(world, tree, item);
        }
    }
    return status;
}

static int make_items(struct pccd_mpi *world, double separation, double (*const *x)[3],
                      struct tree *tree)
{
    uint32_t objects = world->object_count;
    uint64_t at = 0;
    for (uint32_t o = 0; o < objects; o++) {
        tree->count += world->objects[o]->own_count + world->objects[o]->ghost_count;
    }
    tree->items = ranks_array(tree->count, sizeof *tree->items);
    int status = tree->items == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        free(object->weights);
        object->weights = ranks_array(object->own_count, sizeof *object->weights);
        status = object->weights == NULL
                     ? ranks_no_memory(world)
                     : add_items(world, o, ranks_reach(object, separation),
                                 (const double(*)[3])x[o],
                                 (const double(*)[3])x[objects + o], tree->items + at);
        at += object->own_count + object->ghost_count;
    }
    return status;
}

/* Work of the last step = alone * leaves + meeting * (leaves that they meet), as nearly
 * as that can be for all ranks (least squares). Returns alone / meeting. */
static double fit(const uint64_t *leaves, const uint64_t *met, const uint64_t *work,
                  int size)
{
    double ll = 0, lm = 0, mm = 0, lw = 0, mw = 0;
    for (int r = 0; r < size; r++) {
        double l = (double)leaves[r], m = (double)met[r], w = (double)work[r];
        ll += l * l;
        lm += l * m;
        mm += m * m;
        lw += l * w;
        mw += m * w;
    }
    double determinant = ll * mm - lm * lm;
    double alone = lw * mm - mw * lm, meeting = mw * ll - lw * lm;
    if (!(determinant > 1e-9 * ll * mm) || !(meeting > 0)) {
        return WEIGHT_RATIO;
    }
    double ratio = alone / meeting;
    return fmin(fmax(ratio, 0.25), 64);
}

/* From how many leaves each one meets to what it weighs. */
static int scale(struct pccd_mpi *world)
{
    struct ranks_link *link = &world->link;
    uint64_t leaves = 0, met = 0;
    uint64_t *all = ranks_array(3 * (uint64_t)link->size, sizeof *all);
    int status = ranks_agree_on(link, all == NULL ? ranks_no_memory(world) : PCCD_OK);
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaves += world->objects[o]->own_count;
        for (uint32_t i = 0; i < world->objects[o]->own_count; i++) {
            met += world->objects[o]->weights[i];
        }
    }
    const uint64_t mine[3] = {leaves, met, world->share.work};
    for (int i = 0; i < 3 && status == PCCD_OK; i++) {
        status = ranks_tell_all(link, mine[i], all + i * link->size);
    }
    if (status == PCCD_OK) {
        double ratio = fit(all, all + link->size, all + 2 * link->size, link->size);
        for (uint32_t o = 0; o < world->object_count; o++) {
            for (uint32_t i = 0; i < world->objects[o]->own_count; i++) {
                uint32_t *weight = &world->objects[o]->weights[i];
                *weight = (uint32_t)(WEIGHT_UNITS * (1 + *weight / ratio));
            }
        }
    }
    free(all);
    return status;
}

int ranks_weigh(struct pccd_mpi *world, double separation)
{
    uint32_t objects = world->object_count;
    struct tree tree = {.count = 0};
    double(**x)[3] = calloc(2 * (size_t)objects + 1, sizeof *x);
    const double(**given)[3] = calloc((size_t)objects + 1, sizeof *given);
    int status = x == NULL || given == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < 2 * objects && status == PCCD_OK; o++) {
        x[o] = ranks_array(world->objects[o % objects]->local.vertex_count, sizeof **x);
        status = x[o] == NULL ? ranks_no_memory(world) : PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    for (uint32_t end = 0; end < 2 && status == PCCD_OK; end++) {
        for (uint32_t o = 0; o < objects; o++) {
            given[o] = end == 0 ? world->objects[o]->from : world->objects[o]->to;
        }
        status = ranks_plan_send(world, given, x + end * objects);
    }
    if (status == PCCD_OK) {
        status = make_items(world, separation, x, &tree);
        if (status == PCCD_OK) {
            status = weigh_items(world, &tree);
        }
        status = ranks_agree_on(&world->link, status);
    }
    if (status == PCCD_OK) {
        status = scale(world);
    }
    tree_deinit(&tree);
    for (uint32_t o = 0; x != NULL && o < 2 * objects; o++) {
        free(x[o]);
    }
    free((void *)x);
    free((void *)given);
    return status;
}
