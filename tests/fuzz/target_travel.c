/* target_travel.c - small objects that drive, jump and shrink, anywhere.
 *
 * Keep a scene over some steps in which its objects go as the input says, at any distance
 * from the origin and from each other, at any scale. Each answer is compared with a scene
 * made anew, by the other method, and with brute force in exact arithmetic.
 */
#include <math.h>
#include <string.h>

#include "fuzz_scene.h"
#include "fuzz_target.h"
#include "memory.h"
#include "step.h"

#define OBJECTS_MAX 5u
#define VERTICES    5u /* of a strip of three triangles */
#define TRIANGLES   3u
#define STEPS_MAX   4u

static const uint32_t strip[TRIANGLES][3] = {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}};

struct tour {
    struct eng_scene *scene;
    uint32_t objects[OBJECTS_MAX];
    uint32_t count;
    double scale;
    double x0[OBJECTS_MAX][VERTICES][3];
    double x1[OBJECTS_MAX][VERTICES][3];
};

static bool is_refusal(int status)
{
    FUZZ_CHECK(status == PCCD_OK || fuzz_scarcity_hits() > 0);
    return status != PCCD_OK;
}

/* 0, or a power of two up to 2^59 of either sign. */
static double take_distance(struct fuzz_input *input)
{
    uint8_t byte = fuzz_take_u8(input);
    double distance = ldexp(1, byte % 64 < 60 ? byte % 64 : 0);
    return byte % 64 == 63 ? 0 : byte >= 128 ? -distance : distance;
}

static void take_shape(struct fuzz_input *input, double scale, double (*x)[3])
{
    for (uint32_t i = 0; i < 3 * VERTICES; i++) {
        x[i / 3][i % 3] = scale * ((int8_t)fuzz_take_u8(input) / 16.0);
    }
}

static int add_object(struct eng_scene *scene, const double (*x)[3], uint32_t id,
                      uint32_t *object)
{
    struct eng_mesh *mesh = NULL;
    uint32_t bad;
    int status = eng_mesh_new(VERTICES, TRIANGLES, &mesh);
    if (status == PCCD_OK) {
        status = eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, VERTICES, x);
    }
    if (status == PCCD_OK) {
        status = eng_mesh_write_triangles(mesh, 0, TRIANGLES, strip, &bad);
    }
    if (status == PCCD_OK) {
        status = eng_mesh_commit(mesh, 1);
    }
    if (status == PCCD_OK) {
        status = eng_scene_add(scene, mesh, id, object);
    }
    eng_mesh_release(mesh);
    return status;
}

/* Move an object to where it is at the end of the next step; some of its vertices may
 * stay. */
static void move_object(struct fuzz_input *input, struct tour *tour, uint32_t i,
                        uint32_t *first, uint32_t *count)
{
    uint8_t how = fuzz_take_u8(input);
    double by[3] = {0, 0, 0};
    *first = how % 4 == 3 ? how / 4 % VERTICES : 0;
    *count = how % 4 == 0 ? 0 : how % 4 == 3 ? 1 : VERTICES;
    for (int k = 0; k < 3 && how % 4 == 2; k++) {
        by[k] = tour->scale * take_distance(input);
    }
    for (uint32_t v = *first; v < *first + *count; v++) {
        for (int k = 0; k < 3; k++) {
            double shake = (int8_t)fuzz_take_u8(input) / 16.0;
            double x = tour->x0[i][v][k] + by[k] + tour->scale * shake;
            tour->x1[i][v][k] = fabs(x) <= PROTO_COORDINATE_MAX ? x : tour->x0[i][v][k];
        }
    }
}

static int step(struct eng_scene *scene, enum pccd_method method, enum pccd_mode mode,
                struct eng_step_result *result)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.method = method;
    settings.mode = mode;
    return eng_step(scene, &settings, result);
}

/* The same step of a scene made anew. */
static int step_fresh(const struct tour *tour, enum pccd_method method,
                      enum pccd_mode mode, struct eng_scene **scene,
                      struct eng_step_result *result)
{
    int status = eng_scene_new(NULL, scene);
    uint32_t objects[OBJECTS_MAX];
    for (uint32_t i = 0; i < tour->count && status == PCCD_OK; i++) {
        status = add_object(*scene, (const double(*)[3])tour->x0[i], i, &objects[i]);
    }
    if (status == PCCD_OK) {
        eng_stage_begin(*scene);
    }
    for (uint32_t i = 0; i < tour->count && status == PCCD_OK; i++) {
        status =
            eng_stage_x1(*scene, objects[i], PCCD_FORMAT_F64, 0, VERTICES, tour->x1[i]);
    }
    return status == PCCD_OK ? step(*scene, method, mode, result) : status;
}

static void check_contacts(const struct eng_step_result *result,
                           const struct fuzz_scene_truth *truth)
{
    const struct pccd_contact *found = result->records;
    FUZZ_CHECK(result->count == truth->count);
    for (size_t i = 0; i < truth->count; i++) {
        const uint32_t *name = truth->contacts[i];
        FUZZ_CHECK(found[i].kind == name[0] && found[i].object_a == name[1] &&
                   found[i].feature_a == name[2] && found[i].object_b == name[3] &&
                   found[i].feature_b == name[4]);
    }
}

/* One step of the scene that stays; returns whether it was answered. */
static bool drive(struct fuzz_input *input, struct tour *tour, enum pccd_method method)
{
    struct eng_step_result resident;
    struct eng_step_result fresh;
    struct eng_scene *scene = NULL;
    struct fuzz_scene_truth truth;
    enum pccd_method other =
        method == PCCD_METHOD_WIDE ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE;
    int status = PCCD_OK;
    eng_stage_begin(tour->scene);
    memcpy(tour->x1, tour->x0, sizeof tour->x1);
    for (uint32_t i = 0; i < tour->count && status == PCCD_OK; i++) {
        uint32_t first;
        uint32_t count;
        move_object(input, tour, i, &first, &count);
        if (count > 0) {
            status = eng_stage_x1(tour->scene, tour->objects[i], PCCD_FORMAT_F64, first,
                                  count, tour->x1[i] + first);
        }
    }
    if (is_refusal(status) ||
        is_refusal(step(tour->scene, method, PCCD_MODE_ALL, &resident)) ||
        resident.incomplete != PCCD_COMPLETE) {
        return false;
    }
    fuzz_scarcity_pause();
    const struct fuzz_scene scene_now = {tour->count,
                                         VERTICES,
                                         TRIANGLES,
                                         strip,
                                         (const double(*)[3])tour->x0[0],
                                         (const double(*)[3])tour->x1[0]};
    fuzz_scene_find(&scene_now, &truth);
    check_contacts(&resident, &truth);
    FUZZ_CHECK(step_fresh(tour, other, PCCD_MODE_PAIRS, &scene, &fresh) == PCCD_OK);
    FUZZ_CHECK(fresh.count == truth.beside);
    eng_scene_free(scene);
    FUZZ_CHECK(step_fresh(tour, other, PCCD_MODE_ALL, &scene, &fresh) == PCCD_OK);
    FUZZ_CHECK(fresh.hash[0] == resident.hash[0] && fresh.hash[1] == resident.hash[1]);
    eng_scene_free(scene);
    fuzz_scene_forget(&truth);
    fuzz_scarcity_resume();
    memcpy(tour->x0, tour->x1, sizeof tour->x0);
    return true;
}

void fuzz_travel(const uint8_t *data, size_t bytes)
{
    static struct tour tour;
    struct fuzz_input input = {data, bytes};
    uint64_t bytes_before = eng_alloc_bytes();
    uint8_t choices = fuzz_take_u8(&input);
    int exponent = (int8_t)fuzz_take_u8(&input) * 4;
    memset(&tour, 0, sizeof tour);
    tour.count = choices % (OBJECTS_MAX - 1) + 2;
    tour.scale = ldexp(1, exponent < 50 ? exponent : 0); /* 2^-512 and more */
    bool goes_on = !is_refusal(eng_scene_new(NULL, &tour.scene));
    for (uint32_t i = 0; i < tour.count && goes_on; i++) {
        take_shape(&input, tour.scale, tour.x0[i]);
        goes_on = !is_refusal(
            add_object(tour.scene, (const double(*)[3])tour.x0[i], i, &tour.objects[i]));
    }
    for (uint32_t i = 0; i < choices / 4 % STEPS_MAX + 1 && goes_on; i++) {
        goes_on = drive(&input, &tour,
                        choices / 16 >> i & 1 ? PCCD_METHOD_PAPER : PCCD_METHOD_WIDE);
    }
    eng_scene_free(tour.scene);
    FUZZ_CHECK(eng_alloc_bytes() == bytes_before);
}
