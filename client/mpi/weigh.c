/* weigh.c - the weights of leaves.
 *
 * Sort the boxes of own leaves and ghosts along the curve, put boxes around each eight of
 * them, and so on; ask for each own leaf what its box meets, and for each of its features
 * what that is tested with.
 */
#include "cut.h"

#include <stdlib.h>
#include <string.h>

#include "boxes.h"
#include "parts.h"
#include "rank_sort.h"

/* So many own leaves are looked at at most, evenly along the curve, each for those behind
 * it, too. Of cloth-ball and n-body 16384 take a rank 0.2 s, and the largest work of four
 * ranks is 1.045 of the mean; all leaves take 0.4 s, and it is 1.026. */
#define SAMPLES_MAX 32768u

#define FAN          8u
#define LEVELS_MAX   12u
#define WEIGHT_UNITS 16.0 /* of the work of a leaf that meets nothing */
#define WEIGHT_RATIO 1.15 /* that, in pairs, before work was counted: 1.0 to 1.4 */
/* So that a heap of leaves in one place ends: it is cut anyway wherever it can be. */
#define WEIGHT_MAX 65535u

/* A box at both ends of the step. */
struct way {
    float low[2][3], high[2][3];
};

struct item {
    float box[6]; /* all over the step */
    const struct ranks_leaf *of;
    uint32_t object;
    uint32_t leaf; /* of its own leaves; RANKS_NONE: a ghost */
    uint32_t v[3];
};

/* Local positions of an object at both ends, and by how much its boxes are larger. */
struct path {
    const double (*x[2])[3];
    double growth;
};

/* Items in the order of the curve, and boxes around FAN of the level below each. */
struct tree {
    struct item *items;
    uint64_t count;
    float (*boxes[LEVELS_MAX])[6]; /* [0] around items */
    uint64_t counts[LEVELS_MAX];
    uint32_t levels;
    struct path *paths; /* [object_count] */
};

static void tree_deinit(struct tree *tree)
{
    free(tree->items);
    free(tree->paths);
    for (uint32_t i = 0; i < tree->levels; i++) {
        free(tree->boxes[i]);
    }
}

/* ---- boxes ------------------------------------------------------------------------ */

/* Around `count` local vertices; as floats nearest to the numbers: it is about how many
 * meet. */
static struct way way_of(const struct path *path, const uint32_t *v, uint32_t count)
{
    struct way way;
    for (int end = 0; end < 2; end++) {
        for (int k = 0; k < 3; k++) {
            double low = path->x[end][v[0]][k], high = low;
            for (uint32_t i = 1; i < count; i++) {
                double x = path->x[end][v[i]][k];
                low = x < low ? x : low;
                high = x > high ? x : high;
            }
            way.low[end][k] = (float)(low - path->growth);
            way.high[end][k] = (float)(high + path->growth);
        }
    }
    return way;
}

/* Is there a time of the step at which two boxes, each of which goes from one end to the
 * other, meet? */
static bool ways_meet(const struct way *a, const struct way *b)
{
    float begin = 0, end = 1;
    for (int k = 0; k < 3; k++) {
        for (int side = 0; side < 2; side++) {
            const struct way *low = side == 0 ? a : b, *high = side == 0 ? b : a;
            float gap0 = low->low[0][k] - high->high[0][k];
            float gap1 = low->low[1][k] - high->high[1][k];
            if (gap0 > 0) { /* until then they are apart */
                if (gap1 > 0) {
                    return false;
                }
                begin = fmaxf(begin, gap0 / (gap0 - gap1));
            } else if (gap1 > 0) {
                end = fminf(end, gap0 / (gap0 - gap1));
            }
        }
    }
    return begin <= end;
}

/* Boxes of one object's leaves, own and ghosts. */
static int add_items(struct pccd_mpi *world, uint32_t o, const struct path *path,
                     struct item *items)
{
    const struct ranks_object *object = world->objects[o];
    uint32_t count = object->own_count + object->ghost_count;
    uint32_t(*corners)[3] = ranks_array(count, sizeof *corners);
    int status = corners == NULL ? ranks_no_memory(world)
                                 : ranks_local_corners(world, &object->local, object->own,
                                                       object->own_count, corners);
    if (status == PCCD_OK) {
        status = ranks_local_corners(world, &object->local, object->ghosts,
                                     object->ghost_count, corners + object->own_count);
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        bool is_own = i < object->own_count;
        items[i].object = o;
        items[i].leaf = is_own ? i : RANKS_NONE;
        items[i].of = is_own ? &object->own[i] : &object->ghosts[i - object->own_count];
        memcpy(items[i].v, corners[i], sizeof items[i].v);
        struct way way = way_of(path, corners[i], 3);
        for (int k = 0; k < 3; k++) {
            items[i].box[k] = fminf(way.low[0][k], way.low[1][k]);
            items[i].box[k + 3] = fmaxf(way.high[0][k], way.high[1][k]);
        }
    }
    free(corners);
    return status;
}

/* items[i] becomes items[order[i].value], in place: cycle by cycle. */
static void put_in_order(struct item *items, struct ranks_key *order, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        struct item first = items[i];
        uint64_t at = i;
        while (order[at].value != i) {
            uint64_t from = order[at].value;
            items[at] = items[from];
            order[at].value = at;
            at = from;
        }
        items[at] = first;
        order[at].value = at;
    }
}

static int sort_items(struct pccd_mpi *world, struct tree *tree)
{
    float whole[6];
    double low[3], high[3];
    struct ranks_key *keys = ranks_array(2 * tree->count, sizeof *keys);
    if (keys == NULL) {
        return ranks_no_memory(world);
    }
    ranks_box_begin(whole);
    for (uint64_t i = 0; i < tree->count; i++) {
        ranks_box_add(whole, tree->items[i].box);
    }
    for (int k = 0; k < 3; k++) {
        low[k] = (double)whole[k];
        high[k] = (double)whole[k + 3];
    }
    for (uint64_t i = 0; i < tree->count; i++) {
        const float *box = tree->items[i].box;
        const double middle[3] = {0.5 * ((double)box[0] + (double)box[3]),
                                  0.5 * ((double)box[1] + (double)box[4]),
                                  0.5 * ((double)box[2] + (double)box[5])};
        keys[i] = (struct ranks_key){ranks_curve_place(middle, low, high), i};
    }
    put_in_order(tree->items, ranks_sort(keys, keys + tree->count, tree->count),
                 tree->count);
    free(keys);
    return PCCD_OK;
}

static const float *box_at(const struct tree *tree, uint32_t level, uint64_t i)
{
    return level == 0 ? tree->items[i].box : tree->boxes[level - 1][i];
}

/* Level n + 1 is made of level n, items being level 0, until one box is left. */
static int make_levels(struct pccd_mpi *world, struct tree *tree)
{
    uint64_t count = tree->count;
    while (count > 1 && tree->levels < LEVELS_MAX) {
        uint64_t above = (count + FAN - 1) / FAN;
        float(*boxes)[6] = ranks_array(above, sizeof *boxes);
        if (boxes == NULL) {
            return ranks_no_memory(world);
        }
        for (uint64_t i = 0; i < above; i++) {
            ranks_box_begin(boxes[i]);
            for (uint64_t j = i * FAN; j < (i + 1) * FAN && j < count; j++) {
                ranks_box_add(boxes[i], box_at(tree, tree->levels, j));
            }
        }
        tree->boxes[tree->levels] = boxes;
        tree->counts[tree->levels++] = above;
        count = above;
    }
    return PCCD_OK;
}

/* ---- pairs ------------------------------------------------------------------------- */

/* Differences between the points of two features at both ends: of a vertex and a face
 * three, of two edges four. */
struct pair {
    int count;
    double d[2][4][3];
    double edge[2][3]; /* EE: from the first end of the first edge to the second */
};

static double along(const double d[3], int direction)
{
    int axis = (direction - 3) / 2, next = (axis + 1) % 3;
    return direction % 2 ? d[axis] + d[next] : d[axis] - d[next];
}

/* Does a face diagonal keep them apart all over the step? */
static bool are_apart(const struct pair *pair)
{
    for (int direction = 3; direction < 9; direction++) {
        int positive = 0, negative = 0;
        for (int i = 0; i < 2 * pair->count; i++) {
            double x = along(pair->d[i % 2][i / 2], direction);
            positive += x > 0;
            negative += x < 0;
        }
        if (positive == 2 * pair->count || negative == 2 * pair->count) {
            return true;
        }
    }
    return false;
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Are their points certainly in one plane at no time? By the coefficients of that cubic
 * (Bernstein), if they have one sign. */
static bool is_never_plane(const struct pair *pair)
{
    double sums[4] = {0, 0, 0, 0};
    for (int ends = 0; ends < 8; ends++) {
        int i = ends & 1, j = ends >> 1 & 1, k = ends >> 2;
        sums[i + j + k] += pair->count == 3
                               ? determinant(pair->d[i][0], pair->d[j][1], pair->d[k][2])
                               : determinant(pair->edge[i], pair->d[j][0], pair->d[k][2]);
    }
    return (sums[0] > 0 && sums[1] > 0 && sums[2] > 0 && sums[3] > 0) ||
           (sums[0] < 0 && sums[1] < 0 && sums[2] < 0 && sums[3] < 0);
}

/* Would libpccd's filter let the pair pass? What does takes the most work by far. Of
 * thick features it says too little, of all alike. */
static bool passes(const struct path *path_a, const uint32_t *a, uint32_t a_count,
                   const struct path *path_b, const uint32_t *b)
{
    struct pair pair = {.count = a_count == 1 ? 3 : 4};
    for (int end = 0; end < 2; end++) {
        for (int i = 0; i < pair.count; i++) {
            const double *from = path_a->x[end][a[a_count == 1 ? 0 : i % 2]];
            const double *to = path_b->x[end][b[a_count == 1 ? i : i / 2]];
            for (int k = 0; k < 3; k++) {
                pair.d[end][i][k] = to[k] - from[k];
            }
        }
        for (int k = 0; k < 3 && a_count > 1; k++) {
            pair.edge[end][k] = path_a->x[end][a[1]][k] - path_a->x[end][a[0]][k];
        }
    }
    return !is_never_plane(&pair) && !are_apart(&pair);
}

/* Features of a leaf that belong to it; an edge as its two ends. */
struct features {
    struct way way; /* of the leaf */
    uint32_t vertex_count, edge_count;
    struct way vertices[3], edges[3];
    uint32_t vertex[3], ends[3][2], number[3];
};

static void list_features(const struct tree *tree, const struct item *item,
                          struct features *features)
{
    const struct path *path = &tree->paths[item->object];
    features->way = way_of(path, item->v, 3);
    features->vertex_count = features->edge_count = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t ends[2] = {item->v[k], item->v[(k + 1) % 3]};
        if (item->of->owns & RANKS_OWNS_CORNER(k)) {
            uint32_t at = features->vertex_count++;
            features->vertex[at] = ends[0];
            features->vertices[at] = way_of(path, ends, 1);
        }
        if (item->of->owns & RANKS_OWNS_SIDE(k)) {
            uint32_t at = features->edge_count++;
            memcpy(features->ends[at], ends, sizeof ends);
            features->number[at] = item->of->side[k];
            features->edges[at] = way_of(path, ends, 2);
        }
    }
}

/* Vertices of an item with the face of another. */
static uint32_t count_vertices(const struct tree *tree, const struct item *item,
                               const struct features *mine, const struct item *other,
                               const struct way *way)
{
    const struct path *path = &tree->paths[item->object];
    uint32_t count = 0;
    for (uint32_t i = 0; i < mine->vertex_count; i++) {
        uint32_t v = mine->vertex[i];
        bool is_joined = item->object == other->object &&
                         (v == other->v[0] || v == other->v[1] || v == other->v[2]);
        count += !is_joined && ways_meet(&mine->vertices[i], way) &&
                 passes(path, &v, 1, &tree->paths[other->object], other->v);
    }
    return count;
}

/* Edges of an item that come before those of another. */
static uint32_t count_edges(const struct tree *tree, const struct item *item,
                            const struct features *mine, const struct item *other)
{
    const struct path *paths[2] = {&tree->paths[item->object],
                                   &tree->paths[other->object]};
    bool is_one = item->object == other->object;
    uint32_t count = 0;
    for (uint32_t k = 0; k < 3 && mine->edge_count > 0; k++) {
        const uint32_t ends[2] = {other->v[k], other->v[(k + 1) % 3]};
        if (!(other->of->owns & RANKS_OWNS_SIDE(k))) {
            continue;
        }
        struct way way = way_of(paths[1], ends, 2);
        for (uint32_t i = 0; i < mine->edge_count; i++) {
            const uint32_t *e = mine->ends[i];
            bool is_left_out =
                is_one && (e[0] == ends[0] || e[0] == ends[1] || e[1] == ends[0] ||
                           e[1] == ends[1] || mine->number[i] > other->of->side[k]);
            count += !is_left_out && ways_meet(&mine->edges[i], &way) &&
                     passes(paths[0], e, 2, paths[1], ends);
        }
    }
    return count;
}

/* Of an item with these features: pairs with those of another one whose first feature is
 * its own, and which libpccd has to solve. */
static uint32_t count_pairs(const struct pccd_mpi *world, const struct tree *tree,
                            const struct item *item, const struct features *mine,
                            const struct item *other)
{
    const struct ranks_object *object = world->objects[other->object];
    uint32_t count = 0;
    const struct way way = way_of(&tree->paths[other->object], other->v, 3);
    if (!ways_meet(&mine->way, &way) ||
        !ranks_may_meet(world, item->object, other->object)) {
        return 0;
    }
    if (other->of->number < object->mesh->triangle_total) {
        count += count_vertices(tree, item, mine, other, &way);
    }
    if (item->object == other->object ||
        world->objects[item->object]->handle < object->handle) {
        count += count_edges(tree, item, mine, other);
    }
    return count;
}

/* How many pairs begin with a feature of an item. A walk over the tree without a stack:
 * the next box is the first one below, or the next beside, or beside one above. */
static uint32_t count_meeting(const struct pccd_mpi *world, const struct tree *tree,
                              const struct item *item)
{
    uint32_t met = 0, level = tree->levels;
    uint64_t at = 0;
    struct features mine;
    list_features(tree, item, &mine);
    if (mine.vertex_count + mine.edge_count == 0) {
        return 0;
    }
    for (;;) {
        bool meets = ranks_boxes_meet(item->box, box_at(tree, level, at));
        if (meets && level > 0) {
            level--;
            at *= FAN;
            continue;
        }
        if (meets && &tree->items[at] != item) {
            met += count_pairs(world, tree, item, &mine, &tree->items[at]);
        }
        uint64_t count = level == 0 ? tree->count : tree->counts[level - 1];
        while (level < tree->levels && (at % FAN == FAN - 1 || at + 1 == count)) {
            at /= FAN;
            level++;
            count = tree->counts[level - 1];
        }
        if (level == tree->levels || met >= WEIGHT_MAX) {
            return met < WEIGHT_MAX ? met : WEIGHT_MAX;
        }
        at++;
    }
}

static int weigh_items(struct pccd_mpi *world, struct tree *tree)
{
    int status = sort_items(world, tree);
    if (status == PCCD_OK) {
        status = make_levels(world, tree);
    }
    uint64_t own_count = 0, own = 0;
    uint32_t met = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        own_count += world->objects[o]->own_count;
    }
    const uint64_t each = own_count / SAMPLES_MAX + 1;
    for (uint64_t i = 0; i < tree->count && status == PCCD_OK; i++) {
        const struct item *item = &tree->items[i];
        if (item->leaf != RANKS_NONE) {
            met = own++ % each == 0 ? count_meeting(world, tree, item) : met;
            world->objects[item->object]->weights[item->leaf] = met;
        }
    }
    return status;
}

static int make_items(struct pccd_mpi *world, double separation, double (*const *x)[3],
                      struct tree *tree)
{
    uint32_t objects = world->object_count;
    uint64_t at = 0;
    for (uint32_t o = 0; o < objects; o++) {
        tree->count += world->objects[o]->own_count + world->objects[o]->ghost_count;
    }
    tree->items = ranks_array(tree->count, sizeof *tree->items);
    tree->paths = ranks_array(objects, sizeof *tree->paths);
    int status =
        tree->items == NULL || tree->paths == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < objects && status == PCCD_OK; o++) {
        struct ranks_object *object = world->objects[o];
        free(object->weights);
        object->weights = ranks_array(object->own_count, sizeof *object->weights);
        tree->paths[o] =
            (struct path){{(const double(*)[3])x[o], (const double(*)[3])x[objects + o]},
                          ranks_reach(object, separation)};
        status = object->weights == NULL
                     ? ranks_no_memory(world)
                     : add_items(world, o, &tree->paths[o], tree->items + at);
        at += object->own_count + object->ghost_count;
    }
    return status;
}

/* Work of the last step = alone * leaves + meeting * pairs, as nearly
 * as that can be for all ranks (least squares). Returns alone / meeting. */
static double fit(const uint64_t *leaves, const uint64_t *met, const uint64_t *work,
                  int size)
{
    double ll = 0, lm = 0, mm = 0, lw = 0, mw = 0;
    for (int r = 0; r < size; r++) {
        double l = (double)leaves[r], m = (double)met[r], w = (double)work[r];
        ll += l * l;
        lm += l * m;
        mm += m * m;
        lw += l * w;
        mw += m * w;
    }
    double determinant = ll * mm - lm * lm;
    double alone = lw * mm - mw * lm, meeting = mw * ll - lw * lm;
    if (!(determinant > 1e-9 * ll * mm) || !(meeting > 0)) {
        return WEIGHT_RATIO;
    }
    double ratio = alone / meeting;
    return fmin(fmax(ratio, 0.25), 64);
}

/* From how many pairs begin with each leaf to what it weighs. */
static int scale(struct pccd_mpi *world, uint64_t *sum)
{
    struct ranks_link *link = &world->link;
    uint64_t leaves = 0, met = 0;
    *sum = 0;
    uint64_t *all = ranks_array(3 * (uint64_t)link->size, sizeof *all);
    int status = ranks_agree_on(link, all == NULL ? ranks_no_memory(world) : PCCD_OK);
    for (uint32_t o = 0; o < world->object_count; o++) {
        leaves += world->objects[o]->own_count;
        for (uint32_t i = 0; i < world->objects[o]->own_count; i++) {
            met += world->objects[o]->weights[i];
        }
    }
    const uint64_t mine[3] = {leaves, met, world->known_work};
    for (int i = 0; i < 3 && status == PCCD_OK; i++) {
        status = ranks_tell_all(link, mine[i], all + i * link->size);
    }
    if (status == PCCD_OK) {
        double ratio = fit(all, all + link->size, all + 2 * link->size, link->size);
        for (uint32_t o = 0; o < world->object_count; o++) {
            for (uint32_t i = 0; i < world->objects[o]->own_count; i++) {
                uint32_t *weight = &world->objects[o]->weights[i];
                *weight = (uint32_t)(WEIGHT_UNITS * (1 + *weight / ratio));
                *sum += *weight;
            }
        }
    }
    free(all);
    return status;
}

void ranks_weights_forget(struct pccd_mpi *world)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        free(world->objects[o]->weights);
        world->objects[o]->weights = NULL;
    }
}

int ranks_weigh(struct pccd_mpi *world, double separation, uint64_t *sum)
{
    uint32_t objects = world->object_count;
    struct tree tree = {.count = 0};
    double(**x)[3] = calloc(2 * (size_t)objects + 1, sizeof *x);
    const double(**given)[3] = calloc((size_t)objects + 1, sizeof *given);
    int status = x == NULL || given == NULL ? ranks_no_memory(world) : PCCD_OK;
    for (uint32_t o = 0; o < 2 * objects && status == PCCD_OK; o++) {
        x[o] = ranks_array(world->objects[o % objects]->local.vertex_count, sizeof **x);
        status = x[o] == NULL ? ranks_no_memory(world) : PCCD_OK;
    }
    status = ranks_agree_on(&world->link, status);
    for (uint32_t end = 0; end < 2 && status == PCCD_OK; end++) {
        for (uint32_t o = 0; o < objects; o++) {
            given[o] = end == 0 ? world->objects[o]->from : world->objects[o]->to;
        }
        status = ranks_plan_send(world, given, x + end * objects);
    }
    if (status == PCCD_OK) {
        status = make_items(world, separation, x, &tree);
        if (status == PCCD_OK) {
            status = weigh_items(world, &tree);
        }
        status = ranks_agree_on(&world->link, status);
    }
    if (status == PCCD_OK) {
        status = scale(world, sum);
    }
    tree_deinit(&tree);
    for (uint32_t o = 0; x != NULL && o < 2 * objects; o++) {
        free(x[o]);
    }
    free((void *)x);
    free((void *)given);
    return status;
}
