/* test_ctl_weld.c - vertices at one place, in the frames of files. */
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ctl_kit.h"
#include "meshframes.h"

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
CASE(weld__joins_what_is_at_one_place_in_each_frame)
{
    char a[KIT_PATH_BYTES], b[KIT_PATH_BYTES], c[KIT_PATH_BYTES];
    struct ctl_frames frames;
    struct ctl_mesh frame = {0};
    write_text("a.obj", SPLIT("1 -0 0", "0 1 -0"), a);
    write_text("b.obj", SPLIT("1 0 0", "0 1 0"), b);
    write_text("c.obj", SPLIT("1 0 0", "0 1 5e-324"), c);
    open_frames(&frames, (char *[]){a, b}, 2, 0);
    assert_int_equal(frames.welded.joined, 2);
    assert_int_equal(frames.welded.apart + frames.welded.more + frames.welded.flat, 0);
    assert_int_equal(frames.mesh.vertex_count, 7);
    assert_memory_equal(frames.mesh.triangles.vertices + 3, ((uint32_t[]){1, 6, 2}), 12);
    assert_ok(ctl_frames_read(&frames, 1, &frame, &error));
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
CASE(weld__joins_what_is_as_near_as_was_asked_for)
{
    char a[KIT_PATH_BYTES];
    struct ctl_frames frames;
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
CASE(weld__gives_stl_the_same_vertices_in_each_frame)
{
    static const float apart[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                      {1, 0, 0}, {1, 1, 0}, {0, 2, 0}};
    static const float together[6][3] = {{0, 0, 0}, {1, 0, 1}, {0, 1, 0},
                                         {1, 0, 1}, {1, 1, 0}, {0, 1, 0}};
    char a[KIT_PATH_BYTES], b[KIT_PATH_BYTES];
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
            assert_ok(ctl_frames_read(&frames, i, &x[i], &error));
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
CASE(weld__reads_pipes_once)
{
    char a[KIT_PATH_BYTES], b[KIT_PATH_BYTES];
    struct ctl_frames frames;
    struct ctl_mesh frame = {0};
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
    assert_ok(ctl_frames_read(&frames, 0, &frame, &error));
    assert_ok(ctl_frames_read(&frames, 1, &frame, &error));
    assert_true(((const double(*)[3])frame.x)[4][2] == 1);
    ctl_mesh_deinit(&frame);
    ctl_frames_close(&frames);
    (void)waitpid(child, NULL, 0);
    (void)unlink(a);
    (void)unlink(b);
}

CASES_WITH(kit_make_folder, kit_remove_folder);
