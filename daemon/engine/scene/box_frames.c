/* box_frames.c - where the boxes of a scene's objects are measured from. */
#include "box_frames.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "moving.h"
#include "world.h"

/* A float is off by 2^-24 of its distance from the origin, and so by at most 2^-10 of a
 * feature that is 2^-14 of that distance. Boxes that grow by that let hardly a pair in a
 * hundred through that they should not. */
#define FINE_ENOUGH 0x1p14

/* Distances from the origin whose areas and volumes floats hold, as products. */
#define FAR_LEAST 0x1p-20

/* The largest scale, so that no product with it overflows. */
#define SCALE_EXPONENT_MAX 1000

/* Gaps are shortened when they make the scene so many times as long as what is in it. */
#define SPARSE_FROM 16.0

/* Both ends of a step are measured from one origin, unless they are farther apart than
 * so many lengths of a group. */
#define MOVES_FAR_FROM 4.0

static const struct eng_box_frame plain = {.scale = 1};

static double farthest_of(const struct eng_bounds *bounds)
{
    double far = 0;
    for (int k = 0; k < 3; k++) {
        far = fmax(far, fmax(fabs(bounds->low[k]), fabs(bounds->high[k])));
    }
    return far;
}

/* Return whether boxes of features of size `detail` may be measured from the origin of
 * the coordinates, as far away as `far`. */
static bool is_fine_enough(double far, double detail)
{
    return far == 0 || (far >= FAR_LEAST && far <= FINE_ENOUGH * detail);
}

/* The scale that brings `far` into the numbers that floats hold well. */
static double scale_for(double far)
{
    int exponent;
    frexp(far, &exponent);
    return far == 0 || far >= FAR_LEAST
               ? 1
               : ldexp(1,
                       -exponent < SCALE_EXPONENT_MAX ? -exponent : SCALE_EXPONENT_MAX);
}

struct eng_box_frame eng_box_frame_alone(const struct eng_mesh *mesh,
                                         const double (*x)[3])
{
    assert(mesh->leaves && x);
    struct eng_box_frame frame = plain;
    double size = eng_bounds_size(&mesh->bounds);
    if (is_fine_enough(farthest_of(&mesh->bounds), size * mesh->fineness)) {
        return frame;
    }
    const double *anchor = x[mesh->leaves[0].v[0]];
    for (int k = 0; k < 3; k++) {
        frame.origin[k] = frame.origin[4 + k] = anchor[k];
    }
    frame.scale = scale_for(size);
    return frame;
}

/* The lengths that a scene's boxes have to tell apart. */
struct detail {
    double far;   /* from the origin, of all */
    double least; /* size of a feature, of the object with the smallest; */
    const struct eng_object *finest; /* that one */
};

/* Return the detail of objects that have moved so much at least. */
static struct detail detail_of(const struct eng_scene *scene, unsigned from, unsigned to,
                               enum eng_movement movement)
{
    struct detail detail = {0, INFINITY, NULL};
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (!object->mesh || object->moves < movement) {
            continue;
        }
        double size = fmax(eng_bounds_size(&object->bounds[from]),
                           eng_bounds_size(&object->bounds[to]));
        double feature = size * object->mesh->fineness;
        detail.far = fmax(detail.far, fmax(farthest_of(&object->bounds[from]),
                                           farthest_of(&object->bounds[to])));
        if (!detail.finest || (feature > 0 && feature < detail.least)) {
            detail.finest = object;
            detail.least = feature > 0 ? feature : INFINITY;
        }
    }
    return detail;
}

/* ---- along one axis ---------------------------------------------------------------- */

static int compare_items(const void *a, const void *b)
{
    const struct eng_box_frame_item *ia = a;
    const struct eng_box_frame_item *ib = b;
    if (ia->low[0] != ib->low[0]) {
        return ia->low[0] < ib->low[0] ? -1 : 1;
    }
    return ia->object < ib->object ? -1 : ia->object > ib->object;
}

/* All objects, in the order in which they begin at t = 0. */
static uint32_t list_items(struct eng_scene *scene, unsigned from, unsigned to, int axis)
{
    struct eng_box_frame_item *items = scene->framing.items;
    uint32_t count = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        const struct eng_bounds *begin = &object->bounds[from];
        const struct eng_bounds *end = &object->bounds[to];
        if (object->mesh) {
            items[count++] =
                (struct eng_box_frame_item){.low = {begin->low[axis], end->low[axis]},
                                            .high = {begin->high[axis], end->high[axis]},
                                            .object = i};
        }
    }
    qsort(items, count, sizeof *items, compare_items);
    for (uint32_t i = count; i-- > 0;) {
        for (int end = 0; end < 2; end++) {
            double behind = i + 1 < count ? items[i + 1].next_low[end] : INFINITY;
            items[i].next_low[end] = fmin(items[i].low[end], behind);
        }
    }
    return count;
}

/* Objects of which none is apart from all others, at both ends in the same order. */
struct group {
    uint32_t first; /* items */
    uint32_t end;
    double low[2]; /* around them, at both ends */
    double high[2];
};

static struct group group_from(const struct eng_box_frame_item *items, uint32_t first,
                               uint32_t count, bool is_sparse)
{
    struct group group = {first, first, {INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    do {
        const struct eng_box_frame_item *item = &items[group.end++];
        for (int end = 0; end < 2; end++) {
            group.low[end] = fmin(group.low[end], item->low[end]);
            group.high[end] = fmax(group.high[end], item->high[end]);
        }
    } while (group.end < count &&
             (!is_sparse || items[group.end].next_low[0] <= group.high[0] ||
              items[group.end].next_low[1] <= group.high[1]));
    return group;
}

/* The length that a group takes, with one origin for both ends if `is_slow`. */
static double length_of(const struct group *group, bool *is_slow)
{
    double longest = fmax(group->high[0] - group->low[0], group->high[1] - group->low[1]);
    double around =
        fmax(group->high[0], group->high[1]) - fmin(group->low[0], group->low[1]);
    *is_slow = around <= MOVES_FAR_FROM * longest;
    return *is_slow ? around : longest;
}

/* The layout of a scene's groups along an axis. */
struct layout {
    bool is_sparse; /* gaps are shortened .. */
    double gap;     /* .. to this */
};

static struct layout layout_of(const struct eng_box_frame_item *items, uint32_t count)
{
    double low = INFINITY;
    double high = -INFINITY;
    double sum = 0;
    double groups = 0;
    for (uint32_t i = 0; i < count;) {
        bool is_slow;
        struct group group = group_from(items, i, count, true);
        sum += length_of(&group, &is_slow);
        low = fmin(low, fmin(group.low[0], group.low[1]));
        high = fmax(high, fmax(group.high[0], group.high[1]));
        groups++;
        i = group.end;
    }
    return (struct layout){high - low > SPARSE_FROM * sum,
                           sum > 0 ? sum / groups : (high - low) / groups};
}

/* One group after the other, from 0 on: the origin that each object's coordinates along
 * the axis get. */
static void place_groups(struct eng_scene *scene, uint32_t count, int axis)
{
    const struct eng_box_frame_item *items = scene->framing.items;
    struct layout layout = layout_of(items, count);
    double at = 0;
    for (uint32_t i = 0; i < count;) {
        bool is_slow;
        struct group group = group_from(items, i, count, layout.is_sparse);
        double length = length_of(&group, &is_slow);
        double both = fmin(group.low[0], group.low[1]);
        for (; i < group.end; i++) {
            struct eng_box_frame *frame = &scene->objects[items[i].object].frame;
            frame->origin[axis] = (is_slow ? both : group.low[0]) - at;
            frame->origin[4 + axis] = (is_slow ? both : group.low[1]) - at;
        }
        double gap = i < count ? fmin(items[i].next_low[0] - group.high[0],
                                      items[i].next_low[1] - group.high[1])
                               : 0;
        at += length + fmin(gap, layout.gap);
    }
}

/* Origins may differ by less than a gap between groups by this part of the numbers at
 * hand: more than what rounding adds to either. */
#define SPARE_PART 0x1p-40

/* By how much the origin of the next group may lie above that of this one, at an end: as
 * far as the gap is longer than `left`, and never more. */
static double shift_across(double gap, double left, double origin)
{
    double shift = gap * (1 - SPARE_PART) - left - SPARE_PART * fabs(origin);
    return fmax(shift, 0);
}

/* The same, but origins never fall from one group to the next, and the gap that is left
 * of one that is shortened is more than none. */
static void place_groups_in_order(struct eng_scene *scene, uint32_t count, int axis)
{
    const struct eng_box_frame_item *items = scene->framing.items;
    struct layout layout = layout_of(items, count);
    double origin[2] = {0, 0};
    for (uint32_t i = 0; i < count;) {
        struct group group = group_from(items, i, count, layout.is_sparse);
        for (int end = 0; end < 2 && i == 0; end++) {
            origin[end] = group.low[end];
        }
        for (; i < group.end; i++) {
            struct eng_box_frame *frame = &scene->objects[items[i].object].frame;
            frame->origin[axis] = origin[0];
            frame->origin[4 + axis] = origin[1];
        }
        for (int end = 0; end < 2 && i < count; end++) {
            origin[end] += shift_across(items[i].next_low[end] - group.high[end],
                                        layout.gap, origin[end]);
        }
    }
}

/* ---- the scene --------------------------------------------------------------------- */

/* Floats are finest near 0: have the finest object there. Groups keep one origin each. */
static void shift_to(struct eng_scene *scene, const struct eng_object *finest,
                     unsigned to)
{
    assert(finest->mesh);
    const double *anchor =
        scene->x[to][finest->vertices.first + finest->mesh->leaves[0].v[0]];
    double shift[3];
    for (int k = 0; k < 3; k++) {
        shift[k] = anchor[k] - finest->frame.origin[4 + k];
    }
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        for (int k = 0; k < 3; k++) {
            scene->objects[i].frame.origin[k] += shift[k];
            scene->objects[i].frame.origin[4 + k] += shift[k];
        }
    }
}

static void set_scale(struct eng_scene *scene, double scale)
{
    scene->framing.scale = scale;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        scene->objects[i].frame.scale = scale;
    }
}

static void make_plain(struct eng_scene *scene)
{
    for (uint32_t i = 0; scene->framing.number > 0 && i < scene->object_capacity; i++) {
        scene->objects[i].frame = plain;
    }
    scene->framing.number = 0;
    scene->framing.scale = 1;
    scene->framing.keeps_order = true;
}

bool eng_box_frames_extent(const struct eng_scene *scene, double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        for (int j = 0; object->mesh && j < 6; j++) {
            const struct eng_box_frame *frame = &object->frame;
            int k = j % 3;
            const struct eng_bounds *bounds = &object->bounds[scene->framing.ends[j / 3]];
            double origin = frame->origin[j < 3 ? k : 4 + k];
            low[k] = fmin(low[k], (bounds->low[k] - origin) * frame->scale);
            high[k] = fmax(high[k], (bounds->high[k] - origin) * frame->scale);
        }
    }
    return low[0] <= high[0];
}

static void choose(struct eng_scene *scene, unsigned from, unsigned to, bool keeps_order)
{
    assert(from <= 1 && to <= 1);
    scene->framing.of = 0;
    struct detail detail = detail_of(scene, from, to, ENG_STANDS);
    double low[3];
    double high[3];
    scene->framing.ends[0] = from;
    scene->framing.ends[1] = to;
    scene->framing.far = detail.far;
    scene->framing.least = detail.least;
    if (!detail.finest || is_fine_enough(detail.far, detail.least)) {
        make_plain(scene);
        return;
    }
    for (int axis = 0; axis < 3; axis++) {
        uint32_t count = list_items(scene, from, to, axis);
        if (keeps_order) {
            place_groups_in_order(scene, count, axis);
        } else {
            place_groups(scene, count, axis);
        }
    }
    scene->framing.keeps_order = keeps_order;
    shift_to(scene, detail.finest, to);
    set_scale(scene, 1);
    eng_box_frames_extent(scene, low, high);
    struct eng_bounds around = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
    set_scale(scene, scale_for(farthest_of(&around)));
    scene->framing.number = ++scene->framing.chosen;
}

void eng_box_frames_choose(struct eng_scene *scene, unsigned from, unsigned to)
{
    choose(scene, from, to, false);
}

void eng_box_frames_choose_keeping(struct eng_scene *scene, unsigned from, unsigned to)
{
    choose(scene, from, to, true);
}

/* Return whether all objects have one frame. Then it may stay wherever they go: only what
 * is near the origin is measured finely. */
static bool is_uniform(const struct eng_scene *scene)
{
    const struct eng_box_frame *one = NULL;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_box_frame *frame = &scene->objects[i].frame;
        if (!scene->objects[i].mesh) {
            continue;
        }
        for (int k = 0; one && k < 3; k++) {
            if (frame->origin[k] != one->origin[k] ||
                frame->origin[4 + k] != one->origin[4 + k]) {
                return false;
            }
        }
        if (one && frame->scale != one->scale) {
            return false;
        }
        one = frame;
    }
    return one != NULL;
}

bool eng_box_frames_keep_distances(const struct eng_scene *scene)
{
    return scene->framing.number == 0 || scene->framing.keeps_order || is_uniform(scene);
}

/* Return how far an object is from the origin of its frame, at either end. */
static double far_in_frame(const struct eng_object *object, const unsigned ends[2])
{
    double far = 0;
    for (int j = 0; j < 6; j++) {
        const struct eng_bounds *bounds = &object->bounds[ends[j / 3]];
        double origin = object->frame.origin[4 * (j / 3) + j % 3];
        far = fmax(far, fmax(fabs(bounds->low[j % 3] - origin),
                             fabs(bounds->high[j % 3] - origin)));
    }
    return far;
}

/* Return whether the frames of the last step may stay, so that the boxes of what stands
 * can. */
static bool still_fit(const struct eng_scene *scene)
{
    const struct eng_framing *framing = &scene->framing;
    struct detail detail =
        detail_of(scene, framing->ends[0], framing->ends[1], ENG_STANDS);
    if (!is_uniform(scene) || !detail.finest ||
        is_fine_enough(detail.far, detail.least) ||
        far_in_frame(detail.finest, framing->ends) > FINE_ENOUGH * detail.least) {
        return false;
    }
    double far = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        far = object->mesh ? fmax(far, far_in_frame(object, framing->ends)) : far;
    }
    return scale_for(far) == framing->scale;
}

/* Return whether boxes may still be measured from the origin. Certain, by what moves
 * alone: what is said of the others may be of where they were. */
static bool stay_plain(struct eng_scene *scene)
{
    struct eng_framing *framing = &scene->framing;
    struct detail detail =
        detail_of(scene, framing->ends[0], framing->ends[1], ENG_MOVES_SOME);
    framing->far = fmax(framing->far, detail.far);
    framing->least = fmin(framing->least, detail.least);
    return detail.far >= FAR_LEAST && is_fine_enough(framing->far, framing->least);
}

/* The positions have moved on from those that the frames are for. */
static bool may_stay(struct eng_scene *scene)
{
    return scene->moving.objects == 0 ||
           (eng_moves_little(scene) &&
            (scene->framing.number == 0 ? stay_plain(scene) : still_fit(scene)));
}

void eng_box_frames_follow(struct eng_scene *scene)
{
    struct eng_framing *framing = &scene->framing;
    bool is_next = framing->of != 0 && framing->of + 1 == scene->moving.number;
    framing->ends[0] = 1 - scene->now;
    framing->ends[1] = scene->now;
    if (!is_next || !may_stay(scene) ||
        (scene->thickness.is_on && !eng_box_frames_keep_distances(scene))) {
        choose(scene, framing->ends[0], framing->ends[1], scene->thickness.is_on);
    }
    framing->of = scene->moving.number;
}
