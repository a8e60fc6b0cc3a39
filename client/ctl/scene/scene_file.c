/* scene_file.c - scene files: JSON that names meshes and says what they may meet. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"
#include "scene.h"
#include "shown.h"
#include "text.h"

#define SCENE_VERSION 1
#define GROUPS_MAX    63u /* bits of a group or mask, but for the one of a new object */
#define UNIT_MIN      1e-18
#define LENGTH_MAX    1e18
#define RINGS_MAX     8.0
#define FRAMES_MAX    1048576.0

bool scene_is_named(const char *path)
{
    size_t length = strlen(path);
    return length > 5 && strcmp(path + length - 5, ".json") == 0;
}

/* ---- members ----------------------------------------------------------------------- */

enum form {
    REAL,
    WHOLE,
    TRUTH,
    TEXT,
    TEXTS,
    WELD,
    FRAMES,
    OBJECTS,
    PAIRS,
    CLEARANCES,
    NUMBERS, /* `min` of them */
    WORD,
    JOINTS
};

struct member {
    const char *name;
    enum form form;
    double min, max; /* of numbers */
    const char *meaning;
};

static const struct member scene_members[] = {
    {"pccd_scene", WHOLE, SCENE_VERSION, SCENE_VERSION,
     "The version of this format, which says what the file is"},
    {"unit", REAL, UNIT_MIN, LENGTH_MAX,
     "Coordinates of files are multiplied by it, such as 0.01 for centimetres in a scene "
     "in metres (default: 1)"},
    {"rate", REAL, FRAMES_RATE_MIN, FRAMES_RATE_MAX,
     "Of files that move by themselves, frames a second (default: their keyframes)"},
    {"frames", FRAMES, 0, FRAMES_MAX,
     "The first and the last frame of the files, from 0"},
    {"objects", OBJECTS, 0, 0,
     "What there is. Objects with several frames have as many of them; one with a single "
     "frame stands"},
    {"ignore", PAIRS, 0, 0, "Names of two objects each that do not meet"},
    {"clearance", CLEARANCES, 0, LENGTH_MAX,
     "Names of two objects each, and a distance that they keep in the place of their "
     "thickness: at 0 they may be as near as they like, and may not pass through each "
     "other"},
    {"joints", JOINTS, 0, 0, "How objects move, for pccdctl sweep"},
    {0}};

static const struct member frames_members[] = {
    {"first", WHOLE, 0, FRAMES_MAX, "The first frame (default: 0)"},
    {"last", WHOLE, 0, FRAMES_MAX, "The last frame (default: the last one there is)"},
    {0}};

static const struct member joint_members[] = {
    {"name", TEXT, 0, 0, "Another one for each joint"},
    {"type", WORD, 0, 0, "How it moves"},
    {"parent", TEXT, 0, 0, "The joint that it hangs on (default: none)"},
    {"position", NUMBERS, 3, 0, "Of the joint, where its parent is at rest (default: 0)"},
    {"rpy", NUMBERS, 3, 0, "Its roll, pitch and yaw in radians, as in URDF (default: 0)"},
    {"axis", NUMBERS, 3, 0, "That it turns about or slides along (default: 1, 0, 0)"},
    {"range", NUMBERS, 2, 0, "Of its value: radians, or the unit of the scene"},
    {"follows", TEXT, 0, 0,
     "Another joint, whose value times multiplier plus offset is its value"},
    {"multiplier", REAL, -LENGTH_MAX, LENGTH_MAX, "As said (default: 1)"},
    {"offset", REAL, -LENGTH_MAX, LENGTH_MAX, "As said (default: 0)"},
    {0}};
static const char *const joint_types[] = {"fixed", "revolute", "continuous", "prismatic",
                                          NULL};

static const struct member object_members[] = {
    {"name", TEXT, 0, 0, "Another one for each object"},
    {"files", TEXTS, 0, 0,
     "The files of its frames as pccdctl check takes them, beside the scene file: meshes "
     "in their order, a pattern such as seq%d.obj, a mesh and a point cache"},
    {"unit", REAL, UNIT_MIN, LENGTH_MAX, "As of the scene, in its place"},
    {"rate", REAL, FRAMES_RATE_MIN, FRAMES_RATE_MAX, "As of the scene, in its place"},
    {"animation", TEXT, 0, 0, "As --animation"},
    {"weld", WELD, 0, LENGTH_MAX, "As --weld, in the unit of the files"},
    {"thickness", REAL, 0, LENGTH_MAX,
     "Radius of its features, in the unit of the scene"},
    {"rest_exclusion", REAL, 0, LENGTH_MAX, "As --rest-exclusion"},
    {"rings", WHOLE, 0, RINGS_MAX, "As --rings"},
    {"self", TRUTH, 0, 0, "Whether it meets itself (default: true)"},
    {"groups", TEXTS, 0, 0,
     "The groups that it is in, by names of your own; at most 63 in a scene (default: "
     "none)"},
    {"meets", TEXTS, 0, 0,
     "The groups that it may meet. Two objects meet if each is in a group that the other "
     "may meet (default: all)"},
    {"joint", TEXT, 0, 0,
     "The joint that it hangs on: its files are in the frame of that (default: none)"},
    {0}};

static const struct member *member_of(const struct member *members, const char *name)
{
    while (members->name != NULL && strcmp(members->name, name) != 0) {
        members++;
    }
    return members;
}

/* ---- lines ------------------------------------------------------------------------- */

/* Where a value is: by these members and places, up to one that is all zero. */
struct step {
    const char *key; /* NULL: an element */
    size_t index;    /* from 1 */
};

/* jansson does not tell where values are. What follows walks through a text that it has
 * found right. */

static const char *skip_blanks(const char *at)
{
    return at + strspn(at, " \t\r\n");
}

static const char *skip_string(const char *at)
{
    for (at++; *at != '"'; at++) {
        at += *at == '\\';
    }
    return at + 1;
}

static const char *skip_value(const char *at)
{
    int depth = 0;
    do {
        if (*at == '"') {
            at = skip_string(at);
            continue;
        }
        depth += (*at == '{' || *at == '[') - (*at == '}' || *at == ']');
        at++;
    } while (depth > 0 || strchr(",]} \t\r\n", *at) == NULL);
    return at;
}

/* The element or member of the value at `at` that a step says, or `at`. */
static const char *follow(const char *at, const struct step *step)
{
    const char *next = skip_blanks(at + 1);
    for (size_t i = 1; *next != ']' && *next != '}' && *next != '\0'; i++) {
        const char *found = next;
        if (step->key != NULL) {
            const char *end = skip_string(next);
            size_t length = strlen(step->key);
            next = skip_blanks(skip_blanks(end) + 1); /* behind the colon */
            if ((size_t)(end - found) == length + 2 &&
                memcmp(found + 1, step->key, length) == 0) {
                return next;
            }
        } else if (i == step->index) {
            return found;
        }
        next = skip_blanks(skip_value(next));
        next = *next == ',' ? skip_blanks(next + 1) : next;
    }
    return at;
}

static uint32_t line_of(const char *text, const struct step *steps)
{
    const char *at = skip_blanks(text);
    for (; steps->key != NULL || steps->index > 0; steps++) {
        at = follow(at, steps);
    }
    uint32_t line = 1;
    for (const char *c = text; c < at; c++) {
        line += *c == '\n';
    }
    return line;
}

/* ---- values ------------------------------------------------------------------------ */

struct reader {
    struct scene *scene;
    const char *text;
    size_t folder_bytes;            /* of scene->path, with its slash */
    const char *groups[GROUPS_MAX]; /* names, of the JSON */
    uint32_t group_count;
    double unit, rate; /* of all objects that do not say */
    struct ctl_error *error;
    int status;
};

__attribute__((format(printf, 3, 4))) static void
refuse(struct reader *reader, const struct step *steps, const char *format, ...)
{
    char what[CTL_ERROR_TEXT_BYTES];
    va_list arguments;
    if (reader->status != PCCD_OK) {
        return; /* the first fault is told */
    }
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    reader->status =
        ctl_error_set(reader->error, PCCD_E_FORMAT, "%s:%" PRIu32 ": %.700s",
                      reader->scene->path, line_of(reader->text, steps), what);
}

static void lack_memory(struct reader *reader)
{
    if (reader->status == PCCD_OK) {
        reader->status = ctl_error_set(reader->error, PCCD_E_NOMEM,
                                       "no memory for the scene %s", reader->scene->path);
    }
}

/* Where member `key` of a value at `at` is; `to` has room for all of it. */
static const struct step *join(struct step to[6], const struct step *at, const char *key,
                               size_t index)
{
    size_t count = 0;
    for (; at[count].key != NULL || at[count].index > 0; count++) {
        to[count] = at[count];
    }
    to[count] = (struct step){key, index};
    to[count + 1] = (struct step){NULL, 0};
    return to;
}

static void take_real(struct reader *reader, const json_t *of, const struct step *at,
                      const struct member *members, const char *key, double *to)
{
    const json_t *value = json_object_get(of, key);
    const struct member *member = member_of(members, key);
    struct step place[6];
    if (value == NULL) {
        return;
    }
    double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= member->min && number <= member->max)) {
        refuse(reader, join(place, at, key, 0), "\"%s\" is no number from %g to %g", key,
               member->min, member->max);
    } else if (member->form == WHOLE && number != floor(number)) {
        refuse(reader, join(place, at, key, 0), "\"%s\" is no whole number", key);
    } else {
        *to = number;
    }
}

/* Return whether it is there. */
static bool take_whole(struct reader *reader, const json_t *of, const struct step *at,
                       const struct member *members, const char *key, uint32_t *to)
{
    double number = *to;
    take_real(reader, of, at, members, key, &number);
    *to = (uint32_t)number;
    return json_object_get(of, key) != NULL;
}

/* Return a text; NULL: it is not there, or is none. */
static const char *take_text(struct reader *reader, const json_t *of,
                             const struct step *at, const char *key)
{
    const json_t *value = json_object_get(of, key);
    struct step place[6];
    if (value == NULL) {
        return NULL;
    }
    if (!json_is_string(value) || json_string_length(value) == 0) {
        refuse(reader, join(place, at, key, 0), "\"%s\" is no text", key);
        return NULL;
    }
    return json_string_value(value);
}

/* The texts of an array, or one text; 0: there is none. */
static size_t take_texts(struct reader *reader, const json_t *of, const struct step *at,
                         const char *key, const char ***to)
{
    const json_t *value = json_object_get(of, key);
    struct step place[6];
    size_t count = json_is_array(value) ? json_array_size(value) : value != NULL;
    *to = calloc(count + 1, sizeof **to);
    if (*to == NULL) {
        lack_memory(reader);
        return 0;
    }
    for (size_t i = 0; i < count; i++) {
        const json_t *element = json_is_array(value) ? json_array_get(value, i) : value;
        if (!json_is_string(element) || json_string_length(element) == 0) {
            refuse(reader, join(place, at, key, 0),
                   "\"%s\" is no text, and no list of texts", key);
            return 0;
        }
        (*to)[i] = json_string_value(element);
    }
    if (value != NULL && count == 0) {
        refuse(reader, join(place, at, key, 0), "\"%s\" is empty", key);
    }
    return count;
}

/* Refuse members that are not among `members`. */
static void check_members(struct reader *reader, json_t *of, const struct step *at,
                          const char *what, const struct member *members)
{
    const char *key;
    json_t *value;
    json_object_foreach(of, key, value)
    {
        char known[400] = "";
        struct step place[6];
        if (member_of(members, key)->name != NULL) {
            continue;
        }
        for (const struct member *member = members; member->name != NULL; member++) {
            strcat(strcat(known, " "), member->name);
        }
        refuse(reader, join(place, at, key, 0), "\"%s\" is no member of %s, which has%s",
               tool_shown(key), what, known);
    }
}

/* ---- objects ----------------------------------------------------------------------- */

/* A file beside the scene file. */
static char *beside(const struct reader *reader, const char *path)
{
    size_t folder = path[0] == '/' ? 0 : reader->folder_bytes;
    char *whole = malloc(folder + strlen(path) + 1);
    if (whole != NULL) {
        memcpy(whole, reader->scene->path, folder);
        strcpy(whole + folder, path);
    }
    return whole;
}

/* The bits of groups by their names, in the order in which names first come: an object
 * without groups is in none that has a name. */
static uint64_t take_groups(struct reader *reader, const json_t *of,
                            const struct step *at, const char *key)
{
    const char **names = NULL;
    size_t count = take_texts(reader, of, at, key, &names);
    struct step place[6];
    uint64_t bits = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t group = 0;
        while (group < reader->group_count &&
               strcmp(reader->groups[group], names[i]) != 0) {
            group++;
        }
        if (group == GROUPS_MAX) {
            refuse(reader, join(place, at, key, 0), "more than %u groups", GROUPS_MAX);
            break;
        }
        if (group == reader->group_count) {
            reader->groups[reader->group_count++] = names[i];
        }
        bits |= UINT64_C(2) << group;
    }
    free(names);
    return bits;
}

static void take_weld(struct reader *reader, const json_t *of, const struct step *at,
                      double *to)
{
    const json_t *value = json_object_get(of, "weld");
    const char *word = json_string_value(value);
    struct step place[6];
    if (word == NULL) {
        take_real(reader, of, at, object_members, "weld", to);
    } else if (strcmp(word, "auto") == 0 || strcmp(word, "off") == 0) {
        *to = word[0] == 'a' ? 0 : -1;
    } else {
        refuse(reader, join(place, at, "weld", 0),
               "\"weld\" is not auto, off or a length");
    }
}

/* Take what is said of thickness and of what may be met. */
static void take_settings(struct reader *reader, const json_t *of, const struct step *at,
                          struct pccd_object_settings *to)
{
    const json_t *self = json_object_get(of, "self");
    struct step place[6];
    take_real(reader, of, at, object_members, "thickness", &to->radius);
    take_real(reader, of, at, object_members, "rest_exclusion", &to->rest_distance);
    to->what |= json_object_get(of, "thickness") != NULL ? PCCD_OBJECT_RADIUS : 0u;
    to->what |=
        json_object_get(of, "rest_exclusion") != NULL ? PCCD_OBJECT_REST_DISTANCE : 0u;
    if (take_whole(reader, of, at, object_members, "rings", &to->rest_rings)) {
        to->what |= PCCD_OBJECT_REST_RINGS;
    }
    if (self != NULL && !json_is_boolean(self)) {
        refuse(reader, join(place, at, "self", 0), "\"self\" is neither true nor false");
    } else if (self != NULL) {
        to->what |= PCCD_OBJECT_SELF;
        to->self_collision = json_is_true(self);
    }
    if (json_object_get(of, "groups") != NULL) {
        to->what |= PCCD_OBJECT_GROUP;
        to->group = take_groups(reader, of, at, "groups");
    }
    if (json_object_get(of, "meets") != NULL) {
        to->what |= PCCD_OBJECT_MASK;
        to->mask = take_groups(reader, of, at, "meets");
    }
}

static void take_files(struct reader *reader, const json_t *of, const struct step *at,
                       struct scene_object *to)
{
    const char **names = NULL;
    size_t count = take_texts(reader, of, at, "files", &names);
    if (json_object_get(of, "files") == NULL) {
        refuse(reader, at, "an object has no \"files\"");
    }
    to->paths = calloc(count + 1, sizeof *to->paths);
    for (size_t i = 0; to->paths != NULL && i < count; i++) {
        to->paths[i] = beside(reader, names[i]);
        to->path_count += to->paths[i] != NULL;
    }
    if (to->paths == NULL || to->path_count != count) {
        lack_memory(reader);
    }
    free(names);
}

static void take_object(struct reader *reader, json_t *of, const struct step *at)
{
    struct scene *scene = reader->scene;
    struct step place[6];
    if (!json_is_object(of)) {
        refuse(reader, at, "an object is { ... }");
        return;
    }
    check_members(reader, of, at, "an object", object_members);
    const char *name = take_text(reader, of, at, "name");
    const char *animation = take_text(reader, of, at, "animation");
    const char *joint = take_text(reader, of, at, "joint");
    if (json_object_get(of, "name") == NULL) {
        refuse(reader, at, "an object has no \"name\"");
    } else if (name != NULL && scene_find(scene, name) < scene->object_count) {
        refuse(reader, join(place, at, "name", 0),
               "another object, of line %" PRIu32 ", has the name \"%s\"",
               scene->objects[scene_find(scene, name)].line, tool_shown(name));
    }
    if (reader->status != PCCD_OK) {
        return;
    }
    struct scene_object *to;
    reader->status = scene_append(scene, &to, reader->error);
    if (reader->status != PCCD_OK) {
        return;
    }
    to->unit = reader->unit;
    to->frames.wish.rate = reader->rate;
    to->line = line_of(reader->text, at);
    to->name = strdup(name);
    to->animation = animation != NULL ? strdup(animation) : NULL;
    to->joint = joint != NULL ? strdup(joint) : NULL;
    if (to->name == NULL || (animation != NULL && to->animation == NULL) ||
        (joint != NULL && to->joint == NULL)) {
        lack_memory(reader);
    }
    to->frames.wish.animation =
        to->animation != NULL ? to->animation : to->frames.wish.animation;
    take_files(reader, of, at, to);
    take_real(reader, of, at, object_members, "unit", &to->unit);
    take_real(reader, of, at, object_members, "rate", &to->frames.wish.rate);
    take_weld(reader, of, at, &to->frames.weld);
    take_settings(reader, of, at, &to->settings);
}

/* ---- joints ------------------------------------------------------------------------ */

/* Return whether the numbers are there. */
static bool take_numbers(struct reader *reader, const json_t *of, const struct step *at,
                         const char *key, double *to)
{
    const json_t *value = json_object_get(of, key);
    size_t count = (size_t)member_of(joint_members, key)->min;
    struct step place[6];
    bool is_right = json_array_size(value) == count;
    for (size_t i = 0; i < count && is_right; i++) {
        to[i] = json_number_value(json_array_get(value, i));
        is_right = json_is_number(json_array_get(value, i)) && fabs(to[i]) <= LENGTH_MAX;
    }
    if (value != NULL && !is_right) {
        refuse(reader, join(place, at, key, 0), "\"%s\" is no list of %zu numbers", key,
               count);
    }
    return value != NULL;
}

static char *take_copy(struct reader *reader, const json_t *of, const struct step *at,
                       const char *key)
{
    const char *text = take_text(reader, of, at, key);
    char *copy = text != NULL ? strdup(text) : NULL;
    if (text != NULL && copy == NULL) {
        lack_memory(reader);
    }
    return copy;
}

static void take_joint(struct reader *reader, json_t *of, const struct step *at,
                       struct scene_joint *to)
{
    const char *type = take_text(reader, of, at, "type");
    struct step place[6];
    check_members(reader, of, at, "a joint", joint_members);
    to->line = line_of(reader->text, at);
    to->axis[0] = to->multiplier = 1;
    to->name = take_copy(reader, of, at, "name");
    to->parent = take_copy(reader, of, at, "parent");
    to->follows = take_copy(reader, of, at, "follows");
    if (to->name == NULL || type == NULL) {
        refuse(reader, at, "a joint has no \"%s\"", to->name == NULL ? "name" : "type");
        return;
    }
    int word = 0;
    while (joint_types[word] != NULL && strcmp(joint_types[word], type) != 0) {
        word++;
    }
    if (joint_types[word] == NULL) {
        refuse(reader, join(place, at, "type", 0),
               "\"%s\" is no type of joint: fixed, revolute, continuous or prismatic",
               tool_shown(type));
        return;
    }
    to->type = (enum scene_joint_type)word;
    (void)take_numbers(reader, of, at, "position", to->position);
    (void)take_numbers(reader, of, at, "rpy", to->rpy);
    (void)take_numbers(reader, of, at, "axis", to->axis);
    bool has_range = take_numbers(reader, of, at, "range", to->range);
    bool has_ends = to->type == SCENE_REVOLUTE || to->type == SCENE_PRISMATIC;
    if (has_ends && to->follows == NULL && !has_range) {
        refuse(reader, at, "joint \"%s\": %s, and no \"range\"", tool_shown(to->name),
               type);
    }
    take_real(reader, of, at, joint_members, "multiplier", &to->multiplier);
    take_real(reader, of, at, joint_members, "offset", &to->offset);
}

static void take_joints(struct reader *reader, const json_t *all)
{
    struct scene *scene = reader->scene;
    const struct step at_joints[] = {{"joints", 0}, {NULL, 0}};
    size_t count = json_array_size(all);
    if (all != NULL && (count == 0 || count > SCENE_OBJECTS_MAX)) {
        refuse(reader, at_joints, "\"joints\" is no list of 1 to %u of them",
               SCENE_OBJECTS_MAX);
    } else if (all != NULL && !scene->takes_joints) {
        refuse(reader, at_joints, "joints are moved by pccdctl sweep alone");
    }
    scene->joints = calloc(count + 1, sizeof *scene->joints);
    if (scene->joints == NULL) {
        lack_memory(reader);
    }
    for (size_t i = 0; i < count && reader->status == PCCD_OK; i++) {
        const struct step at[] = {{"joints", 0}, {NULL, i + 1}, {NULL, 0}};
        take_joint(reader, json_array_get(all, i), at, &scene->joints[i]);
        scene->joint_count++;
    }
}

/* ---- the file ---------------------------------------------------------------------- */

/* Find the two objects that an item of a list of pairs begins with. */
static void take_pair(struct reader *reader, const json_t *pair, const struct step *place,
                      const char *list, uint32_t objects[2])
{
    struct scene *scene = reader->scene;
    for (size_t k = 0; k < 2 && reader->status == PCCD_OK; k++) {
        const char *name = json_string_value(json_array_get(pair, k));
        objects[k] = name != NULL ? scene_find(scene, name) : scene->object_count;
        if (objects[k] == scene->object_count) {
            refuse(reader, place, "\"%s\": no object has the name \"%s\"", list,
                   name != NULL ? tool_shown(name) : "");
        }
    }
}

/* Pairs of names, with a distance behind each or not. */
static void take_pairs(struct reader *reader, const json_t *root, const char *list,
                       bool has_clearance)
{
    struct scene *scene = reader->scene;
    const json_t *all = json_object_get(root, list);
    const struct step at[] = {{list, 0}, {NULL, 0}};
    if (all != NULL && !json_is_array(all)) {
        refuse(reader, at, "\"%s\" is no list of pairs of names%s", list,
               has_clearance ? " with a distance each" : "");
    }
    for (size_t i = 0; i < json_array_size(all) && reader->status == PCCD_OK; i++) {
        const json_t *pair = json_array_get(all, i);
        const json_t *said = json_array_get(pair, 2);
        const struct step place[] = {{list, 0}, {NULL, i + 1}, {NULL, 0}};
        uint32_t objects[2] = {0, 0};
        double clearance = json_number_value(said);
        if (json_array_size(pair) != (has_clearance ? 3u : 2u)) {
            refuse(reader, place, "a pair of \"%s\" is [\"name\", \"name\"%s]", list,
                   has_clearance ? ", distance" : "");
        }
        take_pair(reader, pair, place, list, objects);
        if (reader->status == PCCD_OK && objects[0] == objects[1]) {
            refuse(reader, place,
                   has_clearance ? "a clearance is of two objects"
                                 : "an object ignores itself by \"self\": false");
        }
        if (reader->status == PCCD_OK && has_clearance &&
            (!json_is_number(said) || !(clearance >= 0 && clearance <= LENGTH_MAX))) {
            refuse(reader, place, "a clearance is a number from 0 to %g", LENGTH_MAX);
        }
        if (reader->status == PCCD_OK) {
            reader->status =
                has_clearance
                    ? scene_keep_clearance(scene, objects[0], objects[1], clearance,
                                           reader->error)
                    : scene_ignore(scene, objects[0], objects[1], reader->error);
        }
    }
}

static void take_scene(struct reader *reader, json_t *root)
{
    struct scene *scene = reader->scene;
    const struct step top[] = {{NULL, 0}};
    const struct step at_frames[] = {{"frames", 0}, {NULL, 0}};
    const struct step at_objects[] = {{"objects", 0}, {NULL, 0}};
    if (!json_is_object(root)) {
        refuse(reader, top, "a scene is { ... }");
        return;
    }
    check_members(reader, root, top, "a scene", scene_members);
    uint32_t version = SCENE_VERSION;
    if (!take_whole(reader, root, top, scene_members, "pccd_scene", &version)) {
        refuse(reader, top, "no \"pccd_scene\": %d, which says what the file is",
               SCENE_VERSION);
    }
    take_real(reader, root, top, scene_members, "unit", &reader->unit);
    take_real(reader, root, top, scene_members, "rate", &reader->rate);
    json_t *frames = json_object_get(root, "frames");
    if (frames != NULL && !json_is_object(frames)) {
        refuse(reader, at_frames, "\"frames\" is {\"first\": N, \"last\": N}");
    } else if (frames != NULL) {
        check_members(reader, frames, at_frames, "\"frames\"", frames_members);
        (void)take_whole(reader, frames, at_frames, frames_members, "first",
                         &scene->first);
        (void)take_whole(reader, frames, at_frames, frames_members, "last", &scene->last);
    }
    if (scene->first > scene->last) {
        refuse(reader, at_frames, "the first frame, %" PRIu32 ", is behind the last",
               scene->first);
    }
    const json_t *objects = json_object_get(root, "objects");
    if (json_array_size(objects) == 0) {
        refuse(reader, objects != NULL ? at_objects : top,
               "a scene has a list \"objects\" of one at least");
    }
    for (size_t i = 0; i < json_array_size(objects) && reader->status == PCCD_OK; i++) {
        const struct step at[] = {{"objects", 0}, {NULL, i + 1}, {NULL, 0}};
        take_object(reader, json_array_get(objects, i), at);
    }
    take_pairs(reader, root, "ignore", false);
    take_pairs(reader, root, "clearance", true);
    take_joints(reader, json_object_get(root, "joints"));
}

int scene_read_file(struct scene *scene, const char *path, struct ctl_error *error)
{
    struct ctl_file file = {.data = NULL};
    json_error_t fault;
    json_t *root = NULL;
    scene->path = strdup(path);
    if (scene->path == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    int status = ctl_file_open(path, &file, error);
    if (status == PCCD_OK) {
        status = ctl_file_load(&file, error);
    }
    if (status == PCCD_OK) {
        const char *text = ctl_file_start(&file); /* behind a byte order mark */
        size_t bytes = file.bytes - (size_t)(text - file.data);
        root = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &fault);
        if (root == NULL) {
            status = ctl_error_set(error, PCCD_E_FORMAT, "%s:%d: %s", path, fault.line,
                                   tool_shown(fault.text));
        }
    }
    if (status == PCCD_OK) {
        const char *slash = strrchr(path, '/');
        struct reader reader = {.scene = scene,
                                .text = ctl_file_start(&file),
                                .folder_bytes =
                                    slash != NULL ? (size_t)(slash + 1 - path) : 0,
                                .unit = 1,
                                .rate = scene->frames->wish.rate,
                                .error = error,
                                .status = PCCD_OK};
        take_scene(&reader, root);
        status = reader.status;
    }
    json_decref(root);
    ctl_file_deinit(&file);
    return status;
}

/* ---- the format -------------------------------------------------------------------- */

/* Return the value if all of it is there; else NULL. */
static json_t *keep_whole(json_t *value, bool is_whole)
{
    if (!is_whole) {
        json_decref(value);
    }
    return is_whole ? value : NULL;
}

static json_t *schema_of(const struct member *members, const char *const *needed);

static json_t *type_of(const struct member *member)
{
    static const char *const of_object[] = {"name", "files", NULL};
    static const char *const of_frames[] = {NULL};
    static const char *const of_joint[] = {"name", "type", NULL};
    switch (member->form) {
    case REAL:
        return json_pack("{s:s, s:f, s:f}", "type", "number", "minimum", member->min,
                         "maximum", member->max);
    case WHOLE:
        return json_pack("{s:s, s:I, s:I}", "type", "integer", "minimum",
                         (json_int_t)member->min, "maximum", (json_int_t)member->max);
    case TRUTH:
        return json_pack("{s:s}", "type", "boolean");
    case TEXT:
        return json_pack("{s:s, s:i}", "type", "string", "minLength", 1);
    case TEXTS:
        return json_pack("{s:[{s:s, s:i}, {s:s, s:i, s:{s:s, s:i}}]}", "anyOf", "type",
                         "string", "minLength", 1, "type", "array", "minItems", 1,
                         "items", "type", "string", "minLength", 1);
    case WELD:
        return json_pack("{s:[{s:[s, s]}, {s:s, s:f, s:f}]}", "anyOf", "enum", "auto",
                         "off", "type", "number", "minimum", member->min, "maximum",
                         member->max);
    case FRAMES:
        return schema_of(frames_members, of_frames);
    case OBJECTS:
        return json_pack("{s:s, s:i, s:i, s:o}", "type", "array", "minItems", 1,
                         "maxItems", (int)SCENE_OBJECTS_MAX, "items",
                         schema_of(object_members, of_object));
    case PAIRS:
        return json_pack("{s:s, s:{s:s, s:i, s:i, s:{s:s}}}", "type", "array", "items",
                         "type", "array", "minItems", 2, "maxItems", 2, "items", "type",
                         "string");
    case CLEARANCES:
        return json_pack("{s:s, s:{s:s, s:i, s:i, s:[{s:s}, {s:s}, {s:s, s:i, s:f}]}}",
                         "type", "array", "items", "type", "array", "minItems", 3,
                         "maxItems", 3, "prefixItems", "type", "string", "type", "string",
                         "type", "number", "minimum", 0, "maximum", member->max);
    case NUMBERS:
        return json_pack("{s:s, s:i, s:i, s:{s:s}}", "type", "array", "minItems",
                         (int)member->min, "maxItems", (int)member->min, "items", "type",
                         "number");
    case WORD:
        return json_pack("{s:[s, s, s, s]}", "enum", joint_types[0], joint_types[1],
                         joint_types[2], joint_types[3]);
    case JOINTS:
        return json_pack("{s:s, s:i, s:i, s:o}", "type", "array", "minItems", 1,
                         "maxItems", (int)SCENE_OBJECTS_MAX, "items",
                         schema_of(joint_members, of_joint));
    }
    return NULL;
}

static json_t *schema_of(const struct member *members, const char *const *needed)
{
    json_t *properties = json_object();
    json_t *required = json_array();
    bool ok = true;
    for (const struct member *member = members; member->name != NULL; member++) {
        json_t *type = type_of(member);
        json_set(type, "description", json_string(member->meaning), &ok);
        json_set(properties, member->name, type, &ok);
    }
    for (; *needed != NULL; needed++) {
        json_append(required, json_string(*needed), &ok);
    }
    json_t *schema =
        json_pack("{s:s, s:b, s:o, s:o}", "type", "object", "additionalProperties", 0,
                  "required", required, "properties", properties);
    return keep_whole(schema, ok);
}

json_t *scene_schema(void)
{
    static const char *const needed[] = {"pccd_scene", "objects", NULL};
    json_t *schema = schema_of(scene_members, needed);
    bool ok = true;
    json_set(schema, "$schema",
             json_string("https://json-schema.org/draft/2020-12/schema"), &ok);
    json_set(schema, "title", json_string("A scene of pccdctl"), &ok);
    return keep_whole(schema, ok);
}

json_t *scene_new(char *const *files, uint32_t count, struct ctl_error *error)
{
    const struct ctl_frames_options frames = {.weld = 0};
    struct scene scene = {.frames = &frames};
    json_t *objects = json_array();
    bool ok = true;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        json_t *name = json_string(files[i]);
        if (name == NULL) {
            status = ctl_error_set(error, PCCD_E_INVAL,
                                   "%s: the name is not UTF-8, which JSON cannot say",
                                   tool_shown(files[i]));
            break;
        }
        status = scene_add(&scene, &files[i], 1, error);
        if (status == PCCD_OK) {
            json_append(
                objects,
                json_pack("{s:s, s:O}", "name", scene.objects[i].name, "files", name),
                &ok);
        }
        json_decref(name);
    }
    scene_close(&scene);
    json_t *value =
        json_pack("{s:i, s:o}", "pccd_scene", SCENE_VERSION, "objects", objects);
    value = keep_whole(value, ok && status == PCCD_OK);
    if (value == NULL && status == PCCD_OK) {
        (void)ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    return value;
}
