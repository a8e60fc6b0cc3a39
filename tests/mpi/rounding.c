/* rounding.c - a program for mpirun: ranks that compute with floats in their own way.
 *
 * Ask a world everything while ranks round in each direction, or take subnormal numbers
 * for zeros; compare with what it says to ranks that do not, and see that each call gives
 * the rank its own way back. Usage:    mpirun -n RANKS rounding. The exit status is 1 if
 * anything else happened.
 */
#include <fenv.h>
#include <stdio.h>

#include "pccd_mpi.h"
#include "rounding.h"

#define TRIANGLES 60u
#define VERTICES  (3 * TRIANGLES)

static struct {
    int rank, size;
    struct pccd_mpi *world;
    double x[2][2][VERTICES][3]; /* this rank's: of an object, at an end */
    uint32_t count;
} test;

static void stop(const char *what)
{
    fprintf(stderr, "rank %d: %s: %s\n", test.rank, what,
            pccd_mpi_error_text(test.world));
    MPI_Abort(MPI_COMM_WORLD, 1);
}

#define DIRECTIONS 4
#define WAYS       (DIRECTIONS + 1) /* the last: subnormal numbers are zeros, both ways */
#define FLUSHES    0x8040u

static uint32_t flushes_now(void)
{
#if defined(__x86_64__)
    return common_rounding_now().sse & FLUSHES;
#else
    return 0;
#endif
}

static const int directions[WAYS] = {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO,
                                     FE_TONEAREST};

static void take_way(int way)
{
    (void)fesetround(directions[way]);
#if defined(__x86_64__)
    struct common_rounding now = common_rounding_now();
    now.sse = (now.sse & ~FLUSHES) | (way == DIRECTIONS ? FLUSHES : 0);
    common_rounding_set(&now);
#endif
}

/* Check that the caller has its own way back, after a call that must have gone well. */
static void check_call(const char *what, int status, int way, uint32_t flushes)
{
    if (status != PCCD_OK) {
        stop(what);
    }
    if (fegetround() != directions[way] || flushes_now() != flushes) {
        fprintf(stderr, "rank %d, way %d: %s has changed it\n", test.rank, way, what);
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

/* Digest of the records that gather() brings. */
struct digest {
    size_t record_bytes;
    uint64_t value;
};

static int digest_bytes(struct digest *digest, const void *bytes, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) { /* FNV-1a */
        digest->value =
            (digest->value ^ ((const uint8_t *)bytes)[i]) * UINT64_C(0x100000001b3);
    }
    return 0;
}

static int digest_records(void *context, const void *records, uint64_t count)
{
    struct digest *digest = context;
    return digest_bytes(digest, records, count * digest->record_bytes);
}

/* Triangle t is rank t % size's, with its vertices. In two objects each vertex goes its
 * own way. */
static struct pccd_mpi_part make_positions(double scale)
{
    static uint32_t triangles[TRIANGLES][3], vertices[VERTICES], numbers[TRIANGLES];
    uint32_t count = 0;
    for (uint32_t t = (uint32_t)test.rank; t < TRIANGLES; t += (uint32_t)test.size) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t v = 3 * count + k, random = (3 * t + k) * 2654435761u;
            triangles[count][k] = vertices[v] = 3 * t + k;
            for (int axis = 0; axis < 3; axis++) {
                for (int i = 0; i < 4; i++) {
                    random = random * 1664525u + 1013904223u;
                    test.x[i / 2][i % 2][v][axis] = scale * (random >> 8) / (1 << 23);
                }
            }
        }
        numbers[count++] = t;
    }
    test.count = 3 * count;
    return (struct pccd_mpi_part){.struct_bytes = sizeof(struct pccd_mpi_part),
                                  .vertex_total = VERTICES,
                                  .triangle_total = TRIANGLES,
                                  .vertex_count = test.count,
                                  .vertices = vertices,
                                  .format = PCCD_FORMAT_F64,
                                  .x = test.x[0][0],
                                  .triangle_count = count,
                                  .triangles = (const uint32_t *)triangles,
                                  .triangle_numbers = numbers};
}

static void digest_step(struct digest *digest, int way, uint32_t flushes,
                        const uint32_t objects[2], double separation)
{
    struct pccd_motion motions[2];
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    settings.separation = separation;
    for (int i = 0; i < 2; i++) {
        motions[i] = (struct pccd_motion){.object = objects[i],
                                          .count = test.count,
                                          .format = PCCD_FORMAT_F64,
                                          .x0 = test.x[i][0],
                                          .x1 = test.x[i][1]};
    }
    check_call("a step", pccd_mpi_step(test.world, motions, 2, &settings, &answer), way,
               flushes);
    (void)digest_bytes(digest, answer.hash, sizeof answer.hash);
    (void)digest_bytes(digest, &answer.toi_first, sizeof answer.toi_first);
    (void)digest_bytes(digest, &answer.safe_step, sizeof answer.safe_step);
    check_call("a share", pccd_mpi_get_share(test.world, &share), way, flushes);
    (void)digest_bytes(digest, &share.imbalance, sizeof share.imbalance);
    digest->record_bytes = sizeof(struct pccd_contact);
    check_call("contacts", pccd_mpi_gather(test.world, 0, digest_records, digest), way,
               flushes);
    if (answer.total == 0) {
        stop("a step without contacts");
    }
}

static void digest_near(struct digest *digest, int way, uint32_t flushes, double distance)
{
    static const enum pccd_near_what whats[] = {PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES,
                                                PCCD_NEAR_VERTICES, PCCD_NEAR_NEAREST,
                                                PCCD_NEAR_CROSSINGS};
    for (size_t i = 0; i < sizeof whats / sizeof whats[0]; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
        settings.what = whats[i];
        settings.distance = whats[i] == PCCD_NEAR_CROSSINGS ? 0 : distance;
        check_call("a question", pccd_mpi_near(test.world, NULL, 0, &settings, &answer),
                   way, flushes);
        (void)digest_bytes(digest, answer.hash, sizeof answer.hash);
        (void)digest_bytes(digest, &answer.distance_min, 2 * sizeof answer.distance_min);
        digest->record_bytes =
            whats[i] == PCCD_NEAR_VERTICES ? sizeof(double) : sizeof(struct pccd_near);
        check_call("records", pccd_mpi_gather(test.world, 0, digest_records, digest), way,
                   flushes);
    }
}

/* All that a new world says of a scene of that size, to ranks of which some compute in
 * that way. */
static uint64_t digest_world(int way, double scale)
{
    const struct pccd_mpi_options options = {
        .struct_bytes = sizeof options, .timeout_ms = 20000, .threads = 2};
    const struct pccd_object_settings thick = {
        .struct_bytes = sizeof thick, .what = PCCD_OBJECT_RADIUS, .radius = scale / 48};
    const struct pccd_mpi_part part = make_positions(scale);
    const double distance = scale / 3, separation = scale / 16; /* not in that way */
    struct digest digest = {0, UINT64_C(0xcbf29ce484222325)};
    uint32_t mesh = 0, objects[2];
    take_way(way);
    const uint32_t flushes = flushes_now();
    check_call("open", pccd_mpi_open(MPI_COMM_WORLD, &options, &test.world), way,
               flushes);
    check_call("a mesh", pccd_mpi_mesh_put(test.world, &part, &mesh, NULL), way, flushes);
    for (int i = 0; i < 2; i++) {
        check_call("an object", pccd_mpi_add(test.world, mesh, &objects[i]), way,
                   flushes);
        check_call("a radius", pccd_mpi_object_set(test.world, objects[i], &thick), way,
                   flushes);
    }
    digest_step(&digest, way, flushes, objects, separation);
    digest_near(&digest, way, flushes, distance);
    pccd_mpi_close(test.world);
    test.world = NULL;
    take_way(0);
    return digest.value;
}

/* Numbers of some size, and so small that their differences and products are subnormal;
 * each rank in each way, while the others compute in others. */
static int compute_otherwise(void)
{
    static const double scales[2] = {1, 0x1p-1020};
    int failed = 0;
    for (int k = 0; k < 2; k++) {
        const uint64_t expected = digest_world(0, scales[k]);
        for (int i = 0; i < WAYS; i++) {
            int way = (i + test.rank) % WAYS;
            if (digest_world(way, scales[k]) != expected) {
                fprintf(stderr, "rank %d, way %d, scale %g: another answer\n", test.rank,
                        way, scales[k]);
                failed = 1;
            }
        }
    }
    return failed;
}

int main(int argc, char **argv)
{
    int given = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &test.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &test.size);
    int failed = compute_otherwise();
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    MPI_Finalize();
    return failed;
}
