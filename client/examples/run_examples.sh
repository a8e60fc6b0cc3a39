# run_examples.sh - run every example; each checks its own answers (TAP).
#
# Room:     client/examples.
# Does:     one TAP line an example: "not ok" when it exits with anything but 0, with what it
#           printed. A daemon that it leaves behind would show in the private folder check.
set -u

examples="hello cloth cloth_near cloth_thick game_balls game_boxes game_loop two_processes"
runtime=$(mktemp -d)
trap 'rm -rf "$runtime"' EXIT
export XDG_RUNTIME_DIR=$runtime
unset PCCD_URL

number=0
failed=0
echo "1..11"
for example in $examples; do
    number=$((number + 1))
    if output=$("$top_builddir/client/examples/$example" 2>&1); then
        echo "ok $number - example $example is right"
    else
        failed=1
        echo "not ok $number - example $example is right"
    fi
    printf '%s\n' "$output" | sed 's/^/# /'
done

# A private daemon's folder that is still there means that it was not stopped.
if [ -z "$(ls -A "$runtime")" ]; then
    echo "ok 9 - examples leave nothing behind"
else
    failed=1
    echo "not ok 9 - examples leave nothing behind"
    find "$runtime" | sed 's/^/# /'
fi

# They ask for a private daemon; who tells them to do without any is obeyed.
for example in $examples; do
    PCCD_URL=direct: PCCD_DAEMON=/nowhere/pccdd "$top_builddir/client/examples/$example" 2>&1
    status=$?
    case $example-$status in
    two_processes-1) ;; # cannot
    *-0) ;;
    *) echo "wrong: $example ended with $status" ;;
    esac
done >"$runtime/out"
if ! grep 'wrong' "$runtime/out" && grep -q "no daemon that two processes share" "$runtime/out"; then
    echo "ok 10 - examples compute without a daemon when PCCD_URL is direct:"
else
    failed=1
    echo "not ok 10 - examples compute without a daemon when PCCD_URL is direct:"
fi
sed 's/^/# /' "$runtime/out"

# Longer ones are not read.
if long=$(wc -l "$top_srcdir"/client/examples/*.c | awk '$1 >= 150 && $2 != "total"') &&
    [ -z "$long" ]; then
    echo "ok 11 - examples have less than 150 lines"
else
    failed=1
    echo "not ok 11 - examples have less than 150 lines"
    printf '%s\n' "$long" | sed 's/^/# /'
fi
exit $failed
