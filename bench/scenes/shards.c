/* shards.c - a surface cut into pieces. */
#include "surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NONE UINT32_MAX

/* A side of a triangle, to be matched with the same side of its neighbour. */
struct side {
    uint32_t low; /* vertices */
    uint32_t high;
    uint32_t at; /* 3 * triangle + corner where it begins */
};

struct cut {
    const struct surface *whole;
    const double (*inner)[3];
    uint32_t *neighbour; /* [3 * triangles]: across the side, or NONE */
    uint32_t *piece;     /* [triangles] */
    uint32_t *order;     /* [triangles]: by piece */
    uint32_t *local[2];  /* [vertices]: outer and inner copy in the current piece */
};

static int compare_sides(const void *a, const void *b)
{
    const struct side *x = a;
    const struct side *y = b;
    if (x->low != y->low) {
        return x->low < y->low ? -1 : 1;
    }
    if (x->high != y->high) {
        return x->high < y->high ? -1 : 1;
    }
    return (x->at > y->at) - (x->at < y->at);
}

static void find_neighbours(struct cut *cut)
{
    uint32_t count = 3 * cut->whole->triangle_count;
    struct side *sides = bench_scene_alloc(count, sizeof *sides);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *t = cut->whole->triangles[i / 3];
        uint32_t a = t[i % 3];
        uint32_t b = t[(i + 1) % 3];
        sides[i] = (struct side){a < b ? a : b, a < b ? b : a, i};
        cut->neighbour[i] = NONE;
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    for (uint32_t i = 0; i + 1 < count; i++) {
        if (sides[i].low == sides[i + 1].low && sides[i].high == sides[i + 1].high) {
            cut->neighbour[sides[i].at] = sides[i + 1].at / 3;
            cut->neighbour[sides[i + 1].at] = sides[i].at / 3;
        }
    }
    free(sides);
}

/* Breadth-first from all seeds at once. */
static void grow_pieces(struct cut *cut, uint32_t count, struct prng *prng)
{
    uint32_t total = cut->whole->triangle_count;
    uint32_t *queue = bench_scene_alloc(total, sizeof *queue);
    uint32_t tail = 0;
    memset(cut->piece, 0xff, total * sizeof *cut->piece);
    while (tail < count) {
        uint32_t seed = prng_u32(prng, total);
        if (cut->piece[seed] == NONE) {
            cut->piece[seed] = tail;
            queue[tail++] = seed;
        }
    }
    for (uint32_t head = 0; head < tail; head++) {
        uint32_t t = queue[head];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t next = cut->neighbour[3 * t + k];
            if (next != NONE && cut->piece[next] == NONE) {
                cut->piece[next] = cut->piece[t];
                queue[tail++] = next;
            }
        }
    }
    free(queue);
}

static void sort_by_piece(struct cut *cut, uint32_t count)
{
    uint32_t *first = bench_scene_alloc(count + 1, sizeof *first);
    memset(first, 0, (count + 1) * sizeof *first);
    for (uint32_t t = 0; t < cut->whole->triangle_count; t++) {
        first[cut->piece[t] + 1]++;
    }
    for (uint32_t i = 0; i < count; i++) {
        first[i + 1] += first[i];
    }
    for (uint32_t t = 0; t < cut->whole->triangle_count; t++) {
        cut->order[first[cut->piece[t]]++] = t;
    }
    free(first);
}

/* The copy of vertex v in a piece, which is made when it is first asked for. */
static uint32_t copy_of(struct shards *shards, const struct cut *cut, int side,
                        uint32_t v, uint32_t piece)
{
    uint32_t *local = &cut->local[side][v];
    struct surface *out = &shards->surface;
    if (*local == NONE || shards->piece_of[*local] != piece) {
        *local = out->vertex_count++;
        memcpy(out->x[*local], side ? cut->inner[v] : cut->whole->x[v], sizeof *out->x);
        shards->piece_of[*local] = piece;
        shards->vertex_of[*local] = v;
    }
    return *local;
}

static void add_triangle(struct surface *out, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = out->triangles[out->triangle_count++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* A triangle in its piece; for a shard, its inner side and the walls at the cracks. */
static void copy_triangle(struct shards *shards, const struct cut *cut, uint32_t t)
{
    const uint32_t *v = cut->whole->triangles[t];
    uint32_t piece = cut->piece[t];
    struct surface *out = &shards->surface;
    uint32_t o[3];
    uint32_t i[3];
    for (int k = 0; k < 3; k++) {
        o[k] = copy_of(shards, cut, 0, v[k], piece);
    }
    add_triangle(out, o[0], o[1], o[2]);
    if (!cut->inner) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        i[k] = copy_of(shards, cut, 1, v[k], piece);
    }
    add_triangle(out, i[0], i[2], i[1]);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t across = cut->neighbour[3 * t + k];
        uint32_t next = (k + 1) % 3;
        if (across == NONE || cut->piece[across] != piece) {
            add_triangle(out, o[k], i[k], i[next]);
            add_triangle(out, o[k], i[next], o[next]);
        }
    }
}

static void measure(struct shards *shards)
{
    const struct surface *surface = &shards->surface;
    uint32_t *vertices = bench_scene_alloc(shards->count, sizeof *vertices);
    memset(vertices, 0, shards->count * sizeof *vertices);
    memset(shards->centre, 0, shards->count * sizeof *shards->centre);
    memset(shards->radius, 0, shards->count * sizeof *shards->radius);
    for (uint32_t v = 0; v < surface->vertex_count; v++) {
        uint32_t piece = shards->piece_of[v];
        vertices[piece]++;
        for (int k = 0; k < 3; k++) {
            shards->centre[piece][k] += surface->x[v][k];
        }
    }
    for (uint32_t i = 0; i < shards->count; i++) {
        for (int k = 0; k < 3; k++) {
            shards->centre[i][k] /= vertices[i];
        }
    }
    for (uint32_t v = 0; v < surface->vertex_count; v++) {
        uint32_t piece = shards->piece_of[v];
        for (int k = 0; k < 3; k++) {
            double way = surface->x[v][k] - shards->centre[piece][k];
            shards->radius[piece] += way * way / vertices[piece];
        }
    }
    for (uint32_t i = 0; i < shards->count; i++) {
        shards->radius[i] = sqrt(shards->radius[i]);
    }
    free(vertices);
}

/* Each vertex by its own amount, as broken sides are rough: none lies in the plane of its
 * neighbours any more. */
static void shrink_pieces(struct shards *shards, double shrink, struct prng *prng)
{
    for (uint32_t v = 0; v < shards->surface.vertex_count; v++) {
        const double *centre = shards->centre[shards->piece_of[v]];
        double *x = shards->surface.x[v];
        double size = prng_between(prng, shrink, 0.5 + 0.5 * shrink);
        for (int k = 0; k < 3; k++) {
            x[k] = centre[k] + size * (x[k] - centre[k]);
        }
    }
}

static void allocate(struct shards *shards, struct cut *cut, uint32_t count)
{
    uint32_t vertices = cut->whole->vertex_count;
    uint32_t triangles = cut->whole->triangle_count;
    /* At most: every triangle with vertices and walls of its own. */
    size_t sides = cut->inner ? 2 : 1;
    cut->neighbour = bench_scene_alloc(3 * triangles, sizeof *cut->neighbour);
    cut->piece = bench_scene_alloc(triangles, sizeof *cut->piece);
    cut->order = bench_scene_alloc(triangles, sizeof *cut->order);
    for (int i = 0; i < 2; i++) {
        cut->local[i] = bench_scene_alloc(vertices, sizeof *cut->local[i]);
        memset(cut->local[i], 0xff, vertices * sizeof *cut->local[i]);
    }
    shards->count = count;
    shards->surface.triangles = bench_scene_alloc(
        (cut->inner ? 8u : 1u) * (size_t)triangles, sizeof *shards->surface.triangles);
    shards->surface.x = bench_scene_alloc(sides * 3 * triangles, sizeof(double[3]));
    shards->piece_of = bench_scene_alloc(sides * 3 * triangles, sizeof(uint32_t));
    shards->vertex_of = bench_scene_alloc(sides * 3 * triangles, sizeof(uint32_t));
    shards->centre = bench_scene_alloc(count, sizeof *shards->centre);
    shards->radius = bench_scene_alloc(count, sizeof *shards->radius);
}

void shards_init(struct shards *shards, const struct surface *whole, uint32_t count,
                 const double (*inner)[3], double shrink, struct prng *prng)
{
    struct cut cut = {.whole = whole, .inner = inner};
    memset(shards, 0, sizeof *shards);
    allocate(shards, &cut, count);
    find_neighbours(&cut);
    grow_pieces(&cut, count, prng);
    sort_by_piece(&cut, count);
    for (uint32_t i = 0; i < whole->triangle_count; i++) {
        copy_triangle(shards, &cut, cut.order[i]);
    }
    measure(shards);
    shrink_pieces(shards, shrink, prng);
    free(cut.neighbour);
    free(cut.piece);
    free(cut.order);
    free(cut.local[0]);
    free(cut.local[1]);
}

void shards_deinit(struct shards *shards)
{
    surface_deinit(&shards->surface);
    free(shards->piece_of);
    free(shards->vertex_of);
    free(shards->centre);
    free(shards->radius);
    memset(shards, 0, sizeof *shards);
}
