/* grid.c - a scene of any size with a known answer. */
#include "grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crossing.h"

void test_grid_positions(struct test_grid *grid, float z)
{
    for (uint32_t i = 0; i < grid->vertex_count; i++) {
        float x = (float)(i % grid->side) / (float)grid->side - 0.5f;
        float y = (float)(i / grid->side) / (float)grid->side - 0.5f;

        grid->x[i][0] = x;
        grid->x[i][1] = y;
        grid->x[i][2] = z + 0.1f * sinf(7.0f * x) * cosf(5.0f * y);
    }
}

uint32_t (*test_grid_triangles(const struct test_grid *grid))[3]
{
    uint32_t cells = grid->side - 1;
    uint32_t(*triangles)[3] = calloc(2 * (size_t)cells * cells, sizeof *triangles);

    for (uint32_t i = 0; triangles != NULL && i < cells * cells; i++) {
        uint32_t corner = i / cells * grid->side + i % cells;
        const uint32_t first[3] = {corner, corner + 1, corner + grid->side};
        const uint32_t second[3] = {corner + 1, corner + grid->side + 1,
                                    corner + grid->side};

        memcpy(triangles[2 * (size_t)i], first, sizeof first);
        memcpy(triangles[2 * (size_t)i + 1], second, sizeof second);
    }
    return triangles;
}

static int add_grid(struct test_grid *grid)
{
    uint32_t cells = grid->side - 1;
    uint32_t(*triangles)[3] = test_grid_triangles(grid);
    int status;

    if (triangles == NULL) {
        return PCCD_E_NOMEM;
    }
    status = pccd_mesh_create(grid->client, grid->x, PCCD_FORMAT_F32, grid->vertex_count,
                              (const uint32_t(*)[3])triangles, 2 * cells * cells,
                              &grid->mesh, NULL);
    free(triangles);
    return status != 0
               ? status
               : pccd_scene_add(grid->client, grid->scene, grid->mesh, &grid->object);
}

int test_grid_replace(struct test_grid *grid)
{
    uint32_t cells = grid->side - 1;
    uint32_t(*triangles)[3] = test_grid_triangles(grid);
    int status;

    if (triangles == NULL) {
        return PCCD_E_NOMEM;
    }
    test_grid_positions(grid, 1);
    status = pccd_mesh_replace(grid->client, grid->mesh, grid->x, PCCD_FORMAT_F32,
                               grid->vertex_count, (const uint32_t(*)[3])triangles,
                               2 * cells * cells, NULL);
    free(triangles);
    grid->z = status == 0 ? 1 : grid->z;
    return status;
}

int test_grid_make(struct pccd_client *client, uint32_t side, struct test_grid *grid)
{
    uint32_t floor_mesh = 0;
    int status;

    memset(grid, 0, sizeof *grid);
    grid->client = client;
    grid->side = side;
    grid->vertex_count = side * side;
    grid->z = 1;
    grid->x = calloc(grid->vertex_count, sizeof *grid->x);
    if (grid->x == NULL) {
        return PCCD_E_NOMEM;
    }
    test_grid_positions(grid, grid->z);
    status = pccd_scene_create(client, NULL, &grid->scene);
    if (status == 0) {
        status = pccd_mesh_create(client, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle,
                                  1, &floor_mesh, NULL);
    }
    if (status == 0) {
        status = pccd_scene_add(client, grid->scene, floor_mesh, &grid->floor);
    }
    if (status == 0) {
        status = add_grid(grid);
    }
    if (status != 0) {
        fprintf(stderr, "# grid: %s\n", pccd_error_text(client));
    }
    return status;
}

void test_grid_free(struct test_grid *grid)
{
    free(grid->x);
    grid->x = NULL;
}

int test_grid_submit(struct test_grid *grid, const struct pccd_step_settings *settings,
                     uint64_t *step)
{
    struct pccd_frame frame;
    size_t bytes = grid->vertex_count * sizeof *grid->x;
    void *x1 = NULL;
    int status = pccd_frame_begin(grid->client, grid->scene, 1, bytes, &frame);

    if (status == 0) {
        status = pccd_frame_x1(&frame, grid->object, PCCD_FORMAT_F32, 0,
                               grid->vertex_count, &x1);
    }
    if (status != 0) {
        return status;
    }
    grid->z = -grid->z;
    test_grid_positions(grid, grid->z);
    memcpy(x1, grid->x, bytes);
    return pccd_frame_commit(&frame, settings, step);
}

int test_grid_turn(struct test_grid *grid, const struct pccd_step_settings *settings,
                   struct pccd_answer *answer)
{
    uint64_t step = 0;
    int status = test_grid_submit(grid, settings, &step);

    return status == 0 ? pccd_wait(grid->client, step, -1, answer) : status;
}

int test_grid_await(struct test_grid *grid, uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status = pccd_wait(grid->client, step, -1, &answer);

    if (status == 0) {
        pccd_answer_release(grid->client, &answer);
    }
    return status;
}

bool test_grid_is_right(const struct test_grid *grid, const struct pccd_answer *answer)
{
    if (answer->status != 0 || answer->incomplete != PCCD_COMPLETE ||
        answer->counts[PCCD_EE] != 0 || answer->counts[PCCD_VF] != grid->vertex_count ||
        answer->count != grid->vertex_count) {
        return false;
    }
    for (uint32_t i = 0; i < grid->vertex_count; i++) {
        const struct pccd_contact *contact = &answer->contacts[i];
        float x = (float)(i % grid->side) / (float)grid->side - 0.5f;
        float y = (float)(i / grid->side) / (float)grid->side - 0.5f;
        double wave = (double)(0.1f * sinf(7.0f * x) * cosf(5.0f * y));
        /* From height 1 to -1 or back; the float sums are exact enough for 1e-6. */
        double down = (1.0 + wave) / 2.0;
        double up = (1.0 - wave) / 2.0;
        bool inside = (down >= contact->toi - 1e-6 && down <= contact->toi_hi + 1e-6) ||
                      (up >= contact->toi - 1e-6 && up <= contact->toi_hi + 1e-6);

        if (contact->kind != PCCD_VF || contact->feature_a != i ||
            contact->object_a != grid->object || contact->object_b != grid->floor ||
            !inside) {
            return false;
        }
    }
    return true;
}
