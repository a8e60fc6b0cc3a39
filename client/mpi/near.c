/* near.c - what is near in the whole scene at one moment. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "names.h"
#include "near_objects.h"
#include "rounding.h"
#include "step.h"

#define LENGTH_MAX 1e18

/* As in one process: too long is E_LIMIT, anything else that is no length E_INVAL. */
static int check_length(struct pccd_mpi *world, const char *name, double length)
{
    if (!(length >= 0) || isinf(length)) {
        return ranks_fail(&world->link, PCCD_E_INVAL, "%s is negative or not finite",
                          name);
    }
    return length <= LENGTH_MAX ? PCCD_OK
                                : ranks_fail(&world->link, PCCD_E_LIMIT,
                                             "%s is beyond %g", name, LENGTH_MAX);
}

static int check_objects(struct pccd_mpi *world, const struct pccd_near_settings *near)
{
    const uint32_t objects[2] = {near->object_a, near->object_b};
    if (common_near_is_of_objects(near->what) && objects[0] != 0 &&
        objects[0] == objects[1]) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "object_a and object_b are both %" PRIu32, objects[0]);
    }
    for (int side = 0; side < 2; side++) {
        if (objects[side] != 0 && side >= common_near_names_objects(near->what)) {
            return ranks_fail(&world->link, PCCD_E_INVAL,
                              "object_%c is %" PRIu32 ", and what = %u is asked of all",
                              "ab"[side], objects[side], (unsigned)near -> what);
        }
        if (objects[side] != 0 && ranks_find_object(world, objects[side]) == NULL) {
            return ranks_fail(&world->link, PCCD_E_HANDLE,
                              "object_%c %" PRIu32 " is not in the scene", "ab"[side],
                              objects[side]);
        }
    }
    return PCCD_OK;
}

static int check(struct pccd_mpi *world, const struct pccd_near_settings *near)
{
    bool is_nearest = near->what == PCCD_NEAR_NEAREST;
    bool is_far = is_nearest && near->distance == INFINITY;
    int status = PCCD_OK;
    if ((unsigned)near->what >= PCCD_NEAR_COUNT ||
        (unsigned)near->method >= PCCD_METHOD_COUNT) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "there is no such question or method");
    }
    if (near->joint_count > 0) {
        return ranks_fail(&world->link, PCCD_E_INVAL,
                          "joints: ranks share what goes straight alone");
    }
    if (common_near_has_distance(near->what) && !is_far) {
        status = check_length(world, "distance", near->distance);
    }
    if (status == PCCD_OK && is_nearest) {
        status = check_length(world, "gap", near->gap);
    }
    status = status == PCCD_OK ? check_objects(world, near) : status;
    return status == PCCD_OK && common_near_is_of_objects(near->what)
               ? ranks_check_triangles(world, near)
               : status;
}

static uint64_t hash_of(const struct pccd_near_settings *near)
{
    uint64_t hash = ranks_hash(2, &near->what, sizeof near->what);
    hash = ranks_hash(hash, &near->distance, sizeof near->distance);
    hash = ranks_hash(hash, &near->gap, sizeof near->gap);
    hash = ranks_hash(hash, &near->at_begin, sizeof near->at_begin);
    hash = ranks_hash(hash, &near->object_a, sizeof near->object_a);
    hash = ranks_hash(hash, &near->object_b, sizeof near->object_b);
    hash = ranks_hash(hash, &near->threads, sizeof near->threads);
    hash = ranks_hash(hash, &near->deadline_ns, sizeof near->deadline_ns);
    hash = ranks_hash(hash, &near->tells_crossings, sizeof near->tells_crossings);
    hash = ranks_hash(hash, &near->method, sizeof near->method);
    return ranks_hash(hash, near->tuning, strnlen(near->tuning, sizeof near->tuning));
}

int pccd_mpi_near(struct pccd_mpi *world, const struct pccd_motion *motions,
                  uint32_t motion_count, const struct pccd_near_settings *settings,
                  struct pccd_answer *answer)
{
    COMMON_ROUNDING_HERE;
    struct pccd_near_settings near = PCCD_NEAR_SETTINGS_INIT;
    struct ranks_moment moment = {
        .motions = motions, .motion_count = motion_count, .near = &near};
    if (world == NULL) {
        return PCCD_E_INVAL;
    }
    if (settings != NULL) {
        size_t bytes = settings->struct_bytes;
        memcpy(&near, settings, bytes == 0 || bytes > sizeof near ? sizeof near : bytes);
    }
    near.struct_bytes = sizeof near;
    int status = check(world, &near);
    uint64_t hash = hash_of(&near);
    near.threads = near.threads > 0 ? near.threads : world->threads;
    if (common_near_has_all_pairs(near.what)) { /* so far ghosts reach */
        moment.settings.separation = near.distance;
    }
    return ranks_moment_make(world, RANKS_NEAR, hash, status, &moment, answer);
}
