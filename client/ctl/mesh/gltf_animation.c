/* client/ctl/mesh/gltf_animation.c - what moves the nodes of a glTF file, and when. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gltf_scene.h"

/* One thing of one node that an animation moves. */
struct gltf_channel {
    const json_t *json;
    size_t animation, node;
    enum gltf_path path;
    enum { GLTF_STEP, GLTF_LINEAR, GLTF_CUBICSPLINE, GLTF_BETWEEN } between;
    struct gltf_accessor times, values;
};

#define POINTER       "KHR_animation_pointer"
#define HALVINGS_MAX  27   /* a quarter turn is below 2^-26 then */
#define RATE_ROUNDING 1e-4 /* of a frame, by which times that are floats may be off */
#define DEGREES       (180 / 3.14159265358979323846)

/* ---- keys -------------------------------------------------------------------------- */

static double key_time(const struct gltf_channel *channel, size_t key)
{
    double time;
    gltf_read(&channel->times, key, &time);
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

static double product(const double a[4], const double b[4])
{
    return (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
}

static void normalize(double q[4])
{
    double length = sqrt(product(q, q));
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
    bool is_longer = product(a, b) < 0;
    for (int i = 0; i < 4 && is_longer; i++) {
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

/* Set `value` to that of a channel at a time, in row `row` of `rows` (one for each morph
 * target, or one). Before the first key and after the last it is that key's. */
static void read_row(const struct gltf_channel *channel, double time, size_t rows,
                     size_t row, double value[4])
{
    const struct gltf_accessor *values = &channel->values;
    bool is_cubic = channel->between == GLTF_CUBICSPLINE;
    size_t parts = is_cubic ? 3 : 1; /* of a cubic key: tangent, value, tangent */
    size_t key = key_before(channel, time);
    size_t at = (parts * key + is_cubic) * rows + row;
    double begin = key_time(channel, key), next[4], out[4], in[4];
    gltf_read(values, at, value);
    if (time <= begin || key + 1 == channel->times.count ||
        channel->between == GLTF_STEP) {
        return;
    }
    double span = key_time(channel, key + 1) - begin;
    double u = (time - begin) / span, v = 1 - u;
    gltf_read(values, at + parts * rows, next);
    if (is_cubic) {
        gltf_read(values, at + rows, out);
        gltf_read(values, at + 2 * rows, in);
    } else if (channel->path == GLTF_ROTATION) {
        turn_between(value, next, u);
        return;
    }
    for (size_t i = 0; i < values->components; i++) {
        value[i] =
            is_cubic ? ((1 + 2 * u) * v * v * value[i] + u * u * (1 + 2 * v) * next[i]) +
                           span * u * v * (v * out[i] - u * in[i])
                     : v * value[i] + u * next[i];
    }
}

/* Return how many values a key has: one for each morph target, or one. */
static size_t rows_of(const struct gltf_scene *scene, const struct gltf_channel *channel)
{
    return channel->path == GLTF_WEIGHTS ? scene->nodes[channel->node].weight_count : 1;
}

void gltf_animation_pose(struct gltf_scene *scene, uint32_t frame)
{
    double time = gltf_animation_time(&scene->animation, frame);
    for (size_t i = 0; i < scene->animation.channel_count; i++) {
        const struct gltf_channel *channel = &scene->animation.channels[i];
        struct gltf_node *node = &scene->nodes[channel->node];
        double *to =
            channel->path == GLTF_WEIGHTS ? node->weights : node->pose[channel->path];
        size_t rows = rows_of(scene, channel);
        for (size_t row = 0; row < rows; row++) {
            double value[4];
            read_row(channel, time, rows, row, value);
            memcpy(to + row, value, channel->values.components * sizeof *value);
        }
    }
}

/* ---- channels ---------------------------------------------------------------------- */

/* The keys of a channel. */
static void read_sampler(struct gltf_scene *scene, struct gltf_channel *channel)
{
    static const char *const names[] = {"STEP", "LINEAR", "CUBICSPLINE", ""};
    struct gltf *gltf = &scene->gltf;
    const json_t *entry = gltf_entry(gltf, "animations", (long long)channel->animation);
    long long index = gltf_number(channel->json, "sampler", -1);
    const json_t *sampler =
        json_array_get(json_object_get(entry, "samplers"), (size_t)index);
    const json_t *named = json_object_get(sampler, "interpolation");
    const char *name = named == NULL           ? "LINEAR"
                       : json_is_string(named) ? json_string_value(named)
                                               : "";
    while (channel->between < GLTF_BETWEEN &&
           strcmp(name, names[channel->between]) != 0) {
        channel->between++;
    }
    gltf_check(gltf, sampler != NULL, "sampler %lld: there is none", index);
    gltf_check(
        gltf, channel->between < GLTF_BETWEEN,
        "sampler %lld: interpolation \"%.40s\" is none of STEP, LINEAR, CUBICSPLINE",
        index, name);
    channel->times = gltf_find(gltf, json_object_get(sampler, "input"), GLTF_TIMES);
    for (size_t k = 0; k < channel->times.count; k++) {
        double time = key_time(channel, k);
        gltf_check(gltf, isfinite(time) && (k == 0 || time > key_time(channel, k - 1)),
                   "accessor %zu: key %zu is at %g s, not after the one before it",
                   channel->times.index, k, time);
    }
    channel->values = gltf_find(gltf, json_object_get(sampler, "output"),
                                gltf_path_kinds[channel->path].role);
    size_t rows = rows_of(scene, channel), values = channel->values.count;
    size_t keys = channel->times.count * (channel->between == GLTF_CUBICSPLINE ? 3 : 1);
    gltf_check(gltf, keys > 0 && values % keys == 0 && values / keys == rows,
               "accessor %zu: has %zu values for %zu keys of %zu each",
               channel->values.index, values, channel->times.count, rows);
}

/* Read what a channel moves. Return false if that is no mesh. */
static bool read_target(struct gltf_scene *scene, struct gltf_channel *channel)
{
    struct gltf *gltf = &scene->gltf;
    const json_t *target = json_object_get(channel->json, "target");
    const json_t *extensions = json_object_get(target, "extensions");
    const char *path = json_string_value(json_object_get(target, "path"));
    const char *pointer = json_string_value(
        json_object_get(json_object_get(extensions, POINTER), "pointer"));
    gltf_check(gltf,
               pointer == NULL || (strncmp(pointer, "/nodes/", 7) != 0 &&
                                   strncmp(pointer, "/meshes/", 8) != 0 &&
                                   strncmp(pointer, "/skins/", 7) != 0),
               "\"%.80s\" is moved by \"" POINTER "\", which is not read",
               pointer != NULL ? pointer : "");
    while (channel->path < GLTF_PATHS &&
           (path == NULL || strcmp(gltf_path_kinds[channel->path].name, path) != 0)) {
        channel->path++;
    }
    long long index = gltf_number(target, "node", -1);
    bool is_there = index >= 0 && (size_t)index < scene->node_count;
    if (json_object_get(target, "node") == NULL || channel->path == GLTF_PATHS ||
        !gltf_check_as(gltf, is_there, PCCD_E_INDEX, "there is no node %lld to move",
                       index)) {
        return false; /* by the specification it moves nothing */
    }
    const struct gltf_node *node = &scene->nodes[index];
    channel->node = (size_t)index;
    if (channel->path == GLTF_WEIGHTS) {
        return node->weight_count > 0;
    }
    gltf_check(gltf, !node->moves_mesh || !node->has_matrix,
               "node %lld: moves and has a matrix", index);
    return node->moves_mesh;
}

/* All channels that move a mesh, of all animations. Returns whether two of these move the
 * same. */
static bool find_channels(struct gltf_scene *scene)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_animation *animation = &scene->animation;
    const json_t *all = json_object_get(gltf->root, "animations"), *entry, *json;
    size_t count = 0, i, k;
    bool has_two = false;
    json_array_foreach(all, i, entry)
    {
        count += json_array_size(json_object_get(entry, "channels"));
    }
    animation->channels =
        gltf_alloc(gltf, count, sizeof(struct gltf_channel), "channels");
    json_array_foreach(all, i, entry)
    {
        size_t before = animation->channel_count;
        json_array_foreach(json_object_get(entry, "channels"), k, json)
        {
            struct gltf_channel made = {.json = json, .animation = i};
            if (!read_target(scene, &made) || gltf->status != PCCD_OK) {
                continue;
            }
            size_t *moved_by = &scene->nodes[made.node].moved_by[made.path];
            gltf_check(gltf, *moved_by != i + 1,
                       "animation %zu: moves the %s of node %zu twice", i,
                       gltf_path_kinds[made.path].name, made.node);
            has_two |= *moved_by != 0;
            *moved_by = i + 1;
            animation->channels[animation->channel_count++] = made;
        }
        animation->moving_count += animation->channel_count > before;
    }
    return has_two;
}

/* The number of the animation that is wished for; -1: there is none. */
static long long find_wish(struct gltf *gltf, const char *wish)
{
    const json_t *all = json_object_get(gltf->root, "animations"), *entry;
    size_t i;
    json_array_foreach(all, i, entry)
    {
        const char *name = json_string_value(json_object_get(entry, "name"));
        if (name != NULL && strcmp(name, wish) == 0) {
            return (long long)i;
        }
    }
    char *end;
    unsigned long number = strtoul(wish, &end, 10);
    bool is_number = *wish >= '0' && *wish <= '9' && *end == '\0';
    bool is_there = is_number && number < json_array_size(all);
    gltf_check_as(gltf, is_there, PCCD_E_INVAL,
                  "no animation has the name or number \"%.80s\", of %zu", wish,
                  json_array_size(all));
    return is_there ? (long long)number : -1;
}

/* Keep the channels that are played, and read their keys. */
static void choose(struct gltf_scene *scene, const char *wish)
{
    struct gltf_animation *animation = &scene->animation;
    long long wished = wish != NULL ? find_wish(&scene->gltf, wish) : -1;
    bool is_alone = find_channels(scene) || wish != NULL;
    size_t found = animation->channel_count, last = SIZE_MAX;
    if (scene->gltf.status != PCCD_OK) {
        return;
    }
    animation->first = wish != NULL ? (size_t)wished : animation->channels[0].animation;
    animation->channel_count = 0;
    for (size_t i = 0; i < found; i++) {
        struct gltf_channel channel = animation->channels[i];
        if (is_alone && channel.animation != animation->first) {
            continue;
        }
        read_sampler(scene, &channel);
        animation->channels[animation->channel_count++] = channel;
        animation->is_curved |= channel.between == GLTF_CUBICSPLINE;
        animation->read_count += channel.animation != last;
        last = channel.animation;
    }
}

/* ---- frames ------------------------------------------------------------------------ */

static int order_of_times(const void *a, const void *b)
{
    double difference = *(const double *)a - *(const double *)b;
    return difference < 0 ? -1 : difference > 0;
}

/* The keys of all channels, each time once. */
static void collect_times(struct gltf *gltf, struct gltf_animation *animation)
{
    size_t accessors = gltf_entry_count(gltf, "accessors"), all = 0, count = 0;
    const struct gltf_accessor **found =
        gltf_alloc(gltf, accessors, sizeof *found, "accessors");
    for (size_t i = 0; found != NULL && i < animation->channel_count; i++) {
        const struct gltf_accessor *keys = &animation->channels[i].times;
        all += found[keys->index] == NULL ? keys->count : 0;
        found[keys->index] = keys;
    }
    double *times = gltf_alloc(gltf, all, sizeof *times, "keys");
    if (found == NULL || times == NULL || all == 0) {
        return;
    }
    for (size_t i = 0; i < accessors; i++) {
        for (size_t key = 0; found[i] != NULL && key < found[i]->count; key++) {
            gltf_read(found[i], key, &times[count++]);
        }
    }
    qsort(times, count, sizeof *times, order_of_times);
    animation->times = times;
    animation->time_count = 1;
    for (size_t i = 1; i < count; i++) {
        if (times[i] != times[animation->time_count - 1]) {
            times[animation->time_count++] = times[i];
        }
    }
}

double gltf_animation_time(const struct gltf_animation *animation, uint32_t frame)
{
    bool is_last = frame + 1 == animation->frame_count;
    return animation->rate == 0 ? animation->times[frame]
           : is_last            ? animation->times[animation->time_count - 1]
                                : animation->times[0] + frame / animation->rate;
}

/* Return how far a node turns between two frames, in degrees: by its rotation at each,
 * the shorter way. */
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
            double cosine = fabs(product(a, b));
            double turn = frame > 0 && cosine < 1 ? 2 * acos(cosine) * DEGREES : 0;
            greatest = turn > greatest ? turn : greatest;
            memcpy(a, b, sizeof a);
        }
    }
    return greatest;
}

void gltf_animation_read(struct gltf_scene *scene, const struct ctl_motion_wish *wish)
{
    struct gltf *gltf = &scene->gltf;
    struct gltf_animation *animation = &scene->animation;
    double rate = animation->rate = wish != NULL ? wish->rate : 0;
    choose(scene, wish != NULL ? wish->animation : NULL);
    if (gltf->status == PCCD_OK) {
        collect_times(gltf, animation);
    }
    if (gltf->status != PCCD_OK || animation->time_count == 0) {
        return;
    }
    double first = animation->times[0],
           last = animation->times[animation->time_count - 1];
    double frames = rate == 0 ? (double)animation->time_count
                              : ceil((last - first) * rate - RATE_ROUNDING) + 1;
    if (gltf_check_as(gltf, frames <= (double)CTL_MESH_COUNT_MAX, PCCD_E_LIMIT,
                      "%g frames from %g s to %g s, at most %" PRIu64, frames, first,
                      last, CTL_MESH_COUNT_MAX)) {
        animation->frame_count = (uint32_t)frames;
        animation->turn_degrees = find_turn(animation);
    }
}
