/* inspect_pack.c - parts of a step as sections of data. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>
#include <zlib.h>

#include "array.h"
#include "inspect.h"
#include "kinds.h"
#include "output.h"
#include "recorded_state.h"

/* A mesh that is in the file. */
struct inspect_mesh {
    uint64_t hash[2]; /* XXH3-128 of those of its triangles, rods, points and radii */
    uint32_t vertex_count, triangle_count;
};

/* Place where an object was last, so that what stands still is written once. */
struct inspect_place {
    uint32_t scene, object;
    uint32_t number;  /* in the page: objects of several scenes share it by name */
    uint64_t name[2]; /* XXH3-128 of its name; 0: it has none */
    uint64_t hash[2]; /* XXH3-128 of the section */
    uint32_t blob;
    size_t offset;
};

/* 20 bytes. */
struct inspect_event {
    uint32_t begin_ns, duration_ns; /* from the step's begin */
    uint32_t kind_thread;           /* enum pccd_trace_kind | thread << 8 */
    uint32_t a, b;
};

/* 48 bytes: of what is near, the nearest points; of a crossing, the ends of its edge; of
 * a vertex with its bound, which is the distance, the vertex twice. */
struct inspect_line {
    float ends[2][3]; /* relative to the page's origin, in its unit */
    float distance;   /* d_lo */
    uint32_t kind;    /* enum pccd_kind, enum pccd_near_kind */
    uint32_t feature_a, feature_b;
    uint16_t object_a, object_b; /* as of a contact */
    float along;                 /* of a crossing: where along its edge; 0 .. 1 */
};

/* ---- A growing array of bytes, divided into sections. */

#define FIRST_ROOM 65536u

void *bytes_section(struct bytes *bytes, size_t count, size_t *offset)
{
    size_t begin = (bytes->used + BYTES_ALIGN - 1) / BYTES_ALIGN * BYTES_ALIGN;
    size_t room = bytes->room == 0 ? FIRST_ROOM : bytes->room;
    while (room < begin + count) {
        room *= 2;
    }
    if (room > bytes->room) {
        uint8_t *grown = realloc(bytes->at, room);
        if (grown == NULL) {
            bytes->is_short = true;
            return NULL;
        }
        bytes->at = grown;
        bytes->room = room;
    }
    memset(bytes->at + bytes->used, 0, begin + count - bytes->used);
    bytes->used = begin + count;
    *offset = begin;
    return bytes->at + begin;
}

void bytes_empty(struct bytes *bytes)
{
    bytes->used = 0;
    bytes->is_short = false;
}

bool bytes_pack(const struct bytes *bytes, struct bytes *packed)
{
    size_t offset = 0;
    uLongf used = compressBound(bytes->used);
    bytes_empty(packed);
    Bytef *to = bytes_section(packed, used, &offset);
    if (to == NULL ||
        compress2(to, &used, bytes->at, bytes->used, Z_BEST_SPEED) != Z_OK) {
        return false;
    }
    packed->used = used;
    return true;
}

void bytes_deinit(struct bytes *bytes)
{
    free(bytes->at);
    memset(bytes, 0, sizeof *bytes);
}

#define LEVELS        65535.0 /* of a rounded coordinate */
#define CONTACT_BYTES 35u

#define PAIRS_PART 16u /* of the page may be counts of pairs; more are left out */

/* Bytes of texts that are cut to fit. */
#define OWNER_BYTES      128u
#define FIRST_PAIR_BYTES 384u

_Static_assert(PCCD_KIND_COUNT <= 1 << (8 - INSPECT_KIND_SHIFT), "a kind has its room");
_Static_assert(sizeof(struct inspect_line) == 48, "data.js reads 48 bytes");
_Static_assert(sizeof(struct inspect_event) == 20, "data.js reads 20 bytes");
_Static_assert(sizeof(struct pccd_joint) == 136, "joints.js reads 136 bytes");

json_t *inspect_section(const struct inspect *inspect, size_t offset)
{
    return json_pack("[I, I]", (json_int_t)inspect->page->blob_count, (json_int_t)offset);
}

static void hash_of(const void *bytes, size_t count, uint64_t hash[2])
{
    XXH128_hash_t sum = XXH3_128bits(bytes, count);
    hash[0] = sum.high64;
    hash[1] = sum.low64;
}

/* ---- meshes ------------------------------------------------------------------------ */

static json_t *counted(const struct inspect *inspect, size_t offset, uint64_t count)
{
    return json_pack("{s:o, s:I}", "at", inspect_section(inspect, offset), "count",
                     (json_int_t)count);
}

/* Its edges are known (recorded_edges). */
static json_t *pack_rods(struct inspect *inspect, const struct registry_mesh *mesh)
{
    uint32_t count = 0;
    size_t offset = 0;
    for (uint32_t i = 0; i < mesh->edge_count; i++) {
        count += recorded_is_free(mesh, 2, i);
    }
    uint32_t(*to)[2] = bytes_section(&inspect->data, count * sizeof *to, &offset);
    for (uint32_t i = 0; to != NULL && i < mesh->edge_count; i++) {
        if (recorded_is_free(mesh, 2, i)) {
            memcpy(to++, mesh->edges[i], sizeof *to);
        }
    }
    return to != NULL ? counted(inspect, offset, count) : NULL;
}

static json_t *pack_points(struct inspect *inspect, const struct registry_mesh *mesh)
{
    uint32_t count = 0;
    size_t offset = 0;
    for (uint32_t i = 0; i < mesh->named_point_count; i++) {
        count += recorded_is_free(mesh, 1, mesh->named_points[i]);
    }
    uint32_t *to = bytes_section(&inspect->data, count * sizeof *to, &offset);
    for (uint32_t i = 0; to != NULL && i < mesh->named_point_count; i++) {
        if (recorded_is_free(mesh, 1, mesh->named_points[i])) {
            *to++ = mesh->named_points[i];
        }
    }
    return to != NULL ? counted(inspect, offset, count) : NULL;
}

static json_t *pack_radii(struct inspect *inspect, const struct registry_mesh *mesh)
{
    size_t offset = 0;
    if (mesh->radii == NULL) {
        return json_null();
    }
    float *to = bytes_section(&inspect->data, mesh->vertex_count * sizeof *to, &offset);
    for (uint32_t i = 0; to != NULL && i < mesh->vertex_count; i++) {
        to[i] = (float)(mesh->radii[i] / inspect->unit);
    }
    return to != NULL ? inspect_section(inspect, offset) : NULL;
}

static json_t *pack_mesh(struct inspect *inspect, const struct registry_mesh *mesh)
{
    size_t corners = (size_t)mesh->triangle_count * 3, offset = 0;
    const uint32_t *from = (const uint32_t *)mesh->triangles;
    bool is_small = mesh->vertex_count <= 65536;
    void *to = bytes_section(&inspect->data,
                             corners * (is_small ? sizeof(uint16_t) : sizeof(uint32_t)),
                             &offset);
    if (to == NULL) {
        return NULL;
    }
    for (size_t i = 0; i < corners; i++) {
        if (is_small) {
            ((uint16_t *)to)[i] = (uint16_t)from[i];
        } else {
            ((uint32_t *)to)[i] = from[i];
        }
    }
    json_t *rods = pack_rods(inspect, mesh);
    json_t *points = pack_points(inspect, mesh);
    json_t *radii = pack_radii(inspect, mesh);
    return json_pack("{s:I, s:I, s:o, s:o, s:o, s:o}", "vertices",
                     (json_int_t)mesh->vertex_count, "triangles",
                     (json_int_t)mesh->triangle_count, "at",
                     inspect_section(inspect, offset), "edges", rods, "points", points,
                     "radii", radii);
}

/* The number of a mesh in the file, -1 without memory. */
static int64_t find_mesh(struct inspect *inspect, const struct registry_mesh *mesh,
                         json_t *meshes)
{
    struct inspect_mesh key = {.vertex_count = mesh->vertex_count,
                               .triangle_count = mesh->triangle_count};
    uint64_t parts[4][2];
    hash_of(mesh->triangles, (size_t)mesh->triangle_count * sizeof *mesh->triangles,
            parts[0]);
    hash_of(mesh->named_edges, mesh->named_edge_count * sizeof *mesh->named_edges,
            parts[1]);
    hash_of(mesh->named_points, mesh->named_point_count * sizeof *mesh->named_points,
            parts[2]);
    hash_of(mesh->radii,
            mesh->radii != NULL ? mesh->vertex_count * sizeof *mesh->radii : 0, parts[3]);
    hash_of(parts, sizeof parts, key.hash);
    for (uint32_t i = 0; i < inspect->known_count; i++) {
        if (memcmp(&inspect->known[i], &key, sizeof key) == 0) {
            return i;
        }
    }
    if (!array_reserve((void **)&inspect->known, inspect->known_count,
                       &inspect->known_room, sizeof key) ||
        json_array_append_new(meshes, pack_mesh(inspect, mesh)) != 0) {
        return -1;
    }
    inspect->known[inspect->known_count] = key;
    return inspect->known_count++;
}

/* ---- positions --------------------------------------------------------------------- */

static bool pack_floats(struct inspect *inspect, const double (*x)[3], uint32_t count,
                        size_t *offset)
{
    float(*to)[3] = bytes_section(&inspect->data, count * sizeof *to, offset);
    for (uint32_t i = 0; to != NULL && i < count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            to[i][k] = (float)((x[i][k] - inspect->origin[k]) / inspect->unit);
        }
    }
    return to != NULL;
}

static bool pack_rounded(struct inspect *inspect, const double (*x)[3], uint32_t count,
                         size_t *offset)
{
    double low[3] = {INFINITY, INFINITY, INFINITY};
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    float head[6];
    uint8_t *to =
        bytes_section(&inspect->data, sizeof head + count * 3 * sizeof(uint16_t), offset);
    if (to == NULL) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            low[k] = fmin(low[k], x[i][k]);
            high[k] = fmax(high[k], x[i][k]);
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        head[k] = (float)((low[k] - inspect->origin[k]) / inspect->unit);
        head[3 + k] = (float)((high[k] - low[k]) / inspect->unit / LEVELS);
    }
    memcpy(to, head, sizeof head);
    uint16_t *rounded = (uint16_t *)(void *)(to + sizeof head);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            double side = high[k] - low[k];
            double at = side > 0 ? (x[i][k] - low[k]) / side * LEVELS : 0;
            rounded[3 * i + k] = (uint16_t)lrint(at);
        }
    }
    return true;
}

static bool has_number(const struct inspect *inspect, uint32_t scene, uint32_t number)
{
    bool has = false;
    for (uint32_t i = 0; i < inspect->place_count && !has; i++) {
        has = inspect->places[i].scene == scene && inspect->places[i].number == number;
    }
    return has;
}

/* Give a place the number of what has its name in an earlier scene, if there is any. */
static void share_number(const struct inspect *inspect, struct inspect_place *place)
{
    for (uint32_t i = 0; i < inspect->place_count; i++) {
        const struct inspect_place *other = &inspect->places[i];
        if (other->scene != place->scene &&
            memcmp(other->name, place->name, sizeof place->name) == 0 &&
            !has_number(inspect, place->scene, other->number)) {
            place->number = other->number;
            return;
        }
    }
}

/* The place of item `i` in the list of a scene; NULL without memory. */
static struct inspect_place *find_place(struct inspect *inspect,
                                        const struct registry_scene *scene, uint32_t i)
{
    const struct registry_object *object = &scene->objects[i];
    const uint32_t count = inspect->place_count;
    for (uint32_t tried = 0; tried < count; tried++) {
        struct inspect_place *place = &inspect->places[(i + tried) % count];
        if (place->scene == scene->handle && place->object == object->handle) {
            return place;
        }
    }
    if (!array_reserve((void **)&inspect->places, count, &inspect->place_room,
                       sizeof *inspect->places)) {
        return NULL;
    }
    struct inspect_place made = {
        .scene = scene->handle, .object = object->handle, .number = count};
    if (object->name != NULL) {
        hash_of(object->name, strlen(object->name), made.name);
        share_number(inspect, &made);
    }
    struct inspect_place *place = &inspect->places[inspect->place_count++];
    *place = made;
    return place;
}

/* Positions of an object, where it is last or in a section of their own. */
static json_t *pack_positions(struct inspect *inspect, struct inspect_place *place,
                              const double (*x)[3], uint32_t count)
{
    size_t used = inspect->data.used, offset = 0;
    uint64_t hash[2];
    if (!(inspect->settings.is_rounded ? pack_rounded(inspect, x, count, &offset)
                                       : pack_floats(inspect, x, count, &offset))) {
        return NULL;
    }
    hash_of(inspect->data.at + offset, inspect->data.used - offset, hash);
    if (memcmp(hash, place->hash, sizeof hash) == 0) {
        inspect->data.used = used;
    } else {
        memcpy(place->hash, hash, sizeof hash);
        place->blob = inspect->page->blob_count;
        place->offset = offset;
    }
    return json_pack("[I, I]", (json_int_t)place->blob, (json_int_t)place->offset);
}

json_t *inspect_pack_objects(struct inspect *inspect, const struct registry_scene *scene,
                             enum inspect_moment moment, json_t *meshes)
{
    json_t *objects = json_array();
    for (uint32_t i = 0; i < scene->object_count && objects != NULL; i++) {
        const struct registry_object *object = &scene->objects[i];
        uint32_t count = object->mesh->vertex_count;
        int64_t mesh = find_mesh(inspect, object->mesh, meshes);
        struct inspect_place *place = find_place(inspect, scene, i);
        if (mesh < 0 || place == NULL) {
            json_decref(objects);
            return NULL;
        }
        double(*begin)[3] = moment == INSPECT_END ? object->x1 : object->x0;
        double(*end)[3] = moment == INSPECT_BEGIN ? object->x0 : object->x1;
        json_t *x0 = pack_positions(inspect, place, (const double(*)[3])begin, count);
        json_t *x1 = pack_positions(inspect, place, (const double(*)[3])end, count);
        bool turns = moment == INSPECT_BOTH && object->turned;
        json_t *item = json_pack(
            "{s:I, s:I, s:o, s:I, s:o, s:o, s:f, s:o}", "handle",
            (json_int_t)object->handle, "number", (json_int_t)place->number, "name",
            object->name != NULL ? json_text(object->name) : json_null(), "mesh",
            (json_int_t)mesh, "x0", x0, "x1", x1, "radius", object->attributes.radius,
            "joint", turns ? json_integer(object->joint) : json_null());
        if (json_array_append_new(objects, item) != 0) {
            json_decref(objects);
            return NULL;
        }
    }
    return objects;
}

json_t *inspect_pack_joints(struct inspect *inspect, const struct recorded_joints *joints)
{
    size_t bytes = joints->count * sizeof *joints->items, offset = 0;
    void *to = bytes_section(&inspect->data, bytes, &offset);
    if (to != NULL && bytes > 0) {
        memcpy(to, joints->items, bytes);
    }
    return to != NULL ? counted(inspect, offset, joints->count) : NULL;
}

/* ---- contacts ---------------------------------------------------------------------- */

/* The place of a handle in the scene's list; records come in the order of the first, so
 * that the place of the one before is nearly always right. */
static bool find_object(const struct registry_scene *scene, uint32_t handle,
                        uint16_t *place)
{
    if (*place < scene->object_count && scene->objects[*place].handle == handle) {
        return true;
    }
    for (uint32_t i = 0; i < scene->object_count && i <= UINT16_MAX; i++) {
        if (scene->objects[i].handle == handle) {
            *place = (uint16_t)i;
            return true;
        }
    }
    return false;
}

static int16_t part_of(float value)
{
    return (int16_t)lrintf(fminf(fmaxf(value, -1), 1) * 32767);
}

/* Find the places of a record's objects. Return false for a record that makes no sense:
 * see snapshot.c. */
static bool makes_sense(const struct registry_scene *scene,
                        const struct pccd_contact *record, uint16_t *a, uint16_t *b)
{
    return find_object(scene, record->object_a, a) &&
           find_object(scene, record->object_b, b) && record->kind < PCCD_KIND_COUNT;
}

/* Pairs have no time, and no place on their features. */
static struct pccd_contact contact_of(const struct play_step *step, uint64_t i)
{
    if (step->contacts != NULL) {
        return step->contacts[i];
    }
    const struct pccd_pair *pair = &step->pairs[i];
    return (struct pccd_contact){.kind = pair->kind,
                                 .object_a = pair->object_a,
                                 .feature_a = pair->feature_a,
                                 .object_b = pair->object_b,
                                 .feature_b = pair->feature_b};
}

json_t *inspect_pack_contacts(struct inspect *inspect, const struct play_step *step)
{
    enum { TOI, PARAM, FEATURE_A, FEATURE_B, OBJECT_A, OBJECT_B, NORMAL, FLAGS, COLUMNS };
    static const size_t sizes[COLUMNS] = {8, 8, 4, 4, 2, 2, 6, 1};
    bool has_records = step->contacts != NULL || step->pairs != NULL;
    uint64_t count = has_records && step->scene != NULL ? step->found.count : 0;
    uint64_t packed = 0;
    uint16_t a = 0, b = 0;
    for (uint64_t i = 0; i < count; i++) {
        const struct pccd_contact from = contact_of(step, i);
        packed += makes_sense(step->scene, &from, &a, &b);
    }
    size_t offset = 0;
    uint8_t *to[COLUMNS];
    to[0] = bytes_section(&inspect->data, packed * CONTACT_BYTES, &offset);
    if (to[0] == NULL) {
        return NULL;
    }
    for (uint32_t column = 1; column < COLUMNS; column++) {
        to[column] = to[column - 1] + packed * sizes[column - 1];
    }
    for (uint64_t i = 0; i < count; i++) {
        const struct pccd_contact from = contact_of(step, i);
        const void *values[COLUMNS] = {&from.toi,       &from.param, &from.feature_a,
                                       &from.feature_b, &a,          &b};
        if (!makes_sense(step->scene, &from, &a, &b)) {
            continue;
        }
        const int16_t normal[3] = {part_of(from.normal[0]), part_of(from.normal[1]),
                                   part_of(from.normal[2])};
        const uint8_t flags =
            (uint8_t)((from.flags & (PCCD_PROVED | PCCD_INITIAL | PCCD_INSIDE)) |
                      from.kind << INSPECT_KIND_SHIFT);
        values[NORMAL] = normal;
        values[FLAGS] = &flags;
        for (uint32_t column = 0; column < COLUMNS; column++) {
            memcpy(to[column], values[column], sizes[column]);
            to[column] += sizes[column];
        }
    }
    return counted(inspect, offset, packed);
}

struct pair_count {
    uint64_t key; /* both objects' numbers in the page, the lower one in the upper half */
    uint64_t count;
};

static int compare_keys(const void *a, const void *b)
{
    const struct pair_count *left = a, *right = b;
    return left->key < right->key ? -1 : left->key > right->key;
}

/* Return the key of two items in the list of a scene; 0, the first object and itself,
 * without memory, which *ok says. */
static uint64_t key_of(struct inspect *inspect, const struct registry_scene *scene,
                       uint32_t a, uint32_t b, bool *ok)
{
    const struct inspect_place *place = find_place(inspect, scene, a);
    const uint64_t first = place != NULL ? place->number : 0;
    const struct inspect_place *other = find_place(inspect, scene, b);
    const uint64_t second = other != NULL ? other->number : 0;
    *ok = *ok && place != NULL && other != NULL;
    return first < second ? first << 32 | second : second << 32 | first;
}

/* Sort counts, and make one of those of each pair. Returns how many are left. */
static size_t join_counts(struct pair_count *counts, size_t count)
{
    size_t kept = 0;
    qsort(counts, count, sizeof *counts, compare_keys);
    for (size_t i = 0; i < count; i++) {
        if (kept > 0 && counts[kept - 1].key == counts[i].key) {
            counts[kept - 1].count += counts[i].count;
        } else {
            counts[kept++] = counts[i];
        }
    }
    return kept;
}

json_t *inspect_pack_pairs(struct inspect *inspect, const struct play_step *step)
{
    struct pair_count *counts = NULL;
    size_t count = 0, room = 0;
    uint16_t a = 0, b = 0;
    uint32_t both = 0; /* places of the last record's objects */
    bool ok = true;
    if (step->contacts == NULL && step->pairs == NULL && step->nears == NULL) {
        return step->answer->total == 0 ? json_array() : json_null();
    }
    for (uint64_t i = 0; i < step->found.count && ok; i++) {
        const struct pccd_near *near = step->nears != NULL ? &step->nears[i] : NULL;
        const struct pccd_contact record =
            near != NULL ? (struct pccd_contact){.object_a = near->object_a,
                                                 .object_b = near->object_b}
                         : contact_of(step, i);
        if (!makes_sense(step->scene, &record, &a, &b)) {
            continue;
        }
        if (count == 0 || both != ((uint32_t)a << 16 | b)) {
            both = (uint32_t)a << 16 | b;
            ok = array_reserve((void **)&counts, count, &room, sizeof *counts);
            if (ok) {
                const uint64_t key = key_of(inspect, step->scene, a, b, &ok);
                counts[count++] = (struct pair_count){.key = key};
            }
        }
        counts[count - 1].count += ok;
    }
    json_t *packed = ok ? json_array() : NULL;
    count = count > 0 ? join_counts(counts, count) : 0;
    for (size_t i = 0; i < count && ok; i++) {
        json_append(packed, json_integer((json_int_t)(counts[i].key >> 32)), &ok);
        json_append(packed, json_integer((json_int_t)(counts[i].key & UINT32_MAX)), &ok);
        json_append(packed, json_integer((json_int_t)counts[i].count), &ok);
    }
    free(counts);
    const uint64_t bytes = ok ? page_file_json_bytes(packed) : 0;
    if (ok && inspect->pairs_bytes + bytes <= inspect->settings.bytes_max / PAIRS_PART) {
        inspect->pairs_bytes += bytes;
        return packed;
    }
    json_decref(packed);
    return ok ? json_null() : NULL;
}

json_t *inspect_first_pair(const struct play_step *step)
{
    const struct pccd_contact *first = NULL;
    char text[FIRST_PAIR_BYTES] = "";
    for (uint64_t i = 0; step->contacts != NULL && i < step->found.count; i++) {
        if (first == NULL || step->contacts[i].toi < first->toi) {
            first = &step->contacts[i];
        }
    }
    uint16_t places[2] = {0, 0};
    if (first == NULL || !makes_sense(step->scene, first, &places[0], &places[1])) {
        return json_null();
    }
    size_t used = 0;
    for (uint32_t side = 0; side < 2 && used < sizeof text; side++) {
        const struct registry_object *object = &step->scene->objects[places[side]];
        const uint32_t feature = side == 0 ? first->feature_a : first->feature_b;
        const uint32_t points = common_kinds[first->kind].points[side];
        const uint32_t *v = recorded_feature(object->mesh, points, &feature);
        char other[16] = "", owner[OWNER_BYTES] = "";
        if (points == 2 && v != NULL) {
            snprintf(other, sizeof other, "-%" PRIu32, v[1]);
        }
        if (step->scene->object_count > 1 && object->name != NULL) {
            snprintf(owner, sizeof owner, " of %s", object->name);
        } else if (step->scene->object_count > 1) {
            snprintf(owner, sizeof owner, " of object %u", (unsigned)places[side]);
        }
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %" PRIu32 "%s%s",
                                 side == 0 ? "" : " meets ", common_feature_names[points],
                                 points == 2 && v != NULL ? v[0] : feature, other, owner);
    }
    return json_text(text);
}

static void pack_ends(const struct inspect *inspect, const double ends[2][3],
                      struct inspect_line *to)
{
    for (uint32_t k = 0; k < 6; k++) {
        to->ends[k / 3][k % 3] =
            (float)((ends[k / 3][k % 3] - inspect->origin[k % 3]) / inspect->unit);
    }
}

/* Pack the vertices whose bounds are below the distance that was asked for: the others
 * have nothing near. They come by objects, of the one that was asked about or all.
 * Returns how many. */
static uint64_t pack_bounds(const struct inspect *inspect, const struct play_step *near,
                            struct inspect_line *to)
{
    const struct record_frame *asked = near->asked;
    uint64_t packed = 0, at = 0;
    for (uint32_t i = 0; i < near->scene->object_count && i <= UINT16_MAX; i++) {
        const struct registry_object *object = &near->scene->objects[i];
        bool is_asked = asked->objects[0] == 0 || asked->objects[0] == object->handle;
        uint32_t count = is_asked ? object->mesh->vertex_count : 0;
        for (uint32_t v = 0; v < count && at < near->found.count; v++, at++) {
            const double *x = asked->end == 0 ? object->x0[v] : object->x1[v];
            const double ends[2][3] = {{x[0], x[1], x[2]}, {x[0], x[1], x[2]}};
            if (!(near->bounds[at] < asked->distance)) {
                continue;
            }
            pack_ends(inspect, ends, &to[packed]);
            to[packed].distance = (float)near->bounds[at];
            to[packed].kind = PCCD_VV;
            to[packed].feature_a = to[packed].feature_b = v;
            to[packed].object_a = to[packed].object_b = (uint16_t)i;
            packed++;
        }
    }
    return packed;
}

json_t *inspect_pack_lines(struct inspect *inspect, const struct play_step *near)
{
    bool has_records = near->nears != NULL || near->bounds != NULL;
    uint64_t count = has_records ? near->found.count : 0;
    size_t offset = 0;
    uint64_t packed = 0;
    uint16_t a = 0, b = 0;
    struct inspect_line *to = bytes_section(&inspect->data, count * sizeof *to, &offset);
    if (to != NULL && near->bounds != NULL) {
        packed = pack_bounds(inspect, near, to);
    }
    for (uint64_t i = 0; to != NULL && near->nears != NULL && i < count; i++) {
        const struct pccd_near *from = &near->nears[i];
        double ends[2][3];
        if (!find_object(near->scene, from->object_a, &a) ||
            !find_object(near->scene, from->object_b, &b) ||
            !recorded_near_line(near->scene, from, near->asked->end, ends)) {
            continue; /* a record that makes no sense: see snapshot.c */
        }
        pack_ends(inspect, (const double(*)[3])ends, &to[packed]);
        to[packed].distance = (float)from->d_lo;
        to[packed].kind = from->kind;
        to[packed].feature_a = from->feature_a;
        to[packed].feature_b = from->feature_b;
        to[packed].object_a = a;
        to[packed].object_b = b;
        to[packed++].along = from->param[0];
    }
    return to != NULL ? counted(inspect, offset, packed) : NULL;
}

/* ---- events ------------------------------------------------------------------------ */

json_t *inspect_pack_events(struct inspect *inspect, const struct step_trace *trace)
{
    size_t offset = 0;
    uint32_t threads = 0;
    if (trace == NULL || trace->status != PCCD_OK || trace->end_ns == 0) {
        return json_null();
    }
    struct inspect_event *to =
        bytes_section(&inspect->data, trace->count * sizeof *to, &offset);
    if (to == NULL) {
        return NULL;
    }
    for (uint32_t i = 0; i < trace->count; i++) {
        const struct pccd_trace_event *from = &trace->events[i];
        uint64_t begin_ns = from->begin_ns - trace->begin_ns;
        uint64_t duration_ns = from->end_ns - from->begin_ns;
        threads = from->thread >= threads ? from->thread + 1 : threads;
        to[i] = (struct inspect_event){
            .begin_ns = (uint32_t)(begin_ns < UINT32_MAX ? begin_ns : UINT32_MAX),
            .duration_ns =
                (uint32_t)(duration_ns < UINT32_MAX ? duration_ns : UINT32_MAX),
            .kind_thread = from->kind | from->thread << 8,
            .a = from->a,
            .b = from->b};
    }
    return json_pack("{s:o, s:I, s:I, s:I, s:I}", "at", inspect_section(inspect, offset),
                     "count", (json_int_t)trace->count, "threads", (json_int_t)threads,
                     "ns", (json_int_t)(trace->end_ns - trace->begin_ns), "lost",
                     (json_int_t)trace->lost);
}
