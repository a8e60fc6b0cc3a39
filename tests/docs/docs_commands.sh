#!/bin/bash
# docs_commands.sh - every command of the documents works as it is written (TAP).
#
# Room:     tests/docs.
# Does:     take the command blocks of README.md, client/README.md and tests/README.md (four blanks,
#           after an empty line), the commands in the table of tests/README.md, and the commands of every EXAMPLES
#           section (a tab); run each as it is written, where its files are: frames of a mesh,
#           build/, a daemon of the user's own with a client that plays. Run the program of
#           README.md, compile and run that of libpccd(3).
# Does not: run what excluded.txt names, with the reason; such a line that stands in no document
#           any more fails.

set -u
: "${top_srcdir:?is set by make check}" "${top_builddir:?}" "${PCCDD:?}"
# shellcheck source=tests/support/tap.sh
. "$top_srcdir/tests/support/tap.sh"

work=$(mktemp -d "${TMPDIR:-/tmp}/pccd-docs-XXXXXX") || exit 99
pids=
finish() {
    # shellcheck disable=SC2086 # words
    [ -z "$pids" ] || kill $pids 2>/dev/null
    for lock in "$work"/run/pccd/pccd.sock.lock "$work"/run2/*.lock "$work"/run2/pccd/*.lock; do
        [ ! -s "$lock" ] || kill "$(cat "$lock")" 2>/dev/null
    done
    rm -rf "$work"
}
trap finish EXIT
mkdir "$work/run" "$work/here" && cd "$work/here" || exit 99
log=$work/log

# ---- what a reader has ----------------------------------------------------------------

export XDG_RUNTIME_DIR=$work/run PCCD_DAEMON=$top_builddir/pccdd
unset PCCD_URL MAKEFLAGS MAKELEVEL MFLAGS
ln -s "$top_builddir" build
PATH=$top_builddir:$PATH
frame() { # HEIGHT
    printf 'ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n'
    printf 'property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n'
    printf '%s\n' '0 0 0' '1 0 0' '0 1 0' "0.25 0.25 $1" "0.75 0.25 $((3 + $1))" \
        "0.25 0.75 $((3 + $1))" '3 0 1 2' '3 3 4 5'
}
for name in frame0 cloth_92 door; do frame 1 >$name.ply; done
for name in frame1 cloth_93 wall; do frame -1 >$name.ply; done
"$top_builddir/pccdctl" load --hz 100 --seconds 600 frame0.ply frame1.ply >/dev/null 2>"$log" &
pids=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do
    "$top_builddir/pccdctl" list objects --json 2>/dev/null | grep -q object && break
    sleep 0.5
done

# The hinge of client/README.md.
awk '/^```xml$/ { on = 1; next } /^```$/ { on = 0 } on' "$top_srcdir/client/README.md" >hinge.urdf

# The sources that commands of documents name; cc is the compiler of this build.
ln -s "$(cd "$top_srcdir" && pwd)/client" client
mkdir "$work/bin" && printf '#!/bin/sh\nexec %s "$@"\n' "${CC:-$(command -v cc)}" >"$work/bin/cc" &&
    chmod +x "$work/bin/cc"
PATH=$work/bin:$PATH

# ---- what is written ------------------------------------------------------------------

# Blocks of four blanks after an empty line; a list goes on without one.
awk '/^```/ { fence = !fence }
    fence { next }
    /^    [^ ]/ && (empty || block) { print substr($0, 5); block = 1; next }
    { empty = $0 == ""; block = 0 }' "$top_srcdir/README.md" "$top_srcdir/client/README.md" \
    "$top_srcdir/tests/README.md" \
    >"$work/readme"
sed -n 's/^| `\([^`]*\)` |.*/\1/p' "$top_srcdir/tests/README.md" | grep -E '^(make|build/|pccd|\./)' \
    >>"$work/readme"
# Examples: a tab before each; "++" ends a line, a backslash escapes.
for page in "$top_srcdir"/client/man/*.scd; do
    awk '/^# / { examples = $0 == "# EXAMPLES" }
        /^```/ { fence = !fence }
        examples && !fence && /^\t/ { sub(/^\t/, ""); sub(/[+][+]$/, ""); gsub(/\\/, ""); print }' \
        "$page"
done >"$work/pages"
sed -n 's/ :: .*//p' "$top_srcdir/tests/docs/excluded.txt" | grep -v '^#' >"$work/excluded"

[ "$(wc -l <"$work/readme")" -gt 15 ] && [ "$(wc -l <"$work/pages")" -gt 12 ]
# If it failed, the documents would have changed their form, and nothing would be run.
tap_result $? documents__have_commands "$work/readme"

# ---- what it does ---------------------------------------------------------------------

# Whether the target of an excluded command of make is there.
has_target() {
    local words=${1#make }
    words=${words#-C build }
    grep -qE "^${words%% *}:" "$top_builddir/Makefile" || echo "no target ${words%% *}"
}

# A command that stays: it is still there after a while, and where it listens somebody answers.
run_daemon() {
    local socket=$work/run2/pccd/pccd.sock
    case $1 in
    *--socket*)
        socket=${1#*--socket } socket=${socket%% *}
        socket=$work/run2${socket#\$XDG_RUNTIME_DIR}
        ;;
    esac
    mkdir -p "$work/run2"
    XDG_RUNTIME_DIR=$work/run2 timeout 120 bash -c "$1"' for try in 1 2 3 4 5 6 7 8 9 10; do
        sleep 0.3
        pccdctl ping -c 1 --socket "$0" && break
    done
    status=$?
    kill $! && wait $!
    exit $status' "$socket"
}

# If one of these failed, a reader would type it and be let down.
run_all() {
    local document=$1 command name status
    while IFS= read -r command; do
        name=$(printf '%s' "$command" | tr -cs 'a-zA-Z0-9' _)
        name=${document}__${name:0:70}
        if [[ $command == *"pccdctl inspect "* && ! -s $top_builddir/client/inspect/page.html ]]; then
            tap_skip "$name" "built without the page"
            continue
        fi
        if ! grep -Fqx -- "$command" "$work/excluded"; then
            case $command in
            *'&') run_daemon "$command" >"$log" 2>&1 </dev/null ;;
            *) timeout 120 bash -c "$command" >"$log" 2>&1 </dev/null ;;
            esac
            status=$?
            # In each example of it something meets.
            [[ $command != *"pccdctl "@(check|sweep)" "* ]] || [ $status -ne 1 ] || status=0
            tap_result $status "$name" "$log"
            continue
        fi
        case $command in
        "make check"*) tap_skip "$name" "of make check itself" ;;
        make*)
            has_target "$command" >"$log"
            [ ! -s "$log" ]
            tap_result $? "$name" "$log"
            ;;
        *) tap_skip "$name" "takes too long" ;;
        esac
    done
}
run_all readme <"$work/readme"
run_all page <"$work/pages"

# If it failed, something would be left out that nobody remembers, or run twice as long for
# nothing.
while IFS= read -r command; do
    grep -Fqx -- "$command" "$work/readme" "$work/pages" || echo "not written anywhere: $command"
done <"$work/excluded" >"$log"
grep -vE '^#|^$|.+ :: .+' "$top_srcdir/tests/docs/excluded.txt" >>"$log"
[ ! -s "$log" ]
tap_result $? excluded__are_all_written_somewhere "$log"

# ---- the programs -----------------------------------------------------------------------

# check_program NAME LINES FILE LINE: a program that somebody copies prints so many lines like
# LINE. If it failed, that program would not work.
check_program() {
    local status
    # shellcheck disable=SC2046 # words on purpose
    cc -std=c11 -Wall -Wextra -Werror -o program "$3" \
        $(PKG_CONFIG_PATH=build pkg-config --cflags --libs pccd) >"$log" 2>&1 &&
        ./program >out 2>>"$log" && [ "$(grep -c "$4" out)" -ge "$2" ]
    status=$?
    cat out >>"$log"
    tap_result $status "$1" "$log"
}
# If it failed, the first program that somebody tries would not work, or be longer than is said.
awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' "$top_srcdir/README.md" >fall.py
# shellcheck source=tests/python/find.sh
. "$top_srcdir/tests/python/find.sh"
if [ -n "$python" ]; then
    "$python" fall.py >"$log" 2>&1 && [ "$(wc -l <fall.py)" -le 12 ] &&
        [ "$(cat "$log")" = "vertex 3 hits face 0 at t = 0.500" ]
    tap_result $? readme__program_works "$log"
else
    tap_skip readme__program_works "$no_python"
fi
awk '/^```/ { fence = !fence; next } fence' "$top_srcdir/client/man/libpccd.3.scd" >program.c
check_program page__program_of_libpccd_works 1 program.c '^vertex-face at t = 0\.\(5\|4999\)'

tap_end
