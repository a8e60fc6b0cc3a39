#!/bin/bash
# test_eng_sine.sh - sines are within their error of those of MPFR (TAP).
#
# Room:  proto/common (sine.h), from outside.
# Does:  build a program that compares both, and run it.
# Needs: a C compiler and MPFR's headers (Debian: libmpfr-dev); skipped without them.

set -u
: "${top_srcdir:?}"
. "$top_srcdir/tests/support/tap.sh"

dir=$(mktemp -d "${TMPDIR:-/tmp}/pccd-sine-XXXXXX") || exit 99
trap 'rm -rf "$dir"' EXIT
common=$top_srcdir/proto/common
name=sine__is_within_its_error

# Prints the largest error, as a part of what is claimed, and fails if it is above 1.
cat >"$dir/truth.c" <<'PROGRAM'
#include <math.h>
#include <mpfr.h>
#include <stdio.h>

#include "prng.h"
#include "sine.h"

#define TRIES 200000

/* An angle of any size; near a multiple of a quarter turn; or that multiple as a pair. */
static double draw(struct prng *random, double *lo)
{
    double quarters = prng_integer(random, 1u << 22);
    double hi = quarters * 0x1.921fb54442d18p+0;
    int exponent = -(int)prng_u32(random, 1070);
    *lo = 0;
    switch (prng_u32(random, 5)) {
    case 0:
        hi = prng_between(random, -COMMON_ANGLE_MAX, COMMON_ANGLE_MAX);
        break;
    case 1:
        hi = prng_between(random, -7, 7);
        break;
    case 2:
        hi = ldexp(prng_between(random, -1, 1), exponent);
        break;
    case 3:
        hi += ldexp(prng_between(random, -1, 1), exponent % 60);
        break;
    default: /* an eighth of a turn beside it, too, where the quarter changes */
        hi += prng_integer(random, 1) * 0x1.921fb54442d18p-1;
        break;
    }
    *lo = prng_u32(random, 3) ? 0 : hi * prng_between(random, -0x1p-54, 0x1p-54);
    return hi;
}

static double error_of(mpfr_t truth, double computed)
{
    mpfr_sub_d(truth, truth, computed, MPFR_RNDN);
    return fabs(mpfr_get_d(truth, MPFR_RNDN)) / COMMON_SINE_ERROR;
}

int main(void)
{
    struct prng random = {prng_seed()};
    double worst = 0;
    mpfr_t angle, sine, cosine;
    mpfr_inits2(1200, angle, sine, cosine, (mpfr_ptr)0);
    for (int i = 0; i < TRIES; i++) {
        double lo, hi = draw(&random, &lo), s, c;
        common_sine(hi, lo, &s, &c);
        mpfr_set_d(angle, hi, MPFR_RNDN);
        mpfr_set_prec(sine, 140);
        mpfr_set_prec(cosine, 140);
        mpfr_add_d(angle, angle, lo, MPFR_RNDN);
        mpfr_sin_cos(sine, cosine, angle, MPFR_RNDN);
        worst = fmax(worst, fmax(error_of(sine, s), error_of(cosine, c)));
    }
    mpfr_clears(angle, sine, cosine, (mpfr_ptr)0);
    printf("%.3f\n", worst);
    return worst <= 1 ? 0 : 1;
}
PROGRAM

build() { # FOLDER of sine.h
    "${CC:-cc}" -std=c11 -O2 -ffp-contract=off -Wall -Wextra -Wconversion -Wshadow -Werror \
        -iquote "$1" -iquote "$top_srcdir/tests/support" \
        "$dir/truth.c" -lmpfr -lgmp -lm -o "$dir/truth"
}

if ! echo '#include <mpfr.h>
int main(void) { return mpfr_get_version() == 0; }' |
    "${CC:-cc}" -x c - -lmpfr -o "$dir/try" 2>"$dir/log"; then
    tap_skip "$name" "no MPFR"
    tap_skip "sine__smaller_part_is_found_out" "no MPFR"
else
    build "$common" >"$dir/log" 2>&1 && "$dir/truth" >>"$dir/log" 2>&1
    tap_result $? "$name" "$dir/log"
    # If it failed, the comparison would see nothing: the last bits of half pi are changed.
    sed 's/0x1.313198a2e037p-61/0x1.3p-61/' "$common/sine.h" >"$dir/sine.h"
    ! cmp -s "$common/sine.h" "$dir/sine.h" && build "$dir" >"$dir/log" 2>&1 &&
        ! "$dir/truth" >>"$dir/log" 2>&1
    tap_result $? "sine__smaller_part_is_found_out" "$dir/log"
fi
tap_end
