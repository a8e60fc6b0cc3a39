/* curve.c - Hilbert's curve in three dimensions. */
#include "curve.h"

#define BITS 21u

/* Skilling's AxestoTranspose. */
static void transpose(uint32_t x[3])
{
    const uint32_t most = 1u << (BITS - 1);
    for (uint32_t q = most; q > 1; q >>= 1) {
        uint32_t p = q - 1;
        for (int i = 0; i < 3; i++) {
            if (x[i] & q) {
                x[0] ^= p;
            } else {
                uint32_t t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t t = 0;
    for (uint32_t q = most; q > 1; q >>= 1) {
        t ^= x[2] & q ? q - 1 : 0;
    }
    for (int i = 0; i < 3; i++) {
        x[i] ^= t;
    }
}

uint64_t ranks_curve_place(const double x[3], const double low[3], const double high[3])
{
    uint32_t cell[3];
    double size = 0;
    for (int k = 0; k < 3; k++) {
        size = high[k] - low[k] > size ? high[k] - low[k] : size;
    }
    for (int k = 0; k < 3; k++) {
        double at = size > 0 ? (x[k] - low[k]) / size * (1u << BITS) : 0;
        cell[k] = at >= (1u << BITS) - 1 ? (1u << BITS) - 1 : at > 0 ? (uint32_t)at : 0;
    }
    transpose(cell);
    uint64_t place = 0;
    for (uint32_t bit = BITS; bit-- > 0;) {
        for (int k = 0; k < 3; k++) {
            place = place << 1 | (cell[k] >> bit & 1u);
        }
    }
    return place;
}
