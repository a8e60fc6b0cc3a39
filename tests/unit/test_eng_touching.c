/* test_eng_touching.c - a box on a floor, and other things that touch at t = 0. */
#include "eng_kit.h"

#include "world.h"

/* Where a box goes: all of it, and its half x > 0.5 by so much more. */
struct way {
    double by[3];
    double more;
};

static struct eng_step_result result;
static double within; /* things meet at this distance */

/* A box of 0.25 .. 0.75, half of that above a floor of 4 x 4 squares, whose
 * lines its sides are on, or a floor of 3 x 3, whose are elsewhere. */
static void put_box_on(uint32_t side)
{
    const double low[3] = {0.25, 0.25, within / 2};
    const double high[3] = {0.75, 0.75, 0.5};
    kit_begin_with(kit_sheet(side, 0), kit_box(low, high, false));
}

static void move_box(const struct way *way, enum pccd_touching touching,
                     enum pccd_mode mode, enum pccd_method method)
{
    const struct eng_mesh *mesh = eng_scene_object(kit.scene, kit.idx[1])->mesh;
    const double(*x0)[3] = eng_mesh_vertices(mesh);
    double x1[8][3];
    struct eng_question question = ENG_QUESTION_DEFAULT;
    for (uint32_t v = 0; v < 8; v++) {
        for (uint32_t k = 0; k < 3; k++) {
            double more = k == 2 && x0[v][0] > 0.5 ? way->more : 0;
            x1[v][k] = x0[v][k] + way->by[k] + more;
        }
    }
    question.touching = touching;
    question.mode = mode;
    question.method = method;
    question.distance = within;
    eng_stage_begin(kit.scene);
    assert_ok(eng_stage_x0x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 8, x0, x1));
    result = kit_step(kit.scene, &question);
}

/* By both methods; of the floor whose lines are under the box and of the other one. */
static void check_box(const struct way *way, double safe_step, bool enters)
{
    for (uint32_t i = 0; i < 4; i++) {
        enum pccd_method method = i % 2 ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE;
        put_box_on(i < 2 ? 4 : 3);
        move_box(way, PCCD_TOUCHING_LEFT_OUT, PCCD_MODE_ALL, method);
        assert_true(result.safe_step == safe_step);
        assert_true((result.entering > 0) == enters);
        assert_true(result.entering + result.sliding + result.leaving > 0);
        move_box(way, PCCD_TOUCHING_LEFT_OUT, PCCD_MODE_ANY, method);
        assert_int_equal(result.verdict,
                         safe_step == 1 ? PCCD_VERDICT_NO : PCCD_VERDICT_YES);
        move_box(way, PCCD_TOUCHING_KEPT, PCCD_MODE_ALL, method);
        assert_true(result.safe_step == 0 && result.toi_first == 0);
        assert_int_equal(result.entering + result.sliding + result.leaving, 0);
    }
}

/* A box that leaves its floor would never get away. */
CASE(a_box_that_leaves_its_floor__has_a_safe_step)
{
    check_box(&(struct way){{0, 0, 1}, 0}, 1, false);
    check_box(&(struct way){{0.01, 0.02, 0x1p-60}, 0}, 1, false);
    check_box(&(struct way){{0, 0, 0}, 0.25}, 1, false); /* it turns about an edge */
    check_box(&(struct way){{0, 0, 0.5}, 0.25}, 1, false);
}

/* A box that goes in would be left out. */
CASE(a_box_that_goes_into_its_floor__has_none)
{
    check_box(&(struct way){{0, 0, -1}, 0}, 0, true);
    check_box(&(struct way){{0, 0, -0x1p-60}, 0}, 0, true);
    check_box(&(struct way){{0, 0, 0}, -0.25}, 0, true);   /* by an edge */
    check_box(&(struct way){{0, 0, 0.25}, -0.5}, 0, true); /* one half goes up */
    check_box(&(struct way){{0.25, 0, -0x1p-50}, 0}, 0, true);
}

/* A box that stands would be told to enter. */
CASE(a_box_that_stands__slides)
{
    check_box(&(struct way){{0, 0, 0}, 0}, 1, false);
    assert_int_equal(result.count > 0, true);
    put_box_on(3);
    move_box(&(struct way){{0, 0, 0}, 0}, PCCD_TOUCHING_TOLD, PCCD_MODE_ALL,
             PCCD_METHOD_WIDE);
    assert_int_equal(result.entering + result.leaving, 0);
    assert_int_equal(result.sliding, result.initial);
    for (uint64_t i = 0; i < result.count; i++) {
        const struct pccd_contact *contact =
            (const struct pccd_contact *)result.records + i;
        assert_int_equal(contact->flags, PCCD_PROVED | PCCD_INITIAL | PCCD_SLIDES);
    }
}

/* One that slides has to stop where it comes over the next line of its floor, and not
 * before. */
CASE(a_box_that_slides__goes_on_to_the_next_line)
{
    put_box_on(3);
    move_box(&(struct way){{0.01, 0, 0}, 0}, PCCD_TOUCHING_LEFT_OUT, PCCD_MODE_ALL,
             PCCD_METHOD_WIDE);
    assert_int_equal(result.entering, 0);
    double first = result.toi_first;
    assert_true(result.safe_step > 0);
    move_box(&(struct way){{0.02, 0, 0}, 0}, PCCD_TOUCHING_LEFT_OUT, PCCD_MODE_ALL,
             PCCD_METHOD_PAPER);
    assert_true(first == 2 || fabs(2 * result.toi_first - first) < 1e-5);
}

/* The second contact of a pair that has left would be lost. */
CASE(what_leaves_and_comes_back__meets_when_it_does)
{
    /* A floor that turns about the axis y, and a tip that goes up and to the side: their
     * gap is t - 2 t^2. */
    const double floor0[3][3] = {{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}};
    const double floor1[3][3] = {{-8, -8, -16}, {8, -8, 16}, {0, 8, 0}};
    const double tip0[4][3] = {{0, 0, 0}, {0.25, 0, 64}, {0, 0.25, 64}, {-0.25, 0, 64}};
    const uint32_t face[1][3] = {{0, 1, 2}};
    const uint32_t sides[3][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
    double tip1[4][3];
    for (uint32_t v = 0; v < 4; v++) {
        tip1[v][0] = tip0[v][0] + 1;
        tip1[v][1] = tip0[v][1];
        tip1[v][2] = tip0[v][2] + 1;
    }
    kit_begin_with(kit_mesh(floor0, 3, face, 1), kit_mesh(tip0, 4, sides, 3));
    struct eng_question question = ENG_QUESTION_DEFAULT;
    question.touching = PCCD_TOUCHING_LEFT_OUT;
    for (uint32_t i = 0; i < 2; i++) {
        question.mode = i == 0 ? PCCD_MODE_ALL : PCCD_MODE_FIRST;
        eng_stage_begin(kit.scene);
        assert_ok(
            eng_stage_x0x1(kit.scene, kit.idx[0], PCCD_FORMAT_F64, 0, 3, floor0, floor1));
        assert_ok(
            eng_stage_x0x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 4, tip0, tip1));
        result = kit_step(kit.scene, &question);
        const struct pccd_contact *contact = result.records;
        assert_int_equal(result.count, 1);
        assert_int_equal(result.leaving, 1);
        assert_int_equal(contact->flags, PCCD_PROVED | PCCD_LEAVES);
        assert_true(contact->toi <= 0.5 && 0.5 <= contact->toi_hi);
        assert_true(contact->toi_hi - contact->toi <= 1e-6);
        assert_true(contact->normal[2] > 0); /* from the floor to the tip */
        assert_true(result.safe_step > 0.499 && result.safe_step < 0.5);
    }
}

/* A box that is too near and goes away, or stays, would never get free; or one that comes
 * nearer still would be let go. */
CASE(a_box_within_its_distance__is_told_by_whether_that_falls)
{
    static const double up[4] = {1, 0x1p-50, 0, -0x1p-50};
    within = 0.25;
    check_box(&(struct way){{0, 0, 1}, 0}, 1, false);
    check_box(&(struct way){{0, 0, 0}, 0}, 1, false);
    check_box(&(struct way){{0.01, 0.02, 1}, 0}, 1, false);
    check_box(&(struct way){{0.01, 0.02, 0}, 0}, 0, true); /* nearer to lines ahead */
    check_box(&(struct way){{0, 0, -0x1p-50}, 0}, 0, true);
    check_box(&(struct way){{0, 0, 0.25}, -0.5}, 0, true);
    for (uint32_t i = 0; i < 4; i++) {
        put_box_on(3);
        move_box(&(struct way){{0, 0, up[i]}, 0}, PCCD_TOUCHING_TOLD, PCCD_MODE_ALL,
                 PCCD_METHOD_WIDE);
        assert_int_equal(result.count, result.initial);
        assert_int_equal(result.leaving > 0, up[i] > 0);
        assert_int_equal(result.entering > 0, up[i] < 0);
        assert_true(result.sliding > 0); /* near lines of the floor itself */
        assert_int_equal(result.entering + result.sliding + result.leaving, result.count);
    }
    within = 0;
}

/* The distance would be one that it had before, or that another pair has: the tip above
 * comes nearer than it began when t - 2 t^2 = 0.125 (sqrt(1 + 4 t^2) - 1). */
CASE(what_goes_away_and_comes_nearer_than_it_began__meets_then)
{
    const double floor0[3][3] = {{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}};
    const double floor1[3][3] = {{-8, -8, -16}, {8, -8, 16}, {0, 8, 0}};
    const double tip0[4][3] = {
        {0, 0, 0.125}, {0.25, 0, 64}, {0, 0.25, 64}, {-0.25, 0, 64}};
    const uint32_t face[1][3] = {{0, 1, 2}};
    const uint32_t sides[3][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
    double tip1[4][3], t = 0.5;
    for (uint32_t v = 0; v < 4; v++) {
        tip1[v][0] = tip0[v][0] + 1;
        tip1[v][1] = tip0[v][1];
        tip1[v][2] = tip0[v][2] + 1;
    }
    for (int i = 0; i < 60; i++) {
        t = 0.5 - 0.125 * (sqrt(1 + 4 * t * t) - 1) / (2 * t);
    }
    kit_begin_with(kit_mesh(floor0, 3, face, 1), kit_mesh(tip0, 4, sides, 3));
    struct eng_question question = ENG_QUESTION_DEFAULT;
    question.touching = PCCD_TOUCHING_LEFT_OUT;
    question.distance = 0.25;
    eng_stage_begin(kit.scene);
    assert_ok(
        eng_stage_x0x1(kit.scene, kit.idx[0], PCCD_FORMAT_F64, 0, 3, floor0, floor1));
    assert_ok(eng_stage_x0x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 4, tip0, tip1));
    result = kit_step(kit.scene, &question);
    const struct pccd_contact *contact = result.records;
    assert_int_equal(result.count, 1);
    assert_int_equal(result.leaving, 1);
    assert_int_equal(contact->flags, PCCD_PROVED | PCCD_INSIDE | PCCD_LEAVES);
    assert_true(contact->toi > t - 1e-5 && contact->toi < t + 1e-5);
    assert_true(result.inside == 1 && result.safe_step == nextafter(contact->toi, 0));
}

/* Sheets of which nothing tells which is above would be let through each other. */
CASE(sheets_in_one_plane__enter_unless_their_fronts_face_each_other)
{
    const double x[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const double y[3][3] = {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}};
    const uint32_t up[1][3] = {{0, 1, 2}};
    const uint32_t down[1][3] = {{0, 2, 1}};
    for (uint32_t i = 0; i < 4; i++) {
        double y1[3][3];
        memcpy(y1, y, sizeof y1);
        for (uint32_t v = 0; v < 3; v++) {
            y1[v][2] = i / 2 == 0 ? 1 : -1;
        }
        kit_begin_with(kit_mesh(x, 3, up, 1), kit_mesh(y, 3, i % 2 ? down : up, 1));
        struct eng_question question = ENG_QUESTION_DEFAULT;
        question.touching = PCCD_TOUCHING_LEFT_OUT;
        eng_stage_begin(kit.scene);
        assert_ok(eng_stage_x0x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 3, y, y1));
        result = kit_step(kit.scene, &question);
        assert_int_equal(result.entering, i == 1 ? 0 : 3);
        assert_int_equal(result.leaving, i == 1 ? 3 : 0);
        assert_true(result.safe_step == (i == 1 ? 1 : 0));
    }
}

/* A face that is a line in the plane of what it touches may open to any side: it would be
 * let through. */
CASE(faces_that_are_lines_at_first__enter)
{
    const double floor[4][3] = {{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}, {0, -15, 0}};
    const uint32_t squares[2][3] = {{0, 1, 2}, {1, 0, 3}};
    const uint32_t face[1][3] = {{0, 1, 2}};
    /* On the floor; and across a line of it. */
    const double lines[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}},
                                   {{0, -8, 0}, {0, 2, 0}, {0, 0, 0}}};
    for (uint32_t i = 0; i < 4; i++) {
        double y1[3][3];
        memcpy(y1, lines[i / 2], sizeof y1);
        for (uint32_t v = 0; v < 3; v++) {
            y1[v][2] = i % 2 == 0 ? -1 : 1;
        }
        y1[2][1] += 0.25;
        kit_begin_with(kit_mesh(floor, 4, squares, 2),
                       kit_mesh(lines[i / 2], 3, face, 1));
        struct eng_question question = ENG_QUESTION_DEFAULT;
        question.touching = PCCD_TOUCHING_LEFT_OUT;
        eng_stage_begin(kit.scene);
        assert_ok(eng_stage_x0x1(kit.scene, kit.idx[1], PCCD_FORMAT_F64, 0, 3,
                                 lines[i / 2], y1));
        result = kit_step(kit.scene, &question);
        assert_true(result.entering > 0);
        assert_true(result.safe_step == 0);
    }
}

/* A rod that begins at a corner of a face, and lies on it, shows no side: its other end
 * would be let through the face. */
CASE(a_rod_on_the_face_it_begins_at__enters)
{
    const struct eng_mesh_counts counts = {.vertices = 4, .triangles = 1, .edges = 1};
    const double x0[4][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}};
    const uint32_t face[1][3] = {{0, 1, 2}};
    const uint32_t rod[1][2] = {{0, 3}};
    struct eng_question question = ENG_QUESTION_DEFAULT;
    kit_begin();
    kit_put(kit_mesh_of(&(struct kit_shape){counts, x0, face, rod, NULL, NULL}));
    question.touching = PCCD_TOUCHING_LEFT_OUT;
    for (int way = -1; way <= 1; way += 2) {
        double x1[4][3];
        memcpy(x1, x0, sizeof x1);
        x1[3][2] = way;
        eng_stage_begin(kit.scene);
        assert_ok(eng_stage_x0x1(kit.scene, kit.idx[0], PCCD_FORMAT_F64, 0, 4, x0, x1));
        result = kit_step(kit.scene, &question);
        assert_int_equal(result.entering, 1);
        assert_true(result.count == 1 && result.safe_step == 0);
    }
}

/* The records of the last answer would be taken for those of another question. */
CASE(steps_that_are_asked_by_turns__have_their_own_answers)
{
    static const enum pccd_touching turns[] = {PCCD_TOUCHING_KEPT, PCCD_TOUCHING_LEFT_OUT,
                                               PCCD_TOUCHING_KEPT, PCCD_TOUCHING_TOLD,
                                               PCCD_TOUCHING_TOLD, PCCD_TOUCHING_KEPT};
    struct eng_question question = ENG_QUESTION_DEFAULT;
    put_box_on(3);
    for (uint32_t i = 0; i < 6; i++) {
        question.touching = turns[i];
        result = kit_step(kit.scene, &question); /* nothing moves */
        bool is_left_out = turns[i] == PCCD_TOUCHING_LEFT_OUT;
        assert_true((result.count == 0) == is_left_out);
        assert_true((result.sliding > 0) == (turns[i] != PCCD_TOUCHING_KEPT));
        for (uint64_t k = 0; k < result.count; k++) {
            const struct pccd_contact *contact =
                (const struct pccd_contact *)result.records + k;
            assert_int_equal((contact->flags & PCCD_SLIDES) != 0,
                             turns[i] == PCCD_TOUCHING_TOLD);
        }
    }
}
