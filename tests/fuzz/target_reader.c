/* target_reader.c - mesh files of any content. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fault.h"
#include "fuzz_target.h"
#include "meshfile.h"

/* Most bytes of one allocation: a header, 1024 triangles to begin with, then what grows
 * with the file: a vertex takes six characters at least, a triangle a few more. */
#define BYTES_AT_FIRST    (1u << 16)
#define BYTES_A_CHARACTER 64u

static void check_mesh(const struct ctl_mesh *mesh)
{
    FUZZ_CHECK(mesh->format == PCCD_FORMAT_F32 || mesh->format == PCCD_FORMAT_F64);
    for (size_t i = 0; i < (size_t)mesh->vertex_count * 3; i++) {
        double value = mesh->format == PCCD_FORMAT_F32
                           ? (double)((const float *)mesh->x)[i]
                           : ((const double *)mesh->x)[i];
        FUZZ_CHECK(common_is_coordinate(value));
    }
    for (uint32_t i = 0; i < mesh->triangles.count; i++) {
        for (size_t corner = 0; corner < 3; corner++) {
            FUZZ_CHECK(mesh->triangles.vertices[3 * (size_t)i + corner] <
                       mesh->vertex_count);
        }
    }
}

/* Frames of a point cache, which is opened by its name. */
static void read_frames(ctl_motion_reader *open_cache, const struct fuzz_input *input)
{
    struct ctl_error error = {0};
    struct ctl_motion motion = {.state = NULL};
    char path[32], name[64];
    fuzz_scarcity_pause();
    int fd = memfd_create("fuzz", MFD_CLOEXEC);
    FUZZ_CHECK(fd >= 0 && write(fd, input->at, input->left) == (ssize_t)input->left);
    (void)snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    fuzz_scarcity_resume();
    int status = ctl_motion_open(path, open_cache, NULL, &motion, &error);
    FUZZ_CHECK(status == PCCD_OK || strncmp(error.text, path, strlen(path)) == 0);
    if (status == PCCD_OK) {
        /* The size is that of the header, so all that is said is there. */
        size_t numbers = 3 * (size_t)motion.vertex_count;
        FUZZ_CHECK(numbers * motion.frame_count * sizeof(float) <= input->left);
        fuzz_scarcity_pause();
        float *x = malloc(numbers * sizeof *x);
        FUZZ_CHECK(x != NULL);
        fuzz_scarcity_resume();
        for (uint32_t i = 0; i < motion.frame_count; i++) {
            status = motion.read(&motion, i, x, &error);
            FUZZ_CHECK(status == PCCD_OK || status == PCCD_E_NOTFINITE);
            motion.name(&motion, i, name, sizeof name);
        }
        free(x);
        ctl_motion_close(&motion);
    }
    (void)close(fd);
}

/* The first byte chooses: up to 239 PLY if it is even, OBJ if odd; up to 247 STL and
 * glTF, and then PC2 and MDD. */
static const struct reader {
    const char *path;
    int (*parse)(struct ctl_file *file, struct ctl_mesh *mesh);
    ctl_motion_reader *open;
} readers[3][2] = {
    {{"fuzz.ply", ctl_ply_parse, NULL}, {"fuzz.obj", ctl_obj_parse, NULL}},
    {{"fuzz.stl", ctl_stl_parse, NULL}, {"fuzz.glb", ctl_gltf_parse, NULL}},
    {{"fuzz.pc2", NULL, ctl_pc2_open}, {"fuzz.mdd", NULL, ctl_mdd_open}}};

void fuzz_reader(const uint8_t *data, size_t bytes)
{
    struct fuzz_input input = {data, bytes};
    struct ctl_error error = {0};
    uint8_t choice = fuzz_take_u8(&input);
    const struct reader *reader = &readers[(choice >= 240) + (choice >= 248)][choice % 2];
    struct ctl_mesh mesh = {.path = reader->path, .error = &error};
    if (reader->open != NULL) {
        read_frames(reader->open, &input);
        return;
    }
    fuzz_scarcity_pause();
    struct ctl_file file = {.path = reader->path,
                            .error = &error,
                            .data = malloc(input.left + 1),
                            .bytes = input.left};
    FUZZ_CHECK(file.data != NULL);
    memcpy(file.data, input.at, input.left);
    file.data[input.left] = '\0';
    fuzz_scarcity_resume();
    atomic_store(&fault_page->refused, 0);
    atomic_store(&fault_page->bytes_max, BYTES_AT_FIRST + input.left * BYTES_A_CHARACTER);
    int status = reader->parse(&file, &mesh);
    atomic_store(&fault_page->bytes_max, 0);
    /* A glTF may show one mesh in many places, and is refused more than it is worth. */
    bool is_glb = reader->parse == ctl_gltf_parse;
    FUZZ_CHECK(is_glb || atomic_load(&fault_page->refused) == 0);
    FUZZ_CHECK(is_glb || status != PCCD_E_NOMEM || fuzz_scarcity_hits() > 0);
    if (status == PCCD_OK) {
        check_mesh(&mesh);
    }
    ctl_mesh_deinit(&mesh);
    free(file.data);
}
