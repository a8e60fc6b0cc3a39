/* ghosts.c - leaves that ranks have to know of each other. */
#include "ghosts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "parts.h"
#include "rank_sort.h"
#include "rounding.h"
#include "team.h"

/* A ghost under way. */
struct visitor {
    uint32_t object;
    struct ranks_leaf leaf;
};

/* Blocks of a rank that follow each other, and so are near each other as a rule: with one
 * box, so that not each block is compared with each one. */
#define BAND_BLOCKS 32u

struct band {
    struct ranks_moving_box box;
    uint64_t begin, end; /* of its blocks */
};

/* What choosing ghosts needs for its time. */
struct choice {
    double separation;
    bool is_still;               /* all stands where the last step ended */
    double (**x0)[3], (**x1)[3]; /* [object] of local vertices */
    double steps;                /* for which boxes go on */
    struct ranks_boxes mine;     /* of own leaves, and their blocks */
    struct ranks_block *all;     /* blocks of all ranks */
    uint64_t *first;             /* [size + 1] of these */
    struct band *bands;          /* of these, rank by rank */
    uint64_t *band_first;        /* [size + 1] */
    struct band *own_bands;      /* of mine.blocks */
    uint64_t own_band_count;
    struct visitor *out;
    uint64_t out_count, out_capacity;
    uint64_t *out_first;
    struct visitor *in;
    uint64_t *in_first;
};

static void forget_positions(const struct pccd_mpi *world, struct choice *choice)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        if (choice->x0 != NULL) {
            free(choice->x0[o]);
        }
        if (choice->x1 != NULL) {
            free(choice->x1[o]);
        }
    }
    free((void *)choice->x0);
    free((void *)choice->x1);
    choice->x0 = choice->x1 = NULL;
}

static void choice_deinit(const struct pccd_mpi *world, struct choice *choice)
{
    forget_positions(world, choice);
    ranks_boxes_deinit(&choice->mine);
    free(choice->all);
    free(choice->first);
    free(choice->bands);
    free(choice->band_first);
    free(choice->own_bands);
    free(choice->out);
    free(choice->out_first);
    free(choice->in);
    free(choice->in_first);
}

/* ---- what ghosts are chosen by ----------------------------------------------------- */

/* Of each given vertex of the object: where it may be. */
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
        ranks_cover(object->from[i], object->to[i], &object->room, object->cover[i]);
    }
    return PCCD_OK;
}

static bool follows(const struct ranks_object *object)
{
    return object->room.follows[0] || object->room.follows[1] || object->room.follows[2];
}

/* A look at vertices: which steps have been made where they begin and end. */
struct look {
    double from, to;
    bool is_anew; /* it may not have been so where the last step ended */
    uint8_t *misses;
};

/* Does any of the vertices `begin` to `end` - 1 leave its box? Where the last step ended
 * all were in theirs, unless look->is_anew. [team] */
static bool has_left(const struct ranks_object *object, const struct look *look,
                     uint64_t begin, uint64_t end)
{
    const struct ranks_room room = object->room;
    const bool starts = look->is_anew || object->from != (const double(*)[3])object->x;
    for (uint64_t i = begin; i < end; i++) {
        const float *cover = object->cover[i];
        if (!ranks_is_covered(object->to[i], look->to, &room, cover) ||
            (starts && !ranks_is_covered(object->from[i], look->from, &room, cover))) {
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

/* Of the vertices begin .. end - 1 of all objects that do not rest. [team] */
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

/* Positions of all local vertices at both ends. */
static int fetch(struct pccd_mpi *world, struct choice *choice)
{
    uint32_t objects = world->object_count;
    const double(**given)[3] = calloc((size_t)objects + 1, sizeof *given);
    choice->x0 = calloc((size_t)objects + 1, sizeof *choice->x0);
    choice->x1 = calloc((size_t)objects + 1, sizeof *choice->x1);
    int status = given == NULL || choice->x0 == NULL || choice->x1 == NULL
                     ? ranks_no_memory(world)
                     : PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        uint32_t count = world->objects[o]->local.vertex_count;
        choice->x0[o] = ranks_array(count, sizeof **choice->x0);
        choice->x1[o] = ranks_array(count, sizeof **choice->x1);
        status = choice->x0[o] == NULL || choice->x1[o] == NULL ? ranks_no_memory(world)
                                                                : PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    for (int end = 0; end < 2 && status == PCCD_OK; end++) {
        for (uint32_t o = 0; o < objects; o++) {
            given[o] = end == 0 ? world->objects[o]->from : world->objects[o]->to;
        }
        status = ranks_plan_send(world, given, end == 0 ? choice->x0 : choice->x1);
    }
    free((void *)given);
    return status == PCCD_OK ? ranks_rooms_find(world, choice->is_still, choice->x0)
                             : status;
}

/* ---- who needs what --------------------------------------------------------------- */

/* The blocks of a band that this one meets: to near[]. */
static uint32_t find_near(const struct pccd_mpi *world, const struct choice *choice,
                          const struct ranks_block *block, const struct band *band,
                          const struct ranks_block **near)
{
    uint32_t count = 0;
    if (!ranks_moving_boxes_meet(&block->box, &band->box, choice->steps)) {
        return 0;
    }
    for (uint64_t i = band->begin; i < band->end; i++) {
        const struct ranks_block *theirs = &choice->all[i];
        if (ranks_moving_boxes_meet(&block->box, &theirs->box, choice->steps) &&
            ranks_may_meet(world, block->object, theirs->object)) {
            near[count++] = theirs;
        }
    }
    return count;
}

/* A place for one more that goes out; false: no memory. */
static bool has_place(struct choice *choice)
{
    if (choice->out_count < choice->out_capacity) {
        return true;
    }
    uint64_t capacity = choice->out_capacity + choice->out_capacity / 2 + 1024;
    struct visitor *out = realloc(choice->out, capacity * sizeof *out);
    if (out != NULL) {
        choice->out = out;
        choice->out_capacity = capacity;
    }
    return out != NULL;
}

/* The leaves of an own block that meet any of those near: out they go. */
static bool choose_of(const struct pccd_mpi *world, struct choice *choice,
                      const struct ranks_block *block,
                      const struct ranks_block *const *near, uint32_t near_count)
{
    const struct ranks_object *object = world->objects[block->object];
    for (uint32_t i = 0; i < block->count && near_count > 0; i++) {
        const uint32_t leaf = block->begin + i;
        struct ranks_moving_box box;
        uint32_t n = 0;
        ranks_leaf_box(&choice->mine, block->object, leaf, &box);
        while (n < near_count &&
               !ranks_moving_boxes_meet(&box, &near[n]->box, choice->steps)) {
            n++;
        }
        if (n == near_count) {
            continue;
        }
        if (!has_place(choice)) {
            return false;
        }
        choice->out[choice->out_count++] =
            (struct visitor){block->object, object->own[leaf]};
    }
    return true;
}

/* What is near an own band, or a block of it. */
struct near {
    const struct band **bands;
    const struct ranks_block **blocks;
};

/* Which of the own leaves go to rank r; false: no memory. */
static bool choose_for(const struct pccd_mpi *world, struct choice *choice,
                       const struct near *near, int r)
{
    bool has_memory = true;
    for (uint64_t m = 0; m < choice->own_band_count && has_memory; m++) {
        const struct band *own = &choice->own_bands[m];
        uint64_t bands = 0;
        for (uint64_t i = choice->band_first[r]; i < choice->band_first[r + 1]; i++) {
            near->bands[bands] = &choice->bands[i];
            bands +=
                ranks_moving_boxes_meet(&own->box, &choice->bands[i].box, choice->steps);
        }
        for (uint64_t b = own->begin; b < own->end && bands > 0 && has_memory; b++) {
            const struct ranks_block *block = &choice->mine.blocks[b];
            uint32_t count = 0;
            for (uint64_t i = 0; i < bands; i++) {
                count +=
                    find_near(world, choice, block, near->bands[i], near->blocks + count);
            }
            has_memory = choose_of(world, choice, block, near->blocks, count);
        }
    }
    return has_memory;
}

/* Of the blocks of each rank those that meet none of this rank's stay out. */
static int choose(struct pccd_mpi *world, struct choice *choice)
{
    struct ranks_link *link = &world->link;
    uint64_t cells = (uint64_t)link->size + 1;
    const struct near near = {
        .bands = ranks_array(choice->band_first[link->size] + 1, sizeof *near.bands),
        .blocks = ranks_array(choice->first[link->size], sizeof *near.blocks)};
    choice->out_first = ranks_array(cells, sizeof(uint64_t));
    choice->in_first = ranks_array(cells, sizeof(uint64_t));
    bool has_memory = near.bands != NULL && near.blocks != NULL &&
                      choice->out_first != NULL && choice->in_first != NULL;
    for (int r = 0; r < link->size && has_memory; r++) {
        choice->out_first[r] = choice->out_count;
        has_memory = r == link->rank || choose_for(world, choice, &near, r);
        choice->out_first[r + 1] = choice->out_count;
    }
    free((void *)near.bands);
    free((void *)near.blocks);
    return has_memory ? PCCD_OK : ranks_no_memory(world);
}

/* Blocks far from all of this rank need not be looked at again and again. */
static void forget_far(const struct pccd_mpi *world, struct choice *choice)
{
    struct ranks_moving_box whole;
    ranks_moving_box_begin(&whole);
    for (uint32_t b = 0; b < choice->mine.block_count; b++) {
        ranks_moving_box_add(&whole, &choice->mine.blocks[b].box);
    }
    uint64_t kept = 0;
    for (int r = 0; r < world->link.size; r++) {
        uint64_t begin = choice->first[r];
        choice->first[r] = kept;
        for (uint64_t i = begin; i < choice->first[r + 1]; i++) {
            if (ranks_moving_boxes_meet(&whole, &choice->all[i].box, choice->steps)) {
                choice->all[kept++] = choice->all[i];
            }
        }
    }
    choice->first[world->link.size] = kept;
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

static int make_bands(struct pccd_mpi *world, struct choice *choice)
{
    const uint32_t size = (uint32_t)world->link.size, own = choice->mine.block_count;
    uint64_t count = 0;
    choice->bands =
        ranks_array(choice->first[size] / BAND_BLOCKS + size, sizeof *choice->bands);
    choice->band_first = ranks_array((uint64_t)size + 1, sizeof *choice->band_first);
    choice->own_bands = ranks_array(own / BAND_BLOCKS + 1, sizeof *choice->own_bands);
    if (choice->bands == NULL || choice->band_first == NULL ||
        choice->own_bands == NULL) {
        return ranks_no_memory(world);
    }
    for (uint32_t r = 0; r < size; r++) {
        choice->band_first[r] = count;
        count += band_up(choice->all, choice->first[r], choice->first[r + 1],
                         choice->bands + count);
    }
    choice->band_first[size] = count;
    choice->own_band_count = band_up(choice->mine.blocks, 0, own, choice->own_bands);
    return PCCD_OK;
}

/* ---- those that came -------------------------------------------------------------- */

/* Are these the ghosts that the object has? The same leaf has the same number. */
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
                         const struct visitor *in, const struct ranks_key *came,
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
static int settle(struct pccd_mpi *world, const struct choice *choice)
{
    uint64_t count = choice->in_first[world->link.size];
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] = (struct ranks_key){choice->in[i].object, i};
    }
    const struct ranks_key *sorted = ranks_sort(keys, keys + count, count);
    uint64_t at = 0;
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        uint64_t begin = at;
        while (at < count && sorted[at].key == o) {
            at++;
        }
        status = settle_object(world, world->objects[o], choice->in, sorted + begin,
                               at - begin);
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

static int choose_all(struct pccd_mpi *world, struct choice *choice)
{
    struct ranks_link *link = &world->link;
    int status = fetch(world, choice);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        choice->steps = ranks_room_time(&world->objects[o]->room);
        status = cover(world, world->objects[o]);
    }
    if (status == PCCD_OK) {
        status = ranks_boxes_make(world, choice->separation,
                                  (const double(*const *)[3])choice->x0,
                                  (const double(*const *)[3])choice->x1, &choice->mine);
    }
    forget_positions(world, choice);
    choice->first = ranks_array((uint64_t)link->size + 1, sizeof(uint64_t));
    if (status == PCCD_OK && choice->first == NULL) {
        status = ranks_no_memory(world);
    }
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status =
            ranks_spread(link, sizeof(struct ranks_block), choice->mine.blocks,
                         choice->mine.block_count, (void **)&choice->all, choice->first);
    }
    if (status != PCCD_OK) {
        return status;
    }
    forget_far(world, choice);
    status = make_bands(world, choice);
    status = status == PCCD_OK ? choose(world, choice) : status;
    status = ranks_agree_on(link, status);
    if (status == PCCD_OK) {
        status = ranks_deal(link, sizeof *choice->out, choice->out, choice->out_first,
                            (void **)&choice->in, choice->in_first);
    }
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        status = ranks_neighbours_find(world, world->objects[o]);
    }
    return status == PCCD_OK ? ranks_agree_on(link, settle(world, choice)) : status;
}

int ranks_ghosts_choose(struct pccd_mpi *world, double separation, bool is_still,
                        bool has_missed)
{
    struct choice choice = {.separation = separation, .is_still = is_still};
    world->is_covered = false;
    ranks_rooms_choose(world, has_missed);
    int status = choose_all(world, &choice);
    choice_deinit(world, &choice);
    if (status == PCCD_OK) {
        status = name_local(world);
    }
    if (status == PCCD_OK) {
        status = ranks_rooms_learn(world);
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
