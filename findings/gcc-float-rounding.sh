#!/bin/sh
# gcc-float-rounding.sh - gcc leaves out the rounding of doubles to floats and back.
#
# Seen with gcc 12.2 (Debian 12), x86-64, -O2 and -O3; not with -O1, nor with clang 14. Where two
# neighbours are computed as one vector, (double)(float)x becomes x: what is stored is no float,
# and (double)(float)x - x is 0. With -fno-tree-slp-vectorize, or where the float goes through a
# volatile object or an array in memory, it is rounded.

. "$(dirname "$0")/unpack.sh"
unpack gcc-12=12.2.0-14+deb12u1 cpp-12=12.2.0-14+deb12u1 libgcc-12-dev=12.2.0-14+deb12u1
cat >"$folder/round.c" <<'PROGRAM'
#include <stdio.h>

__attribute__((noinline)) static void round_all(double x[3])
{
    for (int k = 0; k < 3; k++) {
        x[k] = (double)(float)x[k];
    }
}

int main(void)
{
    double x[3] = {0.1, 0.2, 0.3};
    round_all(x);
    printf("%.17g %.17g %.17g\n", x[0], x[1], x[2]);
}
PROGRAM
gcc="$folder/root/usr/bin/x86_64-linux-gnu-gcc-12 -B $folder/root/usr/lib/gcc/x86_64-linux-gnu/12/"
for options in -O1 -O2 '-O2 -fno-tree-slp-vectorize'; do
    $gcc $options -o "$folder/round" "$folder/round.c" || exit 2
    echo "$options: $("$folder/round")" >>"$folder/seen"
done
expect "$(cat "$folder/seen")" '-O1: 0.10000000149011612 0.20000000298023224 0.30000001192092896
-O2: 0.10000000000000001 0.20000000000000001 0.30000001192092896
-O2 -fno-tree-slp-vectorize: 0.10000000149011612 0.20000000298023224 0.30000001192092896'
