/* vtp.c - a step as VTK XML PolyData.
 *
 * Points: vertices of all objects, then contacts, then ends of lines; cells: contacts and
 * points as vertices, lines and rods as lines, then triangles; arrays in base64, as text
 * is rounded.
 */
#include "export.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base64.h"

#define TOI_NONE  2.0f           /* of a feature: later than any contact */
#define KIND_NONE PCCD_KINDS_MAX /* of a feature: no kind of contact */

/* Everything that is written, in the order of points and cells. */
struct vtp {
    const struct snapshot *snapshot;
    FILE *to;
    uint64_t vertices, triangles, contacts, lines;
    uint64_t rods, points; /* edges, and points, that nothing else has */
    uint64_t *bytes;       /* of the array below: VTK wants both in one piece of base64 */
    void *scratch;         /* an array: 24 bytes for each point or cell */
    bool is_ok;
};

static void put_array(struct vtp *vtp, const char *type, const char *name,
                      unsigned components, uint64_t bytes)
{
    fprintf(vtp->to,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" "
            "format=\"binary\">",
            type, name, components);
    *vtp->bytes = bytes;
    vtp->is_ok =
        vtp->is_ok && base64_write(vtp->bytes, sizeof *vtp->bytes + bytes, vtp->to);
    fputs("</DataArray>\n", vtp->to);
}

/* In place, from the end: where the scene is, which no float tells. */
static void widen(struct vtp *vtp, uint64_t count)
{
    uint8_t *bytes = vtp->scratch;
    for (uint64_t i = count; i-- > 0;) {
        float x[3];
        double wide[3];
        memcpy(x, bytes + i * sizeof x, sizeof x);
        for (int k = 0; k < 3; k++) {
            wide[k] = (double)x[k] + vtp->snapshot->origin[k];
        }
        memcpy(bytes + i * sizeof wide, wide, sizeof wide);
    }
}

static uint64_t point_count(const struct vtp *vtp)
{
    return vtp->vertices + vtp->contacts + 2 * vtp->lines;
}

/* There are contacts, or lines, never both. */
static uint64_t cell_count(const struct vtp *vtp)
{
    return vtp->contacts + vtp->points + vtp->lines + vtp->rods + vtp->triangles;
}

static void put_points(struct vtp *vtp)
{
    float(*x)[3] = vtp->scratch;
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        const struct snapshot_object *object = &vtp->snapshot->objects[o];
        memcpy(x, object->x, object->vertex_count * sizeof *x);
        x += object->vertex_count;
    }
    for (uint64_t i = 0; i < vtp->contacts; i++) {
        memcpy(x[i], vtp->snapshot->contacts[i].at, sizeof *x);
    }
    for (uint64_t i = 0; i < vtp->lines; i++) {
        memcpy(x[vtp->contacts + 2 * i], vtp->snapshot->lines[i].ends, 2 * sizeof *x);
    }
    fputs("<Points>\n", vtp->to);
    uint64_t count = point_count(vtp);
    if (vtp->snapshot->has_origin) {
        widen(vtp, count);
        put_array(vtp, "Float64", "Points", 3, count * sizeof(double[3]));
    } else {
        put_array(vtp, "Float32", "Points", 3, count * sizeof(float[3]));
    }
    fputs("</Points>\n", vtp->to);
}

/* Write what arrows at contacts are drawn by; other points have a normal of 0, and so no
 * arrow. */
static void put_contact_points(struct vtp *vtp)
{
    const struct snapshot_contact *contacts = vtp->snapshot->contacts;
    const uint64_t count = point_count(vtp);
    float(*normal)[3] = vtp->scratch, *toi = vtp->scratch;
    memset(normal, 0, count * sizeof *normal);
    for (uint64_t i = 0; i < vtp->contacts; i++) {
        memcpy(normal[vtp->vertices + i], contacts[i].normal, sizeof *normal);
    }
    put_array(vtp, "Float32", "normal", 3, count * sizeof *normal);
    for (uint64_t i = 0; i < count; i++) {
        bool is_contact = i >= vtp->vertices && i - vtp->vertices < vtp->contacts;
        toi[i] = is_contact ? (float)contacts[i - vtp->vertices].toi : TOI_NONE;
    }
    put_array(vtp, "Float32", "toi", 1, count * sizeof *toi);
}

static void put_point_data(struct vtp *vtp)
{
    float(*motion)[3] = vtp->scratch;
    fputs("<PointData Vectors=\"motion\">\n", vtp->to);
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        const struct snapshot_object *object = &vtp->snapshot->objects[o];
        memcpy(motion, object->motion, object->vertex_count * sizeof *motion);
        motion += object->vertex_count;
    }
    memset(motion, 0, (vtp->contacts + 2 * vtp->lines) * sizeof *motion);
    put_array(vtp, "Float32", "motion", 3, point_count(vtp) * sizeof(float[3]));
    float *radius = vtp->scratch;
    memset(radius, 0, point_count(vtp) * sizeof *radius);
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        const struct snapshot_object *object = &vtp->snapshot->objects[o];
        if (object->radii != NULL) {
            memcpy(radius, object->radii, object->vertex_count * sizeof *radius);
        }
        radius += object->vertex_count;
    }
    put_array(vtp, "Float32", "radius", 1, point_count(vtp) * sizeof *radius);
    uint32_t *handle = vtp->scratch;
    memset(handle, 0, point_count(vtp) * sizeof *handle);
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        for (uint32_t i = 0; i < vtp->snapshot->objects[o].vertex_count; i++) {
            *handle++ = vtp->snapshot->objects[o].handle;
        }
    }
    put_array(vtp, "UInt32", "object", 1, point_count(vtp) * sizeof *handle);
    put_contact_points(vtp);
    fputs("</PointData>\n", vtp->to);
}

static uint32_t float_word(float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

/* Word that a cell of a feature has in an array whose words are about contacts. INDEX:
 * the number of the feature among those of its sort in its object. */
enum feature_word {
    FEATURE_NONE,
    FEATURE_TOI,
    FEATURE_KIND,
    FEATURE_OBJECT,
    FEATURE_INDEX,
    FEATURE_HITS
};

static uint32_t *put_features(const struct snapshot_object *object, uint32_t count,
                              const uint32_t *hits, enum feature_word which,
                              uint32_t *words)
{
    for (uint32_t i = 0; i < count; i++) {
        *words++ = which == FEATURE_TOI                    ? float_word(TOI_NONE)
                   : which == FEATURE_KIND                 ? KIND_NONE
                   : which == FEATURE_OBJECT               ? object->handle
                   : which == FEATURE_INDEX                ? i
                   : which == FEATURE_HITS && hits != NULL ? hits[i]
                                                           : 0;
    }
    return words;
}

/* Write a word for each contact, then for each point, edge of a rod, and triangle. A
 * contact has the time, 0 for FEATURE_HITS, or its uint32_t at the offset `at`. */
static void put_cells(struct vtp *vtp, const char *type, const char *name,
                      enum feature_word which, size_t at)
{
    const struct snapshot *snapshot = vtp->snapshot;
    uint32_t *words = vtp->scratch;
    for (uint64_t i = 0; i < vtp->contacts; i++) {
        const struct snapshot_contact *contact = &snapshot->contacts[i];
        uint32_t word = which == FEATURE_TOI ? float_word((float)contact->toi) : 0;
        if (which != FEATURE_TOI && which != FEATURE_HITS) {
            memcpy(&word, (const char *)contact + at, sizeof word);
        }
        *words++ = word;
    }
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        words = put_features(&snapshot->objects[o], snapshot->objects[o].point_count,
                             NULL, which, words);
    }
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        words = put_features(&snapshot->objects[o], snapshot->objects[o].edge_count, NULL,
                             which, words);
    }
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        words = put_features(&snapshot->objects[o], snapshot->objects[o].triangle_count,
                             snapshot->objects[o].hits, which, words);
    }
    put_array(vtp, type, name, 1, cell_count(vtp) * sizeof(uint32_t));
}

static void put_cell_data(struct vtp *vtp)
{
    fputs("<CellData Scalars=\"toi\" Normals=\"normal\">\n", vtp->to);
#define AT(member) offsetof(struct snapshot_contact, member)
    put_cells(vtp, "Float32", "toi", FEATURE_TOI, 0);
    put_cells(vtp, "UInt32", "kind", FEATURE_KIND, AT(kind));
    put_cells(vtp, "UInt32", "flags", FEATURE_NONE, AT(flags));
    put_cells(vtp, "UInt32", "object_a", FEATURE_OBJECT, AT(object_a));
    put_cells(vtp, "UInt32", "feature_a", FEATURE_INDEX, AT(feature_a));
    put_cells(vtp, "UInt32", "object_b", FEATURE_NONE, AT(object_b));
    put_cells(vtp, "UInt32", "feature_b", FEATURE_NONE, AT(feature_b));
    put_cells(vtp, "UInt32", "contacts", FEATURE_HITS, 0);
    float(*normal)[3] = vtp->scratch;
    for (uint64_t i = 0; i < vtp->contacts; i++) {
        memcpy(normal[i], vtp->snapshot->contacts[i].normal, sizeof *normal);
    }
    memset(normal + vtp->contacts, 0, (cell_count(vtp) - vtp->contacts) * sizeof *normal);
    put_array(vtp, "Float32", "normal", 3, cell_count(vtp) * sizeof(float[3]));
    fputs("</CellData>\n", vtp->to);
}

/* Write what is near: distances and kinds of lines, which come behind the points; a
 * feature has no distance. */
static void put_near_data(struct vtp *vtp)
{
    const struct snapshot_line *lines = vtp->snapshot->lines;
    uint64_t count = cell_count(vtp), first = vtp->points;
    double *distance = vtp->scratch;
    uint32_t *kind = vtp->scratch;
    fputs("<CellData Scalars=\"distance\">\n", vtp->to);
    for (uint64_t i = 0; i < count; i++) {
        bool is_line = i >= first && i - first < vtp->lines;
        distance[i] = is_line ? lines[i - first].distance : NAN;
    }
    put_array(vtp, "Float64", "distance", 1, count * sizeof *distance);
    for (uint64_t i = 0; i < count; i++) {
        bool is_line = i >= first && i - first < vtp->lines;
        kind[i] = is_line ? lines[i - first].kind : KIND_NONE;
    }
    put_array(vtp, "UInt32", "kind", 1, count * sizeof *kind);
    fputs("</CellData>\n", vtp->to);
}

/* Ends of cells of `each` points. */
static void put_offsets(struct vtp *vtp, uint64_t count, uint32_t each)
{
    uint32_t *ends = vtp->scratch;
    for (uint64_t i = 0; i < count; i++) {
        ends[i] = (uint32_t)(i + 1) * each;
    }
    put_array(vtp, "UInt32", "offsets", 1, count * sizeof *ends);
}

static void put_contact_cells(struct vtp *vtp)
{
    uint32_t *points = vtp->scratch, first = 0;
    for (uint64_t i = 0; i < vtp->contacts; i++) {
        *points++ = (uint32_t)(vtp->vertices + i);
    }
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        const struct snapshot_object *object = &vtp->snapshot->objects[o];
        for (uint32_t i = 0; i < object->point_count; i++) {
            *points++ = first + object->points[i];
        }
        first += object->vertex_count;
    }
    uint64_t count = vtp->contacts + vtp->points;
    fputs("<Verts>\n", vtp->to);
    put_array(vtp, "UInt32", "connectivity", 1, count * sizeof *points);
    put_offsets(vtp, count, 1);
    fputs("</Verts>\n", vtp->to);
}

static void put_line_cells(struct vtp *vtp)
{
    uint32_t *points = vtp->scratch, first = 0;
    for (uint64_t i = 0; i < 2 * vtp->lines; i++) {
        *points++ = (uint32_t)(vtp->vertices + vtp->contacts + i);
    }
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        const struct snapshot_object *object = &vtp->snapshot->objects[o];
        for (uint64_t i = 0; i < 2 * (uint64_t)object->edge_count; i++) {
            *points++ = first + object->edges[i / 2][i % 2];
        }
        first += object->vertex_count;
    }
    uint64_t count = vtp->lines + vtp->rods;
    fputs("<Lines>\n", vtp->to);
    put_array(vtp, "UInt32", "connectivity", 1, 2 * count * sizeof *points);
    put_offsets(vtp, count, 2);
    fputs("</Lines>\n", vtp->to);
}

static void put_triangle_cells(struct vtp *vtp)
{
    uint32_t(*corners)[3] = vtp->scratch;
    uint32_t first = 0;
    for (uint32_t o = 0; o < vtp->snapshot->object_count; o++) {
        const struct snapshot_object *object = &vtp->snapshot->objects[o];
        for (uint32_t t = 0; t < object->triangle_count; t++, corners++) {
            for (int k = 0; k < 3; k++) {
                (*corners)[k] = first + object->triangles[t][k];
            }
        }
        first += object->vertex_count;
    }
    fputs("<Polys>\n", vtp->to);
    put_array(vtp, "UInt32", "connectivity", 1, vtp->triangles * sizeof *corners);
    put_offsets(vtp, vtp->triangles, 3);
    fputs("</Polys>\n", vtp->to);
}

/* Write the names of objects beside their handles, where they have names: text is the
 * numbers of its bytes, and a 0. */
static void put_names(const struct snapshot *snapshot, FILE *to)
{
    uint32_t count = snapshot->object_count;
    bool has_names = false;
    for (uint32_t i = 0; i < count; i++) {
        has_names = has_names || snapshot->objects[i].name != NULL;
    }
    if (!has_names) {
        return;
    }
    fprintf(to,
            "<FieldData>\n<DataArray type=\"UInt32\" Name=\"object_handles\" "
            "NumberOfTuples=\"%" PRIu32 "\" format=\"ascii\">",
            count);
    for (uint32_t i = 0; i < count; i++) {
        fprintf(to, "%" PRIu32 " ", snapshot->objects[i].handle);
    }
    fprintf(to,
            "</DataArray>\n<DataArray type=\"String\" Name=\"object_names\" "
            "NumberOfTuples=\"%" PRIu32 "\" format=\"ascii\">",
            count);
    for (uint32_t i = 0; i < count; i++) {
        const char *name = snapshot->objects[i].name;
        for (const char *at = name != NULL ? name : ""; *at != '\0'; at++) {
            fprintf(to, "%d ", (unsigned char)*at);
        }
        fputs("0 ", to);
    }
    fputs("</DataArray>\n</FieldData>\n", to);
}

int vtp_write(const struct snapshot *snapshot, FILE *to, const char *path,
              struct ctl_error *error)
{
    struct vtp vtp = {.snapshot = snapshot,
                      .to = to,
                      .contacts = snapshot->contact_count,
                      .lines = snapshot->line_count,
                      .is_ok = true};
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        vtp.vertices += snapshot->objects[o].vertex_count;
        vtp.triangles += snapshot->objects[o].triangle_count;
        vtp.rods += snapshot->objects[o].edge_count;
        vtp.points += snapshot->objects[o].point_count;
    }
    uint64_t most = point_count(&vtp) + cell_count(&vtp);
    if (most > UINT32_MAX / 3) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: more than 32-bit indices name",
                             path);
    }
    vtp.bytes = calloc(most + 1, sizeof(double[3]));
    if (vtp.bytes == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", path);
    }
    vtp.scratch = vtp.bytes + 1;
    fprintf(to,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<!-- pccdctl export, "
            "step %" PRIu64 ", t = %g -->\n<PolyData>\n",
            snapshot->step, snapshot->t);
    put_names(snapshot, to);
    fprintf(to,
            "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfVerts=\"%" PRIu64
            "\" NumberOfLines=\"%" PRIu64 "\" NumberOfStrips=\"0\" "
            "NumberOfPolys=\"%" PRIu64 "\">\n",
            point_count(&vtp), vtp.contacts + vtp.points, vtp.lines + vtp.rods,
            vtp.triangles);
    put_point_data(&vtp);
    if (snapshot->lines != NULL) {
        put_near_data(&vtp);
    } else {
        put_cell_data(&vtp);
    }
    put_points(&vtp);
    put_contact_cells(&vtp);
    put_line_cells(&vtp);
    put_triangle_cells(&vtp);
    fputs("</Piece>\n</PolyData>\n</VTKFile>\n", to);
    free(vtp.bytes);
    return vtp.is_ok && ferror(to) == 0
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                               strerror(errno));
}
