/* check_screw.c - options of a check in which a body turns. */
#include "check_screw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "robot.h"
#include "sine.h"

#define LENGTH_MAX 1e18

static void take_vector(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    double *values = (double *)(void *)((char *)to + row->at);
    const char *at = text;
    for (int k = 0; k < 3; k++) {
        char *stop;
        values[k] = strtod(at, &stop);
        if (stop == at || *stop != (k < 2 ? ',' : '\0') ||
            !(fabs(values[k]) <= LENGTH_MAX)) {
            option_misused(state, "--%s: \"%s\" is not X,Y,Z, each at most %g", row->name,
                           text, LENGTH_MAX);
        }
        at = stop + 1;
    }
}

/* Take an angle; a negative one turns about the axis in the other direction. */
static void take_angle(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    char *stop;
    double angle = strtod(text, &stop);
    bool is_right = stop > text && isfinite(angle);
    if (is_right && strcmp(stop, "deg") == 0) {
        angle *= ROBOT_PI / 180;
        stop += 3;
    }
    if (!is_right || *stop != '\0' || angle == 0 || !(fabs(angle) <= COMMON_ANGLE_MAX)) {
        option_misused(state,
                       "--%s: \"%s\" is not an angle in radians, or in degrees as 90deg, "
                       "other than 0 and of at most 2^20 turns",
                       row->name, text);
    }
    ((struct check_screw *)to)->angle = angle;
}

static void check_usage(struct argp_state *state, void *to)
{
    struct check_screw *screw = to;
    const double *axis = screw->axis;
    bool has_axis = axis[0] != 0 || axis[1] != 0 || axis[2] != 0;
    if (screw->motion == 0) {
        if (has_axis || screw->angle != 0 || screw->pitch != 0 ||
            screw->through[0] != 0 || screw->through[1] != 0 || screw->through[2] != 0) {
            option_misused(state, "--axis, --through, --angle and --pitch are of "
                                  "--motion screw");
        }
        return;
    }
    if (!has_axis || screw->angle == 0) {
        option_misused(state, "--motion screw: --axis X,Y,Z, not all 0, and --angle say "
                              "how it turns");
    }
    for (int k = 0; screw->angle < 0 && k < 3; k++) {
        screw->axis[k] = -screw->axis[k];
    }
    screw->angle = fabs(screw->angle);
}

#define AT(member) offsetof(struct check_screw, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"motion", 0, "frames|screw",
     "The files are the frames of one mesh, which goes straight from one to the next "
     "(frames, the default); or bodies, of which the first one turns, on its true arc, "
     "and the others stand (screw)",
     OPTION_WORD, .at = AT(motion)},
    {"axis", 0, "X,Y,Z", "With --motion screw: the direction of the axis", OPTION_OWN,
     .at = AT(axis), .take = take_vector},
    {"through", 0, "X,Y,Z",
     "With --motion screw: a point that the axis goes through (default: 0,0,0)",
     OPTION_OWN, .at = AT(through), .take = take_vector},
    {"angle", 0, "A",
     "With --motion screw: how far it turns, counterclockwise where the axis points to "
     "the eye, in radians or degrees (as 90deg)",
     OPTION_OWN, .take = take_angle},
    {"pitch", 0, "H",
     "With --motion screw: how far it goes along the axis in a whole turn (default: 0)",
     OPTION_REAL, .at = AT(pitch), .min = -LENGTH_MAX, .max = LENGTH_MAX},
    {0}};
const struct option_table check_screw_table = {.rows = rows, .check = check_usage};
