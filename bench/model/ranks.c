/* ranks.c - what ranks have, do and send in a step: counted and timed.
 *
 * Step a scene that libpccd-mpi spreads over the ranks of this program, and write a line
 * of CSV for each rank and step. With "link", measure what it takes that two ranks meet.
 * ranks.awk makes the model of it.
 *
 * SCENE is layers=SIDE or sheet=SIDE (layers.c; one of its sheets), or NAME=FRAME,FRAME
 * of $PCCD_DATA. A step goes a part of the way between two frames, one in PARTS. ON steps
 * go on and on; then FRO steps go the last part's way back and forth: they are alike and
 * need no new ghosts, so that their times can be compared. With "alone" each rank has all
 * of the scene for itself, and all of them step at the same time: what they take from
 * each other.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "families.h"
#include "pccd_mpi.h"
#include "report.h"

#define LAYERS       8u
#define SHORT_TURNS  2000
#define LONG_TURNS   20
#define LONG_BYTES   (4 << 20)
#define RECORD_LIMIT (1ull << 32)
#define MPI_PATIENCE 1800000 /* ms: ranks may be many more than processors */

#define COLUMNS                                                                          \
    "scene,triangles,vertices,parts,ranks,rank,step,how,cuts,searches,own,ghosts,"       \
    "own_vertices,ghost_vertices,sent,work,records,wall_ns,ingest_ns,refit_ns,"          \
    "traversal_ns,tests_ns,merge_ns,step_ns,total,hash"

/* Numbers that a rank prints of a step. */
struct row {
    uint64_t own, ghosts, own_vertices, ghost_vertices, sent, work, records, wall_ns;
};
#define ROW_WORDS ((int)(sizeof(struct row) / sizeof(uint64_t)))

struct counter {
    struct pccd_mpi *world;
    const struct bench_scene *scene;
    struct bench_frames frames;
    uint32_t *objects;
    struct pccd_motion *motions;
    double (*x)[3]; /* of this rank's vertices of all objects */
    uint32_t parts;
};

static int rank, ranks;      /* of the communicator that a world is made of */
static uint32_t threads = 1; /* of a rank */
static bool is_alone;
static bool is_silent; /* another process of those alone writes */

static void must(const struct pccd_mpi *world, int status)
{
    if (status != 0) {
        fprintf(stderr, "ranks: %s\n", pccd_mpi_error_text(world));
        MPI_Abort(MPI_COMM_WORLD, 2);
    }
}

/* This rank's run of `count` things begins at begin_of(count, rank). */
static uint32_t begin_of(uint32_t count, int r)
{
    return (uint32_t)((uint64_t)count * (uint32_t)r / (uint32_t)ranks);
}

/* ---- a scene ---------------------------------------------------------------------- */

/* SCENE of the usage, which it cuts at '=' and ','. */
static bool make_scene(char *text, struct bench_scene *scene)
{
    char *value = strchr(text, '=');
    char *comma = strchr(text, ',');
    memset(scene, 0, sizeof *scene);
    scene->name = text;
    if (value == NULL) {
        return false;
    }
    *value++ = '\0';
    if (comma != NULL) {
        const char *const frames[2] = {value, comma + 1};
        *comma = '\0';
        return bench_read_recorded(scene, frames, 1);
    }
    uint32_t side = (uint32_t)strtoul(value, NULL, 10);
    bool is_sheet = strcmp(text, "sheet") == 0;
    if (side < 2 || (!is_sheet && strcmp(text, "layers") != 0)) {
        return false;
    }
    bench_make_layers(scene, is_sheet ? 1 : LAYERS, side);
    return true;
}

/* Put this rank's vertices where they are after so many steps. */
static void place(struct counter *counter, uint32_t step)
{
    uint32_t frame = step / counter->parts;
    double part = (double)(step % counter->parts) / counter->parts;
    double(*to)[3] = counter->x;
    if (frame + 1 >= counter->scene->frame_count) { /* the end of the last way */
        frame = counter->scene->frame_count - 2;
        part = 1;
    }
    bench_frames_seek(&counter->frames, frame);
    for (uint32_t o = 0; o < counter->scene->object_count; o++) {
        uint32_t count = counter->scene->objects[o].vertex_count;
        const double(*x0)[3] = (const double(*)[3])bench_frames_x(&counter->frames, 0, o);
        const double(*x1)[3] = (const double(*)[3])bench_frames_x(&counter->frames, 1, o);
        for (uint32_t i = begin_of(count, rank); i < begin_of(count, rank + 1); i++) {
            for (int k = 0; k < 3; k++) {
                (*to)[k] = x0[i][k] + part * (x1[i][k] - x0[i][k]);
            }
            to++;
        }
    }
}

static void register_all(struct counter *counter)
{
    const struct bench_scene *scene = counter->scene;
    double(*x)[3] = counter->x;
    place(counter, 0);
    for (uint32_t o = 0; o < scene->object_count; o++) {
        const struct bench_object *object = &scene->objects[o];
        uint32_t vertices = object->vertex_count, triangles = object->triangle_count;
        uint32_t first = begin_of(triangles, rank), mesh = 0;
        uint32_t count = begin_of(vertices, rank + 1) - begin_of(vertices, rank);
        const struct pccd_mpi_part part = {
            .vertex_total = vertices,
            .triangle_total = triangles,
            .vertex_count = count,
            .format = PCCD_FORMAT_F64,
            .x = x,
            .triangle_count = begin_of(triangles, rank + 1) - first,
            .triangles = (const uint32_t *)(object->triangles + first)};
        must(counter->world, pccd_mpi_mesh_put(counter->world, &part, &mesh, NULL));
        must(counter->world, pccd_mpi_add(counter->world, mesh, &counter->objects[o]));
        counter->motions[o] = (struct pccd_motion){.object = counter->objects[o],
                                                   .count = count,
                                                   .format = PCCD_FORMAT_F64,
                                                   .x1 = x};
        x += count;
    }
}

static void tell(const struct counter *counter, uint32_t number, bool is_fro,
                 const struct pccd_answer *answer, uint64_t wall_ns)
{
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    struct row mine, *rows = bench_alloc((size_t)ranks, sizeof *rows);
    must(counter->world, pccd_mpi_get_share(counter->world, &share));
    mine = (struct row){
        share.own,        share.ghosts, share.own_vertices, share.ghost_vertices,
        share.sent_bytes, share.work,   answer->count,      wall_ns};
    MPI_Gather(&mine, ROW_WORDS, MPI_UINT64_T, rows, ROW_WORDS, MPI_UINT64_T, 0,
               is_alone ? MPI_COMM_SELF : MPI_COMM_WORLD);
    for (int r = 0; r < ranks && rank == 0 && !is_silent; r++) {
        const struct row *row = &rows[r];
        printf("%s,%" PRIu64 ",%u,%u,%d,%d,%u,%s,%" PRIu64 ",%" PRIu64,
               counter->scene->name, bench_scene_triangles(counter->scene),
               counter->scene->vertex_count, counter->parts, ranks, r, number,
               !is_fro    ? "on"
               : is_alone ? "alone"
                          : "fro",
               share.cuts, share.searches);
        printf(",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64
               ",%" PRIu64 ",%" PRIu64,
               row->own, row->ghosts, row->own_vertices, row->ghost_vertices, row->sent,
               row->work, row->records, row->wall_ns);
        printf(",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64,
               answer->times.ingest, answer->times.refit, answer->times.traversal,
               answer->times.tests, answer->times.merge, answer->times.step);
        printf(",%" PRIu64 ",%016" PRIx64 "%016" PRIx64 "\n", answer->total,
               answer->hash[0], answer->hash[1]);
    }
    fflush(stdout);
    free(rows);
}

static void count(const struct bench_scene *scene, uint32_t parts, uint32_t on,
                  uint32_t fro)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct counter counter = {.scene = scene, .parts = parts};
    uint32_t vertices = 0;
    for (uint32_t o = 0; o < scene->object_count; o++) {
        vertices += begin_of(scene->objects[o].vertex_count, rank + 1) -
                    begin_of(scene->objects[o].vertex_count, rank);
    }
    const struct pccd_mpi_options options = {.struct_bytes = sizeof options,
                                             .timeout_ms = MPI_PATIENCE,
                                             .threads = threads,
                                             .record_limit = RECORD_LIMIT};
    counter.x = bench_alloc((size_t)vertices + 1, sizeof *counter.x);
    counter.objects = bench_alloc(scene->object_count, sizeof *counter.objects);
    counter.motions = bench_alloc(scene->object_count, sizeof *counter.motions);
    bench_frames_init(&counter.frames, scene, 0);
    must(NULL, pccd_mpi_open(is_alone ? MPI_COMM_SELF : MPI_COMM_WORLD, &options,
                             &counter.world));
    register_all(&counter);
    if (rank == 0 && !is_silent) {
        puts(COLUMNS);
    }
    for (uint32_t i = 1; i <= on + fro; i++) {
        place(&counter, i <= on ? i : on - (i - on) % 2);
        MPI_Barrier(MPI_COMM_WORLD);
        uint64_t begin_ns = common_now_ns();
        must(counter.world, pccd_mpi_step(counter.world, counter.motions,
                                          scene->object_count, NULL, &answer));
        tell(&counter, i, i > on, &answer, common_now_ns() - begin_ns);
    }
    pccd_mpi_close(counter.world);
    bench_frames_deinit(&counter.frames);
    free(counter.x);
    free(counter.objects);
    free(counter.motions);
}

/* ---- two ranks meet --------------------------------------------------------------- */

/* One way, by messages to and fro, ns; the median of nine. */
static double message_ns(char *bytes, int count, int turns)
{
    struct bench_samples samples = {0};
    for (int repeat = 0; repeat < 9; repeat++) {
        MPI_Barrier(MPI_COMM_WORLD);
        uint64_t begin_ns = common_now_ns();
        for (int turn = 0; turn < turns; turn++) {
            for (int end = 0; end < 2; end++) {
                if (rank == end) {
                    MPI_Send(bytes, count, MPI_BYTE, 1 - end, 0, MPI_COMM_WORLD);
                } else {
                    MPI_Recv(bytes, count, MPI_BYTE, end == 0 ? 0 : 1, 0, MPI_COMM_WORLD,
                             MPI_STATUS_IGNORE);
                }
            }
        }
        bench_add(&samples, (double)(common_now_ns() - begin_ns) / (2 * turns));
    }
    double ns = bench_summarise(&samples).p50;
    bench_free(&samples);
    return ns;
}

static int measure_link(void)
{
    if (ranks != 2) {
        fprintf(stderr, "ranks: link is measured between two ranks\n");
        return 2;
    }
    char *bytes = bench_alloc(LONG_BYTES, 1);
    memset(bytes, 1, LONG_BYTES);
    double latency_ns = message_ns(bytes, 8, SHORT_TURNS);
    double long_ns = message_ns(bytes, LONG_BYTES, LONG_TURNS);
    if (rank == 0) {
        printf("link_latency_ns,%.1f\nlink_byte_ns,%.4f\n", latency_ns,
               (long_ns - latency_ns) / LONG_BYTES);
    }
    free(bytes);
    return 0;
}

int main(int argc, char **argv)
{
    struct bench_scene scene;
    int status = 0;
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    if (argc == 2 && strcmp(argv[1], "link") == 0) {
        status = measure_link();
    } else if (argc != 5 && argc != 6) {
        fprintf(stderr, "usage: ranks SCENE PARTS ON FRO [alone | THREADS] | link\n");
        status = 2;
    } else if (!make_scene(argv[1], &scene)) {
        fprintf(stderr, "ranks: no scene %s, or its frames are not in $PCCD_DATA\n",
                argv[1]);
        status = 77;
    } else {
        is_alone = argc == 6 && strcmp(argv[5], "alone") == 0;
        threads = argc == 6 && !is_alone ? (uint32_t)strtoul(argv[5], NULL, 10) : 1;
        is_silent = is_alone && rank > 0;
        rank = is_alone ? 0 : rank;
        ranks = is_alone ? 1 : ranks;
        count(&scene, (uint32_t)strtoul(argv[2], NULL, 10),
              (uint32_t)strtoul(argv[3], NULL, 10), (uint32_t)strtoul(argv[4], NULL, 10));
        bench_scene_free(&scene);
    }
    MPI_Finalize();
    return status;
}
