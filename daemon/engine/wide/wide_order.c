/* wide_order.c - the order in which an object's features are stored.
 *
 * Threads: [any]; opens parallel regions if it is told to. The order does not depend on
 * how many threads made it: each split is of a list that they do not change.
 */
#include "wide_order.h"

#include <assert.h>
#include <omp.h>
#include <string.h>

#include "box_frames.h"
#include "boxes.h"
#include "kernel.h"
#include "memory.h"
#include "parallel.h"
#include "topology.h"

/* ---- the pieces of a mesh ---------------------------------------------------------- */

/* Triangles that are connected by shared vertices.
 *
 * Source: Tarjan 1975 (union-find); van Leeuwen, van der Weide 1977 (halving of
 * paths). */
#define NO_PIECE UINT32_MAX

static uint32_t root_of(uint32_t *parent, uint32_t vertex)
{
    while (parent[vertex] != vertex) {
        parent[vertex] = parent[parent[vertex]];
        vertex = parent[vertex];
    }
    return vertex;
}

/* The lesser root becomes the parent, so that no parent is greater than its child. */
static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    if (parent[a] == parent[b]) {
        return; /* as of most neighbours */
    }
    a = root_of(parent, a);
    b = root_of(parent, b);
    if (a < b) {
        parent[b] = a;
    } else {
        parent[a] = b;
    }
}

/* Find the pieces of a committed mesh: of[vertex_count] gets the piece of every vertex,
 * numbered by their least vertices, NO_PIECE if it is in no triangle. Returns how many
 * there are. O(vertices + triangles), nearly. */
static uint32_t find_pieces(const struct eng_mesh *mesh, uint32_t *of)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->info.vertex_count; i++) {
        of[i] = NO_PIECE;
    }
    for (uint32_t i = 0; i < mesh->leaf_count; i++) {
        const uint32_t *v = mesh->leaves[i].v;
        for (int k = 0; k < 3; k++) {
            of[v[k]] = of[v[k]] == NO_PIECE ? v[k] : of[v[k]];
        }
        join(of, v[0], v[1]);
        join(of, v[0], v[2]);
    }
    /* Parents turn into numbers from the first vertex on: each one's parent has its own
     * by then. */
    for (uint32_t i = 0; i < mesh->info.vertex_count; i++) {
        if (of[i] != NO_PIECE) {
            of[i] = of[i] == i ? count++ : of[of[i]];
        }
    }
    return count;
}

/* ---- orders ------------------------------------------------------------------------ */

/* Features of an object below which one thread orders them: some 2 ms. */
#define TEAM_FEATURES_MIN 32768u

/* Pieces of a mesh that are told apart, and triangles of each on average: with fewer,
 * more than an eighth of all slots would be behind pieces. */
#define PIECES_MIN          16u
#define PIECES_MAX          4096u
#define PIECE_TRIANGLES_MIN 64u

/* The centroid of `count` vertices times their number: the order is the same. */
static inline struct eng_split_item item_of(struct eng_wide_positions positions,
                                            const uint32_t *vertices, uint32_t count,
                                            uint32_t id)
{
    struct eng_split_item item = {.id = id};
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (uint32_t i = 0; i < count; i++) {
            sum += eng_box_frame_at(positions.frame, positions.x[vertices[i]][k], k);
        }
        item.centroid[k] = (float)sum;
    }
    return item;
}

uint32_t eng_wide_order_sources(const struct eng_mesh *mesh, enum pccd_tree kind)
{
    return kind == PCCD_TREE_EDGES   ? mesh->info.edge_count
           : kind == PCCD_TREE_FACES ? mesh->info.triangle_count
                                     : mesh->leaf_count;
}

void eng_wide_order_sum(const struct eng_wide_order *order,
                        struct eng_wide_positions positions, uint32_t first,
                        uint32_t count, struct eng_split_item *pieces)
{
    for (uint32_t i = first; order->piece_of && i < first + count; i++) {
        uint32_t piece = order->piece_of[i];
        for (int k = 0; k < 3 && piece != NO_PIECE; k++) {
            pieces[piece].centroid[k] +=
                (float)eng_box_frame_at(positions.frame, positions.x[i][k], k);
        }
    }
}

void eng_wide_order_sequence(const struct eng_wide_order *order,
                             struct eng_split_item *pieces)
{
    for (uint32_t i = 0; i < order->piece_count; i++) {
        for (int k = 0; k < 3; k++) {
            pieces[i].centroid[k] /= (float)order->piece_size[PCCD_TREE_VERTICES][i];
        }
        pieces[i].id = i;
    }
    eng_wide_sort(pieces, order->piece_count, 1);
}

uint32_t eng_wide_order_slots(const struct eng_wide_order *order, enum pccd_tree kind,
                              uint32_t piece)
{
    uint32_t size = order->piece_size[kind][piece];
    return order->piece_of ? (size + ENG_WIDE - 1) / ENG_WIDE * ENG_WIDE : size;
}

void eng_wide_order_assign_slots(const struct eng_wide_order *order, enum pccd_tree kind,
                                 const struct eng_split_item *pieces,
                                 struct eng_split_item *items, uint32_t *next)
{
    uint32_t slot = 0;
    for (uint32_t i = 0; i < order->piece_count; i++) {
        uint32_t piece = pieces[i].id;
        uint32_t end = slot + eng_wide_order_slots(order, kind, piece);
        next[piece] = slot;
        for (slot += order->piece_size[kind][piece]; slot < end; slot++) {
            items[slot].id = ENG_WIDE_NO_FEATURE;
        }
    }
}

void eng_wide_order_list(const struct eng_wide_order *order, const struct eng_mesh *mesh,
                         struct eng_wide_positions positions,
                         struct eng_wide_sources sources, struct eng_split_item *items,
                         uint32_t *next)
{
    const uint32_t *piece_of = order->piece_of;
    const enum pccd_tree kind = sources.kind;
    for (uint32_t i = sources.first; i < sources.first + sources.count; i++) {
        const uint32_t *v = kind == PCCD_TREE_EDGES ? mesh->edges[i] : mesh->leaves[i].v;
        uint32_t *place = &next[piece_of ? piece_of[v[0]] : 0];
        if (kind == PCCD_TREE_EDGES) {
            items[(*place)++] = item_of(positions, v, 2, i);
            continue;
        }
        if (kind == PCCD_TREE_FACES) {
            items[(*place)++] = item_of(positions, v, 3, i);
            continue;
        }
        for (unsigned k = 0; k < 3; k++) {
            if (mesh->leaves[i].owns & ENG_OWNS_VERTEX(k)) {
                items[(*place)++] = item_of(positions, &v[k], 1, v[k]);
            }
        }
    }
}

static int threads_for(size_t features, uint32_t threads)
{
    uint32_t most = ENG_WIDE_PARTS_MAX / ENG_WIDE_TREES;
    return features < TEAM_FEATURES_MIN || threads == 0 ? 1
           : threads < most                             ? (int)threads
                                                        : (int)most;
}

/* Return how many pieces of a mesh are to be told apart, 1 of most: those
 * of[vertex_count]. */
static uint32_t tell_apart(const struct eng_mesh *mesh, uint32_t *of)
{
    uint32_t size[PIECES_MAX] = {0};
    uint32_t largest = 0;
    uint32_t count = find_pieces(mesh, of);
    if (count < PIECES_MIN || count > PIECES_MAX ||
        count > mesh->leaf_count / PIECE_TRIANGLES_MIN) {
        return 1;
    }
    for (uint32_t i = 0; i < mesh->leaf_count; i++) {
        uint32_t now = ++size[of[mesh->leaves[i].v[0]]];
        largest = now > largest ? now : largest;
    }
    return largest > mesh->leaf_count / 2 ? 1 : count;
}

/* The memory that an order is made with; freed together. */
struct making {
    uint32_t *of;                  /* [vertex_count] */
    uint32_t piece_count;          /* 1: not told apart */
    uint32_t *size;                /* [ENG_WIDE_TREES][piece_count] */
    struct eng_split_item *items;  /* of the largest tree; for a team of all three */
    struct eng_split_item *pieces; /* [piece_count] */
    uint32_t *next;                /* [piece_count] */
    struct eng_wide_range *parts;  /* of a tree each piece, or more parts */
    int team;                      /* threads */
    uint64_t *words;               /* for each; NULL: none */
};

static void making_free(struct making *making)
{
    eng_free(making->of);
    eng_free(making->size);
    eng_free(making->items);
    eng_free(making->pieces);
    eng_free(making->next);
    eng_free(making->parts);
    eng_free(making->words);
}

static void count_features(const struct making *making, const struct eng_mesh *mesh)
{
    const struct eng_mesh_info *info = &mesh->info;
    uint32_t n = making->piece_count;
    uint32_t *vertices = making->size;
    uint32_t *edges = vertices + n;
    uint32_t *faces = edges + n;
    if (n == 1) {
        *vertices = info->vertex_count - info->isolated_count;
        *edges = info->edge_count;
        *faces = info->triangle_count;
        return;
    }
    memset(vertices, 0, (size_t)ENG_WIDE_TREES * n * sizeof *vertices);
    for (uint32_t i = 0; i < info->vertex_count; i++) {
        if (making->of[i] != NO_PIECE) {
            vertices[making->of[i]]++;
        }
    }
    for (uint32_t i = 0; i < info->edge_count; i++) {
        edges[making->of[mesh->edges[i][0]]]++;
    }
    for (uint32_t i = 0; i < info->triangle_count; i++) {
        faces[making->of[mesh->leaves[i].v[0]]]++;
    }
}

/* Where the arrays of an order are: behind it. */
static void lay_out(struct eng_wide_order *order, bool has_pieces)
{
    uint32_t *next = (uint32_t *)(void *)(order + 1);
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        order->feature[kind] = next;
        next += order->count[kind];
    }
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        order->piece_size[kind] = next;
        next += order->piece_count;
    }
    order->piece_of = has_pieces ? next : NULL;
}

struct eng_wide_order *eng_wide_order_copy(const struct eng_wide_order *order)
{
    struct eng_wide_order *copy = eng_alloc(1, order->bytes);
    if (copy) {
        memcpy(copy, order, order->bytes);
        lay_out(copy, order->piece_of != NULL);
    }
    return copy;
}

/* An order whose features are not in it yet. */
static struct eng_wide_order *order_of(const struct making *making,
                                       const struct eng_mesh *mesh)
{
    struct eng_wide_order shape = {.piece_count = making->piece_count};
    size_t slots = 0;
    size_t numbers = (size_t)ENG_WIDE_TREES * making->piece_count;
    size_t vertices = making->piece_count > 1 ? mesh->info.vertex_count : 0;
    shape.piece_of = vertices > 0 ? making->of : NULL;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        shape.piece_size[kind] = making->size + (size_t)kind * making->piece_count;
        for (uint32_t i = 0; i < making->piece_count; i++) {
            shape.count[kind] += eng_wide_order_slots(&shape, kind, i);
        }
        slots += shape.count[kind];
    }
    shape.bytes = sizeof shape + (slots + numbers + vertices) * sizeof(uint32_t);
    struct eng_wide_order *order = eng_alloc(1, shape.bytes);
    if (order) {
        *order = shape;
        lay_out(order, vertices > 0);
        memcpy(order->piece_size[0], making->size, numbers * sizeof(uint32_t));
        if (order->piece_of) {
            memcpy(order->piece_of, making->of, vertices * sizeof(uint32_t));
        }
    }
    return order;
}

static struct eng_wide_order *making_begin(struct making *making,
                                           const struct eng_mesh *mesh, uint32_t threads)
{
    struct eng_wide_order *order = NULL;
    memset(making, 0, sizeof *making);
    making->of = eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *making->of);
    if (making->of) {
        making->piece_count = tell_apart(mesh, making->of);
        making->size = eng_alloc(making->piece_count, ENG_WIDE_TREES * sizeof(uint32_t));
    }
    if (making->size) {
        count_features(making, mesh);
        order = order_of(making, mesh);
    }
    if (order) {
        size_t slots = (size_t)order->count[0] + order->count[1] + order->count[2];
        size_t parts = (size_t)ENG_WIDE_TREES * order->piece_count;
        making->team = threads_for(slots, threads);
        bool wants_words = slots >= ENG_WIDE_WORDS_MIN;
        for (int kind = 0; making->team == 1 && kind < ENG_WIDE_TREES; kind++) {
            slots = kind == 0 || order->count[kind] > slots ? order->count[kind] : slots;
        }
        parts = parts > ENG_WIDE_PARTS_MAX ? parts : ENG_WIDE_PARTS_MAX;
        making->items = eng_alloc(slots, sizeof *making->items);
        making->pieces = eng_alloc(order->piece_count, sizeof *making->pieces);
        making->next = eng_alloc(order->piece_count, sizeof *making->next);
        making->parts = eng_alloc(parts, sizeof *making->parts);
        if (wants_words && making->parts) { /* last: it goes without them, too */
            size_t most = making->team > 1 || slots > ENG_WIDE_WORDS_MAX
                              ? ENG_WIDE_WORDS_MAX
                              : slots;
            making->words =
                eng_alloc((size_t)making->team * most, 2 * sizeof *making->words);
        }
    }
    if (!order || !making->items || !making->pieces || !making->next || !making->parts) {
        making_free(making);
        eng_free(order);
        return NULL;
    }
    memset(making->pieces, 0, order->piece_count * sizeof *making->pieces);
    return order;
}

/* item_of where no coordinate changes by the frame. */
static inline struct eng_split_item
item_in_place(const double (*x)[3], const uint32_t *vertices, uint32_t count, uint32_t id)
{
    struct eng_split_item item = {.id = id};
    for (int k = 0; k < 3; k++) {
        double sum = x[vertices[0]][k];
        for (uint32_t i = 1; i < count; i++) {
            sum += x[vertices[i]][k];
        }
        item.centroid[k] = (float)sum;
    }
    return item;
}

static bool is_plain(const struct eng_box_frame *frame)
{
    return frame->origin[4] == 0 && frame->origin[5] == 0 && frame->origin[6] == 0 &&
           frame->scale == 1;
}

/* Lists features of a mesh at positions, `in_place` where the frame changes no
 * coordinate. */
struct listing {
    const struct making *making;
    const struct eng_mesh *mesh;
    struct eng_wide_positions positions;
    bool in_place;
};

/* Return the item of a feature with `corners` vertices. */
static inline struct eng_split_item list_one(const struct listing *listing,
                                             uint32_t corners, uint32_t i)
{
    const struct eng_mesh *mesh = listing->mesh;
    const uint32_t *v = corners == 1   ? &i
                        : corners == 2 ? mesh->edges[i]
                                       : mesh->leaves[i].v;
    return listing->in_place ? item_in_place(listing->positions.x, v, corners, i)
                             : item_of(listing->positions, v, corners, i);
}

/* Features after which one is listed when its vertices are fetched. */
#define AHEAD 16u

/* Fetch vertices of a feature soon to be listed: with numbers that are shuffled each is
 * far from the others. */
static inline void fetch_ahead(const struct listing *listing, uint32_t corners,
                               uint32_t i, uint32_t end)
{
    const struct eng_mesh *mesh = listing->mesh;
    if (i + AHEAD < end) {
        const uint32_t *v =
            corners == 2 ? mesh->edges[i + AHEAD] : mesh->leaves[i + AHEAD].v;
        for (uint32_t k = 0; k < corners; k++) {
            __builtin_prefetch(listing->positions.x[v[k]]);
        }
    }
}

/* The features of one piece that is the mesh: a part of several. */
static void list_part(const struct listing *listing, enum pccd_tree kind, uint32_t count,
                      uint32_t part, uint32_t parts, struct eng_split_item *items)
{
    uint32_t i = (uint32_t)((uint64_t)count * part / parts);
    uint32_t end = (uint32_t)((uint64_t)count * (part + 1) / parts);
    switch (kind) { /* so that each loop is compiled with its number of corners */
    case PCCD_TREE_VERTICES:
        for (; i < end; i++) {
            items[i] = list_one(listing, 1, i);
        }
        break;
    case PCCD_TREE_EDGES:
        for (; i < end; i++) {
            fetch_ahead(listing, 2, i, end);
            items[i] = list_one(listing, 2, i);
        }
        break;
    default:
        for (; i < end; i++) {
            fetch_ahead(listing, 3, i, end);
            items[i] = list_one(listing, 3, i);
        }
    }
}

/* List the features of a tree at the next places of their pieces. */
static void list(const struct listing *listing, enum pccd_tree kind,
                 struct eng_split_item *items)
{
    const struct making *making = listing->making;
    const struct eng_mesh_info *info = &listing->mesh->info;
    uint32_t count = kind == PCCD_TREE_VERTICES ? info->vertex_count
                     : kind == PCCD_TREE_EDGES  ? info->edge_count
                                                : info->triangle_count;
    if (making->piece_count == 1 &&
        (kind != PCCD_TREE_VERTICES || info->isolated_count == 0)) {
        struct eng_parallel region = eng_parallel_open();
        uint32_t parts = (uint32_t)making->team;
#pragma omp parallel for num_threads(making->team) if (making->team > 1)
        for (uint32_t part = 0; part < parts; part++) {
            ENG_PARALLEL_JOIN(region);
            list_part(listing, kind, count, part, parts, items);
        }
        eng_parallel_close();
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t v = kind == PCCD_TREE_VERTICES ? i
                     : kind == PCCD_TREE_EDGES  ? listing->mesh->edges[i][0]
                                                : listing->mesh->leaves[i].v[0];
        if (making->of[v] != NO_PIECE) {
            uint32_t piece = making->piece_count > 1 ? making->of[v] : 0;
            items[making->next[piece]++] = list_one(listing, (uint32_t)kind + 1, i);
        }
    }
}

/* By one thread one tree after the other, in the same memory; by a team all at once. */
static void sort_trees(struct making *making, struct eng_wide_order *made,
                       const struct eng_mesh *mesh, struct eng_wide_positions positions)
{
    const struct listing listing = {making, mesh, positions, is_plain(positions.frame)};
    uint32_t *ids = made->feature[0]; /* the trees follow each other */
    size_t first = 0;
    uint32_t parts = 0;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        struct eng_split_item *items = making->items + first;
        eng_wide_order_assign_slots(made, kind, making->pieces, items, making->next);
        for (uint32_t i = 0; i < made->piece_count; i++) {
            making->parts[parts++] = (struct eng_wide_range){
                first + making->next[i], making->next[i], made->piece_size[kind][i]};
        }
        for (uint32_t i = 0; made->piece_of && i < made->count[kind]; i++) {
            made->feature[kind][i] = ENG_WIDE_NO_FEATURE; /* most are replaced */
        }
        list(&listing, kind, items);
        first += made->count[kind];
        if (making->team == 1 || kind + 1 == ENG_WIDE_TREES) {
            eng_wide_sort_parts(making->items, making->parts, parts, making->team,
                                making->words, ids);
            ids += first;
            first = 0;
            parts = 0;
        }
    }
}

int eng_wide_order_new(const struct eng_mesh *mesh, const double (*x)[3],
                       uint32_t threads, struct eng_wide_order **order)
{
    assert(mesh->committed && x);
    struct making making;
    struct eng_wide_order *made = making_begin(&making, mesh, eng_payer_threads(threads));
    if (!made) {
        return PCCD_E_NOMEM;
    }
    struct eng_box_frame frame = eng_box_frame_alone(mesh, x);
    struct eng_wide_positions positions = {x, &frame};
    eng_wide_order_sum(made, positions, 0, mesh->info.vertex_count, making.pieces);
    eng_wide_order_sequence(made, making.pieces);
    sort_trees(&making, made, mesh, positions);
    making_free(&making);
    *order = made;
    return PCCD_OK;
}
