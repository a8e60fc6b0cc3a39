/* bench/direct.c - a step in the process of its client, beside the daemon's.
 *
 * Room:     bench; the public header of the client library.
 * Does:     ping, an empty step and the steps of large scenes by a daemon and by direct:,
 *           by turns, after their answers have been compared.
 * Does not: set OpenMP's environment, which a game's process would not have either: run
 *           it with GOMP_SPINCOUNT=2000 and without to see what that is worth.
 * Threads:  one, and the team of direct:; the daemon is a private one.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pccd.h"
#include "report.h"
#include "workload.h"

#define TURN 50u /* calls before the other side has its turn */

enum { BLOCKING, SPINNING, DIRECT, SIDES };

static const char *const side_names[SIDES] = {"daemon", "daemon, 50 us spin", "direct:"};

struct side {
    struct pccd_client *client;
    uint32_t tiny; /* scene of one triangle */
    uint32_t scene;
    uint32_t *meshes; /* of the scene, [object_count] */
    uint32_t *objects;
};

static void must(int status, const char *what, struct pccd_client *client)
{
    if (status != PCCD_OK) {
        fprintf(stderr, "direct: %s: %s: %s\n", what, pccd_status_name(status),
                pccd_error_text(client));
        exit(2);
    }
}

static void open_side(struct side *side, int which)
{
    static const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    struct pccd_options options;
    uint32_t mesh;
    uint32_t object;
    pccd_options_init(&options);
    options.spin_us = which == SPINNING ? 50 : 0;
    options.private_daemon = which != DIRECT;
    options.url = which == DIRECT ? "direct:" : NULL;
    must(pccd_connect(&options, &side->client), "connect", NULL);
    must(pccd_scene_create(side->client, NULL, &side->tiny), "scene", side->client);
    must(pccd_mesh_create(side->client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL),
         "mesh", side->client);
    must(pccd_scene_add(side->client, side->tiny, mesh, &object), "add", side->client);
}

/* ---- nothing to compute ------------------------------------------------------------ */

static double ping_us(struct side *side)
{
    uint64_t ns;
    uint64_t begin_ns = bench_now_ns();
    must(pccd_ping(side->client, &ns), "ping", side->client);
    return 1e-3 * (double)(bench_now_ns() - begin_ns);
}

static double empty_step_us(struct side *side)
{
    struct pccd_answer answer;
    uint64_t step;
    uint64_t begin_ns = bench_now_ns();
    must(pccd_submit_still(side->client, side->tiny, NULL, &step), "submit",
         side->client);
    must(pccd_wait(side->client, step, -1, &answer), "wait", side->client);
    uint64_t end_ns = bench_now_ns();
    bench_check(answer.total == 0 && answer.incomplete == PCCD_COMPLETE, "round trip",
                "a single triangle has contacts");
    pccd_answer_release(side->client, &answer);
    return 1e-3 * (double)(end_ns - begin_ns);
}

static void print_sides(const char *scene, const char *what, const char *unit,
                        uint32_t threads, struct bench_samples samples[SIDES])
{
    for (int which = 0; which < SIDES; which++) {
        char text[64];
        (void)snprintf(text, sizeof text, "%s, %s", what, side_names[which]);
        bench_row(&(struct bench_row){.scene = scene,
                                      .what = text,
                                      .unit = unit,
                                      .samples = &samples[which],
                                      .base_name = which > 0 ? "daemon" : NULL,
                                      .base = which > 0 ? &samples[0] : NULL,
                                      .threads = threads});
    }
    for (int which = 0; which < SIDES; which++) {
        bench_free(&samples[which]);
    }
}

static void round_trips(struct side sides[SIDES], unsigned turns)
{
    struct bench_samples pings[SIDES] = {{0}};
    struct bench_samples steps[SIDES] = {{0}};
    for (unsigned turn = 0; turn < turns; turn++) {
        for (int which = 0; which < SIDES; which++) {
            for (unsigned i = 0; i < TURN; i++) {
                double ping = ping_us(&sides[which]);
                double step = empty_step_us(&sides[which]);
                if (turn > 0) {
                    bench_add(&pings[which], ping);
                    bench_add(&steps[which], step);
                }
            }
        }
    }
    print_sides("round trip", "ping", "us", 1, pings);
    print_sides("round trip", "empty step", "us", 1, steps);
}

/* ---- large scenes ------------------------------------------------------------------ */

static void register_scene(struct side *side, const struct bench_frames *frames)
{
    const struct bench_scene *scene = frames->scene;
    side->meshes = bench_alloc(scene->object_count, sizeof *side->meshes);
    side->objects = bench_alloc(scene->object_count, sizeof *side->objects);
    must(pccd_scene_create(side->client, NULL, &side->scene), "scene", side->client);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct bench_object *object = &scene->objects[i];
        must(pccd_mesh_create(side->client, bench_frames_x(frames, 0, i), PCCD_FORMAT_F64,
                              object->vertex_count,
                              (const uint32_t(*)[3])object->triangles,
                              object->triangle_count, &side->meshes[i], NULL),
             "mesh", side->client);
        must(
            pccd_scene_add(side->client, side->scene, side->meshes[i], &side->objects[i]),
            "add", side->client);
    }
}

static void forget_scene(struct side *side, uint32_t object_count)
{
    must(pccd_scene_destroy(side->client, side->scene), "destroy", side->client);
    for (uint32_t i = 0; i < object_count; i++) {
        must(pccd_mesh_destroy(side->client, side->meshes[i]), "destroy", side->client);
    }
    free(side->meshes);
    free(side->objects);
}

/* From writing the first vertex to having the answer. Returns milliseconds. */
static double step_ms(struct side *side, const struct bench_frames *frames,
                      uint32_t threads, uint64_t hash[2])
{
    const struct bench_scene *scene = frames->scene;
    struct pccd_step_settings settings = {.threads = threads};
    struct pccd_frame frame;
    struct pccd_answer answer;
    uint64_t step;
    uint64_t begin_ns = bench_now_ns();
    must(pccd_frame_begin(side->client, side->scene, scene->object_count,
                          2ull * scene->vertex_count * sizeof(double[3]), &frame),
         "frame", side->client);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        void *x[2];
        uint32_t count = scene->objects[i].vertex_count;
        must(pccd_frame_x0x1(&frame, side->objects[i], PCCD_FORMAT_F64, 0, count, &x[0],
                             &x[1]),
             "segment", side->client);
        for (int end = 0; end < 2; end++) {
            memcpy(x[end], bench_frames_x(frames, end, i), count * sizeof(double[3]));
        }
    }
    must(pccd_frame_commit(&frame, &settings, &step), "commit", side->client);
    must(pccd_wait(side->client, step, -1, &answer), "wait", side->client);
    uint64_t end_ns = bench_now_ns();
    memcpy(hash, answer.hash, sizeof answer.hash);
    pccd_answer_release(side->client, &answer);
    return 1e-6 * (double)(end_ns - begin_ns);
}

static void run_scene(struct side sides[SIDES], const struct bench_scene *scene,
                      uint32_t threads, unsigned rounds)
{
    struct bench_samples samples[SIDES] = {{0}};
    struct bench_frames frames;
    bench_frames_init(&frames, scene, scene->hard_frame);
    for (int which = 0; which < SIDES; which++) {
        register_scene(&sides[which], &frames);
    }
    for (unsigned round = 0; round < rounds; round++) {
        uint64_t hashes[SIDES][2];
        bench_frames_seek(&frames, bench_hard_step(scene, round));
        for (int i = 0; i < SIDES; i++) {
            int which = (int)((round + (unsigned)i) % SIDES);
            double ms = step_ms(&sides[which], &frames, threads, hashes[which]);
            if (round > 1) {
                bench_add(&samples[which], ms);
            }
        }
        for (int which = 1; which < SIDES; which++) {
            bench_check(memcmp(hashes[0], hashes[which], sizeof hashes[0]) == 0,
                        scene->name, "the process and the daemon differ");
        }
    }
    print_sides(scene->name, threads == 1 ? "step, 1 thread" : "step, all threads", "ms",
                threads, samples);
    for (int which = 0; which < SIDES; which++) {
        forget_scene(&sides[which], scene->object_count);
    }
    bench_frames_deinit(&frames);
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"cloth-20k", "cloth-ball-fifth", NULL};
    struct bench_options options;
    int exit_status;
    if (!bench_begin_with("direct", BENCH_TAKES_THREADS, argc, argv, &options,
                          &exit_status)) {
        return exit_status;
    }
    struct side sides[SIDES];
    struct bench_scene scene;
    unsigned index = 0;
    for (int which = 0; which < SIDES; which++) {
        open_side(&sides[which], which);
    }
    bench_heading("In the process of the client, and beside it");
    if (bench_is_wanted(&options, "round trip")) {
        round_trips(sides, options.smoke ? 3 : 100);
    }
    while (bench_next_scene(&options, names, &index, &scene)) {
        unsigned rounds = options.smoke ? 4 : 62;
        run_scene(sides, &scene, 1, rounds);
        run_scene(sides, &scene, options.threads > 0 ? options.threads : 2, rounds);
        bench_scene_free(&scene);
    }
    for (int which = 0; which < SIDES; which++) {
        pccd_close(sides[which].client);
    }
    return bench_end();
}
