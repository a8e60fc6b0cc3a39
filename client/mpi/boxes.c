/* boxes.c - boxes around leaves. */
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

/* What is smaller, by `growth`, than a float: the difference is rounded by less than the
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

double ranks_reach(const struct ranks_object *object, double separation)
{
    double reach = separation / 2 + radius_of(object);
    return reach > 0 ? nextafter(reach, INFINITY) : 0;
}

static void grow(float box[6], double growth)
{
    for (int k = 0; k < 3; k++) {
        box[k] = grow_low(box[k], growth);
        box[k + 3] = grow_high(box[k + 3], growth);
    }
}

/* Of one object: all of its local vertices, each for all leaves that have it. */
static int bound(struct pccd_mpi *world, const struct ranks_object *object, double growth,
                 const double (*x0)[3], const double (*x1)[3],
                 struct ranks_moving_box **vertices, uint32_t (**corners)[3])
{
    uint32_t count = object->local.vertex_count;
    *vertices = ranks_array(count, sizeof **vertices);
    *corners = ranks_array(object->own_count, sizeof **corners);
    if (*vertices == NULL || *corners == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t i = 0; i < count; i++) {
        ranks_vertex_box(x0[i], x1[i], &object->room, &(*vertices)[i]);
        grow((*vertices)[i].box, growth);
    }
    return ranks_local_corners(world, &object->local, object->own, object->own_count,
                               *corners);
}

/* How far apart two boxes are along the axis along which they are farthest apart. */
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
static void make_blocks(const struct pccd_mpi *world, uint64_t leaf_count,
                        struct ranks_boxes *boxes)
{
    uint64_t most = BLOCKS_OF_ALL / (uint32_t)world->link.size;
    most = most < BLOCKS_MIN ? BLOCKS_MIN : most < BLOCKS_MAX ? most : BLOCKS_MAX;
    uint64_t size = leaf_count / most + 1;
    uint32_t jumps = 0;
    size = size < BLOCK_LEAVES_MIN ? BLOCK_LEAVES_MIN : size;
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
}

int ranks_boxes_make(struct pccd_mpi *world, double separation,
                     const double (*const *x0)[3], const double (*const *x1)[3],
                     struct ranks_boxes *boxes)
{
    uint32_t objects = world->object_count;
    uint64_t count = 0;
    boxes->vertices = calloc((size_t)objects + 1, sizeof *boxes->vertices);
    boxes->corners = calloc((size_t)objects + 1, sizeof *boxes->corners);
    if (boxes->vertices == NULL || boxes->corners == NULL) {
        return ranks_no_memory(world);
    }
    boxes->object_count = objects;
    for (uint32_t o = 0; o < objects; o++) {
        const struct ranks_object *object = world->objects[o];
        count += object->own_count;
        int status = bound(world, object, ranks_reach(object, separation), x0[o], x1[o],
                           &boxes->vertices[o], &boxes->corners[o]);
        if (status != PCCD_OK) {
            return status;
        }
    }
    boxes->blocks = ranks_array(2 * BLOCKS_MAX + objects + count / BLOCK_LEAVES_MIN,
                                sizeof *boxes->blocks);
    if (boxes->blocks == NULL) {
        return ranks_no_memory(world);
    }
    make_blocks(world, count, boxes);
    return PCCD_OK;
}
