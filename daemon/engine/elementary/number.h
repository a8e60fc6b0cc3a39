/* number.h - numbers for a computation that is written once and done twice: in pairs of
 * doubles with a bound of the error, and where that leaves a sign open, in integers.
 *
 * Threads: one thread for one struct eng_numbers. Only eng_numbers_init allocates.
 * Source: Dekker: A floating-point technique for extending the available precision, 1971;
 * BOUNDS.md, "Pairs of doubles".
 */
#ifndef ENG_NUMBER_H
#define ENG_NUMBER_H

#include <gmp.h>
#include <stdbool.h>
#include <stdint.h>

#include "limbs.h"

#define ENG_NUMBER_POINTS 5

/* Numbers that are there at the same time, and bits of the longest: BOUNDS.md. */
#define ENG_NUMBER_COUNT 320
#define ENG_NUMBER_BITS  7424

/* By pairs: within `error` of hi + lo, where hi is the double nearest to hi + lo. By
 * integers: *z. Valid until eng_numbers_forget or eng_numbers_load. */
struct eng_number {
    double hi;
    double lo;
    double error;
    mpz_ptr z;
};

struct eng_vector {
    struct eng_number c[3];
};

enum eng_sign { ENG_MINUS = -1, ENG_ZERO = 0, ENG_PLUS = 1, ENG_UNSURE = 2 };

struct eng_numbers {
    bool is_exact;
    bool is_unsure; /* set when an answer depended on what is not known */
    int unit;       /* points are numbers times 2^unit */
    const double (*x)[3];
    mpz_ptr points[ENG_NUMBER_POINTS][3];
    __mpz_struct z[ENG_NUMBER_COUNT];
    uint32_t used; /* of z */
    struct eng_limbs limbs;
    mp_limb_t *block;
};

/* Allocate the block. PCCD_E_NOMEM: there is nothing to deinit. What follows never fails
 * for memory. */
int eng_numbers_init(struct eng_numbers *numbers);
void eng_numbers_deinit(struct eng_numbers *numbers);
/* Return the bytes of the block. Pages of it are taken when numbers become as long as
 * that. */
size_t eng_numbers_bytes(void);

/* Begin with points of magnitude at most 1e18, which stay where they are. */
void eng_numbers_load(struct eng_numbers *numbers, bool is_exact, const double (*x)[3],
                      int point_count);

/* A mark in the numbers and limbs in use: what is behind it is not needed again. */
struct eng_number_mark {
    uint32_t used;
    struct eng_limbs limbs;
};
static inline struct eng_number_mark eng_numbers_mark(const struct eng_numbers *numbers)
{
    return (struct eng_number_mark){numbers->used, numbers->limbs};
}
static inline void eng_numbers_forget(struct eng_numbers *numbers,
                                      struct eng_number_mark mark)
{
    numbers->used = mark.used;
    numbers->limbs = mark.limbs;
}

/* Return (x[i] - x[j]) / 2^unit. */
struct eng_vector eng_number_between(struct eng_numbers *numbers, int i, int j);

struct eng_number eng_number_one(struct eng_numbers *numbers);
struct eng_number eng_number_add(struct eng_numbers *numbers, struct eng_number a,
                                 struct eng_number b);
struct eng_number eng_number_sub(struct eng_numbers *numbers, struct eng_number a,
                                 struct eng_number b);
struct eng_number eng_number_mul(struct eng_numbers *numbers, struct eng_number a,
                                 struct eng_number b);
struct eng_number eng_number_dot(struct eng_numbers *numbers, const struct eng_vector *a,
                                 const struct eng_vector *b);
struct eng_vector eng_number_cross(struct eng_numbers *numbers,
                                   const struct eng_vector *a,
                                   const struct eng_vector *b);

/* Return the sign, and set no is_unsure: the caller decides whether it matters that a
 * sign is unsure. */
enum eng_sign eng_number_sign(const struct eng_numbers *numbers, struct eng_number a);

/* Return the sign of sqrt(num / den) 2^unit - h, for num >= 0, den > 0, h >= 0. */
enum eng_sign eng_number_compare(struct eng_numbers *numbers, struct eng_number num,
                                 struct eng_number den, double h);

/* The next three set is_unsure where they do not know. den > 0. */

/* Return the nearest multiple of 2^-32 to num / den, which is within [-1, 1]; halves to
 * even. */
double eng_number_ratio(struct eng_numbers *numbers, struct eng_number num,
                        struct eng_number den);
/* Return the nearest multiple of 2^-32 to g / sqrt(gg), in the same way. */
double eng_number_cosine(struct eng_numbers *numbers, struct eng_number g,
                         struct eng_number gg);
/* Set *lo, *hi to sqrt(num / den) 2^unit, num >= 0, rounded down and up to doubles of at
 * most 33 significant bits. */
void eng_number_length(struct eng_numbers *numbers, struct eng_number num,
                       struct eng_number den, double *lo, double *hi);

#endif
