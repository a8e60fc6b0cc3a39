/* client/ctl/commands/cmd_render.c - pccdctl render.
 *
 * Room:     client/ctl.
 * Does:     draws one step of a recording, its contacts coloured by time.
 * Does not: need a screen or a graphics card.
 * Threads:  one.
 * Source:   still.h, picture.h.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "colour.h"
#include "ctl.h"
#include "output.h"
#include "picture.h"
#include "play_options.h"
#include "shown.h"
#include "still.h"

#define GROUPS   64u /* colours of times */
#define ZOOM_MAX 10000.0
#define SIDE_MIN 64u
#define DEGREE   0.017453292519943295

enum {
    OPTION_TIME = 256 + 64,
    OPTION_VIEW,
    OPTION_UP,
    OPTION_ZOOM,
    OPTION_SIZE,
    OPTION_AT,
    OPTION_OUTPUT = 'o'
};

struct render {
    struct play_options options;
    const char *path;
    double t;
    double azimuth, elevation; /* degrees */
    double zoom;
    enum picture_up up;
    uint32_t width, height;
    bool is_at_contacts;
};

static const struct argp_option option_list[] = {
    {"output", OPTION_OUTPUT, "FILE", 0,
     "Where the picture goes: FILE.png, or FILE.svg with contacts and legend as shapes "
     "and text",
     0},
    {"time", OPTION_TIME, "T", 0, "Show the step at time T, 0 to 1 (default: 1, its end)",
     0},
    {"view", OPTION_VIEW, "A,E", 0,
     "Look from azimuth A and elevation E, degrees (default: 25,16)", 0},
    {"up", OPTION_UP, "x|y|z", 0, "What is up: x, y (the default) or z", 0},
    {"at", OPTION_AT, "all|contacts", 0, "See all (the default), or the contacts", 0},
    {"zoom", OPTION_ZOOM, "Z", 0, "See it Z times as large", 0},
    {"size", OPTION_SIZE, "WxH", 0, "Of the picture, pixels (default: 1200x900)", 0},
    {0},
};

static bool ends_with(const char *text, const char *end)
{
    size_t length = strlen(text), tail = strlen(end);
    return length > tail && strcmp(text + length - tail, end) == 0;
}

/* "A,B" or "AxB" */
static void parse_two(const struct argp_state *state, const char *name, const char *text,
                      char between, double two[2])
{
    char *stop;
    two[0] = strtod(text, &stop);
    bool is_ok = stop != text && *stop == between;
    const char *rest = stop + 1;
    if (is_ok) {
        two[1] = strtod(rest, &stop);
    }
    if (!is_ok || stop == rest || *stop != '\0' || !isfinite(two[0]) ||
        !isfinite(two[1])) {
        tool_misused(state, "--%s: \"%s\" is not two numbers with a %c between them",
                     name, text, between);
    }
}

static void parse_size(const struct argp_state *state, const char *text,
                       struct render *render)
{
    double two[2] = {0, 0};
    parse_two(state, "size", text, 'x', two);
    for (int i = 0; i < 2; i++) {
        if (!(two[i] >= SIDE_MIN && two[i] <= PICTURE_SIDE_MAX)) {
            tool_misused(state, "--size: from %ux%u to %ux%u", SIDE_MIN, SIDE_MIN,
                         PICTURE_SIDE_MAX, PICTURE_SIDE_MAX);
        }
    }
    render->width = (uint32_t)two[0];
    render->height = (uint32_t)two[1];
}

static void parse_view(const struct argp_state *state, const char *text,
                       struct render *render)
{
    double two[2] = {0, 0};
    parse_two(state, "view", text, ',', two);
    if (fabs(two[1]) > 90) {
        tool_misused(state, "--view: the elevation is from -90 to 90");
    }
    render->azimuth = two[0];
    render->elevation = two[1];
}

static void parse_up(const struct argp_state *state, const char *text,
                     struct render *render)
{
    const char *const axes = "yzx";
    const char *at = text[0] != '\0' && text[1] == '\0' ? strchr(axes, text[0]) : NULL;
    if (at == NULL) {
        tool_misused(state, "--up: \"%s\" is not x, y or z", text);
        return;
    }
    render->up = (enum picture_up)(at - axes);
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct render *render = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &render->options;
        return 0;
    case OPTION_OUTPUT:
        if (!ends_with(text, ".png") && !ends_with(text, ".svg")) {
            tool_misused(state, "-o: \"%s\" ends with neither .png nor .svg", text);
        }
        render->path = text;
        return 0;
    case OPTION_TIME:
        render->t = ctl_option_real(state, "time", text, 0, 1);
        return 0;
    case OPTION_VIEW:
        parse_view(state, text, render);
        return 0;
    case OPTION_UP:
        parse_up(state, text, render);
        return 0;
    case OPTION_AT:
        if (strcmp(text, "all") != 0 && strcmp(text, "contacts") != 0) {
            tool_misused(state, "--at: \"%s\" is not all or contacts", text);
        }
        render->is_at_contacts = strcmp(text, "contacts") == 0;
        return 0;
    case OPTION_ZOOM:
        render->zoom = ctl_option_real(state, "zoom", text, 0.01, ZOOM_MAX);
        return 0;
    case OPTION_SIZE:
        parse_size(state, text, render);
        return 0;
    case ARGP_KEY_END:
        if (render->path == NULL) {
            tool_misused(state, "-o FILE.png or -o FILE.svg says what to draw");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&play_options_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_render = {
    .options = option_list,
    .parser = parse,
    .args_doc = "FILE",
    .doc = "Draw a step of a recording: its objects, and its contacts coloured by their "
           "time of impact.\vWithout --steps the last answered one is taken, with it the "
           "last of the range. The contacts are the recording's, or those of a daemon "
           "that repeats the step.",
    .children = children};

/* ---- drawing ----------------------------------------------------------------------- */

/* The direction to the eye: azimuth 0 looks along the axis after the one that is up. */
static void find_eye(const struct render *render, float from[3])
{
    double a = render->azimuth * DEGREE, e = render->elevation * DEGREE;
    uint32_t up = render->up == PICTURE_UP_Y ? 1 : render->up == PICTURE_UP_Z ? 2 : 0;
    from[up] = (float)sin(e);
    from[(up + 1) % 3] = (float)(cos(e) * cos(a));
    from[(up + 2) % 3] = (float)(cos(e) * sin(a));
}

static int draw(const struct render *render, const struct still *still, FILE *file,
                struct ctl_error *error)
{
    struct picture_mesh *meshes = calloc(still->object_count + 1, sizeof(*meshes));
    struct picture_mark *marks = calloc(still->contact_count + 1, sizeof(*marks));
    struct picture_group groups[GROUPS];
    struct picture_scale scale = {.title = "time of impact", .low = "0", .high = "1"};
    char title[128];
    if (meshes == NULL || marks == NULL) {
        free(meshes);
        free(marks);
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", render->path);
    }
    for (uint32_t i = 0; i < still->object_count; i++) {
        meshes[i].x = (const float(*)[3])still->objects[i].x;
        meshes[i].triangles = (const uint32_t(*)[3])still->objects[i].triangles;
        meshes[i].vertex_count = still->objects[i].vertex_count;
        meshes[i].triangle_count = still->objects[i].triangle_count;
        colour_of_object(i, meshes[i].front, meshes[i].back);
    }
    for (uint64_t i = 0; i < still->contact_count; i++) {
        double toi = still->contacts[i].toi;
        uint32_t group = toi > 0 ? (uint32_t)(toi * GROUPS) : 0;
        memcpy(marks[i].at, still->contacts[i].at, sizeof(marks[i].at));
        marks[i].group = group < GROUPS ? group : GROUPS - 1;
    }
    for (uint32_t i = 0; i < GROUPS; i++) {
        groups[i].label[0] = '\0';
        colour_of_time(((double)i + 0.5) / GROUPS, groups[i].colour);
    }
    snprintf(title, sizeof(title), "step %" PRIu64 ", %" PRIu64 " contacts", still->step,
             still->contact_count);
    struct picture picture = {.meshes = meshes,
                              .marks = marks,
                              .groups = groups,
                              .mesh_count = still->object_count,
                              .mark_count = (uint32_t)still->contact_count,
                              .group_count = GROUPS,
                              .up = render->up,
                              .width = render->width,
                              .height = render->height,
                              .zoom = (float)render->zoom,
                              .is_at_marks = render->is_at_contacts,
                              .title = title,
                              .scale = &scale};
    find_eye(render, picture.from);
    int status = picture_write(&picture, file, render->path, error);
    free(meshes);
    free(marks);
    return status;
}

int ctl_cmd_render(int argc, char **argv)
{
    struct render render = {.t = 1, .azimuth = 25, .elevation = 16};
    struct still still = {.object_count = 0};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    play_options_init(&render.options, "steps");
    render.options.play.source = PLAY_RECORDS;
    render.options.play.needs_records = true;
    render.options.play.only_last = true;
    if (argp_parse(&ctl_argp_render, argc, argv, 0, NULL, &render) != 0) {
        return CTL_USAGE;
    }
    int status = still_take(&render.options.play, render.t, &still, &summary, &error);
    if (status == PCCD_OK && still.object_count == 0) {
        status =
            ctl_error_set(&error, PCCD_E_INVAL,
                          "step %" PRIu64 " is of a scene without objects", still.step);
    }
    if (status == PCCD_OK) {
        status = output_open(&file, render.path, false, &error);
    }
    if (status == PCCD_OK) {
        status = draw(&render, &still, file.to, &error);
    }
    if (status == PCCD_OK) {
        status = output_finish(&file, render.path, &error);
    }
    whole_file_discard(&file);
    if (status == PCCD_OK) {
        play_options_warn(&render.options.play, &summary);
        still_report(&still, render.path, render.options.is_json);
    } else {
        play_complain(&error);
    }
    still_deinit(&still);
    play_options_deinit(&render.options);
    return play_exit(status, true);
}
