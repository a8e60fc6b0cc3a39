/* crossing.c - the smallest scene with a known answer, and a client that keeps asking. */
#include "crossing.h"

#include <stdio.h>
#include <string.h>

#include "daemon.h"

#define TIMEOUT_MS 20000
#define AWAIT_MS   5000

const float test_floor_x[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
const float test_triangle_x[3][3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
const uint32_t test_triangle[1][3] = {{0, 1, 2}};

static struct pccd_client *connect_to(const char *url, int reconnect_ms,
                                      uint32_t slot_count)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;

    pccd_options_init(&options);
    options.url = url;
    options.timeout_ms = TIMEOUT_MS;
    options.reconnect_ms = reconnect_ms;
    options.slot_count = slot_count;
    options.result_bytes = 4u << 20; /* several answers of a grid that wait to be taken */
    if (pccd_connect(&options, &client) != 0) {
        fprintf(stderr, "# connect: %s\n", pccd_error_text(NULL));
    }
    return client;
}

struct pccd_client *test_connect(const char *url)
{
    return connect_to(url, 0, 0);
}

struct pccd_client *test_connect_once(const char *url)
{
    return connect_to(url, -1, 0);
}

struct pccd_client *test_connect_slim(const char *url)
{
    return connect_to(url, 0, 1);
}

int test_crossing_make(struct pccd_client *client, struct test_crossing *crossing)
{
    int status;

    memset(crossing, 0, sizeof *crossing);
    crossing->client = client;
    crossing->z = 1;
    status = pccd_scene_create(client, NULL, &crossing->scene);
    if (status == 0) {
        status = pccd_mesh_create(client, test_floor_x, PCCD_FORMAT_F32, 3, test_triangle,
                                  1, &crossing->floor_mesh, NULL);
    }
    if (status == 0) {
        status = pccd_mesh_create(client, test_triangle_x, PCCD_FORMAT_F32, 3,
                                  test_triangle, 1, &crossing->mesh, NULL);
    }
    if (status == 0) {
        status = pccd_scene_add(client, crossing->scene, crossing->floor_mesh,
                                &crossing->floor);
    }
    if (status == 0) {
        status =
            pccd_scene_add(client, crossing->scene, crossing->mesh, &crossing->object);
    }
    if (status != 0) {
        fprintf(stderr, "# scene: %s\n", pccd_error_text(client));
    }
    return status;
}

void test_crossing_positions(float x[3][3], float z)
{
    memcpy(x, test_triangle_x, sizeof test_triangle_x);
    x[0][2] = x[1][2] = x[2][2] = z;
}

bool test_crossing_is_right(struct test_crossing *crossing, struct pccd_answer *answer)
{
    bool right = answer->status == 0 && answer->incomplete == PCCD_COMPLETE &&
                 answer->count == 3 && answer->total == 3 &&
                 answer->counts[PCCD_VF] == 3 && answer->counts[PCCD_EE] == 0 &&
                 answer->contacts != NULL;

    for (uint32_t i = 0; right && i < 3; i++) {
        const struct pccd_contact *contact = &answer->contacts[i];

        right = contact->kind == PCCD_VF && contact->object_a == crossing->object &&
                contact->feature_a == i && contact->object_b == crossing->floor &&
                contact->feature_b == 0 && contact->toi <= 0.5 &&
                contact->toi_hi >= 0.5 && contact->toi_hi - contact->toi <= 1e-6;
    }
    pccd_answer_release(crossing->client, answer);
    return right;
}

int test_crossing_step(struct test_crossing *crossing, const void *x1,
                       const struct pccd_step_settings *settings,
                       struct pccd_answer *answer)
{
    return pccd_step_x1(crossing->client, crossing->scene, crossing->object, x1,
                        PCCD_FORMAT_F32, 3, settings, answer);
}

bool test_crossing_turn(struct test_crossing *crossing)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    float x1[3][3];
    int status;

    test_crossing_positions(x1, -crossing->z);
    status = test_crossing_step(crossing, x1, NULL, &answer);
    if (status != 0) {
        fprintf(stderr, "# turn: %s\n", pccd_error_text(crossing->client));
        return false;
    }
    crossing->z = -crossing->z;
    return test_crossing_is_right(crossing, &answer);
}

/* Name of a number to look for, and what was found. */
struct search {
    const char *name;
    uint64_t value;
};

static void look(void *context, const char *name, uint64_t value, const char *text)
{
    struct search *search = context;

    (void)text;
    if (strcmp(name, search->name) == 0) {
        search->value = value;
    }
}

uint64_t test_stat(struct pccd_client *client, const char *name)
{
    struct search search = {name, UINT64_MAX};

    if (pccd_stats(client, look, &search) != 0) {
        return UINT64_MAX;
    }
    return search.value;
}

uint64_t test_stat_await(struct pccd_client *client, const char *name, uint64_t value)
{
    uint64_t until_ms = test_now_ms() + AWAIT_MS;
    uint64_t seen;

    do {
        seen = test_stat(client, name);
        if (seen == value) {
            break;
        }
        test_sleep_ms(2);
    } while (test_now_ms() < until_ms);
    return seen;
}
