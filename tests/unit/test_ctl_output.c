/* test_ctl_output.c - what pccdctl writes: figures, CSV, JSON and pictures. */
#include "cases.h"

#include <unistd.h>

#include <jansson.h>
#include <png.h>

#include "check_run.h"
#include "columns.h"
#include "output.h"
#include "picture.h"
#include "report.h"
#include "statistics.h"

/* If it failed: figures of repeated steps would be means, or off by a rank. */
CASE(statistics__give_medians_and_nearest_ranks)
{
    double odd[] = {5, 1, 3};
    double even[] = {4, 1, 3, 100};
    double many[200];
    statistics_sort(odd, 3);
    assert_true(statistics_median(odd, 3) == 3.0);
    statistics_sort(even, 4);
    assert_true(statistics_median(even, 4) == 3.5);
    for (int i = 0; i < 200; i++) {
        many[i] = 200 - i;
    }
    statistics_sort(many, 200);
    assert_true(statistics_quantile(many, 200, 0.99) == 198.0);
    assert_true(statistics_quantile(many, 200, 1.0) == 200.0);
    assert_true(statistics_quantile(many, 200, 0.0) == 1.0);
    assert_true(statistics_quantile(many, 1, 0.99) == 1.0);
}

static const uint32_t triangles[2][3] = {{7, 5, 6}, {0, 2, 1}};
static const struct pccd_edge edges[3] = {{0, 1}, {0, 2}, {5, 6}};
static const struct ctl_mesh shape = {
    .triangles = {.vertices = (uint32_t *)(uintptr_t)triangles, .count = 2}};
static struct objects_of object_of = {.mesh = &shape, .edges = edges};
static const struct objects objects = {.of = &object_of, .count = 1};
static const struct pccd_contact contacts[2] = {
    {.kind = PCCD_VF,
     .flags = PCCD_PROVED,
     .feature_a = 3,
     .feature_b = 1,
     .toi = 0.1,
     .toi_hi = 0.25},
    {.kind = PCCD_EE, .feature_a = 1, .feature_b = 2, .toi = 0.0, .toi_hi = 1.0},
};

/* The text of a file, NUL-terminated. */
static void read_back(FILE *file, char *text, size_t bytes)
{
    rewind(file);
    size_t count = fread(text, 1, bytes - 1, file);
    text[count] = '\0';
}

/* If it failed: feature numbers would be taken for vertex numbers, or times lose digits.
 */
CASE(csv__names_vertices_in_file_order)
{
    const struct pccd_answer page = {.contacts = contacts, .count = 2};
    struct contacts_csv csv = {.objects = &objects};
    char text[512];
    csv.whole.to = tmpfile();
    assert_non_null(csv.whole.to);
    contacts_csv_page(&csv, 1, &page);
    read_back(csv.whole.to, text, sizeof text);
    assert_string_equal(text, "vf,3,0,2,1,0.10000000000000001,0.25,1\n"
                              "ee,0,2,5,6,0,1,0\n");
    fclose(csv.whole.to);
}

/* If it failed: pairs would come with times nobody computed, or steps run together. */
CASE(csv__leaves_times_of_pairs_empty_and_numbers_steps)
{
    const struct pccd_pair pairs[1] = {{.kind = PCCD_EE, .feature_a = 0, .feature_b = 2}};
    const struct pccd_answer page = {.pairs = pairs, .count = 1};
    struct contacts_csv csv = {.objects = &objects, .has_step = true};
    char text[512];
    csv.whole.to = tmpfile();
    assert_non_null(csv.whole.to);
    contacts_csv_page(&csv, 12, &page);
    read_back(csv.whole.to, text, sizeof text);
    assert_string_equal(text, "12,ee,0,1,5,6,,,0\n");
    fclose(csv.whole.to);
}

/* If it failed: a full disk would look like a complete file. */
CASE(csv__tells_when_the_disk_is_full)
{
    struct contacts_csv csv = {.path = "/dev/full", .objects = &objects};
    struct ctl_error error = {.text = ""};
    assert_ok(contacts_csv_open(&csv, &error));
    assert_int_equal(output_close(&csv.whole, csv.path, true, &error), PCCD_E_SYSTEM);
    assert_non_null(strstr(error.text, "/dev/full: cannot write"));
}

struct sample {
    uint64_t wide;
    uint32_t narrow;
    bool is_so;
    double exact, real;
    char text[8];
};
#define OF(member) COLUMN_OF(struct sample, member)
static const struct column sample_columns[] = {
    {"wide", "WIDE", COLUMN_NUMBER, OF(wide), .rank = 1},
    {"narrow", "NARROW", COLUMN_HANDLE, OF(narrow), .rank = 3},
    {"flag", .type = COLUMN_FLAG, OF(is_so)},
    {"bit", .type = COLUMN_NUMBER, OF(is_so)},
    {"exact", "EXACT", COLUMN_EXACT, OF(exact), .rank = 4},
    {"real", .type = COLUMN_REAL, OF(real)},
    {"text", "TEXT", COLUMN_CHARS, OF(text), .is_left = true, .rank = 2},
    {0}};
#undef OF
static const struct sample sample = {UINT64_MAX, 77, true, INFINITY, 0.1, "a\\b\"c"};

/* If it failed: a run of pccd-mpi would go on with other results than it wrote. */
CASE(columns__come_back_from_json_as_they_were)
{
    struct sample read;
    memset(&read, 0, sizeof read);
    json_t *object = columns_json(sample_columns, &sample);
    assert_non_null(object);
    assert_true(columns_read(object, sample_columns, &read));
    assert_true(read.wide == sample.wide && read.narrow == 77 && read.is_so);
    assert_true(isinf(read.exact) && read.real == 0.1);
    assert_string_equal(read.text, sample.text);
    assert_int_equal(json_object_set_new(object, "narrow", json_integer(1ll << 32)), 0);
    assert_false(columns_read(object, sample_columns, &read)); /* it does not fit */
    assert_int_equal(json_object_del(object, "narrow"), 0);
    assert_false(columns_read(object, sample_columns, &read));
    json_decref(object);
}

/* If it failed: a narrow terminal would wrap a table, or lose what matters most. */
CASE(columns__that_matter_less_give_way)
{
    struct column columns[sizeof sample_columns / sizeof sample_columns[0]];
    memcpy(columns, sample_columns, sizeof columns);
    columns_fit(columns, &sample, sizeof sample, 1, 32);
    assert_false(columns[0].is_hidden); /* 20 columns, and 5 of the text: 26 */
    assert_true(columns[1].is_hidden);  /* 7 more are too much */
    assert_true(columns[4].is_hidden);  /* and what matters less goes, too */
    assert_false(columns[6].is_hidden);
    assert_int_equal(columns[0].width, 20);
    memcpy(columns, sample_columns, sizeof columns);
    columns_fit(columns, &sample, sizeof sample, 1, 3);
    assert_false(columns[0].is_hidden); /* one is shown always */
    assert_true(columns[6].is_hidden);
}

static struct report_object told = {
    .info = {.vertex_count = 4, .edge_count = 5, .triangle_count = 2}};
static const struct report_scene scene = {
    .objects = &told, .object_count = 1, .build_ms = 0.5};

static struct report_step made_step(uint64_t total, double toi)
{
    struct report_step step = {.from = "a.ply",
                               .to = "b.ply",
                               .answer = {.total = total,
                                          .counts[PCCD_VF] = 1,
                                          .counts[PCCD_EE] = total - 1,
                                          .possible = 1,
                                          .toi_first = toi,
                                          .hash = {0x123, 0xabc},
                                          .counters = {.box_tests = 77}},
                               .is_complete = true,
                               .ms = {[REPORT_tests] = 1.5, [REPORT_step] = 4.0}};
    return step;
}

static json_t *json_of(const struct report_step *steps, uint32_t count)
{
    char text[8192];
    json_error_t error;
    FILE *file = tmpfile();
    assert_non_null(file);
    json_t *verdict = count > 1 ? json_string("free") : NULL;
    assert_true(report_json(file, &scene, steps, count, verdict));
    read_back(file, text, sizeof text);
    fclose(file);
    json_t *object = json_loads(text, 0, &error);
    assert_non_null(object);
    return object;
}

static json_int_t count_of(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

/* If it failed: programs that read the report would miss a value they were promised. */
CASE(json__holds_the_promised_keys)
{
    static const char *const phases[] = {"build", "ingest", "refit", "traversal",
                                         "tests", "merge",  "step"};
    struct report_step step = made_step(3, 0.125);
    json_t *object = json_of(&step, 1);
    const json_t *ms = json_object_get(object, "ms");
    assert_int_equal(count_of(object, "vertices"), 4);
    assert_int_equal(count_of(object, "edges"), 5);
    assert_int_equal(count_of(object, "triangles"), 2);
    assert_int_equal(count_of(object, "contacts"), 3);
    assert_int_equal(count_of(object, "vf"), 1);
    assert_int_equal(count_of(object, "ee"), 2);
    assert_int_equal(count_of(object, "possible"), 1);
    assert_true(json_real_value(json_object_get(object, "toi_first")) == 0.125);
    assert_true(json_is_true(json_object_get(object, "complete")));
    assert_string_equal(json_string_value(json_object_get(object, "hash")),
                        "2:00000000000001230000000000000abc");
    for (size_t i = 0; i < sizeof phases / sizeof phases[0]; i++) {
        assert_true(json_is_real(json_object_get(ms, phases[i])));
    }
    assert_true(json_real_value(json_object_get(ms, "build")) == 0.5);
    assert_true(json_real_value(json_object_get(ms, "tests")) == 1.5);
    assert_true(json_real_value(json_object_get(ms, "step")) == 4.0);
    assert_int_equal(count_of(json_object_get(object, "counters"), "box_tests"), 77);
    json_decref(object);
}

/* If it failed: a sequence's sums or steps would be lost, or "never" look like a time. */
CASE(json__sums_a_sequence)
{
    struct report_step steps[2] = {made_step(3, 0.125), made_step(2, 2.0)};
    steps[1].is_complete = false;
    json_t *object = json_of(steps, 2);
    const json_t *array = json_object_get(object, "steps");
    assert_int_equal(count_of(object, "contacts"), 5);
    assert_int_equal(count_of(object, "ee"), 3);
    assert_true(json_is_false(json_object_get(object, "complete")));
    assert_int_equal(json_array_size(array), 2);
    assert_true(json_is_string(json_object_get(object, "sequence")));
    assert_int_equal(count_of(json_array_get(array, 1), "contacts"), 2);
    assert_true(json_is_null(json_object_get(json_array_get(array, 1), "toi_first")));
    json_decref(object);
}

static float corner_x[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
static uint32_t corner_triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};

/* Draw the square seen from `from_z` with one mark in the middle; read the PNG back. */
static uint8_t *drawn_square(float from_z, const char *path)
{
    struct snapshot_object square = {.x = corner_x,
                                     .triangles = corner_triangles,
                                     .vertex_count = 4,
                                     .triangle_count = 2};
    const struct snapshot snapshot = {.objects = &square, .object_count = 1};
    const struct picture_mark mark = {.at = {0.5f, 0.25f, 0},
                                      .colour = PICTURE_COLOURS - 1};
    struct picture picture = {.snapshot = &snapshot,
                              .marks = &mark,
                              .mark_count = 1,
                              .from = {0, 0, from_z},
                              .title = "square"};
    struct ctl_error error = {.text = ""};
    png_image image = {.version = PNG_IMAGE_VERSION};
    struct whole_file file;
    assert_ok(output_open(&file, path, false, &error));
    assert_ok(picture_write(&picture, file.to, path, &error));
    assert_ok(output_finish(&file, path, &error));
    assert_int_not_equal(png_image_begin_read_from_file(&image, path), 0);
    assert_int_equal(image.width, PICTURE_WIDTH);
    assert_int_equal(image.height, PICTURE_HEIGHT);
    image.format = PNG_FORMAT_RGB;
    uint8_t *pixels = test_room(PNG_IMAGE_SIZE(image));
    assert_int_not_equal(png_image_finish_read(&image, NULL, pixels, 0, NULL), 0);
    return pixels;
}

static const uint8_t *pixel(const uint8_t *pixels, uint32_t x, uint32_t y)
{
    return pixels + ((size_t)y * PICTURE_WIDTH + x) * 3;
}

/* If it failed: sides would be swapped, marks missing or misplaced, or an older and
 * longer file would show through. */
CASE(picture__shows_sides_and_marks_where_they_are)
{
    char path[] = "/tmp/pccd-picture-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_int_equal(ftruncate(fd, 4000000), 0);
    close(fd);
    uint8_t *front = drawn_square(1.0f, path);
    uint8_t *back = drawn_square(-1.0f, path);
    const uint32_t middle_x = PICTURE_WIDTH / 2, middle_y = PICTURE_HEIGHT / 2;
    /* The square's side is the picture's height without the margins of 12 %. */
    const uint32_t half = (uint32_t)(PICTURE_HEIGHT / 2 / 1.12);
    const uint8_t *light = pixel(front, middle_x - 40, middle_y - 20);
    const uint8_t *dark = pixel(back, middle_x + 40, middle_y - 20);
    const uint8_t *yellow = pixel(front, middle_x + half / 2, middle_y - half / 4);
    assert_in_range(light[2], light[0] + 30, 255); /* the first object is blue */
    assert_in_range(dark[2], dark[0] + 30, light[2] - 30);
    assert_in_range(yellow[0], yellow[2] + 100, 255);
    /* From behind the mark is on the other side, and shines through nothing. */
    yellow = pixel(back, middle_x - half / 2, middle_y - half / 4);
    assert_in_range(yellow[0], yellow[2] + 100, 255);
    free(front);
    free(back);
    unlink(path);
}

/* A cube of side 2 around the origin; two triangles a side. */
static float cube_x[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                             {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
static uint32_t cube_triangles[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                         {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                         {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

/* If it failed: the sides of a box would be shaded like cushions. */
CASE(picture__shades_the_sides_of_a_box_flat)
{
    const struct snapshot_object cube = {.x = cube_x,
                                         .triangles = cube_triangles,
                                         .vertex_count = 8,
                                         .triangle_count = 12};
    float normals[36][3];
    assert_true(picture_normals(&cube, 0, normals));
    for (uint32_t i = 0; i < 36; i++) {
        uint32_t side = i / 6; /* -z, z, -y, y, -x, x */
        for (uint32_t k = 0; k < 3; k++) {
            bool is_along = k == 2 - side / 2;
            assert_true(normals[i][k] == (!is_along       ? 0.0f
                                          : side % 2 == 0 ? -1.0f
                                                          : 1.0f));
        }
    }
}

/* If it failed: a ball would be a stone, or triangles wound otherwise would be dark. */
CASE(picture__smooths_what_is_nearly_flat)
{
    /* A ridge of 20 degrees along the y axis; the second time its last triangle is wound
     * otherwise. */
    static float x[6][3] = {{-1, 0, 0}, {0, 0, 0.176f}, {1, 0, 0},
                            {-1, 1, 0}, {0, 1, 0.176f}, {1, 1, 0}};
    static uint32_t ridges[2][4][3] = {{{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}},
                                       {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 4, 5}}};
    struct snapshot_object ridge = {
        .x = x, .triangles = ridges[0], .vertex_count = 6, .triangle_count = 4};
    float normals[12][3];
    assert_true(picture_normals(&ridge, 0, normals));
    assert_memory_equal(normals[1], normals[6], sizeof normals[1]); /* of vertex 1 */
    assert_memory_equal(normals[1], normals[9], sizeof normals[1]);
    assert_memory_equal(normals[2], normals[4], sizeof normals[2]); /* of vertex 4 */
    assert_memory_equal(normals[2], normals[11], sizeof normals[2]);
    assert_true(normals[1][0] > 0.0f && normals[1][0] < 0.17f); /* two of three lean so */
    assert_true(normals[0][0] < -0.17f);                        /* and all of vertex 0 */
    ridge.triangles = ridges[1];
    assert_true(picture_normals(&ridge, 0, normals));
    assert_true(normals[2][2] > 0.9f && normals[9][2] < -0.9f);
}

/* If it failed: the demo would work for seconds before it says that it cannot write. */
CASE(picture__tells_at_once_that_a_path_is_no_good)
{
    struct ctl_error error = {.text = ""};
    struct whole_file file;
    assert_int_equal(output_open(&file, "/nowhere/at/all.png", false, &error),
                     PCCD_E_SYSTEM);
    assert_string_equal(error.text,
                        "/nowhere/at/all.png: cannot write: No such file or directory");
    assert_null(file.to);
}
