/* same_as_one.c - a program for mpirun: what the ranks answer together is what one
 * process answers.
 *
 * Perform random plays, whose meshes are dealt out to the ranks at random, by pccd_mpi.h;
 * the first rank performs them by pccd.h alone, too, and compares every number and every
 * byte. Usage:    mpirun -n RANKS same_as_one PLAYS TRIANGLES [SEED]. The exit status is
 * 1 after a difference; the first rank prints the seed of the play.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "names.h"
#include "pccd_mpi.h"
#include "play.h"
#include "prng.h"

#define OBJECTS_MAX  1024u
#define MOTIONS_MAX  2048u
#define STEPS        8u
#define FLIGHT_STEPS 30u
#define PAGE_BYTES   65536u /* of a thousand contacts: some answers take many pages */

/* An object of the play, on this rank. */
struct actor {
    bool is_there;
    uint32_t mesh, object;         /* of the world */
    uint32_t one_mesh, one_object; /* of the one process */
    uint32_t vertex_count;
    uint32_t *owned; /* numbers of this rank's vertices, ascending */
    uint32_t owned_count;
};

static struct {
    int rank, size;
    uint64_t seed;
    struct pccd_mpi *world;
    struct pccd_client *one; /* on the first rank */
    uint32_t scene;
    struct actor actors[OBJECTS_MAX];
    struct pccd_motion motions[MOTIONS_MAX], one_motions[MOTIONS_MAX];
    uint32_t motion_count, one_motion_count;
    void *memory[4 * MOTIONS_MAX]; /* of motions */
    uint32_t memory_count;
    struct prng prng; /* the same on every rank */
    bool has_failed;
    uint64_t record_limit; /* of the play; 0: as many as ever */
    double farthest;       /* nothing asks for what is farther apart */
    int mode;              /* of steps; -1: any */
    uint64_t steps, nears, records;
    uint64_t cut_short;                 /* by a deadline */
    uint64_t answered[PCCD_NEAR_COUNT]; /* questions that had records */
} test;

static void stop(const char *what)
{
    fprintf(stderr, "rank %d, seed %" PRIu64 ": %s: %s\n", test.rank, test.seed, what,
            pccd_mpi_error_text(test.world));
    MPI_Abort(MPI_COMM_WORLD, 1);
}

static void must(int status, const char *what)
{
    if (status != PCCD_OK) {
        stop(what);
    }
}

static void one_must(int status, const char *what)
{
    if (status != PCCD_OK) {
        fprintf(stderr, "one process, seed %" PRIu64 ": %s: %s\n", test.seed, what,
                pccd_error_text(test.one));
        MPI_Abort(MPI_COMM_WORLD, 1);
    }
}

static void *need(size_t bytes)
{
    void *memory = calloc(bytes + 1, 1);
    if (memory == NULL) {
        stop("out of memory");
    }
    return memory;
}

static bool chance(double part)
{
    return prng_between(&test.prng, 0, 1) < part;
}

/* ---- dealing out ------------------------------------------------------------------ */

/* The rank that gets a thing: in one of four manners. */
struct dealing {
    uint64_t salt;
    uint32_t manner;
};

static struct dealing choose_dealing(void)
{
    struct dealing dealing = {prng_next(&test.prng), 0};
    dealing.manner = (uint32_t)prng_below(&test.prng, 4);
    return dealing;
}

static int rank_of(const struct dealing *dealing, uint32_t number, uint32_t total)
{
    struct prng own = {dealing->salt + number * 0x9e3779b97f4a7c15u};
    int only = (int)(dealing->salt % (uint64_t)test.size);
    int any = (int)prng_below(&own, (uint64_t)test.size);
    switch (dealing->manner) {
    case 0: /* at random */
        return any;
    case 1: /* in slices */
        return (int)((uint64_t)number * (uint64_t)test.size / total);
    case 2: /* one rank has all */
        return only;
    default: /* one rank has nothing */
        return test.size > 1 && any == only ? (only + 1) % test.size : any;
    }
}

/* A mesh of a play with what may be named in it besides. */
struct whole {
    const struct play_act *act;
    uint32_t edge_count, point_count;
    uint32_t (*edges)[2];
    uint32_t *points;
    double *radii;
};

static void name_more(const struct play_act *act, struct whole *whole)
{
    uint32_t vertices = act->vertex_count;
    *whole = (struct whole){.act = act};
    if (chance(0.4)) {
        whole->edge_count = 1 + (uint32_t)prng_below(&test.prng, 8);
        whole->point_count = 1 + (uint32_t)prng_below(&test.prng, 8);
    }
    whole->edges = need(whole->edge_count * sizeof *whole->edges);
    whole->points = need(whole->point_count * sizeof *whole->points);
    for (uint32_t i = 0; i < whole->edge_count; i++) {
        whole->edges[i][0] = (uint32_t)prng_below(&test.prng, vertices);
        whole->edges[i][1] = (uint32_t)prng_below(&test.prng, vertices);
    }
    for (uint32_t i = 0; i < whole->point_count; i++) {
        whole->points[i] = (uint32_t)prng_below(&test.prng, vertices);
    }
    if (chance(0.2)) {
        whole->radii = need(vertices * sizeof *whole->radii);
        for (uint32_t i = 0; i < vertices; i++) {
            whole->radii[i] = prng_between(&test.prng, 0, 0.02);
        }
    }
}

/* This rank's part of it. Numbers are given, or left out where the dealing is in
 * slices. */
static void take_part(const struct whole *whole, struct actor *actor,
                      struct pccd_mpi_part *part)
{
    const struct play_act *act = whole->act;
    struct dealing vertices = choose_dealing(), triangles = choose_dealing();
    struct dealing named = choose_dealing();
    uint32_t *numbers = need(act->triangle_count * sizeof *numbers), count = 0;
    uint32_t(*corners)[3] = need(act->triangle_count * sizeof *corners);
    actor->owned = realloc(actor->owned, (act->vertex_count + 1) * sizeof(uint32_t));
    actor->owned_count = 0;
    actor->vertex_count = act->vertex_count;
    double(*x)[3] = need(act->vertex_count * sizeof *x);
    double *radii = whole->radii ? need(act->vertex_count * sizeof *radii) : NULL;
    for (uint32_t v = 0; v < act->vertex_count; v++) {
        if (rank_of(&vertices, v, act->vertex_count) == test.rank) {
            memcpy(x[actor->owned_count], act->x0[v], sizeof *x);
            if (radii != NULL) {
                radii[actor->owned_count] = whole->radii[v];
            }
            actor->owned[actor->owned_count++] = v;
        }
    }
    for (uint32_t t = 0; t < act->triangle_count; t++) {
        if (rank_of(&triangles, t, act->triangle_count) == test.rank) {
            memcpy(corners[count], act->triangles[t], sizeof *corners);
            numbers[count++] = t;
        }
    }
    uint32_t(*edges)[2] = need(whole->edge_count * sizeof *edges), edge_count = 0;
    for (uint32_t i = 0; i < whole->edge_count; i++) {
        if (rank_of(&named, i, whole->edge_count) == test.rank) {
            memcpy(edges[edge_count++], whole->edges[i], sizeof *edges);
        }
    }
    uint32_t *points = need(whole->point_count * sizeof *points), point_count = 0;
    for (uint32_t i = 0; i < whole->point_count; i++) {
        if (rank_of(&named, i, whole->point_count) == test.rank) {
            points[point_count++] = whole->points[i];
        }
    }
    if (triangles.manner == 1) {
        free(numbers);
        numbers = NULL;
    }
    *part = (struct pccd_mpi_part){.struct_bytes = sizeof *part,
                                   .vertex_total = act->vertex_count,
                                   .triangle_total = act->triangle_count,
                                   .vertex_count = actor->owned_count,
                                   .vertices = vertices.manner == 1 ? NULL : actor->owned,
                                   .format = PCCD_FORMAT_F64,
                                   .x = x,
                                   .radii = radii,
                                   .triangle_count = count,
                                   .edge_count = edge_count,
                                   .point_count = point_count,
                                   .triangles = (const uint32_t *)corners,
                                   .triangle_numbers = numbers,
                                   .edges = (const uint32_t *)edges,
                                   .points = points};
}

static void free_part(const struct pccd_mpi_part *part, const struct whole *whole)
{
    free((void *)(uintptr_t)part->triangle_numbers);
    free((void *)(uintptr_t)part->x);
    free((void *)(uintptr_t)part->radii);
    free((void *)(uintptr_t)part->triangles);
    free((void *)(uintptr_t)part->edges);
    free((void *)(uintptr_t)part->points);
    free(whole->edges);
    free(whole->points);
    free(whole->radii);
}

/* ---- acts ------------------------------------------------------------------------- */

static void fail(const char *what)
{
    printf("# seed %" PRIu64 ", step %" PRIu64 ", %d ranks: %s\n", test.seed, test.steps,
           test.size, what);
    test.has_failed = true;
}

static void compare_infos(const struct pccd_mesh_info *a, const struct pccd_mesh_info *b)
{
    if (a->vertex_count != b->vertex_count || a->triangle_count != b->triangle_count ||
        a->edge_count != b->edge_count || a->duplicate_count != b->duplicate_count ||
        a->degenerate_count != b->degenerate_count ||
        a->isolated_count != b->isolated_count ||
        a->free_edge_count != b->free_edge_count ||
        a->free_point_count != b->free_point_count || a->generation != b->generation) {
        fail("the counts of a mesh differ");
    }
}

static void put(struct actor *actor, const struct whole *whole, bool is_new)
{
    const struct play_act *act = whole->act;
    struct pccd_mpi_part part;
    struct pccd_mesh_info info, one_info;
    take_part(whole, actor, &part);
    must(pccd_mpi_mesh_put(test.world, &part, &actor->mesh, &info), "mesh_put");
    if (is_new) {
        must(pccd_mpi_add(test.world, actor->mesh, &actor->object), "add");
    }
    if (test.rank == 0) {
        const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                            .x = act->x0,
                                            .format = PCCD_FORMAT_F64,
                                            .vertex_count = act->vertex_count,
                                            .triangle_count = act->triangle_count,
                                            .triangles = (const uint32_t *)act->triangles,
                                            .radii = whole->radii,
                                            .edges = (const uint32_t *)whole->edges,
                                            .points = whole->points,
                                            .edge_count = whole->edge_count,
                                            .point_count = whole->point_count};
        one_must(pccd_mesh_put(test.one, &data, &actor->one_mesh, &one_info), "mesh");
        if (is_new) {
            one_must(
                pccd_scene_add(test.one, test.scene, actor->one_mesh, &actor->one_object),
                "add");
        }
        compare_infos(&info, &one_info);
        if (actor->object != actor->one_object) {
            fail("an object has another handle");
        }
    }
    free_part(&part, whole);
}

static void put_act(struct actor *actor, const struct play_act *act, bool is_new)
{
    struct whole whole;
    name_more(act, &whole);
    put(actor, &whole, is_new);
}

/* Change what an actor may meet, and how thick it is: sometimes something else than at
 * first. */
static void change(struct actor *actor)
{
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings};
    if (chance(0.2)) {
        settings.what |= PCCD_OBJECT_GROUP | PCCD_OBJECT_MASK;
        settings.group = 1 + prng_below(&test.prng, 3);
        settings.mask = 1 + prng_below(&test.prng, 3);
    }
    if (chance(0.2)) {
        settings.what |= PCCD_OBJECT_SELF;
        settings.self_collision = chance(0.5);
    }
    if (chance(0.3)) {
        settings.what |= PCCD_OBJECT_RADIUS;
        settings.radius = chance(0.5) ? prng_between(&test.prng, 0, 0.03) : 0;
    }
    if (chance(0.3)) {
        settings.what |= PCCD_OBJECT_REST_DISTANCE;
        settings.rest_distance = prng_between(&test.prng, 0, 0.1);
    }
    if (chance(0.3)) {
        settings.what |= PCCD_OBJECT_REST_RINGS;
        settings.rest_rings = (uint32_t)prng_below(&test.prng, 4);
    }
    if (settings.what == 0) {
        return;
    }
    must(pccd_mpi_object_set(test.world, actor->object, &settings), "object_set");
    if (test.rank == 0) {
        one_must(pccd_object_set(test.one, test.scene, actor->object, &settings), "set");
    }
}

static struct actor *random_actor(void)
{
    uint32_t at = (uint32_t)prng_below(&test.prng, OBJECTS_MAX);
    for (uint32_t i = 0; i < OBJECTS_MAX; i++) {
        struct actor *actor = &test.actors[(at + i) % OBJECTS_MAX];
        if (actor->is_there) {
            return actor;
        }
    }
    return NULL;
}

static void ignore_some(void)
{
    struct actor *a = random_actor(), *b = random_actor();
    if (a == NULL || b == NULL || a == b || !chance(0.3)) {
        return;
    }
    bool ignored = chance(0.6);
    must(pccd_mpi_pair_ignore(test.world, a->object, b->object, ignored), "ignore");
    if (test.rank == 0) {
        one_must(pccd_pair_ignore(test.one, test.scene, a->object, b->object, ignored),
                 "ignore");
    }
}

/* An object that goes or breaks does not make the motions that it was given. */
static void forget_motions(uint32_t object)
{
    uint32_t kept = 0, one_kept = 0;
    for (uint32_t i = 0; i < test.motion_count; i++) {
        if (test.motions[i].object != object) {
            test.motions[kept++] = test.motions[i];
        }
    }
    for (uint32_t i = 0; i < test.one_motion_count; i++) {
        if (test.one_motions[i].object != object) {
            test.one_motions[one_kept++] = test.one_motions[i];
        }
    }
    test.motion_count = kept;
    test.one_motion_count = one_kept;
}

static void remove_actor(struct actor *actor)
{
    forget_motions(actor->object);
    must(pccd_mpi_remove(test.world, actor->object), "remove");
    must(pccd_mpi_mesh_destroy(test.world, actor->mesh), "mesh_destroy");
    if (test.rank == 0) {
        one_must(pccd_scene_remove(test.one, test.scene, actor->object), "remove");
        one_must(pccd_mesh_destroy(test.one, actor->one_mesh), "destroy");
    }
    actor->is_there = false;
}

static void *keep(void *memory)
{
    test.memory[test.memory_count++] = memory;
    return memory;
}

/* This rank's part of a motion: a run of its list. */
static void move(const struct actor *actor, const struct play_act *act)
{
    struct pccd_motion motion = {.object = actor->object, .format = PCCD_FORMAT_F64};
    uint32_t end = act->first + act->vertex_count;
    bool is_rigid = act->what == PLAY_RIGID;
    double(*x0)[3] = keep(need(act->vertex_count * sizeof *x0));
    double(*x1)[3] = keep(need(act->vertex_count * sizeof *x1));
    for (uint32_t i = 0; i < actor->owned_count; i++) {
        uint32_t v = actor->owned[i];
        if (v < act->first) {
            motion.first++;
        } else if (v < end) {
            if (!is_rigid) {
                memcpy(x1[motion.count], act->x1[v - act->first], sizeof *x1);
            }
            if (act->what == PLAY_X0X1) {
                memcpy(x0[motion.count], act->x0[v - act->first], sizeof *x0);
            }
            motion.count++;
        }
    }
    motion.x0 = act->what == PLAY_X0X1 ? x0 : NULL;
    motion.x1 = is_rigid ? NULL : x1;
    motion.m0 = is_rigid ? act->m[0] : NULL;
    motion.m1 = is_rigid ? act->m[1] : NULL;
    if (motion.count > 0) {
        test.motions[test.motion_count++] = motion;
    }
    test.one_motions[test.one_motion_count++] =
        (struct pccd_motion){.object = actor->object,
                             .first = act->first,
                             .count = act->vertex_count,
                             .format = PCCD_FORMAT_F64,
                             .x0 = act->what == PLAY_X0X1 ? act->x0 : NULL,
                             .x1 = is_rigid ? NULL : act->x1,
                             .m0 = motion.m0,
                             .m1 = motion.m1};
}

/* ---- steps ------------------------------------------------------------------------ */

/* Records of the ranks, compared with those of one process as they come. */
struct comparison {
    const char *records;
    size_t record_bytes;
    uint64_t count, at;
    bool differs;
};

static int compare_records(void *context, const void *records, uint64_t count)
{
    struct comparison *comparison = context;
    if (comparison->at + count > comparison->count ||
        memcmp(comparison->records + comparison->at * comparison->record_bytes, records,
               count * comparison->record_bytes) != 0) {
        comparison->differs = true;
        for (uint64_t i = 0; i < count && comparison->at + i < comparison->count; i++) {
            const uint32_t *a =
                (const void *)(comparison->records +
                               (comparison->at + i) * comparison->record_bytes);
            const uint32_t *b =
                (const void *)((const char *)records + i * comparison->record_bytes);
            if (memcmp(a, b, comparison->record_bytes) != 0) {
                printf("# record %" PRIu64
                       ": %u %u %u %u %u %u, ranks %u %u %u %u %u %u\n",
                       comparison->at + i, a[0], a[1], a[2], a[3], a[4], a[5], b[0], b[1],
                       b[2], b[3], b[4], b[5]);
                break;
            }
        }
    }
    comparison->at += count;
    return 0;
}

static bool same_double(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Mode first: one process may find more than it keeps before it knows what comes first,
 * where each rank has room enough; but not before it has found what fills a block of
 * memory. tests/mpi/stop.c sees what holds then. */
static bool is_crowded_out(const struct pccd_answer *one)
{
    return one->mode == PCCD_MODE_FIRST && !one->is_near &&
           one->incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT &&
           one->counters.survivors + one->counters.thick_survivors >= 1000;
}

/* Whatever was found by then. */
static bool is_cut_short(const struct pccd_answer *answer)
{
    return answer->incomplete == PCCD_INCOMPLETE_DEADLINE;
}

static void compare_answers(const struct pccd_answer *a, const struct pccd_answer *b)
{
    char text[512];
    if (is_crowded_out(a)) {
        return;
    }
    if (a->total == b->total && memcmp(a->counts, b->counts, sizeof a->counts) == 0 &&
        a->possible == b->possible && a->initial == b->initial &&
        a->inside == b->inside && a->coincident == b->coincident &&
        a->crowded == b->crowded && a->crossings == b->crossings &&
        a->start_inside == b->start_inside && same_double(a->toi_first, b->toi_first) &&
        same_double(a->safe_step, b->safe_step) && a->verdict == b->verdict &&
        a->incomplete == b->incomplete && memcmp(a->hash, b->hash, sizeof a->hash) == 0) {
        return;
    }
    snprintf(text, sizeof text,
             "mode %d: total %" PRIu64 " and %" PRIu64 ", initial %" PRIu64
             " and %" PRIu64 ", inside %" PRIu64 " and %" PRIu64 ", crossings %" PRIu64
             " and %" PRIu64 ", inside at first %" PRIu64 " and %" PRIu64
             ", crowded %d and %d, toi %.17g and %.17g"
             ", safe %.17g and %.17g, verdict %d and %d, incomplete %d and %d"
             ", hash %016" PRIx64 " and %016" PRIx64,
             (int)a->mode, a->total, b->total, a->initial, b->initial, a->inside,
             b->inside, a->crossings, b->crossings, a->start_inside, b->start_inside,
             a->crowded, b->crowded, a->toi_first, b->toi_first, a->safe_step,
             b->safe_step, (int)a->verdict, (int)b->verdict, (int)a->incomplete,
             (int)b->incomplete, a->hash[1], b->hash[1]);
    fail(text);
}

/* While the one process answers, the limit of the play is its own; it shares it with all
 * clients of direct: in this rank. */
static void limit_one(bool is_on)
{
    char limit[32];
    if (test.record_limit > 0) {
        snprintf(limit, sizeof limit, "%" PRIu64, is_on ? test.record_limit : 1u << 24);
        one_must(pccd_config_set(test.one, "contacts-max", limit), "limit");
    }
}

static struct pccd_step_settings choose_settings(void)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    uint32_t mode = prng_u32(&test.prng, PCCD_MODE_PAIRS + 1);
    settings.mode = chance(0.5) ? PCCD_MODE_ALL : (enum pccd_mode)mode;
    settings.mode = test.mode >= 0 ? (enum pccd_mode)test.mode : settings.mode;
    settings.method = chance(0.2) ? PCCD_METHOD_PAPER : PCCD_METHOD_DEFAULT;
    settings.threads = 1;
    settings.separation = chance(0.3) ? prng_between(&test.prng, 0, 0.02) : 0;
    settings.separation = fmin(settings.separation, test.farthest);
    settings.approach = chance(0.3) ? 0.5 : 0;
    settings.tells_start = chance(0.3);
    settings.deadline_ns = chance(0.03) ? 1 : 0; /* it has passed at once */
    return settings;
}

static void forget_all_motions(void)
{
    while (test.memory_count > 0) {
        free(test.memory[--test.memory_count]);
    }
    test.motion_count = test.one_motion_count = 0;
}

/* All records of the ranks, beside those of one process. */
static void compare_all_records(const struct pccd_answer *one, size_t record_bytes)
{
    struct comparison comparison = {.record_bytes = record_bytes, .count = one->count};
    comparison.records = one->is_near && one->what == PCCD_NEAR_VERTICES
                             ? (const char *)one->vertex_bounds
                         : one->is_near          ? (const char *)one->near
                         : one->contacts != NULL ? (const char *)one->contacts
                                                 : (const char *)one->pairs;
    must(pccd_mpi_gather(test.world, 0, compare_records, &comparison), "gather");
    if (test.rank == 0) {
        if (!is_crowded_out(one) &&
            (comparison.differs || comparison.at != comparison.count)) {
            fail(one->is_near ? "the records of what is near differ"
                              : "the records differ");
        }
        pccd_answer_release(test.one, (struct pccd_answer *)(uintptr_t)one);
    }
}

static void step(void)
{
    struct pccd_step_settings settings = choose_settings();
    struct pccd_answer answer = PCCD_ANSWER_INIT, one = PCCD_ANSWER_INIT;
    int status =
        pccd_mpi_step(test.world, test.motions, test.motion_count, &settings, &answer);
    test.steps++;
    test.records += answer.total;
    if (test.rank == 0) {
        limit_one(true);
        int one_status = pccd_step(test.one, test.scene, test.one_motions,
                                   test.one_motion_count, &settings, &one);
        limit_one(false);
        if (status != one_status) {
            printf("# ranks: %s; one process: %s\n", pccd_mpi_error_text(test.world),
                   pccd_error_text(test.one));
            fail("a step has another status");
        }
        if (settings.deadline_ns == 0) {
            compare_answers(&one, &answer);
        }
    }
    if (settings.deadline_ns == 0) {
        compare_all_records(&one, settings.mode == PCCD_MODE_PAIRS
                                      ? sizeof(struct pccd_pair)
                                      : sizeof(struct pccd_contact));
    } else {
        test.cut_short += is_cut_short(&answer);
        pccd_answer_release(test.one, &one);
    }
    forget_all_motions();
}

static struct pccd_near_settings choose_question(void)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    settings.what = (enum pccd_near_what)prng_below(&test.prng, PCCD_NEAR_COUNT);
    settings.distance = chance(0.2) ? 0 : prng_between(&test.prng, 0, 0.1);
    if (chance(0.3)) { /* what is exactly so far apart is within it */
        settings.distance = ldexp(1, -(int)prng_below(&test.prng, 8));
    }
    if (settings.what == PCCD_NEAR_NEAREST && chance(0.5)) {
        settings.distance = INFINITY;
    }
    settings.distance = fmin(settings.distance, test.farthest);
    settings.gap = settings.what == PCCD_NEAR_NEAREST && chance(0.1) ? 0.01 : 0;
    settings.tells_crossings = chance(0.5);
    settings.at_begin = chance(0.3);
    settings.method = chance(0.2) ? PCCD_METHOD_PAPER : PCCD_METHOD_DEFAULT;
    settings.threads = 1;
    settings.deadline_ns = chance(0.03) ? 1 : 0;
    const struct actor *a = random_actor(), *b = random_actor();
    int named = common_near_names_objects(settings.what);
    settings.object_a = a != NULL && named > 0 && chance(0.3) ? a->object : 0;
    settings.object_b = b != NULL && named > 1 && chance(0.3) ? b->object : 0;
    return settings;
}

/* One process and ranks say the same, but for records. */
static bool is_same_question(const struct pccd_answer *a, const struct pccd_answer *b)
{
    return a->total == b->total && a->verdict == b->verdict && a->what == b->what &&
           a->is_near == b->is_near && a->incomplete == b->incomplete &&
           memcmp(a->counts, b->counts, sizeof a->counts) == 0 &&
           memcmp(a->hash, b->hash, sizeof a->hash) == 0 &&
           a->crossings == b->crossings && a->method == b->method &&
           same_double(a->distance_min, b->distance_min) &&
           same_double(a->distance_max, b->distance_max);
}

/* With a gap, the pair of two objects may be another one, farther by at most that. */
static bool is_within_gap(const struct pccd_near_settings *settings,
                          const struct pccd_answer *a, const struct pccd_answer *b)
{
    return a->total == b->total && a->incomplete == b->incomplete &&
           fabs(a->distance_min - b->distance_min) <= settings->gap * 1.001 &&
           fabs(a->distance_max - b->distance_max) <= settings->gap * 1.001;
}

static void compare_questions(const struct pccd_near_settings *settings,
                              const struct pccd_answer *one,
                              const struct pccd_answer *answer)
{
    if (settings->gap > 0 ? !is_within_gap(settings, one, answer)
                          : !is_same_question(one, answer)) {
        printf("# %d within %.17g at %u: total %" PRIu64 " and %" PRIu64
               ", verdict %d and %d, incomplete %d and %d, crossings %" PRIu64
               " and %" PRIu64 ", from %.17g and %.17g to %.17g and %.17g, hash %" PRIx64
               " and %" PRIx64 "\n",
               (int)settings->what, settings->distance, settings->at_begin ? 0u : 1u,
               one->total, answer->total, (int)one->verdict, (int)answer->verdict,
               (int)one->incomplete, (int)answer->incomplete, one->crossings,
               answer->crossings, one->distance_min, answer->distance_min,
               one->distance_max, answer->distance_max, one->hash[1], answer->hash[1]);
        fail("what is near differs");
    }
}

/* Ranks look at triangles alone for NEAREST and DEPTH (pccd_mpi.h): they refuse what else
 * there is, by name, and nothing has moved. */
static bool is_refused(const struct pccd_near_settings *settings, int status)
{
    bool is_of_objects =
        settings->what == PCCD_NEAR_NEAREST || settings->what == PCCD_NEAR_DEPTH;
    return status == PCCD_E_INVAL && is_of_objects &&
           strstr(pccd_mpi_error_text(test.world), "free edges or points") != NULL;
}

/* Ask what is near where the last step ended or began, or where motions lead. */
static void ask_near(void)
{
    const struct pccd_near_settings settings = choose_question();
    struct pccd_answer answer = PCCD_ANSWER_INIT, one = PCCD_ANSWER_INIT;
    int status =
        pccd_mpi_near(test.world, test.motions, test.motion_count, &settings, &answer);
    test.nears++;
    test.records += answer.total;
    if (test.rank == 0 && !is_refused(&settings, status)) {
        limit_one(true);
        int one_status = pccd_ask_near(test.one, test.scene, test.one_motions,
                                       test.one_motion_count, &settings, &one);
        limit_one(false);
        test.answered[settings.what] += one_status == PCCD_OK && one.total > 0;
        if (status != one_status) {
            printf("# %d, ranks: %s; one process: %s\n", (int)settings.what,
                   pccd_mpi_error_text(test.world), pccd_error_text(test.one));
            fail("a question has another status");
        } else if (status == PCCD_OK && settings.deadline_ns == 0) {
            compare_questions(&settings, &one, &answer);
        }
    }
    test.cut_short += is_cut_short(&answer);
    if (status == PCCD_OK && (settings.gap > 0 || settings.deadline_ns > 0)) {
        pccd_answer_release(test.one, &one);
    } else if (status == PCCD_OK) {
        compare_all_records(&one, settings.what == PCCD_NEAR_VERTICES
                                      ? sizeof(double)
                                      : sizeof(struct pccd_near));
    }
    forget_all_motions();
}

static void perform(const struct play_act *act)
{
    struct actor *actor = &test.actors[act->object_id % OBJECTS_MAX];
    switch (act->what) {
    case PLAY_ADD:
        actor->mesh = actor->one_mesh = 0;
        put_act(actor, act, true);
        actor->is_there = true;
        change(actor);
        break;
    case PLAY_REMOVE:
        remove_actor(actor);
        break;
    case PLAY_REPLACE:
        forget_motions(actor->object);
        put_act(actor, act, false);
        break;
    case PLAY_X1:
    case PLAY_X0X1:
    case PLAY_RIGID:
        move(actor, act);
        break;
    case PLAY_STEP:
        ignore_some();
        if (chance(0.2)) { /* it moves what a step would have moved */
            ask_near();
        } else {
            step();
        }
        while (chance(0.5)) {
            ask_near();
        }
        actor = random_actor();
        if (actor != NULL && chance(0.3)) {
            change(actor);
        }
        break;
    }
}

static void perform_any(uint32_t triangles)
{
    struct play play;
    if (chance(0.5)) {
        play_wild(&play, STEPS, triangles, test.seed);
    } else {
        play_make(&play, (enum play_kind)prng_below(&test.prng, PLAY_KINDS), triangles,
                  test.seed);
    }
    for (uint32_t i = 0; i < play.act_count; i++) {
        perform(&play.acts[i]);
    }
    play_deinit(&play);
}

/* Rods bent like hairpins: the two long edges lie beside each other, and the three edges
 * that join them lie far from the first one. So three rings make them thin, but only for
 * a rank that knows an edge which is near nothing of its own. */
static void perform_hairpins(uint32_t pins)
{
    static const double shape[6][2] = {{0, 0},  {10, 0},    {12, 2},
                                       {12, 4}, {10, 0.01}, {0, 0.01}};
    struct play_act act = {.what = PLAY_X1, .vertex_count = 6 * pins};
    struct whole whole = {.act = &act, .edge_count = 5 * pins};
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                            .what = PCCD_OBJECT_RADIUS |
                                                    PCCD_OBJECT_REST_RINGS,
                                            .radius = 0.1};
    act.x0 = need(act.vertex_count * sizeof *act.x0);
    act.x1 = need(act.vertex_count * sizeof *act.x1);
    whole.edges = need(whole.edge_count * sizeof *whole.edges);
    for (uint32_t i = 0; i < act.vertex_count; i++) {
        act.x0[i][0] = shape[i % 6][0];
        act.x0[i][1] = shape[i % 6][1];
        act.x0[i][2] = i / 6;
        for (int k = 0; k < 3; k++) {
            act.x1[i][k] = act.x0[i][k] + prng_between(&test.prng, 0, 0.001);
        }
    }
    for (uint32_t i = 0; i < whole.edge_count; i++) {
        whole.edges[i][0] = 6 * (i / 5) + i % 5;
        whole.edges[i][1] = whole.edges[i][0] + 1;
    }
    struct actor *actor = &test.actors[0];
    put(actor, &whole, true);
    actor->is_there = true;
    for (settings.rest_rings = 0; settings.rest_rings <= 4; settings.rest_rings++) {
        must(pccd_mpi_object_set(test.world, actor->object, &settings), "object_set");
        if (test.rank == 0) {
            one_must(pccd_object_set(test.one, test.scene, actor->object, &settings),
                     "set");
        }
        move(actor, &act);
        step();
    }
    free(act.x0);
    free(act.x1);
}

/* A box of `cells` squares along each side, cut into triangles; its corners are where
 * those of others may be, too. */
static void make_box(uint32_t cells, const double at[3], double size,
                     struct play_act *act)
{
    uint32_t row = cells + 1;
    act->vertex_count = row * row * row; /* those within are in no triangle */
    act->triangle_count = 12 * cells * cells;
    act->x0 = need(act->vertex_count * sizeof *act->x0);
    act->triangles = need(act->triangle_count * sizeof *act->triangles);
    for (uint32_t v = 0; v < act->vertex_count; v++) {
        const uint32_t place[3] = {v % row, v / row % row, v / row / row};
        for (int k = 0; k < 3; k++) {
            act->x0[v][k] = at[k] + size * place[k] / cells;
        }
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < 6 * cells * cells; i++) {
        uint32_t axis = i % 3, side = i / 3 % 2, u = i / 6 % cells, w = i / 6 / cells;
        const uint32_t steps[3] = {1, row, row * row};
        uint32_t along = steps[(axis + 1) % 3], across = steps[(axis + 2) % 3];
        uint32_t corner = side * cells * steps[axis] + u * along + w * across;
        uint32_t quad[4] = {corner, corner + along, corner + along + across,
                            corner + across};
        for (uint32_t half = 0; half < 2; half++, count++) {
            act->triangles[count][0] = quad[0];
            act->triangles[count][side ? 1 : 2] = quad[1 + half];
            act->triangles[count][side ? 2 : 1] = quad[2 + half];
        }
    }
}

/* Boxes that stand in each other, move and turn, some of them open: depth has vertices
 * inside, on the surface, and beside it with the same coordinates. */
static void perform_boxes(uint32_t triangles)
{
    uint32_t count = 2 + (uint32_t)prng_below(&test.prng, 4);
    uint32_t most = (uint32_t)sqrt(triangles / 12.0) + 1;
    struct play_act acts[8];
    for (uint32_t i = 0; i < count; i++) {
        struct whole whole = {.act = &acts[i]};
        double at[3];
        for (int k = 0; k < 3; k++) { /* on a grid, often */
            at[k] = chance(0.5) ? 0.25 * (double)prng_below(&test.prng, 5)
                                : prng_between(&test.prng, 0, 1);
        }
        acts[i] = (struct play_act){.what = PLAY_X1};
        make_box(1 + (uint32_t)prng_below(&test.prng, most), at,
                 chance(0.5) ? 1 : prng_between(&test.prng, 0.2, 1), &acts[i]);
        acts[i].triangle_count -= chance(0.1);
        acts[i].x1 = need(acts[i].vertex_count * sizeof *acts[i].x1);
        test.actors[i].mesh = test.actors[i].one_mesh = 0;
        put(&test.actors[i], &whole, true);
        test.actors[i].is_there = true;
    }
    for (uint32_t s = 0; s < STEPS; s++) {
        for (uint32_t i = 0; i < count; i++) {
            double by[3], blur = chance(0.5) ? 0.01 : 0;
            for (int k = 0; k < 3; k++) {
                by[k] = chance(0.5) ? 0.125 * ((double)prng_below(&test.prng, 3) - 1) : 0;
            }
            for (uint32_t v = 0; v < acts[i].vertex_count; v++) {
                for (int k = 0; k < 3; k++) {
                    acts[i].x1[v][k] =
                        acts[i].x0[v][k] + by[k] + prng_between(&test.prng, 0, blur);
                }
            }
            if (chance(0.7)) {
                move(&test.actors[i], &acts[i]);
                memcpy(acts[i].x0, acts[i].x1, acts[i].vertex_count * sizeof *acts[i].x0);
            }
        }
        ignore_some();
        chance(0.5) ? step() : ask_near();
        for (int q = 0; q < 4; q++) {
            ask_near();
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        free(acts[i].x0);
        free(acts[i].x1);
        free(acts[i].triangles);
    }
}

/* Triangles of a long cloud that flies: each has its own way, which it keeps for some
 * steps. */
struct cloud {
    struct play_act act;
    double (*way)[3]; /* of each triangle, in a step */
};

static void make_cloud(struct cloud *cloud, uint32_t triangles, double above)
{
    const double lows[3] = {0, 0, above}, sizes[3] = {4, 0.4, 0.4};
    struct play_act *act = &cloud->act;
    struct whole whole = {.act = act};
    *act = (struct play_act){
        .what = PLAY_X1, .triangle_count = triangles, .vertex_count = 3 * triangles};
    act->x0 = need(act->vertex_count * sizeof *act->x0);
    act->x1 = need(act->vertex_count * sizeof *act->x1);
    act->triangles = need(act->triangle_count * sizeof *act->triangles);
    cloud->way = need(triangles * sizeof *cloud->way);
    for (uint32_t v = 0; v < act->vertex_count; v++) {
        act->triangles[v / 3][v % 3] = v;
        for (int k = 0; k < 3; k++) {
            bool is_first = v % 3 == 0;
            double low = is_first ? lows[k] : act->x0[v / 3 * 3][k];
            act->x0[v][k] = low + prng_between(&test.prng, 0, is_first ? sizes[k] : 0.1);
        }
    }
    memcpy(act->x1, act->x0, act->vertex_count * sizeof *act->x1);
    struct actor *actor = test.actors;
    while (actor->is_there) {
        actor++;
    }
    actor->mesh = actor->one_mesh = 0;
    put(actor, &whole, true);
    actor->is_there = true;
}

/* All of a cloud get new ways: one for all, and a part that is each one's own. */
static void turn_cloud(struct cloud *cloud, double fast)
{
    double all[3], own = chance(0.5) ? 0.1 * fast : 0;
    for (int k = 0; k < 3; k++) {
        all[k] = prng_between(&test.prng, -fast, fast);
    }
    for (uint32_t t = 0; t < cloud->act.triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            cloud->way[t][k] = all[k] + prng_between(&test.prng, -own, own);
        }
    }
}

/* Flight of clouds. */
struct flight {
    struct cloud clouds[4];
    uint32_t count;
    double fast, blur;
    bool is_steady; /* each as it began */
    bool is_chase;  /* steady; one flies in front of the other, until it stops */
    uint32_t stop;
};

/* Fly a cloud to where it goes in the next step: as before but for a blur, as a rule. */
static void fly(const struct flight *flight, struct cloud *cloud,
                const struct actor *actor)
{
    struct play_act *act = &cloud->act;
    if (!flight->is_steady && chance(0.06)) {
        turn_cloud(cloud, chance(0.3) ? 0 : flight->fast);
    }
    if (!flight->is_steady && chance(0.05)) {
        return; /* it waits */
    }
    act->what = !flight->is_steady && chance(0.04) ? PLAY_X0X1 : PLAY_X1;
    for (uint32_t v = 0; v < act->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            act->x0[v][k] = act->x1[v][k] + (act->what == PLAY_X0X1 ? 0.01 : 0);
            act->x1[v][k] = act->x0[v][k] + cloud->way[v / 3][k] +
                            prng_between(&test.prng, -flight->blur, flight->blur);
        }
    }
    move(actor, act);
}

/* The last step once more, or backwards. */
static void fly_again(struct flight *flight, bool is_back)
{
    for (uint32_t i = 0; i < flight->count; i++) {
        struct play_act *act = &flight->clouds[i].act;
        double(*before)[3] = act->x0;
        act->what = is_back ? PLAY_X1 : PLAY_X0X1;
        if (is_back) {
            act->x0 = act->x1;
            act->x1 = before;
        }
        move(&test.actors[i], act);
    }
    step();
}

/* Each cloud begins elsewhere, and comes to x1 there; or goes from where it is. */
static void jump(const struct flight *flight, double away, bool begins)
{
    for (uint32_t i = 0; i < flight->count; i++) {
        struct play_act act = flight->clouds[i].act;
        const double(*at)[3] = (const double(*)[3])act.x1;
        act.what = begins ? PLAY_X0X1 : PLAY_X1;
        act.x0 = keep(need(act.vertex_count * sizeof *act.x0));
        act.x1 = keep(need(act.vertex_count * sizeof *act.x1));
        for (uint32_t v = 0; v < act.vertex_count; v++) {
            for (int k = 0; k < 3; k++) {
                act.x1[v][k] = at[v][k] + (k == 2 ? i * away : 0);
                act.x0[v][k] = act.x1[v][k] - 0.001;
            }
        }
        move(&test.actors[i], &act);
    }
}

/* A step elsewhere is refused: all stays where it was. What was found out for it is not
 * right for the way there, and back. */
static void jump_in_vain(const struct flight *flight)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    const double away = prng_between(&test.prng, -1, 1);
    settings.tolerance = 5;
    jump(flight, away, true);
    int status =
        pccd_mpi_step(test.world, test.motions, test.motion_count, &settings, &answer);
    if (test.rank == 0 &&
        (status != PCCD_E_INVAL ||
         pccd_step(test.one, test.scene, test.one_motions, test.one_motion_count,
                   &settings, &answer) != PCCD_E_INVAL)) {
        fail("a tolerance of 5 was taken");
    }
    forget_all_motions();
    jump(flight, away, false);
    step();
    jump(flight, 0, false);
    step();
}

/* Clouds that fly through each other, and go on as they went: so ghosts stay right for
 * many steps, and boxes follow. Some turn, stop, wait, or start elsewhere; others come
 * from afar, and meet when what was chosen first is right no more, or when one of them
 * stops. */
static void perform_flight(uint32_t triangles)
{
    struct flight flight = {.is_steady = chance(0.5)};
    flight.is_chase = flight.is_steady && chance(0.5);
    flight.stop = 2 + (uint32_t)prng_below(&test.prng, 12);
    flight.fast = chance(0.5) ? 0.02 : 0.1;
    flight.blur = !flight.is_steady && chance(0.5) ? 0.02 * flight.fast : 0;
    flight.count = flight.is_steady ? 2 : 2 + (uint32_t)prng_below(&test.prng, 3);
    for (uint32_t i = 0; i < flight.count; i++) {
        double above = flight.is_chase    ? i * (0.5 + 2 * flight.fast)
                       : flight.is_steady ? i * FLIGHT_STEPS / 2 * flight.fast
                                          : 0;
        make_cloud(&flight.clouds[i], 4 * triangles, above);
        turn_cloud(&flight.clouds[i], flight.fast);
        for (uint32_t t = 0; t < 4 * triangles && flight.is_steady; t++) {
            flight.clouds[i].way[t][2] = flight.is_chase ? flight.fast
                                         : i == 0        ? 0
                                                         : -flight.fast;
        }
    }
    test.farthest = chance(0.7) ? 0 : 0.05; /* ghosts are right for long if it is 0 */
    for (uint32_t s = 0; s < FLIGHT_STEPS; s++) {
        if (chance(0.1)) {
            jump_in_vain(&flight);
        }
        for (uint32_t i = 0; i < flight.count; i++) {
            if (!flight.is_chase || i == 0 || s < flight.stop) {
                fly(&flight, &flight.clouds[i], &test.actors[i]);
            }
        }
        chance(0.9) ? step() : ask_near();
        while (chance(0.1)) {
            ask_near();
        }
        while (chance(0.15)) {
            fly_again(&flight, chance(0.3));
        }
        if (s == 0 && chance(0.3)) { /* ghosts are right for contacts, not for pairs */
            test.mode = PCCD_MODE_ALL;
            for (int i = 0; i < 5; i++) {
                fly_again(&flight, false);
            }
            test.mode = PCCD_MODE_PAIRS;
            fly_again(&flight, false);
            test.mode = -1;
        }
    }
    for (uint32_t i = 0; i < flight.count; i++) {
        free(flight.clouds[i].act.x0);
        free(flight.clouds[i].act.x1);
        free(flight.clouds[i].act.triangles);
        free(flight.clouds[i].way);
    }
}

static void perform_play(uint32_t triangles)
{
    test.prng.state = test.seed;
    test.farthest = INFINITY;
    test.mode = -1;
    struct pccd_mpi_options of_world = {.struct_bytes = sizeof of_world};
    test.record_limit = chance(0.2) ? 1 + prng_below(&test.prng, 100) : 0;
    of_world.record_limit = test.record_limit;
    of_world.result_bytes = chance(0.3) ? PAGE_BYTES : 0;
    must(pccd_mpi_open(MPI_COMM_WORLD, &of_world, &test.world), "open");
    if (test.rank == 0) {
        const struct pccd_options options = {.struct_bytes = sizeof options,
                                             .url = "direct:"};
        one_must(pccd_connect(&options, &test.one), "connect");
        one_must(pccd_scene_create(test.one, NULL, &test.scene), "scene");
    }
    if (chance(0.1)) {
        perform_hairpins(triangles / 5 + 1);
    } else if (chance(0.3)) {
        perform_flight(triangles);
    } else if (chance(0.4)) {
        perform_boxes(triangles);
    } else {
        perform_any(triangles);
    }
    for (uint32_t i = 0; i < OBJECTS_MAX; i++) {
        free(test.actors[i].owned);
        test.actors[i] = (struct actor){.is_there = false};
    }
    pccd_mpi_close(test.world);
    pccd_close(test.one);
    test.world = NULL;
    test.one = NULL;
}

int main(int argc, char **argv)
{
    int given = 0, failed = 0;
    uint64_t plays = argc > 1 ? strtoull(argv[1], NULL, 0) : 1;
    uint32_t triangles = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 0) : 60;
    uint64_t seed = argc > 3 ? strtoull(argv[3], NULL, 0) : prng_seed();
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &test.rank);
    MPI_Comm_size(MPI_COMM_WORLD, &test.size);
    for (uint64_t i = 0; i < plays && !failed; i++) {
        test.seed = seed + i;
        perform_play(triangles);
        failed = test.has_failed;
        MPI_Bcast(&failed, 1, MPI_INT, 0, MPI_COMM_WORLD);
    }
    if (test.rank == 0 && !failed) {
        printf("# %d ranks: %" PRIu64 " steps, %" PRIu64 " questions, %" PRIu64
               " records, seed %" PRIu64 "; answered, of each kind:",
               test.size, test.steps, test.nears, test.records, seed);
        for (int what = 0; what < PCCD_NEAR_COUNT; what++) {
            printf(" %" PRIu64, test.answered[what]);
        }
        printf("; cut short: %" PRIu64 "\n", test.cut_short);
        fflush(stdout);
    }
    MPI_Finalize();
    return failed;
}
