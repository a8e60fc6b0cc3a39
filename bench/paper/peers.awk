# peers.awk - the lines of bench/peers/peers --json to a table, as Markdown.
#
# awk -f peers.awk peers.jsonl >peers.md
# Medians; the fastest library of each row's scene and threads, and how many times as long
# as ours it took in the same run.

function field(name,    text) {
    if (!match($0, "\"" name "\":(\"[^\"]*\"|[^,}]*)")) return ""
    text = substr($0, RSTART, RLENGTH)
    sub("^\"" name "\":", "", text)
    gsub("\"", "", text)
    return text
}

function best(scene, threads, step,    i, library, least) {
    least = ""
    for (i = 1; i <= libraries; i++) {
        library = name[i]
        if (!((scene, library, threads, step) in ms)) continue
        if (least == "" || ms[scene, library, threads, step] < ms[scene, least, threads, step])
            least = library
    }
    return least
}

function cells(scene, threads, step,    ours, library, theirs) {
    if (!((scene, "ours", threads, step) in ms)) return " | | | |"
    ours = ms[scene, "ours", threads, step]
    library = best(scene, threads, step)
    if (library == "") return sprintf(" | %.3g | | |", ours)
    theirs = ms[scene, library, threads, step]
    return sprintf(" | %.3g | %.3g (%s) | %.1f", ours, theirs, library, theirs / ours)
}

field("unit") == "ms" {
    what = field("what")
    scene = field("scene")
    threads = what
    sub(/.*, /, "", threads)
    sub(/, [0-9]+$/, "", what)
    step = sub(/, whole step$/, "", what)
    if (what ~ / (cpu|update)$/ || what == "ours, named") next
    if (!(scene in seen)) { seen[scene] = 1; scenes[++count] = scene }
    if (what != "ours" && !(what in known)) { known[what] = 1; name[++libraries] = what }
    if (!(threads in is_p)) { is_p[threads] = 1; p[++counts] = threads }
    ms[scene, what, threads, step] = field("p50") + 0
}

END {
    print "| scene | threads | pairs: ours, ms | fastest library, ms | times | " \
        "whole step: ours, ms | fastest library, ms | times |"
    print "|---|---|---|---|---|---|---|---|"
    for (i = 1; i <= count; i++) {
        for (k = 1; k <= counts; k++) {
            print "| " scenes[i] " | " p[k] cells(scenes[i], p[k], 0) \
                cells(scenes[i], p[k], 1) " |"
        }
    }
}
