/* cmd_demo.c - pccdctl demo. */
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloth.h"
#include "ctl.h"
#include "inspect.h"
#include "link.h"
#include "output.h"
#include "printable.h"
#include "render.h"
#include "report.h"
#include "shown.h"
#include "statistics.h"
#include "terminal.h"

#define STEPS_DEFAULT  300u
#define STEPS_MAX      100000u
#define OUTPUT_DEFAULT "./pccd-demo.png"

struct demo_options {
    struct ctl_query query;
    uint32_t steps;
    uint32_t threads;
    const char *output;
};

#define AT(member) offsetof(struct demo_options, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"steps", 0, "N", "Steps of a hundredth of a second (default: 300)", OPTION_U32,
     .at = AT(steps), .min = 1, .max = STEPS_MAX},
    CTL_OUTPUT,
    {"output", 'o', "FILE", "Where the picture goes, a PNG (default: " OUTPUT_DEFAULT ")",
     OPTION_TEXT, .at = AT(output)},
    CTL_ENGINE,
    {"threads", 0, "N", "Use at most N threads (default: the daemon decides)", OPTION_U32,
     .at = AT(threads), .min = 1, .max = 1024},
    {0}};

const struct option_table ctl_table_demo = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_query_table, AT(query)}, {0}},
    .text = "Let a cloth fall over a turning ball. Before each step a daemon finds "
            "what the cloth would collide with; the demo pushes that apart, and "
            "never takes a step in which two surfaces pass through each other. Show "
            "what was found, how long it took and where.",
    .more = "Without --url and --socket a private daemon is started. The picture "
            "shows the cloth after the last step, and where it had been about to "
            "pass through the ball or itself.",
    .examples = "  pccdctl demo\n"
                "  pccdctl demo --steps 50 -o cloth.png\n",
};

struct demo {
    const struct demo_options *options;
    struct cloth *cloth;
    uint64_t asked;
    double *step_ms; /* of each that was asked; ours */
    size_t capacity;
    double phase_ms[REPORT_PHASE_COUNT]; /* sums */
    uint64_t contacts, vf, ee, possible, incomplete;
    uint64_t left; /* contacts on the ways that were taken */
    uint32_t threads;
    /* What was met first in the last frame that met anything. */
    struct pccd_contact *met;
    uint64_t met_count;
    uint64_t met_frame; /* from 1; 0: none */
    uint64_t hash[2];
    bool has_memory;
};

/* Keep the records of an answer, for the picture. */
static void keep_records(struct demo *demo, const struct pccd_answer *answer)
{
    size_t bytes = (size_t)answer->count * sizeof *demo->met;
    struct pccd_contact *met = realloc(demo->met, bytes + 1);
    if (met == NULL) {
        demo->has_memory = false;
        return;
    }
    memcpy(met, answer->contacts, bytes);
    demo->met = met;
    demo->met_count = answer->count;
    demo->met_frame = demo->cloth->frame + 1u;
    memcpy(demo->hash, answer->hash, sizeof demo->hash);
}

static void note_answer(void *context, const struct pccd_answer *answer, bool is_taken)
{
    struct demo *demo = context;
    double ms[REPORT_PHASE_COUNT];
    if (demo->asked == demo->capacity) {
        size_t capacity = 2 * demo->capacity + 1024;
        double *grown = realloc(demo->step_ms, capacity * sizeof *grown);
        if (grown == NULL) {
            demo->has_memory = false;
            return;
        }
        demo->step_ms = grown;
        demo->capacity = capacity;
    }
    report_phases(&answer->times, ms);
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        demo->phase_ms[phase] += ms[phase];
    }
    demo->step_ms[demo->asked++] = ms[REPORT_step];
    demo->contacts += answer->total;
    demo->vf += answer->counts[PCCD_VF];
    demo->ee += answer->counts[PCCD_EE];
    demo->possible += answer->possible;
    demo->incomplete += answer->incomplete != PCCD_COMPLETE;
    demo->left += is_taken ? answer->total : 0;
    demo->threads = answer->threads;
    if (answer->total > 0 && demo->met_frame != demo->cloth->frame + 1u) {
        keep_records(demo, answer);
    }
}

static int take_frames(struct demo *demo, struct ctl_error *error)
{
    const uint32_t steps = demo->options->steps;
    struct progress progress;
    int status = PCCD_OK;
    progress_begin(&progress, "steps", steps);
    for (uint32_t i = 0; i < steps && status == PCCD_OK; i++) {
        status = cloth_frame(demo->cloth, note_answer, demo, error);
        if (status == PCCD_OK && !demo->has_memory) {
            status = ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
        }
        progress_update(&progress, demo->cloth->frame);
    }
    progress_clear(&progress);
    return status;
}

/* The meshes as they are now, and where they met, as pccdctl render draws a step. */
static int draw(const struct demo *demo, FILE *file, struct ctl_error *error)
{
    const struct render render = {
        .path = demo->options->output, .t = NAN, .azimuth = NAN};
    struct cloth *cloth = demo->cloth;
    float x[CLOTH_MESHES][CLOTH_VERTICES][3];
    struct snapshot_object objects[CLOTH_MESHES];
    struct snapshot snapshot = {
        .step = cloth->frame,
        .objects = objects,
        .object_count = CLOTH_MESHES,
        .contacts = calloc((size_t)demo->met_count + 1, sizeof *snapshot.contacts),
        .contact_count = demo->met_count};
    if (snapshot.contacts == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", render.path);
    }
    for (uint32_t i = 0; i < CLOTH_MESHES; i++) {
        cloth_positions(cloth, (enum cloth_mesh)i, 0, x[i]);
        objects[i] =
            (struct snapshot_object){.x = x[i],
                                     .triangles = cloth->triangles[i],
                                     .vertex_count = cloth_counts[i].vertices,
                                     .triangle_count = cloth_counts[i].triangles};
    }
    for (uint64_t i = 0; i < demo->met_count; i++) {
        cloth_locate(cloth, &demo->met[i], snapshot.contacts[i].at);
        snapshot.contacts[i].toi = demo->met[i].toi;
    }
    int status = render_draw(&render, &snapshot, file, NULL, NULL, error);
    free(snapshot.contacts);
    return status;
}

static void print_table(const struct demo *demo)
{
    double whole = demo->phase_ms[REPORT_step], other = 100.0;
    printf("steps       %" PRIu64 " taken, %" PRIu64 " asked for", demo->cloth->frame,
           demo->asked);
    if (demo->cloth->cut > 0) {
        printf("; %" PRIu64 " ended before their time", demo->cloth->cut);
    }
    printf("\ntriangles   %d: cloth %d, ball %d\n",
           CLOTH_TRIANGLES + CLOTH_BALL_TRIANGLES, CLOTH_TRIANGLES, CLOTH_BALL_TRIANGLES);
    printf("contacts    %" PRIu64 " pushed apart: %" PRIu64 " vertex-face, %" PRIu64
           " edge-edge\n",
           demo->contacts, demo->vf, demo->ee);
    printf("left        %" PRIu64 " %s on the way of what was taken\n", demo->left,
           proto_plural(demo->left, "contact", "contacts"));
    if (demo->incomplete > 0) {
        printf("INCOMPLETE  %" PRIu64 " %s\n", demo->incomplete,
               proto_plural(demo->incomplete, "answer", "answers"));
    }
    printf("per step    p50 %.3f ms, p99 %.3f ms, max %.3f ms; %" PRIu32 " %s\n",
           statistics_median(demo->step_ms, demo->asked),
           statistics_quantile(demo->step_ms, demo->asked, 0.99),
           demo->step_ms[demo->asked - 1], demo->threads,
           proto_plural(demo->threads, "thread", "threads"));
    for (uint32_t phase = 0; phase < REPORT_step; phase++) {
        double share = whole > 0 ? 100.0 * demo->phase_ms[phase] / whole : 0.0;
        printf("  %-10s%5.1f %%\n", report_phase_names[phase], share);
        other -= share;
    }
    printf("  %-10s%5.1f %%\n", "other", fmax(other, 0.0));
    char hash[PROTO_HASH_BYTES];
    printf("hash        %s of the last answer with contacts\n",
           proto_hash_text(PCCD_HASH_VERSION, demo->hash, hash));
}

/* A picture shows one moment: say how to see all of them, where that can be done. */
static void print_page_command(void)
{
    struct ctl_error error;
    const char *me = tool_shown(program_invocation_name);
    if (inspect_has_page(&error) == PCCD_OK) {
        printf(
            "to look at it in a browser: %s record -o demo.rec -- %s demo --steps 100 && "
            "%s inspect demo.rec\n",
            me, me, me);
    }
}

static void print_json(const struct demo *demo)
{
    char hash[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, demo->hash, hash);
    json_t *phases = json_object();
    for (uint32_t phase = 0; phase <= REPORT_step; phase++) {
        json_object_set_new(phases, report_phase_names[phase],
                            json_real(demo->phase_ms[phase] / (double)demo->asked));
    }
    json_t *object = json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:f, s:I, s:o, "
        "s:s, s:o}",
        "steps", (json_int_t)demo->cloth->frame, "asked", (json_int_t)demo->asked, "cut",
        (json_int_t)demo->cloth->cut, "triangles",
        (json_int_t)(CLOTH_TRIANGLES + CLOTH_BALL_TRIANGLES), "contacts",
        (json_int_t)demo->contacts, "vf", (json_int_t)demo->vf, "ee",
        (json_int_t)demo->ee, "possible", (json_int_t)demo->possible, "left",
        (json_int_t)demo->left, "incomplete", (json_int_t)demo->incomplete, "p50_ms",
        statistics_median(demo->step_ms, demo->asked), "p99_ms",
        statistics_quantile(demo->step_ms, demo->asked, 0.99), "max_ms",
        demo->step_ms[demo->asked - 1], "threads", (json_int_t)demo->threads, "mean_ms",
        phases, "hash", hash, "picture", json_text(demo->options->output));
    (void)output_json(object, true, stdout);
}

static int run_demo(const struct demo_options *options, struct ctl_error *error)
{
    struct whole_file file = {.to = NULL};
    struct pccd_client *client = NULL;
    struct demo demo = {.options = options, .cloth = cloth_new(), .has_memory = true};
    int status = demo.cloth != NULL ? PCCD_OK
                                    : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    if (status == PCCD_OK) {
        demo.cloth->threads = options->threads;
        status = output_open(&file, options->output, false, error);
    }
    if (status == PCCD_OK && ctl_link_open(&options->query.link, &client) != CTL_DONE) {
        status = PCCD_E_NODAEMON; /* and has been told */
    }
    if (status == PCCD_OK) {
        status = cloth_register(demo.cloth, client, error);
    }
    if (status == PCCD_OK) {
        status = take_frames(&demo, error);
    }
    if (status == PCCD_OK) {
        statistics_sort(demo.step_ms, demo.asked);
        if (!options->query.is_json) {
            print_table(&demo);
        }
        status = draw(&demo, file.to, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(&file, options->output, error);
    }
    if (status == PCCD_OK && options->query.is_json) {
        print_json(&demo);
    } else if (status == PCCD_OK) {
        printf("picture     %s\n", tool_shown(options->output));
        print_page_command();
    }
    whole_file_discard(&file);
    pccd_close(client);
    free(demo.step_ms);
    free(demo.met);
    free(demo.cloth);
    return status;
}

int ctl_cmd_demo(int argc, char **argv)
{
    struct demo_options options = {.query = {.link = {.policy = CTL_LINK_PRIVATE}},
                                   .steps = STEPS_DEFAULT,
                                   .output = OUTPUT_DEFAULT};
    struct ctl_error error = {.text = ""};
    if (option_parse(&ctl_table_demo, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    int status = run_demo(&options, &error);
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    ctl_link_deinit(&options.query.link);
    return (int)ctl_exit_of(status, true);
}
