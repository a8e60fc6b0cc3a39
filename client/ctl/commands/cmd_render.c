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
#include "plural.h"
#include "shown.h"
#include "still.h"
#include "viewpoint.h"

#define GROUPS      64u /* colours of times */
#define ZOOM_MAX    10000.0
#define SIDE_MIN    64u
#define DEGREE      0.017453292519943295
#define AZIMUTH     25.0
#define ELEVATION   16.0
#define PLACE_ROOM  1.6f /* around the features of a contact */
#define PLACE_LEAST 0.01 /* of the scene, where they have no size */

enum {
    OPTION_TIME = 256 + 64,
    OPTION_VIEW,
    OPTION_UP,
    OPTION_ZOOM,
    OPTION_SIZE,
    OPTION_AT,
    OPTION_NEAR,
    OPTION_THICK,
    OPTION_OUTPUT = 'o'
};

struct render {
    struct play_options options;
    const char *path;
    double t;                  /* NAN: not given */
    uint64_t contact;          /* that is to be seen; 0: none in particular */
    double azimuth, elevation; /* degrees; NAN: not given */
    double zoom;
    enum picture_up up;
    uint32_t width, height;
    bool is_at_contacts;
    bool is_near; /* what is near, and not contacts */
    bool is_thick;
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
    {"up", OPTION_UP, "x|y|z", 0, "The axis that points up: x, y (the default) or z", 0},
    {"at", OPTION_AT, "all|contacts|contact N", 0,
     "Show all (the default), the contacts, or contact N of the step, counted from 1 in "
     "the order of the answer. One contact is shown close, at its time of impact, from a "
     "side where nothing hides it, unless --time or --view say otherwise",
     0},
    {"near", OPTION_NEAR, NULL, 0,
     "Draw the last answer about what is near instead of contacts: lines between nearest "
     "points, coloured by distance, and edges that cross",
     0},
    {"thick", OPTION_THICK, NULL, 0,
     "Draw triangles with their thickness, too, and half of the step's separation around "
     "everything: what meets, touches. Without it rods and points alone have theirs",
     0},
    {"zoom", OPTION_ZOOM, "Z", 0, "Enlarge the picture's contents Z times", 0},
    {"size", OPTION_SIZE, "WxH", 0, "Size of the picture in pixels (default: 1200x900)",
     0},
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

/* all, contacts, or contact N, whose number is a word of its own or not. */
static void parse_at(struct argp_state *state, const char *text, struct render *render)
{
    bool is_one = strncmp(text, "contact", 7) == 0 && (text[7] == '\0' || text[7] == ' ');
    render->is_at_contacts = strcmp(text, "contacts") == 0;
    render->contact = 0;
    if (is_one) {
        const char *number = text[7] == ' '              ? text + 8
                             : state->next < state->argc ? state->argv[state->next++]
                                                         : "";
        render->contact = ctl_option_count(state, "at contact", number, 1, INT64_MAX);
    } else if (!render->is_at_contacts && strcmp(text, "all") != 0) {
        tool_misused(state, "--at: \"%s\" is not all, contacts or contact N", text);
    }
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
        parse_at(state, text, render);
        return 0;
    case OPTION_NEAR:
        render->is_near = true;
        return 0;
    case OPTION_THICK:
        render->is_thick = true;
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
        if (render->is_near && (!isnan(render->t) || render->contact > 0)) {
            tool_misused(state, "--near is of one moment, and has no contacts: neither "
                                "--time nor --at contact N");
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
    .args_doc = "FILE\nFRAME [FRAME...]",
    .doc =
        "Draw a step of a recording, or of the frames of a mesh: its objects, and its "
        "contacts coloured by their time of impact.\vWithout --steps it is the last step "
        "that was answered, with "
        "--steps the last of the range. The contacts are those of the recording, or of a "
        "daemon that repeats the step.",
    .children = children};

/* ---- drawing ----------------------------------------------------------------------- */

/* The direction to the eye: azimuth 0 looks along the axis after the one that is up. */
static void find_eye(const struct render *render, float from[3])
{
    bool is_given = !isnan(render->azimuth);
    double a = (is_given ? render->azimuth : AZIMUTH) * DEGREE;
    double e = (is_given ? render->elevation : ELEVATION) * DEGREE;
    uint32_t up = render->up == PICTURE_UP_Y ? 1 : render->up == PICTURE_UP_Z ? 2 : 0;
    from[up] = (float)sin(e);
    from[(up + 1) % 3] = (float)(cos(e) * cos(a));
    from[(up + 2) % 3] = (float)(cos(e) * sin(a));
}

static void name_step(const struct render *render, const struct still *still, char *title,
                      size_t room)
{
    if (render->is_near) {
        snprintf(title, room, "question %" PRIu64 ", %" PRIu64 " %s", still->step,
                 still->line_count, proto_plural(still->line_count, "record", "records"));
    } else if (render->contact > 0) {
        snprintf(title, room,
                 "step %" PRIu64 " at t = %.6g, contact %" PRIu64 " of %" PRIu64,
                 still->step, still->t, render->contact, still->contact_count);
    } else {
        snprintf(title, room, "step %" PRIu64 ", %" PRIu64 " %s", still->step,
                 still->contact_count,
                 proto_plural(still->contact_count, "contact", "contacts"));
    }
}

/* The features of the chosen contact, and what is around them. */
static struct picture_place place_of(const struct render *render,
                                     const struct still *still)
{
    struct picture_place place = {.radius = 0};
    if (render->contact > 0) {
        const struct still_contact *contact = &still->contacts[still->chosen];
        for (uint32_t k = 0; k < 3; k++) {
            place.at[k] = contact->at[k] +
                          (render->is_thick ? contact->share * contact->reach[k] : 0);
        }
        place.radius = contact->radius > 0 ? PLACE_ROOM * contact->radius
                                           : (float)(PLACE_LEAST * still->extent);
    }
    return place;
}

/* Lines by their shares of the greatest distance. */
static void mark_lines(const struct still *still, double greatest,
                       struct picture_mark *marks)
{
    for (uint64_t i = 0; i < still->line_count; i++) {
        double share = greatest > 0 ? still->lines[i].distance / greatest : 0;
        memcpy(marks[i].at, still->lines[i].ends[0], sizeof marks[i].at);
        memcpy(marks[i].to, still->lines[i].ends[1], sizeof marks[i].to);
        marks[i].is_line = true;
        marks[i].group = (uint32_t)(share * (GROUPS - 1));
    }
}

/* A dot, over a line to the nearest point of its first feature if it is at a distance;
 * the dot is where they touch. Returns how many marks there are now. */
static uint32_t mark_contact(const struct still_contact *contact, bool is_thick,
                             struct picture_mark *marks, uint32_t count)
{
    uint32_t group = contact->toi > 0 ? (uint32_t)(contact->toi * GROUPS) : 0;
    struct picture_mark mark = {.group = group < GROUPS ? group : GROUPS - 1};
    const float *reach = contact->reach;
    memcpy(mark.at, contact->at, sizeof mark.at);
    if (reach[0] != 0 || reach[1] != 0 || reach[2] != 0) {
        mark.is_line = true;
        for (uint32_t k = 0; k < 3; k++) {
            mark.to[k] = mark.at[k] + reach[k];
        }
        marks[count++] = mark;
        mark.is_line = false;
    }
    for (uint32_t k = 0; k < 3 && is_thick; k++) {
        mark.at[k] += contact->share * reach[k];
    }
    marks[count] = mark;
    return count + 1;
}

/* Contacts by their times, the chosen one over the others. Returns how many marks. */
static uint32_t mark_contacts(const struct render *render, const struct still *still,
                              struct picture_mark *marks)
{
    uint32_t count = 0;
    for (uint64_t i = 0; i < still->contact_count; i++) {
        if (render->contact == 0 || i != still->chosen) {
            count = mark_contact(&still->contacts[i], render->is_thick, marks, count);
        }
    }
    if (render->contact > 0) {
        count =
            mark_contact(&still->contacts[still->chosen], render->is_thick, marks, count);
        marks[count - 1].is_chosen = true;
    }
    return count;
}

static void make_meshes(const struct still *still, struct picture_mesh *meshes)
{
    for (uint32_t i = 0; i < still->object_count; i++) {
        const struct still_object *object = &still->objects[i];
        meshes[i] =
            (struct picture_mesh){.x = (const float(*)[3])object->x,
                                  .triangles = (const uint32_t(*)[3])object->triangles,
                                  .edges = (const uint32_t(*)[2])object->edges,
                                  .points = object->points,
                                  .radii = object->radii,
                                  .vertex_count = object->vertex_count,
                                  .triangle_count = object->triangle_count,
                                  .edge_count = object->edge_count,
                                  .point_count = object->point_count};
        colour_of_object(i, meshes[i].front, meshes[i].back);
    }
}

static int draw(const struct render *render, const struct still *still, FILE *file,
                struct ctl_error *error)
{
    struct picture_mesh *meshes = calloc(still->object_count + 1, sizeof *meshes);
    struct picture_mark *marks =
        calloc(2 * still->contact_count + still->line_count + 1, sizeof *marks);
    double greatest = still_greatest(still);
    struct picture_group groups[GROUPS];
    struct picture_scale scale = {.title = "time of impact", .low = "0", .high = "1"};
    char title[128];
    if (meshes == NULL || marks == NULL) {
        free(meshes);
        free(marks);
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", render->path);
    }
    make_meshes(still, meshes);
    uint32_t mark_count = still->lines != NULL ? (uint32_t)still->line_count
                                               : mark_contacts(render, still, marks);
    if (still->lines != NULL) {
        mark_lines(still, greatest, marks);
        snprintf(scale.title, sizeof scale.title, "distance");
        snprintf(scale.high, sizeof scale.high, "%.4g", greatest);
    }
    for (uint32_t i = 0; i < GROUPS; i++) {
        groups[i].label[0] = '\0';
        colour_of_time(((double)i + 0.5) / GROUPS, groups[i].colour);
    }
    name_step(render, still, title, sizeof title);
    struct picture_place place = place_of(render, still);
    struct picture picture = {.meshes = meshes,
                              .marks = marks,
                              .groups = groups,
                              .mesh_count = still->object_count,
                              .mark_count = mark_count,
                              .group_count = GROUPS,
                              .up = render->up,
                              .width = render->width,
                              .height = render->height,
                              .zoom = (float)render->zoom,
                              .is_at_marks = render->is_at_contacts,
                              .is_thick = render->is_thick,
                              .gap = (float)(still->separation / 2),
                              .place = render->contact > 0 ? &place : NULL,
                              .title = title,
                              .scale =
                                  still->lines == NULL || greatest > 0 ? &scale : NULL};
    find_eye(render, picture.from);
    if (render->contact > 0 && isnan(render->azimuth)) {
        viewpoint_choose(still, picture.from);
    }
    int status = picture_write(&picture, file, render->path, error);
    free(meshes);
    free(marks);
    return status;
}

static bool has_thickness(const struct still *still)
{
    bool has = still->separation > 0;
    for (uint32_t i = 0; i < still->object_count; i++) {
        has = has || still->objects[i].radii != NULL;
    }
    return has;
}

int ctl_cmd_render(int argc, char **argv)
{
    struct render render = {.t = NAN, .azimuth = NAN};
    struct still still = {.object_count = 0};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    play_options_init(&render.options, "steps");
    render.options.play.source = PLAY_RECORDS;
    render.options.play.needs_records = true;
    render.options.play.only_last = true;
    render.options.takes_frames = true;
    if (argp_parse(&ctl_argp_render, argc, argv, 0, NULL, &render) != 0) {
        return CTL_USAGE;
    }
    struct still_at at = {.t = render.t, .contact = render.contact};
    if (isnan(at.t) && at.contact == 0) {
        at.t = 1;
    }
    int status = play_options_open(&render.options, &error);
    if (status == PCCD_OK) {
        status = render.is_near
                     ? still_take_near(&render.options.play, &still, &summary, &error)
                     : still_take(&render.options.play, &at, &still, &summary, &error);
    }
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
        if (render.is_thick && !has_thickness(&still)) {
            ctl_complain("nothing in %s %" PRIu64 " has a thickness",
                         render.is_near ? "question" : "step", still.step);
        }
        still_report(&still, render.path, render.options.is_json);
    } else {
        ctl_error_tell(&error);
    }
    still_deinit(&still);
    play_options_deinit(&render.options);
    return (int)ctl_exit_of(status, true);
}
