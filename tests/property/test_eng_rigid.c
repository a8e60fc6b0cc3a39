/* test_eng_rigid.c - objects that move by poses are answered as any others.
 *
 * Sequences of steps of objects that are posed, stand, and are written to in other ways
 * between: meshes that touch themselves, cut themselves, have parts within a hair of each
 * other, or nothing of that; turns up to half a turn, scales, shears, places so far away
 * that rounding brings features together. Each complete answer against that of a fresh
 * scene, which is given positions and knows of no pose; those of small scenes against
 * exact arithmetic, too. In many of the sequences all that moves does so by poses, and in
 * body space.
 */
#include "cases.h"
#include "eng_answer.h"
#include "eng_way.h"
#include "judge.h"
#include "sequences.h"

#define SEQUENCES     40
#define STEPS         8u
#define THREADS_MAX   3u
#define VERTICES_MAX  200u
#define OBJECTS       3u
#define PI            3.14159265358979323846
#define TINY_VERTICES 30u /* an object: few enough for exact arithmetic */

static struct {
    uint64_t sequences;
    uint64_t steps;
    uint64_t records;
    uint64_t within; /* of these, within an object */
    uint64_t rigid;  /* objects that were left out of their own way .. */
    uint64_t beside; /* .. in steps with contacts within objects */
    uint64_t bodies; /* steps in body space, .. */
    uint64_t meet;   /* .. and their records */
} sums;

static struct judge_sums judged;

struct sequence {
    uint64_t seed;
    uint32_t step;
    uint32_t next_id;
    struct prng prng;
    struct player player;
    struct eng_question settings;
    bool is_tiny;
    bool is_of_bodies; /* what moves does so by poses, and does not meet itself */
    double pose[OBJECTS][12]; /* where the last one ended */
};

static uint32_t draw(struct sequence *sequence, uint32_t bound)
{
    return prng_u32(&sequence->prng, bound);
}

static double between(struct sequence *sequence, double low, double high)
{
    return prng_between(&sequence->prng, low, high);
}

static void must(const struct sequence *sequence, bool holds, const char *what)
{
    if (!holds) {
        char way[WAY_TEXT_MAX];
        way_tell(&sequence->settings, way);
        print_message("# mode %d, %s\n", (int)sequence->settings.mode, way);
        fail_msg("PCCD_SEED=%llu, step %u: %s", (unsigned long long)sequence->seed,
                 sequence->step, what);
    }
}

/* ---- meshes ------------------------------------------------------------------------ */

struct mesh {
    double x[VERTICES_MAX][3];
    uint32_t triangles[2 * VERTICES_MAX][3];
    uint32_t vertex_count;
    uint32_t triangle_count;
};

static void add_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corners = mesh->triangles[mesh->triangle_count++];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

/* side x side squares at about a height. */
static void add_sheet(struct sequence *sequence, struct mesh *mesh, uint32_t side,
                      double height, double rough)
{
    uint32_t first = mesh->vertex_count;
    uint32_t row = side + 1;
    for (uint32_t i = 0; i < row * row; i++) {
        double *x = mesh->x[mesh->vertex_count++];
        x[0] = (double)(i % row) / side;
        x[1] = (double)(i / row) / side;
        x[2] = height + between(sequence, 0, rough);
    }
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t v = first + i / side * row + i % side;
        add_triangle(mesh, v, v + 1, v + row);
        add_triangle(mesh, v + 1, v + row + 1, v + row);
    }
}

/* A body of eight faces, each of them a corner of space. */
static void add_octahedron(struct mesh *mesh, double x, double size)
{
    uint32_t first = mesh->vertex_count;
    for (uint32_t i = 0; i < 6; i++) {
        double *v = mesh->x[mesh->vertex_count++];
        v[0] = x;
        v[1] = 0.5;
        v[2] = 0.5;
        v[i / 2] += i % 2 ? size : -size;
    }
    for (uint32_t i = 0; i < 8; i++) {
        add_triangle(mesh, first + i % 2, first + 2 + i / 2 % 2, first + 4 + i / 4);
    }
}

/* The distance between objects, as registered: some meet others. */
#define ASIDE        1.25
#define ASIDE_BODIES 0.75

static void make_mesh(struct sequence *sequence, struct mesh *mesh, uint32_t at)
{
    static const double gaps[] = {0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-4};
    uint32_t side = sequence->is_tiny ? 1 + draw(sequence, 2) : 3 + draw(sequence, 6);
    double rough = draw(sequence, 2) * 0.3 / side;
    mesh->vertex_count = mesh->triangle_count = 0;
    switch (draw(sequence, 6)) {
    case 0: /* nothing is near */
        add_sheet(sequence, mesh, side, 0, rough);
        break;
    case 1: /* two bodies, which touch, cut each other, or neither */
        add_octahedron(mesh, 0, 0.5);
        add_octahedron(mesh, 0.5 + 0.25 * draw(sequence, 4), 0.5);
        break;
    case 2: /* two sheets within a hair of each other, or a little more */
        add_sheet(sequence, mesh, side, 0, 0);
        add_sheet(sequence, mesh, side, gaps[draw(sequence, 6)], 0);
        break;
    case 3: /* a patch on a sheet: a few features are near */
        add_sheet(sequence, mesh, side, 0, 0);
        add_octahedron(mesh, 0.5, 0.2);
        for (uint32_t v = mesh->vertex_count - 6; v < mesh->vertex_count; v++) {
            mesh->x[v][2] += gaps[draw(sequence, 6)] - 0.3;
        }
        break;
    case 4: /* a heap */
        for (uint32_t i = 0; i < 6; i++) {
            for (int k = 0; k < 9; k++) {
                mesh->x[3 * i + (uint32_t)k / 3][k % 3] = between(sequence, 0, 1);
            }
            add_triangle(mesh, 3 * i, 3 * i + 1, 3 * i + 2);
        }
        mesh->vertex_count = 18;
        break;
    default: /* one body */
        add_octahedron(mesh, 0, 0.5);
        break;
    }
    double scale = exp2(draw(sequence, 3) ? 0 : 56 * between(sequence, -1, 1));
    for (uint32_t i = 0; i < 3 * mesh->vertex_count; i++) {
        double aside = sequence->is_of_bodies ? ASIDE_BODIES : ASIDE;
        aside = i % 3 == 0 ? aside * at : 0;
        mesh->x[i / 3][i % 3] = scale * (mesh->x[i / 3][i % 3] + aside);
    }
}

static void add_object(struct sequence *sequence, bool replaces)
{
    static struct mesh mesh;
    struct play_act act = {.what = replaces ? PLAY_REPLACE : PLAY_ADD};
    uint32_t at = replaces ? draw(sequence, OBJECTS) : sequence->player.object_count;
    make_mesh(sequence, &mesh, at);
    act.object_id = replaces ? sequence->player.objects[at].id : sequence->next_id++;
    act.vertex_count = mesh.vertex_count;
    act.triangle_count = mesh.triangle_count;
    act.x0 = mesh.x;
    act.triangles = mesh.triangles;
    player_act(&sequence->player, &act);
    memset(sequence->pose[at], 0, sizeof sequence->pose[at]);
    for (int i = 0; i < 3; i++) {
        sequence->pose[at][5 * i] = 1;
    }
    if (sequence->is_of_bodies) {
        const struct player_object *object = &sequence->player.objects[at];
        filters_set(&sequence->player.filters, sequence->player.scene,
                    (struct filters_place){object->id, object->idx},
                    (struct eng_object_filter){1, 1, false});
    }
}

/* ---- motions ----------------------------------------------------------------------- */

/* m, then a turn about an axis of space. */
static void turn(double m[12], int axis, double angle)
{
    int a = (axis + 1) % 3;
    int b = (axis + 2) % 3;
    for (int k = 0; k < 4; k++) {
        double one = m[4 * a + k];
        double other = m[4 * b + k];
        m[4 * a + k] = cos(angle) * one - sin(angle) * other;
        m[4 * b + k] = sin(angle) * one + cos(angle) * other;
    }
}

/* From one pose to the next; `size` is about that of the mesh. */
static void change_pose(struct sequence *sequence, double m[12], double size)
{
    static const double angles[] = {0, 1, 10, 90, 170, 179.9, 180};
    int axis = (int)draw(sequence, 3);
    switch (draw(sequence, 8)) {
    case 0: /* far: rounding is up to as large as the object */
        m[4 * axis + 3] += size * exp2(40 * between(sequence, 0, 1));
        break;
    case 1:
        for (int k = 0; k < 3; k++) { /* larger or smaller along one axis of space */
            m[4 * axis + k] *= exp2(between(sequence, -3, 3));
        }
        break;
    case 2: /* a shear, or pressed flat */
        for (int k = 0; k < 3; k++) {
            m[4 * axis + k] = draw(sequence, 8) == 0
                                  ? 0
                                  : m[4 * axis + k] + 0.3 * m[(4 * axis + 4) % 12 + k];
        }
        break;
    case 3: /* back to where it was registered */
        memset(m, 0, 12 * sizeof *m);
        m[0] = m[5] = m[10] = 1;
        break;
    default:
        turn(m, axis, PI / 180 * angles[draw(sequence, 7)]);
        m[4 * axis + 3] += size * between(sequence, -0.3, 0.3);
        break;
    }
    for (int i = 0; i < 12; i++) {
        double most = i % 4 == 3 ? 1e17 : 1e17 / size; /* coordinates have a limit */
        m[i] = fmin(fmax(m[i], -most), most);
    }
}

static double size_of(const struct player_object *object)
{
    double size = 0;
    for (uint32_t i = 0; i < 3 * object->vertex_count; i++) {
        size = fmax(size, fabs(object->registered[i / 3][i % 3]));
    }
    return size;
}

static void pose(struct sequence *sequence, uint32_t at, bool in_halves)
{
    const struct player_object *object = &sequence->player.objects[at];
    struct play_act act = {.what = PLAY_RIGID, .object_id = object->id};
    double *last = sequence->pose[at];
    memcpy(act.m[0], last, sizeof act.m[0]);
    if (draw(sequence, 6) == 0) {
        change_pose(sequence, act.m[0], size_of(object));
    }
    memcpy(act.m[1], act.m[0], sizeof act.m[1]);
    if (draw(sequence, 5) > 0) {
        change_pose(sequence, act.m[1], size_of(object));
    }
    memcpy(last, act.m[1], sizeof act.m[1]);
    uint32_t half = object->vertex_count / 2;
    act.vertex_count = in_halves ? half : object->vertex_count;
    player_act(&sequence->player, &act);
    if (in_halves) {
        act.first = half;
        act.vertex_count = object->vertex_count - half;
        player_act(&sequence->player, &act);
    }
}

/* Positions: of a few vertices, or of all. */
static void bend(struct sequence *sequence, uint32_t at)
{
    static double x1[VERTICES_MAX][3];
    const struct player_object *object = &sequence->player.objects[at];
    uint32_t first = draw(sequence, object->vertex_count);
    uint32_t most = object->vertex_count - first;
    struct play_act act = {.what = PLAY_X1,
                           .object_id = object->id,
                           .first = first,
                           .vertex_count = 1 + draw(sequence, most),
                           .x1 = x1};
    double reach = size_of(object) * exp2(-30 * between(sequence, 0, 1));
    for (uint32_t i = 0; i < 3 * act.vertex_count; i++) {
        x1[i / 3][i % 3] =
            object->x1[first + i / 3][i % 3] + between(sequence, -reach, reach);
    }
    player_act(&sequence->player, &act);
}

/* Each object is posed, as a rule. */
static void move(struct sequence *sequence)
{
    player_open(&sequence->player);
    for (uint32_t at = 0; at < OBJECTS; at++) {
        uint32_t how = draw(sequence, sequence->is_of_bodies ? 9 : 12);
        if (sequence->is_of_bodies && how == 8) { /* it stands */
            continue;
        }
        if (how < 8) {
            pose(sequence, at, false);
        } else if (how == 8) {
            pose(sequence, at, true);
        } else if (how == 9) {
            bend(sequence, at);
        }
    }
}

/* ---- steps ------------------------------------------------------------------------- */

static bool is_within(const struct eng_step_result *result, uint64_t at)
{
    struct pccd_contact contact;
    memcpy(&contact, (const char *)result->records + at * result->record_bytes,
           sizeof contact);
    return contact.object_a == contact.object_b;
}

static void count(const struct eng_step_result *result)
{
    uint64_t within = 0;
    for (uint64_t i = 0; i < result->count && result->mode == PCCD_MODE_ALL; i++) {
        within += is_within(result, i);
    }
    sums.steps++;
    sums.records += result->count;
    sums.within += within;
    sums.rigid += result->counters.rigid_objects;
    sums.beside += within > 0 ? result->counters.rigid_objects : 0;
}

static bool all_are_small(const struct player *player)
{
    uint32_t vertices = 0;
    for (uint32_t i = 0; i < player->object_count; i++) {
        vertices += player->objects[i].vertex_count;
    }
    return vertices <= TINY_VERTICES;
}

static void take_step(struct sequence *sequence)
{
    struct eng_step_result result;
    struct answer fresh;
    way_draw(&sequence->prng, THREADS_MAX, &sequence->settings);
    sequence->settings.mode = draw(sequence, 3) > 0
                                  ? PCCD_MODE_ALL
                                  : (enum pccd_mode)draw(sequence, PCCD_MODE_COUNT);
    must(sequence,
         player_step(&sequence->player, &sequence->settings, &result) == PCCD_OK &&
             result.incomplete == PCCD_COMPLETE,
         "the step failed");
    must(sequence, result.mode != PCCD_MODE_PAIRS || result.counters.rigid_objects == 0,
         "pairs of boxes are left out");
    answer_find_fresh(&sequence->player, &sequence->settings, &fresh);
    must(sequence, fresh.result.counters.rigid_objects == 0, "positions are no poses");
    const char *difference = answer_difference(&fresh, &result);
    must(sequence, difference == NULL, difference);
    answer_free(&fresh);
    count(&result);
    if (way_was_by_bodies(sequence->player.scene)) {
        sums.bodies++;
        sums.meet += result.count;
    }
    if (result.mode == PCCD_MODE_ALL && all_are_small(&sequence->player)) {
        judge_check_play(&judged, &sequence->player, sequence->settings.tolerance,
                         sequence->seed, sequence->step, &result);
    }
}

static void live(uint64_t seed)
{
    struct sequence sequence = {.seed = seed, .prng = {seed}, .next_id = 3};
    sequence.settings = (struct eng_question)ENG_QUESTION_DEFAULT;
    sequence.is_tiny = draw(&sequence, 2) == 0;
    sequence.is_of_bodies = draw(&sequence, 2) == 0;
    player_init(&sequence.player, NULL);
    for (uint32_t i = 0; i < OBJECTS; i++) {
        add_object(&sequence, false);
    }
    for (; sequence.step < STEPS; sequence.step++) {
        if (draw(&sequence, 8) == 0) {
            add_object(&sequence, true);
        }
        if (!sequence.is_of_bodies && draw(&sequence, 8) == 0) {
            player_draw_filters(&sequence.player, &sequence.prng);
        }
        move(&sequence);
        if (draw(&sequence, 10) == 0) { /* what is dropped leaves no trace */
            player_drop(&sequence.player);
            player_stage_copies(&sequence.player);
        }
        take_step(&sequence);
    }
    sums.sequences++;
    player_deinit(&sequence.player);
}

/* If this failed, a contact of an object with itself would be missed because the poses
 * that move it seem to keep its parts from each other. */
CASE(rigid__objects_are_answered_as_any_others)
{
    sequences_live(live, SEQUENCES, NULL);
    print_message(
        "# %llu sequences, %llu steps, %llu records, %llu within objects; %llu "
        "objects left out, %llu beside such records; by the oracle %llu steps; in body "
        "space %llu, with %llu records\n",
        (unsigned long long)sums.sequences, (unsigned long long)sums.steps,
        (unsigned long long)sums.records, (unsigned long long)sums.within,
        (unsigned long long)sums.rigid, (unsigned long long)sums.beside,
        (unsigned long long)judged.steps, (unsigned long long)sums.bodies,
        (unsigned long long)sums.meet);
    if (!getenv("PCCD_SEED") && sums.sequences >= SEQUENCES) {
        assert_true(sums.within > 1000 && sums.rigid > sums.steps / 4);
        assert_true(sums.beside > 20 && judged.steps > 20);
        assert_true(sums.bodies > 20 && sums.meet > 100);
    }
}

/* Two triangles, of corners that are multiplied by `size` as registered, and by `factor`
 * in poses; from and to where these take each of them along z. */
struct rounded {
    double size;
    double factor;
    double from[2];
    double to[2];
};

/* The second comes down on the first. */
static void check_rounded(const struct rounded *rounded, bool by_bodies)
{
    static uint32_t corners[1][3] = {{0, 1, 2}};
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    struct player player;
    settings.mode = PCCD_MODE_ALL;
    settings.team_always = by_bodies;
    player_init(&player, NULL);
    for (uint32_t i = 0; i < 2; i++) {
        double x[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                             {{0.25, 0.25, 0x1p-4}, {1, 0, 1}, {0, 1, 1}}};
        for (uint32_t k = 0; k < 9; k++) {
            x[i][k / 3][k % 3] *= rounded->size;
        }
        player_act(&player, &(struct play_act){.what = PLAY_ADD,
                                               .object_id = i,
                                               .vertex_count = 3,
                                               .triangle_count = 1,
                                               .x0 = x[i],
                                               .triangles = corners});
        filters_set(&player.filters, player.scene,
                    (struct filters_place){i, player.objects[i].idx},
                    (struct eng_object_filter){1, 1, false});
    }
    for (uint32_t i = 0; i < 2; i++) {
        struct play_act pose = {.what = PLAY_RIGID, .object_id = i, .vertex_count = 3};
        for (int k = 0; k < 3; k++) {
            pose.m[0][5 * k] = pose.m[1][5 * k] = rounded->factor;
        }
        pose.m[0][11] = rounded->from[i];
        pose.m[1][11] = rounded->to[i];
        player_act(&player, &pose);
    }
    assert_int_equal(player_step(&player, &settings, &result), PCCD_OK);
    assert_int_equal(way_was_by_bodies(player.scene), by_bodies);
    assert_true(result.count > 0);
    player_deinit(&player);
}

/* If this failed, what meets would be missed in body space:
 * - because positions are rounded: poses keep a corner 2^-4 above a triangle, which
 *   doubles beyond 2^50 do not;
 * - because numbers of poses are too small for floats, which are off by more than 2^-11
 *   of them: a corner passes through a triangle by 2^-14 of its body. */
CASE(rigid__what_rounding_brings_together_meets)
{
    const double factor = 713.49 * 0x1p-149;
    const double size = 0x1p59;
    const struct rounded of_places = {
        1, 1, {0x1p50, 0x1p50 + 0.5}, {0x1p50, 0x1p50}};
    const struct rounded of_factors = {
        size, factor, {0, size * factor}, {0, -(0x1p-4 + 0x1p-14) * size * factor}};
    for (int by_bodies = 0; by_bodies < 2; by_bodies++) {
        check_rounded(&of_places, by_bodies);
        check_rounded(&of_factors, by_bodies);
    }
}

#define SIDE   24u
#define ACROSS (SIDE + 1)

/* Two sheets turn about their middles in a step, one so far above the other. */
static void turn_sheets(struct player *player, double from, double to, double above)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    settings.mode = PCCD_MODE_ALL;
    for (uint32_t i = 0; i < 2; i++) {
        struct play_act pose = {
            .what = PLAY_RIGID, .object_id = i, .vertex_count = ACROSS * ACROSS};
        for (int end = 0; end < 2; end++) {
            double angle = end == 0 ? from : to;
            double *m = pose.m[end];
            m[0] = m[5] = cos(angle);
            m[1] = -sin(angle);
            m[4] = sin(angle);
            m[10] = 1;
            m[11] = above * i;
        }
        player_act(player, &pose);
    }
    assert_int_equal(player_step(player, &settings, &result), PCCD_OK);
}

/* If this failed, bodies that turn by much in a step, or are near each other, would be
 * tested in body space, where that takes several times as long: their leaves sweep by far
 * more than their size, and many are beside each other. */
CASE(rigid__what_turns_far_or_is_near_is_not_tested_in_body_space)
{
    static double x[ACROSS * ACROSS][3];
    static uint32_t triangles[2 * SIDE * SIDE][3];
    struct player player;
    for (uint32_t i = 0; i < ACROSS * ACROSS; i++) {
        x[i][0] = (double)(i % ACROSS) / SIDE - 0.5;
        x[i][1] = (double)(i / ACROSS) / SIDE - 0.5;
        x[i][2] = i % 2 * 0x1p-6; /* rough */
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        uint32_t v = i / SIDE * ACROSS + i % SIDE;
        uint32_t w = v + ACROSS;
        uint32_t two[2][3] = {{v, v + 1, w}, {v + 1, w + 1, w}};
        memcpy(triangles[2 * i], two, sizeof two);
    }
    for (int is_near = 0; is_near < 2; is_near++) {
        player_init(&player, NULL);
        for (uint32_t i = 0; i < 2; i++) {
            player_act(&player, &(struct play_act){.what = PLAY_ADD,
                                                   .object_id = i,
                                                   .vertex_count = ACROSS * ACROSS,
                                                   .triangle_count = 2 * SIDE * SIDE,
                                                   .x0 = x,
                                                   .triangles = triangles});
            filters_set(&player.filters, player.scene,
                        (struct filters_place){i, player.objects[i].idx},
                        (struct eng_object_filter){1, 1, false});
        }
        double angle = 0;
        for (int step = 0; step < 100 && !way_was_by_bodies(player.scene); step++) {
            turn_sheets(&player, angle, angle + 0.1, 4);
            angle += 0.1;
        }
        assert_true(way_was_by_bodies(player.scene));
        turn_sheets(&player, angle, angle + (is_near ? 0.1 : 1), is_near ? 0x1p-8 : 4);
        turn_sheets(&player, angle, angle + 0.1, 4); /* nor is what comes after it */
        assert_false(way_was_by_bodies(player.scene));
        player_deinit(&player);
    }
}
