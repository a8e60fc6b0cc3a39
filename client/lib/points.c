/* points.c - vertices, weights and places of the features of records. */
#include "points.h"

#include <inttypes.h>
#include <stddef.h>
#include <string.h>

#include "client.h"
#include "kinds.h"

int cli_records_check(const struct cli_records *records, const char *what)
{
    if ((records->bodies == NULL && records->body_count > 0) ||
        (records->contacts == NULL && records->near == NULL && records->count > 0)) {
        return cli_fail(NULL, PCCD_E_INVAL, "%s: bodies or records are NULL", what);
    }
    for (uint32_t i = 1; i < records->body_count; i++) {
        if (records->bodies[i].object <= records->bodies[i - 1].object) {
            return cli_fail(NULL, PCCD_E_INVAL,
                            "%s: body %" PRIu32 " does not come after the one before",
                            what, i);
        }
    }
    for (uint32_t i = 0; i < records->body_count; i++) {
        if ((records->bodies[i].m0 == NULL) != (records->bodies[i].m1 == NULL)) {
            return cli_fail(NULL, PCCD_E_INVAL,
                            "%s: body %" PRIu32 " has one of m0 and m1", what, i);
        }
    }
    return records->t >= 0 && records->t <= 1
               ? PCCD_OK
               : cli_fail(NULL, PCCD_E_INVAL, "%s: t is %g, not 0 .. 1", what,
                          records->t);
}

static const struct pccd_body *find_body(const struct cli_records *records,
                                         uint32_t object)
{
    uint32_t low = 0, high = records->body_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (records->bodies[middle].object < object) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < records->body_count && records->bodies[low].object == object
               ? &records->bodies[low]
               : NULL;
}

/* The vertices of a feature of so many points. False: there is no such feature. */
static bool find_vertices(const struct pccd_body *body, uint32_t points, uint32_t feature,
                          uint32_t vertex[3])
{
    if (points == 1) {
        vertex[0] = feature;
    } else if (points == 2) {
        if (feature >= body->edge_count || body->edges == NULL) {
            return false;
        }
        vertex[0] = body->edges[feature].a;
        vertex[1] = body->edges[feature].b;
    } else {
        if (feature >= body->triangle_count || body->triangles == NULL) {
            return false;
        }
        memcpy(vertex, body->triangles + 3 * (size_t)feature, 3 * sizeof *vertex);
    }
    for (uint32_t i = 0; i < points; i++) {
        if (vertex[i] >= body->vertex_count) {
            return false;
        }
    }
    return true;
}

/* Either kind of record has these at the same place. */
static_assert(offsetof(struct pccd_near, kind) == offsetof(struct pccd_contact, kind) &&
                  offsetof(struct pccd_near, object_a) ==
                      offsetof(struct pccd_contact, object_a) &&
                  offsetof(struct pccd_near, feature_b) ==
                      offsetof(struct pccd_contact, feature_b) &&
                  offsetof(struct pccd_near, param) ==
                      offsetof(struct pccd_contact, param) &&
                  offsetof(struct pccd_near, direction) ==
                      offsetof(struct pccd_contact, normal) &&
                  sizeof(struct pccd_near) == sizeof(struct pccd_contact),
              "a record of either kind");

int cli_feature_pair_find(const struct cli_records *records, uint64_t i,
                          struct cli_feature_pair *pair)
{
    struct pccd_contact is;
    memcpy(&is, records->near != NULL ? (const void *)&records->near[i]
                                      : (const void *)&records->contacts[i],
           sizeof is);
    const uint32_t objects[2] = {is.object_a, is.object_b};
    const uint32_t features[2] = {is.feature_a, is.feature_b};
    if (is.kind >= COMMON_KIND_COUNT) {
        return cli_fail(NULL, PCCD_E_INVAL, "record %" PRIu64 " is of kind %" PRIu32, i,
                        is.kind);
    }
    *pair = (struct cli_feature_pair){
        .kind = is.kind,
        .t = records->near != NULL ? records->t : is.toi,
        .distance = records->near != NULL ? records->near[i].d_lo : 0};
    memcpy(pair->normal, is.normal, sizeof pair->normal);
    for (int side = 0; side < 2; side++) {
        pair->object[side] = objects[side];
        pair->points[side] = common_kinds[is.kind].points[side];
        pair->body[side] = find_body(records, objects[side]);
        if (pair->body[side] == NULL) {
            return cli_fail(NULL, PCCD_E_HANDLE,
                            "record %" PRIu64 ": no body is object 0x%" PRIx32, i,
                            objects[side]);
        }
        if (!find_vertices(pair->body[side], pair->points[side], features[side],
                           pair->vertex[side])) {
            return cli_fail(NULL, PCCD_E_INDEX,
                            "record %" PRIu64 ": object 0x%" PRIx32 " has no %s %" PRIu32
                            ", or it names no vertex",
                            i, objects[side],
                            common_feature_names[pair->points[side]], features[side]);
        }
    }
    if (is.kind == PCCD_EF) {
        pair->points[1] = 0;
        pair->weight[0][0] = 1 - (double)is.param[0];
        pair->weight[0][1] = (double)is.param[0];
    } else {
        common_contact_weights((enum pccd_kind)is.kind, is.param, pair->weight);
    }
    return PCCD_OK;
}

/* A vertex at one end: moved by `m`, or as it is. */
static void place(const double x[3], const double *m, double at[3])
{
    for (int k = 0; k < 3; k++) {
        at[k] = m == NULL ? x[k]
                          : ((m[4 * k] * x[0] + m[4 * k + 1] * x[1]) +
                             m[4 * k + 2] * x[2]) +
                                m[4 * k + 3];
    }
}

/* A vertex at time t. */
static void move(const struct pccd_body *body, uint32_t vertex, double t, double x[3])
{
    double to[3];
    place(body->x0 + 3 * (size_t)vertex, body->m0, x);
    if (body->x1 == NULL && body->m1 == NULL) {
        return;
    }
    place((body->m1 != NULL ? body->x0 : body->x1) + 3 * (size_t)vertex, body->m1, to);
    for (int k = 0; k < 3; k++) {
        x[k] += t * (to[k] - x[k]);
    }
}

void cli_feature_pair_points(const struct cli_feature_pair *pair, double points[2][3])
{
    for (int side = 0; side < 2; side++) {
        double sum[3] = {0, 0, 0};
        for (uint32_t i = 0; i < pair->points[side]; i++) {
            double x[3];
            move(pair->body[side], pair->vertex[side][i], pair->t, x);
            for (int k = 0; k < 3; k++) {
                sum[k] += pair->weight[side][i] * x[k];
            }
        }
        memcpy(points[side], sum, sizeof sum);
    }
    if (pair->kind == PCCD_EF) {
        memcpy(points[1], points[0], sizeof points[0]);
    }
}

/* ---- stencils ---------------------------------------------------------------------- */

static void write_stencil(const struct cli_feature_pair *pair, uint32_t *vertices,
                          double *weights)
{
    uint32_t last = 0;
    uint32_t n = 0;
    for (int side = 0; side < 2; side++) {
        for (uint32_t i = 0; i < pair->points[side]; i++, n++) {
            last = pair->body[side]->first + pair->vertex[side][i];
            if (vertices != NULL) {
                vertices[n] = last;
            }
            if (weights != NULL) {
                double weight = pair->weight[side][i];
                weights[n] = side == 0 ? weight : -weight;
            }
        }
    }
    for (; n < 4; n++) {
        if (vertices != NULL) {
            vertices[n] = last;
        }
        if (weights != NULL) {
            weights[n] = 0;
        }
    }
}

static int write_stencils(const struct cli_records *records, const char *what,
                          uint32_t (*vertices)[4], double (*weights)[4])
{
    struct cli_feature_pair pair;
    int status = cli_records_check(records, what);
    for (uint64_t i = 0; i < records->count && status == PCCD_OK; i++) {
        status = cli_feature_pair_find(records, i, &pair);
        if (status == PCCD_OK) {
            write_stencil(&pair, vertices != NULL ? vertices[i] : NULL,
                          weights != NULL ? weights[i] : NULL);
        }
    }
    return status;
}

int pccd_stencils(const struct pccd_body *bodies, uint32_t body_count,
                  const struct pccd_contact *contacts, uint64_t count,
                  uint32_t (*vertices)[4], double (*weights)[4])
{
    const struct cli_records records = {
        .bodies = bodies, .body_count = body_count, .contacts = contacts, .count = count};
    return write_stencils(&records, "stencils", vertices, weights);
}

int pccd_near_stencils(const struct pccd_body *bodies, uint32_t body_count,
                       const struct pccd_near *near, uint64_t count,
                       uint32_t (*vertices)[4], double (*weights)[4])
{
    const struct cli_records records = {
        .bodies = bodies, .body_count = body_count, .near = near, .count = count};
    return write_stencils(&records, "near_stencils", vertices, weights);
}

/* ---- points ------------------------------------------------------------------------ */

int cli_records_check_positions(const struct cli_records *records, const char *what)
{
    int status = cli_records_check(records, what);
    for (uint32_t i = 0; i < records->body_count && status == PCCD_OK; i++) {
        const struct pccd_body *body = &records->bodies[i];
        if (body->x0 == NULL && body->vertex_count > 0) {
            status = cli_fail(NULL, PCCD_E_INVAL, "%s: x0 of body %" PRIu32 " is NULL",
                              what, i);
        }
    }
    return status;
}

static int write_points(const struct cli_records *records, const char *what,
                        double (*points)[2][3])
{
    struct cli_feature_pair pair;
    int status = cli_records_check_positions(records, what);
    if (status == PCCD_OK && points == NULL && records->count > 0) {
        status = cli_fail(NULL, PCCD_E_INVAL, "%s: points is NULL", what);
    }
    for (uint64_t i = 0; i < records->count && status == PCCD_OK; i++) {
        status = cli_feature_pair_find(records, i, &pair);
        if (status == PCCD_OK) {
            cli_feature_pair_points(&pair, points[i]);
        }
    }
    return status;
}

int pccd_points(const struct pccd_body *bodies, uint32_t body_count,
                const struct pccd_contact *contacts, uint64_t count,
                double (*points)[2][3])
{
    const struct cli_records records = {
        .bodies = bodies, .body_count = body_count, .contacts = contacts, .count = count};
    return write_points(&records, "points", points);
}

int pccd_near_points(const struct pccd_body *bodies, uint32_t body_count,
                     const struct pccd_near *near, uint64_t count, double t,
                     double (*points)[2][3])
{
    const struct cli_records records = {
        .bodies = bodies, .body_count = body_count, .near = near, .count = count, .t = t};
    return write_points(&records, "near_points", points);
}
