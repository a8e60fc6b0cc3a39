/* sweep_report.c - what came of a sweep, for people and for programs. */
#include "sweep.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "output.h"
#include "shown.h"

#define DEGREES    (180 / ROBOT_PI)
#define GAPS_SHOWN 8u

const char *sweep_verdict_name(enum sweep_verdict verdict)
{
    return verdict == SWEEP_FREE ? "free" : verdict == SWEEP_JAMS ? "jams" : "undecided";
}

static bool turns(const struct robot *robot, uint32_t joint)
{
    return robot->joints[joint].kind == PCCD_JOINT_TURN;
}

/* Print an interval of a joint's values, that of degrees behind one of radians. */
static void print_values(FILE *to, const struct robot *robot, uint32_t joint,
                         const double ends[2])
{
    fputs(tool_shown_interval(ends[0], ends[1]), to);
    if (turns(robot, joint)) {
        fprintf(to, " rad (%s deg)",
                tool_shown_interval(ends[0] * DEGREES, ends[1] * DEGREES));
    }
}

static void print_box(FILE *to, const struct robot *robot,
                      const struct sweep_range *range, const struct sweep_box *box)
{
    for (uint32_t k = 0; k < range->count; k++) {
        fprintf(to, "%s%s%s", k > 0 ? ", " : "",
                range->count > 1 ? tool_shown(robot->joints[range->joints[k]].name) : "",
                range->count > 1 ? " " : "");
        print_values(to, robot, range->joints[k], box->ends[k]);
    }
}

static const char *part_of(const struct robot *robot, uint32_t shape)
{
    return tool_shown(robot->parts[robot->shapes[shape].part].name);
}

void sweep_report_begin(FILE *to, const struct sweep *sweep)
{
    const struct robot *robot = sweep->robot;
    fprintf(to,
            "sweep      %s: joints %" PRIu32 ", parts %" PRIu32 ", shapes %" PRIu32
            ", pairs of shapes that may meet %" PRIu64 "\n",
            tool_shown(robot->path), robot->joint_count, robot->part_count,
            robot->shape_count, sweep->pair_count);
    if (sweep->clearance > 0) {
        fprintf(to, "clearance  %s: what comes as near is a jam\n",
                tool_shown_number(sweep->clearance));
    }
    for (size_t i = 0; i < robot->pair_count; i++) {
        const struct robot_pair *pair = &robot->pairs[i];
        if (pair->clearance != ROBOT_APART) {
            fprintf(to, "clearance  %s between %s and %s\n",
                    tool_shown_number(pair->clearance),
                    tool_shown(robot->parts[pair->parts[0]].name),
                    tool_shown(robot->parts[pair->parts[1]].name));
        }
    }
}

void sweep_report_still(FILE *to, const struct robot *robot)
{
    for (uint32_t i = 0; i < robot->part_count; i++) {
        if (robot->parts[i].is_visual_alone) {
            fprintf(to,
                    "note       link %s has a <visual> and no <collision>: it is not "
                    "compared\n",
                    tool_shown(robot->parts[i].name));
        }
    }
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        const struct robot_joint *joint = &robot->joints[i];
        if (joint->held != NULL) {
            fprintf(to, "joint      %s: %s, held where it is\n", tool_shown(joint->name),
                    joint->held);
        } else if (joint->leader != ROBOT_NONE && joint->kind != PCCD_JOINT_FIXED) {
            fprintf(to, "joint      %s: follows %s, times %s plus %s\n",
                    tool_shown(joint->name),
                    tool_shown(robot->joints[joint->leader].name),
                    tool_shown_number(joint->factor), tool_shown_number(joint->offset));
        } else if (robot_is_free(robot, i) && joint->range[0] == joint->range[1]) {
            fprintf(to, "joint      %s: %s, does not move\n", tool_shown(joint->name),
                    tool_shown_number(joint->range[0]));
        }
    }
}

static void print_gaps(FILE *to, const struct robot *robot,
                       const struct sweep_range *range, const struct sweep_answer *answer)
{
    fprintf(to, "  undecided  %s of the range\n", tool_shown_number(answer->undecided));
    for (size_t i = 0; i < answer->gap_count && i < GAPS_SHOWN; i++) {
        fprintf(to, "    ");
        print_box(to, robot, range, &answer->gaps[i]);
        fprintf(to, "\n");
    }
    if (answer->gap_count > GAPS_SHOWN) {
        fprintf(to, "    and %zu others, which --json lists\n",
                answer->gap_count - GAPS_SHOWN);
    }
}

/* Return whether the interval of the first joint is as narrow as was asked for; others
 * have a single value. */
static bool is_within_bracket(const struct sweep *sweep, const struct sweep_jam *jam)
{
    return jam->at.ends[0][1] - jam->at.ends[0][0] <= sweep->bracket;
}

/* Set `ends` to the values that a joint has in a range, ascending. */
static void take_ends(const struct robot *robot, const struct sweep_range *range,
                      const double *values, uint32_t index, double ends[2])
{
    const struct robot_joint *joint = &robot->joints[index];
    bool follows = joint->leader != ROBOT_NONE;
    uint32_t own = follows ? joint->leader : index;
    ends[0] = ends[1] = values[own];
    for (uint32_t k = 0; k < range->count; k++) {
        if (range->joints[k] == own) {
            memcpy(ends, range->ends[k], 2 * sizeof *ends);
        }
    }
    for (int k = 0; k < 2 && follows; k++) {
        ends[k] = joint->factor * ends[k] + joint->offset;
    }
}

/* Return whether these values are beyond a joint's limits. What limits leave to rounding
 * is not beyond. */
static bool is_beyond(const struct robot_joint *joint, const double ends[2])
{
    double slack = 1e-9 * fmax(fabs(joint->range[0]), fabs(joint->range[1]));
    bool is_limited = joint->kind != PCCD_JOINT_FIXED && !joint->is_endless &&
                      joint->range[0] < joint->range[1];
    return is_limited && (fmin(ends[0], ends[1]) < joint->range[0] - slack ||
                          fmax(ends[0], ends[1]) > joint->range[1] + slack);
}

/* Print a note if they are. */
static void note_beyond(FILE *to, const struct robot *robot, uint32_t joint,
                        const double ends[2])
{
    const double low_high[2] = {fmin(ends[0], ends[1]), fmax(ends[0], ends[1])};
    if (is_beyond(&robot->joints[joint], ends)) {
        fprintf(to, "  note       %s at ", tool_shown(robot->joints[joint].name));
        print_values(to, robot, joint, low_high);
        fprintf(to, " goes beyond its limits, ");
        print_values(to, robot, joint, robot->joints[joint].range);
        fprintf(to, "\n");
    }
}

/* Print what to do about parts that meet where the range begins. */
static void print_meeting(FILE *to, const struct robot *robot,
                          const struct sweep_answer *answer)
{
    if (answer->meeting_count > 0 && robot->states != NULL) {
        fprintf(to, "  joints as the SRDF file has them: --state, one of %s\n",
                tool_shown(robot->states));
    }
    if (answer->meeting_count > 0) {
        fprintf(to, "  %s:",
                robot->states != NULL ? "all that meet at the begin"
                                      : "what touches by design");
    }
    for (size_t i = 0; i < answer->meeting_count; i++) {
        const uint32_t *parts = answer->meeting[i].parts;
        fprintf(to, " %s%s,%s", robot->states != NULL ? "" : "--allow ",
                tool_shown(robot->parts[parts[0]].name),
                tool_shown(robot->parts[parts[1]].name));
    }
    fputs(answer->meeting_count > 0 ? "\n" : "", to);
}

void sweep_report_range(FILE *to, const struct sweep *sweep,
                        const struct sweep_range *range, const double *values,
                        const struct sweep_answer *answer)
{
    const struct robot *robot = sweep->robot;
    const struct sweep_box *whole = (const struct sweep_box *)range->ends;
    fprintf(to, "joint      ");
    if (range->count == 1) {
        fprintf(to, "%s ", tool_shown(robot->joints[range->joints[0]].name));
    }
    print_box(to, robot, range, whole);
    fprintf(to, ": %s\n", sweep_verdict_name(answer->verdict));
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        double ends[2];
        take_ends(robot, range, values, i, ends);
        note_beyond(to, robot, i, ends);
    }
    for (uint32_t i = 0; i < answer->jam_count; i++) {
        const struct sweep_jam *jam = &answer->jams[i];
        fprintf(to, "  jams       at ");
        print_box(to, robot, range, &jam->at);
        fprintf(to, ": %s and %s%s%s\n", part_of(robot, jam->shapes[0]),
                part_of(robot, jam->shapes[1]),
                range->count > 1 ? ""
                : i == 0         ? ", from the begin"
                                 : ", from the end",
                jam->is_at_begin ? ", where they meet already" : "");
        if (!is_within_bracket(sweep, jam)) {
            fprintf(to, "    %s wide: it could not be narrowed to %s\n",
                    tool_shown_number(jam->at.ends[0][1] - jam->at.ends[0][0]),
                    tool_shown_number(sweep->bracket));
        }
    }
    print_meeting(to, robot, answer);
    if (answer->gap_count > 0) {
        print_gaps(to, robot, range, answer);
    }
    if (isfinite(answer->least[1])) {
        fprintf(to, "  least distance  %s%s: %s and %s, at ",
                tool_shown_interval(answer->least[0], answer->least[1]),
                robot_has_clearances(robot) ? " above the clearance" : "",
                part_of(robot, answer->nearest.shapes[0]),
                part_of(robot, answer->nearest.shapes[1]));
        print_box(to, robot, range, &answer->nearest.at);
        fprintf(to, "\n");
    }
}

enum sweep_verdict sweep_hit_verdict(const struct sweep_hit *hit)
{
    return !hit->is_there ? SWEEP_FREE : hit->is_proved ? SWEEP_JAMS : SWEEP_UNDECIDED;
}

void sweep_report_edge(FILE *to, const struct robot *robot, uint64_t line,
                       double *const ends[2], const struct sweep_hit *hit)
{
    fprintf(to, "edge       line %" PRIu64 ": %s", line,
            sweep_verdict_name(sweep_hit_verdict(hit)));
    if (hit->is_there) {
        fprintf(to, ", t %s", tool_shown_interval(hit->t[0], hit->t[1]));
    }
    if (hit->is_there && !hit->is_unknown) {
        fprintf(to, ": %s and %s", part_of(robot, hit->shapes[0]),
                part_of(robot, hit->shapes[1]));
    }
    fprintf(to, "\n");
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        note_beyond(to, robot, i, (const double[2]){ends[0][i], ends[1][i]});
    }
}

/* ---- JSON -------------------------------------------------------------------------- */

static json_t *interval(const double ends[2])
{
    return json_pack("[f, f]", ends[0], ends[1]);
}

static json_t *box_json(const struct robot *robot, const struct sweep_range *range,
                        const struct sweep_box *box, bool *ok)
{
    json_t *value = json_object();
    for (uint32_t k = 0; k < range->count; k++) {
        json_set(value, tool_shown(robot->joints[range->joints[k]].name),
                 interval(box->ends[k]), ok);
    }
    return value;
}

static json_t *parts_json(const struct robot *robot, const uint32_t shapes[2])
{
    return json_pack("[o, o]", json_text(part_of(robot, shapes[0])),
                     json_text(part_of(robot, shapes[1])));
}

static json_t *jam_json(const struct robot *robot, const struct sweep_range *range,
                        const struct sweep_jam *jam, bool *ok)
{
    json_t *value = json_object();
    json_set(value, "at", box_json(robot, range, &jam->at, ok), ok);
    json_set(value, "parts", parts_json(robot, jam->shapes), ok);
    return value;
}

json_t *sweep_report_json(const struct sweep *sweep, const struct sweep_range *range,
                          const double *values, const struct sweep_answer *answer)
{
    const struct robot *robot = sweep->robot;
    json_t *value = json_object(), *others = json_object();
    json_t *jams = json_array(), *gaps = json_array(), *beyond = json_array();
    json_t *meeting = json_array();
    bool ok = true;
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        bool is_swept = robot->joints[i].kind == PCCD_JOINT_FIXED;
        for (uint32_t k = 0; k < range->count; k++) {
            is_swept = is_swept || range->joints[k] == i ||
                       robot->joints[i].leader == range->joints[k];
        }
        double ends[2];
        take_ends(robot, range, values, i, ends);
        if (is_beyond(&robot->joints[i], ends)) {
            json_append(beyond, json_text(robot->joints[i].name), &ok);
        }
        if (!is_swept) {
            json_set(others, tool_shown(robot->joints[i].name), json_real(values[i]),
                     &ok);
        }
    }
    for (uint32_t i = 0; i < answer->jam_count; i++) {
        json_t *jam = jam_json(robot, range, &answer->jams[i], &ok);
        if (range->count == 1) {
            json_set(jam, "from", json_string(i == 0 ? "begin" : "end"), &ok);
        }
        json_set(jam, "initial", json_boolean(answer->jams[i].is_at_begin), &ok);
        json_set(jam, "within_bracket",
                 json_boolean(is_within_bracket(sweep, &answer->jams[i])), &ok);
        json_append(jams, jam, &ok);
    }
    for (size_t i = 0; i < answer->meeting_count; i++) {
        const uint32_t *parts = answer->meeting[i].parts;
        char *pair = NULL;
        ok = asprintf(&pair, "%s,%s", robot->parts[parts[0]].name,
                      robot->parts[parts[1]].name) >= 0 &&
             ok;
        json_append(meeting, ok ? json_text(pair) : NULL, &ok);
        free(pair);
    }
    for (size_t i = 0; i < answer->gap_count; i++) {
        json_append(gaps, box_json(robot, range, &answer->gaps[i], &ok), &ok);
    }
    json_set(value, "range",
             box_json(robot, range, (const struct sweep_box *)range->ends, &ok), &ok);
    json_set(value, "others", others, &ok);
    json_set(value, "beyond_limits", beyond, &ok);
    json_set(value, "verdict", json_string(sweep_verdict_name(answer->verdict)), &ok);
    json_set(value, "jams", jams, &ok);
    json_set(value, "initial_pairs", meeting, &ok);
    json_set(value, "undecided", json_real(answer->undecided), &ok);
    json_set(value, "undecided_boxes", gaps, &ok);
    bool has_least = isfinite(answer->least[1]);
    bool is_above = robot_has_clearances(robot);
    json_set(value, "least_distance",
             has_least && !is_above ? interval(answer->least) : json_null(), &ok);
    json_set(value, "least_above_clearance",
             has_least && is_above ? interval(answer->least) : json_null(), &ok);
    json_set(value, "nearest",
             has_least ? jam_json(robot, range, &answer->nearest, &ok) : json_null(),
             &ok);
    if (!ok) {
        json_decref(value);
    }
    return ok ? value : NULL;
}

json_t *sweep_report_edge_json(const struct robot *robot, uint64_t line,
                               double *const ends[2], const struct sweep_hit *hit)
{
    json_t *value = json_object(), *beyond = json_array();
    bool ok = true;
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        if (is_beyond(&robot->joints[i], (const double[2]){ends[0][i], ends[1][i]})) {
            json_append(beyond, json_text(robot->joints[i].name), &ok);
        }
    }
    json_set_count(value, "line", line, &ok);
    json_set(value, "verdict", json_string(sweep_verdict_name(sweep_hit_verdict(hit))),
             &ok);
    json_set(value, "beyond_limits", beyond, &ok);
    json_set(value, "t", hit->is_there ? interval(hit->t) : json_null(), &ok);
    json_set(value, "parts",
             hit->is_there && !hit->is_unknown ? parts_json(robot, hit->shapes)
                                               : json_null(),
             &ok);
    if (!ok) {
        json_decref(value);
    }
    return ok ? value : NULL;
}
