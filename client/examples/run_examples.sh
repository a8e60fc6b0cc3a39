# run_examples.sh - run every example; each checks its own answers (TAP).
#
# Room:     client/examples.
# Does:     one TAP line an example: "not ok" when it exits with anything but 0, with what it
#           printed. A daemon that it leaves behind would show in the private folder check.
set -u

examples="hello cloth two_clients"
runtime=$(mktemp -d)
trap 'rm -rf "$runtime"' EXIT
export XDG_RUNTIME_DIR=$runtime
unset PCCD_URL

number=0
failed=0
echo "1..4"
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
    echo "ok 4 - examples leave nothing behind"
else
    failed=1
    echo "not ok 4 - examples leave nothing behind"
    find "$runtime" | sed 's/^/# /'
fi
exit $failed
