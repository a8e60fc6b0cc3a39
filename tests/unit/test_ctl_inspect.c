/* test_ctl_inspect.c - recordings as pages, without a browser. */
#include "cases.h"

#include <jansson.h>

#include "inspect.h"

#define VERTICES 3u
#define OBJECT   0x20001u

static const char template[] = "<html><!--pccd:data--><script>1</script></html>";

/* Three vertices that sink, in a scene of one object. */
struct fall {
    double x0[VERTICES][3], x1[VERTICES][3];
    uint32_t triangles[1][3];
    struct registry_mesh mesh;
    struct registry_object object;
    struct registry_scene scene;
    struct pccd_answer answer;
    struct pccd_contact contact;
    struct record_frame frame;
    struct play_step step;
};

static void fall_begin(struct fall *fall, uint64_t number)
{
    *fall = (struct fall){
        .triangles = {{0, 1, 2}},
        .mesh = {.vertex_count = VERTICES,
                 .triangle_count = 1,
                 .triangles = fall->triangles},
        .object = {.handle = OBJECT, .mesh = &fall->mesh, .x0 = fall->x0, .x1 = fall->x1},
        .scene = {.handle = 1, .objects = &fall->object, .object_count = 1},
        .contact = {.kind = PCCD_EE,
                    .flags = PCCD_PROVED,
                    .object_a = OBJECT,
                    .object_b = OBJECT,
                    .feature_a = 1,
                    .feature_b = 2,
                    .toi = 0.25,
                    .param = {0.5f, 1.0f},
                    .normal = {0, -1, 0}},
        .step = {.number = number,
                 .scene = &fall->scene,
                 .frame = &fall->frame,
                 .answer = &fall->answer,
                 .contacts = &fall->contact,
                 .found = {.count = 1}}};
    for (uint32_t v = 0; v < VERTICES; v++) {
        fall->x0[v][0] = fall->x1[v][0] = 1e9 + v;
        fall->x0[v][1] = 1.0 - (double)number;
        fall->x1[v][1] = -(double)number;
    }
}

/* The edges that were found are its own. */
static void fall_end(struct fall *fall)
{
    free(fall->mesh.edges);
    free(fall->mesh.is_free_edge);
    free(fall->mesh.is_free_vertex);
}

/* A file with the steps 1 .. step_count under a name, one in `every` of them drawn; what
 * is in it. */
static char *write_page(const char *name, uint32_t step_count, uint64_t every,
                        uint64_t bytes_max, uint64_t *kept, uint64_t *bytes)
{
    const struct inspect_settings settings = {
        .every = every, .bytes_max = bytes_max, .up = 3};
    struct play_summary summary = {.frames = step_count};
    struct ctl_error error = {.text = ""};
    struct page_file page;
    struct inspect inspect;
    struct fall fall;
    FILE *file = tmpfile();
    int status = PCCD_OK;
    assert_non_null(file);
    assert_ok(inspect_init(&inspect, &settings, &page, &error));
    assert_ok(
        page_file_begin(&page, file, "page", template, sizeof template - 1, &error));
    for (uint32_t i = 1; i <= step_count && status == PCCD_OK; i++) {
        fall_begin(&fall, i);
        status = inspect_step(&inspect, &fall.step, &error);
        fall_end(&fall);
    }
    assert_int_equal(status, inspect.is_full ? PCCD_E_CANCELLED : PCCD_OK);
    assert_ok(inspect_finish(&inspect, name, &summary, &error));
    *kept = inspect.kept;
    *bytes = (uint64_t)ftell(file);
    char *text = test_room((*bytes + 1));
    rewind(file);
    assert_int_equal(fread(text, 1, *bytes, file), *bytes);
    inspect_deinit(&inspect);
    fclose(file);
    return text;
}

static uint32_t count_of(const char *text, const char *word)
{
    uint32_t count = 0;
    for (const char *at = strstr(text, word); at != NULL; at = strstr(at + 1, word)) {
        count++;
    }
    return count;
}

/* The JSON text, as a parser of HTML cuts it out. */
static json_t *meta_of(const char *text)
{
    static const char open[] = "id=\"pccd-meta\">";
    const char *begin = strstr(text, open);
    assert_non_null(begin);
    begin += strlen(open);
    const char *end = strstr(begin, "</script>");
    assert_non_null(end);
    json_t *meta = json_loadb(begin, (size_t)(end - begin), 0, NULL);
    assert_non_null(meta);
    return meta;
}

/* If it failed, who names a file could run a script in the browser of who looks at it. */
CASE(name__cannot_end_its_element)
{
    static const char *const names[] = {"</script><script>alert(1)</script>",
                                        "<!--<script>", "\"};alert(1)//",
                                        "a\\\"</SCRIPT ", "&lt;\xe2\x80\xa8\x01"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        uint64_t kept, bytes;
        char *text = write_page(names[i], 1, 1, 1 << 20, &kept, &bytes);
        json_t *meta = meta_of(text);
        const json_t *recording = json_object_get(meta, "recording");
        assert_string_equal(json_string_value(json_object_get(recording, "name")),
                            names[i]);
        /* One of a step, one of the description, the template's. */
        assert_int_equal(count_of(text, "<script"), 3);
        assert_int_equal(count_of(text, "</"), 4);
        assert_null(strstr(text + strlen("<html>"), "<!--"));
        json_decref(meta);
        free(text);
    }
}

/* If it failed, a name that is no text, as a file may have, would spoil the page. */
CASE(name__may_be_any_bytes)
{
    char name[600];
    uint64_t kept, bytes;
    memset(name, 'n', sizeof name);
    name[0] = '\xff';
    name[sizeof name - 1] = '\0';
    char *text = write_page(name, 1, 1, 1 << 20, &kept, &bytes);
    json_t *meta = meta_of(text);
    const char *got =
        json_string_value(json_object_get(json_object_get(meta, "recording"), "name"));
    assert_memory_equal(got, "\\xffn", 5);
    assert_in_range(strlen(got), 100, 300);
    json_decref(meta);
    free(text);
}

/* If it failed, a file could be larger than was allowed, or smaller than it could be. */
CASE(size__is_kept_and_used)
{
    uint64_t kept, bytes, all;
    free(write_page("whole", 40, 1, 1 << 20, &kept, &all));
    assert_int_equal(kept, 40);
    for (uint64_t most = all / 3; most < all + 5000; most += 777) {
        json_t *meta;
        char *text = write_page("part", 40, 1, most, &kept, &bytes);
        assert_true(bytes <= most);
        assert_true(kept == 40 || bytes + 4096 + 2 * (all / 40) > most);
        meta = meta_of(text);
        assert_int_equal(json_array_size(json_object_get(meta, "steps")), kept);
        assert_int_equal(json_is_true(json_object_get(meta, "is_full")), kept < 40);
        assert_int_equal(count_of(text, "octet-stream"), kept);
        json_decref(meta);
        free(text);
    }
}

/* If it failed, the page would say nothing of a step whose drawing is left out, or what
 * it says of many would make it larger than was allowed. */
CASE(left_out__steps_are_told_of_and_counted)
{
    uint64_t kept, bytes, all;
    free(write_page("some", 90, 40, 1 << 20, &kept, &all));
    assert_int_equal(kept, 3);
    char *text = write_page("some", 90, 40, all - 2000, &kept, &bytes);
    json_t *meta = meta_of(text), *told = json_object_get(meta, "left_out");
    assert_true(bytes <= all - 2000);
    assert_int_equal(kept, 2);
    assert_in_range(json_array_size(told), 40, 86);
    const json_t *step = json_array_get(told, 0);
    assert_int_equal(json_integer_value(json_object_get(step, "number")), 2);
    assert_string_equal(json_string_value(json_object_get(step, "first_pair")),
                        "edge 0-2 meets edge 1-2");
    json_decref(meta);
    free(text);
}

/* If it failed, --max-size would promise what the file does not keep. */
CASE(bytes__are_counted_as_they_are_written)
{
    static const char *const texts[] = {"", "<>&", "\x01\xc3\xa4", "plain"};
    struct ctl_error error;
    struct page_file page;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        FILE *file = tmpfile();
        json_t *meta = json_pack("{s:s}", "text", texts[i]);
        assert_non_null(file);
        assert_ok(
            page_file_begin(&page, file, "page", template, sizeof template - 1, &error));
        for (size_t count = 0; count < 9; count++) {
            assert_ok(page_file_blob(&page, "12345678", count, &error));
        }
        assert_ok(page_file_finish(&page, meta, &error));
        assert_int_equal(ftell(file), page.bytes + page_file_json_bytes(meta));
        json_decref(meta);
        fclose(file);
    }
    assert_int_equal(page_file_begin(&page, stderr, "page", "<html>", 6, &error),
                     PCCD_E_FORMAT);
}

/* If it failed, objects that a batch has in each scene could not be followed through it,
 * or two of one name would be taken for one. */
CASE(object__has_one_number_by_its_name_in_all_scenes)
{
    static char bolt[] = "bolt", nut[] = "nut";
    static char *const names[4][2] = {
        {bolt, bolt}, {bolt, bolt}, {NULL, NULL}, {nut, bolt}};
    static const char *const pairs[] = {"[0,1,1]", "[0,1,1]", "[4,5,1]", "[0,6,1]"};
    const struct inspect_settings settings = {.every = 1, .bytes_max = 1 << 20};
    struct ctl_error error = {.text = ""};
    struct page_file page;
    struct inspect inspect;
    FILE *file = tmpfile();
    assert_non_null(file);
    inspect_init(&inspect, &settings, &page, &error);
    page_file_begin(&page, file, "page", template, sizeof template - 1, &error);
    for (uint32_t i = 0; i < 4; i++) {
        struct fall fall;
        fall_begin(&fall, i + 1);
        struct registry_object objects[2] = {fall.object, fall.object};
        for (uint32_t k = 0; k < 2; k++) {
            objects[k].handle = OBJECT + k;
            objects[k].name = names[i][k];
        }
        fall.scene = (struct registry_scene){
            .handle = i + 1, .objects = objects, .object_count = 2};
        fall.contact.object_b = OBJECT + 1;
        assert_ok(inspect_step(&inspect, &fall.step, &error));
        const json_t *step = json_array_get(inspect.steps, i);
        char *text = json_dumps(json_object_get(step, "pairs"), JSON_COMPACT);
        assert_string_equal(text, pairs[i]);
        free(text);
        fall_end(&fall);
    }
    inspect_deinit(&inspect);
    fclose(file);
}

/* If it failed, positions far from zero would jump, or contacts be others. */
CASE(step__is_packed_as_the_page_reads_it)
{
    const struct inspect_settings settings = {.every = 1, .bytes_max = 1 << 20};
    struct ctl_error error = {.text = ""};
    struct page_file page;
    struct inspect inspect;
    struct fall fall;
    struct columns { /* of one contact */
        double toi;
        float param[2];
        uint32_t feature_a, feature_b;
        uint16_t object_a, object_b;
        int16_t normal[3];
        uint8_t flags;
    } contact;
    float x[3];
    FILE *file = tmpfile();
    assert_non_null(file);
    inspect_init(&inspect, &settings, &page, &error);
    page_file_begin(&page, file, "page", template, sizeof template - 1, &error);
    fall_begin(&fall, 1);
    fall.contact.toi = 0.1;
    fall.contact.param[0] = 0.3f;
    assert_ok(inspect_step(&inspect, &fall.step, &error));
    assert_int_equal(inspect.origin[0], 1e9 + 1);
    const json_t *step = json_array_get(inspect.steps, 0);
    const json_t *object = json_array_get(json_object_get(step, "objects"), 0);
    json_int_t at1 = json_integer_value(json_array_get(json_object_get(object, "x1"), 1));
    memcpy(x, inspect.data.at + at1 + 2 * sizeof x, sizeof x);
    assert_true(x[0] == 1.0f && x[1] == -1.0f && x[2] == 0.0f);
    json_int_t at = json_integer_value(
        json_array_get(json_object_get(json_object_get(step, "contacts"), "at"), 1));
    assert_int_equal(at % BYTES_ALIGN, 0);
    memcpy(&contact, inspect.data.at + at, offsetof(struct columns, flags) + 1);
    assert_int_equal(contact.feature_a, 1);
    assert_int_equal(contact.feature_b, 2);
    assert_true(contact.toi == 0.1);
    assert_true(contact.param[0] == 0.3f && contact.param[1] == 1.0f);
    assert_int_equal(contact.normal[1], -32767);
    assert_int_equal(contact.flags, PCCD_EE << INSPECT_KIND_SHIFT | PCCD_PROVED);
    fall_end(&fall);
    inspect_deinit(&inspect);
    fclose(file);
}
