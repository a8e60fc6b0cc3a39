/* kernels.c - the engine's inner loops, each beside a plain version of itself. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "coordinates.h"
#include "gather.h"
#include "ingest.h"
#include "sections.h"
#include "solve.h"
#include "trees.h"

#define QUERY_MAX 60000u
#define REPEATS   15u
#define EXACT_MAX 2000u
#define TOLERANCE 1e-6

static const struct eng_question asked = ENG_QUESTION_DEFAULT; /* of TOLERANCE */

static unsigned repeats; /* of every measurement, the first not counted */

/* A value that the compiler has to produce. */
static void use(uint64_t value)
{
    __asm__ volatile("" : : "r"(value) : "memory");
}

/* ---- filter and solver ------------------------------------------------------------ */

struct answers {
    uint64_t survivors;
    uint64_t contacts;
    bool *hit;
    struct eng_hit *hits;
};

static bool same_hits(const struct answers *a, const struct answers *b, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_hit *x = &a->hits[i];
        const struct eng_hit *y = &b->hits[i];
        if (a->hit[i] != b->hit[i]) {
            return false;
        }
        if (a->hit[i] && (x->flags != y->flags || memcmp(&x->toi, &y->toi, 16) != 0 ||
                          memcmp(x->param, y->param, sizeof x->param) != 0 ||
                          memcmp(x->normal, y->normal, sizeof x->normal) != 0)) {
            return false;
        }
    }
    return true;
}

static void load(const struct eng_scene *scene, const struct bench_candidates *c,
                 uint32_t i, struct eng_query *query)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    const uint32_t *points = common_kinds[c->kind].points; /* four together */
    uint32_t v[4];
    eng_feature_vertices(trees, points[0], c->a[i], v);
    eng_feature_vertices(trees, points[1], c->b[i], v + points[0]);
    query->kind = c->kind;
    for (int k = 0; k < 4; k++) {
        memcpy(query->x[0][k], scene->x[1 - scene->now][v[k]], sizeof query->x[0][k]);
        memcpy(query->x[1][k], scene->x[scene->now][v[k]], sizeof query->x[1][k]);
    }
}

/* The points of every candidate, four a pair. */
struct records {
    struct eng_point *points;
    uint32_t (*quads)[4];
    struct eng_batch batch;
};

static void records_init(struct records *records, const struct eng_scene *scene,
                         const struct bench_candidates *c)
{
    memset(&records->batch, 0, sizeof records->batch);
    size_t bytes = (size_t)c->count * 4 * sizeof *records->points;
    records->points = aligned_alloc(_Alignof(struct eng_point), bytes);
    if (!records->points) {
        exit(2);
    }
    memset(records->points, 0, bytes);
    records->quads = bench_alloc(c->count, sizeof *records->quads);
    for (uint32_t i = 0; i < c->count; i++) {
        struct eng_query query;
        load(scene, c, i, &query);
        for (uint32_t k = 0; k < 4; k++) {
            struct eng_point *point = &records->points[4 * i + k];
            memcpy(point->x0, query.x[0][k], sizeof point->x0);
            memcpy(point->x1, query.x[1][k], sizeof point->x1);
            records->quads[i][k] = 4 * i + k;
        }
    }
}

static void records_deinit(struct records *records)
{
    free(records->points);
    free(records->quads);
}

/* In chunks, as a step does it; `answers` NULL: the filter alone. */
static void with_filter(struct records *records, const struct bench_candidates *c,
                        struct eng_exact *exact, struct answers *answers)
{
    const struct eng_kernels *kernels = eng_kernels();
    struct eng_batch *batch = &records->batch;
    batch->kernels = kernels;
    batch->contacts = exact;
    for (uint32_t i = 0; i < c->count; i += ENG_CHUNK_MAX) {
        const uint32_t(*quads)[4] = (const uint32_t(*)[4])records->quads + i;
        uint32_t n = c->count - i < ENG_CHUNK_MAX ? c->count - i : ENG_CHUNK_MAX;
        if (!answers) {
            uint32_t kept = kernels->reject_axes(
                (struct eng_quads){c->kind, records->points, quads}, n, batch->left);
            use(kernels->filter((struct eng_quads){c->kind, records->points, quads},
                                batch->left, kept, batch->left));
            continue;
        }
        const struct eng_pairs pairs = {.question = &asked,
                                        .kind = c->kind,
                                        .count = n,
                                        .points = records->points,
                                        .quads = quads,
                                        .t_end = 1};
        uint32_t hits = eng_batch_test(batch, &pairs);
        memset(answers->hit + i, 0, n * sizeof *answers->hit);
        for (uint32_t k = 0; k < hits; k++) {
            answers->hit[i + batch->index[k]] = true;
            answers->hits[i + batch->index[k]] = batch->hits[k];
        }
        answers->survivors += batch->survivors;
        answers->contacts += hits;
    }
}

static void solver_alone(const struct eng_scene *scene, const struct bench_candidates *c,
                         struct eng_exact *exact, struct answers *answers)
{
    for (uint32_t i = 0; i < c->count; i++) {
        struct eng_query query;
        load(scene, c, i, &query);
        answers->hit[i] = eng_solve(&query, TOLERANCE, 1, exact, &answers->hits[i]);
    }
}

static void answers_init(struct answers *answers, uint32_t count)
{
    memset(answers, 0, sizeof *answers);
    answers->hit = bench_alloc(count, sizeof *answers->hit);
    answers->hits = bench_alloc(count, sizeof *answers->hits);
}

static void answers_deinit(struct answers *answers)
{
    free(answers->hit);
    free(answers->hits);
}

/* A heading that begins with the kind. */
static void name_side(struct bench_side *side, enum pccd_kind kind, const char *what)
{
    snprintf(side->what, sizeof side->what, "%s %s", kind == PCCD_VF ? "VF" : "EE", what);
}

static void number_of_kind(const char *scene, enum pccd_kind kind, const char *what,
                           const char *unit, double value)
{
    struct bench_side side;
    name_side(&side, kind, what);
    bench_number(scene, side.what, unit, value);
}

static void measure_tests(const struct bench_work *work, struct bench_candidates *c,
                          struct eng_exact *exact)
{
    enum { FILTER, BOTH, AGAIN, ALONE, SIDES };
    /* The same work again: its ratio shows the noise of the others. */
    static const char *const names[SIDES] = {"filter", "filter, solver", "solver, again",
                                             "solver alone"};
    const struct eng_scene *scene = work->world.scene;
    const char *name = work->world.source->name;
    struct bench_side sides[SIDES] = {0};
    static struct records records;
    struct answers with;
    struct answers without;
    bool good = true;
    if (c->count == 0) {
        return;
    }
    for (unsigned i = 0; i < SIDES; i++) {
        sides[i] = (struct bench_side){
            .unit = "ns", .base_name = i == ALONE ? NULL : names[ALONE], .base = ALONE};
        name_side(&sides[i], c->kind, names[i]);
    }
    records_init(&records, scene, c);
    answers_init(&with, c->count);
    answers_init(&without, c->count);
    for (unsigned r = 0; r < repeats && good; r++) {
        with.survivors = 0;
        with.contacts = 0;
        uint64_t t0 = common_now_ns();
        with_filter(&records, c, exact, &with);
        uint64_t t1 = common_now_ns();
        solver_alone(scene, c, exact, &without);
        uint64_t t2 = common_now_ns();
        with_filter(&records, c, exact, NULL);
        uint64_t t3 = common_now_ns();
        solver_alone(scene, c, exact, &without);
        uint64_t t4 = common_now_ns();
        good = bench_check(same_hits(&with, &without, c->count), name,
                           "the filter changes answers of the solver");
        if (r > 0) {
            bench_add(&sides[BOTH].samples, (double)(t1 - t0) / c->count);
            bench_add(&sides[ALONE].samples, (double)(t2 - t1) / c->count);
            bench_add(&sides[FILTER].samples, (double)(t3 - t2) / c->count);
            bench_add(&sides[AGAIN].samples, (double)(t4 - t3) / c->count);
        }
    }
    if (good) {
        double rejected = (double)(c->count - with.survivors);
        double misses = (double)(c->count - with.contacts);
        number_of_kind(name, c->kind, "queries", "", c->count);
        number_of_kind(name, c->kind, "misses rejected", "share",
                       misses > 0 ? rejected / misses : 1);
    }
    bench_sides_end(name, sides, SIDES, good);
    records_deinit(&records);
    answers_deinit(&with);
    answers_deinit(&without);
}

/* ---- contacts ---------------------------------------------------------------------- */

/* Contacts that the solver proves by itself, one after the other, their points at
 * hand. */
static void measure_contacts(const struct bench_work *work,
                             const struct bench_candidates *c, struct eng_exact *exact)
{
    const char *name = work->world.source->name;
    struct bench_side side = {.unit = "ns"};
    struct eng_query *queries = bench_alloc(c->count, sizeof *queries);
    uint32_t count = 0;
    for (uint32_t i = 0; i < c->count; i++) {
        struct eng_hit hit;
        uint64_t before = exact->queries;
        load(work->world.scene, c, i, &queries[count]);
        if (eng_solve(&queries[count], TOLERANCE, 1, exact, &hit) &&
            exact->queries == before) {
            count++;
        }
    }
    for (unsigned r = 0; r < repeats && count > 0; r++) {
        uint64_t found = 0;
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < count; i++) {
            struct eng_hit hit;
            found += eng_solve(&queries[i], TOLERANCE, 1, exact, &hit);
        }
        double each_ns = (double)(common_now_ns() - begin_ns) / count;
        bench_check(found == count, name, "a contact was there once and not again");
        if (r > 0) {
            bench_add(&side.samples, each_ns);
        }
    }
    name_side(&side, c->kind, "solver, contacts");
    bench_sides_end(name, &side, 1, true);
    free(queries);
}

/* Queries that the solver cannot decide by itself, put to exact arithmetic at once. */
static void measure_exact(const struct bench_work *work, const struct bench_candidates *c,
                          struct eng_exact *exact)
{
    const char *name = work->world.source->name;
    struct bench_side side = {.unit = "us"};
    bool good = true;
    for (uint32_t i = 0; i < c->count && side.samples.count < EXACT_MAX && good; i++) {
        struct eng_query query;
        struct eng_hit hit;
        load(work->world.scene, c, i, &query);
        uint64_t before = exact->queries;
        bool hits = eng_solve(&query, TOLERANCE, 1, exact, &hit);
        if (exact->queries == before) {
            continue;
        }
        uint64_t begin_ns = common_now_ns();
        bool meets = eng_exact_meets(exact, &query, 0, 1);
        bench_add(&side.samples, 1e-3 * (double)(common_now_ns() - begin_ns));
        good = bench_check(hits == meets, name, "the solver and exact arithmetic differ");
    }
    name_side(&side, c->kind, "exact, whole step");
    bench_sides_end(name, &side, 1, good);
}

/* ---- ingest ----------------------------------------------------------------------- */

static bool same_positions(const double (*out)[3], enum pccd_format format,
                           uint32_t count, const void *source)
{
    const float *f32 = source;
    const double *f64 = source;
    for (uint32_t i = 0; i < 3 * count; i++) {
        double x = format == PCCD_FORMAT_F64 ? f64[i] : (double)f32[i];
        if (memcmp(&out[i / 3][i % 3], &x, sizeof x) != 0) {
            return false;
        }
    }
    return true;
}

static void measure_ingest(const char *name, enum pccd_format format, uint32_t count)
{
    size_t bytes = (size_t)count * common_vertex_bytes(format);
    unsigned char *source = bench_alloc(bytes, 1);
    unsigned char *plain = bench_alloc(bytes, 1);
    double(*out)[3] = bench_alloc(count, sizeof *out);
    enum { INGEST, COPY, SIDES };
    struct bench_side sides[SIDES] = {{"ingest float", "GB/s", "memcpy", COPY, 1, {0}},
                                      {"memcpy", "GB/s", NULL, 0, 1, {0}}};
    bool good = true;
    for (uint32_t i = 0; i < 3 * count; i++) {
        double x = (double)i * 0.25 - 1000;
        float f = (float)x;
        memcpy(source + (size_t)i * (format == PCCD_FORMAT_F64 ? 8 : 4),
               format == PCCD_FORMAT_F64 ? (void *)&x : (void *)&f,
               format == PCCD_FORMAT_F64 ? 8 : 4);
    }
    for (unsigned r = 0; r < 2 * repeats && good; r++) {
        uint64_t t0 = common_now_ns();
        int status = eng_ingest_positions(out, format, count, source, NULL);
        uint64_t t1 = common_now_ns();
        memcpy(plain, source, bytes);
        use(plain[bytes / 2]);
        uint64_t t2 = common_now_ns();
        good = bench_check(status == PCCD_OK && same_positions((const double(*)[3])out,
                                                               format, count, source),
                           name, "ingest changes positions");
        if (r > 0) { /* bytes per nanosecond are gigabytes per second */
            bench_add(&sides[INGEST].samples, (double)bytes / (double)(t1 - t0));
            bench_add(&sides[COPY].samples, (double)bytes / (double)(t2 - t1));
        }
    }
    if (format == PCCD_FORMAT_F64) {
        strcpy(sides[INGEST].what, "ingest double");
    }
    bench_sides_end(name, sides, SIDES, good);
    free(source);
    free(plain);
    free(out);
}

static void measure_scene(const struct bench_scene *scene, bool smoke)
{
    static struct bench_work work;
    struct eng_exact exact;
    bench_heading(scene->name);
    bench_work_init(&work, scene, smoke ? 500 : QUERY_MAX);
    if (work.found.count == 0) {
        bench_skip(scene->name, "there are no candidates");
        bench_work_deinit(&work);
        return;
    }
    if (eng_exact_init(&exact) != PCCD_OK) {
        abort();
    }
    measure_tests(&work, &work.vf, &exact);
    measure_tests(&work, &work.ee, &exact);
    measure_contacts(&work, &work.vf, &exact);
    measure_contacts(&work, &work.ee, &exact);
    measure_exact(&work, &work.vf, &exact);
    measure_exact(&work, &work.ee, &exact);
    bench_sorting_measure(&work, repeats);
    eng_exact_deinit(&exact);
    bench_work_deinit(&work);
}

int section_kernels(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    static const struct {
        const char *name;
        uint32_t count;
    } sizes[] = {
        {"46 K vertices", 46000}, {"250 K vertices", 250000}, {"1 M vertices", 1000000}};
    struct bench_scene scene;
    repeats = options->smoke ? 3 : REPEATS;
    bench_heading("ingest");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        if (bench_is_wanted(options, sizes[i].name) && !(options->smoke && i > 0)) {
            measure_ingest(sizes[i].name, PCCD_FORMAT_F64, sizes[i].count);
            measure_ingest(sizes[i].name, PCCD_FORMAT_F32, sizes[i].count);
        }
    }
    for (unsigned i = 0; bench_next_scene(options, NULL, &i, &scene);) {
        measure_scene(&scene, options->smoke);
        bench_scene_free(&scene);
    }
    return 0;
}
