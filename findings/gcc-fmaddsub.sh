#!/bin/sh
# gcc-fmaddsub.sh - gcc fuses products and sums where -ffp-contract=off forbids it.
#
# Seen with gcc 12.2 (Debian 12), x86-64, -O2 and -O3, where the set of instructions has FMA (-mfma,
# -march=native); not with -O1, nor with clang 14. Where one of two neighbours in memory is
# a b + c d and the other a b - c d, both become one vfmsubadd, which rounds once and not twice. So
# bytes differ from those of other compilers. With -fno-tree-slp-vectorize they are rounded twice.

. "$(dirname "$0")/unpack.sh"
unpack gcc-12=12.2.0-14+deb12u1 cpp-12=12.2.0-14+deb12u1 libgcc-12-dev=12.2.0-14+deb12u1
cat >"$folder/turn.c" <<'PROGRAM'
void turn(double m[2], double sine, double cosine)
{
    double x = m[0], y = m[1];
    m[0] = cosine * x + sine * y;
    m[1] = cosine * y - sine * x;
}
PROGRAM
gcc="$folder/root/usr/bin/x86_64-linux-gnu-gcc-12 -B $folder/root/usr/lib/gcc/x86_64-linux-gnu/12/"
for options in -O1 -O2 '-O2 -fno-tree-slp-vectorize'; do
    $gcc $options -mfma -ffp-contract=off -S -o "$folder/turn.s" "$folder/turn.c" || exit 2
    echo "$options: $(grep -c vfm "$folder/turn.s") fused" >>"$folder/seen"
done
expect "$(cat "$folder/seen")" '-O1: 0 fused
-O2: 1 fused
-O2 -fno-tree-slp-vectorize: 0 fused'
