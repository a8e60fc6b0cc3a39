/* hog.c - requests that compute for seconds. */
#include "hog.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "prng.h"

#define WAIT_MS      600000
#define SEGMENT_ROOM 32u /* of a slot: one segment, then positions */

static const char *const names[HOG_KINDS] = {"coincident triangles", "fan of triangles",
                                             "mesh.commit"};

const char *test_hog_name(enum hog_kind kind)
{
    return names[kind];
}

static uint32_t vertices_of(const struct hog *hog)
{
    return hog->kind == HOG_FAN ? 2 * hog->triangles + 1 : 3 * hog->triangles;
}

/* Vertices are three of each triangle but in a fan, where the first is everybody's. */
static void put_triangles(const struct hog *hog, uint32_t (*triangles)[3])
{
    for (uint32_t i = 0; i < hog->triangles; i++) {
        bool is_fan = hog->kind == HOG_FAN;
        triangles[i][0] = is_fan ? 0 : 3 * i;
        triangles[i][1] = is_fan ? 2 * i + 1 : 3 * i + 1;
        triangles[i][2] = is_fan ? 2 * i + 2 : 3 * i + 2;
    }
}

static void put_vertex(const struct hog *hog, struct prng *prng, uint32_t i, float x[3])
{
    static const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (int k = 0; k < 3; k++) {
        if (hog->kind == HOG_COINCIDENT) {
            x[k] = corners[i % 3][k];
        } else if (hog->kind == HOG_FAN) {
            float angle = 6.2831853f * (float)((i + 1) / 2) / (float)hog->triangles;
            const float way[3] = {cosf(angle), sinf(angle), i % 2 == 0 ? 1.f : -1.f};
            x[k] = i == 0 ? 0 : way[k];
        } else {
            x[k] = (float)(prng_below(prng, 1u << 20));
        }
    }
}

static void put_vertices(const struct hog *hog, float (*x)[3], float height)
{
    struct prng prng = {hog->triangles};
    for (uint32_t i = 0; i < vertices_of(hog); i++) {
        put_vertex(hog, &prng, i, x[i]);
        x[i][2] += height;
    }
}

/* Vertices and triangles, without the commit. */
static bool fill(struct hog *hog)
{
    uint32_t count = vertices_of(hog);
    struct proto_MESH_CREATE_result created;
    float(*x)[3] = malloc(count * sizeof *x);
    uint32_t(*triangles)[3] = malloc(hog->triangles * sizeof *triangles);
    bool worked = x != NULL && triangles != NULL &&
                  RAW_CALL(&hog->raw, MESH_CREATE, &created, .vertex_count = count,
                           .triangle_count = hog->triangles) == 0;
    if (worked) {
        put_vertices(hog, x, 0);
        put_triangles(hog, triangles);
        hog->mesh = created.mesh;
        worked =
            test_raw_fill(&hog->raw, hog->mesh, x, count, triangles, hog->triangles) == 0;
    }
    free(x);
    free(triangles);
    return worked;
}

static bool commit(struct hog *hog)
{
    return RAW_CALL(&hog->raw, MESH_COMMIT, NULL, .mesh = hog->mesh) == 0;
}

static bool add(struct hog *hog)
{
    return test_raw_add(&hog->raw, hog->scene, hog->mesh, &hog->object) == 0;
}

bool test_hog_open(struct hog *hog, const char *socket, enum hog_kind kind,
                   uint32_t triangles)
{
    hog->kind = kind;
    hog->triangles = triangles;
    hog->id = 0;
    hog->deadline_ns = 0;
    test_raw_wait_ms = WAIT_MS;
    return test_raw_session(&hog->raw, socket, 2, SEGMENT_ROOM + 36ull * triangles) ==
               0 &&
           test_raw_scene(&hog->raw, "", &hog->scene) == 0 && fill(hog) &&
           (kind == HOG_COMMIT || commit(hog)) && (kind == HOG_COMMIT || add(hog));
}

/* A step that moves all of it up by 1/8. */
static uint32_t submit(struct hog *hog)
{
    const struct proto_segment segment = {.object = hog->object,
                                          .kind = PROTO_SEGMENT_X1,
                                          .count = vertices_of(hog),
                                          .offset1 = SEGMENT_ROOM};
    uint8_t *payload = test_raw_payload(&hog->raw, 0);
    memcpy(payload, &segment, sizeof segment);
    put_vertices(hog, (float(*)[3])(void *)(payload + SEGMENT_ROOM), 0.125f);
    struct proto_FRAME_SUBMIT_request request = {.scene = hog->scene, .segments = 1};
    request.seq = test_raw_publish(&hog->raw, 0);
    request.deadline_ns = hog->deadline_ns;
    return test_raw_request(&hog->raw, PROTO_METHOD_FRAME_SUBMIT, &request);
}

bool test_hog_begin(struct hog *hog)
{
    hog->id = hog->kind == HOG_COMMIT
                  ? RAW_SEND(&hog->raw, MESH_COMMIT, .mesh = hog->mesh)
                  : submit(hog);
    return hog->id != 0;
}

int test_hog_end(struct hog *hog, struct proto_FRAME_SUBMIT_result *answer)
{
    uint32_t id = hog->id;
    hog->id = 0;
    return hog->kind == HOG_COMMIT
               ? test_raw_answer(&hog->raw, id, PROTO_METHOD_MESH_COMMIT, NULL)
               : test_raw_answer(&hog->raw, id, PROTO_METHOD_FRAME_SUBMIT, answer);
}

bool test_hog_again(struct hog *hog)
{
    return hog->kind != HOG_COMMIT ||
           (RAW_CALL(&hog->raw, MESH_DESTROY, NULL, .mesh = hog->mesh) == 0 && fill(hog));
}

void test_hog_close(struct hog *hog)
{
    test_raw_close(&hog->raw);
}
