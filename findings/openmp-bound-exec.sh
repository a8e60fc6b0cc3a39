#!/bin/sh
# openmp-bound-exec.sh - OMP_PROC_BIND leaves one processor to whatever the program executes, or not.
#
# Seen with libgomp 12.2 and libomp 14.0 (Debian 12), x86-64. A system with OMP_PROC_BIND=true for
# all jobs, as clusters have, is meant to place the threads of regions. libgomp binds the first
# thread of each program that is linked with it before main, also of one that never enters a
# region. The binding outlives exec: a program that restarts itself, or starts another one, has a
# single processor left, and libgomp in the new image takes that one for the whole machine
# (omp_get_num_procs() is 1; a team of all processors runs on it). libomp binds in the first call.
# omp_get_place_proc_ids() still tells the processors in the first image: give them back to the
# thread before exec.

. "$(dirname "$0")/unpack.sh"
[ "$(nproc)" -ge 2 ] || { echo "$0: it takes two processors" >&2; exit 2; }
unpack libgomp1=12.2.0-14+deb12u1 libomp5-14=1:14.0.6-12 libomp-14-dev=1:14.0.6-12
cat >"$folder/again.c" <<'PROGRAM'
#define _GNU_SOURCE
#include <omp.h>
#include <sched.h>
#include <stdio.h>
#include <unistd.h>

int main(int argc, char **argv)
{
    cpu_set_t set;
    if (argc < 2) {
        execl(argv[0], argv[0], "again", (char *)NULL);
        return 2;
    }
    sched_getaffinity(0, sizeof set, &set);
    const char *some = CPU_COUNT(&set) == 1 ? "one processor" : "all";
    printf("after exec: may run on %s; omp_get_num_procs(): %s\n", some,
           omp_get_num_procs() == 1 ? "one" : "all");
}
PROGRAM
library=$folder/root/usr/lib/x86_64-linux-gnu
gcc -fopenmp -c -o "$folder/again.o" "$folder/again.c" || exit 2
gcc -fopenmp -o "$folder/gnu" "$folder/again.o" || exit 2
gcc -o "$folder/llvm" "$folder/again.o" -L"$folder/root/usr/lib/llvm-14/lib" \
    -Wl,-rpath,"$folder/root/usr/lib/llvm-14/lib:$library" -l:libomp.so.5 || exit 2
unset OMP_PLACES
seen=$(echo libgomp; LD_LIBRARY_PATH=$library OMP_PROC_BIND=true "$folder/gnu"
    echo libomp; OMP_PROC_BIND=true "$folder/llvm")
expect "$seen" 'libgomp
after exec: may run on one processor; omp_get_num_procs(): one
libomp
after exec: may run on all; omp_get_num_procs(): all'
