/* test_int_verify_fields.c - each number of each kind of answer, changed, and whether
 * pccdctl verify finds that. */
#include "cases.h"

#include "fixture.h"
#include "forge.h"
#include "grid.h"
#include "must.h"
#include "record_hash.h"
#include "recording.h"
#include "run_ctl.h"

/* ---- the tables -------------------------------------------------------------------- */

/* Fate of a field that is changed. */
enum fate {
    JUDGED, /* FAIL */
    TOLD,   /* FAIL, or the step is named as not checked, or the file as damaged */
    UNUSED  /* it says nothing */
};

struct field {
    const char *name;
    size_t at, bytes, each; /* each: of an element */
    enum fate fate;
    bool is_real;
};

#define FIELD(type, member, each_, fate_, real)                                          \
    {                                                                                    \
#member, offsetof(struct type, member), sizeof(((struct type *)0)->member),      \
            each_, fate_, real                                                           \
    }

static const struct field answer_fields[] = {
    FIELD(record_answer, step, 8, TOLD, false),
    FIELD(record_answer, status, 4, TOLD, false),
    FIELD(record_answer, is_near, 4, TOLD, false),
    FIELD(record_answer, mode, 4, JUDGED, false),
    FIELD(record_answer, what, 4, TOLD, false),
    FIELD(record_answer, incomplete, 4, TOLD, false),
    FIELD(record_answer, verdict, 4, JUDGED, false),
    FIELD(record_answer, total, 8, JUDGED, false),
    FIELD(record_answer, counts, 8, JUDGED, false),
    FIELD(record_answer, possible, 8, JUDGED, false),
    FIELD(record_answer, initial, 8, JUDGED, false),
    FIELD(record_answer, toi_first, 8, JUDGED, true),
    FIELD(record_answer, distance_min, 8, JUDGED, true),
    FIELD(record_answer, distance_max, 8, JUDGED, true),
    FIELD(record_answer, crossings, 8, JUDGED, false),
    FIELD(record_answer, hash, 8, JUDGED, false)};

static const struct field contact_fields[] = {
    FIELD(pccd_contact, kind, 4, JUDGED, false),
    FIELD(pccd_contact, flags, 4, TOLD, false), /* a thick one may be possible */
    FIELD(pccd_contact, object_a, 4, JUDGED, false),
    FIELD(pccd_contact, feature_a, 4, JUDGED, false),
    FIELD(pccd_contact, object_b, 4, JUDGED, false),
    FIELD(pccd_contact, feature_b, 4, JUDGED, false),
    FIELD(pccd_contact, toi, 8, JUDGED, true),
    FIELD(pccd_contact, toi_hi, 8, JUDGED, true),
    FIELD(pccd_contact, param, 4, JUDGED, true),
    FIELD(pccd_contact, normal, 4, JUDGED, true),
    FIELD(pccd_contact, reserved, 4, JUDGED, false)};

static const struct field pair_fields[] = {FIELD(pccd_pair, kind, 4, JUDGED, false),
                                           FIELD(pccd_pair, object_a, 4, JUDGED, false),
                                           FIELD(pccd_pair, feature_a, 4, JUDGED, false),
                                           FIELD(pccd_pair, object_b, 4, JUDGED, false),
                                           FIELD(pccd_pair, feature_b, 4, JUDGED, false)};

static const struct field near_fields[] = {FIELD(pccd_near, kind, 4, JUDGED, false),
                                           FIELD(pccd_near, flags, 4, JUDGED, false),
                                           FIELD(pccd_near, object_a, 4, JUDGED, false),
                                           FIELD(pccd_near, feature_a, 4, JUDGED, false),
                                           FIELD(pccd_near, object_b, 4, JUDGED, false),
                                           FIELD(pccd_near, feature_b, 4, JUDGED, false),
                                           FIELD(pccd_near, d_lo, 8, JUDGED, true),
                                           FIELD(pccd_near, d_hi, 8, JUDGED, true),
                                           FIELD(pccd_near, param, 4, JUDGED, true),
                                           FIELD(pccd_near, direction, 4, JUDGED, true),
                                           FIELD(pccd_near, count, 4, JUDGED, false)};

static const struct field bound_fields[] = {{"bound", 0, 8, 8, JUDGED, true}};

static const struct field head_fields[] = {
    FIELD(record_records, step, 8, TOLD, false),
    FIELD(record_records, first, 8, TOLD, false),
    FIELD(record_records, count, 8, TOLD, false),
    FIELD(record_records, record_bytes, 4, TOLD, false),
    FIELD(record_records, reserved, 4, UNUSED, false)};

struct table {
    const struct field *fields;
    size_t count, bytes;
};
#define TABLE(fields, bytes)                                                             \
    {                                                                                    \
        fields, sizeof(fields) / sizeof(fields)[0], bytes                                \
    }
static const struct table answers = TABLE(answer_fields, sizeof(struct record_answer));
static const struct table contacts = TABLE(contact_fields, sizeof(struct pccd_contact));
static const struct table pairs = TABLE(pair_fields, sizeof(struct pccd_pair));
static const struct table nears = TABLE(near_fields, sizeof(struct pccd_near));
static const struct table bounds = TABLE(bound_fields, sizeof(double));
static const struct table heads = TABLE(head_fields, sizeof(struct record_records));

/* If this failed, a field that is new in an answer would be neither judged nor said not
 * to be. */
CASE(tables__have_every_byte)
{
    const struct table *const all[] = {&answers, &contacts, &pairs,
                                       &nears,   &bounds,   &heads};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        size_t end = 0;
        for (size_t k = 0; k < all[i]->count; k++) {
            const struct field *field = &all[i]->fields[k];
            assert_int_equal(field->at, end);
            assert_int_equal(field->bytes % field->each, 0);
            end = field->at + field->bytes;
        }
        assert_int_equal(end, all[i]->bytes);
    }
}

/* ---- recordings -------------------------------------------------------------------- */

/* A floor, and a needle above it that goes down through it. */
static const double floor_x[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
static const double above[3][3] = {{.75, .5, 1}, {.75, .5, 3}, {1.25, .75, 3}};
static const double below[3][3] = {{.75, .5, -1}, {.75, .5, 1}, {1.25, .75, 1}};
static const double lower[3][3] = {{.75, .5, .5}, {.75, .5, 2.5}, {1.25, .75, 2.5}};
static const uint32_t face[1][3] = {{0, 1, 2}};
/* Two tetrahedra, a corner of each in the other. */
static const double closed_x[2][4][3] = {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
                                         {{.5, .5, .5}, {5, 1, 1}, {1, 5, 1}, {1, 1, 5}}};
static const uint32_t closed_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

struct stage {
    struct pccd_client *client;
    uint32_t scene, floor, needle;
};

static void begin(void **state, struct stage *stage)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    uint32_t mesh[2];
    test_recording_clear();
    assert_ok(test_shared_connect(state, 0, &stage->client));
    assert_ok(pccd_record_start(stage->client, test_recording, &settings));
    stage->scene = test_scene(stage->client);
    mesh[0] = test_mesh(stage->client, floor_x, PCCD_FORMAT_F64, 3, face, 1);
    mesh[1] = test_mesh(stage->client, above, PCCD_FORMAT_F64, 3, face, 1);
    stage->floor = test_object(stage->client, stage->scene, mesh[0]);
    stage->needle = test_object(stage->client, stage->scene, mesh[1]);
}

/* From above to x; *total records. */
static void step(struct stage *stage, const struct pccd_step_settings *settings,
                 const double (*x)[3], bool is_empty)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    assert_ok(pccd_step_x0x1(stage->client, stage->scene, stage->needle, above, x,
                             PCCD_FORMAT_F64, 3, settings, &answer));
    assert_true(is_empty == (answer.total == 0));
    pccd_answer_release(stage->client, &answer);
}

static void end(struct stage *stage)
{
    assert_ok(pccd_record_stop(stage->client, NULL));
    pccd_close(stage->client);
}

/* ---- changing ---------------------------------------------------------------------- */

#define RECORDS_BYTES_MAX 262144u

/* A change of the first answer, or of its first page, of a recording. */
struct change {
    uint16_t kind;    /* of the chunk */
    uint32_t number;  /* which of them, from 1 */
    size_t at, bytes; /* of its payload */
    uint8_t value[8]; /* what is there then */
    bool is_dropped;  /* the chunk is not there at all */
    bool mends_sums;  /* of the answer, to fit the records */
    uint32_t seen;
    struct record_answer answer;
    uint32_t answers; /* seen */
};

static bool apply(void *context, struct forge_chunk *chunk)
{
    struct change *change = context;
    bool is_answer = chunk->kind == RECORD_ANSWER;
    change->answers += is_answer;
    if (change->mends_sums && is_answer && change->answers == 1) {
        memcpy(chunk->payload, &change->answer, sizeof change->answer);
    }
    change->seen += chunk->kind == change->kind;
    if (chunk->kind != change->kind || change->seen != change->number) {
        return true;
    }
    assert_true(change->at + change->bytes <= chunk->bytes);
    memcpy(chunk->payload + change->at, change->value, change->bytes);
    return !change->is_dropped;
}

/* The first answer of a file, and its first page. */
struct first {
    bool has_answer, has_records;
    struct record_answer answer;
    uint8_t head_and_records[RECORDS_BYTES_MAX];
    uint64_t bytes; /* of these */
};

static bool note_first(void *context, struct forge_chunk *chunk)
{
    struct first *first = context;
    if (chunk->kind == RECORD_ANSWER && !first->has_answer) {
        first->has_answer = true;
        memcpy(&first->answer, chunk->payload, sizeof first->answer);
    }
    if (chunk->kind == RECORD_RECORDS && !first->has_records) {
        assert_true(chunk->bytes <= sizeof first->head_and_records);
        first->has_records = true;
        first->bytes = chunk->bytes;
        memcpy(first->head_and_records, chunk->payload, chunk->bytes);
    }
    return true;
}

/* Sums and hash that fit the records, where these are of steps or of pairs. */
static void mend(const struct first *first, struct change *change)
{
    struct record_records head;
    const uint8_t *records = first->head_and_records + sizeof head;
    memcpy(&head, first->head_and_records, sizeof head);
    change->mends_sums = true;
    change->answer = first->answer;
    struct record_answer *answer = &change->answer;
    bool has_hash = answer->hash[0] != 0 || answer->hash[1] != 0;
    if (head.record_bytes == sizeof(double)) {
        return; /* bounds: nothing is counted or hashed of them alone */
    }
    memset(answer->counts, 0, sizeof answer->counts);
    answer->possible = answer->initial = 0;
    answer->toi_first = answer->is_near != 0 ? 0 : 2;
    answer->distance_min = answer->is_near != 0 ? 2e18 : 0;
    answer->distance_max = 0;
    for (uint64_t i = 0; i < head.count; i++) {
        uint32_t kind;
        memcpy(&kind, records + i * head.record_bytes, sizeof kind);
        answer->counts[kind % PCCD_KINDS_MAX]++;
        if (answer->is_near != 0) {
            struct pccd_near one;
            memcpy(&one, records + i * sizeof one, sizeof one);
            answer->distance_min = fmin(answer->distance_min, one.d_lo);
            answer->distance_max = fmax(answer->distance_max, one.d_hi);
        } else if (head.record_bytes == sizeof(struct pccd_contact)) {
            struct pccd_contact one;
            memcpy(&one, records + i * sizeof one, sizeof one);
            answer->possible += (one.flags & PCCD_PROVED) == 0;
            answer->initial += (one.flags & PCCD_INITIAL) != 0;
            answer->toi_first = fmin(answer->toi_first, one.toi);
        }
    }
    if (has_hash) {
        record_hash_2(records, head.count, head.record_bytes, answer->hash);
    }
}

/* ---- judging ----------------------------------------------------------------------- */

static uint32_t missed;    /* changes that were not found */
static const char *played; /* what is recorded */

/* Files whose records are too many to be looked at again and again: some of them. */
static const char *options = "";

static void judge(const char *of, const struct field *field, size_t element,
                  struct change *change)
{
    char said[8192], line[64];
    forge_recording(test_recording, test_forged, apply, change);
    assert_true(change->seen >= change->number);
    (void)snprintf(line, sizeof line, "--sample 50 %s", options);
    int status = test_ctl("verify", line, test_forged, said, sizeof said);
    bool is_told = status == 1 || status == 4 ||
                   strstr(said, "not checked: step 1: ") != NULL ||
                   strstr(said, "not checked: question 1: ") != NULL;
    /* 4: the file is refused, as pages of records do not fit it. */
    bool is_right = field->fate == UNUSED ? status == 0
                    : field->fate == TOLD ? is_told
                                          : status == 1 || status == 4;
    if (!is_right || (status == 1 && strstr(said, "FAIL: ") == NULL)) {
        print_message("%s, %s: %s[%zu]: %d, %s\n", played, of, field->name, element,
                      status, said);
        missed++;
    }
}

/* Values that a field may have in its place: of words the others of an enum, or one bit
 * more; of numbers a little more, or much. */
static uint32_t other_values(const struct field *field, const uint8_t *is,
                             uint8_t values[8][8])
{
    uint32_t count = 0, word;
    uint64_t whole;
    double real;
    float narrow;
    memcpy(&word, is, sizeof word);
    if (field->is_real && field->each == 8) {
        const double more[2] = {1e-4, .25};
        memcpy(&real, is, sizeof real);
        for (int i = 0; i < 2; i++, count++) {
            double other = real + more[i];
            memcpy(values[count], &other, sizeof other);
        }
    } else if (field->is_real) {
        memcpy(&narrow, is, sizeof narrow);
        narrow += .25f;
        memcpy(values[count++], &narrow, sizeof narrow);
    } else if (field->each == 8) {
        memcpy(&whole, is, sizeof whole);
        const uint64_t others[2] = {whole + 1, whole ^ 0x100000000u};
        memcpy(values[count++], &others[0], 8);
        memcpy(values[count++], &others[1], 8);
    } else if (strcmp(field->name, "status") == 0) {
        const int32_t others[2] = {PCCD_E_NOMEM, PCCD_E_NOTFINITE};
        memcpy(values[count++], &others[0], 4);
        memcpy(values[count++], &others[1], 4);
    } else {
        for (uint32_t other = 0; other < 5; other++) {
            if (other != word) {
                memcpy(values[count++], &other, sizeof other);
            }
        }
    }
    return count;
}

/* Each field of a table, of one chunk at `at` of its payload, which is `is`. */
static void change_each(const char *of, const struct table *table, uint16_t kind,
                        size_t at, const uint8_t *is, const struct first *first)
{
    for (size_t i = 0; i < table->count; i++) {
        const struct field *field = &table->fields[i];
        for (size_t e = 0; e < field->bytes / field->each; e++) {
            uint8_t values[8][8];
            size_t place = field->at + e * field->each;
            if (field->each == 8 && e > 1 && e + 1 < field->bytes / field->each) {
                continue; /* the first two and the last are enough */
            }
            uint32_t count = other_values(field, is + place, values);
            for (uint32_t v = 0; v < count; v++) {
                struct change change = {
                    .kind = kind, .number = 1, .at = at + place, .bytes = field->each};
                if (field->fate == UNUSED && v > 0) {
                    continue; /* one is enough */
                }
                memcpy(change.value, values[v], sizeof change.value);
                if (first != NULL) {
                    struct first *copy = test_room(sizeof *copy);
                    *copy = *first;
                    memcpy(copy->head_and_records + at + place, values[v], field->each);
                    mend(copy, &change);
                    free(copy);
                }
                judge(of, field, e, &change);
            }
        }
    }
}

/* Everything of the first answer of the recording. */
static void change_all(const char *name)
{
    struct first *first = test_room(sizeof *first);
    struct record_records head;
    char said[4096];
    played = name;
    assert_ok(test_ctl("verify", options, test_recording, said, sizeof said));
    assert_non_null(strstr(said, "PASS"));
    assert_null(strstr(said, "not checked"));
    test_ctl_says(0, "verify --repeat", options, test_recording, NULL);
    forge_recording(test_recording, test_forged, note_first, first);
    change_each("answer", &answers, RECORD_ANSWER, 0, (const uint8_t *)&first->answer,
                NULL);
    if (first->has_records) {
        memcpy(&head, first->head_and_records, sizeof head);
        change_each("head", &heads, RECORD_RECORDS, 0, first->head_and_records, NULL);
        change_each("record",
                    head.record_bytes == sizeof(struct pccd_near)
                        ? (first->answer.is_near != 0 ? &nears : &contacts)
                    : head.record_bytes == sizeof(double) ? &bounds
                                                          : &pairs,
                    RECORD_RECORDS, sizeof head, first->head_and_records + sizeof head,
                    first);
    }
    free(first);
}

/* If this failed, a wrong number in the answer to a step would be called right. */
CASE(steps__have_no_number_that_is_not_judged)
{
    static const char *const names[] = {"all", "first", "any", "pairs", "none", "thick"};
    for (uint32_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const struct pccd_step_settings settings = {.struct_bytes = sizeof settings,
                                                    .mode = i < 4    ? (enum pccd_mode)i
                                                            : i == 4 ? PCCD_MODE_ANY
                                                                     : PCCD_MODE_ALL,
                                                    .separation = i == 5 ? .25 : 0};
        struct stage stage;
        bool is_empty = settings.mode == PCCD_MODE_ANY;
        begin(state, &stage);
        step(&stage, &settings, i == 4 ? lower : below, is_empty);
        step(&stage, &settings, i == 4 ? lower : below, is_empty);
        end(&stage);
        change_all(names[i]);
    }
    assert_int_equal(missed, 0);
}

/* If this failed, a wrong number in the answer to a scene of a batch would be called
 * right. */
CASE(batches__have_no_number_that_is_not_judged)
{
    struct pccd_batch_part part = {.count = 3, .format = PCCD_FORMAT_F64};
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    struct pccd_batch *batch = NULL;
    struct stage stage;
    const void *x0[1] = {above}, *x1[1] = {below};
    begin(state, &stage);
    part.scene = stage.scene;
    part.object = stage.needle;
    part.way = PCCD_BATCH_X0X1;
    assert_ok(pccd_batch_create(stage.client, &part, 1, &batch));
    for (int i = 0; i < 2; i++) {
        assert_ok(pccd_batch_step(batch, x0, x1, NULL, &answer));
        assert_true(answer.total > 0);
        pccd_batch_release(stage.client, &answer);
    }
    pccd_batch_destroy(batch);
    end(&stage);
    change_all("batch");
    assert_int_equal(missed, 0);
}

/* If this failed, records could be taken away from an answer of several pages, or its
 * numbers changed, and what is left be called right. */
CASE(pages__have_no_number_that_is_not_judged)
{
    const struct pccd_record_settings settings = {.contacts = 1};
    const struct field page = {"page", 0, 0, 1, TOLD, false};
    struct pccd_client *client = NULL;
    struct test_grid grid;
    uint32_t pages = 0;
    test_recording_clear();
    assert_ok(test_shared_connect(state, 65536, &client));
    assert_ok(pccd_record_start(client, test_recording, &settings));
    assert_ok(test_grid_make(client, 40, &grid));
    for (int i = 0; i < 2; i++) {
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        uint64_t number = 0;
        assert_ok(test_grid_submit(&grid, NULL, &number));
        assert_ok(pccd_wait(client, number, -1, &answer));
        for (pages = 1; answer.cursor < answer.total; pages++) {
            uint64_t cursor = answer.cursor;
            pccd_answer_release(client, &answer);
            assert_ok(pccd_fetch(client, grid.scene, number, cursor, &answer));
        }
        pccd_answer_release(client, &answer);
    }
    assert_true(pages >= 2);
    test_grid_close(&grid);
    options = "--contacts 20";
    played = "pages";
    struct first *first = test_room(sizeof *first);
    test_ctl_says(0, "verify --repeat", options, test_recording, NULL);
    forge_recording(test_recording, test_forged, note_first, first);
    change_each("answer", &answers, RECORD_ANSWER, 0, (const uint8_t *)&first->answer,
                NULL);
    change_each("head", &heads, RECORD_RECORDS, 0, first->head_and_records, NULL);
    for (uint32_t i = 1; i <= pages; i++) {
        struct change change = {.kind = RECORD_RECORDS, .number = i, .is_dropped = true};
        judge("page", &page, i, &change);
    }
    options = "";
    free(first);
    assert_int_equal(missed, 0);
}

static void ask(struct pccd_client *client, uint32_t scene, enum pccd_near_what what,
                double gap)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings.what = what;
    settings.distance = what == PCCD_NEAR_CROSSINGS ? 0 : 1.5;
    settings.gap = gap;
    assert_ok(pccd_ask_near(client, scene, NULL, 0, &settings, &answer));
    assert_true(answer.total > 0);
    pccd_answer_release(client, &answer);
}

/* Changes every number of the answers to each question. Floor and needle, 1 apart, have
 * that radius. */
static void change_questions(void **state, double radius)
{
    static const char *const names[] = {"n_pairs", "n_features", "n_vertices", "nearest",
                                        "n_cross", "n_depth",    "n_gap"};
    const struct pccd_object_settings thick = {
        .struct_bytes = sizeof thick, .what = PCCD_OBJECT_RADIUS, .radius = radius};
    for (uint32_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        struct stage stage;
        uint32_t scene, mesh;
        enum pccd_near_what what = i == 6 ? PCCD_NEAR_NEAREST : (enum pccd_near_what)i;
        begin(state, &stage);
        assert_ok(pccd_object_set(stage.client, stage.scene, stage.floor, &thick));
        assert_ok(pccd_object_set(stage.client, stage.scene, stage.needle, &thick));
        scene = stage.scene;
        if (what == PCCD_NEAR_CROSSINGS || what == PCCD_NEAR_DEPTH) {
            scene = test_scene(stage.client);
            for (int k = 0; k < 2; k++) {
                mesh = test_mesh(stage.client, closed_x[k], PCCD_FORMAT_F64, 4,
                                 closed_faces, 4);
                (void)test_object(stage.client, scene, mesh);
            }
        }
        for (int k = 0; k < 2; k++) {
            ask(stage.client, scene, what, i == 6 ? .125 : 0);
        }
        end(&stage);
        change_all(names[i]);
    }
    assert_int_equal(missed, 0);
}

/* If this failed, a wrong number in an answer about what is near would be called
 * right. */
CASE(questions__have_no_number_that_is_not_judged)
{
    change_questions(state, 0);
}

/* If this failed, the same where objects are thick. */
CASE(thick_questions__have_no_number_that_is_not_judged)
{
    change_questions(state, .125);
}

CASES_WITH(test_recording_start, test_recording_stop);
