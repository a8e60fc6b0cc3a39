/* client/ctl/mesh/gltf_animation.c - what moves the nodes of a glTF file, and when.
 *
 * Room:     client/ctl.
 * Does:     judge channels, collect their keys, interpolate.
 * Threads:  one at a time.
 * Source:   gltf_animation.h.
 */
#include "gltf_animation.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "meshfile.h"
#include "pccd_types.h"

#define POINTER       "KHR_animation_pointer"
#define HALVINGS_MAX  27   /* a quarter turn is below 2^-26 then */
#define RATE_ROUNDING 1e-4 /* of a frame, by which times that are floats may be off */
#define DEGREES       (180 / 3.14159265358979323846)

static const char *const path_names[GLTF_PATHS] = {"translation", "rotation", "scale",
                                                   "weights"};
static const char *const between_names[] = {"STEP", "LINEAR", "CUBICSPLINE"};

/* Where a name stands in a list; -1: nowhere. */
static int place_in(const char *const *names, int count, const char *name)
{
    int place = count - 1;
    while (place >= 0 && (name == NULL || strcmp(names[place], name) != 0)) {
        place--;
    }
    return place;
}

/* ---- keys -------------------------------------------------------------------------- */

static double key_time(const struct gltf_channel *channel, size_t key)
{
    double time;
    gltf_accessor_read(&channel->times, key, &time);
    return time;
}

/* The last key that is not after the time; 0 if all are. */
static size_t key_before(const struct gltf_channel *channel, double time)
{
    size_t low = 0, high = channel->times.count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        low = key_time(channel, middle) <= time ? middle : low;
        high = low == middle ? high : middle;
    }
    return low;
}

static void normalize(double q[4])
{
    double length = sqrt((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
    for (int i = 0; i < 4; i++) {
        q[i] /= length;
    }
}

/* From a to b the shorter way, u of the angle, into a. By halving, with square roots
 * alone: the sines of two C libraries have not the same last bits. */
static void turn_between(double a[4], double b[4], double u)
{
    normalize(a);
    normalize(b);
    double dot = (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
    for (int i = 0; i < 4 && dot < 0; i++) {
        b[i] = -b[i];
    }
    for (int n = 0; n < HALVINGS_MAX && u > 0 && u < 1; n++) {
        double middle[4];
        for (int i = 0; i < 4; i++) {
            middle[i] = a[i] + b[i];
        }
        normalize(middle);
        memcpy(u < 0.5 ? b : a, middle, sizeof middle);
        u = u < 0.5 ? 2 * u : 2 * u - 1;
    }
    for (int i = 0; i < 4; i++) {
        a[i] = (1 - u) * a[i] + u * b[i];
    }
}

/* What one node has of a channel at a time: into row `row` of `rows`, which are morph
 * targets, or one. */
static void read_row(const struct gltf_channel *channel, double time, size_t rows,
                     size_t row, double *value)
{
    const struct gltf_accessor *values = &channel->values;
    bool is_cubic = channel->between == GLTF_CUBICSPLINE;
    size_t parts = is_cubic ? 3 : 1; /* of a cubic key: tangent, value, tangent */
    size_t key = key_before(channel, time);
    size_t at = (parts * key + is_cubic) * rows + row;
    size_t components = values->components;
    double begin = key_time(channel, key), next[4], out[4], in[4];
    gltf_accessor_read(values, at, value);
    if (time <= begin || key + 1 == channel->times.count ||
        channel->between == GLTF_STEP) {
        return;
    }
    double span = key_time(channel, key + 1) - begin;
    double u = (time - begin) / span;
    gltf_accessor_read(values, at + parts * rows, next);
    if (!is_cubic && channel->path == GLTF_ROTATION) {
        turn_between(value, next, u);
        return;
    }
    if (is_cubic) {
        gltf_accessor_read(values, at + rows, out);
        gltf_accessor_read(values, at + 2 * rows, in);
    }
    double v = 1 - u;
    for (size_t i = 0; i < components; i++) {
        value[i] =
            is_cubic ? ((1 + 2 * u) * v * v * value[i] + u * u * (1 + 2 * v) * next[i]) +
                           span * u * v * (v * out[i] - u * in[i])
                     : v * value[i] + u * next[i];
    }
}

void gltf_animation_pose(const struct gltf_animation *animation, struct gltf_tree *tree,
                         double time)
{
    for (size_t i = 0; i < animation->channel_count; i++) {
        const struct gltf_channel *channel = &animation->channels[i];
        struct gltf_node *node = &tree->nodes[channel->node];
        double *const values[GLTF_PATHS] = {node->translation, node->rotation,
                                            node->scale, node->weights};
        bool has_rows = channel->path == GLTF_WEIGHTS;
        size_t rows = has_rows ? node->weight_count : 1;
        for (size_t row = 0; row < rows; row++) {
            double value[4];
            read_row(channel, time, rows, row, value);
            memcpy(values[channel->path] + row, value,
                   channel->values.components * sizeof *value);
        }
    }
}

/* ---- channels ---------------------------------------------------------------------- */

static int judge_times(struct gltf *gltf, const struct gltf_channel *channel)
{
    double before = -INFINITY;
    for (size_t k = 0; k < channel->times.count; k++) {
        double time = key_time(channel, k);
        if (!isfinite(time) || time <= before) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "accessor %zu: key %zu is at %g s, not after the one before "
                             "it",
                             channel->times.index, k, time);
        }
        before = time;
    }
    return PCCD_OK;
}

static int read_sampler(struct gltf *gltf, const json_t *animation, int64_t index,
                        size_t rows, struct gltf_channel *channel)
{
    const json_t *samplers = json_object_get(animation, "samplers");
    const json_t *sampler = index < 0 ? NULL : json_array_get(samplers, (size_t)index);
    static const char *const kinds[GLTF_PATHS] = {"VEC3", "VEC4", "VEC3", "SCALAR"};
    const json_t *named = json_object_get(sampler, "interpolation");
    bool is_fraction = channel->path == GLTF_ROTATION || channel->path == GLTF_WEIGHTS;
    int between = named == NULL ? GLTF_LINEAR
                                : place_in(between_names, 3, json_string_value(named));
    if (between < 0) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "sampler %" PRId64
                         ": interpolation \"%.40s\" is none of STEP, LINEAR, CUBICSPLINE",
                         index, json_is_string(named) ? json_string_value(named) : "");
    }
    if (sampler == NULL) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "sampler %" PRId64 ": there is none",
                         index);
    }
    channel->between = (enum gltf_between)between;
    int status = gltf_accessor_find(gltf, gltf_number(sampler, "input", -1), "SCALAR",
                                    GLTF_FLOAT, &channel->times);
    if (status == PCCD_OK) {
        status = judge_times(gltf, channel);
    }
    if (status == PCCD_OK) {
        status = gltf_accessor_find(
            gltf, gltf_number(sampler, "output", -1), kinds[channel->path],
            is_fraction ? GLTF_FRACTIONS : GLTF_FLOAT, &channel->values);
    }
    size_t wanted = channel->times.count * (between == GLTF_CUBICSPLINE ? 3 : 1);
    if (status == PCCD_OK && (wanted == 0 || channel->values.count % wanted != 0 ||
                              channel->values.count / wanted != rows)) {
        return gltf_fail(
            gltf, PCCD_E_FORMAT, "accessor %zu: has %zu values for %zu keys of %zu each",
            channel->values.index, channel->values.count, channel->times.count, rows);
    }
    return status;
}

/* What a channel moves, if that is a mesh; otherwise *moves is false. */
static int read_target(struct gltf *gltf, const struct gltf_tree *tree,
                       const json_t *channel, struct gltf_channel *made, bool *moves)
{
    const json_t *target = json_object_get(channel, "target");
    int64_t index = gltf_number(target, "node", -1);
    const char *name = json_string_value(json_object_get(target, "path"));
    int path = place_in(path_names, GLTF_PATHS, name);
    const char *pointer = json_string_value(json_object_get(
        json_object_get(json_object_get(target, "extensions"), POINTER), "pointer"));
    *moves = false;
    if (pointer != NULL &&
        (strncmp(pointer, "/nodes/", 7) == 0 || strncmp(pointer, "/meshes/", 8) == 0 ||
         strncmp(pointer, "/skins/", 7) == 0)) {
        return gltf_fail(gltf, PCCD_E_FORMAT,
                         "\"%.80s\" is moved by \"" POINTER "\", which is not read",
                         pointer);
    }
    if (json_object_get(target, "node") == NULL || path < 0) {
        return PCCD_OK; /* by the specification it moves nothing */
    }
    if (index < 0 || (uint64_t)index >= tree->count) {
        return gltf_fail(gltf, PCCD_E_INDEX, "there is no node %" PRId64 " to move",
                         index);
    }
    const struct gltf_node *node = &tree->nodes[index];
    made->node = (size_t)index;
    made->path = (enum gltf_path)path;
    *moves = path == GLTF_WEIGHTS ? node->weight_count > 0 : node->moves_mesh;
    if (*moves && path != GLTF_WEIGHTS && node->has_matrix) {
        return gltf_fail(gltf, PCCD_E_FORMAT, "node %" PRId64 ": moves and has a matrix",
                         index);
    }
    return PCCD_OK;
}

/* What moves is claimed by an animation: 0 nothing yet, else its number from 1. */
struct claims {
    size_t *by; /* [nodes * GLTF_PATHS] */
    bool has_two;
    bool reads; /* the channels, too */
};

static int read_channels(struct gltf *gltf, const struct gltf_tree *tree, size_t index,
                         struct claims *claims, size_t *moving,
                         struct gltf_animation *animation)
{
    const json_t *json = gltf_entry(gltf, "animations", (int64_t)index);
    const json_t *channels = json_object_get(json, "channels");
    *moving = 0;
    for (size_t i = 0; i < json_array_size(channels); i++) {
        const json_t *channel = json_array_get(channels, i);
        struct gltf_channel made = {.node = 0};
        bool moves;
        int status = read_target(gltf, tree, channel, &made, &moves);
        if (status != PCCD_OK || !moves) {
            if (status != PCCD_OK) {
                return status;
            }
            continue;
        }
        ++*moving;
        if (!claims->reads) {
            size_t *claim = &claims->by[made.node * GLTF_PATHS + made.path];
            if (*claim == index + 1) {
                return gltf_fail(gltf, PCCD_E_FORMAT,
                                 "animation %zu: moves the %s of node %zu twice", index,
                                 path_names[made.path], made.node);
            }
            claims->has_two |= *claim != 0;
            *claim = index + 1;
            continue;
        }
        size_t rows = made.path == GLTF_WEIGHTS ? tree->nodes[made.node].weight_count : 1;
        status =
            read_sampler(gltf, json, gltf_number(channel, "sampler", -1), rows, &made);
        if (status != PCCD_OK) {
            return status;
        }
        void *all = animation->channels;
        if (!array_reserve(&all, animation->channel_count, &animation->channel_room,
                           sizeof made)) {
            return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu channels",
                             animation->channel_count);
        }
        animation->channels = all;
        animation->channels[animation->channel_count++] = made;
        animation->is_curved |= made.between == GLTF_CUBICSPLINE;
    }
    return PCCD_OK;
}

/* The number of the animation that is wished for; -1: there is none. */
static int64_t find_wish(const struct gltf *gltf, const char *wish)
{
    size_t count = gltf_entry_count(gltf, "animations");
    for (size_t i = 0; i < count; i++) {
        const char *name = json_string_value(
            json_object_get(gltf_entry(gltf, "animations", (int64_t)i), "name"));
        if (name != NULL && strcmp(name, wish) == 0) {
            return (int64_t)i;
        }
    }
    char *end;
    unsigned long number = strtoul(wish, &end, 10);
    bool is_number = *wish >= '0' && *wish <= '9' && *end == '\0';
    return is_number && number < count ? (int64_t)number : -1;
}

static int choose(struct gltf *gltf, const struct gltf_tree *tree, const char *wish,
                  struct claims *claims, struct gltf_animation *animation)
{
    size_t count = gltf_entry_count(gltf, "animations"), moving;
    int64_t wished = wish != NULL ? find_wish(gltf, wish) : -1;
    int status = PCCD_OK;
    if (wish != NULL && wished < 0) {
        return gltf_fail(gltf, PCCD_E_INVAL,
                         "no animation has the name or number \"%.80s\", of %zu", wish,
                         count);
    }
    animation->first = -1;
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        status = read_channels(gltf, tree, i, claims, &moving, animation);
        animation->moving_count += moving > 0;
        animation->first =
            animation->first < 0 && moving > 0 ? (int64_t)i : animation->first;
    }
    animation->first = wished >= 0 ? wished : animation->first;
    claims->reads = true;
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        bool is_alone = wish != NULL || claims->has_two;
        if (is_alone && (int64_t)i != animation->first) {
            continue;
        }
        status = read_channels(gltf, tree, i, claims, &moving, animation);
        animation->read_count += moving > 0;
    }
    return status;
}

/* ---- frames ------------------------------------------------------------------------ */

static int order_of_times(const void *a, const void *b)
{
    double difference = *(const double *)a - *(const double *)b;
    return difference < 0 ? -1 : difference > 0;
}

/* The keys of all channels, each time once. */
static int collect_times(struct gltf *gltf, struct gltf_animation *animation)
{
    bool *seen = calloc(gltf_entry_count(gltf, "accessors") + 1, sizeof *seen);
    bool has_memory = seen != NULL;
    for (size_t i = 0; i < animation->channel_count && has_memory; i++) {
        const struct gltf_channel *channel = &animation->channels[i];
        size_t count = seen[channel->times.index] ? 0 : channel->times.count;
        seen[channel->times.index] = true;
        for (size_t k = 0; k < count && has_memory; k++) {
            void *times = animation->times;
            has_memory = array_reserve(&times, animation->time_count,
                                       &animation->time_room, sizeof *animation->times);
            animation->times = times;
            if (has_memory) {
                animation->times[animation->time_count++] = key_time(channel, k);
            }
        }
    }
    free(seen);
    if (!has_memory) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu keys",
                         animation->time_count);
    }
    if (animation->time_count == 0) {
        return PCCD_OK;
    }
    qsort(animation->times, animation->time_count, sizeof *animation->times,
          order_of_times);
    size_t count = 1;
    for (size_t i = 1; i < animation->time_count; i++) {
        if (animation->times[i] != animation->times[count - 1]) {
            animation->times[count++] = animation->times[i];
        }
    }
    animation->time_count = count;
    return PCCD_OK;
}

double gltf_animation_time(const struct gltf_animation *animation, uint32_t frame)
{
    bool is_last = frame + 1 == animation->frame_count;
    return animation->rate == 0 ? animation->times[frame]
           : is_last            ? animation->times[animation->time_count - 1]
                                : animation->times[0] + frame / animation->rate;
}

/* How far a node turns between two frames: by what it has at each, the shorter way. */
static double find_turn(const struct gltf_animation *animation)
{
    double greatest = 0;
    for (size_t i = 0; i < animation->channel_count; i++) {
        const struct gltf_channel *channel = &animation->channels[i];
        double a[4] = {0}, b[4];
        for (uint32_t frame = 0;
             channel->path == GLTF_ROTATION && frame < animation->frame_count; frame++) {
            read_row(channel, gltf_animation_time(animation, frame), 1, 0, b);
            normalize(b);
            double dot = fabs((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]));
            double turn = frame > 0 && dot < 1 ? 2 * acos(dot) * DEGREES : 0;
            greatest = turn > greatest ? turn : greatest;
            memcpy(a, b, sizeof a);
        }
    }
    return greatest;
}

int gltf_animation_read(struct gltf *gltf, struct gltf_tree *tree,
                        const struct ctl_motion_wish *wish,
                        struct gltf_animation *animation)
{
    double rate = wish != NULL ? wish->rate : 0;
    const char *name = wish != NULL ? wish->animation : NULL;
    struct claims claims = {.by = calloc(tree->count * GLTF_PATHS + 1, sizeof(size_t))};
    *animation = (struct gltf_animation){.rate = rate};
    int status = claims.by != NULL ? choose(gltf, tree, name, &claims, animation)
                                   : gltf_fail(gltf, PCCD_E_NOMEM,
                                               "no memory for %zu nodes", tree->count);
    free(claims.by);
    if (status == PCCD_OK) {
        status = collect_times(gltf, animation);
    }
    if (status != PCCD_OK || animation->time_count == 0) {
        return status;
    }
    double last = animation->times[animation->time_count - 1];
    double frames = rate == 0
                        ? (double)animation->time_count
                        : ceil((last - animation->times[0]) * rate - RATE_ROUNDING) + 1;
    if (!(frames <= (double)CTL_MESH_COUNT_MAX)) {
        return gltf_fail(gltf, PCCD_E_LIMIT,
                         "%g frames from %g s to %g s, at most %" PRIu64, frames,
                         animation->times[0], last, CTL_MESH_COUNT_MAX);
    }
    animation->frame_count = (uint32_t)frames;
    animation->turn_degrees = rate == 0 ? find_turn(animation) : 0;
    return PCCD_OK;
}

void gltf_animation_deinit(struct gltf_animation *animation)
{
    free(animation->channels);
    free(animation->times);
    *animation = (struct gltf_animation){.channels = NULL};
}
