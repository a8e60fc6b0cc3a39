/* stop.c - a program for mpirun: steps and questions that end before they are done.
 *
 * Let one rank prove a contact while another has much to do; let a deadline pass; cancel
 * from a second thread; see by the work that was counted that all ranks have stopped, and
 * that later calls answer what one process answers. And let records be too many for mode
 * first to know the earliest. Usage:    mpirun -n RANKS stop yes|deadline|cancel, 2 ranks
 * at least, or stop turns CALLS [SEED], or stop crowd. The exit status is 1 if anything
 * else happened.
 */
#include <inttypes.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pccd_mpi.h"
#include "prng.h"

#define LENGTH     100.0 /* of a needle */
#define APART      1e6   /* the clusters */
#define MANY       2500u /* needles of a cluster that takes long */
#define TRIES      5     /* as the system may let the other rank wait for once */
#define TURN_SIZE  12u   /* needles of a cluster that does not */
#define HITS_MAX   3000u /* clusters */
#define KEPT       8u    /* records, where they are too many */
#define STOP_AFTER 20000 /* microseconds */

/* Two objects. The first has, in each cluster, needles beside each other, whose boxes
 * overlap where they are close, and a floor; the second one a leaf above each floor. */
struct part {
    uint32_t mesh, object, vertex_total, triangle_total;
    double (*x0)[3], (*x1)[3]; /* of the whole */
    uint32_t (*triangles)[3];
    /* this rank's: those whose number is its own, modulo the ranks */
    double (*own0)[3], (*own1)[3];
    uint32_t *vertices, vertex_count, *numbers, (*own)[3], count;
};

static struct {
    int rank, size;
    struct pccd_mpi *world;
    struct pccd_client *one; /* on the first rank */
    uint32_t scene, clusters, needles;
    struct part parts[2];
    uint64_t calls, early, yes;
    struct prng prng; /* the same on every rank */
    atomic_bool is_over;
    double
        falls[HITS_MAX];   /* how far the leaf of each cluster falls; the floor is at 1 */
    uint64_t record_limit; /* of the world */
} test;

static void stop(const char *what)
{
    fprintf(stderr, "rank %d, call %" PRIu64 ": %s: %s\n", test.rank, test.calls, what,
            pccd_mpi_error_text(test.world));
    MPI_Abort(MPI_COMM_WORLD, 1);
}

static void must(bool is_so, const char *what)
{
    if (!is_so) {
        stop(what);
    }
}

static void *need(size_t bytes)
{
    void *memory = calloc(bytes + 1, 1);
    must(memory != NULL, "out of memory");
    return memory;
}

/* ---- no message is left ------------------------------------------------------------ */

/* In the place of MPI's: libpccd-mpi frees its communicator when its world is closed. */
int MPI_Comm_free(MPI_Comm *comm)
{
    int is_there = 0;
    PMPI_Barrier(*comm);
    PMPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, *comm, &is_there, MPI_STATUS_IGNORE);
    if (is_there) {
        fprintf(stderr, "rank %d: a message is left over\n", test.rank);
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
    return PMPI_Comm_free(comm);
}

/* ---- the scene --------------------------------------------------------------------- */

static void allocate(struct part *part, uint32_t triangles)
{
    uint32_t vertices = 3 * triangles;
    *part = (struct part){.vertex_total = vertices, .triangle_total = triangles};
    part->x0 = need(vertices * sizeof *part->x0);
    part->x1 = need(vertices * sizeof *part->x1);
    part->own0 = need(vertices * sizeof *part->own0);
    part->own1 = need(vertices * sizeof *part->own1);
    part->vertices = need(vertices * sizeof *part->vertices);
    part->triangles = need(triangles * sizeof *part->triangles);
    part->own = need(triangles * sizeof *part->own);
    part->numbers = need(triangles * sizeof *part->numbers);
    for (uint32_t v = 0; v < vertices; v++) {
        part->triangles[v / 3][v % 3] = v;
        if (v % (uint32_t)test.size == (uint32_t)test.rank) {
            part->vertices[part->vertex_count++] = v;
        }
    }
    for (uint32_t t = 0; t < triangles; t++) {
        if (t % (uint32_t)test.size == (uint32_t)test.rank) {
            memcpy(part->own[part->count], part->triangles[t], sizeof *part->own);
            part->numbers[part->count++] = t;
        }
    }
}

/* Place a needle of a cluster; each lies in a plane of its own beside the last one. */
static void place_needle(double (*x)[3], double at, double beside)
{
    for (int k = 0; k < 3; k++) {
        double from = (k == 0 ? at + beside : k == 1 ? -beside : 0);
        x[0][k] = from;
        x[1][k] = from + LENGTH;
        x[2][k] = from + LENGTH / 2 + (k < 2 ? 1 : -2);
    }
}

static void place_flat(double (*x)[3], double at, double height)
{
    for (int v = 0; v < 3; v++) {
        x[v][0] = at - 5 * LENGTH + (v == 1);
        x[v][1] = v == 2;
        x[v][2] = height;
    }
}

/* spacing[c]: from one needle of cluster c to the next. */
static void make_scene(uint32_t clusters, uint32_t needles, const double *spacing)
{
    test.clusters = clusters;
    test.needles = needles;
    allocate(&test.parts[0], clusters * (needles + 1));
    allocate(&test.parts[1], clusters);
    for (uint32_t c = 0; c < clusters; c++) {
        double(*x)[3] = test.parts[0].x0 + 3 * (size_t)c * (needles + 1);
        test.falls[c] = 0.1;
        for (uint32_t i = 0; i < needles; i++) {
            place_needle(x + 3 * (size_t)i, APART * c, spacing[c] * i);
        }
        place_flat(x + 3 * (size_t)needles, APART * c, 0);
        place_flat(test.parts[1].x0 + 3 * (size_t)c, APART * c + 0.1, 1);
    }
}

static void take_own(const struct part *part, double (*from)[3], double (*to)[3])
{
    for (uint32_t i = 0; i < part->vertex_count; i++) {
        memcpy(to[i], from[part->vertices[i]], sizeof *to);
    }
}

/* All needles go along themselves, and leaves fall. Where everything is, is moved by
 * `away`. */
static void move(double away)
{
    for (int p = 0; p < 2; p++) {
        struct part *part = &test.parts[p];
        for (uint32_t v = 0; v < part->vertex_total; v++) {
            for (int k = 0; k < 3; k++) {
                double by = p == 0 ? 0.01 : k < 2 ? 0 : -test.falls[v / 3];
                part->x1[v][k] = part->x0[v][k] + (k == 1 ? away : 0) + by;
                part->x0[v][k] += k == 1 ? away : 0;
            }
        }
        take_own(part, part->x0, part->own0);
        take_own(part, part->x1, part->own1);
    }
}

static void open_world(void)
{
    const struct pccd_mpi_options options = {
        .struct_bytes = sizeof options, .threads = 1, .record_limit = test.record_limit};
    must(pccd_mpi_open(MPI_COMM_WORLD, &options, &test.world) == 0, "open");
    if (test.rank == 0) {
        const struct pccd_options of_one = {.struct_bytes = sizeof of_one,
                                            .url = "direct:"};
        must(pccd_connect(&of_one, &test.one) == 0, "connect");
        must(pccd_scene_create(test.one, NULL, &test.scene) == 0, "scene");
    }
    for (int p = 0; p < 2; p++) {
        struct part *part = &test.parts[p];
        take_own(part, part->x0, part->own0);
        const struct pccd_mpi_part own = {.struct_bytes = sizeof own,
                                          .vertex_total = part->vertex_total,
                                          .triangle_total = part->triangle_total,
                                          .vertex_count = part->vertex_count,
                                          .vertices = part->vertices,
                                          .format = PCCD_FORMAT_F64,
                                          .x = part->own0,
                                          .triangle_count = part->count,
                                          .triangles = (const uint32_t *)part->own,
                                          .triangle_numbers = part->numbers};
        const struct pccd_mesh_data all = {.struct_bytes = sizeof all,
                                           .x = part->x0,
                                           .format = PCCD_FORMAT_F64,
                                           .vertex_count = part->vertex_total,
                                           .triangle_count = part->triangle_total,
                                           .triangles =
                                               (const uint32_t *)part->triangles};
        uint32_t mesh = 0, object = 0;
        must(pccd_mpi_mesh_put(test.world, &own, &part->mesh, NULL) == 0, "mesh");
        must(pccd_mpi_add(test.world, part->mesh, &part->object) == 0, "add");
        if (test.rank == 0) {
            must(pccd_mesh_put(test.one, &all, &mesh, NULL) == 0 &&
                     pccd_scene_add(test.one, test.scene, mesh, &object) == 0 &&
                     object == part->object,
                 "one process");
        }
    }
}

static void close_world(void)
{
    pccd_mpi_close(test.world);
    pccd_close(test.one);
    test.world = NULL;
    test.one = NULL;
    for (int p = 0; p < 2; p++) {
        struct part *part = &test.parts[p];
        free(part->x0);
        free(part->x1);
        free(part->own0);
        free(part->own1);
        free(part->vertices);
        free(part->triangles);
        free(part->own);
        free(part->numbers);
    }
}

/* ---- calls ------------------------------------------------------------------------- */

/* A step, or a question if `near` is not NULL. */
static struct pccd_answer ask(const struct pccd_step_settings *settings,
                              const struct pccd_near_settings *near)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_motion motions[2];
    for (int p = 0; p < 2; p++) {
        const struct part *part = &test.parts[p];
        motions[p] = (struct pccd_motion){.object = part->object,
                                          .count = part->vertex_count,
                                          .format = PCCD_FORMAT_F64,
                                          .x0 = part->own0,
                                          .x1 = part->own1};
    }
    test.calls++;
    must((near != NULL ? pccd_mpi_near(test.world, motions, 2, near, &answer)
                       : pccd_mpi_step(test.world, motions, 2, settings, &answer)) == 0,
         "a call");
    test.early += answer.incomplete != PCCD_COMPLETE;
    test.yes += answer.verdict == PCCD_VERDICT_YES;
    return answer;
}

/* On the first rank: the same of one process. */
static void ask_one_and_keep(const struct pccd_step_settings *settings,
                             const struct pccd_near_settings *near,
                             struct pccd_answer *answer)
{
    struct pccd_motion motions[2];
    for (int p = 0; p < 2; p++) {
        const struct part *part = &test.parts[p];
        motions[p] = (struct pccd_motion){.object = part->object,
                                          .count = part->vertex_total,
                                          .format = PCCD_FORMAT_F64,
                                          .x0 = part->x0,
                                          .x1 = part->x1};
    }
    must((near != NULL
              ? pccd_ask_near(test.one, test.scene, motions, 2, near, answer)
              : pccd_step(test.one, test.scene, motions, 2, settings, answer)) == 0,
         pccd_error_text(test.one));
}

/* Without records. */
static struct pccd_answer ask_one(const struct pccd_step_settings *settings,
                                  const struct pccd_near_settings *near)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    ask_one_and_keep(settings, near, &answer);
    pccd_answer_release(test.one, &answer);
    return answer;
}

static struct pccd_answer step(enum pccd_mode mode, uint64_t deadline_ns)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    settings.mode = mode;
    settings.deadline_ns = deadline_ns;
    return ask(&settings, NULL);
}

static struct pccd_mpi_share share_now(void)
{
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    must(pccd_mpi_get_share(test.world, &share) == 0, "share");
    return share;
}

/* Counted in the last step, of all ranks. */
static uint64_t work_of_all(void)
{
    uint64_t work = share_now().work;
    MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    return work;
}

/* One cluster that takes long, and one that does not and has the leaf that may fall. Both
 * have as many triangles, so the first cut puts them on different ranks. */
static void open_uneven(void)
{
    const double spacing[2] = {1e-3, 3 * LENGTH};
    make_scene(2, MANY, spacing);
    open_world();
}

/* ---- a yes ------------------------------------------------------------------------- */

/* Steps that one rank decides at once, and then one that nobody does. */
static void prove(void)
{
    uint64_t least = UINT64_MAX;
    open_uneven();
    test.falls[1] = 2;
    move(0);
    for (int i = 0; i < TRIES; i++) {
        struct pccd_answer answer = step(PCCD_MODE_ANY, 0);
        must(answer.verdict == PCCD_VERDICT_YES && answer.incomplete == PCCD_COMPLETE,
             "no yes");
        uint64_t work = work_of_all();
        least = work < least ? work : least;
    }
    must(share_now().cuts == 1, "cut by the work of a step that ended early");
    test.falls[1] = 0.1;
    move(0);
    must(step(PCCD_MODE_ANY, 0).verdict == PCCD_VERDICT_NO, "a yes");
    uint64_t whole = work_of_all();
    if (test.rank == 0) {
        printf("# work until a yes %" PRIu64 ", without one %" PRIu64 "\n", least, whole);
    }
    must(least < whole / 2, "a yes did not stop the others");
    close_world();
}

/* ---- a deadline -------------------------------------------------------------------- */

/* Steps whose deadline has passed do nothing but move. */
static void let_pass(void)
{
    open_uneven();
    test.falls[1] = 2;
    move(0);
    must(step(PCCD_MODE_ALL, 1).incomplete == PCCD_INCOMPLETE_DEADLINE, "in time");
    must(share_now().cuts == 0 && share_now().searches == 0, "cut too late");
    uint64_t work = UINT64_MAX, mine;
    for (int i = 0; i < TRIES; i++) {
        struct pccd_answer answer = step(PCCD_MODE_ALL, 1000 * STOP_AFTER);
        must(answer.incomplete == PCCD_INCOMPLETE_DEADLINE, "in time");
        mine = work_of_all();
        work = mine < work ? mine : work;
    }
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    for (int i = 0; i < 2; i++) {
        struct pccd_answer answer = ask(&settings, NULL);
        must(answer.incomplete == PCCD_COMPLETE, "not whole");
        mine = work_of_all();
        must(work < mine / 2, "a deadline did not stop a rank");
        if (test.rank == 0) {
            struct pccd_answer one = ask_one(&settings, NULL);
            must(one.total > 0 && memcmp(one.hash, answer.hash, sizeof one.hash) == 0,
                 "another hash");
        }
        uint64_t searches = share_now().searches;
        move(50 * LENGTH); /* out of all boxes */
        must(step(PCCD_MODE_ALL, 1).incomplete == PCCD_INCOMPLETE_DEADLINE, "in time");
        must(share_now().searches == searches, "ghosts were chosen too late");
    }
    close_world();
}

/* ---- a second thread --------------------------------------------------------------- */

static void *cancel_soon(void *unused)
{
    while (!atomic_load(&test.is_over)) { /* the call may not have begun */
        usleep(STOP_AFTER);
        pccd_mpi_cancel(test.world);
    }
    return unused;
}

static void cancel_by(int rank, const struct pccd_step_settings *settings,
                      const struct pccd_near_settings *near)
{
    pthread_t thread;
    atomic_store(&test.is_over, false);
    if (test.rank == rank) {
        must(pthread_create(&thread, NULL, cancel_soon, NULL) == 0, "no thread");
    }
    struct pccd_answer answer = ask(settings, near);
    must(answer.incomplete == PCCD_INCOMPLETE_CANCELLED, "not cancelled");
    atomic_store(&test.is_over, true);
    if (test.rank == rank) {
        pthread_join(thread, NULL);
    }
}

/* By a rank that computes and by one that waits, in each mode; and what is near. */
static void cancel(void)
{
    uint64_t work[PCCD_MODE_PAIRS + 1];
    open_uneven();
    move(0);
    for (int mode = 0; mode <= PCCD_MODE_PAIRS; mode++) {
        struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
        settings.mode = (enum pccd_mode)mode;
        work[mode] = UINT64_MAX;
        for (int rank = 0; rank < test.size; rank++) {
            cancel_by(rank, &settings, NULL);
            uint64_t most = work_of_all();
            work[mode] = most < work[mode] ? most : work[mode];
        }
        const struct pccd_near_settings near = {.struct_bytes = sizeof near,
                                                .what = (enum pccd_near_what)(mode % 3),
                                                .distance = 1e-6};
        cancel_by(mode % test.size, NULL, &near);
    }
    pccd_mpi_cancel(test.world); /* nothing is there to be cancelled */
    must(step(PCCD_MODE_ALL, 0).incomplete == PCCD_COMPLETE, "cancelled");
    uint64_t whole = work_of_all(); /* the same in each mode, as nothing meets */
    for (int mode = 0; mode <= PCCD_MODE_PAIRS; mode++) {
        if (test.rank == 0) {
            printf("# mode %d: work until a cancel %" PRIu64 ", else %" PRIu64 "\n", mode,
                   work[mode], whole);
        }
        must(work[mode] < whole / 2, "a cancel did not stop a rank");
    }
    close_world();
}

/* ---- by turns ---------------------------------------------------------------------- */

static uint64_t below(uint64_t bound)
{
    return prng_next(&test.prng) % bound;
}

static void *cancel_once(void *delay)
{
    usleep((useconds_t)(uintptr_t)delay);
    pccd_mpi_cancel(test.world);
    return NULL;
}

/* Compare what the ranks say with what one process says; is_cut: the call may have ended
 * early. */
static void compare(const struct pccd_answer *ranks, const struct pccd_answer *one,
                    bool is_cut)
{
    if (ranks->incomplete == PCCD_COMPLETE) {
        must(one->incomplete == PCCD_COMPLETE && ranks->verdict == one->verdict &&
                 ranks->total == one->total && ranks->toi_first == one->toi_first &&
                 ranks->safe_step == one->safe_step &&
                 memcmp(ranks->hash, one->hash, sizeof one->hash) == 0,
             "another answer");
        return;
    }
    must(is_cut, "incomplete without a reason");
    must(ranks->incomplete == PCCD_INCOMPLETE_DEADLINE ||
             ranks->incomplete == PCCD_INCOMPLETE_CANCELLED,
         "incomplete for another reason");
    must(ranks->verdict == PCCD_VERDICT_NONE && ranks->safe_step == 0, "a verdict");
    must(one->mode == PCCD_MODE_FIRST || ranks->total <= one->total, "more records");
}

/* A call with a random mode or question, in some of them a deadline or a cancel. */
static void turn(void)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_near_settings near = PCCD_NEAR_SETTINGS_INIT;
    bool asks = below(3) == 0;
    uint64_t deadline_ns = below(8) == 0 ? 1 + below(300000) : 0;
    int canceller = below(8) == 0 ? (int)below((uint64_t)test.size) : -1;
    uintptr_t delay = below(300), rarity = 1 + below(4);
    pthread_t thread;
    for (uint32_t c = 0; c < test.clusters; c++) {
        test.falls[c] = below(rarity * rarity) == 0 ? 2 : 0.1;
    }
    settings.mode = below(2) == 0 ? PCCD_MODE_ANY : (enum pccd_mode)below(4);
    settings.method = below(4) == 0 ? PCCD_METHOD_PAPER : PCCD_METHOD_DEFAULT;
    near.what = (enum pccd_near_what)below(PCCD_NEAR_DEPTH);
    near.distance = 0.5;
    settings.deadline_ns = near.deadline_ns = deadline_ns;
    move(below(10) == 0 ? 50 * LENGTH : 0);
    if (test.rank == canceller) {
        must(pthread_create(&thread, NULL, cancel_once, (void *)delay) == 0, "thread");
    }
    struct pccd_answer answer = ask(&settings, asks ? &near : NULL);
    if (test.rank == canceller) {
        pthread_join(thread, NULL);
    }
    if (test.rank == 0) {
        settings.deadline_ns = near.deadline_ns = 0;
        struct pccd_answer one = ask_one(&settings, asks ? &near : NULL);
        compare(&answer, &one, deadline_ns > 0 || canceller >= 0);
    }
}

static void take_turns(uint64_t calls, uint64_t seed)
{
    double spacing[64];
    uint32_t clusters = 2 * (uint32_t)test.size;
    clusters = clusters < 64 ? clusters : 64;
    for (uint32_t c = 0; c < clusters; c++) {
        spacing[c] = 1;
    }
    test.prng.state = seed;
    make_scene(clusters, TURN_SIZE, spacing);
    open_world();
    for (uint64_t i = 0; i < calls; i++) {
        turn();
    }
    if (test.rank == 0) {
        printf("# %d ranks, %" PRIu64 " calls, seed %" PRIu64 ": %" PRIu64
               " ended early, %" PRIu64 " yes\n",
               test.size, test.calls, seed, test.early, test.yes);
        must(calls < 100 || (test.early > 0 && test.yes > 0), "nothing ended early");
    }
    close_world();
}

/* ---- too many for mode first ------------------------------------------------------- */

/* Records of the ranks, on the first one. */
struct kept {
    struct pccd_contact contacts[KEPT];
    uint64_t count;
};

static int keep(void *context, const void *records, uint64_t count)
{
    struct kept *kept = context;
    must(kept->count + count <= KEPT, "more records than are kept");
    memcpy(kept->contacts + kept->count, records, count * sizeof *kept->contacts);
    kept->count += count;
    return 0;
}

static bool is_among(const struct pccd_contact *contact, const struct pccd_answer *all)
{
    for (uint64_t i = 0; i < all->count; i++) {
        if (memcmp(contact, &all->contacts[i], sizeof *contact) == 0) {
            return true;
        }
    }
    return false;
}

/* Find those of all contacts that may be the earliest; write as many as fit to
 * firsts[KEPT + 1]. Return how many there are. */
static uint64_t find_firsts(const struct pccd_answer *all, struct pccd_contact *firsts)
{
    double bound = 1;
    uint64_t count = 0;
    for (uint64_t i = 0; i < all->count; i++) {
        bool is_proved = (all->contacts[i].flags & PCCD_PROVED) != 0;
        bound = is_proved && all->contacts[i].toi_hi < bound ? all->contacts[i].toi_hi
                                                             : bound;
    }
    for (uint64_t i = 0; i < all->count; i++) {
        if (all->contacts[i].toi <= bound) {
            firsts[count < KEPT ? count : KEPT] = all->contacts[i];
            count++;
        }
    }
    return count;
}

/* However few are kept, a rank has room for all that it finds, so the answer is known: of
 * all contacts the first ones. is_cut: a rank had no room. If it has lost what matters,
 * the answer is incomplete; all that is there is a contact nevertheless. */
static void compare_firsts(const struct pccd_answer *ranks, const struct kept *kept,
                           bool is_cut)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer all = PCCD_ANSWER_INIT;
    struct pccd_contact firsts[KEPT + 1];
    ask_one_and_keep(&settings, NULL, &all);
    uint64_t count = find_firsts(&all, firsts);
    must(all.count == all.total && all.count > 2048 && count > 0, "few contacts");
    must(kept->count == ranks->total, "a total");
    if (ranks->incomplete == PCCD_COMPLETE || !is_cut) {
        must((ranks->incomplete == PCCD_COMPLETE) == (count <= KEPT), "not complete");
        must(kept->count == (count < KEPT ? count : KEPT) &&
                 memcmp(kept->contacts, firsts, kept->count * sizeof *firsts) == 0,
             "not the first ones");
    } else {
        must(ranks->incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT && ranks->safe_step == 0,
             "incomplete for another reason");
    }
    for (uint64_t i = 0; i < kept->count; i++) {
        must(is_among(&kept->contacts[i], &all), "a contact that is none");
    }
    pccd_answer_release(test.one, &all);
}

/* Leaf c falls through its floor at a time that is earlier, or later, the greater c is;
 * or at random; or all at once; or all but one. */
static void fall(int order)
{
    for (uint32_t c = 0; c < HITS_MAX; c++) {
        double part = (double)c / HITS_MAX;
        test.falls[c] = 2 + (order == 0   ? part
                             : order == 1 ? 1 - part
                             : order == 2 ? prng_between(&test.prng, 0, 1)
                             : order == 3 ? 0
                             : order == 4 ? c == 0
                                          : c == HITS_MAX - 1);
    }
    move(0);
}

/* Set how much the first rank's part of libpccd keeps of what it finds; it has one part
 * for all its clients. */
static void set_room(const char *count)
{
    must(test.rank > 0 || pccd_config_set(test.one, "contacts-max", count) == 0, "room");
}

static void crowd(void)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    settings.mode = PCCD_MODE_FIRST;
    test.record_limit = KEPT;
    uint64_t cut[2] = {0};
    make_scene(HITS_MAX, 0, NULL);
    open_world();
    for (int is_cut = 0; is_cut < 2; is_cut++) {
        for (int order = 0; order < 6; order++) {
            struct kept kept = {.count = 0};
            fall(order);
            if (is_cut) {
                set_room("8");
            }
            struct pccd_answer answer = ask(&settings, NULL);
            if (is_cut) {
                set_room("16777216");
            }
            cut[is_cut] += answer.incomplete != PCCD_COMPLETE;
            must(pccd_mpi_gather(test.world, 0, keep, &kept) == 0, "gather");
            if (test.rank == 0) {
                compare_firsts(&answer, &kept, is_cut);
            }
        }
    }
    if (test.rank == 0) {
        printf("# of 6 answers %" PRIu64
               " were incomplete; where a rank had no room %" PRIu64 "\n",
               cut[0], cut[1]);
        must(cut[1] > cut[0], "there was room");
    }
    close_world();
}

int main(int argc, char **argv)
{
    int given = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &test.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &test.size);
    const char *what = argc > 1 ? argv[1] : "";
    if (argc > 2 && strcmp(what, "turns") == 0) {
        take_turns(strtoull(argv[2], NULL, 0),
                   argc > 3 ? strtoull(argv[3], NULL, 0) : prng_seed());
    } else if (strcmp(what, "yes") == 0) {
        prove();
    } else if (strcmp(what, "deadline") == 0) {
        let_pass();
    } else if (strcmp(what, "cancel") == 0) {
        cancel();
    } else if (strcmp(what, "crowd") == 0) {
        crowd();
    } else {
        stop("usage: stop yes|deadline|cancel|crowd|turns CALLS [SEED]");
    }
    MPI_Finalize();
    return 0;
}
