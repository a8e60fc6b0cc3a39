/* output_json.c - a measurement as one JSON object. */
#include <jansson.h>

#include "output.h"

/* jansson's *_set_new and *_append_new take the value also when they fail, and fail on a
 * NULL value, so `ok` is all that has to be looked at. */
struct object {
    json_t *json;
    bool ok;
};

static void set(struct object *object, const char *key, json_t *value)
{
    if (json_object_set_new(object->json, key, value) != 0) {
        object->ok = false;
    }
}

static void set_object(struct object *object, const char *key, const struct object *value)
{
    object->ok = object->ok && value->ok;
    set(object, key, value->json);
}

static struct object new_object(void)
{
    json_t *json = json_object();
    return (struct object){json, json != NULL};
}

/* A count, null where it is not known. */
static json_t *number_of(uint64_t value)
{
    return value == RUN_UNKNOWN ? json_null() : json_integer((json_int_t)value);
}

static json_t *hash_of(const uint64_t hash[2])
{
    char text[PROTO_HASH_BYTES];
    return json_string(proto_hash_text(PCCD_HASH_VERSION, hash, text));
}

static void set_item(void *context, const char *name, const char *text, uint64_t number)
{
    set(context, name, text ? json_string(text) : number_of(number));
}

static struct object statistics(const struct bench_summary *summary)
{
    struct object object = new_object();
    set(&object, "p50", json_real(summary->p50));
    set(&object, "p95", json_real(summary->p95));
    set(&object, "p99", json_real(summary->p99));
    set(&object, "max", json_real(summary->max));
    set(&object, "min", json_real(summary->min));
    return object;
}

static struct object summary_of(const struct run_play *play, uint32_t side)
{
    struct object ms = new_object();
    struct object counts = new_object();
    struct object object = new_object();
    struct bench_summary summary;
    uint64_t total;
    for (enum run_time time = 0; time < RUN_TIMES; time++) {
        summary = run_summarise_time(play, side, time);
        struct object values = statistics(&summary);
        set_object(&ms, run_times[time].name, &values);
    }
    for (enum run_count count = 0; count < RUN_COUNTS; count++) {
        if (run_summarise_count(play, side, count, &summary, &total)) {
            struct object values = statistics(&summary);
            if (count < RUN_SCENE_BYTES) {
                set(&values, "all", json_integer((json_int_t)total));
            }
            set_object(&counts, run_counts[count].name, &values);
        }
    }
    set(&object, "steps", json_integer(play->count));
    set_object(&object, "ms", &ms);
    set_object(&object, "counts", &counts);
    return object;
}

static struct object frame_of(const struct run_frame *frame)
{
    struct object ms = new_object();
    struct object counts = new_object();
    struct object object = new_object();
    for (int t = 0; t < RUN_TIMES; t++) {
        set(&ms, run_times[t].name, json_real(1e-6 * (double)frame->ns[t]));
    }
    for (int c = 0; c < RUN_COUNTS; c++) {
        set(&counts, run_counts[c].name, number_of(frame->counts[c]));
    }
    set(&object, "frame", json_integer(frame->number));
    set(&object, "threads", json_integer(frame->threads));
    set(&object, "hash", hash_of(frame->hash));
    set_object(&object, "ms", &ms);
    set_object(&object, "counts", &counts);
    return object;
}

/* One line; the object is freed. */
static bool write_line(FILE *to, const char *before, struct object object,
                       const char *after)
{
    bool is_written =
        object.ok && fputs(before, to) != EOF &&
        json_dumpf(object.json, to, JSON_COMPACT | JSON_REAL_PRECISION(9)) == 0 &&
        fputs(after, to) != EOF;
    json_decref(object.json);
    return is_written;
}

/* The first side has no speed: it is what the others are compared with. */
static struct object side_of(const struct run_play *play, uint32_t side)
{
    struct object object = new_object();
    struct object summary = summary_of(play, side);
    struct object speed = new_object();
    for (enum run_time time = 0; time < RUN_TIMES && side > 0; time++) {
        if (play->sides[side].speed[time].count > 0) {
            struct bench_summary s = bench_summarise(&play->sides[side].speed[time]);
            struct object values = statistics(&s);
            set_object(&speed, run_times[time].name, &values);
        }
    }
    set(&object, "beside", json_string(play->settings->sides[side].label));
    set_object(&object, "summary", &summary);
    set_object(&object, "times_as_fast", &speed);
    return object;
}

/* A line for the settings, one for the summary, one a side and one a step: such a file is
 * read and compared by lines, too. */
bool run_write_json(FILE *to, const struct run_play *play)
{
    uint32_t sides = play->settings->side_count;
    struct object settings = new_object();
    run_setup_each(play, set_item, &settings);
    bool good = write_line(to, "{\"settings\":", settings, ",\n");
    good = write_line(to, "\"summary\":", summary_of(play, 0), ",\n") && good;
    for (uint32_t i = 0; i < sides && sides > 1; i++) {
        good = write_line(to, i == 0 ? "\"sides\":[\n" : "", side_of(play, i),
                          i + 1 < sides ? ",\n" : "\n],\n") &&
               good;
    }
    good = fputs("\"frames\":[\n", to) != EOF && good;
    for (uint32_t i = 0; i < play->count; i++) {
        const char *after = i + 1 < play->count ? ",\n" : "\n]}\n";
        good = write_line(to, "", frame_of(&play->sides[0].frames[i]), after) && good;
    }
    return good;
}
