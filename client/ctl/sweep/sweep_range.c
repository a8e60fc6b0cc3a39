/* sweep_range.c - ranges of joints: free, a jam, or undecided.
 *
 * One joint is one motion, from its begin to its end. Of several the first is swept, at
 * values of the others in the middle of cells of their intervals: if nothing comes within
 * r there, where no point can leave its place by more than r while the others go through
 * the cell, the whole column is free. Else a motion without r may prove a jam; or the
 * cell is halved.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "sweep.h"

#define ROUNDING (4 * 2.220446049250313e-16)

static int lack_memory(struct sweep *sweep)
{
    return ctl_error_set(sweep->error, PCCD_E_NOMEM, "out of memory");
}

/* A range, and the two configurations that a motion of it goes between. */
struct course {
    struct sweep *sweep;
    const struct sweep_range *range;
    const double *values;
    double *from, *to, *reach; /* ours: [joint_count] */
    double size;               /* the greatest reach */
};

/* Ask for the motion of the first joint from a to b, with the others in the middle. */
static int ask(struct course *course, double a, double b, const struct sweep_box *box,
               double distance, struct sweep_hit *hit)
{
    const struct sweep_range *range = course->range;
    const struct robot *robot = course->sweep->robot;
    size_t bytes = robot->joint_count * sizeof *course->from;
    memcpy(course->from, course->values, bytes);
    for (uint32_t k = 0; k < range->count; k++) {
        course->from[range->joints[k]] =
            box->ends[k][0] + (box->ends[k][1] - box->ends[k][0]) / 2;
    }
    memcpy(course->to, course->from, bytes);
    course->from[range->joints[0]] = a;
    course->to[range->joints[0]] = b;
    robot_follow(robot, course->from);
    robot_follow(robot, course->to);
    double tolerance = a == b ? 1 : 0.5 * course->sweep->bracket / fabs(b - a);
    return sweep_ask(course->sweep, course->from, course->to, distance, tolerance, hit);
}

/* Set an interval to the values between two times of a motion from a to b, ascending, a
 * few roundings more. */
static void set_values(double a, double b, const double t[2], double to[2])
{
    double margin = ROUNDING * (fabs(a) + fabs(b));
    double first = a + t[0] * (b - a), last = a + t[1] * (b - a);
    double low = fmin(a, b), high = fmax(a, b);
    to[0] = fmax(fmin(first, last) - margin, low);
    to[1] = fmin(fmax(first, last) + margin, high);
}

/* Set a jam of a motion from a to b at the middle of a box. */
static void set_jam(const struct course *course, double a, double b,
                    const struct sweep_box *box, const struct sweep_hit *hit,
                    struct sweep_jam *jam)
{
    *jam = (struct sweep_jam){.shapes = {hit->shapes[0], hit->shapes[1]},
                              .is_at_begin = hit->t[1] == 0};
    set_values(a, b, hit->t, jam->at.ends[0]);
    for (uint32_t k = 1; k < course->range->count; k++) {
        double middle = box->ends[k][0] + (box->ends[k][1] - box->ends[k][0]) / 2;
        jam->at.ends[k][0] = jam->at.ends[k][1] = middle;
    }
}

static int add_gap(struct course *course, const struct sweep_box *box,
                   struct sweep_answer *answer)
{
    const struct sweep_range *range = course->range;
    double part = 1;
    void *list = answer->gaps;
    if (!array_reserve(&list, answer->gap_count, &answer->gap_room,
                       sizeof *answer->gaps)) {
        return lack_memory(course->sweep);
    }
    answer->gaps = list;
    for (uint32_t k = 0; k < range->count; k++) {
        double whole = range->ends[k][1] - range->ends[k][0];
        part *= whole > 0 ? (box->ends[k][1] - box->ends[k][0]) / whole : 1;
    }
    answer->gaps[answer->gap_count++] = *box;
    answer->undecided += part;
    return PCCD_OK;
}

/* Set `reach` and `size` for all values of the range. */
static void measure(struct course *course)
{
    const struct sweep_range *range = course->range;
    const struct robot *robot = course->sweep->robot;
    memcpy(course->from, course->values, robot->joint_count * sizeof *course->from);
    memcpy(course->to, course->values, robot->joint_count * sizeof *course->to);
    for (uint32_t k = 0; k < range->count; k++) {
        course->from[range->joints[k]] = range->ends[k][0];
        course->to[range->joints[k]] = range->ends[k][1];
    }
    robot_follow(robot, course->from);
    robot_follow(robot, course->to);
    robot_measure(robot, course->from, course->to, course->reach);
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        course->size = fmax(course->size, course->reach[i]);
    }
}

/* Go from a to b, over what is undecided, up to what is proved to meet. */
static int pass(struct course *course, double a, double b, struct sweep_answer *answer)
{
    const struct sweep_box *whole = (const struct sweep_box *)course->range->ends;
    int status = PCCD_OK;
    for (uint32_t i = 0; status == PCCD_OK; i++) {
        struct sweep_hit hit;
        struct sweep_box gap;
        status = ask(course, a, b, whole, course->sweep->separation, &hit);
        if (status == PCCD_OK && i == 0) {
            status = sweep_look(course->sweep, &hit);
        }
        if (status != PCCD_OK || !hit.is_there) {
            break;
        }
        if (hit.is_proved) {
            set_jam(course, a, b, whole, &hit, &answer->jams[answer->jam_count++]);
            break;
        }
        set_values(a, b, hit.t, gap.ends[0]);
        double next = gap.ends[0][a < b ? 1 : 0];
        bool is_last = hit.t[1] >= 1 || i == SWEEP_GAPS_KEPT || next == a || next == b;
        gap.ends[0][a < b ? 1 : 0] = is_last ? b : next;
        status = add_gap(course, &gap, answer);
        if (is_last) {
            break;
        }
        a = next;
    }
    return status;
}

/* ---- several joints ---------------------------------------------------------------- */

/* Return how far a point can be moved by a joint, and what follows it, for 1 of its
 * value. */
static double leverage(const struct course *course, uint32_t joint)
{
    const struct robot *robot = course->sweep->robot;
    double sum = 0;
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        const struct robot_joint *at = &robot->joints[i];
        double factor = i == joint ? 1 : at->leader == joint ? fabs(at->factor) : 0;
        sum += factor * (at->kind == PCCD_JOINT_SLIDE ? 1 : course->reach[i]);
    }
    return sum * (1 + 1e-12);
}

/* Cells that are searched in their order; those before `next` are done. */
struct cells {
    struct sweep_box *list;
    size_t next, count, room;
};

static bool push(struct cells *cells, const struct sweep_box *box)
{
    void *list = cells->list;
    if (!array_reserve(&list, cells->count, &cells->room, sizeof *cells->list)) {
        return false;
    }
    cells->list = list;
    cells->list[cells->count++] = *box;
    return true;
}

/* Halve a cell along one of its joints. */
static bool halve(struct cells *cells, const struct sweep_box *box, uint32_t joint)
{
    struct sweep_box half[2] = {*box, *box};
    double middle = box->ends[joint][0] + (box->ends[joint][1] - box->ends[joint][0]) / 2;
    half[0].ends[joint][1] = half[1].ends[joint][0] = middle;
    return push(cells, &half[0]) && push(cells, &half[1]);
}

/* Search one cell: free, a jam, or halved. */
static int search(struct course *course, struct sweep_box *box, const double *levers,
                  bool is_last, struct cells *cells, struct sweep_answer *answer)
{
    double separation = course->sweep->separation, r = 0, most = -1;
    double a = box->ends[0][0], b = box->ends[0][1];
    uint32_t widest = 1;
    struct sweep_hit wide, hit;
    for (uint32_t k = 1; k < course->range->count; k++) {
        double way = (box->ends[k][1] - box->ends[k][0]) / 2 * levers[k];
        r += way;
        widest = way > most ? k : widest;
        most = fmax(most, way);
    }
    int status = ask(course, a, b, box, separation + r * (1 + 1e-12), &wide);
    hit = wide;
    if (status == PCCD_OK && wide.is_there && r > 0) {
        status = ask(course, a, b, box, separation, &hit);
    }
    if (status == PCCD_OK) {
        status = sweep_look(course->sweep, &hit);
    }
    if (status == PCCD_OK && hit.is_there && hit.is_proved) {
        set_jam(course, a, b, box, &hit, &answer->jams[answer->jam_count++]);
        return PCCD_OK;
    }
    if (status != PCCD_OK || !wide.is_there) {
        return status;
    }
    /* What was proved free is not asked for again. */
    box->ends[0][0] = fmax(a, a + wide.t[0] * (b - a) - ROUNDING * (fabs(a) + fabs(b)));
    if (is_last || most <= 0) {
        return add_gap(course, box, answer);
    }
    return halve(cells, box, widest) ? PCCD_OK : lack_memory(course->sweep);
}

static int search_all(struct course *course, struct sweep_answer *answer)
{
    struct cells cells = {.list = NULL};
    double levers[SWEEP_AXES_MAX];
    uint64_t first = course->sweep->asked;
    int status = PCCD_OK;
    for (uint32_t k = 0; k < course->range->count; k++) {
        levers[k] = leverage(course, course->range->joints[k]);
    }
    if (!push(&cells, (const struct sweep_box *)course->range->ends)) {
        status = lack_memory(course->sweep);
    }
    while (status == PCCD_OK && cells.next < cells.count && answer->jam_count == 0) {
        struct sweep_box box = cells.list[cells.next++];
        bool is_last = course->sweep->asked - first >= course->sweep->limit;
        status = search(course, &box, levers, is_last, &cells, answer);
    }
    free(cells.list);
    return status;
}

/* ---- the least distance ------------------------------------------------------------ */

/* Tell whether anything comes within a distance in the range, and where. Of several
 * joints: *is_known is false if motions ended before that was known. */
static int try_distance(struct course *course, double distance, struct sweep_jam *jam,
                        bool *meets, bool *is_known)
{
    const struct sweep_box *whole = (const struct sweep_box *)course->range->ends;
    const double kept = course->sweep->separation;
    struct sweep_answer within = {.least = {0, INFINITY}};
    struct sweep_hit hit;
    int status;
    *is_known = true;
    if (course->range->count == 1) {
        double a = whole->ends[0][0], b = whole->ends[0][1];
        status = ask(course, a, b, whole, distance, &hit);
        *meets = hit.is_there;
        *is_known = !hit.is_unknown;
        if (status == PCCD_OK && *meets) {
            set_jam(course, a, b, whole, &hit, jam);
        }
        return status;
    }
    course->sweep->separation = distance;
    status = search_all(course, &within);
    course->sweep->separation = kept;
    *meets = within.jam_count > 0;
    *is_known = *meets || within.gap_count == 0;
    *jam = *meets ? within.jams[0] : *jam;
    sweep_answer_deinit(&within);
    return status;
}

/* Find the least distance of a range that is free: by distances between one that is free
 * and one that meets. */
static int find_least(struct course *course, struct sweep_answer *answer)
{
    double *least = answer->least, size = course->size;
    double gap = course->sweep->least * size, next = fmax(course->sweep->separation, gap);
    int status = PCCD_OK;
    least[0] = course->sweep->separation;
    while (status == PCCD_OK && least[1] - least[0] > gap && next < 4 * size) {
        bool meets, is_known;
        status = try_distance(course, next, &answer->nearest, &meets, &is_known);
        if (status != PCCD_OK || !is_known) {
            break;
        }
        least[meets ? 1 : 0] = next;
        next = isinf(least[1]) ? 4 * next : least[0] + (least[1] - least[0]) / 2;
    }
    return status;
}

int sweep_try(struct sweep *sweep, const struct sweep_range *range, const double *values,
              struct sweep_answer *answer)
{
    size_t bytes = (sweep->robot->joint_count + 1u) * sizeof(double);
    struct course course = {.sweep = sweep,
                            .range = range,
                            .values = values,
                            .from = malloc(bytes),
                            .to = malloc(bytes),
                            .reach = malloc(bytes)};
    const double *ends = range->ends[0];
    *answer = (struct sweep_answer){.least = {0, INFINITY}};
    int status = PCCD_OK;
    if (course.from == NULL || course.to == NULL || course.reach == NULL) {
        status = lack_memory(sweep);
    } else {
        measure(&course);
    }
    if (status == PCCD_OK && range->count > 1) {
        status = search_all(&course, answer);
    } else if (status == PCCD_OK) {
        status = pass(&course, ends[0], ends[1], answer);
        if (status == PCCD_OK && answer->jam_count > 0) {
            status = pass(&course, ends[1], ends[0], answer);
        }
    }
    answer->verdict = answer->jam_count > 0   ? SWEEP_JAMS
                      : answer->gap_count > 0 ? SWEEP_UNDECIDED
                                              : SWEEP_FREE;
    if (status == PCCD_OK && answer->jam_count > 0 && answer->jams[0].is_at_begin) {
        memcpy(course.from, values, bytes - sizeof(double));
        for (uint32_t k = 0; k < range->count; k++) {
            course.from[range->joints[k]] = answer->jams[0].at.ends[k][0];
        }
        robot_follow(sweep->robot, course.from);
        status = sweep_meeting(sweep, course.from, answer);
    }
    if (status == PCCD_OK && answer->verdict == SWEEP_FREE && sweep->least > 0) {
        status = find_least(&course, answer);
    }
    free(course.from);
    free(course.to);
    free(course.reach);
    return status;
}

void sweep_answer_deinit(struct sweep_answer *answer)
{
    free(answer->gaps);
    free(answer->meeting);
    answer->gaps = NULL;
    answer->meeting = NULL;
    answer->gap_count = answer->meeting_count = 0;
}
