/* way_client.c - libpccd: a private daemon, or none. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "asker.h"
#include "names.h"
#include "play.h"
#include "report.h"
#include "workload.h"

#define TIMEOUT_MS 3600000 /* a step of millions of triangles, on one thread */
#define GAP_MAX    4u      /* vertices of a range that do not move, one after the other */

struct run_asked {
    struct pccd_client *client;
    struct pccd_step_settings settings;
    const struct bench_scene *source; /* whose meshes there are */
    uint32_t scene;
    uint32_t *objects; /* [source->object_count] */
    uint32_t *meshes;  /* the same */
    uint32_t frame;    /* where it stands */
    enum pccd_method method;
    enum run_sends sends;
    struct range *ranges; /* what is handed over of a step, object by object */
    uint32_t range_count;
    uint32_t range_capacity;
};

/* Vertices of an object that are handed over together. */
struct range {
    uint32_t object;
    uint32_t first;
    uint32_t count;
};

static struct pccd_client *connect_via(const struct run_side *side)
{
    struct pccd_options options;
    struct pccd_client *client;
    pccd_options_init(&options);
    options.timeout_ms = TIMEOUT_MS;
    options.private_daemon = side->via == RUN_VIA_DAEMON;
    options.url = side->via == RUN_VIA_DIRECT ? "direct:" : NULL;
    options.daemons_max = 1; /* a second one would be measured cold */
    if (access(BENCH_DAEMON, X_OK) == 0 && !getenv("PCCD_DAEMON")) {
        options.daemon = BENCH_DAEMON;
    }
    const char *others =
        getenv("PCCD_CPU"); /* a daemon that is started has our variables */
    char *before = side->cpu && others ? strdup(others) : NULL;
    if (side->cpu) {
        (void)setenv("PCCD_CPU", side->cpu, 1);
    }
    bench_must(pccd_connect(&options, &client), "connect", NULL);
    if (before) {
        (void)setenv("PCCD_CPU", before, 1);
    } else if (side->cpu) {
        (void)unsetenv("PCCD_CPU");
    }
    free(before);
    return client;
}

/* The pose of an object at an end of the next step, if it is moved by such. */
static bool pose_of(const struct run_asked *asked, const struct bench_frames *frames,
                    uint32_t i, uint32_t end, double m[12], double (*rest)[3])
{
    const struct bench_scene *scene = frames->scene;
    return asked->sends == RUN_SENDS_POSES && scene->pose &&
           scene->pose(scene, i, frames->from + end, m, rest);
}

static void add_object(struct run_asked *asked, const struct bench_frames *frames,
                       uint32_t i)
{
    const struct bench_object *object = &frames->scene->objects[i];
    double(*rest)[3] = bench_alloc(object->vertex_count, sizeof *rest);
    double m[12];
    bool has_pose = pose_of(asked, frames, i, 0, m, rest);
    bench_must(pccd_mesh_create(asked->client,
                                has_pose ? rest : bench_frames_x(frames, 0, i),
                                PCCD_FORMAT_F64, object->vertex_count,
                                (const uint32_t(*)[3])object->triangles,
                                object->triangle_count, &asked->meshes[i], NULL),
               "mesh", asked->client);
    bench_must(pccd_request_handle(asked->client, BENCH_OBJECT_ID(i)), "want",
               asked->client);
    bench_must(
        pccd_scene_add(asked->client, asked->scene, asked->meshes[i], &asked->objects[i]),
        "add", asked->client);
    free(rest);
}

static struct run_asked *open_client(const struct run_side *side,
                                     const struct bench_frames *frames)
{
    struct run_asked *asked = bench_alloc(1, sizeof *asked);
    *asked = (struct run_asked){.client = connect_via(side),
                                .settings = side->step,
                                .source = frames->scene,
                                .frame = frames->from,
                                .sends = side->sends};
    asked->settings.separation = run_separation(side, frames);
    asked->objects = bench_alloc(frames->scene->object_count, sizeof *asked->objects);
    asked->meshes = bench_alloc(frames->scene->object_count, sizeof *asked->meshes);
    bench_must(pccd_scene_create(asked->client, NULL, &asked->scene), "scene",
               asked->client);
    for (uint32_t i = 0; i < frames->scene->object_count; i++) {
        add_object(asked, frames, i);
    }
    return asked;
}

static void close_client(struct run_asked *asked)
{
    pccd_close(asked->client);
    free(asked->objects);
    free(asked->meshes);
    free(asked->ranges);
    free(asked);
}

/* Give the object that has broken its new mesh, where the scene has one. */
static void follow(struct run_asked *asked, const struct bench_frames *frames)
{
    uint32_t i = frames->told->break_object;
    const struct bench_object *object = &frames->scene->objects[i];
    if (asked->source == frames->scene) {
        return;
    }
    bench_must(pccd_mesh_replace(
                   asked->client, asked->meshes[i], bench_frames_x(frames, 0, i),
                   PCCD_FORMAT_F64, object->vertex_count,
                   (const uint32_t(*)[3])object->triangles, object->triangle_count, NULL),
               "replace", asked->client);
    asked->source = frames->scene;
}

/* ---- a step ------------------------------------------------------------------------ */

static void add_range(struct run_asked *asked, struct range range)
{
    if (asked->range_count == asked->range_capacity) {
        uint32_t capacity = asked->range_capacity > 0 ? 2 * asked->range_capacity : 64;
        struct range *ranges = bench_alloc(capacity, sizeof *ranges);
        if (asked->range_count > 0) {
            memcpy(ranges, asked->ranges, asked->range_count * sizeof *ranges);
        }
        free(asked->ranges);
        asked->ranges = ranges;
        asked->range_capacity = capacity;
    }
    asked->ranges[asked->range_count++] = range;
}

/* The ranges of an object that change; one range goes on over a few vertices that do
 * not, which take less than another segment would. */
static void add_moved(struct run_asked *asked, const struct bench_frames *frames,
                      uint32_t i)
{
    const double(*x0)[3] = (const double(*)[3])bench_frames_x(frames, 0, i);
    const double(*x1)[3] = (const double(*)[3])bench_frames_x(frames, 1, i);
    uint32_t before = asked->range_count;
    for (uint32_t v = 0; v < asked->source->objects[i].vertex_count; v++) {
        if (memcmp(x0[v], x1[v], sizeof *x0) == 0) {
            continue;
        }
        struct range *last =
            asked->range_count > before ? &asked->ranges[asked->range_count - 1] : NULL;
        if (last && v - last->first - last->count <= GAP_MAX) {
            last->count = v - last->first + 1;
        } else {
            add_range(asked, (struct range){i, v, 1});
        }
    }
}

/* Choose which positions of the next step are handed over. A client knows it: not
 * timed. */
static void choose_ranges(struct run_asked *asked, const struct bench_frames *frames)
{
    asked->range_count = 0;
    for (uint32_t i = 0; i < asked->source->object_count; i++) {
        if (asked->sends == RUN_SENDS_MOVED && asked->frame == frames->from) {
            add_moved(asked, frames, i);
        } else {
            add_range(asked,
                      (struct range){i, 0, asked->source->objects[i].vertex_count});
        }
    }
}

/* The positions of a range, one end or both. */
static void write_range(struct run_asked *asked, const struct bench_frames *frames,
                        struct pccd_frame *slot, const struct range *range)
{
    uint32_t object = asked->objects[range->object];
    size_t bytes = range->count * sizeof(double[3]);
    void *x[2];
    double m[2][12];
    if (pose_of(asked, frames, range->object, 0, m[0], NULL)) {
        (void)pose_of(asked, frames, range->object, 1, m[1], NULL);
        bench_must(pccd_frame_rigid(slot, object, range->first, range->count, m[0], m[1]),
                   "segment", asked->client);
        return;
    }
    if (asked->frame == frames->from) {
        bench_must(pccd_frame_x1(slot, object, PCCD_FORMAT_F64, range->first,
                                 range->count, &x[1]),
                   "segment", asked->client);
    } else {
        bench_must(pccd_frame_x0x1(slot, object, PCCD_FORMAT_F64, range->first,
                                   range->count, &x[0], &x[1]),
                   "segment", asked->client);
        memcpy(x[0], bench_frames_x(frames, 0, range->object) + range->first, bytes);
    }
    memcpy(x[1], bench_frames_x(frames, 1, range->object) + range->first, bytes);
}

static void ask(struct run_asked *asked, const struct bench_frames *frames,
                struct pccd_answer *answer)
{
    struct pccd_frame slot;
    uint64_t step;
    bench_must(pccd_frame_begin(asked->client, asked->scene, asked->range_count,
                                2ull * asked->source->vertex_count * sizeof(double[3]),
                                &slot),
               "frame", asked->client);
    for (uint32_t i = 0; i < asked->range_count; i++) {
        write_range(asked, frames, &slot, &asked->ranges[i]);
    }
    bench_must(pccd_frame_commit(&slot, &asked->settings, &step), "commit",
               asked->client);
    bench_must(pccd_wait(asked->client, step, -1, answer), "wait", asked->client);
    asked->frame = frames->from + 1;
}

static void add_tests(void *context, const char *name, uint64_t value, const char *text)
{
    (void)text;
    if (strcmp(name, "tests") == 0) {
        *(uint64_t *)context += value;
    }
}

/* Return the number of elementary tests, which the threads of the last step tell and the
 * answer does not. */
static uint64_t elementary_tests(struct run_asked *asked, uint32_t threads)
{
    uint64_t tests = 0;
    for (uint32_t i = 0; i < threads; i++) {
        bench_must(pccd_stats_thread(asked->client, false, i, add_tests, &tests, NULL),
                   "stats", asked->client);
    }
    return tests;
}

static bool step_client(struct run_asked *asked, const struct bench_frames *frames,
                        struct run_frame *frame)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    follow(asked, frames);
    choose_ranges(asked, frames);
    uint64_t begin_ns = common_now_ns();
    ask(asked, frames, &answer);
    frame->ns[RUN_WALL] = common_now_ns() - begin_ns;
    run_frame_keep(frame, &answer.times, &answer.counters);
    frame->counts[RUN_CONTACTS] = answer.total;
    frame->counts[RUN_SCENE_BYTES] = RUN_UNKNOWN;
    frame->counts[RUN_ELEMENTARY] = elementary_tests(asked, answer.threads);
    frame->counts[RUN_PROCESS_BYTES] = run_resident_bytes(pccd_daemon_pid(asked->client));
    frame->threads = answer.threads;
    memcpy(frame->hash, answer.hash, sizeof frame->hash);
    asked->method = answer.method;
    /* A page that is full is no loss: the hash and the counts are of all records. */
    bool is_whole = answer.incomplete == PCCD_COMPLETE ||
                    answer.incomplete == PCCD_INCOMPLETE_RESULT_FULL;
    pccd_answer_release(asked->client, &answer);
    return is_whole;
}

static const char *method_of(const struct run_asked *asked)
{
    return asked->method == PCCD_METHOD_DEFAULT ? "" : common_method_name(asked->method);
}

/* The library's text goes with the client. */
static const char *cpu_of(const struct run_asked *asked)
{
    static char name[16];
    (void)snprintf(name, sizeof name, "%s", pccd_daemon_cpu(asked->client));
    return name;
}

const struct run_way run_way_client = {open_client, step_client, method_of, cpu_of,
                                       close_client};
