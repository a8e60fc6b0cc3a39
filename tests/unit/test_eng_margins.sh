#!/bin/bash
# test_eng_margins.sh - the margins of the sieve hold what floats round off (TAP).
#
# Room:  engine (daemon/engine/kernel), from outside.
# Does:  the constants of code and BOUNDS.md are the same, and gappa proves them
#        (margins.py); where one is made less in a copy, that is found out.
# Needs: gappa and Python; skipped without them.

set -u
: "${top_srcdir:?}"
. "$top_srcdir/tests/support/tap.sh"

claims="coefficients cubic filter cut thick near times"
dir=$(mktemp -d "${TMPDIR:-/tmp}/pccd-margins-XXXXXX") || exit 99
trap 'rm -rf "$dir"' EXIT
engine=daemon/engine
mkdir -p "$dir/copy/$engine/kernel" "$dir/copy/$engine/elementary"
cp "$top_srcdir/$engine"/kernel/*.[ch] "$dir/copy/$engine/kernel"
cp "$top_srcdir/$engine"/elementary/BOUNDS.md "$dir/copy/$engine/elementary"

write() { # SOURCES
    rm -f "$dir"/*.g
    python3 "$top_srcdir/tests/unit/margins.py" "$1" "$dir" >"$dir/log" 2>&1
}

prove() { # CLAIM
    timeout 100 gappa -Eno-auto-dichotomy "$dir/$1.g" >"$dir/log" 2>&1
}

# change FILE FROM TO: in the copy.
change() {
    sed -i "s/$2/$3/" "$dir/copy/$engine/$1"
}

missing=
command -v gappa >"$dir/log" || missing="no gappa"
python3 -c '' 2>"$dir/log" || missing="no python3"
if [ -n "$missing" ]; then
    for claim in code_and_text_agree $claims smaller_one_is_found_out; do
        tap_skip "margins__$claim" "$missing"
    done
    tap_end
    exit
fi

# If it failed, BOUNDS.md would derive another margin than the code has.
write "$top_srcdir"
tap_result $? margins__code_and_text_agree "$dir/log"

# If one failed, a pair that meets might be rejected.
for claim in $claims; do
    prove "$claim"
    tap_result $? "margins__$claim" "$dir/log"
done

# If it failed, neither would tell: of the code alone, then of the text as well.
change kernel/sift.c '160 : 80' '160 : 64' && ! write "$dir/copy" &&
    change elementary/BOUNDS.md '`80 u24 PBC' '`64 u24 PBC' && write "$dir/copy" &&
    ! prove cubic && prove cut
tap_result $? margins__smaller_one_is_found_out "$dir/log"

tap_end
