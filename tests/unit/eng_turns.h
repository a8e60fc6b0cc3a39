/* eng_turns.h - where joints take points, by long floats: sines by their series, all
 * joints of both links, nothing cancelled or multiplied together before. */
#ifndef TEST_ENG_TURNS_H
#define TEST_ENG_TURNS_H

#include <gmp.h>

#include "pccd_types.h"
#include "prng.h"

#define TURNS_BITS 512

/* Numbers of one place. */
struct turns_place {
    mpf_t x[3];
};
void turns_init(struct turns_place *place);
void turns_deinit(struct turns_place *place);

/* Set the sine and cosine of an angle of magnitude at most 2^24. */
void turns_sine(mpf_srcptr angle, mpf_ptr sine, mpf_ptr cosine);

/* Set *place to where the frame of `of` sees the point b of `to`. */
void turns_go(const struct pccd_joint *joints, uint32_t of, uint32_t to, double t,
              const double b[3], struct turns_place *place);

/* Return the distance of a place from doubles, of two places. */
double turns_distance(const struct turns_place *place, const double x[3]);

/* Set `count` joints, of a tree of which the last two are at the end of a chain each;
 * places up to `size`. */
void turns_random(struct prng *random, struct pccd_joint *joints, uint32_t count,
                  double size);

#endif
