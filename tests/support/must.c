/* must.c - what a client does that must work. */
#include "must.h"

#include "crossing.h"
#include "grid.h"

/* Fail the case unless the status is 0, with what the library says of the call. */
static void expect_done(const struct pccd_client *client, int status)
{
    if (status != 0) {
        fail_msg("%s: %s", pccd_status_name(status), pccd_error_text(client));
    }
}

struct pccd_client *test_client(const struct pccd_options *options)
{
    struct pccd_client *client = NULL;

    expect_done(NULL, pccd_connect(options, &client));
    return client;
}

struct pccd_client *test_client_at(const char *url)
{
    struct pccd_client *client = test_connect(url);

    assert_non_null(client);
    return client;
}

struct pccd_link_info test_link(const struct pccd_client *client)
{
    struct pccd_link_info info;

    expect_done(client, pccd_link(client, &info));
    return info;
}

uint32_t test_scene(struct pccd_client *client)
{
    uint32_t scene = 0;

    expect_done(client, pccd_scene_create(client, NULL, &scene));
    return scene;
}

uint32_t test_mesh(struct pccd_client *client, const void *x, enum pccd_format format,
                   uint32_t vertex_count, const void *triangles, uint32_t triangle_count)
{
    uint32_t mesh = 0;

    expect_done(client, pccd_mesh_create(client, x, format, vertex_count, triangles,
                                         triangle_count, &mesh, NULL));
    return mesh;
}

uint32_t test_object(struct pccd_client *client, uint32_t scene, uint32_t mesh)
{
    uint32_t object = 0;

    expect_done(client, pccd_scene_add(client, scene, mesh, &object));
    return object;
}

void test_still(struct pccd_client *client, uint32_t scene,
                const struct pccd_step_settings *settings, struct pccd_answer *answer)
{
    uint64_t step = 0;

    expect_done(client, pccd_submit_still(client, scene, settings, &step));
    expect_done(client, pccd_wait(client, step, -1, answer));
}

void test_grid_open(struct test_grid *grid, const char *url, uint32_t side)
{
    struct pccd_client *client = test_client_at(url);

    expect_done(client, test_grid_make(client, side, grid));
}

void test_grid_close(struct test_grid *grid)
{
    pccd_close(grid->client);
    test_grid_free(grid);
}

void test_grid_expect(struct test_grid *grid, uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;

    expect_done(grid->client, pccd_wait(grid->client, step, 600000, &answer));
    assert_true(test_grid_is_right(grid, &answer));
    pccd_answer_release(grid->client, &answer);
}

void test_grid_pass(struct test_grid *grid)
{
    uint64_t step = 0;

    expect_done(grid->client, test_grid_submit(grid, NULL, &step));
    test_grid_expect(grid, step);
}
