# sequence.awk - what pccd-bench says of a scene by several sides, as lines of sequence.csv.
#
# awk -F, -v scene=NAME -f sequence.awk STEPS.csv
# The side of a line names the method and the threads that were asked for, of which a small
# step may use fewer; without it, the first one's: the paper's and one.

BEGIN {
    fields = split("step_ms ingest_ms refit_ms low_ms high_ms merge_ms refit_work_ms " \
        "low_work_ms high_work_ms merge_work_ms wait_ms rebuild_ms box_tests candidates " \
        "contacts reconstructions swaps", field, " ")
}

/^# triangles: / { triangles = $0; sub(/.*: /, "", triangles) }
/^#/ { next }

!columns {
    for (i = 1; i <= NF; i++) at[$i] = i
    columns = NF
    next
}

{
    threads = 1
    if (match($at["side"], /--threads=[0-9]+/))
        threads = substr($at["side"], RSTART + 10, RLENGTH - 10)
    printf "%s,%s,%s,%s,%s", scene, triangles, $at["frame"], \
        ($at["side"] ~ /wide/ ? "wide" : "paper"), threads
    for (i = 1; i <= fields; i++) printf ",%s", $at[field[i]]
    print ""
}
