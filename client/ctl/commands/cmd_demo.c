/* client/ctl/commands/cmd_demo.c - pccdctl demo.
 *
 * Room:     client/ctl.
 * Does:     streams a falling cloth through the upload ring of a daemon, several steps in
 *           flight; ends with a table and a picture.
 * Does not: use the contacts to push the cloth: it only shows that they are found.
 * Threads:  one.
 * Source:   cloth_scene.h, demo_picture.h.
 */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloth_scene.h"
#include "ctl.h"
#include "demo_picture.h"
#include "json_text.h"
#include "link.h"
#include "output.h"
#include "picture.h"
#include "plural.h"
#include "progress.h"
#include "report.h"
#include "shown.h"
#include "statistics.h"

#define STEPS_DEFAULT 300u
#define STEPS_MAX     100000u
#define IN_FLIGHT                                                                        \
    3u /* one less than the ring's slots: the next step is written meanwhile */
#define OUTPUT_DEFAULT "./pccd-demo.png"
#define RIGID_BYTES    (2 * 12 * sizeof(double)) /* payload of a rigid segment */

enum { OPTION_STEPS = 256 + 64, OPTION_THREADS };

struct demo_options {
    struct ctl_query query;
    uint32_t steps;
    uint32_t threads;
    const char *output;
};

static const struct argp_option option_list[] = {
    {"steps", OPTION_STEPS, "N", 0, "Steps of a hundredth of a second (default: 300)", 0},
    {"output", 'o', "FILE", 0,
     "Where the picture goes, a PNG (default: " OUTPUT_DEFAULT ")", 0},
    {"threads", OPTION_THREADS, "N", 0,
     "Use at most N threads (default: the daemon decides)", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct demo_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->query;
        return 0;
    case OPTION_STEPS:
        options->steps = (uint32_t)ctl_option_count(state, "steps", text, 1, STEPS_MAX);
        return 0;
    case 'o':
        options->output = text;
        return 0;
    case OPTION_THREADS:
        options->threads = (uint32_t)ctl_option_count(state, "threads", text, 1, 1024);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_query_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_demo = {
    .options = option_list,
    .parser = parse,
    .doc =
        "Let a cloth fall over a turning ball, stream every step through a daemon, and "
        "show what was found, how long it took and where.\v"
        "Without --url and --socket a private daemon is started. The picture shows the "
        "contacts of the last step.",
    .children = children};

struct demo {
    const struct demo_options *options;
    struct pccd_client *client;
    struct cloth_scene *cloth;
    uint32_t scene;
    struct demo_object objects[2]; /* cloth, ball */
    struct pccd_edge *edges[2];    /* ours */
    float cloth_x[CLOTH_VERTICES][3];
    float ball_x[CLOTH_BALL_VERTICES][3];
    uint64_t waiting[IN_FLIGHT]; /* steps in flight, oldest at `answered` % IN_FLIGHT */
    uint32_t submitted, answered;
    struct pccd_answer last;             /* the newest answer; holds its records */
    double *step_ms;                     /* ours: [steps] */
    double phase_ms[REPORT_PHASE_COUNT]; /* sums */
    uint64_t contacts, vf, ee, possible, incomplete;
    struct progress progress;
};

static int fail(const struct demo *demo, int status, const char *what,
                struct ctl_error *error)
{
    const char *text = pccd_error_text(demo->client);
    return ctl_error_set(error, status, "%s: %s", what,
                         text[0] != '\0' ? text : pccd_status_text(status));
}

/* Register one mesh and place it; the picture needs its edges. */
static int add_object(struct demo *demo, uint32_t index, const float (*start)[3],
                      struct ctl_error *error)
{
    struct demo_object *object = &demo->objects[index];
    struct pccd_mesh_info info;
    uint32_t mesh;
    int status =
        pccd_mesh_create(demo->client, start, PCCD_FORMAT_F32, object->vertex_count,
                         object->triangles, object->triangle_count, &mesh, &info);
    if (status != PCCD_OK) {
        return fail(demo, status, "a mesh was not accepted", error);
    }
    demo->edges[index] = malloc(info.edge_count * sizeof(*demo->edges[index]));
    if (demo->edges[index] == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the edges");
    }
    object->edges = demo->edges[index];
    status = pccd_mesh_edges(demo->client, mesh, demo->edges[index], info.edge_count);
    if (status == PCCD_OK) {
        status = pccd_scene_add(demo->client, demo->scene, mesh, &object->object);
    }
    return status == PCCD_OK ? PCCD_OK
                             : fail(demo, status, "a mesh was not placed", error);
}

static int set_up(struct demo *demo, struct ctl_error *error)
{
    int status = cloth_scene_new(&demo->cloth, error);
    if (status != PCCD_OK) {
        return status;
    }
    const struct cloth_scene *cloth = demo->cloth;
    demo->objects[0] =
        (struct demo_object){.vertex_count = CLOTH_VERTICES,
                             .triangle_count = CLOTH_TRIANGLES,
                             .x = (const float(*)[3])demo->cloth_x,
                             .triangles = (const uint32_t(*)[3])cloth->cloth_triangles};
    demo->objects[1] =
        (struct demo_object){.vertex_count = CLOTH_BALL_VERTICES,
                             .triangle_count = CLOTH_BALL_TRIANGLES,
                             .x = (const float(*)[3])demo->ball_x,
                             .triangles = (const uint32_t(*)[3])cloth->ball_triangles};
    demo->step_ms = malloc(demo->options->steps * sizeof(*demo->step_ms));
    if (demo->step_ms == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    status = pccd_scene_create(demo->client, NULL, &demo->scene);
    if (status != PCCD_OK) {
        return fail(demo, status, "no scene", error);
    }
    status = add_object(demo, 0, (const float(*)[3])cloth->cloth_start, error);
    if (status == PCCD_OK) {
        status = add_object(demo, 1, (const float(*)[3])cloth->ball_start, error);
    }
    return status;
}

/* Move the cloth by a frame, straight into a slot, and submit it. */
static int submit(struct demo *demo, struct ctl_error *error)
{
    const uint64_t payload_bytes = sizeof(demo->cloth_x) + RIGID_BYTES;
    struct pccd_step_settings settings = {.threads = demo->options->threads};
    struct pccd_frame frame;
    double pose0[12], pose1[12];
    void *x1;
    cloth_scene_ball_pose(demo->cloth, pose0);
    cloth_scene_advance(demo->cloth);
    cloth_scene_ball_pose(demo->cloth, pose1);
    int status = pccd_frame_begin(demo->client, demo->scene, 2, payload_bytes, &frame);
    if (status != PCCD_OK) {
        return fail(demo, status, "no slot for a step", error);
    }
    status = pccd_frame_x1(&frame, demo->objects[0].object, PCCD_FORMAT_F32, 0,
                           CLOTH_VERTICES, &x1);
    if (status == PCCD_OK) {
        status = pccd_frame_rigid(&frame, demo->objects[1].object, 0, CLOTH_BALL_VERTICES,
                                  pose0, pose1);
    }
    if (status != PCCD_OK) {
        pccd_frame_abort(&frame);
        return fail(demo, status, "a step could not be written", error);
    }
    cloth_scene_positions(demo->cloth, x1);
    status =
        pccd_frame_commit(&frame, &settings, &demo->waiting[demo->submitted % IN_FLIGHT]);
    if (status != PCCD_OK) {
        return fail(demo, status, "a step could not be submitted", error);
    }
    demo->submitted++;
    return PCCD_OK;
}

/* Wait for the oldest step. The newest answer is kept, the one before given back. */
static int collect(struct demo *demo, struct ctl_error *error)
{
    struct pccd_answer answer;
    double ms[REPORT_PHASE_COUNT];
    uint64_t step = demo->waiting[demo->answered % IN_FLIGHT];
    int status = pccd_wait(demo->client, step, -1, &answer);
    if (status != PCCD_OK) {
        return fail(demo, status, "a step failed", error);
    }
    if (demo->answered > 0) {
        pccd_answer_release(demo->client, &demo->last);
    }
    demo->last = answer;
    report_phases(&answer.times, ms);
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        demo->phase_ms[phase] += ms[phase];
    }
    demo->step_ms[demo->answered] = ms[REPORT_step];
    demo->contacts += answer.total;
    demo->vf += answer.vf;
    demo->ee += answer.ee;
    demo->possible += answer.possible;
    demo->incomplete += answer.incomplete != PCCD_COMPLETE;
    demo->answered++;
    return PCCD_OK;
}

static int stream(struct demo *demo, struct ctl_error *error)
{
    const uint32_t steps = demo->options->steps;
    int status = PCCD_OK;
    progress_begin(&demo->progress, "steps", steps);
    while (demo->answered < steps && status == PCCD_OK) {
        bool is_full = demo->submitted - demo->answered == IN_FLIGHT;
        if (demo->submitted < steps && !is_full) {
            status = submit(demo, error);
        } else {
            status = collect(demo, error);
        }
        progress_update(&demo->progress, demo->answered);
    }
    progress_clear(&demo->progress);
    return status;
}

/* Where the meshes are at the end of the last step. */
static void place_last(struct demo *demo)
{
    double pose[12];
    cloth_scene_positions(demo->cloth, demo->cloth_x);
    cloth_scene_ball_pose(demo->cloth, pose);
    for (uint32_t i = 0; i < CLOTH_BALL_VERTICES; i++) {
        const float *x = demo->cloth->ball_start[i];
        for (uint32_t k = 0; k < 3; k++) {
            const double *row = pose + (size_t)k * 4;
            demo->ball_x[i][k] = (float)(row[0] * (double)x[0] + row[1] * (double)x[1] +
                                         row[2] * (double)x[2] + row[3]);
        }
    }
}

static void print_table(const struct demo *demo)
{
    const uint32_t steps = demo->options->steps;
    const struct pccd_answer *last = &demo->last;
    double whole = demo->phase_ms[REPORT_step], other = 100.0;
    printf("steps       %" PRIu32 ", up to %u in flight\n", steps, IN_FLIGHT);
    printf("triangles   %d: cloth %d, ball %d\n", CLOTH_TRIANGLES + CLOTH_BALL_TRIANGLES,
           CLOTH_TRIANGLES, CLOTH_BALL_TRIANGLES);
    printf("contacts    %" PRIu64 ": %" PRIu64 " vertex-face, %" PRIu64
           " edge-edge; %" PRIu64 " only possible\n",
           demo->contacts, demo->vf, demo->ee, demo->possible);
    printf("last step   %" PRIu64 ": %" PRIu64 " vertex-face, %" PRIu64 " edge-edge\n",
           last->total, last->vf, last->ee);
    if (demo->incomplete > 0) {
        printf("INCOMPLETE  %" PRIu64 " %s\n", demo->incomplete,
               proto_plural(demo->incomplete, "answer", "answers"));
    }
    printf("per step    p50 %.3f ms, p99 %.3f ms, max %.3f ms; %" PRIu32 " %s\n",
           statistics_median(demo->step_ms, steps),
           statistics_quantile(demo->step_ms, steps, 0.99), demo->step_ms[steps - 1],
           last->threads, proto_plural(last->threads, "thread", "threads"));
    for (uint32_t phase = 0; phase < REPORT_step; phase++) {
        double share = whole > 0 ? 100.0 * demo->phase_ms[phase] / whole : 0.0;
        printf("  %-10s%5.1f %%\n", report_phase_names[phase], share);
        other -= share;
    }
    printf("  %-10s%5.1f %%\n", "other", fmax(other, 0.0));
    printf("hash        %016" PRIx64 "%016" PRIx64 " of the last answer\n", last->hash[0],
           last->hash[1]);
}

static void print_json(const struct demo *demo)
{
    const uint32_t steps = demo->options->steps;
    char hash[33];
    snprintf(hash, sizeof hash, "%016" PRIx64 "%016" PRIx64, demo->last.hash[0],
             demo->last.hash[1]);
    json_t *phases = json_object();
    for (uint32_t phase = 0; phase <= REPORT_step; phase++) {
        json_object_set_new(phases, report_phase_names[phase],
                            json_real(demo->phase_ms[phase] / steps));
    }
    json_t *object = json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:I, s:o, s:s, s:o}", "steps",
        (json_int_t)steps, "triangles",
        (json_int_t)(CLOTH_TRIANGLES + CLOTH_BALL_TRIANGLES), "contacts",
        (json_int_t)demo->contacts, "vf", (json_int_t)demo->vf, "ee",
        (json_int_t)demo->ee, "possible", (json_int_t)demo->possible, "incomplete",
        (json_int_t)demo->incomplete, "p50_ms", statistics_median(demo->step_ms, steps),
        "p99_ms", statistics_quantile(demo->step_ms, steps, 0.99), "max_ms",
        demo->step_ms[steps - 1], "threads", (json_int_t)demo->last.threads, "mean_ms",
        phases, "hash", hash, "picture", json_text(demo->options->output));
    json_dumpf(object, stdout, JSON_TEXT_FLAGS);
    putchar('\n');
    json_decref(object);
}

static void tear_down(struct demo *demo)
{
    pccd_close(demo->client);
    cloth_scene_free(demo->cloth);
    free(demo->edges[0]);
    free(demo->edges[1]);
    free(demo->step_ms);
    free(demo);
}

static int run_demo(const struct demo_options *options)
{
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    struct demo *demo = calloc(1, sizeof(*demo));
    if (demo == NULL) {
        return ctl_complain("out of memory");
    }
    demo->options = options;
    int status = output_open(&file, options->output, false, &error);
    if (status == PCCD_OK &&
        ctl_link_open(&options->query.link, &demo->client) != CTL_DONE) {
        status = PCCD_E_NODAEMON; /* and has been told */
    }
    if (status == PCCD_OK) {
        status = set_up(demo, &error);
    }
    if (status == PCCD_OK) {
        status = stream(demo, &error);
    }
    if (status == PCCD_OK) {
        place_last(demo);
        statistics_sort(demo->step_ms, options->steps);
        if (!options->query.is_json) {
            print_table(demo);
        }
        status = demo_picture_write(demo->objects, &demo->last, file.to, options->output,
                                    &error);
        pccd_answer_release(demo->client, &demo->last);
    }
    if (status == PCCD_OK) {
        status = output_finish(&file, options->output, &error);
    }
    if (status == PCCD_OK && options->query.is_json) {
        print_json(demo);
    } else if (status == PCCD_OK) {
        printf("picture     %s\n", tool_shown(options->output));
    }
    whole_file_discard(&file);
    if (status != PCCD_OK && error.text[0] != '\0') {
        ctl_complain("%s", error.text);
    }
    tear_down(demo);
    if (status == PCCD_E_NODAEMON) {
        return CTL_NO_DAEMON;
    }
    return status == PCCD_OK ? CTL_DONE : CTL_FAILED;
}

int ctl_cmd_demo(int argc, char **argv)
{
    struct demo_options options = {.query = {.link = {.policy = CTL_LINK_PRIVATE}},
                                   .steps = STEPS_DEFAULT,
                                   .output = OUTPUT_DEFAULT};
    if (argp_parse(&ctl_argp_demo, argc, argv, 0, NULL, &options) != 0) {
        return CTL_USAGE;
    }
    int status = run_demo(&options);
    ctl_link_deinit(&options.query.link);
    return status;
}
