/* rays.c - rays, spheres and capsules that are cast.
 *
 * All are one object: piece k of ray i is its point, or its edge, k * count + i. A step
 * moves the pieces of a way at once, each from where the one before it ends.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "kinds.h"
#include "rounding.h"
#include "step.h"

#define PIECES 8u /* by default */

struct pccd_rays {
    uint32_t scene;
    uint32_t count, ends, pieces;
    uint64_t group, mask;
    double *radii;   /* [count], or NULL; kept until they are registered */
    uint32_t mesh;   /* 0: not yet registered */
    uint32_t object; /* 0: not yet added */
    bool is_set;     /* the object has its group, its mask, and does not meet itself */
};

/* ---- what they are ----------------------------------------------------------------- */

static int check(struct pccd_client *client, const struct pccd_rays_settings *settings,
                 uint32_t pieces)
{
    if (settings->count == 0) {
        return cli_fail(client, PCCD_E_INVAL, "rays: count is 0");
    }
    if (settings->ends > 2) {
        return cli_fail(client, PCCD_E_INVAL, "rays: ends is %" PRIu32 ", not 1 or 2",
                        settings->ends);
    }
    if ((uint64_t)settings->count * pieces > UINT32_MAX / 2) {
        return cli_fail(client, PCCD_E_LIMIT,
                        "rays: %" PRIu32 " in %" PRIu32
                        " pieces each are more than a mesh may have",
                        settings->count, pieces);
    }
    for (uint32_t i = 0; settings->radii != NULL && i < settings->count; i++) {
        double radius = settings->radii[i];
        if (!(radius >= 0 && radius <= PROTO_COORDINATE_MAX)) {
            return cli_fail(client, radius > 0 ? PCCD_E_LIMIT : PCCD_E_INVAL,
                            "rays: the radius of ray %" PRIu32
                            " is %.17g, not 0 to 1e18",
                            i, radius);
        }
    }
    return 0;
}

int pccd_rays_begin(struct pccd_client *client, uint32_t scene,
                    const struct pccd_rays_settings *settings, struct pccd_rays **rays)
{
    struct pccd_rays_settings known = PCCD_RAYS_SETTINGS_INIT;

    CLI_ENTER_OR_RETURN(client);
    if (settings == NULL || rays == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "rays: %s is NULL",
                        settings == NULL ? "settings" : "rays");
    }
    int status =
        cli_struct_read(client, "settings of rays", settings, &known, sizeof known);
    uint32_t pieces = known.pieces != 0 ? known.pieces : PIECES;
    status = status != 0 ? status : check(client, &known, pieces);
    if (status != 0) {
        return status;
    }
    struct pccd_rays *made = malloc(sizeof *made);
    size_t bytes = known.radii != NULL ? known.count * sizeof *known.radii : 0;
    double *radii = bytes > 0 ? malloc(bytes) : NULL;
    if (made == NULL || (bytes > 0 && radii == NULL)) {
        free(made);
        free(radii);
        return cli_fail(client, PCCD_E_NOMEM, "no memory for %" PRIu32 " rays",
                        known.count);
    }
    if (bytes > 0) {
        memcpy(radii, known.radii, bytes);
    }
    *made = (struct pccd_rays){.scene = scene,
                               .count = known.count,
                               .ends = known.ends == 2 ? 2 : 1,
                               .pieces = pieces,
                               .group = known.group != 0 ? known.group : 1,
                               .mask = known.mask != 0 ? known.mask : UINT64_MAX,
                               .radii = radii};
    *rays = made;
    return 0;
}

void pccd_rays_end(struct pccd_client *client, struct pccd_rays *rays)
{
    if (rays == NULL) {
        return;
    }
    if (client != NULL && rays->object != 0) {
        (void)pccd_scene_remove(client, rays->scene, rays->object);
    }
    if (client != NULL && rays->mesh != 0) {
        (void)pccd_mesh_destroy(client, rays->mesh);
    }
    free(rays->radii);
    free(rays);
}

/* ---- where they go ----------------------------------------------------------------- */

static uint32_t vertex_count(const struct pccd_rays *rays)
{
    return rays->count * rays->ends;
}

/* Write where all pieces begin; and where they end, unless x1 is NULL. */
static void write_ways(const struct pccd_rays *rays, const double *begin,
                       const double *end, double *x0, double *x1)
{
    size_t numbers = (size_t)vertex_count(rays) * 3;

    COMMON_ROUNDING_HERE;
    for (uint32_t piece = 0; piece < rays->pieces; piece++) {
        double part = (double)piece / (double)rays->pieces;
        double *from = x0 + piece * numbers;
        for (size_t i = 0; i < numbers; i++) {
            from[i] = begin[i] + (end[i] - begin[i]) * part;
        }
        if (x1 != NULL && piece > 0) {
            memcpy(x1 + (piece - 1) * numbers, from, numbers * sizeof *x1);
        }
    }
    if (x1 != NULL) {
        memcpy(x1 + (rays->pieces - 1) * numbers, end, numbers * sizeof *x1);
    }
}

/* Register the mesh of all pieces where they begin. */
static int put_mesh(struct pccd_client *client, struct pccd_rays *rays,
                    const double *begin, const double *end)
{
    size_t count = (size_t)rays->pieces * vertex_count(rays);
    double *x = malloc(count * 3 * sizeof *x);
    double *radii = malloc(count * sizeof *radii);
    uint32_t *numbers = malloc(count * sizeof *numbers);
    int status;

    if (x == NULL || radii == NULL || numbers == NULL) {
        status =
            cli_fail(client, PCCD_E_NOMEM, "no memory for %zu vertices of rays", count);
    } else {
        write_ways(rays, begin, end, x, NULL);
        for (size_t i = 0; i < count; i++) {
            numbers[i] = (uint32_t)i;
            radii[i] =
                rays->radii != NULL ? rays->radii[i / rays->ends % rays->count] : 0;
        }
        struct pccd_mesh_data data = {.struct_bytes = sizeof data,
                                      .x = x,
                                      .format = PCCD_FORMAT_F64,
                                      .vertex_count = (uint32_t)count,
                                      .radii = rays->radii != NULL ? radii : NULL};
        if (rays->ends == 2) {
            data.edges = numbers;
            data.edge_count = (uint32_t)(count / 2);
        } else {
            data.points = numbers;
            data.point_count = (uint32_t)count;
        }
        status = pccd_mesh_put(client, &data, &rays->mesh, NULL);
    }
    free(x);
    free(radii);
    free(numbers);
    return status;
}

/* Register them by their first cast: what is registered near each other is searched
 * together. What has failed is tried again by the next one. */
static int enter(struct pccd_client *client, struct pccd_rays *rays, const double *begin,
                 const double *end)
{
    struct pccd_object_settings object = {.struct_bytes = sizeof object,
                                          .what = PCCD_OBJECT_SELF | PCCD_OBJECT_GROUP |
                                                  PCCD_OBJECT_MASK,
                                          .group = rays->group,
                                          .mask = rays->mask};
    int status = rays->mesh != 0 ? 0 : put_mesh(client, rays, begin, end);

    if (status == 0 && rays->object == 0) {
        status = pccd_scene_add(client, rays->scene, rays->mesh, &rays->object);
    }
    if (status == 0) {
        status = pccd_object_set(client, rays->scene, rays->object, &object);
        rays->is_set = status == 0;
    }
    return status;
}

/* ---- what they meet ---------------------------------------------------------------- */

/* Take one record for the hit of its ray, if it is of one and none is earlier. */
static void take(const struct pccd_rays *rays, const double *begin, const double *end,
                 const struct pccd_contact *contact, struct pccd_ray_hit *hits)
{
    bool is_a = contact->object_a == rays->object;
    if (!is_a && contact->object_b != rays->object) {
        return;
    }
    uint32_t own = is_a ? 0 : 1;
    const uint32_t *points = common_kinds[contact->kind].points;
    uint32_t feature = is_a ? contact->feature_a : contact->feature_b;
    uint32_t unit = points[own] == 1 ? feature / rays->ends : feature;
    uint32_t ray = unit % rays->count;
    double t = (unit / rays->count + contact->toi) / rays->pieces;
    struct pccd_ray_hit *hit = &hits[ray];
    if (!(t < hit->t)) {
        return;
    }
    double weights[2][3];
    common_contact_weights((enum pccd_kind)contact->kind, contact->param, weights);
    *hit =
        (struct pccd_ray_hit){.t = t,
                              .object = is_a ? contact->object_b : contact->object_a,
                              .feature = is_a ? contact->feature_b : contact->feature_a,
                              .points = points[1 - own]};
    memcpy(hit->weights, weights[1 - own], sizeof hit->weights);
    uint32_t first = points[own] == 1 ? feature % (rays->count * rays->ends) : 2 * ray;
    for (uint32_t i = 0; i < points[own]; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            size_t at = (size_t)(first + i) * 3 + k;
            hit->point[k] += weights[own][i] * (begin[at] + t * (end[at] - begin[at]));
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        float normal = contact->normal[k];
        hit->normal[k] = is_a || normal == 0 ? normal : -normal;
    }
}

/* Take all records of the answer to `step`, page by page. */
static int take_all(struct pccd_client *client, const struct pccd_rays *rays,
                    uint64_t step, const double *begin, const double *end,
                    struct pccd_ray_hit *hits)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status = cli_answer_finish(client, step, false, &answer);

    while (status == 0) {
        uint64_t cursor = answer.cursor;
        bool has_more = cursor < answer.total;
        if (answer.incomplete != PCCD_COMPLETE &&
            answer.incomplete != PCCD_INCOMPLETE_RESULT_FULL) {
            status = cli_fail(client, PCCD_E_LIMIT,
                              "cast: the answer is cut short, by %s; it has %" PRIu64
                              " records",
                              answer.incomplete == PCCD_INCOMPLETE_CONTACT_LIMIT
                                  ? "the number of records that the daemon keeps"
                                  : "its deadline",
                              answer.total);
        }
        COMMON_ROUNDING_HERE;
        for (uint64_t i = 0; status == 0 && i < answer.count; i++) {
            take(rays, begin, end, &answer.contacts[i], hits);
        }
        pccd_answer_release(client, &answer);
        if (status != 0 || !has_more) {
            break;
        }
        answer = (struct pccd_answer)PCCD_ANSWER_INIT;
        status = pccd_fetch(client, rays->scene, step, cursor, &answer);
    }
    return status;
}

static int check_cast(struct pccd_client *client, const struct pccd_rays *rays,
                      const double *begin, const double *end,
                      const struct pccd_step_settings *settings,
                      const struct pccd_ray_hit *hits)
{
    struct pccd_step_settings known = PCCD_STEP_SETTINGS_INIT;

    if (rays == NULL || begin == NULL || end == NULL || hits == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "cast: %s is NULL",
                        rays == NULL    ? "rays"
                        : begin == NULL ? "begin"
                        : end == NULL   ? "end"
                                        : "hits");
    }
    int status = settings == NULL ? 0
                                  : cli_struct_read(client, "settings of the step",
                                                    settings, &known, sizeof known);
    const char *what = known.mode != PCCD_MODE_ALL ? "mode"
                       : known.approach != 0       ? "approach"
                       : known.hold                ? "hold"
                       : known.joint_count != 0    ? "joints"
                                                   : NULL;
    if (status == 0 && what != NULL) {
        status = cli_fail(client, PCCD_E_INVAL, "cast: its settings have %s", what);
    }
    for (int i = 0; i < 2 && status == 0; i++) {
        uint32_t stray = (uint32_t)common_first_stray(
            i == 0 ? begin : end, PCCD_FORMAT_F64, vertex_count(rays));
        if (stray < vertex_count(rays)) {
            status = cli_fail(client, PCCD_E_NOTFINITE,
                              "cast: the %s of ray %" PRIu32
                              " has a coordinate that is not finite or beyond 1e18",
                              i == 0 ? "begin" : "end", stray / rays->ends);
        }
    }
    return status;
}

int pccd_rays_cast(struct pccd_client *client, struct pccd_rays *rays,
                   const double *begin, const double *end,
                   const struct pccd_step_settings *settings, struct pccd_ray_hit *hits)
{
    struct pccd_frame frame;
    void *x0 = NULL;
    void *x1 = NULL;
    uint64_t step = 0;

    CLI_ENTER_OR_RETURN(client);
    int status = check_cast(client, rays, begin, end, settings, hits);
    if (status == 0 && !rays->is_set) {
        status = enter(client, rays, begin, end);
    }
    if (status != 0) {
        return status;
    }
    uint32_t vertices = rays->pieces * vertex_count(rays);
    status = pccd_frame_begin(client, rays->scene, 1, (uint64_t)vertices * 48, &frame);
    if (status != 0) {
        return status;
    }
    status =
        pccd_frame_x0x1(&frame, rays->object, PCCD_FORMAT_F64, 0, vertices, &x0, &x1);
    if (status != 0) {
        pccd_frame_abort(&frame);
        return status;
    }
    write_ways(rays, begin, end, x0, x1);
    status = pccd_frame_commit(&frame, settings, &step);
    for (uint32_t i = 0; i < rays->count; i++) {
        hits[i] = (struct pccd_ray_hit){.t = INFINITY};
    }
    return status != 0 ? status : take_all(client, rays, step, begin, end, hits);
}
