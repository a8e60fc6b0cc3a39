/* look.c - what a child tells that no command does: folders, scenes, places. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ask_options.h"
#include "confined.h"
#include "coordinates.h"
#include "ctl.h"
#include "frames.h"
#include "mcp.h"
#include "output.h"
#include "scene.h"

#define FILES_MAX 20000u /* of a folder that are looked at */

/* ---- options ----------------------------------------------------------------------- */

/* Question about files, without one to the engine. */
struct look {
    struct option_arguments files;
    struct ctl_frames_options frames;
    struct scene_options scene;
    bool is_each;      /* each file is an object */
    uint32_t step;     /* 0: the first frame alone */
    const char *a, *b; /* of a record: features, as JSON */
    const char *output;
};

#define AT(member) offsetof(struct look, member)
static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = AT(files), .needed = "which files?"},
    {"each", .help = "Each file is an object", .type = OPTION_FLAG, .at = AT(is_each)},
    {"step", 0, "N", "The step", OPTION_U32, .at = AT(step), .min = 0, .max = UINT32_MAX},
    {"a", 0, "JSON", "Object and vertices of the first feature", OPTION_TEXT,
     .at = AT(a)},
    {"b", 0, "JSON", "The same of the second", OPTION_TEXT, .at = AT(b)},
    {"output", 0, "FILE", "Where it goes", OPTION_TEXT, .at = AT(output)},
    {0}};
static const struct option_table look_table = {
    .rows = rows,
    .parts = (const struct option_part[]){
        {&frames_table, AT(frames)}, {&scene_table, AT(scene)}, {0}}};
#undef AT

static int end(int status, const struct ctl_error *error)
{
    if (status != PCCD_OK) {
        ctl_error_tell(error);
    }
    return (int)ctl_exit_of(status, true);
}

static int print(json_t *value, bool ok, struct ctl_error *error)
{
    return output_json(value, ok, stdout)
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_NOMEM, "no memory for the answer");
}

/* ---- a folder ---------------------------------------------------------------------- */

/* Files that tools read, and folders. */
static bool is_of_use(const char *name, bool is_folder)
{
    static const char *const endings[] = {".rec",  ".pc2",  ".mdd", ".png",
                                          ".pccd", ".urdf", ".srdf"};
    bool is_it = is_folder || ctl_mesh_is_named(name) || scene_is_named(name);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        is_it = is_it || tool_ends_with(name, endings[i]);
    }
    return is_it && name[0] != '.';
}

static int compare_versions(const void *a, const void *b)
{
    return strverscmp(*(char *const *)a, *(char *const *)b);
}

static json_t *file_of(int folder, const char *name, bool *ok)
{
    struct stat info;
    json_t *file = json_object();
    bool is_there = fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) == 0;
    bool is_folder = is_there && S_ISDIR(info.st_mode);
    char named[300];
    snprintf(named, sizeof named, "%.256s%s", name, is_folder ? "/" : "");
    json_set(file, "file", json_text(named), ok);
    if (is_there && S_ISREG(info.st_mode)) {
        json_set_count(file, "bytes", (uint64_t)info.st_size, ok);
    }
    return file;
}

int mcp_look_folder(int argc, char **argv)
{
    struct ctl_error error = {.text = ""};
    const char *name = argc > 1 ? argv[1] : ".";
    int fd = tool_open(name);
    DIR *entries = fd >= 0 ? fdopendir(fd) : NULL;
    char **names = calloc(FILES_MAX, sizeof *names);
    size_t count = 0;
    bool ok = names != NULL;
    if (entries == NULL || !ok) {
        int status =
            ctl_error_set(&error, PCCD_E_SYSTEM, "%s: cannot read the folder: %s", name,
                          tool_why(errno));
        return end(status, &error); /* all of this process ends */
    }
    for (const struct dirent *entry; ok && (entry = readdir(entries)) != NULL;) {
        struct stat info;
        bool is_folder = fstatat(fd, entry->d_name, &info, AT_SYMLINK_NOFOLLOW) == 0 &&
                         S_ISDIR(info.st_mode);
        if (count < FILES_MAX && is_of_use(entry->d_name, is_folder)) {
            names[count] = strdup(entry->d_name);
            ok = names[count++] != NULL;
        }
    }
    qsort(names, ok ? count : 0, sizeof *names, compare_versions);
    json_t *list = json_array();
    for (size_t i = 0; ok && i < count; i++) {
        json_append(list, file_of(fd, names[i], &ok), &ok);
    }
    return end(print(json_pack("{s:o}", "rows", list), ok, &error), &error);
}

/* ---- a scene ----------------------------------------------------------------------- */

static json_t *point_of(const double x[3])
{
    return json_pack("[f, f, f]", x[0], x[1], x[2]);
}

static void get_vertex(const struct ctl_mesh *mesh, uint32_t vertex, double x[3])
{
    for (size_t k = 0; k < 3; k++) {
        x[k] = common_coordinate(mesh->x, mesh->format, 3 * (uint64_t)vertex + k);
    }
}

static json_t *object_of(const struct scene_object *object, bool *ok)
{
    const struct ctl_mesh *mesh = &object->at[0];
    double low[3] = {INFINITY, INFINITY, INFINITY}, x[3];
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        get_vertex(mesh, i, x);
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], x[k]);
            high[k] = fmax(high[k], x[k]);
        }
    }
    json_t *row = json_object();
    json_set(row, "object", json_text(object->name), ok);
    json_set(row, "file", json_text(object->paths[0]), ok);
    json_set_count(row, "frames", object->files.count, ok);
    json_set_count(row, "vertices", mesh->vertex_count, ok);
    json_set_count(row, "triangles", object->files.mesh.triangles.count, ok);
    json_set(row, "low", point_of(low), ok);
    json_set(row, "high", point_of(high), ok);
    return row;
}

/* Take the options and the scene that they name, and tell of it. */
static int look_at(int argc, char **argv,
                   int (*tell)(const struct look *look, struct scene *scene,
                               struct ctl_error *error))
{
    struct look look = {.step = 0};
    struct scene scene = {.frames = &look.frames};
    struct ctl_error error = {.text = ""};
    if (option_parse(&look_table, argc, argv, &look) != 0) {
        return CTL_USAGE;
    }
    int status = scene_take(&scene, &look.files, look.is_each, &look.scene, &error);
    if (status == PCCD_OK) {
        status = tell(&look, &scene, &error);
    }
    return end(status, &error);
}

static int open_first(struct scene *scene, struct ctl_error *error)
{
    int status = scene_open(scene, error);
    return status == PCCD_OK ? scene_read(scene, 0, error) : status;
}

static int tell_scene(const struct look *look, struct scene *scene,
                      struct ctl_error *error)
{
    bool ok = true;
    int status = open_first(scene, error);
    (void)look;
    if (status != PCCD_OK) {
        return status;
    }
    json_t *objects = json_array();
    for (uint32_t i = 0; i < scene->object_count; i++) {
        json_append(objects, object_of(&scene->objects[i], &ok), &ok);
    }
    return print(
        json_pack("{s:I, s:o}", "frames", (json_int_t)scene->count, "rows", objects), ok,
        error);
}

int mcp_look_scene(int argc, char **argv)
{
    return look_at(argc, argv, tell_scene);
}

/* ---- the place of a record --------------------------------------------------------- */

/* Return the object that a feature is of: by its number from 1, or by its name, behind
 * which the name of a part may stand. */
static const struct scene_object *object_named(const struct scene *scene,
                                               const json_t *named)
{
    uint32_t found = scene->object_count == 1 ? 0 : scene->object_count;
    size_t longest = 0;
    if (json_is_integer(named)) {
        json_int_t place = json_integer_value(named) - 1;
        return place >= 0 && place < (json_int_t)scene->object_count
                   ? &scene->objects[place]
                   : NULL;
    }
    const char *text = json_string_value(named);
    for (uint32_t i = 0; text != NULL && i < scene->object_count; i++) {
        const char *name = scene->objects[i].name;
        size_t length = strlen(name);
        if (strncmp(name, text, length) == 0 && length >= longest &&
            (text[length] == '\0' || text[length] == '/')) {
            found = i;
            longest = length;
        }
    }
    return found < scene->object_count ? &scene->objects[found] : NULL;
}

/* Return where the vertices of a feature are at the step's begin, and at its end. */
static json_t *feature_of(const struct scene *scene, uint32_t step, const char *text,
                          bool *ok)
{
    json_t *feature = json_loads(text != NULL ? text : "", 0, NULL);
    const struct scene_object *object =
        object_named(scene, json_object_get(feature, "object"));
    const json_t *vertices = json_object_get(feature, "vertices");
    json_t *start = json_array(), *stop = json_array();
    *ok = *ok && object != NULL;
    for (size_t i = 0; *ok && i < json_array_size(vertices); i++) {
        json_int_t vertex = json_integer_value(json_array_get(vertices, i));
        bool moves = object->files.count > 1 && step > 0;
        double x[3];
        *ok = vertex >= 0 && vertex < (json_int_t)object->files.mesh.vertex_count;
        if (*ok) {
            get_vertex(scene_at(object, moves ? step - 1 : 0), (uint32_t)vertex, x);
            json_append(start, point_of(x), ok);
            get_vertex(scene_at(object, moves ? step : 0), (uint32_t)vertex, x);
            json_append(stop, point_of(x), ok);
        }
    }
    json_t *all =
        json_pack("{s:s?, s:o, s:o}", "object", object != NULL ? object->name : NULL,
                  "start", start, "end", stop);
    json_decref(feature);
    return all;
}

static int tell_place(const struct look *look, struct scene *scene,
                      struct ctl_error *error)
{
    const uint32_t step = look->step, from = step > 0 ? step - 1 : 0;
    bool ok = true;
    int status = open_first(scene, error);
    if (status == PCCD_OK && step >= scene->count && step > 0) {
        status = ctl_error_set(error, PCCD_E_INVAL, "the files have changed since");
    }
    for (uint32_t i = from > 0 ? from : 1; i <= step && status == PCCD_OK; i++) {
        status = scene_read(scene, i, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    json_t *a = feature_of(scene, step, look->a, &ok);
    json_t *b = feature_of(scene, step, look->b, &ok);
    json_t *all = json_pack("{s:o, s:o, s:o, s:o}", "a", a, "b", b, "from",
                            json_text(scene_frame_name(scene, from)), "to",
                            json_text(scene_frame_name(scene, step)));
    return ok ? print(all, ok, error)
              : ctl_error_set(error, PCCD_E_INVAL, "the files have changed since");
}

int mcp_look_place(int argc, char **argv)
{
    return look_at(argc, argv, tell_place);
}

/* ---- a recording ------------------------------------------------------------------- */

/* Copy the recording, which has no name, to its place. */
static int copy(const struct frames_recording *recording, const char *path,
                uint64_t *bytes, struct ctl_error *error)
{
    static char some[1 << 16];
    struct whole_file file = {.to = NULL};
    int status = output_open(&file, path, false, error);
    ssize_t got = 1;
    *bytes = 0;
    while (status == PCCD_OK && got > 0) {
        got = pread(recording->fd, some, sizeof some, (off_t)*bytes);
        if (got > 0) {
            (void)fwrite(some, 1, (size_t)got, file.to);
            *bytes += (uint64_t)got;
        }
    }
    return output_close(&file, path, status == PCCD_OK && got == 0, error);
}

static int tell_record(const struct look *look, struct scene *scene,
                       struct ctl_error *error)
{
    struct ctl_link daemon = {.policy = CTL_LINK_PRIVATE_UNLESS_ENV};
    struct frames_recording recording = {.fd = -1};
    uint64_t bytes = 0;
    int status = frames_record(&recording, scene, &look->files, &daemon, error);
    if (status == PCCD_OK) {
        status = copy(&recording, look->output, &bytes, error);
    }
    if (status == PCCD_OK) {
        uint32_t steps = scene->count > 1 ? scene->count - 1 : 1;
        status = print(json_pack("{s:o, s:I, s:I}", "file", json_text(look->output),
                                 "bytes", (json_int_t)bytes, "steps", (json_int_t)steps),
                       true, error);
    }
    frames_forget(&recording);
    return status;
}

int mcp_look_record(int argc, char **argv)
{
    return look_at(argc, argv, tell_record);
}
