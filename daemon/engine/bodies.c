/* bodies.c - which steps are taken in body space. */
#include "bodies.h"

#include <math.h>

#include "body_tree.h"
#include "clock.h"
#include "method.h"
#include "step_memory.h"

/* Where it pays. Few objects: each is compared with all that are beside it along one
 * axis, some ns a pair. Not too small ones: boxes of some triangles are made in less time
 * than two poses take. What moves is a part of all, since all of it has a tree more, 45
 * bytes a triangle. And most of it goes no farther than half of its size: where it
 * sweeps by more, most of the work are pairs of leaves. */
#define OBJECTS_MOST   1024u
#define LEAVES_EACH    32u
#define LEAVES_LEAST   1024u
#define STANDING_PARTS 64u
#define FAR_PARTS      4u

/* Pairs of leaves that are tested, as a part of the leaves that move: where there are
 * more, bodies are near each other, or sweep by each other. A pair takes some 75 ns here,
 * with all of its features; the method makes a box for some 20, compares sixteen at a
 * time, and has boxes of features. */
#define PAIRS_PART 4u

/* Meshes with so small a part of the leaves that move get their trees in the step itself:
 * they are in many objects, and this takes less time than to make the boxes of these. */
#define SHARED_PART 16u

/* Steps until the next one in body space, after one that was not. */
#define WAIT_FIRST 32u
#define WAIT_MOST  1024u

/* Work at a time on the trees of meshes: of a large one as many looks (body_tree.h), of
 * smaller ones leaves. */
#define LOOKS        4u
#define LEAVES_SHARE 1024u

/* A deadline so soon may be a client's own, which a step that makes all boxes anew would
 * miss. Others are what the daemon lets a step take. */
#define SOON_NS 1000000000u

static bool has_to_end_soon(const struct eng_question *question)
{
    return question->deadline_ns != 0 &&
           question->deadline_ns < common_now_ns() + SOON_NS;
}

bool eng_bodies_may(const struct eng_scene *scene, const struct eng_question *question)
{
    bool is_plain = question->mode == PCCD_MODE_ALL ||
                    question->mode == PCCD_MODE_FIRST || question->mode == PCCD_MODE_ANY;
    bool may = is_plain && eng_method_of(question) == PCCD_METHOD_WIDE &&
               question->tuning.still == ENG_STILL_KEPT && question->distance == 0 &&
               !question->tells_start && !question->weigh && !eng_asks_part(question) &&
               !eng_asks_touching(question) && !scene->thickness.is_on &&
               !eng_masks_have_clearances(&scene->masks) && !scene->has_lost_start &&
               !(eng_scene_turns(scene) && question->mode == PCCD_MODE_ANY) &&
               !(question->brief && scene->staging) &&
               (question->team_always || !has_to_end_soon(question));
    for (uint32_t i = 0; i < scene->write_count && may && scene->staging; i++) {
        may = scene->writes[i].has_poses || scene->writes[i].joint != PCCD_NO_JOINT;
    }
    eng_step_memory_of(scene)->bodies.wants_trees = false;
    return may;
}

/* Return whether an object that moves does so by poses, and is not tested against
 * itself. */
static bool is_body(const struct eng_scene *scene, uint32_t idx)
{
    const struct eng_object *object = &scene->objects[idx];
    const struct eng_masks_entry *entry = &scene->masks.entries[idx];
    return object->has_poses && object->moves == ENG_MOVES_ALL &&
           (!entry->self || entry->left_out == ENG_SELF_EXEMPT);
}

/* The objects of a step. */
struct sum {
    uint32_t objects; /* that move */
    uint64_t leaves;  /* of these */
    uint64_t far;     /* and of those that go far */
    bool are_bodies;  /* all of them */
    bool have_trees;  /* all objects */
};

/* Return how far poses take corners of a mesh beside its middle, at most along an
 * axis. */
static double turn_of(const struct eng_object *object)
{
    const struct eng_bounds *bounds = &object->mesh->bounds;
    const double(*m)[12] = (const double(*)[12])object->poses->last;
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double way = 0;
        for (int k = 0; k < 3; k++) {
            way += fabs(m[1][4 * i + k] - m[0][4 * i + k]) *
                   (0.5 * bounds->high[k] - 0.5 * bounds->low[k]);
        }
        most = fmax(most, way);
    }
    return most;
}

/* Return whether an object, or a corner of it, goes farther than half of its size,
 * about. */
static bool goes_far(const struct eng_object *object)
{
    const struct eng_bounds *bounds = object->bounds;
    double way = object->has_poses ? turn_of(object) : 0;
    for (int k = 0; k < 3; k++) {
        way = fmax(way, fmin(fabs(bounds[1].low[k] - bounds[0].low[k]),
                             fabs(bounds[1].high[k] - bounds[0].high[k])));
    }
    return 2 * way > eng_bounds_size(&bounds[0]);
}

static struct sum sum_of(const struct eng_scene *scene)
{
    struct sum sum = {.are_bodies = true, .have_trees = true};
    for (uint32_t i = 0; i < scene->object_capacity && sum.are_bodies; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (!object->mesh) {
            continue;
        }
        bool turns = object->joint != PCCD_NO_JOINT; /* others see to it */
        bool moves = object->moves != ENG_STANDS && !turns;
        sum.objects += moves;
        sum.leaves += moves ? object->mesh->leaf_count : 0;
        sum.far += moves && goes_far(object) ? object->mesh->leaf_count : 0;
        sum.are_bodies = object->mesh->leaf_count > 0 &&
                         !eng_mesh_has_foreign(object->mesh) &&
                         (!moves || is_body(scene, i));
        sum.have_trees &= eng_body_tree_of(object->mesh) != NULL;
    }
    return sum;
}

static bool pays(const struct eng_scene *scene, const struct sum *sum)
{
    return scene->object_count <= OBJECTS_MOST && sum->leaves >= LEAVES_LEAST &&
           sum->leaves >= (uint64_t)LEAVES_EACH * sum->objects &&
           sum->leaves >= scene->leaf_count / STANDING_PARTS &&
           sum->leaves >= FAR_PARTS * sum->far;
}

/* Have a tree for each mesh, if those that have none are of so many leaves at most.
 * False: they are of more, or there is no memory. */
static bool make_trees(const struct eng_scene *scene, uint64_t most)
{
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        struct eng_mesh *mesh = scene->objects[i].mesh;
        if (!mesh || eng_body_tree_of(mesh)) {
            continue;
        }
        if (mesh->leaf_count > most ||
            eng_body_tree_prepare(mesh, NULL, NULL) != PCCD_OK) {
            return false;
        }
        most -= mesh->leaf_count;
    }
    return true;
}

bool eng_bodies_choose(struct eng_scene *scene, const struct eng_question *question)
{
    struct eng_bodies *bodies = &eng_step_memory_of(scene)->bodies;
    if (scene->rigid.wanted != ENG_NO_OBJECT ||
        (question->brief && scene->moving.objects > 0)) {
        return false;
    }
    if (scene->moving.objects == 0) {
        return bodies->is_last; /* and its boxes are older: there is nothing to do */
    }
    struct sum sum = sum_of(scene);
    if (!sum.are_bodies || sum.objects == 0) {
        return false;
    }
    bodies->leaves = sum.leaves;
    if (question->team_always) { /* for tests, which want it wherever it can be */
        return make_trees(scene, UINT64_MAX);
    }
    if (!pays(scene, &sum)) {
        return false;
    }
    sum.have_trees = sum.have_trees || make_trees(scene, sum.leaves / SHARED_PART);
    bodies->wants_trees = !sum.have_trees;
    bool waits = bodies->steps_until > 0;
    bodies->steps_until -= waits;
    return sum.have_trees && !waits;
}

bool eng_bodies_are_all(const struct eng_scene *scene)
{
    return scene->moving.objects == scene->object_count;
}

void eng_bodies_end(struct eng_scene *scene, const struct eng_question *question,
                    const struct eng_step_result *result)
{
    struct eng_bodies *bodies = &eng_step_memory_of(scene)->bodies;
    bodies->is_last = true;
    if (result->mode == PCCD_MODE_ALL && !question->team_always &&
        PAIRS_PART * result->counters.leaf_pairs > bodies->leaves) {
        eng_bodies_leave(scene, question);
    }
}

void eng_bodies_leave(struct eng_scene *scene, const struct eng_question *question)
{
    struct eng_bodies *bodies = &eng_step_memory_of(scene)->bodies;
    if (bodies->is_last) {
        bodies->is_last = false;
        bodies->wait = bodies->wait == 0          ? WAIT_FIRST
                       : bodies->wait < WAIT_MOST ? 2 * bodies->wait
                                                  : WAIT_MOST;
        bodies->steps_until = bodies->wait;
    }
    if (has_to_end_soon(question)) {
        bodies->steps_until = WAIT_MOST;
    }
}

static bool has_looked(void *owner)
{
    uint32_t *left = owner;
    return --*left == 0;
}

void eng_bodies_share(const struct eng_scene *scene)
{
    uint32_t looks = LOOKS;
    uint32_t left = eng_step_memory_of(scene)->bodies.wants_trees ? LEAVES_SHARE : 0;
    for (uint32_t i = 0; i < scene->object_capacity && left > 0; i++) {
        struct eng_mesh *mesh = scene->objects[i].mesh;
        if (mesh && !eng_body_tree_of(mesh)) {
            int status = eng_body_tree_prepare(mesh, has_looked, &looks);
            bool is_last = status != PCCD_OK || mesh->leaf_count >= left;
            left = is_last ? 0 : left - mesh->leaf_count;
        }
    }
}
