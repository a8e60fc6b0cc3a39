/* two.h - what rounding leaves of a sum and of a product, as a double.
 *
 * Source: Dekker: A floating-point technique for extending the available precision, 1971;
 * BOUNDS.md, "Pairs of doubles".
 */
#ifndef ENG_TWO_H
#define ENG_TWO_H

/* Return the sum, and set *rest to what rounding has left: a + b = sum + *rest. */
static inline double eng_two_sum(double a, double b, double *rest)
{
    double sum = a + b;
    double part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

/* Split a = high + *low, each of at most 26 bits; return the first. */
static inline double eng_two_split(double a, double *low)
{
    double scaled = 0x1.0000002p27 * a;
    double high = scaled - (scaled - a);
    *low = a - high;
    return high;
}

/* Return the product, 0 or of magnitude 2^-960 or more, and set *rest to what rounding
 * has left: a b = product + *rest. */
static inline double eng_two_product(double a, double b, double *rest)
{
    double a_low;
    double b_low;
    double a_high = eng_two_split(a, &a_low);
    double b_high = eng_two_split(b, &b_low);
    double product = a * b;
    *rest =
        ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    return product;
}

#endif
