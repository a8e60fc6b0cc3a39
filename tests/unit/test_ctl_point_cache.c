/* test_ctl_point_cache.c - the readers of PC2 and MDD. */
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ctl_kit.h"

#define FRAMES   3u
#define VERTICES 4u
#define MUTANTS  1000u

static char *data;
static size_t data_bytes;

static void put_word(bool is_mdd, uint32_t word)
{
    for (uint32_t i = 0; i < 4; i++) {
        data[data_bytes++] = (char)(word >> 8 * (is_mdd ? 3 - i : i));
    }
}

static void put_float(bool is_mdd, float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    put_word(is_mdd, word);
}

static float coordinate(uint32_t frame, uint32_t index)
{
    return (float)frame * 100 + (float)index + 0.1f;
}

/* A whole file, from frame 7 on and each second one, or from 0.25 s on. */
static void make(bool is_mdd, uint32_t frames, uint32_t vertices)
{
    data = realloc(data, 64 + (size_t)frames * (4 + 12 * (size_t)vertices));
    assert_non_null(data);
    data_bytes = 0;
    if (is_mdd) {
        put_word(true, frames);
        put_word(true, vertices);
        for (uint32_t i = 0; i < frames; i++) {
            put_float(true, 0.25f * (float)(i + 1));
        }
    } else {
        memcpy(data, "POINTCACHE2", 12);
        data_bytes = 12;
        put_word(false, 1);
        put_word(false, vertices);
        put_float(false, 7);
        put_float(false, 2);
        put_word(false, frames);
    }
    for (uint32_t i = 0; i < frames * 3 * vertices; i++) {
        put_float(is_mdd, coordinate(i / (3 * vertices), i % (3 * vertices)));
    }
}

static int open_as(bool is_mdd, const char *path, struct ctl_motion *motion,
                   struct ctl_error *error)
{
    return ctl_motion_open(path, is_mdd ? ctl_mdd_open : ctl_pc2_open, NULL, motion,
                           error);
}

static int open_data(bool is_mdd, struct ctl_motion *motion, struct ctl_error *error)
{
    static char path[KIT_PATH_BYTES];
    kit_write_file(is_mdd ? "a.mdd" : "a.pc2", data, data_bytes, path);
    return open_as(is_mdd, path, motion, error);
}

static void check_frames(const struct ctl_motion *motion, uint32_t frames,
                         uint32_t vertices)
{
    struct ctl_error error;
    float *x = test_room(12 * (size_t)vertices);
    assert_int_equal(motion->frame_count, frames);
    assert_int_equal(motion->vertex_count, vertices);
    assert_int_equal(motion->format, PCCD_FORMAT_F32);
    for (uint32_t frame = frames; frame-- > 0;) {
        assert_ok(motion->read(motion, frame, x, &error));
        for (uint32_t i = 0; i < 3 * vertices; i++) {
            float is = x[i], due = coordinate(frame, i);
            assert_memory_equal(&is, &due, sizeof is);
        }
    }
    free(x);
}

/* If it failed, a bake would be read with other positions, or under other names. */
CASE(cache__has_the_frames_that_were_written)
{
    for (int is_mdd = 0; is_mdd < 2; is_mdd++) {
        struct ctl_motion motion;
        struct ctl_error error;
        char name[64];
        make(is_mdd, FRAMES, VERTICES);
        assert_ok(open_data(is_mdd, &motion, &error));
        check_frames(&motion, FRAMES, VERTICES);
        motion.name(&motion, 2, name, sizeof name);
        assert_string_equal(name, is_mdd ? "0.75 s" : "frame 11");
        ctl_motion_close(&motion);
    }
}

/* If it failed, no MDD of Blender would be read, or its first step would stand still; or
 * a file with a frame too many would pass for one. */
CASE(cache__mdd_may_have_its_first_frame_twice)
{
    const size_t frame_bytes = 12 * (size_t)30011, begin = 8 + 4 * 3;
    struct ctl_motion motion;
    struct ctl_error error;
    for (int is_same = 1; is_same >= 0; is_same--) {
        make(true, 3, 30011);
        data = realloc(data, data_bytes + frame_bytes);
        assert_non_null(data);
        memmove(data + begin + frame_bytes, data + begin, 3 * frame_bytes);
        data_bytes += frame_bytes;
        data[begin + frame_bytes - 1] ^= (char)!is_same;
        int status = open_data(true, &motion, &error);
        assert_int_equal(status, is_same ? PCCD_OK : PCCD_E_FORMAT);
        if (is_same) {
            check_frames(&motion, 3, 30011);
            ctl_motion_close(&motion);
        }
    }
    assert_non_null(strstr(error.text, "3 frames of 30011 vertices, it has 1080416 bytes;"
                                       " it has 1440548"));
}

/* If it failed, a cache above what is read at once would be read in part. */
CASE(cache__may_be_large)
{
    for (int is_mdd = 0; is_mdd < 2; is_mdd++) {
        struct ctl_motion motion;
        struct ctl_error error;
        make(is_mdd, 5, 30011);
        assert_true(data_bytes > 1u << 20);
        assert_ok(open_data(is_mdd, &motion, &error));
        check_frames(&motion, 5, 30011);
        ctl_motion_close(&motion);
    }
}

/* If it failed, the way that a cache comes would decide what it says. */
CASE(cache__may_be_a_pipe)
{
    for (int is_mdd = 0; is_mdd < 2; is_mdd++) {
        struct ctl_motion motion;
        struct ctl_error error;
        char path[KIT_PATH_BYTES];
        int status = 0;
        make(is_mdd, 5, 30011);
        (void)snprintf(path, sizeof path, "%s/pipe%d", kit_folder, is_mdd);
        assert_int_equal(mkfifo(path, 0600), 0);
        pid_t child = fork();
        if (child == 0) {
            FILE *to = fopen(path, "w");
            _exit(to == NULL || fwrite(data, 1, data_bytes, to) != data_bytes ||
                  fclose(to) != 0);
        }
        assert_ok(open_as(is_mdd, path, &motion, &error));
        check_frames(&motion, 5, 30011);
        ctl_motion_close(&motion);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_int_equal(status, 0);
        assert_int_equal(unlink(path), 0);
    }
}

/* Damages: bytes that are written over a good file, its size then, and what the message
 * says. */
static const struct broken {
    bool is_mdd;
    int at; /* -1: nowhere */
    const char *bytes;
    size_t count, size; /* size 0: as it is */
    int status;
    const char *message; /* after the path */
} broken_files[] = {
    {false, 0, "P0INT", 5, 0, PCCD_E_FORMAT,
     ": a PC2 file begins with \"POINTCACHE2\" and a byte 0"},
    {false, 12, "\2", 1, 0, PCCD_E_FORMAT, ": version 2 of PC2, and only 1 is read"},
    {false, 16, "\5", 1, 0, PCCD_E_FORMAT,
     ": by its header, 3 frames of 5 vertices, it has 212 bytes; it has 176"},
    {false, 16, "\0", 1, 0, PCCD_E_FORMAT, ": the header has 3 frames of 0 vertices"},
    {false, 31, "\xff", 1, 0, PCCD_E_FORMAT,
     ": the header has -16777213 frames of 4 vertices"},
    {false, 19, "\x7f\0\0\xe0\x40\0\0\0\x40\3\0\0\x7f", 13, 0, PCCD_E_FORMAT,
     ": by its header, 2130706435 frames of 2130706436 vertices, it has "
     "18446744073709551615 bytes; it has 176"},
    {false, -1, "", 0, 175, PCCD_E_FORMAT,
     ": by its header, 3 frames of 4 vertices, it has 176 bytes; it has 175"},
    {false, -1, "", 0, 177, PCCD_E_FORMAT,
     ": by its header, 3 frames of 4 vertices, it has 176 bytes; it has 177"},
    {false, -1, "", 0, 31, PCCD_E_FORMAT, ": a header has 32 bytes; the file has 31"},
    {true, -1, "", 0, 7, PCCD_E_FORMAT, ": a header has 8 bytes; the file has 7"},
    {true, 3, "\4", 1, 0, PCCD_E_FORMAT,
     ": by its header, 4 frames of 4 vertices, it has 216 bytes; it has 164"},
    {true, 0, "\0\0\0\0", 4, 0, PCCD_E_FORMAT, ": the header has 0 frames of 4 vertices"},
};

/* If it failed, a cut or a wrong file would be read as another animation. */
CASE(cache__that_is_broken_is_named)
{
    for (size_t i = 0; i < sizeof broken_files / sizeof broken_files[0]; i++) {
        const struct broken *broken = &broken_files[i];
        struct ctl_motion motion = {.state = NULL};
        struct ctl_error error;
        char path[KIT_PATH_BYTES], due[400];
        make(broken->is_mdd, FRAMES, VERTICES);
        if (broken->at >= 0) {
            memcpy(data + broken->at, broken->bytes, broken->count);
        }
        if (broken->size > 0) {
            data[data_bytes] = 0;
            data_bytes = broken->size;
        }
        kit_write_file("broken", data, data_bytes, path);
        assert_int_equal(open_as(broken->is_mdd, path, &motion, &error), broken->status);
        (void)snprintf(due, sizeof due, "%s%s", path, broken->message);
        assert_string_equal(error.text, due);
        assert_null(motion.state);
    }
}

/* If it failed, a NaN of a simulation that has exploded would go to the daemon. */
CASE(cache__coordinate_that_is_none_is_named)
{
    struct ctl_motion motion;
    struct ctl_error error;
    float x[VERTICES][3];
    make(false, FRAMES, VERTICES);
    memcpy(data + 32 + 48 + 16, "\0\0\xc0\x7f", 4);
    assert_ok(open_data(false, &motion, &error));
    assert_ok(motion.read(&motion, 0, x, &error));
    assert_int_equal(motion.read(&motion, 1, x, &error), PCCD_E_NOTFINITE);
    assert_non_null(
        strstr(error.text, "a.pc2: byte 96, frame 1, vertex 1: coordinate y is nan"));
    ctl_motion_close(&motion);
}

/* If it failed, a device would be read for ever. */
CASE(cache__is_no_device)
{
    struct ctl_motion motion;
    struct ctl_error error;
    assert_int_equal(ctl_motion_open("/dev/zero", ctl_pc2_open, NULL, &motion, &error),
                     PCCD_E_FORMAT);
    assert_string_equal(error.text, "/dev/zero: a device, neither file nor pipe");
}

static uint32_t random_word(void)
{
    static uint32_t word = 45;
    word ^= word << 13;
    word ^= word >> 17;
    return word ^= word << 5;
}

/* If it failed, a file from elsewhere could make pccdctl read or write outside of what it
 * has; the sanitizers would tell. */
CASE(cache__that_was_changed_is_read_or_refused)
{
    uint32_t read_count = 0;
    float x[256][3];
    for (uint32_t i = 0; i < 2 * MUTANTS; i++) {
        struct ctl_motion motion;
        struct ctl_error error;
        make(i % 2, FRAMES, VERTICES);
        for (uint32_t k = random_word() % 4; k < 4; k++) {
            size_t within = random_word() % 2 ? 36 : data_bytes;
            data[random_word() % within] = (char)random_word();
        }
        data_bytes -= random_word() % 8 == 0 ? random_word() % data_bytes : 0;
        if (open_data(i % 2, &motion, &error) == PCCD_OK) {
            assert_true(motion.vertex_count <= 256);
            for (uint32_t f = 0; f < motion.frame_count; f++) {
                int status = motion.read(&motion, f, x, &error);
                assert_true(status == PCCD_OK || status == PCCD_E_NOTFINITE);
                read_count += status == PCCD_OK;
            }
            ctl_motion_close(&motion);
        }
    }
    assert_true(read_count > MUTANTS / 4);
}

static int tear_down(void **state)
{
    free(data);
    return kit_remove_folder(state);
}

CASES_WITH(kit_make_folder, tear_down);
