/* bench/small.c - from which size on a team pays.
 *
 * Room:     bench; engine headers.
 * Does:     take the same step of a soup of triangles by one thread and by several, one
 *           after the other, the first by turns, for sizes from tiny to some
 *           milliseconds; print the time of one thread and the medians of the ratios.
 * Threads:  one; the engine uses as many as it is told. The team is placed as the
 *           daemon's is.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "place.h"
#include "prng.h"
#include "report.h"
#include "resident.h"

#define SMALLEST   16u
#define LARGEST    4096u
#define PAIRS_MAX  400u
#define PAIRS_MIN  9u
#define WARM_PAIRS 5u
#define SIZE_NS    2000000000u /* about as long for each size */

struct soup {
    struct eng_scene *scene;
    uint32_t object;
    uint32_t vertex_count;
    double (*x)[3]; /* [2][vertex_count] */
};

static void must(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "engine: %s\n", what);
        exit(2);
    }
}

/* `count` triangles of such a size that each overlaps some ten others. */
static void make(struct soup *soup, uint32_t count)
{
    struct prng prng = {prng_seed()};
    struct eng_mesh *mesh;
    uint32_t bad;
    soup->vertex_count = 3 * count;
    soup->x = bench_alloc((size_t)6 * count, sizeof *soup->x);
    uint32_t(*triangles)[3] = bench_alloc(count, sizeof *triangles);
    double side = 1;
    while (side * side * side < count) {
        side *= 1.0625;
    }
    for (uint32_t i = 0; i < 3 * count; i++) {
        for (int k = 0; k < 3; k++) {
            double middle = i % 3 ? soup->x[i - i % 3][k] : prng_between(&prng, 0, side);
            double x = middle + (i % 3 ? prng_between(&prng, -1, 1) : 0);
            soup->x[i][k] = x;
            soup->x[3 * count + i][k] = x + prng_between(&prng, -0.1, 0.1);
        }
        triangles[i / 3][i % 3] = i;
    }
    must(eng_mesh_new(3 * count, count, &mesh) == ENG_OK, "eng_mesh_new");
    must(eng_mesh_write_vertices(mesh, ENG_F64, 0, 3 * count, soup->x) == ENG_OK &&
             eng_mesh_write_triangles(mesh, 0, count, triangles, &bad) == ENG_OK &&
             eng_mesh_commit(mesh) == ENG_OK,
         "eng_mesh_commit");
    must(eng_scene_new(NULL, &soup->scene) == ENG_OK &&
             eng_scene_add(soup->scene, mesh, 1, &soup->object) == ENG_OK,
         "eng_scene_add");
    eng_mesh_release(mesh);
    free(triangles);
}

static void step(struct soup *soup, const struct eng_places *places, uint32_t threads,
                 struct eng_step_result *result)
{
    struct eng_step_settings settings = bench_step_settings(ENG_MODE_ALL);
    settings.threads = threads;
    settings.places = places;
    settings.team_always = true; /* whether it pays or not: that is the question */
    eng_stage_begin(soup->scene);
    must(eng_stage_x0x1(soup->scene, soup->object, ENG_F64, 0, soup->vertex_count,
                        soup->x, soup->x + soup->vertex_count) == ENG_OK,
         "eng_stage_x0x1");
    must(eng_step(soup->scene, &settings, result) == ENG_OK, "eng_step");
}

static void measure(uint32_t triangles, uint32_t threads, const struct eng_places *places,
                    bool smoke)
{
    uint64_t begin_ns = bench_now_ns();
    struct soup soups[2];
    struct bench_samples ns[2];
    struct bench_samples ratio;
    char name[32];
    memset(ns, 0, sizeof ns);
    memset(&ratio, 0, sizeof ratio);
    snprintf(name, sizeof name, "soup-%u", triangles);
    make(&soups[0], triangles);
    make(&soups[1], triangles);
    for (uint32_t i = 0; i < WARM_PAIRS + PAIRS_MAX; i++) {
        bool is_time_up = smoke || bench_now_ns() - begin_ns > SIZE_NS;
        if (i >= WARM_PAIRS + PAIRS_MIN && is_time_up) {
            break;
        }
        struct eng_step_result results[2];
        for (uint32_t turn = 0; turn < 2; turn++) {
            uint32_t which = (i + turn) % 2;
            step(&soups[which], places, which ? threads : 1, &results[which]);
        }
        bench_check(results[0].hash_lo == results[1].hash_lo &&
                        results[0].hash_hi == results[1].hash_hi,
                    name, "threads change the answer");
        if (i >= WARM_PAIRS) {
            double one = (double)(results[0].times.step - results[0].times.ingest);
            double more = (double)(results[1].times.step - results[1].times.ingest);
            bench_add(&ns[0], one / 1e3);
            bench_add(&ns[1], more / 1e3);
            bench_add(&ratio, one / more);
        }
    }
    bench_row(&(struct bench_row){
        .scene = name, .what = "step, one thread", .unit = "us", .samples = &ns[0]});
    bench_row(&(struct bench_row){.scene = name,
                                  .what = "step",
                                  .unit = "us",
                                  .samples = &ns[1],
                                  .threads = threads});
    bench_row(&(struct bench_row){.scene = name,
                                  .what = "speed-up of a pair",
                                  .unit = "times",
                                  .samples = &ratio,
                                  .threads = threads});
    for (int i = 0; i < 2; i++) {
        eng_scene_free(soups[i].scene);
        free(soups[i].x);
        bench_free(&ns[i]);
    }
    bench_free(&ratio);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_places places;
    int exit_status;
    bench_team_environment(argv);
    if (!bench_begin_with("small", BENCH_TAKES_THREADS, argc, argv, &options,
                          &exit_status)) {
        return exit_status;
    }
    uint32_t threads = options.threads > 0 ? options.threads : 2;
    eng_places_init(&places);
    eng_places_warm_up(&places, threads);
    for (uint32_t triangles = SMALLEST; triangles <= LARGEST; triangles *= 2) {
        measure(triangles, threads, &places, options.smoke);
        if (options.smoke) {
            break;
        }
    }
    return bench_end();
}
