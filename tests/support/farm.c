/* farm.c - many small scenes. */
#include "farm.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void fill_triangles(uint32_t side, uint32_t (*triangles)[3])
{
    uint32_t count = 0;

    for (uint32_t j = 0; j + 1 < side; j++) {
        for (uint32_t i = 0; i + 1 < side; i++) {
            uint32_t v = j * side + i;
            const uint32_t two[2][3] = {{v, v + 1, v + side},
                                        {v + 1, v + side + 1, v + side}};

            memcpy(triangles[count], two, sizeof two);
            count += 2;
        }
    }
}

void test_farm_positions(const struct test_farm *farm, uint32_t i, uint32_t turn,
                         float (*x)[3])
{
    double height = (turn % 2 == 0 ? 1 : -1) * (0.4 + 0.05 * (i % 9));
    double phase = 0.7 * i + 0.3 * turn;

    for (uint32_t v = 0; v < farm->vertex_count; v++) {
        double a = v % farm->side, b = (double)(v / farm->side);

        x[v][0] = (float)a;
        x[v][1] = (float)b;
        x[v][2] = (float)(height + 0.2 * sin(phase + a) * cos(phase - 0.6 * b));
    }
}

static int make_meshes(struct test_farm *farm)
{
    const float wide = 10.0f * (float)farm->side;
    const float floor[3][3] = {{-wide, -wide, 0}, {wide, -wide, 0}, {0, wide, 0}};
    const uint32_t triangle[1][3] = {{0, 1, 2}};
    uint32_t triangle_count = 2 * (farm->side - 1) * (farm->side - 1);
    uint32_t(*triangles)[3] = calloc(triangle_count, sizeof *triangles);
    int status = triangles == NULL ? PCCD_E_NOMEM : 0;

    if (status == 0) {
        fill_triangles(farm->side, triangles);
        test_farm_positions(farm, 0, 0, farm->x);
        status = pccd_mesh_create(farm->client, farm->x, PCCD_FORMAT_F32,
                                  farm->vertex_count, (const uint32_t(*)[3])triangles,
                                  triangle_count, &farm->mesh, NULL);
    }
    free(triangles);
    return status != 0 ? status
                       : pccd_mesh_create(farm->client, floor, PCCD_FORMAT_F32, 3,
                                          triangle, 1, &farm->floor_mesh, NULL);
}

static int make_batch(struct test_farm *farm)
{
    struct pccd_batch_part *parts = calloc(farm->count, sizeof *parts);
    int status = parts == NULL ? PCCD_E_NOMEM : 0;

    for (uint32_t i = 0; status == 0 && i < farm->count; i++) {
        struct test_world *world = &farm->worlds[i];

        status = pccd_scene_create(farm->client, NULL, &world->scene);
        status = status != 0 ? status
                             : pccd_scene_add(farm->client, world->scene,
                                              farm->floor_mesh, &world->floor);
        status = status != 0 ? status
                             : pccd_scene_add(farm->client, world->scene, farm->mesh,
                                              &world->body);
        parts[i] = (struct pccd_batch_part){
            .scene = world->scene, .object = world->body, .count = farm->vertex_count};
    }
    if (status == 0) {
        status = pccd_batch_create(farm->client, parts, farm->count, &farm->batch);
    }
    free(parts);
    return status;
}

int test_farm_make(struct pccd_client *client, uint32_t count, uint32_t side,
                   struct test_farm *farm)
{
    int status;

    *farm = (struct test_farm){
        .client = client, .side = side, .vertex_count = side * side, .count = count};
    farm->x = calloc(farm->vertex_count, sizeof *farm->x);
    farm->worlds = calloc(count, sizeof *farm->worlds);
    farm->x1 = calloc(count, sizeof *farm->x1);
    if (farm->x == NULL || farm->worlds == NULL || farm->x1 == NULL) {
        return PCCD_E_NOMEM;
    }
    status = make_meshes(farm);
    return status != 0 ? status : make_batch(farm);
}

void test_farm_free(struct test_farm *farm)
{
    pccd_batch_destroy(farm->batch);
    free(farm->worlds);
    free(farm->x);
    free(farm->x1);
    *farm = (struct test_farm){.client = NULL};
}

int test_farm_submit(struct test_farm *farm, uint32_t turn,
                     const struct pccd_step_settings *settings, uint64_t *step)
{
    int status = pccd_batch_begin(farm->batch, NULL, farm->x1);

    if (status != 0) {
        return status;
    }
    for (uint32_t i = 0; i < farm->count; i++) {
        test_farm_positions(farm, i, turn, farm->x1[i]);
    }
    return pccd_batch_commit(farm->batch, settings, step);
}

int test_farm_turn(struct test_farm *farm, uint32_t turn,
                   const struct pccd_step_settings *settings,
                   struct pccd_batch_answer *answer)
{
    uint64_t step = 0;
    int status = test_farm_submit(farm, turn, settings, &step);

    return status != 0 ? status : pccd_batch_wait(farm->client, step, -1, answer);
}

int test_farm_alone(struct test_farm *farm, uint32_t i, uint32_t turn,
                    const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    const struct test_world *world = &farm->worlds[i];

    test_farm_positions(farm, i, turn, farm->x);
    return pccd_step_x1(farm->client, world->scene, world->body, farm->x, PCCD_FORMAT_F32,
                        farm->vertex_count, settings, answer);
}
