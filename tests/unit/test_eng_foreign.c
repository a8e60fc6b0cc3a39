/* test_eng_foreign.c - pairs whose first feature is foreign. */
#include "eng_kit.h"
#include "kinds.h"
#include "topology.h"

#define TRIANGLES 900u
#define EDGES     120u
#define POINTS    150u
#define V         (3 * TRIANGLES + 2 * EDGES + POINTS)
#define OBJECTS   2u
#define STEPS     5u

enum { WHOLE, MINE, THEIRS, SCENES };

/* Triangles like kit_soup's, and beside them edges and points by themselves. */
static struct eng_mesh *make_mesh(struct prng *random)
{
    static double x[V][3];
    static uint32_t named[V]; /* each vertex once */
    const struct eng_mesh_counts counts = {V, TRIANGLES, EDGES, POINTS};
    const uint32_t *edges = named + (size_t)3 * TRIANGLES;
    struct eng_mesh *mesh;
    uint32_t bad;
    for (uint32_t i = 0; i < V; i++) {
        const double *with = i < 3 * TRIANGLES ? x[i - i % 3] : x[i - i % 2];
        bool is_new = i < 3 * TRIANGLES ? i % 3 == 0 : i % 2 == 0;
        for (int k = 0; k < 3; k++) {
            x[i][k] = is_new ? prng_between(random, 0, 1)
                             : with[k] + prng_between(random, -0.08, 0.08);
        }
        named[i] = i;
    }
    assert_ok(eng_mesh_make(&counts, &mesh));
    assert_ok(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, V, x));
    assert_ok(eng_mesh_write_triangles(mesh, 0, TRIANGLES, named, &bad));
    assert_ok(eng_mesh_write_edges(mesh, 0, EDGES, edges, &bad));
    assert_ok(eng_mesh_write_points(mesh, 0, POINTS, edges + 2 * EDGES, &bad));
    return mesh;
}

/* Most features that are near each other have one owner, as over ranks. */
static void share_out(struct prng *random, const struct eng_mesh *mesh,
                      uint64_t *vertices, uint64_t *edges)
{
    for (uint32_t i = 0; i < mesh->info.vertex_count; i++) {
        bool is_mine = (mesh->x[i][0] < 0.5) != (prng_u32(random, 20) == 0);
        vertices[i / 64] |= (uint64_t)is_mine << i % 64;
    }
    for (uint32_t i = 0; i < mesh->info.edge_count; i++) {
        bool is_mine =
            (mesh->x[mesh->edges[i][0]][0] < 0.5) != (prng_u32(random, 20) == 0);
        edges[i / 64] |= (uint64_t)is_mine << i % 64;
    }
}

struct play {
    struct eng_scene *scene[SCENES];
    struct eng_mesh *mesh[OBJECTS][SCENES];
    uint32_t idx[OBJECTS];
};

/* The same meshes in each scene; MINE owns what THEIRS does not. */
static void begin(struct play *play, struct prng *random)
{
    static uint64_t own[2][V / 64 + 1], rest[2][V / 64 + 1];
    static_assert(3 * TRIANGLES + EDGES < V, "fewer edges than vertices");
    for (uint32_t s = 0; s < SCENES; s++) {
        play->scene[s] = kit_scene();
    }
    for (uint32_t o = 0; o < OBJECTS; o++) {
        const struct prng before = *random;
        for (uint32_t s = 0; s < SCENES; s++) {
            *random = before;
            play->mesh[o][s] = make_mesh(random);
            assert_int_equal(eng_mesh_set_own(play->mesh[o][s], own[0], own[1]),
                             PCCD_E_STATE);
            assert_ok(eng_mesh_commit(play->mesh[o][s], 1));
        }
        memset(own, 0, sizeof own);
        share_out(random, play->mesh[o][WHOLE], own[0], own[1]);
        for (uint32_t i = 0; i < 2 * (V / 64 + 1); i++) {
            rest[i % 2][i / 2] = ~own[i % 2][i / 2];
        }
        assert_ok(eng_mesh_set_own(play->mesh[o][MINE], own[0], own[1]));
        assert_ok(eng_mesh_set_own(play->mesh[o][THEIRS], rest[0], rest[1]));
        assert_int_equal(eng_mesh_set_own(play->mesh[o][MINE], own[0], own[1]),
                         PCCD_E_STATE);
        for (uint32_t s = 0; s < SCENES; s++) {
            assert_ok(
                eng_scene_add(play->scene[s], play->mesh[o][s], 1 + o, &play->idx[o]));
        }
    }
}

static void end(struct play *play)
{
    for (uint32_t s = 0; s < SCENES; s++) {
        eng_scene_free(play->scene[s]);
        for (uint32_t o = 0; o < OBJECTS; o++) {
            eng_mesh_release(play->mesh[o][s]);
        }
    }
}

/* Some vertices go on, in all scenes alike: all of an object, a tenth, or none. */
static void move(struct play *play, struct prng *random)
{
    static double x[OBJECTS][V][3];
    for (uint32_t o = 0; o < OBJECTS; o++) {
        uint32_t each = prng_u32(random, 3);
        memcpy(x[o], eng_scene_positions(play->scene[WHOLE], play->idx[o], 1),
               sizeof x[o]);
        for (uint32_t i = 0; i < V; i++) {
            for (int k = 0; k < 3 && each > 0 && (each == 1 || i % 10 == 0); k++) {
                x[o][i][k] += prng_between(random, -0.05, 0.05);
            }
        }
    }
    for (uint32_t s = 0; s < SCENES; s++) {
        eng_stage_begin(play->scene[s]);
        for (uint32_t o = 0; o < OBJECTS; o++) {
            assert_ok(
                eng_stage_x1(play->scene[s], play->idx[o], PCCD_FORMAT_F64, 0, V, x[o]));
        }
    }
}

static uint32_t record_bytes;

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, record_bytes);
}

/* The records of the one scene are those of the two; of the first of these all begin with
 * a feature that it owns. A record begins with its kind, flags unless it is a pair, and
 * the names of two features. */
static void check_records(const struct play *play, const void *const records[SCENES],
                          const uint64_t counts[SCENES], uint32_t bytes)
{
    size_t all = (size_t)counts[WHOLE];
    assert_int_equal(counts[MINE] + counts[THEIRS], all);
    char *one = calloc(all + 1, bytes), *two = calloc(all + 1, bytes);
    assert_true(one && two);
    memcpy(one, records[WHOLE], all * bytes);
    memcpy(two, records[MINE], (size_t)counts[MINE] * bytes);
    memcpy(two + counts[MINE] * bytes, records[THEIRS], (size_t)counts[THEIRS] * bytes);
    for (uint64_t i = 0; i < counts[MINE]; i++) {
        const uint32_t *words = (const void *)(two + i * bytes);
        const uint32_t *name = words + (bytes == sizeof(struct pccd_pair) ? 1 : 2);
        enum pccd_tree tree = words[0] == PCCD_EE || words[0] == (uint32_t)PCCD_EF
                                  ? PCCD_TREE_EDGES
                                  : PCCD_TREE_VERTICES;
        assert_false(eng_mesh_is_foreign(play->mesh[name[0] - 1][MINE], tree, name[1]));
    }
    record_bytes = bytes;
    qsort(one, all, bytes, compare);
    qsort(two, all, bytes, compare);
    assert_memory_equal(one, two, all * bytes);
    free(one);
    free(two);
}

static uint64_t candidates_of(const struct pccd_step_counters *counters)
{
    uint64_t sum = 0;
    for (uint32_t kind = 0; kind < PCCD_KINDS_MAX; kind++) {
        sum += counters->candidates[kind];
    }
    return sum;
}

static uint64_t step(const struct play *play, const struct eng_question *settings)
{
    struct eng_step_result result[SCENES];
    const void *records[SCENES];
    uint64_t counts[SCENES], candidates[SCENES];
    for (uint32_t s = 0; s < SCENES; s++) {
        memset(&result[s], 0, sizeof result[s]);
        result[s] = kit_step(play->scene[s], settings);
        records[s] = result[s].records;
        counts[s] = result[s].count;
        candidates[s] = candidates_of(&result[s].counters);
    }
    check_records(play, records, counts, result[WHOLE].record_bytes);
    if (settings->method == PCCD_METHOD_PAPER) {
        assert_int_equal(candidates[MINE] + candidates[THEIRS], candidates[WHOLE]);
    } else { /* what is left out in time counts, and that depends on what went before */
        assert_true(50 * (candidates[MINE] + candidates[THEIRS]) <=
                    51 * candidates[WHOLE]);
    }
    return counts[WHOLE];
}

static uint64_t near(const struct play *play, const struct eng_question *settings,
                     enum pccd_near_what what)
{
    struct eng_question ask = *settings;
    ask.verb = what;
    ask.distance = 0.01;
    ask.end = 1;
    struct eng_step_result result[SCENES];
    const void *records[SCENES];
    uint64_t counts[SCENES];
    for (uint32_t s = 0; s < SCENES; s++) {
        memset(&result[s], 0, sizeof result[s]);
        result[s] = kit_near(play->scene[s], &ask);
        records[s] = result[s].records;
        counts[s] = result[s].count;
    }
    check_records(play, records, counts, result[WHOLE].record_bytes);
    return counts[WHOLE];
}

/* A vertex is as far from others as the nearest of all that any scene knows of it; one
 * that has the rest as foreign says infinity where it knows nothing. */
static void check_bounds(const struct play *play, const struct eng_question *settings)
{
    struct eng_question ask = *settings;
    ask.verb = PCCD_NEAR_VERTICES;
    ask.distance = 0.01;
    ask.end = 1;
    struct eng_step_result result[SCENES];
    const double *bounds[SCENES];
    uint64_t unknown = 0;
    for (uint32_t s = 0; s < SCENES; s++) {
        memset(&result[s], 0, sizeof result[s]);
        result[s] = kit_near(play->scene[s], &ask);
        assert_int_equal(result[s].count, OBJECTS * V);
        bounds[s] = result[s].records;
    }
    for (uint32_t i = 0; i < OBJECTS * V; i++) {
        double least = fmin(bounds[MINE][i], bounds[THEIRS][i]);
        assert_true(fmin(least, ask.distance) == bounds[WHOLE][i]);
        unknown += least > ask.distance;
    }
    assert_true(unknown > 0);
    assert_true(fmax(result[MINE].distance_max, result[THEIRS].distance_max) >=
                result[WHOLE].distance_max);
}

static void play_with(enum pccd_method method, uint32_t threads, double separation)
{
    struct prng random = {2026 + threads};
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct play play;
    uint64_t found = 0;
    settings.method = method;
    settings.threads = threads;
    settings.team_always = true;
    settings.distance = separation;
    begin(&play, &random);
    for (uint32_t i = 0; i < 2 * STEPS; i++) {
        settings.mode = i < STEPS ? PCCD_MODE_ALL : PCCD_MODE_PAIRS;
        move(&play, &random);
        found += step(&play, &settings);
        found += near(&play, &settings, PCCD_NEAR_PAIRS);
        found += near(&play, &settings, PCCD_NEAR_CROSSINGS);
        check_bounds(&play, &settings);
    }
    assert_true(found > 1000);
    end(&play);
}

/* If it failed: two ranks would both have a pair, or none would, or a rank would look for
 * what others find. */
CASE(foreign__pairs_are_left_out_by_wide)
{
    play_with(PCCD_METHOD_WIDE, 1, 0);
    play_with(PCCD_METHOD_WIDE, 2, 0.01);
}

/* The same of the binary trees. */
CASE(foreign__pairs_are_left_out_by_paper)
{
    play_with(PCCD_METHOD_PAPER, 1, 0);
    play_with(PCCD_METHOD_PAPER, 2, 0.01);
}
