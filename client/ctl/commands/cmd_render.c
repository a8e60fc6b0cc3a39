/* cmd_render.c - pccdctl render. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "ask_options.h"
#include "ctl.h"
#include "output.h"
#include "printable.h"
#include "render.h"
#include "shown.h"
#include "whole_file.h"

#define RATE     25u
#define RATE_MAX 1000u
#define ZOOM_MAX 10000.0
#define SIDE_MIN 64u

enum {
    OPTION_TIME = 256 + 64,
    OPTION_VIEW,
    OPTION_UP,
    OPTION_ZOOM,
    OPTION_SIZE,
    OPTION_AT,
    OPTION_NEAR,
    OPTION_THICK,
    OPTION_RATE,
    OPTION_EVERY,
    OPTION_FIRST_TRIES,
    OPTION_OUTPUT = 'o'
};

static const struct argp_option option_list[] = {
    {"output", OPTION_OUTPUT, "FILE", 0,
     "Where the picture goes: FILE.png; FILE.svg with contacts and legend as shapes and "
     "text; FILE.apng, a film of all steps, which browsers show",
     0},
    {"rate", OPTION_RATE, "N", 0,
     "Steps a second of a film (default: 25), and frames of a file that moves by itself "
     "(default: its keyframes)",
     0},
    {"every", OPTION_EVERY, "N", 0, "In a film, show every N-th step (default: 1)", 0},
    {"first-tries", OPTION_FIRST_TRIES, NULL, 0,
     "In a film, show steps at their beginning with what meets on their way, and leave "
     "out one that begins where the last one did: another try of the same frame",
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

static void refuse_what_contradicts(const struct argp_state *state,
                                    const struct render *render)
{
    if (render->path == NULL) {
        tool_misused(state, "-o FILE.png, .svg or .apng says what to draw");
    }
    bool has_rate = render->rate > 0 && !play_options_are_frames(&render->options);
    if ((has_rate || render->every > 0) && !render->is_film) {
        tool_misused(state, "--%s is of a film: -o FILE.apng",
                     has_rate ? "rate" : "every");
    }
    if (render->is_film && render->rate > 0 &&
        (render->rate > RATE_MAX || render->rate != floor(render->rate))) {
        tool_misused(state, "--rate: of a film a whole number up to %u", RATE_MAX);
    }
    if (render->is_film && (render->is_near || render->contact > 0)) {
        tool_misused(state, "a film is of steps: neither --near nor --at contact N");
    }
    if (render->has_first_tries && (!render->is_film || !isnan(render->t))) {
        tool_misused(state, "--first-tries is of a film, -o FILE.apng, that shows "
                            "beginnings: no --time");
    }
    if (render->is_near && (!isnan(render->t) || render->contact > 0)) {
        tool_misused(state, "--near is of one moment, and has no contacts: neither "
                            "--time nor --at contact N");
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
        render->is_film = tool_ends_with(text, ".apng");
        if (!render->is_film && !tool_ends_with(text, ".png") &&
            !tool_ends_with(text, ".svg")) {
            tool_misused(state, "-o: \"%s\" ends with neither .png, .svg nor .apng",
                         text);
        }
        render->path = text;
        return 0;
    case OPTION_RATE:
        render->rate = frames_option_rate(state, text);
        return 0;
    case OPTION_EVERY:
        render->every = (uint32_t)ctl_option_count(state, "every", text, 1, UINT32_MAX);
        return 0;
    case OPTION_FIRST_TRIES:
        render->has_first_tries = true;
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
        refuse_what_contradicts(state, render);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&play_film_argp, 0, NULL, 0}, {0}};
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

static bool has_thickness(const struct still *still)
{
    bool has = still->separation > 0;
    for (uint32_t i = 0; i < still->object_count; i++) {
        has = has || still->objects[i].radii != NULL;
    }
    return has;
}

/* ---- a film ------------------------------------------------------------------------ */

struct shooting {
    const struct render *render;
    double low[3], high[3]; /* of the box around all steps */
    uint32_t frame_count;
    uint64_t step_count; /* that could be shown, --every aside */
    uint64_t begins; /* digest of the places where the last step that was met begins */
    struct film film;
};

/* Does it begin elsewhere than the last step that was asked about? */
static bool begins_anew(struct shooting *shooting, const struct still *still)
{
    uint64_t begins = 1;
    for (uint32_t o = 0; o < still->object_count; o++) {
        const struct still_object *object = &still->objects[o];
        begins = XXH3_64bits_withSeed(object->x, sizeof *object->x * object->vertex_count,
                                      begins ^ object->handle);
    }
    bool is_new = begins != shooting->begins;
    shooting->begins = begins;
    return is_new;
}

/* Asked once for each step of a pass. */
static bool is_shown(struct shooting *shooting, const struct still *still)
{
    const struct render *render = shooting->render;
    if (render->has_first_tries && !begins_anew(shooting, still)) {
        return false;
    }
    return shooting->step_count++ % (render->every > 0 ? render->every : 1) == 0;
}

/* Room for a step, first, so that all of them are seen from one place. */
static int measure(void *context, const struct still *still, struct ctl_error *error)
{
    struct shooting *shooting = context;
    if (!is_shown(shooting, still)) {
        return PCCD_OK;
    }
    if (shooting->frame_count++ == FILM_FRAMES_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: a film has at most %u steps",
                             shooting->render->path, FILM_FRAMES_MAX);
    }
    for (uint32_t o = 0; o < still->object_count; o++) {
        const struct still_object *object = &still->objects[o];
        for (uint64_t i = 0; i < 3 * (uint64_t)object->vertex_count; i++) {
            double room = object->radii != NULL ? (double)object->radii[i / 3] : 0;
            double x = (double)object->x[i / 3][i % 3] + still->origin[i % 3];
            shooting->low[i % 3] = fmin(shooting->low[i % 3], x - room);
            shooting->high[i % 3] = fmax(shooting->high[i % 3], x + room);
        }
    }
    return PCCD_OK;
}

static int shoot(void *context, const struct still *still, struct ctl_error *error)
{
    struct shooting *shooting = context;
    float bounds[2][3];
    if (!is_shown(shooting, still)) {
        return PCCD_OK;
    }
    for (uint32_t k = 0; k < 3; k++) {
        bounds[0][k] = (float)(shooting->low[k] - still->origin[k]);
        bounds[1][k] = (float)(shooting->high[k] - still->origin[k]);
    }
    return render_draw(shooting->render, still, NULL, &shooting->film,
                       (const float(*)[3])bounds, error);
}

static void report_film(const struct render *render, uint32_t frame_count)
{
    if (render->options.is_json) {
        json_t *object = json_pack("{s:o, s:I}", "file", json_text(render->path), "steps",
                                   (json_int_t)frame_count);
        json_dumpf(object, stdout, JSON_TEXT_FLAGS);
        putchar('\n');
        json_decref(object);
    } else {
        printf("%s: %" PRIu32 " %s\n", tool_shown(render->path), frame_count,
               proto_plural(frame_count, "step", "steps"));
    }
}

/* All steps, twice: once for what is to be seen, without their contacts. */
static int make_film(const struct render *render, struct whole_file *file,
                     struct play_summary *summary, struct ctl_error *error)
{
    struct shooting shooting = {.render = render,
                                .low = {INFINITY, INFINITY, INFINITY},
                                .high = {-INFINITY, -INFINITY, -INFINITY}};
    struct play_settings settings = render->options.play;
    double t = render->has_first_tries ? 0 : isnan(render->t) ? 1 : render->t;
    settings.only_last = false;
    settings.needs_records = false;
    int status = still_each(&settings, t, measure, &shooting, summary, error);
    settings.needs_records = true;
    if (status == PCCD_OK && !(shooting.low[0] <= shooting.high[0])) {
        status =
            ctl_error_set(error, PCCD_E_INVAL, "the steps are of scenes without objects");
    }
    if (status == PCCD_OK) {
        status = output_open(file, render->path, false, error);
    }
    if (status == PCCD_OK) {
        shooting.begins = 0;
        shooting.step_count = 0;
        film_begin(&shooting.film, file->to, render->path, shooting.frame_count,
                   render->rate > 0 ? (uint32_t)render->rate : RATE);
        status = still_each(&settings, t, shoot, &shooting, summary, error);
    }
    if (status == PCCD_OK && shooting.film.written != shooting.frame_count) {
        status =
            ctl_error_set(error, PCCD_E_STATE, "%s has changed meanwhile", settings.path);
    }
    if (status == PCCD_OK) {
        status = film_end(&shooting.film, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(file, render->path, error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&settings, summary);
        report_film(render, shooting.frame_count);
    }
    return status;
}

/* ---- the command ------------------------------------------------------------------- */

static int make_picture(const struct render *render, struct whole_file *file,
                        struct play_summary *summary, struct ctl_error *error)
{
    struct still_at at = {.t = render->t, .contact = render->contact};
    struct still still = {.object_count = 0};
    if (isnan(at.t) && at.contact == 0) {
        at.t = 1;
    }
    int status = render->is_near
                     ? still_take_near(&render->options.play, &still, summary, error)
                     : still_take(&render->options.play, &at, &still, summary, error);
    if (status == PCCD_OK && still.object_count == 0) {
        status =
            ctl_error_set(error, PCCD_E_INVAL,
                          "step %" PRIu64 " is of a scene without objects", still.step);
    }
    if (status == PCCD_OK) {
        status = output_open(file, render->path, false, error);
    }
    if (status == PCCD_OK) {
        status = render_draw(render, &still, file->to, NULL, NULL, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(file, render->path, error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&render->options.play, summary);
        if (render->is_thick && !has_thickness(&still)) {
            ctl_complain("nothing in %s %" PRIu64 " has a thickness",
                         render->is_near ? "question" : "step", still.step);
        }
        still_report(&still, render->path, render->options.is_json);
    }
    still_deinit(&still);
    return status;
}

int ctl_cmd_render(int argc, char **argv)
{
    struct render render = {.t = NAN, .azimuth = NAN};
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
    render.options.how.wish.rate = render.rate;
    int status = play_options_open(&render.options, &error);
    if (status == PCCD_OK) {
        status = render.is_film ? make_film(&render, &file, &summary, &error)
                                : make_picture(&render, &file, &summary, &error);
    }
    whole_file_discard(&file);
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&render.options);
    return (int)ctl_exit_of(status, true);
}
