#!/bin/sh
# openmp-rounding-mode.sh - OpenMP's threads keep the rounding mode of the first region, or not.
#
# Seen with libgomp 12.2 and libomp 14.0 (Debian 12), x86-64. The rounding mode belongs to a
# thread. OpenMP 5 leaves open which one the threads of a region have. libgomp makes its threads
# in the first region, so that they inherit the mode that the program had then, and keep it for
# ever, also when the program itself has gone back to rounding to nearest. libomp gives them the
# caller's mode in every region (KMP_INHERIT_FP_CONTROL). A library that computes in OpenMP
# regions has to set the mode in each thread of each region.

. "$(dirname "$0")/unpack.sh"
unpack libgomp1=12.2.0-14+deb12u1 libomp5-14=1:14.0.6-12 libomp-14-dev=1:14.0.6-12
cat >"$folder/modes.c" <<'PROGRAM'
#include <fenv.h>
#include <omp.h>
#include <stdio.h>

static void print_modes(const char *when)
{
    int modes[2] = {-1, -1};
#pragma omp parallel num_threads(2)
    modes[omp_get_thread_num()] = fegetround();
    printf("%s: the caller rounds %s, the other thread %s\n", when,
           modes[0] == FE_DOWNWARD ? "down" : "to nearest",
           modes[1] == FE_DOWNWARD ? "down" : "to nearest");
}

int main(void)
{
    omp_set_dynamic(0);
    fesetround(FE_DOWNWARD);
    print_modes("first region");
    fesetround(FE_TONEAREST);
    print_modes("second region");
}
PROGRAM
library=$folder/root/usr/lib/x86_64-linux-gnu
gcc -fopenmp -o "$folder/gnu" "$folder/modes.c" -lm || exit 2
# The same object code: libomp has the entries that gcc calls.
gcc -fopenmp -c -o "$folder/modes.o" "$folder/modes.c" || exit 2
gcc -o "$folder/llvm" "$folder/modes.o" -L"$folder/root/usr/lib/llvm-14/lib" \
    -Wl,-rpath,"$folder/root/usr/lib/llvm-14/lib:$library" -l:libomp.so.5 -lm || exit 2
seen=$(echo libgomp; LD_LIBRARY_PATH=$library "$folder/gnu"; echo libomp; "$folder/llvm")
expect "$seen" 'libgomp
first region: the caller rounds down, the other thread down
second region: the caller rounds to nearest, the other thread down
libomp
first region: the caller rounds down, the other thread down
second region: the caller rounds to nearest, the other thread to nearest'
