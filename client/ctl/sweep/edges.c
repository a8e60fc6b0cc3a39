/* edges.c - motions between configurations, from a file of JSON lines. */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"
#include "shown.h"
#include "sweep.h"
#include "text.h"

/* A file of edges, and the one that is read. */
struct reading {
    struct sweep *sweep;
    const char *path;
    uint64_t line;
    double *ends[2]; /* [joint_count] */
};

__attribute__((format(printf, 2, 3))) static int refuse(const struct reading *reading,
                                                        const char *format, ...)
{
    char what[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return ctl_error_set(reading->sweep->error, PCCD_E_FORMAT, "%s:%" PRIu64 ": %s",
                         reading->path, reading->line, what);
}

/* Take one end: a list of the values of all joints that have their own, or an object of
 * some of them; the others are at the start. */
static int take_end(const struct reading *reading, const json_t *end, const char *name,
                    double *values)
{
    const struct robot *robot = reading->sweep->robot;
    size_t taken = 0;
    memcpy(values, robot->start, robot->joint_count * sizeof *values);
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        const json_t *value = json_is_object(end)
                                  ? json_object_get(end, robot->joints[i].name)
                                  : json_array_get(end, taken);
        if (!robot_is_free(robot, i) || (value == NULL && json_is_object(end))) {
            continue;
        }
        if (!json_is_number(value)) {
            return refuse(reading, "\"%s\" has no number for joint \"%s\"", name,
                          tool_shown(robot->joints[i].name));
        }
        values[i] = json_number_value(value);
        taken++;
    }
    const char *key;
    json_t *of;
    json_object_foreach((json_t *)(uintptr_t)end, key, of)
    {
        uint32_t joint = robot_find_joint(robot, key);
        if (joint == ROBOT_NONE || !robot_is_free(robot, joint)) {
            return refuse(reading,
                          "\"%s\" names \"%s\", which is no joint that moves by "
                          "itself",
                          name, tool_shown(key));
        }
    }
    size_t given = json_is_object(end) ? json_object_size(end) : json_array_size(end);
    if (taken != given) {
        return refuse(reading,
                      "\"%s\" has %zu values, of which joints that move by themselves "
                      "have %zu",
                      name, given, taken);
    }
    robot_follow(robot, values);
    return PCCD_OK;
}

static int take_line(const struct reading *reading, const struct ctl_word *text)
{
    json_error_t fault;
    json_t *root = json_loadb(text->at, (size_t)(text->end - text->at),
                              JSON_REJECT_DUPLICATES, &fault);
    const json_t *from = json_object_get(root, "from"), *to = json_object_get(root, "to");
    int status = root == NULL ? refuse(reading, "%s", tool_shown(fault.text))
                 : from == NULL || to == NULL || json_object_size(root) != 2
                     ? refuse(reading, "an edge is {\"from\": .., \"to\": ..}")
                     : take_end(reading, from, "from", reading->ends[0]);
    if (status == PCCD_OK) {
        status = take_end(reading, to, "to", reading->ends[1]);
    }
    json_decref(root);
    return status;
}

static int ask(const struct reading *reading, struct sweep_hit *hit)
{
    struct sweep *sweep = reading->sweep;
    double most = 0;
    for (uint32_t i = 0; i < sweep->robot->joint_count; i++) {
        most = fmax(most, fabs(reading->ends[1][i] - reading->ends[0][i]));
    }
    int status = sweep_ask(sweep, reading->ends[0], reading->ends[1], sweep->separation,
                           most > 0 ? 0.5 * sweep->bracket / most : 1, hit);
    return status == PCCD_OK ? sweep_look(sweep, hit) : status;
}

int sweep_edges(struct sweep *sweep, const char *path, sweep_edge_fn each, void *context)
{
    struct ctl_file file = {.data = NULL};
    struct ctl_word line;
    size_t bytes = (sweep->robot->joint_count + 1u) * sizeof(double);
    struct reading reading = {
        .sweep = sweep, .path = path, .ends = {malloc(bytes), malloc(bytes)}};
    int status = ctl_file_open(path, &file, sweep->error);
    if (status == PCCD_OK && (reading.ends[0] == NULL || reading.ends[1] == NULL)) {
        status = ctl_error_set(sweep->error, PCCD_E_NOMEM, "out of memory");
    }
    while (status == PCCD_OK && ctl_file_line(&file, &line)) {
        struct sweep_hit hit;
        reading.line++;
        if (line.at == line.end) {
            continue;
        }
        status = take_line(&reading, &line);
        if (status == PCCD_OK) {
            status = ask(&reading, &hit);
        }
        if (status == PCCD_OK) {
            each(context, reading.line, reading.ends, &hit);
        }
    }
    status = status == PCCD_OK ? file.status : status;
    if (status == PCCD_OK && sweep->asked == 0) {
        status = ctl_error_set(sweep->error, PCCD_E_FORMAT, "%s: no edge is in it",
                               tool_shown(path));
    }
    ctl_file_deinit(&file);
    free(reading.ends[0]);
    free(reading.ends[1]);
    return status;
}
