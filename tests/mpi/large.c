/* large.c - a scene that no rank has all of: how much memory it takes.
 *
 * Let each rank make some rows of a rippling sheet and of another one that comes down on
 * it; step; say what was the most that each rank had at a time, while it registered its
 * part, in the first step and in later ones.
 *
 * Each way to end says why: a rank that ends the program, one that an exit of some
 * library ends, and memory beyond the limit.
 *
 *     mpirun -n R large SIDE STEPS [LIMIT [THREADS]]
 *
 * Each sheet has SIDE * SIDE squares of two triangles; edges are 1 / SIDE long, and go a
 * fortieth of that in a step; with THREADS, those of a rank's steps, all of it, so that
 * vertices leave their boxes. LIMIT: MB of all ranks together that are too many.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pccd_mpi.h"
#include "process_status.h"

#define SHEETS 2
#define PARTS  3 /* registration, first step, later steps */

static int rank, ranks;

static void stop(const char *what)
{
    fprintf(stderr, "rank %d: wrong: %s\n", rank, what);
    MPI_Abort(MPI_COMM_WORLD, 1);
}

static void must(struct pccd_mpi *world, int status)
{
    if (status != 0) {
        stop(pccd_mpi_error_text(world));
    }
}

/* As where libgomp cannot start a thread. */
static void say_if_early(void)
{
    int is_over = 0;
    MPI_Finalized(&is_over);
    if (!is_over) {
        fprintf(stderr, "rank %d: exit before MPI_Finalize\n", rank);
    }
}

static double status_of(const char *name)
{
    return (double)common_process_status((long)getpid(), name);
}

/* Most memory of the process, in MB, since the last call; it begins anew. */
static double peak_mb(void)
{
    double kib = status_of("VmHWM:");
    common_forget_most_memory();
    return kib / 1024;
}

/* Rows of this rank, of `side` rows of squares; the last rank has the last row of
 * vertices, too. */
struct rows {
    uint32_t side, first, count, vertex_rows;
};

static struct rows rows_of(uint32_t side)
{
    struct rows rows = {.side = side};
    rows.first = (uint32_t)((uint64_t)side * (uint32_t)rank / (uint32_t)ranks);
    rows.count =
        (uint32_t)((uint64_t)side * ((uint32_t)rank + 1) / (uint32_t)ranks) - rows.first;
    rows.vertex_rows = rows.count + (rank + 1 == ranks);
    return rows;
}

/* Place the vertices at a time, in steps: the lower sheet ripples, the upper one comes
 * down on its crests. */
static void place(const struct rows *rows, int sheet, double time, double (*x)[3])
{
    double size = 1.0 / rows->side, went = time * size / 40;
    for (uint32_t i = 0; i < rows->vertex_rows; i++) {
        for (uint32_t k = 0; k <= rows->side; k++, x++) {
            double u = k * size, v = (rows->first + i) * size;
            (*x)[0] = u + sheet * size / 3;
            (*x)[1] = v + sheet * size / 3;
            (*x)[2] = sheet == 0 ? 4 * size * sin(40 * (u + v)) + went
                                 : 4 * size + size / 30 - went;
        }
    }
}

static void name(const struct rows *rows, uint32_t (*triangle)[3])
{
    uint32_t width = rows->side + 1;
    for (uint32_t i = rows->first; i < rows->first + rows->count; i++) {
        for (uint32_t k = 0; k < rows->side; k++) {
            uint32_t a = i * width + k;
            const uint32_t two[2][3] = {{a, a + 1, a + width},
                                        {a + 1, a + width + 1, a + width}};
            memcpy(triangle, two, sizeof two);
            triangle += 2;
        }
    }
}

static uint32_t register_sheet(struct pccd_mpi *world, const struct rows *rows,
                               const double (*x)[3])
{
    uint32_t side = rows->side, mesh = 0, object = 0;
    uint32_t(*triangles)[3] = malloc(2 * (size_t)rows->count * side * sizeof *triangles);
    if (triangles == NULL) {
        stop("no memory for triangles");
    }
    name(rows, triangles);
    const struct pccd_mpi_part part = {.vertex_total = (side + 1) * (side + 1),
                                       .triangle_total = 2 * side * side,
                                       .vertex_count = rows->vertex_rows * (side + 1),
                                       .format = PCCD_FORMAT_F64,
                                       .x = x,
                                       .triangle_count = 2 * rows->count * side,
                                       .triangles = (const uint32_t *)triangles};
    must(world, pccd_mpi_mesh_put(world, &part, &mesh, NULL));
    free(triangles);
    must(world, pccd_mpi_add(world, mesh, &object));
    return object;
}

/* Print on the root what all ranks had. Return the most of all together. */
static double report(struct pccd_mpi *world, const struct rows *rows,
                     const double peaks[PARTS], const struct pccd_answer *answer)
{
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    double sums[PARTS], most = 0;
    double(*all)[PARTS] = calloc((size_t)ranks, sizeof *all);
    if (all == NULL) {
        stop("no memory for the report");
    }
    must(world, pccd_mpi_get_share(world, &share));
    MPI_Gather(peaks, PARTS, MPI_DOUBLE, all, PARTS, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    MPI_Allreduce(peaks, sums, PARTS, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    for (int part = 0; part < PARTS; part++) {
        most = sums[part] > most ? sums[part] : most;
    }
    for (int r = 0; r < ranks && rank == 0; r++) {
        printf("rank %d: most MB %.0f while registering, %.0f in the first step, "
               "%.0f later\n",
               r, all[r][0], all[r][1], all[r][2]);
    }
    if (rank == 0) {
        printf("%d ranks, %llu triangles, most MB of all ranks %.0f, imbalance %.3f, "
               "%llu choices of ghosts, %llu contacts, hash %016llx%016llx\n",
               ranks, 4ull * rows->side * rows->side, most, share.imbalance,
               (unsigned long long)share.searches, (unsigned long long)answer->total,
               (unsigned long long)answer->hash[0], (unsigned long long)answer->hash[1]);
    }
    free(all);
    return most;
}

int main(int argc, char **argv)
{
    struct pccd_mpi *world = NULL;
    struct pccd_motion motions[SHEETS];
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    double peaks[PARTS] = {0}, most;

    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    (void)atexit(say_if_early);
    if (argc < 3) {
        stop("usage: large SIDE STEPS [LIMIT [THREADS]]");
    }
    const struct rows rows = rows_of((uint32_t)strtoul(argv[1], NULL, 10));
    const long steps = strtol(argv[2], NULL, 10);
    const double way = argc > 4 ? 40 : 1;
    const double limit = argc > 3 ? strtod(argv[3], NULL) : INFINITY;
    const uint32_t count = rows.vertex_rows * (rows.side + 1);
    double(*x)[3] = malloc(((size_t)count + 1) * sizeof *x);
    if (x == NULL) {
        stop("no memory for positions");
    }
    const double threads_before = status_of("Threads:");
    uint32_t threads = argc > 4 ? (uint32_t)strtoul(argv[4], NULL, 10) : 0;
    const struct pccd_mpi_options options = {
        .struct_bytes = sizeof options, .timeout_ms = 1800000, .threads = threads};
    if (threads == 0) {
        must(world, pccd_mpi_threads(MPI_COMM_WORLD, &threads));
    }
    must(world, pccd_mpi_open(MPI_COMM_WORLD, &options, &world));
    for (int sheet = 0; sheet < SHEETS; sheet++) {
        place(&rows, sheet, 0, x);
        motions[sheet] = (struct pccd_motion){.object = register_sheet(world, &rows, x),
                                              .count = count,
                                              .format = PCCD_FORMAT_F64};
    }
    free(x);
    peaks[0] = peak_mb();
    double(*ends)[3] = malloc(((size_t)count + 1) * SHEETS * sizeof *ends);
    if (ends == NULL) {
        stop("no memory for ends");
    }
    for (long step = 1; step <= steps; step++) {
        for (int sheet = 0; sheet < SHEETS; sheet++) {
            motions[sheet].x1 = ends + (size_t)sheet * count;
            place(&rows, sheet, way * (double)step, ends + (size_t)sheet * count);
        }
        must(world, pccd_mpi_step(world, motions, SHEETS, NULL, &answer));
        double peak = peak_mb(), *to = &peaks[step == 1 ? 1 : 2];
        *to = peak > *to ? peak : *to;
    }
    if (threads == 1 && status_of("Threads:") > threads_before) {
        stop("a rank with one thread has started others");
    }
    most = report(world, &rows, peaks, &answer);
    pccd_mpi_close(world);
    free(ends);
    MPI_Finalize();
    if (rank == 0 && (answer.total == 0 || most > limit)) {
        fprintf(stderr, "wrong: %s\n",
                answer.total == 0 ? "no contacts" : "more memory than allowed");
    }
    return answer.total == 0 || most > limit;
}
