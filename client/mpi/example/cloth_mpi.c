/* cloth_mpi.c - a cloth that falls on a ball, computed by the ranks of an MPI program.
 *
 * Room:     client/mpi/example. May include: pccd_mpi.h, sheet.h.
 * Does:     let each rank have some rows of the cloth, and exchange rows with its
 *           neighbours; ask libpccd-mpi what meets on the way; hold the vertices that do,
 *           and ask again, until nothing meets.
 * Threads:  one.
 *
 *     mpirun -n 4 cloth_mpi [FRAMES]      prints the same line for any number of ranks
 */
#include <mpi.h>

#include "pccd_mpi.h"
#include "sheet.h"

enum { SIDE = 33, CLOTH = SIDE * SIDE, VERTICES = 2 * CLOTH, ROUNDS = 60 };
enum { SHEET = 2 * (SIDE - 1) * (SIDE - 1), TRIANGLES = 2 * SHEET };
#define RADIUS 0.3
#define FALL   5e-5 /* gravity, in units per frame squared */

/* Arrays for the whole mesh; a rank knows its rows, the rows beside them, and the
 * ball. */
static double x[VERTICES][3], was[VERTICES][3], end[VERTICES][3];
static uint32_t triangles[TRIANGLES][3];
static unsigned char held[VERTICES]; /* does it stay where it is? */
static int rank, ranks, first, rows;

static void must(struct pccd_mpi *world, int status)
{
    if (status != 0) {
        fprintf(stderr, "wrong: %s\n", pccd_mpi_error_text(world));
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

/* The rows beside this rank's, from those who have them. */
static void exchange_rows(double (*a)[3])
{
    int below = rank > 0 ? rank - 1 : MPI_PROC_NULL;
    int above = rank + 1 < ranks ? rank + 1 : MPI_PROC_NULL;
    double *low = a[first * SIDE], *high = a[(first + rows) * SIDE];

    MPI_Sendrecv(low, 3 * SIDE, MPI_DOUBLE, below, 0, high, 3 * SIDE, MPI_DOUBLE, above,
                 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    MPI_Sendrecv(high - 3 * SIDE, 3 * SIDE, MPI_DOUBLE, above, 1,
                 rank > 0 ? low - 3 * SIDE : low, 3 * SIDE, MPI_DOUBLE, below, 1,
                 MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

/* Each vertex goes on, falls, and moves to where its neighbours keep their length. */
static void predict(void)
{
    static const int steps[4] = {1, -1, SIDE, -SIDE};
    const double length = 1.0 / (SIDE - 1);

    exchange_rows(x);
    memcpy(end, x, sizeof end);
    for (int v = first * SIDE; v < (first + rows) * SIDE; v++) {
        for (int k = 0; k < 3; k++) {
            end[v][k] += (x[v][k] - was[v][k]) * 0.99 - (k == 2 ? FALL : 0);
        }
        for (int n = 0; n < 4; n++) {
            int w = v + steps[n];
            if (w < 0 || w >= CLOTH || (n < 2 && w / SIDE != v / SIDE)) {
                continue;
            }
            double d[3] = {x[w][0] - x[v][0], x[w][1] - x[v][1], x[w][2] - x[v][2]};
            double now = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            for (int k = 0; k < 3; k++) {
                end[v][k] += 0.2 * (1 - length / now) * d[k];
            }
        }
    }
}

/* Note the vertices of a contact's two features. */
static void hold(struct pccd_mpi *world, const struct pccd_contact *contact)
{
    uint32_t points = contact->kind == PCCD_VF ? 1 : 2, v[4];

    must(world,
         pccd_mpi_feature(world, contact->object_a, points, contact->feature_a, v));
    must(world, pccd_mpi_feature(world, contact->object_b, 4 - points, contact->feature_b,
                                 v + points));
    for (int i = 0; i < 4; i++) {
        held[v[i]] = 1;
    }
}

int main(int argc, char **argv)
{
    struct pccd_mpi *world = NULL;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_motion motion = {.format = PCCD_FORMAT_F64};
    long frames = argc > 1 ? strtol(argv[1], NULL, 10) : 100;
    unsigned long long met = 0, sum = 0;
    uint32_t mesh = 0;

    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    first = SIDE * rank / ranks;
    rows = SIDE * (rank + 1) / ranks - first;
    sheet_and_ball(SIDE, RADIUS, x, triangles);
    memcpy(was, x, sizeof x);
    /* Both are numbered on from rank to rank; the last one has the ball, too. */
    int last = rank + 1 == ranks, begin = 2 * first * (SIDE - 1);
    motion.count = (uint32_t)(rows * SIDE + last * CLOTH);
    int stop = last ? TRIANGLES : 2 * (first + rows) * (SIDE - 1);
    const struct pccd_mpi_part part = {.vertex_total = VERTICES,
                                       .triangle_total = TRIANGLES,
                                       .vertex_count = motion.count,
                                       .format = PCCD_FORMAT_F64,
                                       .x = x[first * SIDE],
                                       .triangle_count = (uint32_t)(stop - begin),
                                       .triangles = triangles[begin]};
    must(world, pccd_mpi_open(MPI_COMM_WORLD, NULL, &world));
    must(world, pccd_mpi_mesh_put(world, &part, &mesh, NULL));
    must(world, pccd_mpi_add(world, mesh, &motion.object));
    motion.x0 = x[first * SIDE];
    motion.x1 = end[first * SIDE];
    for (long frame = 0; frame < frames; frame++) {
        predict();
        memset(held, 0, sizeof held);
        for (int round = 0; round < ROUNDS; round++) {
            for (int v = first * SIDE; v < (first + rows) * SIDE; v++) {
                memcpy(end[v], held[v] ? x[v] : end[v], sizeof end[v]);
            }
            must(world, pccd_mpi_step(world, &motion, 1, NULL, &answer));
            for (uint64_t i = 0; i < answer.count; i++) {
                hold(world, &answer.contacts[i]);
            }
            met += answer.total;
            sum = sum * 31 + answer.hash[1];
            round = answer.total == 0 ? ROUNDS : round;
            MPI_Allreduce(MPI_IN_PLACE, held, VERTICES, MPI_UNSIGNED_CHAR, MPI_MAX,
                          MPI_COMM_WORLD);
        }
        must(world, answer.total > 0);
        memcpy(was, x, sizeof x);
        memcpy(x, end, sizeof x);
    }
    if (rank == 0) {
        printf("%ld frames, %llu contacts, none is left, sum of hashes %016llx\n", frames,
               met, sum);
    }
    pccd_mpi_close(world);
    MPI_Finalize();
    return met == 0;
}
