/* oracle_touching.c - features that touch, at t = 0 and at one time soon after. */
#include "oracle_touching.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Whole numbers: coordinates at both times, each time with a scale of its own. */
struct spot {
    uint32_t v;
    const struct oracle_surface *surface;
    mpz_t at[2][3]; /* t = 0, soon */
};

struct spots {
    struct spot *items;
    uint32_t count, capacity;
};

struct scene {
    const struct oracle_surface *side[2];
    struct spots spots;
    int low;  /* exponent of the last bit of all coordinates */
    int high; /* above that of the first */
};

enum { NOW, SOON };

/* ---- numbers ----------------------------------------------------------------------- */

static struct spot *spot_of(struct scene *scene, const struct oracle_surface *surface,
                            uint32_t v)
{
    struct spots *spots = &scene->spots;
    for (uint32_t i = 0; i < spots->count; i++) {
        if (spots->items[i].v == v && spots->items[i].surface == surface) {
            return &spots->items[i];
        }
    }
    assert(spots->count < spots->capacity);
    struct spot *spot = &spots->items[spots->count++];
    spot->v = v;
    spot->surface = surface;
    for (int i = 0; i < 6; i++) {
        mpz_init(spot->at[i / 3][i % 3]);
    }
    return spot;
}

static void measure(struct scene *scene, double x)
{
    int exponent;
    if (x != 0) {
        frexp(x, &exponent);
        scene->low = exponent - 53 < scene->low ? exponent - 53 : scene->low;
        scene->high = exponent > scene->high ? exponent : scene->high;
    }
}

static void scale(mpz_t out, double x, int low)
{
    mpq_t value;
    mpq_init(value);
    mpq_set_d(value, x);
    if (low < 0) {
        mpq_mul_2exp(value, value, (mp_bitcnt_t)-low);
    } else {
        mpq_div_2exp(value, value, (mp_bitcnt_t)low);
    }
    assert(mpz_cmp_ui(mpq_denref(value), 1) == 0);
    mpz_set(out, mpq_numref(value));
    mpq_clear(value);
}

/* Bits of the time: what is asked below are signs of polynomials in time whose
 * coefficients are whole numbers, of degree 6 at most in coordinates below 2^b. One that
 * is not 0 has no root sooner than 1 / (1 + the greatest of them), past 2^-(6 b + 40). */
static unsigned long bits_of(const struct scene *scene)
{
    int b = scene->high > scene->low ? scene->high - scene->low : 1;
    return 6ul * (unsigned long)b + 40;
}

/* x(soon) times 2^bits: x0 2^bits + (x1 - x0). */
static void place(struct scene *scene)
{
    mpz_t x1;
    mpz_init(x1);
    scene->low = INT_MAX;
    scene->high = INT_MIN;
    for (uint32_t i = 0; i < scene->spots.count; i++) {
        const struct spot *spot = &scene->spots.items[i];
        for (int k = 0; k < 3; k++) {
            measure(scene, spot->surface->x[0][spot->v][k]);
            measure(scene, spot->surface->x[1][spot->v][k]);
        }
    }
    scene->low = scene->low == INT_MAX ? 0 : scene->low;
    for (uint32_t i = 0; i < scene->spots.count; i++) {
        struct spot *spot = &scene->spots.items[i];
        for (int k = 0; k < 3; k++) {
            scale(spot->at[NOW][k], spot->surface->x[0][spot->v][k], scene->low);
            scale(x1, spot->surface->x[1][spot->v][k], scene->low);
            mpz_sub(x1, x1, spot->at[NOW][k]);
            mpz_mul_2exp(spot->at[SOON][k], spot->at[NOW][k], bits_of(scene));
            mpz_add(spot->at[SOON][k], spot->at[SOON][k], x1);
        }
    }
    mpz_clear(x1);
}

/* The neighbours of the features, and these: all that is asked about. */
static void begin(struct scene *scene, const struct oracle_surface *a,
                  const struct oracle_surface *b, int count_a, const uint32_t v[4])
{
    *scene = (struct scene){.side = {a, b}};
    scene->spots.capacity = 3 * (a->leaf_count + b->leaf_count) + 8;
    scene->spots.items = calloc(scene->spots.capacity, sizeof *scene->spots.items);
    assert(scene->spots.items);
    for (int i = 0; i < 4; i++) {
        const struct oracle_surface *own = i < count_a ? a : b;
        (void)spot_of(scene, own, v[i]);
        for (uint32_t f = 0; f < own->leaf_count; f++) {
            const uint32_t *c = own->leaves[f];
            for (int k = 0; k < 3 && (c[0] == v[i] || c[1] == v[i] || c[2] == v[i]);
                 k++) {
                (void)spot_of(scene, own, c[k]);
            }
        }
    }
    place(scene);
}

static void end(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->spots.count; i++) {
        for (int k = 0; k < 6; k++) {
            mpz_clear(scene->spots.items[i].at[k / 3][k % 3]);
        }
    }
    free(scene->spots.items);
}

/* ---- predicates, at one time ------------------------------------------------------- */

typedef struct {
    mpz_t c[3];
} vector;

static void vector_init(vector *v)
{
    mpz_inits(v->c[0], v->c[1], v->c[2], NULL);
}

static void vector_clear(vector *v)
{
    mpz_clears(v->c[0], v->c[1], v->c[2], NULL);
}

static void subtract(vector *out, const struct spot *a, const struct spot *b, int when)
{
    for (int k = 0; k < 3; k++) {
        mpz_sub(out->c[k], a->at[when][k], b->at[when][k]);
    }
}

static void cross(vector *out, const vector *a, const vector *b)
{
    for (int k = 0; k < 3; k++) {
        mpz_mul(out->c[k], a->c[(k + 1) % 3], b->c[(k + 2) % 3]);
        mpz_submul(out->c[k], a->c[(k + 2) % 3], b->c[(k + 1) % 3]);
    }
}

static int dot_sign(const vector *a, const vector *b)
{
    mpz_t sum;
    mpz_init(sum);
    for (int k = 0; k < 3; k++) {
        mpz_addmul(sum, a->c[k], b->c[k]);
    }
    int sign = mpz_sgn(sum);
    mpz_clear(sum);
    return sign;
}

static bool is_zero(const vector *a)
{
    return mpz_sgn(a->c[0]) == 0 && mpz_sgn(a->c[1]) == 0 && mpz_sgn(a->c[2]) == 0;
}

/* n = (b - a) x (d - c). */
static void turn(vector *n, const struct spot *a, const struct spot *b,
                 const struct spot *c, const struct spot *d, int when)
{
    vector u, w;
    vector_init(&u);
    vector_init(&w);
    subtract(&u, b, a, when);
    subtract(&w, d, c, when);
    cross(n, &u, &w);
    vector_clear(&u);
    vector_clear(&w);
}

/* Return the sign of n along (b - a). */
static int sign_along(const vector *n, const struct spot *a, const struct spot *b,
                      int when)
{
    vector along;
    vector_init(&along);
    subtract(&along, b, a, when);
    int sign = dot_sign(n, &along);
    vector_clear(&along);
    return sign;
}

static int side(struct spot *const f[3], const struct spot *p, int when)
{
    vector n;
    vector_init(&n);
    turn(&n, f[0], f[1], f[0], f[2], when);
    int sign = sign_along(&n, f[0], p, when);
    vector_clear(&n);
    return sign;
}

static bool is_line(struct spot *const f[3])
{
    vector n;
    vector_init(&n);
    turn(&n, f[0], f[1], f[0], f[2], NOW);
    bool is = is_zero(&n);
    vector_clear(&n);
    return is;
}

/* Return whether the inside of the edge meets the inside of the face across its plane. */
static bool pierces(const struct spot *p, const struct spot *q, struct spot *const f[3])
{
    int ends = side(f, p, SOON) * side(f, q, SOON);
    int turns[3];
    vector n;
    vector_init(&n);
    for (int k = 0; k < 3; k++) {
        turn(&n, p, q, p, f[k], SOON);
        turns[k] = sign_along(&n, p, f[(k + 1) % 3], SOON);
    }
    vector_clear(&n);
    return ends < 0 && turns[0] != 0 && turns[0] == turns[1] && turns[1] == turns[2];
}

/* Return whether point p, in the plane of f, is in it, with its sides. */
static bool is_in(struct spot *const f[3], const struct spot *p, int when)
{
    vector n, m;
    bool is = true;
    vector_init(&n);
    vector_init(&m);
    turn(&n, f[0], f[1], f[0], f[2], when);
    for (int k = 0; k < 3; k++) {
        turn(&m, f[k], f[(k + 1) % 3], f[k], p, when);
        is = is && dot_sign(&m, &n) >= 0;
    }
    vector_clear(&n);
    vector_clear(&m);
    return is;
}

/* Return whether p is on the closed segment, soon. */
static bool is_on(const struct spot *p, const struct spot *a, const struct spot *b)
{
    vector u, w, n;
    vector_init(&u);
    vector_init(&w);
    vector_init(&n);
    subtract(&u, p, a, SOON);
    subtract(&w, p, b, SOON);
    cross(&n, &u, &w);
    bool is = is_zero(&n) && dot_sign(&u, &w) <= 0;
    vector_clear(&u);
    vector_clear(&w);
    vector_clear(&n);
    return is;
}

/* Return whether faces in one plane at t = 0 have more than their sides in common: no
 * side of either has the other on its outside. */
static bool overlap(struct spot *const f[3], struct spot *const g[3], bool *are_facing)
{
    vector nf, ng, m;
    bool do_overlap = true;
    vector_init(&nf);
    vector_init(&ng);
    vector_init(&m);
    turn(&nf, f[0], f[1], f[0], f[2], NOW);
    turn(&ng, g[0], g[1], g[0], g[2], NOW);
    for (int i = 0; i < 6; i++) {
        struct spot *const *own = i < 3 ? f : g;
        struct spot *const *other = i < 3 ? g : f;
        bool separates = true;
        for (int k = 0; k < 3; k++) {
            turn(&m, own[i % 3], own[(i + 1) % 3], own[i % 3], other[k], NOW);
            separates = separates && dot_sign(&m, i < 3 ? &nf : &ng) <= 0;
        }
        do_overlap = do_overlap && !separates;
    }
    *are_facing = dot_sign(&nf, &ng) < 0;
    vector_clear(&nf);
    vector_clear(&ng);
    vector_clear(&m);
    return do_overlap;
}

/* ---- what is around features ------------------------------------------------------- */

static void corners_of(struct scene *scene, int which, uint32_t leaf, struct spot *f[3])
{
    for (int k = 0; k < 3; k++) {
        const struct oracle_surface *surface = scene->side[which];
        f[k] = spot_of(scene, surface, surface->leaves[leaf][k]);
    }
}

static bool is_flat(struct spot *const f[3], struct spot *const g[3])
{
    return side(f, g[0], NOW) == 0 && side(f, g[1], NOW) == 0 && side(f, g[2], NOW) == 0;
}

/* The leaves of a surface that have each of so many vertices; *leaf goes on. */
static bool next_leaf(struct scene *scene, int which, struct spot *const *all,
                      uint32_t count, uint32_t *leaf, struct spot *g[3])
{
    for (; *leaf < scene->side[which]->leaf_count; (*leaf)++) {
        const uint32_t *c = scene->side[which]->leaves[*leaf];
        bool has_all = true;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t v = all[i]->v;
            has_all = has_all && (c[0] == v || c[1] == v || c[2] == v);
        }
        if (has_all) {
            corners_of(scene, which, (*leaf)++, g);
            return true;
        }
    }
    return false;
}

/* Return whether p, on the face f with its sides, slides there: the plane of f, or of a
 * face at p or at the side or corner of f where it is, has all leaves at p on one side
 * and those at the other place on the other. */
static bool slides(struct scene *scene, struct spot *p, struct spot *const f[3])
{
    struct spot *place[2][2] = {{p, p}, {NULL, NULL}};
    uint32_t counts[2] = {1, 0};
    for (int k = 0; k < 3 && counts[1] != 1; k++) {
        if (is_on(p, f[k], f[(k + 1) % 3])) {
            bool is_corner = is_on(p, f[k], f[(k + 2) % 3]);
            place[1][0] = f[k];
            place[1][1] = f[(k + 1) % 3];
            counts[1] = is_corner ? 1 : 2;
        }
    }
    for (int from = -1; from < (counts[1] == 0 ? 0 : 2); from++) { /* -1: f itself */
        struct spot *plane[3] = {f[0], f[1], f[2]};
        uint32_t leaf = 0;
        while (from < 0 ? leaf == 0
                        : counts[from] > 0 && next_leaf(scene, from, place[from],
                                                        counts[from], &leaf, plane)) {
            bool sides[2][2] = {{false, false}, {false, false}};
            struct spot *g[3];
            bool is_face = from < 0 || leaf <= scene->side[from]->face_count;
            leaf += from < 0;
            for (int i = 0; i < 2 && is_face && !is_line(plane); i++) {
                uint32_t at = 0;
                while (counts[i] > 0 &&
                       next_leaf(scene, i, place[i], counts[i], &at, g)) {
                    for (int k = 0; k < 3; k++) {
                        int beside = side(plane, g[k], SOON);
                        sides[i][0] = sides[i][0] || beside < 0;
                        sides[i][1] = sides[i][1] || beside > 0;
                    }
                }
            }
            if (is_face && !is_line(plane) &&
                ((!sides[0][0] && !sides[1][1]) || (!sides[0][1] && !sides[1][0]))) {
                return true;
            }
        }
    }
    return false;
}

static enum oracle_fate fate_of_vertex(struct scene *scene, struct spot *p,
                                       struct spot *const f[3])
{
    bool is_open = false;
    int own = side(f, p, SOON);
    if (is_line(f)) {
        return ORACLE_ENTERS;
    }
    for (uint32_t i = 0; i < scene->side[0]->leaf_count; i++) {
        struct spot *g[3];
        bool is_face = i < scene->side[0]->face_count;
        const uint32_t *c = scene->side[0]->leaves[i];
        if (c[0] != p->v && c[1] != p->v && c[2] != p->v) {
            continue;
        }
        corners_of(scene, 0, i, g);
        is_open = is_open || (!is_face && g[0] == g[1]);
        for (int k = 0; k < 3; k++) {
            if (g[k] == p) {
                continue;
            }
            if (pierces(p, g[k], f)) {
                return ORACLE_ENTERS;
            }
            is_open = is_open || (!is_face && side(f, g[k], NOW) == 0);
        }
        bool are_facing;
        if (is_face && !is_line(g) && is_flat(f, g) && overlap(f, g, &are_facing)) {
            is_open = is_open || !are_facing || own < 0;
        }
        is_open = is_open || (is_face && is_line(g) && is_flat(f, g));
    }
    if (own == 0 && is_in(f, p, SOON)) {
        return slides(scene, p, f) ? ORACLE_SLIDES : ORACLE_ENTERS;
    }
    return is_open ? ORACLE_ENTERS : ORACLE_LEAVES;
}

/* The faces at an edge, one for each call; *leaf goes on. */
static bool next_face(struct scene *scene, int which, struct spot *const edge[2],
                      uint32_t *leaf, struct spot *f[3])
{
    for (; *leaf < scene->side[which]->face_count; (*leaf)++) {
        const uint32_t *c = scene->side[which]->leaves[*leaf];
        int ends[2] = {0, 0};
        for (int k = 0; k < 3; k++) {
            ends[0] += c[k] == edge[0]->v;
            ends[1] += c[k] == edge[1]->v;
        }
        if (ends[0] == 1 && ends[1] == 1) {
            corners_of(scene, which, (*leaf)++, f);
            return true;
        }
    }
    return false;
}

static const struct spot *third_of(struct spot *const f[3], struct spot *const edge[2])
{
    for (int k = 0; k < 2; k++) {
        if (f[k] != edge[0] && f[k] != edge[1]) {
            return f[k];
        }
    }
    return f[2];
}

/* Where edges cross just after: not, inside of both, or in an end or along a line. */
enum place { APART, INSIDE, ENDS };

static enum place place_of(struct spot *const e[2][2])
{
    vector n, m;
    vector_init(&n);
    vector_init(&m);
    turn(&n, e[0][0], e[0][1], e[1][0], e[1][1], SOON);
    int gap = sign_along(&n, e[0][0], e[1][0], SOON);
    bool is_parallel = is_zero(&n);
    enum place place = APART;
    for (int i = 0; i < 4; i++) {
        if (is_on(e[i / 2][i % 2], e[1 - i / 2][0], e[1 - i / 2][1])) {
            place = ENDS;
        }
    }
    if (gap == 0 && !is_parallel && place == APART) {
        /* The ends of each are on other sides of the other one. */
        bool do_cross = true;
        for (int i = 0; i < 2; i++) {
            int sides[2];
            for (int k = 0; k < 2; k++) {
                turn(&m, e[i][0], e[i][1], e[i][0], e[1 - i][k], SOON);
                sides[k] = dot_sign(&m, &n);
            }
            do_cross = do_cross && sides[0] * sides[1] < 0;
        }
        place = do_cross ? INSIDE : APART;
    }
    vector_clear(&n);
    vector_clear(&m);
    return place;
}

/* Return whether face f at edge 0 and g at edge 1, which lie in each other and show each
 * other their fronts, part. */
static bool do_part(struct spot *const e[2][2], struct spot *const f[3],
                    struct spot *const g[3], int gap)
{
    vector n, m;
    bool do_part = true;
    vector_init(&n);
    vector_init(&m);
    turn(&n, e[0][0], e[0][1], e[1][0], e[1][1], NOW);
    turn(&m, g[0], g[1], g[0], g[2], NOW);
    if (!is_zero(&n)) {
        do_part = gap * dot_sign(&n, &m) <= 0;
    }
    for (int k = 0; k < 2 && is_zero(&n); k++) {
        do_part = do_part && side(g, e[0][k], SOON) >= 0 && side(f, e[1][k], SOON) >= 0;
    }
    vector_clear(&n);
    vector_clear(&m);
    return do_part;
}

static bool are_ambiguous(struct scene *scene, struct spot *const e[2][2], int gap,
                          const bool has_front[2], const bool is_in_plane[2])
{
    struct spot *f[3], *g[3];
    bool are = (!has_front[0] && !has_front[1]) || (!has_front[0] && is_in_plane[1]) ||
               (!has_front[1] && is_in_plane[0]);
    for (uint32_t i = 0; !are && next_face(scene, 0, e[0], &i, f);) {
        for (uint32_t k = 0; !are && next_face(scene, 1, e[1], &k, g);) {
            bool are_facing;
            are = !is_line(f) && !is_line(g) && is_flat(f, g) &&
                  overlap(f, g, &are_facing) && (!are_facing || !do_part(e, f, g, gap));
        }
    }
    return are;
}

static enum oracle_fate fate_of_edges(struct scene *scene, struct spot *const e[2][2])
{
    bool above[2] = {false, false}, below[2] = {false, false};
    bool is_in_plane[2] = {false, false}, has_front[2] = {false, false};
    int faces[2] = {0, 0};
    vector n;
    vector_init(&n);
    turn(&n, e[0][0], e[0][1], e[1][0], e[1][1], SOON);
    int gap = sign_along(&n, e[0][0], e[1][0], SOON);
    bool enters = false;
    for (int i = 0; i < 2; i++) {
        struct spot *f[3];
        enters = enters || (mpz_cmp(e[i][0]->at[NOW][0], e[i][1]->at[NOW][0]) == 0 &&
                            mpz_cmp(e[i][0]->at[NOW][1], e[i][1]->at[NOW][1]) == 0 &&
                            mpz_cmp(e[i][0]->at[NOW][2], e[i][1]->at[NOW][2]) == 0);
        for (uint32_t k = 0; next_face(scene, i, e[i], &k, f);) {
            const struct spot *third = third_of(f, e[i]);
            int beside = sign_along(&n, e[i][0], third, SOON);
            faces[i]++;
            has_front[i] = has_front[i] || !is_line(f);
            above[i] = above[i] || beside > 0;
            below[i] = below[i] || beside < 0;
            is_in_plane[i] =
                is_in_plane[i] || (!is_line(f) && side(f, e[1 - i][0], NOW) == 0 &&
                                   side(f, e[1 - i][1], NOW) == 0);
            enters = enters || pierces(e[1 - i][0], e[1 - i][1], f);
        }
    }
    vector_clear(&n);
    enum place place = gap == 0 ? place_of(e) : APART;
    if (!enters && place == INSIDE) {
        enters = (below[0] || above[1]) && (above[0] || below[1]);
    } else if (!enters && place == ENDS) {
        enters = (faces[0] == 0) != (faces[1] == 0);
    } else if (!enters) {
        return are_ambiguous(scene, e, gap, has_front, is_in_plane) ? ORACLE_ENTERS
                                                                    : ORACLE_LEAVES;
    }
    return enters ? ORACLE_ENTERS : ORACLE_SLIDES;
}

enum oracle_fate oracle_touching_fate(const struct oracle_surface *a,
                                      const struct oracle_surface *b, int count_a,
                                      const uint32_t v[4])
{
    struct scene scene;
    struct spot *p[4];
    begin(&scene, a, b, count_a, v);
    for (int i = 0; i < 4; i++) {
        p[i] = spot_of(&scene, i < count_a ? a : b, v[i]);
    }
    enum oracle_fate fate;
    if (count_a == 1) {
        fate = fate_of_vertex(&scene, p[0], (struct spot *const[3]){p[1], p[2], p[3]});
    } else {
        fate =
            fate_of_edges(&scene, (struct spot *const[2][2]){{p[0], p[1]}, {p[2], p[3]}});
    }
    end(&scene);
    return fate;
}

void oracle_touching_soon(const struct oracle_surface *a, const struct oracle_surface *b,
                          int count_a, const uint32_t v[4], mpq_t soon)
{
    struct scene scene;
    begin(&scene, a, b, count_a, v);
    mpq_set_ui(soon, 1, 1);
    mpq_div_2exp(soon, soon, bits_of(&scene));
    end(&scene);
}
