/* colour.h - the colours that pictures and exported files give to times and to
 * objects.
 */
#ifndef CTL_COLOUR_H
#define CTL_COLOUR_H

#include <stdint.h>

/* Of a time of impact: dark blue at 0, yellow at 1; linear between nine colours. */
void colour_of_time(double toi, float colour[3]);
/* Of the sides of the i-th object of a scene. */
void colour_of_object(uint32_t i, float front[3], float back[3]);

#endif
