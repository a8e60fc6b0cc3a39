/* test_int_verify.c - answers that are wrong, and whether pccdctl verify finds that. */
#include "cases.h"

#include <unistd.h>

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "reader.h"
#include "record_hash.h"
#include "recording.h"
#include "run_ctl.h"

#define STEPS 6u

static int set_up(void **state)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    struct pccd_client *client = NULL;
    struct test_grid grid;

    assert_true(test_recording_begin());
    assert_ok(test_shared_connect(state, 0, &client));
    assert_ok(pccd_record_start(client, test_recording, &settings));
    assert_ok(test_grid_make(client, 8, &grid));
    for (uint32_t i = 0; i < STEPS; i++) {
        const struct pccd_step_settings step_settings = {
            .struct_bytes = sizeof(struct pccd_step_settings),
            .mode = i % 2 == 0 ? PCCD_MODE_ALL : PCCD_MODE_PAIRS};
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t step = 0;

        assert_ok(test_grid_submit(&grid, &step_settings, &step));
        assert_ok(pccd_wait(client, step, -1, &answer));
        assert_true(answer.total > 0);
        pccd_answer_release(client, &answer);
    }
    test_grid_free(&grid);
    pccd_close(client);
    return 0;
}

/* ---- forging ----------------------------------------------------------------------- */

enum forgery {
    FORGE_NOTHING,
    FORGE_MISSING,  /* a contact left out, with all sums right */
    FORGE_INVENTED, /* one of a vertex with another face */
    FORGE_LATE,     /* its time after the first contact */
    FORGE_EARLY,    /* and before */
    FORGE_INITIAL,  /* claimed to touch at t = 0 */
    FORGE_HASH,
    FORGE_MOTION, /* positions under which the answers are wrong */
    FORGE_MASK,   /* the object was to meet nothing */
    FORGE_PAIR,   /* and not the floor */
    FORGE_COUNT,
    FORGE_NAMES = FORGE_COUNT, /* of library and processor, which a terminal would obey */
    FORGE_PAIRS,               /* the hash of an answer in mode pairs */
    FORGE_FATE,                /* what enters is told to leave, and the reverse */
    /* What was asked in mode all is said to have been asked in mode first-per-pair: with
     * all contacts, or with that of the greatest or the least toi alone. */
    FORGE_PER_PAIR,
    FORGE_PER_PAIR_LATEST,
    FORGE_PER_PAIR_FIRST
};

static bool is_per_pair(enum forgery forgery)
{
    return forgery >= FORGE_PER_PAIR && forgery <= FORGE_PER_PAIR_FIRST;
}

/* The answer is written after its records have been forged, so it waits here. */
struct forger {
    struct record_writer writer;
    enum forgery forgery;
    struct record_answer answer;
    uint64_t answer_ns;
    bool has_answer;
    bool is_done;
    uint32_t scene;
    uint32_t objects[2]; /* the floor, the grid */
    uint32_t object_count;
};

static void put(struct forger *forger, uint16_t kind, uint64_t time_ns, const void *head,
                size_t head_bytes, const void *rest, size_t rest_bytes)
{
    const struct record_part parts[2] = {{head, head_bytes}, {rest, rest_bytes}};

    assert_ok(record_writer_add(&forger->writer, (enum record_kind)kind, time_ns, parts,
                                rest_bytes > 0 ? 2 : 1));
}

static void put_answer(struct forger *forger)
{
    if (forger->has_answer) {
        put(forger, RECORD_ANSWER, forger->answer_ns, &forger->answer,
            sizeof forger->answer, NULL, 0);
    }
    forger->has_answer = false;
}

/* A chunk that no other function forges. */
static void put_rest(struct forger *forger, const struct record_view *view)
{
    struct record_begin begin;

    if (view->kind != RECORD_BEGIN || forger->forgery != FORGE_NAMES) {
        put(forger, view->kind, view->time_ns, view->payload, view->bytes, NULL, 0);
        return;
    }
    assert_int_equal(view->bytes, sizeof begin);
    memcpy(&begin, view->payload, sizeof begin);
    memcpy(begin.library, "\033[2J\233\a", 7);
    memset(begin.cpu, '\033', sizeof begin.cpu); /* and no NUL */
    forger->is_done = true;
    put(forger, RECORD_BEGIN, view->time_ns, &begin, sizeof begin, NULL, 0);
}

static void note_object(struct forger *forger, const struct record_view *view)
{
    struct record_object object;

    if (view->kind == RECORD_OBJECT) {
        memcpy(&object, view->payload, sizeof object);
        assert_in_range(forger->object_count, 0, 1);
        forger->scene = object.scene;
        forger->objects[forger->object_count++] = object.object;
    }
}

/* Forge a filter that would forbid contacts that are in the answers. */
static void forge_filter(struct forger *forger, const struct record_view *view)
{
    struct record_filter filter = {
        .scene = forger->scene, .object = forger->objects[1], .what = PCCD_OBJECT_MASK};
    struct record_pairs pairs = {.scene = forger->scene, .count = 1};
    struct record_pair pair = {
        .a = forger->objects[0], .b = forger->objects[1], .said = RECORD_IGNORED};

    if (forger->is_done) {
        return;
    }
    if (forger->forgery == FORGE_MASK) {
        put(forger, RECORD_FILTER, view->time_ns, &filter, sizeof filter, NULL, 0);
        forger->is_done = true;
    } else if (forger->forgery == FORGE_PAIR) {
        put(forger, RECORD_PAIRS, view->time_ns, &pairs, sizeof pairs, &pair,
            sizeof pair);
        forger->is_done = true;
    }
}

/* Sums and hash that fit the records. */
static void settle(struct record_answer *answer, const struct pccd_contact *contacts,
                   uint64_t count)
{
    record_hash_2(contacts, count, sizeof *contacts, answer->hash);
    answer->total = count;
    answer->toi_first = 2;
    answer->initial = 0;
    memset(answer->counts, 0, sizeof answer->counts);
    for (uint64_t i = 0; i < count; i++) {
        answer->counts[contacts[i].kind]++;
        answer->initial += (contacts[i].flags & PCCD_INITIAL) != 0;
        if (contacts[i].toi < answer->toi_first) {
            answer->toi_first = contacts[i].toi;
        }
    }
}

static void forge_contacts(struct forger *forger, struct pccd_contact *contacts,
                           uint64_t *count)
{
    struct pccd_contact *one = &contacts[*count / 2];

    switch (forger->forgery) {
    case FORGE_MISSING:
        memmove(one, one + 1, (size_t)(contacts + *count - one - 1) * sizeof *one);
        --*count;
        break;
    case FORGE_INVENTED:
        contacts[*count] = contacts[*count - 1];
        contacts[*count].kind = PCCD_EE;
        contacts[*count].object_b = contacts[*count].object_a;
        contacts[*count].feature_a = 0;
        contacts[*count].feature_b = 100;
        ++*count;
        break;
    case FORGE_LATE:
        one->toi += 1e-5;
        one->toi_hi += 1e-5;
        break;
    case FORGE_EARLY:
        one->toi -= 1e-5;
        one->toi_hi -= 1e-5;
        break;
    case FORGE_INITIAL:
        one->flags |= PCCD_INITIAL;
        break;
    case FORGE_FATE:
        one->flags ^= PCCD_ENTERS | PCCD_LEAVES;
        break;
    case FORGE_PER_PAIR_LATEST:
    case FORGE_PER_PAIR_FIRST:
        for (uint64_t i = 0; i < *count; i++) {
            bool is_later = contacts[i].toi > contacts[0].toi;
            bool is_earlier = contacts[i].toi < contacts[0].toi;
            if (forger->forgery == FORGE_PER_PAIR_FIRST ? is_earlier : is_later) {
                contacts[0] = contacts[i];
            }
        }
        *count = 1;
        settle(&forger->answer, contacts, 1);
        return; /* of every step */
    default:
        return;
    }
    settle(&forger->answer, contacts, *count);
    forger->is_done = true;
}

static void forge_records(struct forger *forger, const struct record_view *view)
{
    static struct pccd_contact contacts[4096];
    const uint8_t *body = (const uint8_t *)view->payload + sizeof(struct record_records);
    struct record_records head;

    memcpy(&head, view->payload, sizeof head);
    bool is_done = forger->is_done && !is_per_pair(forger->forgery);
    if (head.record_bytes != sizeof(struct pccd_contact) || is_done) {
        put_answer(forger);
        put(forger, RECORD_RECORDS, view->time_ns, view->payload, view->bytes, NULL, 0);
        return;
    }
    assert_in_range(head.count, 3, 4095);
    memcpy(contacts, body, head.count * sizeof *contacts);
    forge_contacts(forger, contacts, &head.count);
    put_answer(forger);
    put(forger, RECORD_RECORDS, view->time_ns, &head, sizeof head, contacts,
        head.count * sizeof *contacts);
}

/* Every end position of the frame mirrored: nothing goes through the floor any more. */
static void forge_frame(struct forger *forger, const struct record_view *view)
{
    uint8_t *copy = test_room(view->bytes);
    struct record_segment segment;

    memcpy(copy, view->payload, view->bytes);
    if (is_per_pair(forger->forgery)) {
        struct record_frame frame;
        memcpy(&frame, copy, sizeof frame);
        frame.mode =
            frame.mode == PCCD_MODE_ALL ? (uint32_t)PCCD_MODE_FIRST_PER_PAIR : frame.mode;
        memcpy(copy, &frame, sizeof frame);
        forger->is_done = true;
    }
    if (forger->forgery == FORGE_MOTION && !forger->is_done) {
        memcpy(&segment, copy + sizeof(struct record_frame), sizeof segment);
        assert_int_equal(segment.format, PCCD_FORMAT_F32);
        for (uint32_t i = 0; i < segment.count; i++) {
            uint8_t *at = copy + sizeof(struct record_frame) + segment.offset1 + i * 12;
            float x[3];

            memcpy(x, at, sizeof x);
            for (int k = 0; k < 3; k++) {
                x[k] = -x[k];
            }
            memcpy(at, x, sizeof x);
        }
        forger->is_done = true;
    }
    put(forger, RECORD_FRAME, view->time_ns, copy, view->bytes, NULL, 0);
    free(copy);
}

static void forge_of(const char *source, enum forgery forgery)
{
    struct forger forger = {.writer = {.fd = -1}, .forgery = forgery};
    struct record_reader reader;
    struct record_view view;
    int got;

    (void)unlink(test_forged);
    assert_ok(record_writer_open(&forger.writer, test_forged));
    assert_ok(record_reader_open(&reader, source));
    while ((got = record_reader_next(&reader, &view)) == 1) {
        if (view.kind == RECORD_ANSWER) {
            put_answer(&forger);
            memcpy(&forger.answer, view.payload, sizeof forger.answer);
            forger.answer_ns = view.time_ns;
            forger.has_answer = true;
            if (is_per_pair(forgery) && forger.answer.mode == PCCD_MODE_ALL) {
                forger.answer.mode = PCCD_MODE_FIRST_PER_PAIR;
            }
            bool is_chosen = forger.answer.mode == PCCD_MODE_PAIRS
                                 ? forgery == FORGE_PAIRS
                                 : forgery == FORGE_HASH;
            if (is_chosen && !forger.is_done) {
                forger.answer.hash[1] ^= 1;
                forger.is_done = true;
            }
        } else if (view.kind == RECORD_RECORDS) {
            forge_records(&forger, &view);
        } else if (view.kind == RECORD_FRAME) {
            put_answer(&forger);
            forge_filter(&forger, &view);
            forge_frame(&forger, &view);
        } else {
            note_object(&forger, &view);
            put_answer(&forger);
            put_rest(&forger, &view);
        }
    }
    assert_int_equal(got, 0);
    assert_int_equal(reader.ending, RECORD_ENDING_WHOLE);
    assert_true(forger.is_done || forgery == FORGE_NOTHING);
    record_reader_deinit(&reader);
    record_writer_deinit(&forger.writer);
}

static void forge(enum forgery forgery)
{
    forge_of(test_recording, forgery);
}

/* ---- judging ----------------------------------------------------------------------- */

/* pccdctl COMMAND OPTIONS, of what was recorded or of the forged copy, ends so and says
 * each of the texts. */
#define HONEST(status, command, options, ...)                                            \
    test_ctl_says(status, command, options, test_recording, __VA_ARGS__, NULL)
#define FORGED(status, command, options, ...)                                            \
    test_ctl_says(status, command, options, test_forged, __VA_ARGS__, NULL)

/* If this failed, right answers would be called wrong, or nothing would be checked. */
CASE(verify__passes_what_is_right)
{
    forge(FORGE_NOTHING);
    HONEST(0, "verify", "", "PASS: 6 steps");
    HONEST(0, "verify", "--repeat --method paper", "PASS: 6 steps");
    FORGED(0, "verify", "--json --sample 100000 --seed 7", "\"pass\": true");
}

/* Record one step of one object from where it is registered to x1, with one contact of
 * that kind, and let verify pass it. */
static void pass_contact(void **state, const struct pccd_mesh_data *data, double radius,
                         const void *x1, enum pccd_kind kind)
{
    const struct pccd_object_settings thick = {.what = PCCD_OBJECT_RADIUS,
                                               .radius = radius};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_client *client = NULL;
    uint32_t mesh = 0, scene = 0, object = 0;

    assert_ok(test_shared_connect(state, 0, &client));
    (void)unlink(test_forged);
    assert_ok(pccd_record_start(client, test_forged, NULL));
    assert_ok(pccd_mesh_put(client, data, &mesh, NULL));
    scene = test_scene(client);
    object = test_object(client, scene, mesh);
    assert_ok(pccd_object_set(client, scene, object, &thick));
    assert_ok(pccd_step_x0x1(client, scene, object, data->x, x1, PCCD_FORMAT_F64,
                             data->vertex_count, NULL, &answer));
    assert_int_equal(answer.total, 1);
    assert_int_equal(answer.counts[kind], 1);
    pccd_close(client);
    FORGED(0, "verify", "", "PASS: 1 step, 1 contact ");
}

/* If this failed, a vertex that nothing uses, beside a point with a thickness, would be
 * taken for a point, or an edge with equal ends would not, and a right answer be called
 * wrong. Vertex 1 is unused; 2 is a point by such an edge, and meets 3. */
CASE(verify__takes_an_unused_vertex_for_no_point)
{
    static const double x[4][3] = {{0, 0, 0}, {0.01, 0, 0}, {5, 0, 0}, {5, 0, 0.1}};
    static const uint32_t points[2] = {0, 3}, edge[2] = {2, 2};
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = x,
                                        .format = PCCD_FORMAT_F64,
                                        .vertex_count = 4,
                                        .points = points,
                                        .edges = edge,
                                        .point_count = 2,
                                        .edge_count = 1};

    pass_contact(state, &data, 0.1, x, PCCD_VV);
}

/* If this failed, a right answer would be called wrong: the second rod turns round where
 * the two meet, a point then, and nothing tells the sides of a point. */
CASE(verify__asks_no_side_of_an_edge_that_is_a_point)
{
    static const double x0[4][3] = {{1, 0, 1}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0}};
    static const double x1[4][3] = {{0, 1, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    static const uint32_t edges[4] = {0, 1, 2, 3};
    const struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                        .x = x0,
                                        .format = PCCD_FORMAT_F64,
                                        .vertex_count = 4,
                                        .edges = edges,
                                        .edge_count = 2};

    pass_contact(state, &data, 0, x1, PCCD_EE);
}

/* If this failed, a daemon with a wrong answer would be trusted. */
CASE(verify__shows_what_is_wrong)
{
    static const char *const says[FORGE_COUNT] = {
        [FORGE_MISSING] = "a contact is missing in the answer",
        [FORGE_INVENTED] = "a contact is claimed to be proved, and there is none",
        [FORGE_LATE] = "the first contact is before the record's time",
        [FORGE_EARLY] = "the first contact is after the record's time",
        [FORGE_INITIAL] = "meet at t = 0, or begin within their distance, is claimed",
        [FORGE_HASH] = "the recorded hash is not that of the recorded records",
        [FORGE_MOTION] = "there is none",
        [FORGE_MASK] = "the record's objects may not meet each other",
        [FORGE_PAIR] = "the record's objects may not meet each other"};

    for (enum forgery forgery = FORGE_NOTHING + 1; forgery < FORGE_COUNT; forgery++) {
        forge(forgery);
        FORGED(1, "verify", "--sample 100000", "FAIL: step", says[forgery]);
    }
}

/* If this failed, a body could be told to meet another later than it does, or twice. */
CASE(verify__knows_the_first_contact_of_two_objects)
{
    forge(FORGE_PER_PAIR_FIRST);
    FORGED(0, "verify", "--sample 100000", "PASS: 6 steps");
    forge(FORGE_PER_PAIR_LATEST);
    FORGED(1, "verify", "--sample 100000", "a contact is missing in the answer");
    forge(FORGE_PER_PAIR);
    FORGED(1, "verify", "", "two records are of the same two objects");
}

/* Record one step of a triangle that lies in a floor, front to front, and goes up or
 * down. */
static void record_touch(void **state, const char *path, bool is_up,
                         enum pccd_touching touching)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    static const double x0[6][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0},
                                    {1, 1, 0}, {2, 1, 0}, {1, 2, 0}};
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 5, 4}};
    struct pccd_step_settings step = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct pccd_client *client = NULL;
    double x1[6][3];

    memcpy(x1, x0, sizeof x1);
    for (int i = 3; i < 6; i++) {
        x1[i][2] = is_up ? 1 : -1;
    }
    step.touching = touching;
    assert_ok(test_shared_connect(state, 0, &client));
    (void)unlink(path);
    assert_ok(pccd_record_start(client, path, &settings));
    uint32_t mesh = test_mesh(client, x0, PCCD_FORMAT_F64, 6, triangles, 2);
    uint32_t scene = test_scene(client);
    uint32_t object = test_object(client, scene, mesh);
    assert_ok(pccd_step_x0x1(client, scene, object, x0, x1, PCCD_FORMAT_F64, 6, &step,
                             &answer));
    assert_int_equal(answer.total, is_up && touching == PCCD_TOUCHING_LEFT_OUT ? 0 : 3);
    pccd_answer_release(client, &answer);
    pccd_close(client);
}

/* If this failed, an answer that lets go what enters would be trusted, or one that says
 * so of what leaves. */
CASE(verify__knows_what_becomes_of_what_touches)
{
    char source[128];

    (void)snprintf(source, sizeof source, "%s.touch", test_recording);
    for (int is_up = 0; is_up < 2; is_up++) {
        for (int told = 0; told < 2; told++) {
            record_touch(state, source, is_up != 0,
                         told ? PCCD_TOUCHING_TOLD : PCCD_TOUCHING_LEFT_OUT);
            test_ctl_says(0, "verify", "--sample 1000", source, "PASS: 1 step", NULL);
            if (is_up && !told) {
                continue; /* it has no record */
            }
            forge_of(source, FORGE_FATE);
            FORGED(1, "verify", "", "enter, slide or leave otherwise");
            forge_of(source, FORGE_MISSING);
            FORGED(1, "verify", "--sample 1000", "a contact is missing");
        }
    }
}

/* If this failed, the witness could not be tried by somebody else. */
CASE(verify__names_the_features_and_where_they_are)
{
    forge(FORGE_MISSING);
    FORGED(1, "verify", "--sample 100000", "exact:   first contact in [0x",
           "at t = 0: ", "at t = 1: ");
    FORGED(1, "verify", "--json --sample 100000", "\"witness\": {");
}

/* If this failed, a daemon that answers otherwise than one before would not be
 * noticed. */
CASE(replay__shows_the_first_difference)
{
    forge(FORGE_HASH);
    FORGED(1, "replay", "", "step 1 has another hash", "expected");
    FORGED(1, "replay", "--keep-going --json", "\"differ\": 1", "\"same\": 5");
    FORGED(0, "replay", "--steps 2..", "");
    HONEST(0, "replay", "", "");
}

/* If this failed, a recording that this program would misread would be called wrong, or
 * right, in the place of another format. */
CASE(replay__refuses_a_recording_of_another_version)
{
    FILE *file;

    forge(FORGE_NOTHING);
    file = fopen(test_forged, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, 8, SEEK_SET), 0);
    assert_int_equal(fputc(2, file), 2);
    assert_int_equal(fclose(file), 0);
    for (int i = 0; i < 2; i++) {
        FORGED(4, i == 0 ? "replay" : "verify", "",
               "a recording of version 2 by pccd 0.1.0, and this program reads 3");
    }
}

/* If this failed, a recording could clear the screen of who replays it, or worse. */
CASE(replay__shows_what_a_recording_says_as_text)
{
    char said[4096];

    forge(FORGE_NAMES);
    assert_ok(test_ctl("replay", "", test_forged, said, sizeof said));
    assert_non_null(strstr(said, "libpccd \\x1b[2J\\x9b\\x07"));
    assert_non_null(strstr(said, ", \\x1b\\x1b"));
    assert_null(strchr(said, '\033'));
    assert_null(strchr(said, '\233'));
}

/* If this failed, nothing in mode pairs would be compared. */
CASE(replay__compares_pairs)
{
    forge(FORGE_PAIRS);
    FORGED(1, "replay", "--keep-going --json", "\"differ\": 1", "\"same\": 5");
}

CASES_WITH(set_up, test_recording_stop);
