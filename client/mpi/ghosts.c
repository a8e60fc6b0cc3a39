/* ghosts.c - leaves that ranks have to know of each other. */
#include "ghosts.h"

#include <stdlib.h>

#include "boxes.h"
#include "parts.h"
#include "rank_sort.h"
#include "rounding.h"
#include "team.h"

/* A ghost under way. */
struct remote_leaf {
    uint32_t object;
    struct ranks_leaf leaf;
};

/* ---- what ghosts are chosen by ----------------------------------------------------- */

/* Set where each given vertex of the object may be. */
static int cover(struct pccd_mpi *world, struct ranks_object *object)
{
    uint32_t count = object->mesh->vertex_count;
    if (object->cover == NULL) {
        object->cover = ranks_array(count, sizeof *object->cover);
    }
    if (object->cover == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t i = 0; i < count; i++) {
        ranks_cover(object->from[i], object->to[i], &object->margin, object->cover[i]);
    }
    return PCCD_OK;
}

static bool follows(const struct ranks_object *object)
{
    return object->margin.follows[0] || object->margin.follows[1] ||
           object->margin.follows[2];
}

/* A look at vertices: which steps have been made where they begin and end. */
struct look {
    double from, to;
    bool is_anew; /* it may not have been so where the last step ended */
    uint8_t *misses;
};

/* Return whether any of the vertices `begin` to `end` - 1 leaves its box. Where the last
 * step ended all were in theirs, unless look->is_anew. [team] */
static bool has_left(const struct ranks_object *object, const struct look *look,
                     uint64_t begin, uint64_t end)
{
    const struct ranks_margin margin = object->margin;
    const bool starts = look->is_anew || object->from != (const double(*)[3])object->x;
    for (uint64_t i = begin; i < end; i++) {
        const float *cover = object->cover[i];
        if (!ranks_is_covered(object->to[i], look->to, &margin, cover) ||
            (starts && !ranks_is_covered(object->from[i], look->from, &margin, cover))) {
            return true;
        }
    }
    return false;
}

/* It stays where it is, and so does its box. */
static bool rests(const struct ranks_object *object)
{
    return object->to == (const double(*)[3])object->x &&
           object->from == (const double(*)[3])object->x && !follows(object);
}

/* Look at the vertices begin .. end - 1 of all objects that do not rest. [team] */
static void look_at_part(const struct pccd_mpi *world, const struct look *look,
                         uint64_t begin, uint64_t end)
{
    uint64_t at = 0;
    for (uint32_t o = 0; o < world->object_count && at < end; o++) {
        const struct ranks_object *object = world->objects[o];
        const uint64_t count = rests(object) ? 0 : object->mesh->vertex_count;
        uint64_t first, last;
        if (ranks_part_of_run(at, count, begin, end, &first, &last) &&
            (object->cover == NULL || has_left(object, look, first, last))) {
#pragma omp atomic write
            look->misses[o] = 1;
        }
        at += count;
    }
}

void ranks_ghosts_look(const struct pccd_mpi *world, double from, double to,
                       uint8_t *misses)
{
    const struct look look = {from, to, world->is_once, misses};
    uint64_t count = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        misses[o] = from < 0;
        count += rests(world->objects[o]) ? 0 : world->objects[o]->mesh->vertex_count;
    }
    const int team = ranks_team(world, count);
#pragma omp parallel for num_threads(team) schedule(static, 1)
    for (int t = 0; t < team; t++) {
        COMMON_ROUNDING_HERE;
        look_at_part(world, &look, ranks_part(count, t, team),
                     ranks_part(count, t + 1, team));
    }
}

/* ---- those that came -------------------------------------------------------------- */

/* Return whether these are the ghosts that the object has. The same leaf has the same
 * number. */
static bool has_ghosts(const struct ranks_object *object, const struct ranks_leaf *ghosts,
                       uint32_t count)
{
    bool is_same = count == object->ghost_count;
    for (uint32_t i = 0; i < count && is_same; i++) {
        is_same = ghosts[i].number == object->ghosts[i].number;
    }
    return is_same;
}

/* Those of one object that came, and its neighbours, each once and by their numbers. */
static int settle_object(struct pccd_mpi *world, struct ranks_object *object,
                         const struct remote_leaf *in, const struct ranks_key *came,
                         uint64_t came_count)
{
    uint64_t count = came_count + object->neighbour_count;
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    struct ranks_leaf *ghosts = ranks_array(count, sizeof *ghosts);
    uint32_t each = 0;
    if (keys == NULL || ghosts == NULL) {
        free(keys);
        free(ghosts);
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] =
            (struct ranks_key){i < came_count ? in[came[i].value].leaf.number
                                              : object->neighbours[i - came_count].number,
                               i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    for (uint64_t i = 0; i < count; i++) {
        uint64_t at = sorted[i].value;
        if (i == 0 || sorted[i].key != sorted[i - 1].key) {
            ghosts[each++] = at < came_count ? in[came[at].value].leaf
                                             : object->neighbours[at - came_count];
        }
    }
    object->is_built = object->is_built && has_ghosts(object, ghosts, each);
    free(object->ghosts);
    free(keys);
    object->ghosts = ghosts;
    object->ghost_count = each;
    return PCCD_OK;
}

/* Ghosts by object. Objects that have the same as before stay as they are. */
static int settle(struct pccd_mpi *world, const struct remote_leaf *in, uint64_t count)
{
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] = (struct ranks_key){in[i].object, i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    uint64_t at = 0;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        uint64_t begin = at;
        while (at < count && sorted[at].key == o) {
            at++;
        }
        status = settle_object(world, world->objects[o], in, sorted + begin, at - begin);
    }
    free(keys);
    return status;
}

/* Number what is here of the objects that have changed in any rank. */
static int name_local(struct pccd_mpi *world)
{
    struct ranks_link *link = &world->link;
    uint32_t objects = world->object_count;
    uint8_t *changed = ranks_array(objects, 1);
    int status = changed == NULL ? ranks_no_memory(world) : PCCD_OK;
    bool any = false;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        changed[o] = !object->is_built;
        status = changed[o] ? ranks_local_make(world, object) : PCCD_OK;
    }
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = ranks_max_bytes(link, changed, (int)objects);
    }
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        any = any || changed[o];
        world->objects[o]->is_unsent |= changed[o] != 0;
    }
    if (any && status == PCCD_OK) {
        status = ranks_plan_make(world);
    }
    free(changed);
    world->is_cut = world->is_cut && status == PCCD_OK; /* else the plan is old */
    return status;
}

/* Boxes of own leaves in this step and some more, and of what is in them. */
static int make_boxes(struct pccd_mpi *world, double separation, bool is_still,
                      struct ranks_boxes *boxes)
{
    double(**x0)[3] = NULL, (**x1)[3] = NULL;
    int status = ranks_positions_fetch(world, RANKS_BEGIN, &x0);
    if (status == PCCD_OK) {
        status = ranks_positions_fetch(world, RANKS_END, &x1);
    }
    if (status == PCCD_OK) {
        status = ranks_margins_find(world, is_still, x0);
    }
    if (status == PCCD_OK) {
        for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
            status = cover(world, world->objects[o]);
        }
        if (status == PCCD_OK) {
            status = ranks_boxes_make(world, separation, ranks_block_count(world),
                                      (const double(*const *)[3])x0,
                                      (const double(*const *)[3])x1, boxes);
        }
        status = ranks_agree_on(&world->link, status);
    }
    ranks_positions_free(world, x0);
    ranks_positions_free(world, x1);
    return status;
}

static void put(const void *context, uint32_t object, uint32_t leaf, void *item)
{
    const struct pccd_mpi *world = context;
    *(struct remote_leaf *)item =
        (struct remote_leaf){object, world->objects[object]->own[leaf]};
}

static int choose(struct pccd_mpi *world, double separation, bool is_still)
{
    struct ranks_boxes boxes = {.object_count = 0};
    struct remote_leaf *in = NULL;
    uint64_t in_count = 0;
    int status = make_boxes(world, separation, is_still, &boxes);
    if (status == PCCD_OK) {
        const struct ranks_fetch fetch = {
            .leaves = &boxes,
            .boxes = boxes.blocks,
            .box_count = boxes.block_count,
            .steps = world->object_count > 0
                         ? ranks_margin_time(&world->objects[0]->margin)
                         : 0,
            .wants = ranks_may_meet,
            .put = put,
            .context = world,
            .item_bytes = sizeof *in};
        status = ranks_fetch_leaves(world, &fetch, (void **)&in, &in_count);
    }
    ranks_boxes_deinit(&boxes);
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        status = ranks_neighbours_find(world, world->objects[o]);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(&world->link, settle(world, in, in_count));
    }
    free(in);
    return status;
}

int ranks_ghosts_choose(struct pccd_mpi *world, double separation, bool is_still,
                        bool has_missed)
{
    world->is_covered = false;
    ranks_margins_choose(world, has_missed);
    int status = choose(world, separation, is_still);
    if (status == PCCD_OK) {
        status = name_local(world);
    }
    if (status == PCCD_OK) {
        status = ranks_margins_learn(world);
    }
    if (status == PCCD_OK) {
        world->is_covered = true;
        world->gone = 0;
        world->reach = separation;
        world->share.searches++;
    }
    return status;
}

int ranks_ghosts_build(struct pccd_mpi *world)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        if (object->is_unsent) {
            status = ranks_local_put(world, object);
            object->is_unsent = status != PCCD_OK;
        }
    }
    return status;
}
