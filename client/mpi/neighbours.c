/* neighbours.c - leaves that few edges join to a rank's own. */
#include "ghosts.h"

#include <stdlib.h>
#include <string.h>

#include "parts.h"
#include "rank_sort.h"

/* A rank asks for what is at a vertex; or has something there. */
struct at {
    uint32_t vertex;
    uint32_t rank;
};

/* State of a walk over the edges of one object. */
struct walk {
    struct pccd_mpi *world;
    struct ranks_object *object;
    /* The directory: the ranks with leaves at its vertices, by vertex. value: rank. */
    struct ranks_key *holders, *holder_memory;
    uint64_t holder_count;
    /* Own leaves by vertex: value: leaf. */
    struct ranks_key *at, *at_memory;
    uint64_t at_count;
    /* Vertices that were asked for already, ascending; the newest of them. */
    uint32_t *seen, *edge;
    uint32_t seen_count, edge_count;
    struct ranks_leaf *found; /* that came so far, some of them twice */
    uint64_t found_count;
};

static void walk_deinit(struct walk *walk)
{
    free(walk->holder_memory);
    free(walk->at_memory);
    free(walk->seen);
    free(walk->edge);
    free(walk->found);
}

/* The newest vertices of each rank, to their directories. */
static int tell_directory(const struct walk *walk, struct at **in, uint64_t *in_count)
{
    struct ranks_post post;
    ranks_post_begin(&post, sizeof **in, walk->edge_count);
    for (uint32_t i = 0; i < walk->edge_count; i++) {
        ranks_post_add(&post,
                       (uint32_t)ranks_directory(walk->object->mesh, walk->edge[i]),
                       &(struct at){walk->edge[i], (uint32_t)walk->world->link.rank});
    }
    return ranks_post_deal(&walk->world->link, &post, (void **)in, in_count);
}

/* Learn, in the directory, which ranks have leaves at its vertices. */
static int find_holders(struct walk *walk)
{
    struct at *in = NULL;
    uint64_t count = 0;
    int status = tell_directory(walk, &in, &count);
    if (status == PCCD_OK) {
        walk->holder_memory = ranks_array(2 * count, sizeof *walk->holder_memory);
        status = ranks_agree_memory(walk->world, walk->holder_memory != NULL);
    }
    for (uint64_t i = 0; i < count && status == PCCD_OK; i++) {
        walk->holder_memory[i] = (struct ranks_key){in[i].vertex, in[i].rank};
    }
    free(in);
    if (status == PCCD_OK) {
        walk->holders =
            ranks_sort(walk->holder_memory, walk->holder_memory + count, count);
        walk->holder_count = count;
    }
    return status;
}

/* Begin with the vertices of the own leaves. */
static int begin(struct walk *walk)
{
    const struct ranks_object *object = walk->object;
    uint64_t corners = 3 * (uint64_t)object->own_count;
    walk->at_memory = ranks_array(2 * corners, sizeof *walk->at_memory);
    walk->seen = ranks_array(corners, sizeof *walk->seen);
    walk->edge = ranks_array(corners, sizeof *walk->edge);
    int status = ranks_agree_memory(
        walk->world, walk->at_memory != NULL && walk->seen != NULL && walk->edge != NULL);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint64_t i = 0; i < corners; i++) {
        walk->at_memory[i] = (struct ranks_key){object->own[i / 3].v[i % 3], i / 3};
    }
    walk->at = ranks_sort(walk->at_memory, walk->at_memory + corners, corners);
    walk->at_count = corners;
    for (uint64_t i = 0; i < corners; i++) {
        if (i == 0 || walk->at[i].key != walk->at[i - 1].key) {
            walk->edge[walk->edge_count++] = (uint32_t)walk->at[i].key;
        }
    }
    memcpy(walk->seen, walk->edge, walk->edge_count * sizeof *walk->seen);
    walk->seen_count = walk->edge_count;
    return find_holders(walk);
}

/* Return where the first of a vertex is, or would be, among keys in order. */
static uint64_t find_first(const struct ranks_key *keys, uint64_t count, uint32_t vertex)
{
    uint64_t from = 0, end = count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        if (keys[middle].key < vertex) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from;
}

/* Ask the directory for the newest vertices; it passes on who asks to the others who have
 * leaves there. */
static int ask(const struct walk *walk, struct at **asked, uint64_t *asked_count)
{
    struct at *in = NULL;
    struct ranks_post post;
    uint64_t in_count = 0;
    int status = tell_directory(walk, &in, &in_count);
    if (status != PCCD_OK) {
        return status;
    }
    ranks_post_begin(&post, sizeof *in, 0);
    for (uint64_t i = 0; i < in_count; i++) {
        for (uint64_t h = find_first(walk->holders, walk->holder_count, in[i].vertex);
             h < walk->holder_count && walk->holders[h].key == in[i].vertex; h++) {
            if (walk->holders[h].value != in[i].rank) {
                ranks_post_add(&post, (uint32_t)walk->holders[h].value, &in[i]);
            }
        }
    }
    free(in);
    return ranks_post_deal(&walk->world->link, &post, (void **)asked, asked_count);
}

/* Send the leaves that are asked for. */
static int hand_over(const struct walk *walk, const struct at *asked,
                     uint64_t asked_count, struct ranks_leaf **came, uint64_t *came_count)
{
    struct ranks_post post;
    ranks_post_begin(&post, sizeof **came, 0);
    for (uint64_t i = 0; i < asked_count; i++) {
        for (uint64_t a = find_first(walk->at, walk->at_count, asked[i].vertex);
             a < walk->at_count && walk->at[a].key == asked[i].vertex; a++) {
            ranks_post_add(&post, asked[i].rank, &walk->object->own[walk->at[a].value]);
        }
    }
    return ranks_post_deal(&walk->world->link, &post, (void **)came, came_count);
}

/* Add leaves to those that were found; their vertices that were not seen yet are the
 * newest. */
static int take(struct walk *walk, const struct ranks_leaf *came, uint64_t count)
{
    struct ranks_leaf *found =
        realloc(walk->found, (walk->found_count + count + 1) * sizeof *found);
    uint64_t corners = 3 * count, all = corners + walk->seen_count;
    struct ranks_key *memory = ranks_array(2 * all, sizeof *memory);
    uint32_t *seen = ranks_array(all, sizeof *seen);
    uint32_t *edge = ranks_array(corners, sizeof *edge);
    walk->found = found != NULL ? found : walk->found;
    if (found == NULL || memory == NULL || seen == NULL || edge == NULL) {
        free(memory);
        free(seen);
        free(edge);
        return ranks_no_memory(walk->world);
    }
    memcpy(found + walk->found_count, came, count * sizeof *found);
    walk->found_count += count;
    for (uint64_t i = 0; i < walk->seen_count; i++) {
        memory[i] = (struct ranks_key){walk->seen[i], 0};
    }
    for (uint64_t i = 0; i < corners; i++) {
        memory[walk->seen_count + i] = (struct ranks_key){came[i / 3].v[i % 3], 1};
    }
    const struct ranks_key *keys = ranks_sort(memory, memory + all, all);
    uint32_t seen_count = 0, edge_count = 0;
    for (uint64_t i = 0; i < all; i++) {
        if (i == 0 || keys[i].key != keys[i - 1].key) {
            seen[seen_count++] = (uint32_t)keys[i].key;
            if (keys[i].value == 1) { /* what was seen before comes first */
                edge[edge_count++] = (uint32_t)keys[i].key;
            }
        }
    }
    free(memory);
    free(walk->seen);
    free(walk->edge);
    walk->seen = seen;
    walk->edge = edge;
    walk->seen_count = seen_count;
    walk->edge_count = edge_count;
    return PCCD_OK;
}

static int go_one_ring(struct walk *walk)
{
    struct at *asked = NULL;
    struct ranks_leaf *came = NULL;
    uint64_t asked_count = 0, came_count = 0;
    int status = ask(walk, &asked, &asked_count);
    if (status == PCCD_OK) {
        status = hand_over(walk, asked, asked_count, &came, &came_count);
    }
    if (status == PCCD_OK) {
        status = ranks_agree_on(&walk->world->link, take(walk, came, came_count));
    }
    free(asked);
    free(came);
    return status;
}

int ranks_neighbours_find(struct pccd_mpi *world, struct ranks_object *object)
{
    uint32_t rings = object->settings.rest_rings;
    struct walk walk = {.world = world, .object = object};
    if (rings == object->neighbour_rings) {
        return PCCD_OK;
    }
    int status = rings > 0 ? begin(&walk) : PCCD_OK;
    for (uint32_t i = 0; i < rings && status == PCCD_OK; i++) {
        status = go_one_ring(&walk);
    }
    if (status == PCCD_OK) {
        free(object->neighbours);
        object->neighbours = walk.found;
        object->neighbour_count = walk.found_count;
        object->neighbour_rings = rings;
        walk.found = NULL;
    }
    walk_deinit(&walk);
    return status;
}
