/* distance_quick.h - distances by doubles, where those are sure. */
#ifndef ENG_DISTANCE_QUICK_H
#define ENG_DISTANCE_QUICK_H

#include "nearest.h"
#include "number.h"
#include "pccd_types.h"

/* A place by doubles: each true number is within its error of the one here. */
struct eng_place {
    enum eng_nearest type;
    uint32_t points;
    double length;
    double length_error;
    bool is_exact; /* the length is the double here */
    double param[2];
    double param_error[2];
    double direction[3];
    double direction_error;
};

/* False: nobody knows, by doubles, what the distance is between. */
bool eng_quick_place(enum pccd_kind kind, const double x[4][3], struct eng_place *place);

/* False: *distance means nothing, for a number might be rounded either way. */
bool eng_quick_describe(const struct eng_place *place, struct eng_distance *distance);

/* How many points of the first feature are where one of the second is: the distance is 0
 * if any. One: *distance is set. Of several it depends on ranks which the distance is
 * between. */
int eng_quick_meet(enum pccd_kind kind, const double x[4][3],
                   struct eng_distance *distance);

/* Sign of place's length - d. */
enum eng_sign eng_quick_compare(const struct eng_place *place, double d);

/* ENG_PLUS: it crosses, ENG_MINUS: it does not, as eng_distance_crosses. */
enum eng_sign eng_quick_crosses(const double x[5][3]);

#endif
