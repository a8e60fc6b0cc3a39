/* misuse.c - a program for mpirun: what happens when ranks do not do the same.
 *
 * Make one mistake on the last rank, by its name; see that every rank gets the same
 * status and sentence, and that the world goes on as if nothing had happened; or, where a
 * rank is missing, that the others end in time. Usage:    mpirun -n RANKS misuse MISTAKE;
 * 2 ranks at least. The exit status is 1 if anything else happened. A new mistake is a
 * function, a row of `mistakes`, and its name in `mistakes` of mpi_check.sh.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pccd_mpi.h"

#define VERTICES  60u
#define TRIANGLES 20u
#define WAIT_MS   700

static struct {
    int rank, size;
    struct pccd_mpi *world;
    uint32_t mesh, object;
    double x[VERTICES][3]; /* this rank's */
    uint32_t numbers[VERTICES], count;
    uint32_t triangles[TRIANGLES][3], triangle_numbers[TRIANGLES], triangle_count;
    bool is_last;
} test;

static void stop(const char *what)
{
    fprintf(stderr, "rank %d: %s: %s\n", test.rank, what,
            pccd_mpi_error_text(test.world));
    MPI_Abort(MPI_COMM_WORLD, 1);
}

/* Triangles that fall through each other; vertices and triangles in turn. */
static struct pccd_mpi_part make_part(void)
{
    test.count = test.triangle_count = 0;
    for (uint32_t v = 0; v < VERTICES; v++) {
        if (v % (uint32_t)test.size == (uint32_t)test.rank) {
            test.x[test.count][0] = v % 3 == 1 ? 2 : 0;
            test.x[test.count][1] = v % 3 == 2 ? 2 : 0;
            test.x[test.count][2] = v / 3 + (v % 3) * 0.3;
            test.numbers[test.count++] = v;
        }
    }
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        if (t % (uint32_t)test.size == (uint32_t)test.rank) {
            for (uint32_t k = 0; k < 3; k++) {
                test.triangles[test.triangle_count][k] = 3 * t + k;
            }
            test.triangle_numbers[test.triangle_count++] = t;
        }
    }
    return (struct pccd_mpi_part){.struct_bytes = sizeof(struct pccd_mpi_part),
                                  .vertex_total = VERTICES,
                                  .triangle_total = TRIANGLES,
                                  .vertex_count = test.count,
                                  .vertices = test.numbers,
                                  .format = PCCD_FORMAT_F64,
                                  .x = test.x,
                                  .triangle_count = test.triangle_count,
                                  .triangles = (const uint32_t *)test.triangles,
                                  .triangle_numbers = test.triangle_numbers};
}

/* The step that every rank knows: each other triangle falls by 10. */
static int step_in_mode(enum pccd_mode mode, double first_x, struct pccd_answer *answer)
{
    static double x0[VERTICES][3], x1[VERTICES][3];
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    const struct pccd_motion motion = {.object = test.object,
                                       .count = test.count,
                                       .format = PCCD_FORMAT_F64,
                                       .x0 = x0,
                                       .x1 = x1};
    for (uint32_t i = 0; i < test.count; i++) {
        memcpy(x0[i], test.x[i], sizeof x0[i]);
        memcpy(x1[i], test.x[i], sizeof x1[i]);
        x1[i][2] -= test.numbers[i] / 3 % 2 * 10.0;
    }
    if (test.count > 0) {
        x1[0][0] += first_x;
    }
    settings.mode = mode;
    return pccd_mpi_step(test.world, &motion, 1, &settings, answer);
}

/* Its hash; the world works. */
static uint64_t good_step(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    if (step_in_mode(PCCD_MODE_ALL, 0, &answer) != PCCD_OK) {
        stop("a good step");
    }
    if (answer.total == 0) {
        stop("a step without contacts");
    }
    return answer.hash[1];
}

/* ---- mistakes --------------------------------------------------------------------- */

static int put_part(const struct pccd_mpi_part *part)
{
    uint32_t mesh = 0;
    int status = pccd_mpi_mesh_put(test.world, part, &mesh, NULL);
    if (status == PCCD_OK) {
        stop("a mesh that is none was accepted");
    }
    return status;
}

static int wrong_order(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t object;
    return test.is_last ? pccd_mpi_add(test.world, test.mesh, &object)
                        : step_in_mode(PCCD_MODE_ALL, 0, &answer);
}

static int wrong_totals(void)
{
    struct pccd_mpi_part part = make_part();
    part.vertex_total += test.is_last;
    return put_part(&part);
}

static int no_mode_of_ranks(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    return step_in_mode(PCCD_MODE_FIRST_PER_PAIR, 0, &answer);
}

static int wrong_mode(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    return step_in_mode(test.is_last ? PCCD_MODE_FIRST : PCCD_MODE_ALL, 0, &answer);
}

static int wrong_settings(void)
{
    const struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                                  .what = PCCD_OBJECT_RADIUS,
                                                  .radius = test.is_last ? 0.1 : 0.2};
    return pccd_mpi_object_set(test.world, test.object, &settings);
}

static int two_owners(void)
{
    struct pccd_mpi_part part = make_part();
    if (test.is_last) {
        test.numbers[0] = 0; /* the first rank has it, too */
    }
    return put_part(&part);
}

static int no_owner(void)
{
    struct pccd_mpi_part part = make_part();
    part.vertex_count -= test.is_last;
    return put_part(&part);
}

static int two_triangles(void)
{
    struct pccd_mpi_part part = make_part();
    if (test.is_last) {
        test.triangle_numbers[0] = 0;
    }
    return put_part(&part);
}

static int no_triangle(void)
{
    struct pccd_mpi_part part = make_part();
    part.triangle_count -= test.is_last;
    return put_part(&part);
}

static int bad_index(void)
{
    struct pccd_mpi_part part = make_part();
    if (test.is_last) {
        test.triangles[0][1] = VERTICES;
    }
    return put_part(&part);
}

static int not_finite(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    return step_in_mode(PCCD_MODE_ALL, test.is_last ? NAN : 0, &answer);
}

static int no_object(void)
{
    return pccd_mpi_remove(test.world, 77);
}

/* The last rank asks something else. */
static int ask_near(enum pccd_near_what what, enum pccd_near_what of_last, double last)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = test.is_last ? of_last : what;
    settings.distance = test.is_last ? last : 0.5;
    return pccd_mpi_near(test.world, NULL, 0, &settings, &answer);
}

static int near_distance(void)
{
    return ask_near(PCCD_NEAR_VERTICES, PCCD_NEAR_VERTICES, 0.25);
}

static int near_kind(void)
{
    return ask_near(PCCD_NEAR_PAIRS, PCCD_NEAR_FEATURES, 0.5);
}

static int near_negative(void)
{
    return ask_near(PCCD_NEAR_NEAREST, PCCD_NEAR_NEAREST, -1);
}

/* NEAREST alone looks at a gap. */
static int near_gap(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = PCCD_NEAR_NEAREST;
    settings.gap = test.is_last ? -1 : 0.5;
    return pccd_mpi_near(test.world, NULL, 0, &settings, &answer);
}

static int near_far(void)
{
    return ask_near(PCCD_NEAR_FEATURES, PCCD_NEAR_FEATURES, 2e18);
}

/* An object that there is not, as all ranks say: before anything is exchanged. */
static int near_object(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = PCCD_NEAR_DEPTH;
    settings.object_b = 77;
    return pccd_mpi_near(test.world, NULL, 0, &settings, &answer);
}

/* The triangles are one mesh, which is open, and a second object of it is beside it. */
static int near_open(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    uint32_t other = 0;
    settings.what = PCCD_NEAR_DEPTH;
    if (pccd_mpi_add(test.world, test.mesh, &other) != PCCD_OK) {
        stop("no second object");
    }
    int status = pccd_mpi_near(test.world, NULL, 0, &settings, &answer);
    char text[256];
    snprintf(text, sizeof text, "%s", pccd_mpi_error_text(test.world));
    if (strstr(text,
               "1 of its faces run along the edge from vertex 0 to 1, and 0 back") ==
        NULL) {
        stop("another text");
    }
    if (pccd_mpi_remove(test.world, other) != PCCD_OK) {
        stop("it does not go");
    }
    return status;
}

/* Put no part on one rank. */
static int no_part(void)
{
    const struct pccd_mpi_part part = make_part();
    return put_part(test.is_last ? NULL : &part);
}

static int no_handle(void)
{
    uint32_t object;
    return pccd_mpi_add(test.world, test.mesh, test.is_last ? NULL : &object);
}

static int no_settings(void)
{
    const struct pccd_object_settings settings = {.what = PCCD_OBJECT_SELF};
    return pccd_mpi_object_set(test.world, test.object, test.is_last ? NULL : &settings);
}

static int no_answer(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    return pccd_mpi_step(test.world, NULL, 0, NULL, test.is_last ? NULL : &answer);
}

static int no_motions(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    return pccd_mpi_near(test.world, NULL, test.is_last, NULL, &answer);
}

static int no_share(void)
{
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    return pccd_mpi_get_share(test.world, test.is_last ? NULL : &share);
}

/* Every function without a world, which no rank hears of. */
static int no_world(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_mpi_part part = make_part();
    struct pccd_object_settings settings = {.what = 0};
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    uint32_t vertices[3], handle = 0;
    const int got[] = {pccd_mpi_open(MPI_COMM_WORLD, NULL, NULL),
                       pccd_mpi_threads(MPI_COMM_WORLD, NULL),
                       pccd_mpi_mesh_put(NULL, &part, &handle, NULL),
                       pccd_mpi_mesh_destroy(NULL, 1),
                       pccd_mpi_add(NULL, 1, &handle),
                       pccd_mpi_remove(NULL, 1),
                       pccd_mpi_object_set(NULL, 1, &settings),
                       pccd_mpi_pair_ignore(NULL, 1, 2, true),
                       pccd_mpi_step(NULL, NULL, 0, NULL, &answer),
                       pccd_mpi_near(NULL, NULL, 0, NULL, &answer),
                       pccd_mpi_gather(NULL, 0, NULL, NULL),
                       pccd_mpi_feature(NULL, 1, 1, 1, vertices),
                       pccd_mpi_get_share(NULL, &share)};
    for (size_t i = 0; i < sizeof got / sizeof got[0]; i++) {
        if (got[i] != PCCD_E_INVAL) {
            stop("a call without a world");
        }
    }
    return pccd_mpi_feature(test.world, test.object, 1, 0, NULL);
}

static const struct mistake {
    const char *name;
    int (*make)(void);
    int status;
    const char *text; /* %d: the last rank */
} mistakes[] = {
    {"order", wrong_order, PCCD_E_STATE, "rank %d called pccd_mpi_add"},
    {"totals", wrong_totals, PCCD_E_INVAL, "rank %d gave other arguments"},
    {"no-mode", no_mode_of_ranks, PCCD_E_INVAL, "mode first-per-pair: a rank does not"},
    {"mode", wrong_mode, PCCD_E_INVAL, "rank %d gave other arguments to pccd_mpi_step"},
    {"settings", wrong_settings, PCCD_E_INVAL, "rank %d gave other arguments"},
    {"two-owners", two_owners, PCCD_E_INVAL, "two owners of vertex 0: ranks 0 and %d"},
    {"no-owner", no_owner, PCCD_E_INVAL, "vertex 59 is in no rank's part"},
    {"two-triangles", two_triangles, PCCD_E_INVAL, "two owners of triangle 0"},
    {"no-triangle", no_triangle, PCCD_E_INVAL, "is in no rank's part"},
    {"index", bad_index, PCCD_E_INDEX, "rank %d: triangle 0 names vertex 60"},
    {"not-finite", not_finite, PCCD_E_NOTFINITE, "rank %d: a position"},
    {"no-object", no_object, PCCD_E_HANDLE, "there is no object 77"},
    {"near-distance", near_distance, PCCD_E_INVAL,
     "rank %d gave other arguments to pccd_mpi_near"},
    {"near-kind", near_kind, PCCD_E_INVAL,
     "rank %d gave other arguments to pccd_mpi_near"},
    {"near-negative", near_negative, PCCD_E_INVAL, "distance is negative"},
    {"near-gap", near_gap, PCCD_E_INVAL, "gap is negative"},
    {"near-far", near_far, PCCD_E_LIMIT, "distance is beyond 1e+18"},
    {"near-object", near_object, PCCD_E_HANDLE, "object_b 77 is not in the scene"},
    {"no-part", no_part, PCCD_E_INVAL, "rank %d"},
    {"no-handle", no_handle, PCCD_E_INVAL, "rank %d: object is NULL"},
    {"no-settings", no_settings, PCCD_E_INVAL, "rank %d: settings is NULL"},
    {"no-answer", no_answer, PCCD_E_INVAL, "rank %d: answer is NULL"},
    {"no-motions", no_motions, PCCD_E_INVAL, "rank %d: motions is NULL"},
    {"no-share", no_share, PCCD_E_INVAL, "rank %d: share is NULL"},
    {"no-world", no_world, PCCD_E_INVAL, "vertices is NULL"},
    {"near-open", near_open, PCCD_E_INVAL, "is not closed"},
};

/* The same status and sentence on every rank, and a world as before. */
static int make_mistake(const struct mistake *mistake)
{
    char expected[128];
    uint64_t hash = good_step();
    int status = mistake->make();
    const char *text = pccd_mpi_error_text(test.world);
    snprintf(expected, sizeof expected, "%s", mistake->text);
    char *place = strstr(expected, "%d");
    if (place != NULL) { /* one digit: tests have fewer than ten ranks */
        place[0] = (char)('0' + test.size - 1);
        memmove(place + 1, place + 2, strlen(place + 2) + 1);
    }
    if (status != mistake->status || strstr(text, expected) == NULL) {
        fprintf(stderr, "rank %d: status %s, not %s; text \"%s\", not \"%s\"\n",
                test.rank, pccd_status_name(status), pccd_status_name(mistake->status),
                text, expected);
        return 1;
    }
    (void)make_part();
    if (good_step() != hash) {
        fprintf(stderr, "rank %d: another answer after the mistake\n", test.rank);
        return 1;
    }
    return 0;
}

/* The last rank does not come; the others say so in time, and that it is over. */
static int stay_away(void)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    (void)good_step();
    if (test.is_last) {
        usleep(3 * WAIT_MS * 1000);
        return 0;
    }
    double begin = MPI_Wtime();
    int status = step_in_mode(PCCD_MODE_ALL, 0, &answer);
    double waited = MPI_Wtime() - begin;
    int later = step_in_mode(PCCD_MODE_ALL, 0, &answer);
    if (status != PCCD_E_TIMEOUT || later != PCCD_E_STATE || waited < WAIT_MS / 1e3 ||
        waited > 3 * WAIT_MS / 1e3) {
        fprintf(stderr, "rank %d: status %s after %g s, then %s\n", test.rank,
                pccd_status_name(status), waited, pccd_status_name(later));
        return 1;
    }
    return 0;
}

static int begin(void)
{
    const struct pccd_mpi_options options = {
        .struct_bytes = sizeof options, .timeout_ms = WAIT_MS, .threads = 1};
    struct pccd_mpi_part part = make_part();
    test.is_last = test.rank == test.size - 1;
    if (pccd_mpi_open(MPI_COMM_WORLD, &options, &test.world) != PCCD_OK ||
        pccd_mpi_mesh_put(test.world, &part, &test.mesh, NULL) != PCCD_OK ||
        pccd_mpi_add(test.world, test.mesh, &test.object) != PCCD_OK) {
        stop("no world");
    }
    return 0;
}

static int run(const char *name)
{
    if (strcmp(name, "absent") == 0) {
        return stay_away();
    }
    if (strcmp(name, "dies") == 0) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        (void)good_step();
        if (test.is_last) {
            abort();
        }
        return step_in_mode(PCCD_MODE_ALL, 0, &answer) == PCCD_OK;
    }
    for (size_t i = 0; i < sizeof mistakes / sizeof mistakes[0]; i++) {
        if (strcmp(name, mistakes[i].name) == 0) {
            return make_mistake(&mistakes[i]);
        }
    }
    fprintf(stderr, "no mistake \"%s\"\n", name);
    return 1;
}

int main(int argc, char **argv)
{
    int given = 0, failed = 1;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &test.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &test.size);
    if (argc == 2 && test.size > 1 && begin() == 0) {
        failed = run(argv[1]);
    }
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    pccd_mpi_close(test.world);
    MPI_Finalize();
    return failed;
}
