/* tests/unit/test_ctl_weld.c - vertices at one place, in the frames of files.
 *
 * Room:     client/ctl (meshframes.h, weld.h).
 * Does:     write frames whose vertices meet, part, or are nearly at one place.
 * Does not: need a daemon.
 * Threads:  one, and one that writes into a pipe.
 * Source:   client/ctl/mesh/weld.h.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "ctl_kit.h"
#include "meshframes.h"
#include "weld.h"

static struct ctl_error error;

static void write_text(const char *name, const char *text, char path[KIT_PATH_BYTES])
{
    kit_write_file(name, text, strlen(text), path);
}

static void open_frames(struct ctl_frames *frames, char *const *paths, uint32_t count,
                        double weld)
{
    const struct ctl_frames_options options = {.weld = weld};
    if (ctl_frames_open(frames, paths, count, &options, &error) != PCCD_OK) {
        fail_msg("%s", error.text);
    }
}

/* Two triangles whose common side each has for itself; (3) is (1) and (4) is (2). Vertex
 * 5 is nowhere used. */
#define SPLIT(x3, x4)                                                                    \
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv " x3 "\nv " x4 "\nv 1 0 0\nv 1 1 0\n"                  \
    "f 1 2 3\nf 4 7 5\n"

/* If it failed: what an exporter has split would touch itself, or what tears be held
 * together, or results name vertices that the file does not have. */
static void weld__joins_what_is_at_one_place_in_each_frame(void **state)
{
    char a[KIT_PATH_BYTES], b[KIT_PATH_BYTES], c[KIT_PATH_BYTES];
    struct ctl_frames frames;
    struct ctl_mesh frame = {0};
    (void)state;
    write_text("a.obj", SPLIT("1 -0 0", "0 1 -0"), a);
    write_text("b.obj", SPLIT("1 0 0", "0 1 0"), b);
    write_text("c.obj", SPLIT("1 0 0", "0 1 5e-324"), c);
    open_frames(&frames, (char *[]){a, b}, 2, 0);
    assert_int_equal(frames.welded.joined, 2);
    assert_int_equal(frames.welded.apart + frames.welded.more + frames.welded.flat, 0);
    assert_int_equal(frames.mesh.vertex_count, 7);
    assert_memory_equal(frames.mesh.triangles.vertices + 3, ((uint32_t[]){1, 6, 2}), 12);
    assert_int_equal(ctl_frames_read(&frames, 1, &frame, &error), PCCD_OK);
    assert_int_equal(frame.vertex_count, 7);
    ctl_frames_close(&frames);
    open_frames(&frames, (char *[]){a, b, c}, 3, 0);
    assert_int_equal(frames.welded.joined, 1);
    assert_int_equal(frames.welded.apart, 1);
    assert_memory_equal(frames.mesh.triangles.vertices + 3, ((uint32_t[]){1, 6, 4}), 12);
    ctl_frames_close(&frames);
    open_frames(&frames, (char *[]){c, a}, 2, 0);
    assert_int_equal(frames.welded.joined, 1);
    assert_int_equal(frames.welded.more, 1);
    ctl_frames_close(&frames);
    open_frames(&frames, (char *[]){a, b}, 2, -1);
    assert_int_equal(frames.welded.joined, 0);
    assert_memory_equal(frames.mesh.triangles.vertices + 3, ((uint32_t[]){3, 6, 4}), 12);
    ctl_frames_close(&frames);
    ctl_mesh_deinit(&frame);
}

/* If it failed: a sphere whose seam is off by a rounding could not be made whole, or its
 * user would not hear of it. */
static void weld__joins_what_is_as_near_as_was_asked_for(void **state)
{
    char a[KIT_PATH_BYTES];
    struct ctl_frames frames;
    (void)state;
    write_text("near.obj", SPLIT("1.0000000000000002 0 0", "0 0.9999 0"), a);
    open_frames(&frames, &(char *){a}, 1, 0);
    assert_int_equal(frames.welded.joined, 0);
    assert_int_equal(frames.welded.more, 1);
    assert_true(frames.welded.distance >= 0x1p-40 && frames.welded.distance < 1e-12);
    ctl_frames_close(&frames);
    open_frames(&frames, &(char *){a}, 1, 0x1p-40);
    assert_int_equal(frames.welded.joined, 1);
    ctl_frames_close(&frames);
    open_frames(&frames, &(char *){a}, 1, 1e-3);
    assert_int_equal(frames.welded.joined, 2);
    ctl_frames_close(&frames);
    open_frames(&frames, &(char *){a}, 1, 1);
    assert_int_equal(frames.welded.joined, 4); /* to 0 and 3 */
    assert_int_equal(frames.welded.flat, 2);
    ctl_frames_close(&frames);
}

/* If it failed: two vertices that stay together would be parted because a third one that
 * was there, too, has gone; or many at one place would take for ever. */
static void weld__keeps_together_what_stays_together(void **state)
{
    enum { COUNT = 200000 };
    double(*x)[3] = calloc(COUNT, sizeof *x);
    struct ctl_weld weld;
    const struct ctl_places places = {PCCD_FORMAT_F64, x, COUNT};
    (void)state;
    assert_non_null(x);
    assert_int_equal(ctl_weld_begin(&weld, 0, &places, NULL, &error), PCCD_OK);
    assert_int_equal(weld.joined, COUNT - 1);
    for (uint32_t i = 0; i < COUNT; i++) {
        x[i][1] = i % 1000;
    }
    assert_int_equal(ctl_weld_frame(&weld, &places, &error), PCCD_OK);
    assert_int_equal(weld.joined, COUNT - 1000);
    assert_int_equal(weld.to[123456], 456);
    memset(x, 0, COUNT * sizeof *x);
    assert_int_equal(ctl_weld_frame(&weld, &places, &error), PCCD_OK);
    assert_int_equal(weld.joined, COUNT - 1000); /* what was apart stays so */
    x[456][0] = 1;
    assert_int_equal(ctl_weld_frame(&weld, &places, &error), PCCD_OK);
    assert_int_equal(weld.to[123456], 1456);
    assert_int_equal(weld.joined, COUNT - 1001);
    ctl_weld_deinit(&weld);
    free(x);
}

/* If it failed: the search in cells would miss pairs across their borders, or join what
 * is farther apart. */
static void weld__finds_what_comparing_all_finds(void **state)
{
    enum { COUNT = 600 };
    static double x[COUNT][3];
    unsigned seed = 7;
    (void)state;
    for (int round = 0; round < 40; round++) {
        double distance = round % 4 == 0   ? 0
                          : round % 4 == 1 ? 1
                          : round % 4 == 2 ? .3
                                           : 7;
        uint32_t joined = 0, expected[COUNT];
        struct ctl_weld weld;
        for (int i = 0; i < COUNT * 3; i++) {
            seed = seed * 1664525u + 1013904223u;
            double value = (double)(seed >> 28) - 7;
            x[i / 3][i % 3] = round < 20 ? value : value + (double)(seed >> 20 & 15) / 16;
        }
        for (uint32_t i = 0; i < COUNT; i++) {
            expected[i] = i;
            for (uint32_t j = 0; j < i && expected[i] == i; j++) {
                double sum = 0;
                for (int k = 0; k < 3; k++) {
                    sum += (x[i][k] - x[j][k]) * (x[i][k] - x[j][k]);
                }
                if (expected[j] == j && sum <= distance * distance) {
                    expected[i] = j;
                    joined++;
                }
            }
        }
        const struct ctl_places places = {PCCD_FORMAT_F64, x, COUNT};
        assert_int_equal(ctl_weld_begin(&weld, distance, &places, NULL, &error), PCCD_OK);
        if (distance != .3) { /* whose square is not exact */
            assert_int_equal(weld.joined, joined);
            assert_memory_equal(weld.to, expected, sizeof expected);
        }
        ctl_weld_deinit(&weld);
    }
}

/* ---- STL --------------------------------------------------------------------------- */

static void write_stl(const char *name, const float x[6][3], char path[KIT_PATH_BYTES])
{
    char data[84 + 2 * 50] = {0};
    data[80] = 2;
    for (int i = 0; i < 6; i++) {
        memcpy(data + 84 + 50 * (i / 3) + 12 * (i % 3 + 1), x[i], sizeof x[i]);
    }
    kit_write_file(name, data, sizeof data, path);
}

/* If it failed: two frames from STL would have other numbers of vertices where corners
 * meet or part, and be refused. */
static void weld__gives_stl_the_same_vertices_in_each_frame(void **state)
{
    static const float apart[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                      {1, 0, 0}, {1, 1, 0}, {0, 2, 0}};
    static const float together[6][3] = {{0, 0, 0}, {1, 0, 1}, {0, 1, 0},
                                         {1, 0, 1}, {1, 1, 0}, {0, 1, 0}};
    char a[KIT_PATH_BYTES], b[KIT_PATH_BYTES];
    (void)state;
    write_stl("apart.stl", apart, a);
    write_stl("together.stl", together, b);
    for (int turned = 0; turned < 2; turned++) {
        struct ctl_frames frames;
        struct ctl_mesh x[2] = {{0}, {0}};
        open_frames(&frames, turned ? (char *[]){b, a} : (char *[]){a, b}, 2, 0);
        assert_int_equal(frames.mesh.vertex_count, 5);
        assert_int_equal(frames.welded.apart, turned);
        assert_memory_equal(frames.mesh.triangles.vertices,
                            ((uint32_t[2][3]){{0, 1, 2}, {1, 3, 4}}), 24);
        for (uint32_t i = 0; i < 2; i++) {
            assert_int_equal(ctl_frames_read(&frames, i, &x[i], &error), PCCD_OK);
            assert_int_equal(x[i].vertex_count, 5);
        }
        assert_true(((const float(*)[3])x[turned].x)[4][1] == 2);
        assert_true(((const float(*)[3])x[!turned].x)[4][1] == 1);
        assert_true(((const float(*)[3])x[!turned].x)[1][2] == 1);
        ctl_mesh_deinit(&x[0]);
        ctl_mesh_deinit(&x[1]);
        ctl_frames_close(&frames);
    }
}

/* If it failed: frames from pipes would be empty, because they were read twice. */
static void weld__reads_pipes_once(void **state)
{
    char a[KIT_PATH_BYTES], b[KIT_PATH_BYTES];
    struct ctl_frames frames;
    struct ctl_mesh frame = {0};
    (void)state;
    for (int i = 0; i < 2; i++) {
        snprintf(i == 0 ? a : b, KIT_PATH_BYTES, "%s/pipe%d.obj", kit_folder, i);
        assert_int_equal(mkfifo(i == 0 ? a : b, 0600), 0);
    }
    pid_t child = fork();
    if (child == 0) {
        for (int i = 0; i < 2; i++) {
            FILE *to = fopen(i == 0 ? a : b, "w");
            fputs(i == 0 ? SPLIT("1 0 0", "0 1 0") : SPLIT("1 0 0", "0 1 1"), to);
            fclose(to);
        }
        _exit(0);
    }
    open_frames(&frames, (char *[]){a, b}, 2, 0);
    assert_int_equal(frames.welded.joined, 1);
    assert_int_equal(frames.welded.apart, 1);
    assert_int_equal(ctl_frames_read(&frames, 0, &frame, &error), PCCD_OK);
    assert_int_equal(ctl_frames_read(&frames, 1, &frame, &error), PCCD_OK);
    assert_true(((const double(*)[3])frame.x)[4][2] == 1);
    ctl_mesh_deinit(&frame);
    ctl_frames_close(&frames);
    (void)waitpid(child, NULL, 0);
    (void)unlink(a);
    (void)unlink(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weld__joins_what_is_at_one_place_in_each_frame),
        cmocka_unit_test(weld__joins_what_is_as_near_as_was_asked_for),
        cmocka_unit_test(weld__keeps_together_what_stays_together),
        cmocka_unit_test(weld__finds_what_comparing_all_finds),
        cmocka_unit_test(weld__gives_stl_the_same_vertices_in_each_frame),
        cmocka_unit_test(weld__reads_pipes_once),
    };
    return cmocka_run_group_tests(tests, kit_make_folder, kit_remove_folder);
}
