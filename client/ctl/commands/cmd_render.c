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
#include "render.h"
#include "whole_file.h"

#define RATE     25u
#define RATE_MAX 1000u
#define ZOOM_MAX 10000.0
#define SIDE_MIN 64u

/* "A,B" or "AxB" */
static void parse_two(const struct argp_state *state, const struct option_row *row,
                      const char *text, char between, double two[2])
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
        option_misused(state, "--%s: \"%s\" is not two numbers with a %c between them",
                       row->name, text, between);
    }
}

static void take_size(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct render *render = to;
    double two[2] = {0, 0};
    parse_two(state, row, text, 'x', two);
    for (int i = 0; i < 2; i++) {
        if (!(two[i] >= SIDE_MIN && two[i] <= PICTURE_SIDE_MAX)) {
            option_misused(state, "--size: from %ux%u to %ux%u", SIDE_MIN, SIDE_MIN,
                           PICTURE_SIDE_MAX, PICTURE_SIDE_MAX);
        }
    }
    render->width = (uint32_t)two[0];
    render->height = (uint32_t)two[1];
}

static void take_view(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct render *render = to;
    double two[2] = {0, 0};
    parse_two(state, row, text, ',', two);
    if (fabs(two[1]) > 90) {
        option_misused(state, "--view: the elevation is from -90 to 90");
    }
    render->azimuth = two[0];
    render->elevation = two[1];
}

/* all, contacts, first, or contact N, whose number is a word of its own or not. */
static void take_at(struct argp_state *state, const struct option_row *row,
                    const char *text, void *to)
{
    struct render *render = to;
    (void)row;
    bool is_one = strncmp(text, "contact", 7) == 0 && (text[7] == '\0' || text[7] == ' ');
    render->at = RENDER_AT_ONE;
    render->contact = SNAPSHOT_FIRST;
    if (is_one) {
        const char *number = text[7] == ' '              ? text + 8
                             : state->next < state->argc ? state->argv[state->next++]
                                                         : "";
        const struct option_row one = {"at contact", .min = 1, .max = INT64_MAX};
        render->contact = option_number(state, &one, number);
    } else if (strcmp(text, "first") != 0) {
        render->contact = 0;
        render->at = strcmp(text, "contacts") == 0 ? RENDER_AT_CONTACTS : RENDER_AT_ALL;
        if (render->at == RENDER_AT_ALL && strcmp(text, "all") != 0) {
            option_misused(state, "--at: \"%s\" is not all, contacts, first or contact N",
                           text);
        }
    }
}

static void take_output(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct render *render = to;
    (void)row;
    render->is_film = tool_ends_with(text, ".apng");
    if (!render->is_film && !tool_ends_with(text, ".png") &&
        !tool_ends_with(text, ".svg") && strcmp(text, "-") != 0) {
        option_misused(state, "-o: \"%s\" ends with neither .png, .svg nor .apng", text);
    }
    render->path = text;
}

static void check(struct argp_state *state, void *to)
{
    struct render *render = to;
    bool has_rate = render->rate > 0 && !play_options_are_frames(&render->options);
    if (render->at == RENDER_AT_FEW && (render->is_film || !isnan(render->t))) {
        render->at = RENDER_AT_ALL;
    }
    if ((has_rate || render->every > 0) && !render->is_film) {
        option_misused(state, "--%s is of a film: -o FILE.apng",
                       has_rate ? "rate" : "every");
    }
    if (render->is_film && render->rate > 0 &&
        (render->rate > RATE_MAX || render->rate != floor(render->rate))) {
        option_misused(state, "--rate: of a film a whole number up to %u", RATE_MAX);
    }
    if (render->is_film && (render->is_near || render->contact > 0)) {
        option_misused(state, "a film is of steps: no --near, --at first or contact N");
    }
    if (render->has_first_tries && (!render->is_film || !isnan(render->t))) {
        option_misused(state, "--first-tries is of a film, -o FILE.apng, that shows "
                              "beginnings: no --time");
    }
    if (render->is_near && (!isnan(render->t) || render->contact > 0)) {
        option_misused(state, "--near is of one moment, and has no contacts: no "
                              "--time, --at first or contact N");
    }
}

#define AT(member) offsetof(struct render, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"time", 0, "T",
     "Show the step at time T, 0 to 1 (default: 1, its end, or what --at says)",
     OPTION_REAL, .at = AT(t), .min = 0, .max = 1},
    {"near", 0, NULL,
     "Draw the last answer about what is near instead of contacts: lines between nearest "
     "points, coloured by distance, and edges that cross",
     OPTION_FLAG, .at = AT(is_near)},
    CTL_OUTPUT,
    {"output", 'o', "FILE",
     "Where the picture goes: FILE.png; FILE.svg with contacts and legend as shapes and "
     "text; FILE.apng, a film of all steps, which browsers show; -, a PNG to the "
     "standard output, and no report (default: the name of the first file, with .png)",
     OPTION_OWN, .at = AT(path), .take = take_output},
    {"rate", 0, "N",
     "Steps a second of a film (default: 25), and frames of a file that moves by itself "
     "(default: its keyframes)",
     OPTION_REAL, .at = AT(rate), .min = FRAMES_RATE_MIN, .max = FRAMES_RATE_MAX},
    {"every", 0, "N", "In a film, show every N-th step (default: 1)", OPTION_U32,
     .at = AT(every), .min = 1, .max = UINT32_MAX},
    {"first-tries", 0, NULL,
     "In a film, show steps at their beginning with what meets on their way, and leave "
     "out one that begins where the last one did: another try of the same frame",
     OPTION_FLAG, .at = AT(has_first_tries)},
    {"view", 0, "A,E", "Look from azimuth A and elevation E, degrees (default: 25,16)",
     OPTION_OWN, .take = take_view},
    {"up", 0, "x|y|z",
     "The axis that points up (default: as recorded; else the one along which things "
     "fall, if the motion is plain, or y)",
     OPTION_WORD, .at = AT(up), .min = 1},
    {"at", 0, "all|contacts|first|contact N",
     "Show all of the step, the contacts, the first of them, or contact N, counted from "
     "1 in the order of the answer. Without --at and --time, of a step with up to 20 "
     "contacts these are shown, else all. So few are drawn when the first of them "
     "happens, from a side where it is seen, unless --time or --view say otherwise; a "
     "ring is a contact that something hides",
     OPTION_OWN, .take = take_at},
    {"thick", 0, NULL,
     "Draw triangles with their thickness, too, and half of the step's separation around "
     "everything: what meets, touches. Without it rods and points alone have theirs",
     OPTION_FLAG, .at = AT(is_thick)},
    {"zoom", 0, "Z", "Enlarge the picture's contents Z times", OPTION_REAL,
     .at = AT(zoom), .min = 0.01, .max = ZOOM_MAX},
    {"size", 0, "WxH", "Size of the picture in pixels (default: 1200x900)", OPTION_OWN,
     .take = take_size},
    {0}};

const struct option_table ctl_table_render = {
    .rows = rows,
    .parts = (const struct option_part[]){{&play_film_table, AT(options)}, {0}},
    .check = check,
    .arguments = "FILE\nFRAME [FRAME...]\nSCENE",
    .text = "Draw a step of a recording, or of the frames of a mesh: its objects, "
            "and its contacts coloured by their time of impact.",
    .more = "Without --steps it is the last step that was answered, with --steps the "
            "last of the range. The contacts are those of the recording, or of a "
            "daemon that repeats the step.",
    .examples = "  pccdctl render -o hit.png a.obj b.obj\n"
                "  pccdctl render -o first.svg --steps 7 --at first run.rec\n",
};

static bool has_thickness(const struct snapshot *snapshot)
{
    bool has = snapshot->separation > 0;
    for (uint32_t i = 0; i < snapshot->object_count; i++) {
        has = has || snapshot->objects[i].radii != NULL;
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

/* Return whether the step begins elsewhere than the last one that was asked about. */
static bool begins_anew(struct shooting *shooting, const struct snapshot *snapshot)
{
    uint64_t begins = 1;
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        const struct snapshot_object *object = &snapshot->objects[o];
        begins = XXH3_64bits_withSeed(object->x, sizeof *object->x * object->vertex_count,
                                      begins ^ object->handle);
    }
    bool is_new = begins != shooting->begins;
    shooting->begins = begins;
    return is_new;
}

/* Asked once for each step of a pass. */
static bool is_shown(struct shooting *shooting, const struct snapshot *snapshot)
{
    const struct render *render = shooting->render;
    if (render->has_first_tries && !begins_anew(shooting, snapshot)) {
        return false;
    }
    return shooting->step_count++ % (render->every > 0 ? render->every : 1) == 0;
}

/* Room for a step, first, so that all of them are seen from one place. */
static int measure(void *context, const struct snapshot *snapshot,
                   struct ctl_error *error)
{
    struct shooting *shooting = context;
    if (!is_shown(shooting, snapshot)) {
        return PCCD_OK;
    }
    if (shooting->frame_count++ == FILM_FRAMES_MAX) {
        return ctl_error_set(error, PCCD_E_LIMIT, "%s: a film has at most %u steps",
                             shooting->render->path, FILM_FRAMES_MAX);
    }
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        const struct snapshot_object *object = &snapshot->objects[o];
        for (uint64_t i = 0; i < 3 * (uint64_t)object->vertex_count; i++) {
            double room = object->radii != NULL ? (double)object->radii[i / 3] : 0;
            double x = (double)object->x[i / 3][i % 3] + snapshot->origin[i % 3];
            shooting->low[i % 3] = fmin(shooting->low[i % 3], x - room);
            shooting->high[i % 3] = fmax(shooting->high[i % 3], x + room);
        }
    }
    return PCCD_OK;
}

static int shoot(void *context, const struct snapshot *snapshot, struct ctl_error *error)
{
    struct shooting *shooting = context;
    float bounds[2][3];
    if (!is_shown(shooting, snapshot)) {
        return PCCD_OK;
    }
    for (uint32_t k = 0; k < 3; k++) {
        bounds[0][k] = (float)(shooting->low[k] - snapshot->origin[k]);
        bounds[1][k] = (float)(shooting->high[k] - snapshot->origin[k]);
    }
    return render_draw(shooting->render, snapshot, NULL, &shooting->film,
                       (const float(*)[3])bounds, error);
}

/* Go through the steps of all parts; the pass that measures wants no contacts. */
static int pass(struct shooting *shooting, const struct play_settings *parts,
                bool measures, struct play_summary *summary, struct ctl_error *error)
{
    const struct render *render = shooting->render;
    double t = render->has_first_tries ? 0 : isnan(render->t) ? 1 : render->t;
    int status = PCCD_OK;
    for (; parts->path != NULL && status == PCCD_OK; parts++) {
        struct play_settings settings = *parts;
        settings.only_last = false;
        settings.needs_records = !measures;
        status = snapshot_each(&settings, t, measures ? measure : shoot, shooting,
                               summary, error);
    }
    return status;
}

int render_film(const struct render *render, const struct play_settings *parts, FILE *to,
                uint32_t *frame_count, struct play_summary *summary,
                struct ctl_error *error)
{
    struct render shown = *render;
    struct shooting shooting = {.render = &shown,
                                .low = {INFINITY, INFINITY, INFINITY},
                                .high = {-INFINITY, -INFINITY, -INFINITY}};
    shown.up = render->up != 0 ? render->up : play_up(parts);
    int status = pass(&shooting, parts, true, summary, error);
    if (status == PCCD_OK && !(shooting.low[0] <= shooting.high[0])) {
        status =
            ctl_error_set(error, PCCD_E_INVAL, "the steps are of scenes without objects");
    }
    if (status == PCCD_OK) {
        shooting.begins = 0;
        shooting.step_count = 0;
        film_begin(&shooting.film, to, render->path, shooting.frame_count,
                   render->rate > 0 ? (uint32_t)render->rate : RATE);
        status = pass(&shooting, parts, false, summary, error);
    }
    if (status == PCCD_OK && shooting.film.written != shooting.frame_count) {
        status =
            ctl_error_set(error, PCCD_E_STATE, "%s has changed meanwhile", parts->path);
    }
    if (status == PCCD_OK) {
        film_end(&shooting.film);
    }
    *frame_count = shooting.frame_count;
    return status;
}

static int make_film(const struct render *render, struct whole_file *file,
                     struct play_summary *summary, struct ctl_error *error)
{
    const struct play_settings parts[2] = {render->options.play};
    uint32_t frame_count = 0;
    int status = output_open(file, render->path, false, error);
    if (status == PCCD_OK) {
        status = render_film(render, parts, file->to, &frame_count, summary, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(file, render->path, error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&render->options.play, summary);
        snapshot_report_steps(render->path, frame_count, render->options.is_json);
    }
    return status;
}

/* ---- the command ------------------------------------------------------------------- */

static int make_picture(const struct render *render, struct whole_file *file,
                        struct play_summary *summary, struct ctl_error *error)
{
    const struct snapshot_at at = {.t = render->t,
                                   .contact = render->contact,
                                   .few = render->at == RENDER_AT_ALL ? 0 : RENDER_FEW};
    const struct play_settings parts[2] = {render->options.play};
    struct render shown = *render;
    struct snapshot snapshot = {.object_count = 0};
    shown.up = render->up != 0 ? render->up : play_up(parts);
    int status =
        render->is_near
            ? snapshot_take_near(&render->options.play, &snapshot, summary, error)
            : snapshot_take(&render->options.play, &at, &snapshot, summary, error);
    if (status == PCCD_OK && snapshot.object_count == 0) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "step %" PRIu64 " is of a scene without objects",
                               snapshot.step);
    }
    if (status == PCCD_OK) {
        status = output_open(file, render->path, true, error);
    }
    if (status == PCCD_OK) {
        status = render_draw(&shown, &snapshot, file->to, NULL, NULL, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(file, render->path, error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&render->options.play, summary);
        if (render->is_thick && !has_thickness(&snapshot)) {
            ctl_complain("nothing in %s %" PRIu64 " has a thickness",
                         render->is_near ? "question" : "step", snapshot.step);
        }
        if (strcmp(render->path, "-") != 0) {
            snapshot_report(&snapshot, render->path, render->options.is_json);
        }
    }
    snapshot_deinit(&snapshot);
    return status;
}

int ctl_cmd_render(int argc, char **argv)
{
    struct render render = {.at = RENDER_AT_FEW, .t = NAN, .azimuth = NAN};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    play_options_init(&render.options, "steps");
    render.options.takes_frames = true;
    render.options.play.source = PLAY_RECORDS;
    render.options.play.needs_records = true;
    render.options.play.only_last = true;
    if (option_parse(&ctl_table_render, argc, argv, &render) != 0) {
        return CTL_USAGE;
    }
    render.options.how.wish.rate = render.rate;
    if (render.path == NULL) {
        render.path = play_options_output(&render.options, ".png");
    }
    int status = render.path != NULL
                     ? play_options_open(&render.options, &error)
                     : ctl_error_set(&error, PCCD_E_NOMEM, "out of memory");
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
