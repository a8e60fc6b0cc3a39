#!/bin/bash
# tests/unit/test_eng_neon.sh - the kernels of AArch64 write the bytes of those of x86-64.
#
# Room:  engine (daemon/engine/kernel), from outside.
# Does:  build the kernels for AArch64, scalar and NEON, run them under qemu on the same
#        numbers as the ones of this processor, compare what they wrote.
# Needs: aarch64-linux-gnu-gcc with its C library and qemu-aarch64 (Debian:
#        gcc-aarch64-linux-gnu, libc6-dev-arm64-cross, qemu-user); skipped without them.

set -u
. "${top_srcdir:?}/tests/support/tap.sh"
: "${top_builddir:?}"

cross=aarch64-linux-gnu-gcc
name="neon__kernels_write_the_same_bytes"
dir=$(mktemp -d "${TMPDIR:-/tmp}/pccd-neon-XXXXXX") || exit 1
trap 'rm -rf "$dir"' EXIT

# compile SET VECTOR_BYTES: the kernels of that set; the flags are those of local.mk. Of scalar ones
# only decide.c is what a daemon there runs, so others need not be what takes longest to compile.
compile() {
    local source level
    for source in "$top_srcdir"/daemon/engine/kernel/*.c; do
        case $1:$source in *:*/choose.c | *:*/absent.c | neon:*/decide.c) continue ;; esac
        case $1:$source in scalar:*/decide.c | neon:*) level=-O2 ;; *) level=-O1 ;; esac
        "$cross" $flags -DENG_ISA="$1" -DENG_ISA_NUMBER="ENG_ISA_${1^^}" \
            -DENG_VECTOR_BYTES="$2" $level -c "$source" -o "$dir/$1-$(basename "$source" .c).o" ||
            return 1
    done
}

build() {
    compile scalar 8 && compile neon 16 &&
        "$cross" $flags -static "$top_srcdir/daemon/engine/kernel/choose.c" \
            "$top_srcdir/tests/unit/kernel_digest.c" "$dir"/*.o -lm -o "$dir/digest"
}

# The kernels that table.h and table.c list and kernel_digest does not run.
missing() {
    sed -n -e 's/^ *\.\([a-z0-9_]*\).* = ENG_KERNEL(.*/\1/p' -e 's/^ *K(\([a-z0-9_]*\)).*/\1/p' \
        "$top_srcdir"/daemon/engine/kernel/table.[ch] | while read -r kernel; do
        grep -q "^scalar $kernel " "$dir/here" || echo "kernel_digest does not run $kernel"
    done
}

# Every kernel of every set has one digest.
compare() {
    cat "$dir/here" "$dir/there" | sort -k 2 >"$dir/all"
    grep -q '^neon ' "$dir/there" && grep -q '^scalar ' "$dir/here" &&
        [ "$(cut -d ' ' -f 2 "$dir/all" | sort -u | wc -l)" -eq \
            "$(cut -d ' ' -f 2,3 "$dir/all" | sort -u | wc -l)" ]
}

# If it failed, a daemon on AArch64 would give other bytes than one on x86-64.
flags="-std=c11 -O2 -ffp-contract=off -fno-trapping-math -fno-math-errno -D_GNU_SOURCE"
flags+=" -Wall -Wextra -Wconversion -Wshadow -Werror -I$top_srcdir/tests/support"
flags+=" -I$top_srcdir/proto/common"
for folder in "$top_srcdir"/daemon/engine/ "$top_srcdir"/daemon/engine/*/; do
    flags+=" -I$folder"
done
if ! command -v "$cross" >"$dir/log" || ! command -v qemu-aarch64 >"$dir/log"; then
    tap_skip "$name" "no $cross, or no qemu-aarch64"
elif ! echo 'int main(void) { return 0; }' | "$cross" -static -x c - -o "$dir/try" 2>"$dir/log"; then
    tap_skip "$name" "$cross has no C library"
else
    build >"$dir/log" 2>&1
    tap_result $? "neon__kernels_build_without_a_warning" "$dir/log"
    "$top_builddir/tests/unit/kernel_digest" >"$dir/here" && missing >"$dir/missing"
    [ -s "$dir/here" ] && [ ! -s "$dir/missing" ]
    # If it failed, a new kernel would never be compared.
    tap_result $? "neon__every_kernel_takes_part" "$dir/missing"
    [ -s "$dir/here" ] &&
        qemu-aarch64 "$dir/digest" >"$dir/there" 2>"$dir/log" && compare
    tap_result $? "$name" "$dir/all"
fi
tap_end
