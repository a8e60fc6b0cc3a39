/* cmd_demo.c - pccdctl demo. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloth_scene.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "printable.h"
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
    struct cloth_hold hold;
    float x[2][CLOTH_BALL_VERTICES > CLOTH_VERTICES ? CLOTH_BALL_VERTICES
                                                    : CLOTH_VERTICES][3];
    uint32_t taken;
    uint64_t asked;
    double *step_ms; /* of each that was asked; ours */
    size_t capacity;
    double phase_ms[REPORT_PHASE_COUNT]; /* sums */
    uint64_t contacts, vf, ee, possible, incomplete;
    uint64_t left; /* contacts on the ways that were taken */
    uint32_t threads;
    /* The last answer that had contacts. */
    struct pccd_contact *met;
    struct demo_met last;
    uint64_t hash[2];
    struct progress progress;
    bool has_memory;
};

/* Keep the records of the last answer that has any, for the picture. */
static void keep_records(struct demo *demo, const struct pccd_answer *answer)
{
    struct pccd_contact *met =
        realloc(demo->met, ((size_t)answer->count + 1) * sizeof *met);
    if (met == NULL) {
        demo->has_memory = false;
        return;
    }
    memcpy(met, answer->contacts, (size_t)answer->count * sizeof *met);
    demo->met = met;
    demo->last = (struct demo_met){.contacts = met,
                                   .count = answer->count,
                                   .vf = answer->counts[PCCD_VF],
                                   .ee = answer->counts[PCCD_EE],
                                   .frame = demo->taken + 1u};
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
    /* What is met first in a frame is what holds the cloth. */
    if (answer->total > 0 && demo->last.frame != demo->taken + 1u) {
        keep_records(demo, answer);
    }
}

static int play(struct demo *demo, struct ctl_error *error)
{
    const uint32_t steps = demo->options->steps;
    int status = PCCD_OK;
    progress_begin(&demo->progress, "steps", steps);
    while (demo->taken < steps && status == PCCD_OK) {
        status = cloth_hold_frame(&demo->hold, note_answer, demo, error);
        if (status == PCCD_OK && !demo->has_memory) {
            status = ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
        }
        demo->taken += status == PCCD_OK;
        progress_update(&demo->progress, demo->taken);
    }
    progress_clear(&demo->progress);
    return status;
}

/* The meshes as they are now, and what is known of them. */
static void place_last(struct demo *demo, struct demo_object objects[2])
{
    const struct cloth_scene *cloth = demo->hold.cloth;
    double pose[12];
    cloth_scene_positions(cloth, 0, demo->x[0]);
    cloth_scene_ball_pose(cloth, 0, pose);
    for (uint32_t i = 0; i < CLOTH_BALL_VERTICES; i++) {
        const float *x = cloth->ball_start[i];
        for (uint32_t k = 0; k < 3; k++) {
            const double *row = pose + (size_t)k * 4;
            demo->x[1][i][k] = (float)(row[0] * (double)x[0] + row[1] * (double)x[1] +
                                       row[2] * (double)x[2] + row[3]);
        }
    }
    for (uint32_t i = 0; i < 2; i++) {
        const struct cloth_object *object = &demo->hold.objects[i];
        objects[i] = (struct demo_object){.object = object->object,
                                          .vertex_count = object->vertex_count,
                                          .triangle_count = object->triangle_count,
                                          .x = (const float(*)[3])demo->x[i],
                                          .triangles = object->triangles,
                                          .edges = object->edges};
    }
}

static void print_table(const struct demo *demo)
{
    double whole = demo->phase_ms[REPORT_step], other = 100.0;
    printf("steps       %" PRIu32 " taken, %" PRIu64 " asked for", demo->taken,
           demo->asked);
    if (demo->hold.cut > 0) {
        printf("; %" PRIu64 " ended before their time", demo->hold.cut);
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
        "steps", (json_int_t)demo->taken, "asked", (json_int_t)demo->asked, "cut",
        (json_int_t)demo->hold.cut, "triangles",
        (json_int_t)(CLOTH_TRIANGLES + CLOTH_BALL_TRIANGLES), "contacts",
        (json_int_t)demo->contacts, "vf", (json_int_t)demo->vf, "ee",
        (json_int_t)demo->ee, "possible", (json_int_t)demo->possible, "left",
        (json_int_t)demo->left, "incomplete", (json_int_t)demo->incomplete, "p50_ms",
        statistics_median(demo->step_ms, demo->asked), "p99_ms",
        statistics_quantile(demo->step_ms, demo->asked, 0.99), "max_ms",
        demo->step_ms[demo->asked - 1], "threads", (json_int_t)demo->threads, "mean_ms",
        phases, "hash", hash, "picture", json_text(demo->options->output));
    json_dumpf(object, stdout, JSON_TEXT_FLAGS);
    putchar('\n');
    json_decref(object);
}

static void tear_down(struct demo *demo)
{
    pccd_close(demo->hold.client);
    cloth_hold_deinit(&demo->hold);
    free(demo->step_ms);
    free(demo->met);
    free(demo);
}

static int run_demo(const struct demo_options *options)
{
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    struct pccd_client *client = NULL;
    struct demo_object objects[2];
    struct demo *demo = calloc(1, sizeof *demo);
    if (demo == NULL) {
        return ctl_complain("out of memory");
    }
    demo->options = options;
    demo->has_memory = true;
    int status = output_open(&file, options->output, false, &error);
    if (status == PCCD_OK && ctl_link_open(&options->query.link, &client) != CTL_DONE) {
        status = PCCD_E_NODAEMON; /* and has been told */
    }
    if (status == PCCD_OK) {
        status = cloth_hold_init(&demo->hold, client, &error);
        demo->hold.threads = options->threads;
    }
    if (status == PCCD_OK) {
        status = play(demo, &error);
    }
    if (status == PCCD_OK) {
        place_last(demo, objects);
        statistics_sort(demo->step_ms, demo->asked);
        if (!options->query.is_json) {
            print_table(demo);
        }
        status =
            demo_picture_write(objects, &demo->last, file.to, options->output, &error);
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
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    demo->hold.client = client;
    tear_down(demo);
    return (int)ctl_exit_of(status, true);
}

int ctl_cmd_demo(int argc, char **argv)
{
    struct demo_options options = {.query = {.link = {.policy = CTL_LINK_PRIVATE}},
                                   .steps = STEPS_DEFAULT,
                                   .output = OUTPUT_DEFAULT};
    if (option_parse(&ctl_table_demo, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    int status = run_demo(&options);
    ctl_link_deinit(&options.query.link);
    return status;
}
