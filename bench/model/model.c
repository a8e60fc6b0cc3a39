/* model.c - how a step would scale on a machine with more processors.
 *
 * Record what every task of a real step costs, or of a question about what is near
 * (--near), measure what it costs that threads meet, replay both schedulers of the method
 * paper and the method wide for 1 to 64 threads, check the replay against itself and
 * against steps measured here, write CSV for the figures.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure.h"
#include "report.h"
#include "sim.h"
#include "table.h"
#include "taskunit.h"
#include "world.h"

#define VALIDATE_MAX 7

struct options {
    bool smoke;
    bool fifth_only;
    bool sequences_only; /* `sequences`, whose steps are the paper's as they are */
    bool wide_only;      /* not the method paper, which takes most of the time */
    const char *wanted;  /* part of a scene's name; NULL: all of `modelled` */
    const char *folder;  /* where the CSV files go */
    uint32_t validate[VALIDATE_MAX];
    uint32_t validate_count;
    uint32_t counts[MODEL_THREADS_MAX]; /* of threads, ascending, the first is 1 */
    uint32_t count_count;
    uint32_t grain[2]; /* of work stealing: units, pairs */
    uint32_t turns;    /* of measured steps */
    uint32_t passes;   /* of recordings */
    double near;       /* share of the diagonal: what is that near; < 0: contacts */
};

#define COUNTS "1,2,3,4,5,6,7,8,10,12,14,16,20,24,28,32,40,48,56,64"

static const char *const modelled[] = {"cloth-ball", "breaking", "n-body", "cloth-funnel",
                                       NULL};
/* The sequences that tell the paper's scenes, frame by frame (bench/paper). */
static const char *const sequences[] = {"cloth", "breaking", "bodies", NULL};

struct scheme {
    const char *scheduler;
    const char *high_level;
    const char *refit;
    struct model_way way;
};

static const struct scheme schemes[] = {
    {"paper",
     "round-robin",
     "paper",
     {0, ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_PAPER,
      PCCD_METHOD_PAPER}},
    {"paper",
     "disjoint",
     "paper",
     {0, ENG_SCHEDULER_PAPER, ENG_HIGH_LEVEL_DISJOINT, ENG_REFIT_PAPER,
      PCCD_METHOD_PAPER}},
    {"steal",
     "none",
     "even",
     {0, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN,
      PCCD_METHOD_PAPER}},
    {"wide",
     "none",
     "even",
     {0, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN,
      PCCD_METHOD_WIDE}},
};
#define SCHEMES (sizeof schemes / sizeof schemes[0])

struct run {
    const struct options *options;
    const struct model_machine *machine;
    const struct eng_affinity *affinity;
    FILE *model;      /* CSV: predictions */
    FILE *validation; /* CSV: predictions beside measurements */
    char name[64];
    struct model_record record;
    struct model_measured measured[MODEL_MEASURED_MAX];
    uint32_t measured_count;
    struct model_output alone;
};

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-6 * (fabs(a) + fabs(b)) + 1;
}

/* What must hold of any prediction. */
static void check(const struct run *run, const struct model_output *output,
                  uint32_t threads)
{
    double sum =
        output->refit + output->low + output->high + output->merge + output->serial;
    double work = output->refit_work + output->performed + output->merge_work;
    bench_check(near(output->performed, output->low_work + output->high_work), run->name,
                "every task is performed once");
    bench_check(near(sum, output->total), run->name, "phases add up to the step");
    bench_check(output->total >= work / threads - 1, run->name,
                "no step is shorter than its work divided by its threads");
    bench_check(output->detection >= output->critical - 1, run->name,
                "no step is shorter than its longest chain");
}

static void predict(struct run *run, const struct scheme *scheme,
                    const struct model_division *division, struct model_output *output)
{
    const struct model_measured *one = &run->measured[0];
    struct model_input input = {.record = &run->record,
                                .division = division,
                                .machine = run->machine,
                                .serial = one->ingest + one->rest,
                                .merge_alone = one->merge,
                                .method = scheme->way.method,
                                .scheduler = scheme->way.scheduler,
                                .high_level = scheme->way.high_level,
                                .refit = scheme->way.refit};
    model_simulate(&input, output);
    check(run, output, division->threads);
    if (division->threads == 1) { /* the engine then runs no scheduler */
        model_alone(&input, output);
        run->alone = *output;
    }
}

static void print(const struct run *run, const struct scheme *scheme, uint32_t threads,
                  const struct model_output *o)
{
    model_table_row(run->model,
                    &(struct model_row){run->name, scheme->scheduler, scheme->high_level,
                                        scheme->refit, threads,
                                        run->alone.total / o->total, o});
    if ((threads & (threads - 1)) == 0) {
        printf("%-16s %-6s %3u %9.3f ms %6.2fx  refit %.3f low %.3f high %.3f merge %.3f "
               "serial %.3f wait %.3f critical %.3f largest %.3f\n",
               run->name, scheme->scheduler, threads, o->total * 1e-6,
               run->alone.total / o->total, o->refit * 1e-6, o->low * 1e-6,
               o->high * 1e-6, o->merge * 1e-6, o->serial * 1e-6, o->wait * 1e-6,
               o->critical * 1e-6, o->largest * 1e-6);
    }
}

static const char *name_of(const struct scheme *scheme, uint32_t threads)
{
    bool has_scheduler = threads > 1 || scheme->way.method == PCCD_METHOD_WIDE;
    return has_scheduler ? scheme->scheduler : "serial";
}

/* Beside what was measured here with as many threads. */
static void validate(const struct run *run, const struct scheme *scheme, uint32_t threads,
                     const struct model_output *output)
{
    for (uint32_t i = 0; i < run->measured_count; i++) {
        const struct model_measured *m = &run->measured[i];
        if (m->way.threads != threads ||
            (threads > 1 && (m->way.scheduler != scheme->way.scheduler ||
                             m->way.high_level != scheme->way.high_level))) {
            continue;
        }
        double error = output->total / m->step - 1;
        fprintf(run->validation, "%s,%s,%u,%.4f,%.4f,%.4f,%.3f,%.3f,%.4f\n", run->name,
                name_of(scheme, threads), threads, m->step * 1e-6, output->total * 1e-6,
                error, 1 / m->ratio, run->alone.total / output->total, m->least * 1e-6);
        printf("%-16s %-6s %3u measured %.3f ms, least %.3f, predicted %.3f: %+.1f %%; "
               "speed-up %.2f, predicted %.2f (measured: refit %.3f detection %.3f "
               "merge %.3f, %.0f hand-overs)\n",
               run->name, name_of(scheme, threads), threads, m->step * 1e-6,
               m->least * 1e-6, output->total * 1e-6, 100 * error, 1 / m->ratio,
               run->alone.total / output->total, m->refit * 1e-6, m->detection * 1e-6,
               m->merge * 1e-6, m->hand_overs);
    }
}

static void replay(struct run *run)
{
    static struct model_division division;
    for (uint32_t c = 0; c < run->options->count_count; c++) {
        uint32_t count = run->options->counts[c];
        model_division_init(&division, &run->record, count);
        bench_check(division.consistent, run->name, "every pass meets the same pairs");
        bool is_first = true;
        for (size_t s = 0; s < SCHEMES; s++) {
            struct model_output output;
            if (schemes[s].way.method != run->record.method) {
                continue;
            }
            predict(run, &schemes[s], &division, &output);
            print(run, &schemes[s], count, &output);
            if (count > 1 || is_first) {
                validate(run, &schemes[s], count, &output);
            }
            is_first = false;
        }
        model_division_deinit(&division);
        fflush(stdout);
    }
}

/* As eng_near asks the team, in the frame that its boxes have. */
static struct eng_near_query query_of(const struct eng_scene *scene, double distance)
{
    float growth = eng_near_growth(distance, scene->framing.scale);
    return (struct eng_near_query){.what = PCCD_NEAR_PAIRS,
                                   .kinds = 1u << PCCD_VF | 1u << PCCD_EE,
                                   .end = 1,
                                   .distance = distance,
                                   .reach = distance,
                                   .growth = growth,
                                   .reach_growth = growth};
}

static void model_method(struct run *run, const struct bench_frames *frames,
                         enum pccd_method method)
{
    struct model_way ways[MODEL_MEASURED_MAX];
    struct bench_world world;
    uint32_t count = 0;
    ways[count++] = (struct model_way){1, ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN,
                                       ENG_REFIT_EVEN, method};
    for (uint32_t i = 0; i < run->options->validate_count; i++) {
        for (size_t s = 0; s < SCHEMES && count < MODEL_MEASURED_MAX; s++) {
            if (schemes[s].way.method == method) {
                ways[count] = schemes[s].way;
                ways[count++].threads = run->options->validate[i];
            }
        }
    }
    run->measured_count = count;
    struct model_question question = {
        run->affinity,
        run->options->near < 0 ? -1 : run->options->near * bench_frames_diagonal(frames)};
    bench_world_init(&world, frames, NULL);
    bench_check(model_measure(&world, frames, &question, ways, count, run->options->turns,
                              run->measured),
                run->name, "all ways give the same answer");
    struct eng_near_query query = query_of(world.scene, question.distance);
    run->record = (struct model_record){.scene = world.scene,
                                        .method = method,
                                        .near = question.distance < 0 ? NULL : &query,
                                        .passes = run->options->passes,
                                        .clock_ns = run->machine->clock,
                                        .unit_grain = run->options->grain[0],
                                        .pair_grain = run->options->grain[1]};
    model_record_init(&run->record);
    if (method == PCCD_METHOD_WIDE) {
        model_wide_calibrate(&run->record.wide, run->measured[0].refit,
                             run->measured[0].detection);
    } else {
        model_refit_calibrate(&run->record, run->measured[0].refit);
    }
    bench_check(run->record.consistent, run->name, "every pass meets the same tasks");
    replay(run);
    model_record_deinit(&run->record);
    bench_world_deinit(&world);
}

static void model_scene(struct run *run, const struct bench_frames *frames)
{
    model_method(run, frames, PCCD_METHOD_WIDE);
    if (!run->options->wide_only) {
        model_method(run, frames, PCCD_METHOD_PAPER);
    }
}

/* The first fifth of the way to the next frame: the paper ran five steps a frame. */
static void take_fifth(struct bench_frames *frames)
{
    for (uint32_t v = 0; v < frames->scene->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            double *x1 = &frames->x[1][v][k];
            double x0 = frames->x[0][v][k];
            *x1 = x0 + (*x1 - x0) / 5;
        }
    }
}

static bool is_modelled(const struct options *options, const char *name)
{
    const char *const *names = options->sequences_only ? sequences : modelled;
    for (size_t i = 0; names[i]; i++) {
        if (strcmp(names[i], name) == 0) {
            return !options->wanted || strstr(name, options->wanted);
        }
    }
    return false;
}

static void model_all(struct run *run)
{
    const struct options *options = run->options;
    for (unsigned i = 0; i < bench_scene_total(); i++) {
        struct bench_scene scene;
        struct bench_frames frames;
        const char *name = bench_scene_name(i);
        if (options->smoke ? strcmp(name, "cloth-20k") != 0
                           : !is_modelled(options, name)) {
            continue;
        }
        bool has_fifth = !options->smoke && !options->sequences_only && options->near < 0;
        for (int fifth = 0; fifth < (has_fifth ? 2 : 1); fifth++) {
            if (options->fifth_only && fifth == 0) {
                continue;
            }
            if (!bench_scene_make(i, options->smoke, &scene)) {
                bench_skip(name, "no frames in $PCCD_DATA");
                break;
            }
            snprintf(run->name, sizeof run->name, "%s%s%s", name, fifth ? "/5" : "",
                     options->near < 0 ? "" : " near");
            bench_frames_init(&frames, &scene, scene.hard_frame);
            if (fifth) {
                take_fifth(&frames);
            }
            model_scene(run, &frames);
            bench_frames_deinit(&frames);
            bench_scene_free(&scene);
        }
    }
}

static FILE *create(const char *folder, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        exit(2);
    }
    return file;
}

/* "2,8,64": numbers from `least` to `most`; returns how many, 0 if anything else. */
static uint32_t numbers(const char *text, uint32_t least, uint32_t most, uint32_t *out,
                        uint32_t capacity)
{
    uint32_t count = 0;
    while (*text) {
        char *end;
        unsigned long number = strtoul(text, &end, 10);
        if (end == text || number < least || number > most || count == capacity ||
            (*end && *end != ',')) {
            return 0;
        }
        out[count++] = (uint32_t)number;
        text = *end ? end + 1 : end;
    }
    return count;
}

static bool parse_number(const char *argument, struct options *options)
{
    const char *value = strchr(argument, '=') + 1;
    size_t length = (size_t)(value - argument);
    if (strncmp(argument, "--validate-threads=", length) == 0) {
        options->validate_count =
            numbers(value, 2, MODEL_THREADS_MAX, options->validate, VALIDATE_MAX);
        return options->validate_count > 0;
    }
    if (strncmp(argument, "--threads=", length) == 0) {
        /* One thread is always there: speed-ups are to it. */
        uint32_t count = numbers(value, 2, MODEL_THREADS_MAX, options->counts + 1,
                                 MODEL_THREADS_MAX - 1);
        options->count_count = count + 1;
        return count > 0;
    }
    if (strncmp(argument, "--grain=", length) == 0) {
        return numbers(value, 2, UINT32_MAX, options->grain, 2) == 2;
    }
    if (strncmp(argument, "--near=", length) == 0) {
        char *end;
        options->near = strtod(value, &end);
        return end != value && *end == '\0' && options->near >= 0 && options->near <= 1;
    }
    if (strncmp(argument, "--passes=", length) == 0) {
        return numbers(value, 1, 99, &options->passes, 1) == 1;
    }
    if (strncmp(argument, "--turns=", length) == 0) {
        return numbers(value, 1, 999, &options->turns, 1) == 1;
    }
    return false;
}

static bool parse(int argc, char **argv, struct options *options)
{
    *options = (struct options){.folder = ".",
                                .validate = {2},
                                .validate_count = 1,
                                .grain = {ENG_STEAL_UNIT_GRAIN, ENG_STEAL_PAIR_GRAIN},
                                .turns = 9,
                                .passes = 5,
                                .near = -1};
    options->count_count =
        numbers(COUNTS, 1, MODEL_THREADS_MAX, options->counts, MODEL_THREADS_MAX);
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--smoke") == 0) {
            options->smoke = true;
            options->turns = 3;
            options->passes = 3;
        } else if (strcmp(argv[i], "--fifth") == 0) {
            options->fifth_only = true;
        } else if (strcmp(argv[i], "--sequences") == 0) {
            options->sequences_only = true;
        } else if (strcmp(argv[i], "--wide") == 0) {
            options->wide_only = true;
        } else if (strncmp(argv[i], "--into=", 7) == 0) {
            options->folder = argv[i] + 7;
        } else if (argv[i][0] == '-') {
            if (!strchr(argv[i], '=') || !parse_number(argv[i], options)) {
                return false;
            }
        } else if (!options->wanted) {
            options->wanted = argv[i];
        } else {
            return false;
        }
    }
    return true;
}

int main(int argc, char **argv)
{
    struct options options;
    struct bench_options none;
    struct model_machine machine;
    struct eng_affinity affinity;
    int exit_status;
    bench_team_environment(argv);
    if (!parse(argc, argv, &options)) {
        fprintf(
            stderr,
            "usage: model [--smoke] [--fifth] [--sequences] [--wide] [--into=FOLDER]\n"
            "    [--threads=N,...]\n"
            "    [--validate-threads=N,...] [--grain=UNIT,PAIR] [--passes=N]\n"
            "    [--turns=N] [--near=SHARE] [SCENE]\n");
        return 2;
    }
    if (!bench_begin("model", 1, argv, &none, &exit_status)) {
        return exit_status;
    }
    eng_affinity_init(&affinity);
    model_machine_measure(&machine, &affinity);
    model_machine_print(&machine, stdout);
    FILE *costs = create(options.folder, "machine.csv");
    model_machine_print(&machine, costs);
    fclose(costs);
    static struct run run;
    run = (struct run){.options = &options,
                       .machine = &machine,
                       .affinity = &affinity,
                       .model = create(options.folder, "model.csv"),
                       .validation = create(options.folder, "validation.csv")};
    model_table_begin(run.model);
    fprintf(run.validation, "scene,scheduler,p,measured_ms,predicted_ms,error,"
                            "measured_speedup,predicted_speedup,least_ms\n");
    model_all(&run);
    fclose(run.model);
    fclose(run.validation);
    return bench_end();
}
