# peers.awk - the lines of bench/peers/peers --json to a table, as Markdown.
#
# awk -v csv=peers.csv -f peers.awk avx2.jsonl avx512.jsonl >peers.md
# A file has the name of the instruction set of ours. Medians; the fastest library of each
# row's scene and threads, and how many times as long as ours it took in the same run. Whole
# steps by one thread go to `csv`, too, for peers.gp: scene, set, ours, the fastest library.

function field(name,    text) {
    if (!match($0, "\"" name "\":(\"[^\"]*\"|[^,}]*)")) return ""
    text = substr($0, RSTART, RLENGTH)
    sub("^\"" name "\":", "", text)
    gsub("\"", "", text)
    return text
}

function best(cpu, scene, threads, step,    i, library, least) {
    least = ""
    for (i = 1; i <= libraries; i++) {
        library = name[i]
        if (!((cpu, scene, library, threads, step) in ms)) continue
        if (least == "" ||
            ms[cpu, scene, library, threads, step] < ms[cpu, scene, least, threads, step])
            least = library
    }
    return least
}

function cells(cpu, scene, threads, step,    ours, library, theirs) {
    if (!((cpu, scene, "ours", threads, step) in ms)) return " | | | |"
    ours = ms[cpu, scene, "ours", threads, step]
    library = best(cpu, scene, threads, step)
    if (library == "") return sprintf(" | %.3g | | |", ours)
    theirs = ms[cpu, scene, library, threads, step]
    if (step && threads == p[1]) print scene "," cpu "," ours "," theirs >csv
    return sprintf(" | %.3g | %.3g (%s) | %.1f", ours, theirs, library, theirs / ours)
}

FNR == 1 {
    cpu = FILENAME
    sub(/.*\//, "", cpu)
    sub(/\..*/, "", cpu)
    cpus[++sets] = cpu
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
    ms[cpu, scene, what, threads, step] = field("p50") + 0
}

END {
    print "| scene | ours by | threads | pairs: ours, ms | fastest library, ms | times | " \
        "whole step: ours, ms | fastest library, ms | times |"
    print "|---|---|---|---|---|---|---|---|---|"
    if (csv == "") csv = "/dev/null"
    print "scene,set,ours,library" >csv
    for (i = 1; i <= count; i++) {
        for (j = 1; j <= sets; j++) {
            for (k = 1; k <= counts; k++) {
                print "| " scenes[i] " | " cpus[j] " | " p[k] \
                    cells(cpus[j], scenes[i], p[k], 0) cells(cpus[j], scenes[i], p[k], 1) " |"
            }
        }
    }
}
