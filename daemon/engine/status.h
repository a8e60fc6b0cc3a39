/* daemon/engine/status.h - how the engine's functions fail.
 *
 * Room:     engine. May include: nothing.
 * Does:     the engine's own status values; the server maps them to the wire's.
 */
#ifndef ENG_STATUS_H
#define ENG_STATUS_H

enum eng_status {
    ENG_OK = 0,
    ENG_E_NOMEM = -1,
    ENG_E_INVAL = -2,     /* argument out of its documented range */
    ENG_E_LIMIT = -3,     /* more than 2^31-1 vertices, edges or triangles */
    ENG_E_INDEX = -4,     /* a triangle names a vertex that does not exist */
    ENG_E_NOTFINITE = -5, /* a coordinate is NaN, infinite or beyond 1e18 */
    ENG_E_STATE = -6,     /* mesh not committed, or data missing */
    ENG_E_OVERLAP = -7,   /* two segments of one step write the same vertex */
    ENG_E_LONG = -8       /* a step that was to be brief is not (step.h) */
};

#endif
