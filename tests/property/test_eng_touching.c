/* test_eng_touching.c - what becomes of what touches at t = 0, against exact arithmetic
 * that looks at one time soon after.
 *
 * Coordinates are small whole numbers, so that most scenes touch, and much of what
 * touches is in one plane, parallel, or in a corner.
 *
 * PCCD_TOUCHING_PAIRS: as many pairs that touch are tried, at least; 1e6 take half an
 * hour.
 */
#include "cases.h"
#include "eng_kit.h"
#include "eng_way.h"
#include "oracle.h"
#include "oracle_touching.h"
#include "scene.h"

#define VERTICES_MAX 12u
#define LEAVES_MAX   12u
#define BODIES_MAX   2u
#define RECORDS_MAX  4096u

/* Times at which nothing of such a scene happens: coordinates are below 2^4, and a
 * polynomial of degree 3 in them has no root in (0, 2^-20]. */
#define SOON 0x1p-20

struct body {
    uint32_t vertex_count, leaf_count, face_count;
    double x[2][VERTICES_MAX][3];
    uint32_t leaves[LEAVES_MAX][3]; /* faces, then free edges, then free points */
    uint32_t edges[3 * LEAVES_MAX][2];
    uint32_t edge_count;
};

struct trial {
    uint64_t seed;
    struct prng prng;
    struct body body[BODIES_MAX];
    uint32_t body_count;
    struct eng_scene *scene;
    uint32_t idx[BODIES_MAX];
};

static struct {
    uint64_t pairs, fates[3], returned, left, settled, slid, stuck;
} sums;

/* ---- scenes ------------------------------------------------------------------------ */

static double draw(struct trial *trial, uint32_t below)
{
    return prng_u32(&trial->prng, below);
}

static void draw_vertices(struct trial *trial, struct body *body)
{
    uint32_t flat = prng_u32(&trial->prng, 5);
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        for (uint32_t k = 0; k < 3; k++) {
            body->x[0][v][k] = k == flat ? 1 : draw(trial, 4);
        }
    }
}

/* It stands, moves as a whole, or some of it or all goes anywhere. */
static void draw_motion(struct trial *trial, struct body *body)
{
    uint32_t way = prng_u32(&trial->prng, 5);
    double by[3] = {draw(trial, 3) - 1, draw(trial, 3) - 1, draw(trial, 3) - 1};
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        bool moves = way > 2 || prng_u32(&trial->prng, 2) == 0;
        for (uint32_t k = 0; k < 3; k++) {
            double x = body->x[0][v][k];
            double far = draw(trial, 4);
            body->x[1][v][k] = way == 0 ? x : way == 1 ? x + by[k] : moves ? far : x;
            if (way == 4) {
                body->x[1][v][k] = x + (double)(k == 2) * (draw(trial, 3) - 1);
            }
        }
    }
}

static void add_leaf(struct body *body, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *leaf = body->leaves[body->leaf_count++];
    leaf[0] = a;
    leaf[1] = b;
    leaf[2] = c;
}

static bool has_edge(const struct body *body, uint32_t a, uint32_t b)
{
    for (uint32_t i = 0; i < body->leaf_count; i++) {
        const uint32_t *c = body->leaves[i];
        if ((c[0] == a || c[1] == a || c[2] == a) &&
            (c[0] == b || c[1] == b || c[2] == b)) {
            return true;
        }
    }
    return false;
}

static bool has_vertex(const struct body *body, uint32_t v)
{
    return has_edge(body, v, v);
}

/* A tetrahedron, a fan that may be closed, rods, a soup. */
static void draw_body(struct trial *trial, struct body *body)
{
    struct prng *prng = &trial->prng;
    memset(body, 0, sizeof *body);
    uint32_t shape = prng_u32(prng, 5);
    if (shape == 0) {
        body->vertex_count = 4;
        add_leaf(body, 0, 2, 1);
        add_leaf(body, 0, 1, 3);
        add_leaf(body, 1, 2, 3);
        add_leaf(body, 2, 0, 3);
    } else if (shape == 1 || shape == 2) {
        uint32_t n = 3 + prng_u32(prng, 4);
        body->vertex_count = n + 1;
        for (uint32_t i = 0; i + (shape == 1) < n; i++) {
            add_leaf(body, 0, 1 + i, 1 + (i + 1) % n);
        }
    } else {
        body->vertex_count = 4 + prng_u32(prng, 4);
        uint32_t faces = shape == 3 ? prng_u32(prng, 2) : 1 + prng_u32(prng, 3);
        for (uint32_t i = 0; i < faces; i++) {
            uint32_t a = prng_u32(prng, body->vertex_count);
            uint32_t b =
                (a + 1 + prng_u32(prng, body->vertex_count - 1)) % body->vertex_count;
            uint32_t c = prng_u32(prng, body->vertex_count);
            if (c != a && c != b) {
                add_leaf(body, a, b, c);
            }
        }
    }
    body->face_count = body->leaf_count;
    for (uint32_t v = 1; v < body->vertex_count && shape == 3; v++) {
        if (prng_u32(prng, 3) > 0 && !has_edge(body, v - 1, v)) {
            add_leaf(body, v - 1, v, v);
        }
    }
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        if (!has_vertex(body, v)) {
            add_leaf(body, v, v, v);
        }
    }
    draw_vertices(trial, body);
    draw_motion(trial, body);
}

static struct eng_mesh *mesh_of(struct body *body)
{
    struct eng_mesh_counts counts = {.vertices = body->vertex_count,
                                     .triangles = body->face_count};
    uint32_t edges[LEAVES_MAX][2];
    uint32_t points[LEAVES_MAX];
    for (uint32_t i = body->face_count; i < body->leaf_count; i++) {
        const uint32_t *leaf = body->leaves[i];
        if (leaf[0] != leaf[1]) {
            edges[counts.edges][0] = leaf[0];
            edges[counts.edges++][1] = leaf[1];
        } else {
            points[counts.points++] = leaf[0];
        }
    }
    struct eng_mesh *mesh = kit_mesh_of(
        &(struct kit_shape){counts, body->x[0], body->leaves, edges, points, NULL});
    struct eng_mesh_info info;
    eng_mesh_get_info(mesh, &info);
    body->edge_count = info.edge_count;
    memcpy(body->edges, eng_mesh_edges(mesh), info.edge_count * sizeof *body->edges);
    return mesh;
}

static void begin(struct trial *trial, uint64_t seed)
{
    trial->seed = seed;
    trial->prng = (struct prng){seed};
    trial->body_count = 1 + (prng_u32(&trial->prng, 4) > 0);
    trial->scene = kit_scene();
    for (uint32_t i = 0; i < trial->body_count; i++) {
        draw_body(trial, &trial->body[i]);
        trial->idx[i] = kit_add(trial->scene, mesh_of(&trial->body[i]), i + 1);
    }
}

static struct eng_step_result ask(struct trial *trial, enum pccd_touching touching,
                                  enum pccd_mode mode)
{
    struct eng_question question = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    way_draw(&trial->prng, 2, &question);
    question.touching = touching;
    question.mode = mode;
    eng_stage_begin(trial->scene);
    for (uint32_t i = 0; i < trial->body_count; i++) {
        const struct body *body = &trial->body[i];
        assert_ok(eng_stage_x0x1(trial->scene, trial->idx[i], PCCD_FORMAT_F64, 0,
                                 body->vertex_count, body->x[0], body->x[1]));
    }
    assert_ok(eng_step(trial->scene, &question, &result));
    assert_int_equal(result.incomplete, PCCD_COMPLETE);
    return result;
}

/* ---- pairs ------------------------------------------------------------------------- */

/* The vertices of a record, and its points at two times. */
struct pair {
    const struct body *body[2];
    int count_a;
    uint32_t v[4];
    double p[8][3];
};

static void load(const struct pair *pair, double from, double to, double p[8][3])
{
    for (int i = 0; i < 8; i++) {
        const struct body *body = pair->body[i % 4 >= pair->count_a];
        double t = i < 4 ? from : to;
        for (int k = 0; k < 3; k++) { /* exact */
            double x0 = body->x[0][pair->v[i % 4]][k];
            p[i][k] = x0 + t * (body->x[1][pair->v[i % 4]][k] - x0);
        }
    }
}

static struct pair pair_of(const struct trial *trial, const struct pccd_contact *record)
{
    struct pair pair = {
        .body = {&trial->body[record->object_a - 1], &trial->body[record->object_b - 1]},
        .count_a = record->kind == PCCD_VF ? 1 : 2};
    if (record->kind == PCCD_VF) {
        pair.v[0] = record->feature_a;
        memcpy(pair.v + 1, pair.body[1]->leaves[record->feature_b], 3 * sizeof *pair.v);
    } else {
        memcpy(pair.v, pair.body[0]->edges[record->feature_a], 2 * sizeof *pair.v);
        memcpy(pair.v + 2, pair.body[1]->edges[record->feature_b], 2 * sizeof *pair.v);
    }
    load(&pair, 0, 1, pair.p);
    return pair;
}

static struct oracle_surface surface_of(const struct body *body)
{
    return (struct oracle_surface){
        {(const double(*)[3])body->x[0], (const double(*)[3])body->x[1]},
        (const uint32_t(*)[3])body->leaves,
        body->leaf_count,
        body->face_count};
}

static uint32_t fate_of(const struct pair *pair)
{
    static const uint32_t flags[3] = {[ORACLE_ENTERS] = PCCD_ENTERS,
                                      [ORACLE_SLIDES] = PCCD_SLIDES,
                                      [ORACLE_LEAVES] = PCCD_LEAVES};
    const struct oracle_surface a = surface_of(pair->body[0]);
    const struct oracle_surface b = surface_of(pair->body[1]);
    enum oracle_fate fate = oracle_touching_fate(
        &a, pair->body[0] == pair->body[1] ? &a : &b, pair->count_a, pair->v);
    sums.fates[fate]++;
    return flags[fate];
}

static void fail_trial(const struct trial *trial, const struct pccd_contact *record,
                       const char *what)
{
    for (uint32_t i = 0; i < trial->body_count; i++) {
        const struct body *body = &trial->body[i];
        for (uint32_t v = 0; v < body->vertex_count; v++) {
            const double *x0 = body->x[0][v];
            const double *x1 = body->x[1][v];
            printf("# %u: vertex %u (%g %g %g) to (%g %g %g)\n", i + 1, v, x0[0], x0[1],
                   x0[2], x1[0], x1[1], x1[2]);
        }
        for (uint32_t l = 0; l < body->leaf_count; l++) {
            printf("# %u: leaf %u %u %u\n", i + 1, body->leaves[l][0], body->leaves[l][1],
                   body->leaves[l][2]);
        }
    }
    fail_msg("seed %llu: %s of kind %u, %u.%u and %u.%u: flags %u, toi %.17g",
             (unsigned long long)trial->seed, what, record->kind, record->object_a,
             record->feature_a, record->object_b, record->feature_b, record->flags,
             record->toi);
}

/* ---- checks ------------------------------------------------------------------------ */

static bool is_same_pair(const struct pccd_contact *a, const struct pccd_contact *b)
{
    return a->kind == b->kind && a->object_a == b->object_a &&
           a->feature_a == b->feature_a && a->object_b == b->object_b &&
           a->feature_b == b->feature_b;
}

/* The next contact of a pair that does not enter, `found` (NULL: none is said), is that
 * of the motion from SOON on. What slides may be said to meet while it touches. */
static void check_return(const struct trial *trial, const struct pccd_contact *told,
                         const struct pccd_contact *found)
{
    const struct pair pair = pair_of(trial, told);
    double p[8][3];
    enum oracle_kind kind = told->kind == PCCD_VF ? ORACLE_VF : ORACLE_EE;
    load(&pair, SOON, 1, p);
    struct oracle_first *first = oracle_first_new(kind, (const double(*)[3])p);
    bool slides = (told->flags & PCCD_SLIDES) != 0;
    if (slides && !found) { /* then it touches all the time */
        for (int i = 1; i <= 16; i++) {
            load(&pair, i / 16.0, 1, p);
            if (!oracle_touching_at(kind, (const double(*)[3])p, 0)) {
                fail_trial(trial, told, "a return is missed");
            }
        }
    } else if (slides) {
        load(&pair, 0, found->toi, p);
        if (!oracle_hits(kind, (const double(*)[3])p) || found->toi_hi < found->toi) {
            fail_trial(trial, found, "a return is wrong");
        }
    } else if ((first != NULL) != (found != NULL)) {
        fail_trial(trial, told, found ? "a return is invented" : "a return is missed");
    } else if (found) {
        double lo = (found->toi - SOON) / (1 - SOON) - 0x1p-48;
        double hi = (found->toi_hi - SOON) / (1 - SOON) + 0x1p-48;
        if (oracle_first_compare(first, lo) < 0 || oracle_first_compare(first, hi) > 0 ||
            found->toi_hi - found->toi > 1e-6) {
            fail_trial(trial, found, "a return is at another time");
        }
        sums.returned++;
    }
    oracle_first_free(first);
}

/* Return whether an edge of a body passes strictly through a face at `t`. */
static int orient(const double *a, const double *b, const double *c, const double *d)
{
    __extension__ typedef __int128 wide;
    wide u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) { /* whole numbers */
        u[k] = (wide)((b[k] - a[k]) / (SOON / 128));
        v[k] = (wide)((c[k] - a[k]) / (SOON / 128));
        w[k] = (wide)((d[k] - a[k]) / (SOON / 128));
    }
    wide det = u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
               u[2] * (v[0] * w[1] - v[1] * w[0]);
    return (det > 0) - (det < 0);
}

static void where(const struct body *body, uint32_t v, double t, double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = body->x[0][v][k] + t * (body->x[1][v][k] - body->x[0][v][k]);
    }
}

static bool passes(const struct body *a, uint32_t edge, const struct body *b,
                   uint32_t face, double t)
{
    double e[2][3], f[3][3];
    where(a, a->edges[edge][0], t, e[0]);
    where(a, a->edges[edge][1], t, e[1]);
    for (int k = 0; k < 3; k++) {
        where(b, b->leaves[face][k], t, f[k]);
    }
    int turns[3];
    for (int k = 0; k < 3; k++) {
        turns[k] = orient(e[0], e[1], f[k], f[(k + 1) % 3]);
    }
    return orient(f[0], f[1], f[2], e[0]) * orient(f[0], f[1], f[2], e[1]) < 0 &&
           turns[0] != 0 && turns[0] == turns[1] && turns[1] == turns[2];
}

/* Return whether bodies that touch at SOON, moved a little against each other, are free
 * of each other in some direction. Those that cross are not, whatever is moved. */
static bool can_part(struct trial *trial)
{
    static const double step = 0x1p-24;
    struct body moved[2];
    for (int way = 0; way < 400; way++) {
        memcpy(moved, trial->body, sizeof moved);
        double by[3] = {prng_integer(&trial->prng, 8), prng_integer(&trial->prng, 8),
                        prng_integer(&trial->prng, 8)};
        for (uint32_t b = 0; b < 2; b++) {
            for (uint32_t v = 0; v < moved[b].vertex_count; v++) {
                where(&trial->body[b], v, SOON, moved[b].x[0][v]);
                for (uint32_t k = 0; k < 3; k++) {
                    double jitter = way % 2 ? prng_integer(&trial->prng, 8) / 8 : 0;
                    moved[b].x[0][v][k] += step * (jitter + (b == 0 ? 16 * by[k] : 0));
                }
                memcpy(moved[b].x[1][v], moved[b].x[0][v], sizeof moved[b].x[1][v]);
            }
        }
        bool passes_any = false;
        for (uint32_t i = 0; i < 2; i++) {
            for (uint32_t e = 0; e < moved[i].edge_count; e++) {
                for (uint32_t f = 0; f < moved[1 - i].face_count; f++) {
                    passes_any = passes_any || passes(&moved[i], e, &moved[1 - i], f, 0);
                }
            }
        }
        if (!passes_any) {
            return true;
        }
    }
    return false;
}

static bool any_passes(const struct trial *trial, double t)
{
    for (uint32_t i = 0; i < trial->body_count; i++) {
        for (uint32_t k = 0; k < trial->body_count; k++) {
            const struct body *a = &trial->body[i];
            const struct body *b = &trial->body[k];
            for (uint32_t e = 0; e < a->edge_count; e++) {
                for (uint32_t f = 0; f < b->face_count; f++) {
                    if (passes(a, e, b, f, t)) {
                        return true;
                    }
                }
            }
        }
    }
    return false;
}

/* Where nothing is at once, nothing passes through anything soon after. */
static void check_soon(struct trial *trial, const uint64_t fates[3])
{
    if (fates[0] > 0 || any_passes(trial, 0)) {
        return;
    }
    sums.settled += fates[1] + fates[2] > 0;
    if (any_passes(trial, SOON)) {
        fail_msg("seed %llu: what enters is left out", (unsigned long long)trial->seed);
    }
    if (trial->body_count == 2 && fates[1] > 0) {
        sums.slid++;
        if (!can_part(trial)) {
            sums.stuck++;
            printf("# stuck: seed %llu\n", (unsigned long long)trial->seed);
        }
    }
}

static void check(struct trial *trial)
{
    static struct pccd_contact kept[RECORDS_MAX], told[RECORDS_MAX];
    struct eng_step_result result = ask(trial, PCCD_TOUCHING_KEPT, PCCD_MODE_ALL);
    uint64_t count = result.count;
    assert_true(count <= RECORDS_MAX);
    assert_int_equal(result.entering + result.sliding + result.leaving, 0);
    if (count > 0) {
        memcpy(kept, result.records, count * sizeof *kept);
    }

    result = ask(trial, PCCD_TOUCHING_TOLD, PCCD_MODE_ALL);
    assert_int_equal(result.count, count);
    if (count > 0) {
        memcpy(told, result.records, count * sizeof *told);
    }
    uint64_t fates[3] = {0, 0, 0};
    for (uint64_t i = 0; i < count; i++) {
        struct pccd_contact must = kept[i];
        if (must.flags & PCCD_INITIAL) {
            const struct pair pair = pair_of(trial, &must);
            uint32_t fate = fate_of(&pair);
            must.flags |= fate;
            fates[fate == PCCD_ENTERS ? 0 : fate == PCCD_SLIDES ? 1 : 2]++;
        }
        if (memcmp(&must, &told[i], sizeof must) != 0) {
            fail_trial(trial, &told[i], "what becomes of a pair is wrong");
        }
    }
    assert_int_equal(result.entering, fates[0]);
    assert_int_equal(result.sliding, fates[1]);
    assert_int_equal(result.leaving, fates[2]);
    sums.pairs += fates[0] + fates[1] + fates[2];

    result = ask(trial, PCCD_TOUCHING_LEFT_OUT, PCCD_MODE_ALL);
    assert_int_equal(result.entering, fates[0]);
    assert_int_equal(result.sliding, fates[1]);
    assert_int_equal(result.leaving, fates[2]);
    const struct pccd_contact *left = result.records;
    uint64_t next = 0;
    for (uint64_t i = 0; i < count; i++) {
        const struct pccd_contact *found =
            next < result.count && is_same_pair(&left[next], &told[i]) ? &left[next++]
                                                                       : NULL;
        if ((told[i].flags & (PCCD_SLIDES | PCCD_LEAVES)) != 0) {
            uint32_t must = told[i].flags & ~(uint32_t)PCCD_INITIAL;
            if (found && found->flags != must) {
                fail_trial(trial, found, "a return has other flags");
            }
            sums.left += !found;
            check_return(trial, &told[i], found);
        } else if (!found || memcmp(found, &told[i], sizeof *found) != 0) {
            fail_trial(trial, &told[i], "a contact is left out, or changed,");
        }
    }
    assert_int_equal(next, result.count);

    assert_true(fates[0] > 0 || result.count == 0 || result.toi_first > 0);
    check_soon(trial, fates);
    uint32_t verdict = ask(trial, PCCD_TOUCHING_LEFT_OUT, PCCD_MODE_ANY).verdict;
    assert_int_equal(verdict, next > 0 ? PCCD_VERDICT_YES : PCCD_VERDICT_NO);
}

static uint64_t wanted(void)
{
    const char *text = getenv("PCCD_TOUCHING_PAIRS");
    return text ? (uint64_t)strtod(text, NULL) : 10000;
}

/* Signs, returns and what is left out are those of exact arithmetic. */
CASE(small_scenes__enter_slide_or_leave_as_exact_arithmetic_says)
{
    uint64_t seed = prng_seed();
    uint64_t most = wanted();
    for (uint64_t i = 0; sums.pairs < most; i++) {
        struct trial trial;
        begin(&trial, seed + i);
        check(&trial);
        eng_scene_free(trial.scene);
    }
    printf("# %llu pairs: %llu enter, %llu slide, %llu leave; %llu left out, %llu meet "
           "again; in %llu scenes none enters; of %llu that slide %llu cannot part\n",
           (unsigned long long)sums.pairs, (unsigned long long)sums.fates[0],
           (unsigned long long)sums.fates[1], (unsigned long long)sums.fates[2],
           (unsigned long long)sums.left, (unsigned long long)sums.returned,
           (unsigned long long)sums.settled, (unsigned long long)sums.slid,
           (unsigned long long)sums.stuck);
    assert_true(sums.fates[1] > most / 100 && sums.fates[2] > most / 20);
}
