/* sides.c - edges of a mesh in parts, and what belongs to which leaf.
 *
 * Send what leaves say of their sides and corners to the rank whose directory has the
 * higher vertex; number the edges there as one process does, by (higher, lower) vertex;
 * send the numbers back, and the lowest leaf of each.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "parts.h"
#include "rank_sort.h"

/* What is said of a side or a vertex, and what comes back. */
struct said {
    uint32_t high, low; /* of a vertex both are it */
    uint32_t leaf;      /* the lowest here */
};
struct heard {
    uint32_t number; /* of the edge */
    uint32_t leaf;   /* the lowest of all */
};

/* Something that each leaf has some of: what it says at place k, if anything. */
typedef bool (*say_fn)(const struct ranks_leaf *leaf, uint32_t k, struct said *said);

static bool say_side(const struct ranks_leaf *leaf, uint32_t k, struct said *said)
{
    uint32_t a = leaf->v[k], b = leaf->v[(k + 1) % 3];
    *said = (struct said){a > b ? a : b, a > b ? b : a, leaf->number};
    return a != b;
}

static bool say_corner(const struct ranks_leaf *leaf, uint32_t k, struct said *said)
{
    *said = (struct said){leaf->v[k], leaf->v[k], leaf->number};
    return true;
}

/* All that the leaves say, sorted by (high, low); value: leaf * 4 + k. Two arrays of
 * count keys are in *memory. */
static struct ranks_key *gather(const struct ranks_leaf *leaves, uint32_t leaf_count,
                                say_fn say, struct ranks_key *memory, uint64_t *count)
{
    struct said said;
    *count = 0;
    for (uint32_t i = 0; i < leaf_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            if (say(&leaves[i], k, &said)) {
                memory[(*count)++] = (struct ranks_key){
                    (uint64_t)said.high << 32 | said.low, (uint64_t)i * 4 + k};
            }
        }
    }
    return ranks_sort(memory, memory + *count, *count);
}

/* In the directory: number what the ranks said, and tell the lowest leaf of each. Returns
 * how many there are, or UINT64_MAX: no memory. */
static uint64_t number_all(const struct said *in, uint64_t count, struct heard *heard)
{
    struct ranks_key *memory = ranks_array(2 * count, sizeof *memory);
    uint64_t each = 0;
    if (memory == NULL) {
        return UINT64_MAX;
    }
    for (uint64_t i = 0; i < count; i++) {
        memory[i] = (struct ranks_key){(uint64_t)in[i].high << 32 | in[i].low, i};
    }
    struct ranks_key *keys = ranks_sort(memory, memory + count, count);
    for (uint64_t i = 0, end; i < count; i = end) {
        uint32_t lowest = RANKS_NONE;
        for (end = i; end < count && keys[end].key == keys[i].key; end++) {
            uint32_t leaf = in[keys[end].value].leaf;
            lowest = leaf < lowest ? leaf : lowest;
        }
        for (uint64_t j = i; j < end; j++) {
            heard[keys[j].value] = (struct heard){(uint32_t)each, lowest};
        }
        each++;
    }
    free(memory);
    return each;
}

/* Members that a question about one kind of thing needs. */
struct question {
    struct ranks_key *memory, *keys; /* what the leaves say here */
    uint64_t count;                  /* of these */
    struct said *said;
    struct heard *answers;
    uint64_t *first; /* [size + 1] of what is said to each rank */
    uint64_t total;  /* different ones, on all ranks */
    struct pccd_mpi *world;
};

static void question_deinit(struct question *question)
{
    free(question->memory);
    free(question->said);
    free(question->answers);
    free(question->first);
}

/* Write each once, with the lowest leaf, to question->said, and where those of each
 * directory begin, to first[size + 1]. Return how many there are. */
static uint64_t say_each(const struct ranks_mesh *mesh, int size,
                         const struct ranks_leaf *leaves, struct question *question)
{
    const struct ranks_key *keys = question->keys;
    struct said *said = question->said;
    uint64_t *first = question->first, each = 0;
    memset(first, 0, ((size_t)size + 1) * sizeof *first);
    for (uint64_t i = 0; i < question->count; i++) {
        uint32_t number = leaves[keys[i].value / 4].number;
        if (i > 0 && keys[i].key == keys[i - 1].key) {
            said[each - 1].leaf =
                number < said[each - 1].leaf ? number : said[each - 1].leaf;
            continue;
        }
        uint32_t high = (uint32_t)(keys[i].key >> 32);
        said[each++] = (struct said){high, (uint32_t)keys[i].key, number};
        first[ranks_directory(mesh, high) + 1]++;
    }
    for (int r = 0; r < size; r++) {
        first[r + 1] += first[r];
    }
    return each;
}

/* Number what came to this directory; edges are numbered on behind those of the
 * directories before. */
static int answer(void *context, const void *items, uint64_t count, void *answers)
{
    struct question *question = context;
    struct pccd_mpi *world = question->world;
    struct ranks_link *link = &world->link;
    struct heard *heard = answers;
    uint64_t each = number_all(items, count, heard);
    uint64_t *counts = ranks_array((uint64_t)link->size, sizeof *counts);
    int status = ranks_agree_memory(world, counts != NULL && each != UINT64_MAX);
    if (status == PCCD_OK) {
        status = ranks_tell_all(link, each, counts);
    }
    uint64_t before = 0;
    for (int r = 0; status == PCCD_OK && r < link->size; r++) {
        before += r < link->rank ? counts[r] : 0;
        question->total += counts[r];
    }
    if (status == PCCD_OK && question->total > INT32_MAX) {
        status = ranks_fail(link, PCCD_E_LIMIT, "a mesh has at most %d edges", INT32_MAX);
    }
    for (uint64_t i = 0; status == PCCD_OK && i < count; i++) {
        heard[i].number += (uint32_t)before;
    }
    free(counts);
    return status;
}

static int ask(struct pccd_mpi *world, const struct ranks_mesh *mesh,
               const struct ranks_leaf *leaves, uint32_t leaf_count, say_fn say,
               struct question *question)
{
    const struct ranks_question asked = {sizeof(struct said), sizeof(struct heard),
                                         answer, question};
    uint64_t most = 3 * (uint64_t)leaf_count;
    question->world = world;
    question->memory = ranks_array(2 * most, sizeof *question->memory);
    question->first = ranks_array((uint64_t)world->link.size + 1, sizeof(uint64_t));
    question->said = ranks_array(most, sizeof *question->said);
    bool has_memory =
        question->memory != NULL && question->first != NULL && question->said != NULL;
    if (has_memory) {
        question->keys =
            gather(leaves, leaf_count, say, question->memory, &question->count);
        uint64_t each = say_each(mesh, world->link.size, leaves, question);
        question->answers = ranks_array(each, sizeof *question->answers);
    }
    int status = ranks_agree_memory(world, has_memory && question->answers != NULL);
    return status == PCCD_OK ? ranks_ask(&world->link, &asked, question->said,
                                         question->first, question->answers)
                             : status;
}

/* The answer to each thing that the leaves said, to what they said it of. */
static void take_sides(struct ranks_leaf *leaves, const struct question *question)
{
    uint64_t each = 0;
    for (uint64_t i = 0; i < question->count; i++) {
        const struct ranks_key *key = &question->keys[i];
        each += i > 0 && key->key != key[-1].key;
        const struct heard *heard = &question->answers[each];
        struct ranks_leaf *leaf = &leaves[key->value / 4];
        uint32_t k = key->value % 4;
        bool is_first =
            i == 0 || key->key != key[-1].key || key->value / 4 != key[-1].value / 4;
        leaf->side[k] = heard->number;
        if (is_first && heard->leaf == leaf->number) {
            leaf->owns |= RANKS_OWNS_SIDE(k);
        }
    }
}

static void take_corners(struct ranks_leaf *leaves, const struct question *question)
{
    uint64_t each = 0;
    for (uint64_t i = 0; i < question->count; i++) {
        const struct ranks_key *key = &question->keys[i];
        each += i > 0 && key->key != key[-1].key;
        struct ranks_leaf *leaf = &leaves[key->value / 4];
        bool is_first =
            i == 0 || key->key != key[-1].key || key->value / 4 != key[-1].value / 4;
        if (is_first && question->answers[each].leaf == leaf->number) {
            leaf->owns |= RANKS_OWNS_CORNER(key->value % 4);
        }
    }
}

/* ---- what is counted -------------------------------------------------------------- */

static int compare_corners(const void *a, const void *b)
{
    const uint32_t *one = a, *other = b;
    for (int k = 0; k < 3; k++) {
        if (one[k] != other[k]) {
            return one[k] < other[k] ? -1 : 1;
        }
    }
    return 0;
}

/* Corners of a triangle in descending order. */
static void order_corners(const uint32_t v[3], uint32_t ordered[3])
{
    uint32_t high = v[0] > v[1] ? v[0] : v[1], low = v[0] > v[1] ? v[1] : v[0];
    ordered[0] = v[2] > high ? v[2] : high;
    ordered[2] = v[2] < low ? v[2] : low;
    ordered[1] = high ^ low ^ v[2] ^ ordered[0] ^ ordered[2];
}

/* Triangles with the corners of another one, less one of each: in the directory of the
 * highest corner. */
static int count_duplicates(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                            const struct ranks_leaf *leaves, uint32_t count,
                            uint64_t *duplicates)
{
    uint32_t corners[3], (*in)[3] = NULL;
    struct ranks_post post;
    uint64_t all = 0;
    ranks_post_begin(&post, sizeof corners, count);
    for (uint32_t t = 0; t < count; t++) {
        order_corners(leaves[t].v, corners);
        ranks_post_add(&post, (uint32_t)ranks_directory(mesh, corners[0]), corners);
    }
    int status = ranks_post_deal(&world->link, &post, (void **)&in, &all);
    if (all > 1) {
        qsort(in, all, sizeof *in, compare_corners);
    }
    *duplicates = 0;
    for (uint64_t i = 1; i < all; i++) {
        *duplicates += compare_corners(in[i], in[i - 1]) == 0;
    }
    free(in);
    return status;
}

/* Zero area as the engine counts it for one process (daemon/engine/scene/feature.c): the
 * minors of two sides, each compared exactly. */
static bool has_zero_area(const double *x[3])
{
    double b[3], c[3];
    for (int k = 0; k < 3; k++) {
        b[k] = x[1][k] - x[0][k];
        c[k] = x[2][k] - x[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int j = (k + 1) % 3;
        double p = b[k] * c[j], q = b[j] * c[k];
        if (p != q || fma(b[k], c[j], -p) != fma(b[j], c[k], -q)) {
            return false;
        }
    }
    return true;
}

/* The corners' positions are with those who gave them. */
static int count_degenerate(struct pccd_mpi *world, const struct ranks_mesh *mesh,
                            const struct ranks_leaf *leaves, uint32_t count,
                            const struct question *corners, uint64_t *degenerate)
{
    uint32_t each = 0;
    uint32_t *vertices = ranks_array(corners->count, sizeof *vertices);
    uint32_t(*at)[3] = ranks_array(count, sizeof *at);
    double(*x)[3] = NULL;
    int status = vertices == NULL || at == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint64_t i = 0; status == PCCD_OK && i < corners->count; i++) {
        const struct ranks_key *key = &corners->keys[i];
        if (i == 0 || key->key != key[-1].key) {
            vertices[each++] = (uint32_t)key->key;
        }
        if (key->value / 4 < count) {
            at[key->value / 4][key->value % 4] = each - 1;
        }
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK) {
        status = ranks_fetch_registered(world, mesh, vertices, each, &x, NULL);
    }
    *degenerate = 0;
    for (uint32_t t = 0; status == PCCD_OK && t < count; t++) {
        const uint32_t *v = leaves[t].v;
        const double *corner[3] = {x[at[t][0]], x[at[t][1]], x[at[t][2]]};
        *degenerate +=
            v[0] == v[1] || v[1] == v[2] || v[2] == v[0] || has_zero_area(corner);
    }
    free(vertices);
    free(at);
    free(x);
    return status;
}

/* Edges that a triangle has, or a lower leaf, and points that anything has, go. */
static void drop_named(const struct ranks_mesh *mesh, struct ranks_named *named)
{
    uint32_t count = named->triangle_count, all = count + named->edge_count;
    uint32_t points_begin = mesh->triangle_total + mesh->edge_leaves;
    for (uint32_t i = count; i < all; i++) {
        if (named->leaves[i].owns & RANKS_OWNS_SIDE(0)) {
            named->leaves[count++] = named->leaves[i];
        }
    }
    named->edge_count = count - named->triangle_count;
    for (uint32_t i = all; i < all + named->point_count; i++) {
        if (named->leaves[i].number >= points_begin &&
            (named->leaves[i].owns & RANKS_OWNS_CORNER(0))) {
            named->leaves[count++] = named->leaves[i];
        }
    }
    named->point_count = count - named->triangle_count - named->edge_count;
}

static int find(struct pccd_mpi *world, struct ranks_mesh *mesh,
                struct ranks_named *named, struct question *sides,
                struct question *corners)
{
    uint32_t count = named->triangle_count + named->edge_count + named->point_count;
    struct ranks_leaf *leaves = named->leaves;
    for (uint32_t i = 0; i < count; i++) {
        leaves[i].side[0] = leaves[i].side[1] = leaves[i].side[2] = RANKS_NONE;
    }
    int status = ask(world, mesh, leaves, count, say_side, sides);
    if (status != PCCD_OK) {
        return status;
    }
    take_sides(leaves, sides);
    uint64_t edge_total = sides->total;
    question_deinit(sides);
    *sides = (struct question){.memory = NULL};
    status = ask(world, mesh, leaves, count, say_corner, corners);
    if (status != PCCD_OK) {
        return status;
    }
    take_corners(leaves, corners);
    uint64_t sums[5] = {0};
    status = count_duplicates(world, mesh, leaves, named->triangle_count, &sums[0]);
    if (status == PCCD_OK) {
        status = count_degenerate(world, mesh, leaves, named->triangle_count, corners,
                                  &sums[1]);
    }
    if (status != PCCD_OK) {
        return status;
    }
    drop_named(mesh, named);
    sums[2] = named->edge_count;
    sums[3] = named->point_count;
    status = ranks_sum(&world->link, sums, 4);
    mesh->info = (struct pccd_mesh_info){.vertex_count = mesh->vertex_total,
                                         .triangle_count = mesh->triangle_total,
                                         .edge_count = (uint32_t)edge_total,
                                         .duplicate_count = (uint32_t)sums[0],
                                         .degenerate_count = (uint32_t)sums[1],
                                         .isolated_count = mesh->vertex_total -
                                                           (uint32_t)corners->total,
                                         .free_edge_count = (uint32_t)sums[2],
                                         .free_point_count = (uint32_t)sums[3]};
    return status;
}

int ranks_sides_find(struct pccd_mpi *world, struct ranks_mesh *mesh,
                     struct ranks_named *named)
{
    struct question sides = {.memory = NULL}, corners = {.memory = NULL};
    int status = find(world, mesh, named, &sides, &corners);
    question_deinit(&sides);
    question_deinit(&corners);
    return status;
}
