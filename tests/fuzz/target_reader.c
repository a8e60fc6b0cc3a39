/* target_reader.c - mesh files of any content.
 *
 * Room:     tests/fuzz. May include: fuzz_target.h, fault.h, meshfile.h.
 * Does:     read the input as PLY, OBJ, STL or glTF: what is accepted is a mesh, and
 *           nothing takes more memory than a file of that length can be worth.
 * Threads:  one.
 */
#include <stdlib.h>
#include <string.h>

#include "fault.h"
#include "fuzz_target.h"
#include "meshfile.h"

/* Of one allocation: a header, 1024 triangles to begin with, then what grows with the
 * file: a vertex takes six characters at least, a triangle a few more. */
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

/* The first byte chooses: up to 239 PLY if it is even, OBJ if odd; beyond it STL and
 * glTF. */
static const struct reader {
    const char *path;
    int (*parse)(struct ctl_file *file, struct ctl_mesh *mesh);
} readers[2][2] = {{{"fuzz.ply", ctl_ply_parse}, {"fuzz.obj", ctl_obj_parse}},
                   {{"fuzz.stl", ctl_stl_parse}, {"fuzz.glb", ctl_gltf_parse}}};

void fuzz_reader(const uint8_t *data, size_t bytes)
{
    struct fuzz_input input = {data, bytes};
    struct ctl_error error = {0};
    uint8_t choice = fuzz_take_u8(&input);
    const struct reader *reader = &readers[choice >= 240][choice % 2];
    struct ctl_mesh mesh = {.path = reader->path, .error = &error};
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
