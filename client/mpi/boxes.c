/* boxes.c - boxes around leaves, and who needs which leaves. */
#include "boxes.h"

#include <stdlib.h>

#include "parts.h"

/* Each rank gets the blocks of all, so of many ranks each has few. */
#define BLOCKS_OF_ALL    (1u << 20)
#define BLOCKS_MAX       32768u /* of a rank, one for each object and as many for jumps */
#define BLOCKS_MIN       256u   /* the same, where ranks are many */
#define BLOCK_LEAVES_MIN 16u

void ranks_boxes_deinit(struct ranks_boxes *boxes)
{
    for (uint32_t o = 0; o < boxes->object_count; o++) {
        free(boxes->vertices[o]);
        free(boxes->corners[o]);
    }
    free((void *)boxes->vertices);
    free((void *)boxes->corners);
    free(boxes->blocks);
}

/* Not less than the radius of any of the object's features. Radii of vertices are not
 * here, so the largest of the mesh counts. */
static double radius_of(const struct ranks_object *object)
{
    return object->settings.radius > 0 ? object->settings.radius
                                       : object->mesh->radius_max;
}

/* Return a float that is smaller by `growth`: the difference is rounded by less than the
 * step to the next double. */
static float grow_low(float low, double growth)
{
    return growth > 0 ? ranks_float_below(nextafter((double)low - growth, -INFINITY))
                      : low;
}
static float grow_high(float high, double growth)
{
    return growth > 0 ? ranks_float_above(nextafter((double)high + growth, INFINITY))
                      : high;
}

/* Return by how much the box of a leaf of the object is larger than the leaf: at least
 * the leaf's half of the distance at which any of its features meets another. */
static double reach_of(const struct ranks_object *object, double separation)
{
    double reach = separation / 2 + radius_of(object);
    return reach > 0 ? nextafter(reach, INFINITY) : 0;
}

void ranks_box_grow(float box[6], double growth)
{
    for (int k = 0; k < 3; k++) {
        box[k] = grow_low(box[k], growth);
        box[k + 3] = grow_high(box[k + 3], growth);
    }
}

/* Make boxes around all local vertices of an object, which begin at x[0] and end at x[1],
 * each for all leaves that have it. */
static int bound(struct pccd_mpi *world, uint32_t o, const struct ranks_margin *margin,
                 double growth, const double (*const x[2])[3], struct ranks_boxes *boxes)
{
    const struct ranks_object *object = world->objects[o];
    uint32_t count = object->local.vertex_count;
    struct ranks_moving_box *vertices = ranks_array(count, sizeof *vertices);
    boxes->vertices[o] = vertices;
    boxes->corners[o] = ranks_array(object->own_count, sizeof **boxes->corners);
    if (vertices == NULL || boxes->corners[o] == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t i = 0; i < count; i++) {
        ranks_vertex_box(x[0][i], x[1][i], margin, &vertices[i]);
        ranks_box_grow(vertices[i].box, growth);
    }
    return ranks_local_corners(world, &object->local, object->own, object->own_count,
                               boxes->corners[o]);
}

/* Return how far apart two boxes are along the axis along which they are farthest
 * apart. */
static double gap_between(const float a[6], const float b[6])
{
    double gap = 0;
    for (int k = 0; k < 3; k++) {
        gap = ranks_most(gap, ranks_most((double)a[k] - (double)b[k + 3],
                                         (double)b[k] - (double)a[k + 3]));
    }
    return gap;
}

static double side_of(const float box[6])
{
    double side = 0;
    for (int k = 0; k < 3; k++) {
        side = ranks_most(side, (double)box[k + 3] - (double)box[k]);
    }
    return side;
}

/* Where the curve leaves the scene and comes back elsewhere, a box around both places
 * would be as large as the jump, and meet whatever lies in between. */
static int make_blocks(struct pccd_mpi *world, uint64_t most, struct ranks_boxes *boxes)
{
    uint64_t leaf_count = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaf_count += world->objects[o]->own_count;
    }
    uint64_t size = leaf_count / most + 1, jumps = 0;
    size = size < BLOCK_LEAVES_MIN ? BLOCK_LEAVES_MIN : size;
    boxes->blocks = ranks_array(most + world->object_count + leaf_count / size,
                                sizeof *boxes->blocks);
    if (boxes->blocks == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t o = 0; o < world->object_count; o++) {
        uint32_t count = world->objects[o]->own_count;
        struct ranks_block *block = NULL;
        for (uint32_t i = 0; i < count; i++) {
            struct ranks_moving_box leaf;
            ranks_leaf_box(boxes, o, i, &leaf);
            bool jumps_here =
                block != NULL && block->count < size && jumps < most &&
                gap_between(block->box.box, leaf.box) > side_of(block->box.box);
            if (block == NULL || block->count == size || jumps_here) {
                block = &boxes->blocks[boxes->block_count++];
                block->object = o;
                block->begin = i;
                block->count = 0;
                ranks_moving_box_begin(&block->box);
                jumps += jumps_here;
            }
            block->count++;
            ranks_moving_box_add(&block->box, &leaf);
        }
    }
    return PCCD_OK;
}

static int begin(struct pccd_mpi *world, struct ranks_boxes *boxes)
{
    uint32_t objects = world->object_count;
    *boxes = (struct ranks_boxes){
        .vertices = calloc((size_t)objects + 1, sizeof *boxes->vertices),
        .corners = calloc((size_t)objects + 1, sizeof *boxes->corners)};
    if (boxes->vertices == NULL || boxes->corners == NULL) {
        return ranks_no_memory(world);
    }
    boxes->object_count = objects;
    return PCCD_OK;
}

int ranks_boxes_make(struct pccd_mpi *world, double separation, uint64_t block_count,
                     const double (*const *x0)[3], const double (*const *x1)[3],
                     struct ranks_boxes *boxes)
{
    int status = begin(world, boxes);
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = world->objects[o];
        status = bound(world, o, &object->margin, reach_of(object, separation),
                       (const double(*const[2])[3]){x0[o], x1[o]}, boxes);
    }
    return status == PCCD_OK ? make_blocks(world, block_count, boxes) : status;
}

int ranks_boxes_make_still(struct pccd_mpi *world, uint64_t block_count,
                           const double (*const *x)[3], struct ranks_boxes *boxes)
{
    const struct ranks_margin none = {.steps = 1};
    int status = begin(world, boxes);
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        status =
            bound(world, o, &none, 0, (const double(*const[2])[3]){x[o], x[o]}, boxes);
    }
    return status == PCCD_OK ? make_blocks(world, block_count, boxes) : status;
}

uint64_t ranks_block_count(const struct pccd_mpi *world)
{
    uint64_t most = BLOCKS_OF_ALL / (uint32_t)world->link.size;
    return most < BLOCKS_MIN ? BLOCKS_MIN : most < BLOCKS_MAX ? most : BLOCKS_MAX;
}

/* ---- who needs what --------------------------------------------------------------- */

/* Blocks of a rank that follow each other, and so are near each other as a rule: with one
 * box, so that not each block is compared with each one. */
#define BAND_BLOCKS 32u

struct band {
    struct ranks_moving_box box;
    uint64_t begin, end; /* of its blocks */
};

struct search {
    const struct ranks_fetch *fetch;
    struct ranks_block *all; /* boxes of all ranks that may meet own leaves */
    uint64_t *first;         /* [size + 1] of these */
    struct band *bands;      /* of these, rank by rank */
    uint64_t *band_first;    /* [size + 1] */
    struct band *own_bands;  /* of fetch->leaves->blocks */
    uint64_t own_band_count;
    /* What is near an own band, or a block of it; scratch. */
    const struct band **near_bands;
    const struct ranks_block **near_blocks;
    struct ranks_post post; /* items of fetch */
};

static void search_deinit(struct search *search)
{
    free(search->all);
    free(search->first);
    free(search->bands);
    free(search->band_first);
    free(search->own_bands);
    free((void *)search->near_bands);
    free((void *)search->near_blocks);
}

static bool meet(const struct search *search, const struct ranks_moving_box *a,
                 const struct ranks_moving_box *b)
{
    return ranks_moving_boxes_meet(a, b, search->fetch->steps);
}

/* Boxes far from all of this rank need not be looked at again and again. */
static void forget_far(const struct pccd_mpi *world, struct search *search)
{
    const struct ranks_boxes *leaves = search->fetch->leaves;
    struct ranks_moving_box whole;
    ranks_moving_box_begin(&whole);
    for (uint32_t b = 0; b < leaves->block_count; b++) {
        ranks_moving_box_add(&whole, &leaves->blocks[b].box);
    }
    uint64_t kept = 0;
    for (int r = 0; r < world->link.size; r++) {
        uint64_t begin = search->first[r];
        bool is_asked = r != world->link.rank || search->fetch->is_of_self;
        search->first[r] = kept;
        for (uint64_t i = begin; i < search->first[r + 1] && is_asked; i++) {
            if (meet(search, &whole, &search->all[i].box)) {
                search->all[kept++] = search->all[i];
            }
        }
    }
    search->first[world->link.size] = kept;
}

/* Bands of the blocks begin .. end - 1, to bands[]. Returns how many. */
static uint64_t band_up(const struct ranks_block *blocks, uint64_t begin, uint64_t end,
                        struct band *bands)
{
    uint64_t count = 0;
    for (uint64_t i = begin; i < end; i++) {
        if ((i - begin) % BAND_BLOCKS == 0) {
            bands[count] = (struct band){.begin = i};
            ranks_moving_box_begin(&bands[count++].box);
        }
        ranks_moving_box_add(&bands[count - 1].box, &blocks[i].box);
        bands[count - 1].end = i + 1;
    }
    return count;
}

static int make_bands(struct pccd_mpi *world, struct search *search)
{
    const uint32_t size = (uint32_t)world->link.size;
    const uint32_t own = search->fetch->leaves->block_count;
    uint64_t count = 0, most = search->first[size] / BAND_BLOCKS + size;
    search->bands = ranks_array(most, sizeof *search->bands);
    search->band_first = ranks_array((uint64_t)size + 1, sizeof *search->band_first);
    search->own_bands = ranks_array(own / BAND_BLOCKS + 1, sizeof *search->own_bands);
    search->near_bands = ranks_array(most, sizeof *search->near_bands);
    search->near_blocks = ranks_array(search->first[size], sizeof *search->near_blocks);
    if (search->bands == NULL || search->band_first == NULL ||
        search->own_bands == NULL || search->near_bands == NULL ||
        search->near_blocks == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t r = 0; r < size; r++) {
        search->band_first[r] = count;
        count += band_up(search->all, search->first[r], search->first[r + 1],
                         search->bands + count);
    }
    search->band_first[size] = count;
    search->own_band_count =
        band_up(search->fetch->leaves->blocks, 0, own, search->own_bands);
    return PCCD_OK;
}

/* The blocks of a band that this one meets: to near[]. */
static uint32_t find_near(const struct pccd_mpi *world, const struct search *search,
                          const struct ranks_block *block, const struct band *band,
                          const struct ranks_block **near)
{
    uint32_t count = 0;
    if (!meet(search, &block->box, &band->box)) {
        return 0;
    }
    for (uint64_t i = band->begin; i < band->end; i++) {
        const struct ranks_block *theirs = &search->all[i];
        if (meet(search, &block->box, &theirs->box) &&
            search->fetch->wants(world, theirs->object, block->object)) {
            near[count++] = theirs;
        }
    }
    return count;
}

/* Post the leaves of an own block that meet any of those near to rank r. */
static void choose_of(struct search *search, const struct ranks_block *block,
                      uint32_t near_count, int r)
{
    const struct ranks_fetch *fetch = search->fetch;
    for (uint32_t i = 0; i < block->count && near_count > 0; i++) {
        const uint32_t leaf = block->begin + i;
        struct ranks_moving_box box;
        uint32_t n = 0;
        ranks_leaf_box(fetch->leaves, block->object, leaf, &box);
        while (n < near_count && !meet(search, &box, &search->near_blocks[n]->box)) {
            n++;
        }
        void *item = n < near_count ? ranks_post_room(&search->post, (uint32_t)r) : NULL;
        if (item != NULL) {
            fetch->put(fetch->context, block->object, leaf, item);
        }
    }
}

/* Choose which of the own leaves go to rank r. */
static void choose_for(const struct pccd_mpi *world, struct search *search, int r)
{
    const struct ranks_block *blocks = search->fetch->leaves->blocks;
    for (uint64_t m = 0; m < search->own_band_count; m++) {
        const struct band *own = &search->own_bands[m];
        uint64_t bands = 0;
        for (uint64_t i = search->band_first[r]; i < search->band_first[r + 1]; i++) {
            search->near_bands[bands] = &search->bands[i];
            bands += meet(search, &own->box, &search->bands[i].box);
        }
        for (uint64_t b = own->begin; b < own->end && bands > 0; b++) {
            uint32_t count = 0;
            for (uint64_t i = 0; i < bands; i++) {
                count += find_near(world, search, &blocks[b], search->near_bands[i],
                                   search->near_blocks + count);
            }
            choose_of(search, &blocks[b], count, r);
        }
    }
}

int ranks_fetch_leaves(struct pccd_mpi *world, const struct ranks_fetch *fetch, void **in,
                       uint64_t *in_count)
{
    struct ranks_link *link = &world->link;
    struct search search = {.fetch = fetch};
    search.first = ranks_array((uint64_t)link->size + 1, sizeof *search.first);
    int status = ranks_agree_memory(world, search.first != NULL);
    *in_count = 0;
    if (status == PCCD_OK) {
        status = ranks_spread(link, sizeof *fetch->boxes, fetch->boxes, fetch->box_count,
                              (void **)&search.all, search.first);
    }
    if (status == PCCD_OK) {
        forget_far(world, &search);
        status = ranks_agree_on(link, make_bands(world, &search));
    }
    if (status == PCCD_OK) {
        ranks_post_begin(&search.post, fetch->item_bytes, 0);
        for (int r = 0; r < link->size && !search.post.is_lost; r++) {
            choose_for(world, &search, r);
        }
        status = ranks_post_deal(link, &search.post, in, in_count);
    }
    search_deinit(&search);
    return status;
}
