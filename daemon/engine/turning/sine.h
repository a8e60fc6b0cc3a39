/* sine.h - the sine and cosine of an angle, with a proved bound of their error, and the
 * same bytes on every machine: sums and products of doubles alone.
 *
 * Threads: [any].
 * Source: elementary/BOUNDS.md, "Sines and cosines".
 */
#ifndef ENG_SINE_H
#define ENG_SINE_H

/* 2^20 turns, rounded down: the largest angle of a joint. */
#define ENG_ANGLE_MAX 0x1.921fb54442d18p+22

/* Each of the two is within this of the true one. */
#define ENG_SINE_ERROR 0x1p-51

/* Set *sine, *cosine to those of hi + lo, of magnitude at most ENG_ANGLE_MAX + 1, where
 * hi is the double nearest to that sum. */
void eng_sine(double hi, double lo, double *sine, double *cosine);

#endif
