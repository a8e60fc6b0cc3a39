/* neighbours.c - leaves that few edges join to a rank's own. */
#include "ghosts.h"

#include <stdlib.h>
#include <string.h>

#include "parts.h"
#include "rank_sort.h"

/* Somebody asks for what is at a vertex; or has something there. */
struct at {
    uint32_t vertex;
    int32_t rank;
};

/* What one object needs for its time. */
struct walk {
    struct pccd_mpi *world;
    struct ranks_object *object;
    uint64_t *first, *first_in; /* [size + 1] each */
    /* The directory: who has leaves at its vertices, sorted by vertex. */
    struct at *holders;
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
    free(walk->first);
    free(walk->holders);
    free(walk->at_memory);
    free(walk->seen);
    free(walk->edge);
    free(walk->found);
}

static int agree(const struct walk *walk, bool has_memory)
{
    return ranks_agree_on(&walk->world->link,
                          has_memory ? PCCD_OK : ranks_no_memory(walk->world));
}

static void begins_of(uint64_t *first, int size)
{
    for (int r = 0; r < size; r++) {
        first[r + 1] += first[r];
    }
}

/* Vertices of this rank, ascending, to the directory. */
static int tell_directory(struct walk *walk, const uint32_t *vertices, uint32_t count,
                          uint32_t **in)
{
    int size = walk->world->link.size;
    memset(walk->first, 0, ((size_t)size + 1) * sizeof *walk->first);
    for (uint32_t i = 0; i < count; i++) {
        walk->first[ranks_directory(walk->object->mesh, vertices[i]) + 1]++;
    }
    begins_of(walk->first, size);
    return ranks_deal(&walk->world->link, sizeof *vertices, vertices, walk->first,
                      (void **)in, walk->first_in);
}

static int compare_at(const void *a, const void *b)
{
    const struct at *one = a, *other = b;
    return one->vertex != other->vertex
               ? (one->vertex < other->vertex ? -1 : 1)
               : (one->rank > other->rank) - (one->rank < other->rank);
}

/* Begin with the vertices of the own leaves. */
static int begin(struct walk *walk)
{
    const struct ranks_object *object = walk->object;
    int size = walk->world->link.size;
    uint64_t corners = 3 * (uint64_t)object->own_count;
    walk->first = ranks_array(2 * ((uint64_t)size + 1), sizeof *walk->first);
    walk->at_memory = ranks_array(2 * corners, sizeof *walk->at_memory);
    walk->seen = ranks_array(corners, sizeof *walk->seen);
    walk->edge = ranks_array(corners, sizeof *walk->edge);
    int status = agree(walk, walk->first != NULL && walk->at_memory != NULL &&
                                 walk->seen != NULL && walk->edge != NULL);
    if (status != PCCD_OK) {
        return status;
    }
    walk->first_in = walk->first + size + 1;
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
    uint32_t *in = NULL;
    status = tell_directory(walk, walk->edge, walk->edge_count, &in);
    if (status == PCCD_OK) {
        walk->holder_count = walk->first_in[size];
        walk->holders = ranks_array(walk->holder_count, sizeof *walk->holders);
        status = agree(walk, walk->holders != NULL);
    }
    for (int r = 0; r < size && status == PCCD_OK; r++) {
        for (uint64_t i = walk->first_in[r]; i < walk->first_in[r + 1]; i++) {
            walk->holders[i] = (struct at){in[i], r};
        }
    }
    if (status == PCCD_OK) {
        qsort(walk->holders, walk->holder_count, sizeof *walk->holders, compare_at);
    }
    free(in);
    return status;
}

/* The first holder of a vertex, or where it would be. */
static uint64_t find_holder(const struct walk *walk, uint32_t vertex)
{
    uint64_t from = 0, end = walk->holder_count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        if (walk->holders[middle].vertex < vertex) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from;
}

/* Who asked in[] of this directory, to the others who have leaves there: out == NULL:
 * count them to first[r + 1]; else write them, from first[r] on. */
static void pass_on(const struct walk *walk, const uint32_t *in, uint64_t *first,
                    struct at *out)
{
    for (int r = 0; r < walk->world->link.size; r++) {
        for (uint64_t i = walk->first_in[r]; i < walk->first_in[r + 1]; i++) {
            for (uint64_t h = find_holder(walk, in[i]);
                 h < walk->holder_count && walk->holders[h].vertex == in[i]; h++) {
                int holder = walk->holders[h].rank;
                if (holder != r && out == NULL) {
                    first[holder + 1]++;
                } else if (holder != r) {
                    out[first[holder]++] = (struct at){in[i], r};
                }
            }
        }
    }
}

/* Ask the directory for the newest vertices; whoever has leaves there hears who asks. */
static int ask(struct walk *walk, struct at **asked, uint64_t *asked_count)
{
    int size = walk->world->link.size;
    uint32_t *in = NULL;
    struct at *out = NULL;
    uint64_t *first = calloc((size_t)size + 2, sizeof *first);
    int status = agree(walk, first != NULL);
    if (status == PCCD_OK) {
        status = tell_directory(walk, walk->edge, walk->edge_count, &in);
    }
    if (status == PCCD_OK) {
        pass_on(walk, in, first, NULL);
        begins_of(first, size);
        out = ranks_array(first[size], sizeof *out);
        status = agree(walk, out != NULL);
    }
    if (status == PCCD_OK) {
        pass_on(walk, in, first, out);
        memmove(first + 1, first, (size_t)size * sizeof *first); /* ends to begins */
        first[0] = 0;
        status = ranks_deal(&walk->world->link, sizeof *out, out, first, (void **)asked,
                            walk->first_in);
        *asked_count = status == PCCD_OK ? walk->first_in[size] : 0;
    }
    free(in);
    free(out);
    free(first);
    return status;
}

/* Own leaves at a vertex begin here. */
static uint64_t find_at(const struct walk *walk, uint32_t vertex)
{
    uint64_t from = 0, end = walk->at_count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        if (walk->at[middle].key < vertex) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from;
}

/* The leaves that are asked for: out == NULL: count. */
static void answer(const struct walk *walk, const struct at *asked, uint64_t asked_count,
                   uint64_t *first, struct ranks_leaf *out)
{
    for (uint64_t i = 0; i < asked_count; i++) {
        for (uint64_t a = find_at(walk, asked[i].vertex);
             a < walk->at_count && walk->at[a].key == asked[i].vertex; a++) {
            if (out == NULL) {
                first[asked[i].rank + 1]++;
            } else {
                out[first[asked[i].rank]++] = walk->object->own[walk->at[a].value];
            }
        }
    }
}

static int hand_over(struct walk *walk, const struct at *asked, uint64_t asked_count,
                     struct ranks_leaf **came, uint64_t *came_count)
{
    int size = walk->world->link.size;
    uint64_t *first = calloc((size_t)size + 2, sizeof *first);
    struct ranks_leaf *out = NULL;
    if (first != NULL) {
        answer(walk, asked, asked_count, first, NULL);
        begins_of(first, size);
        out = ranks_array(first[size], sizeof *out);
    }
    int status = agree(walk, first != NULL && out != NULL);
    if (status == PCCD_OK) {
        answer(walk, asked, asked_count, first, out);
        memmove(first + 1, first, (size_t)size * sizeof *first);
        first[0] = 0;
        status = ranks_deal(&walk->world->link, sizeof *out, out, first, (void **)came,
                            walk->first_in);
        *came_count = status == PCCD_OK ? walk->first_in[size] : 0;
    }
    free(first);
    free(out);
    return status;
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
