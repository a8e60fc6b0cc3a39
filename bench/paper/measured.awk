# measured.awk - sequence.csv, a line a step and way, to one line a way.
#
# awk -F, -f measured.awk sequence.csv >measured.csv
# Means over the steps, in the columns of model.csv, so that both are drawn alike. When the
# order of features is sorted anew depends on time, so several threads may ask for other box
# tests than one: `like_speedup` is the median over the `like_steps` steps in which they do
# not, within 3 %.

function name(field) { return $at[field] }

# Of v[1 .. n], which is sorted by it.
function median(v, n,    i, j, x) {
    for (i = 2; i <= n; i++) {
        x = v[i]
        for (j = i - 1; j > 0 && v[j] > x; j--) v[j + 1] = v[j]
        v[j + 1] = x
    }
    return n % 2 ? v[(n + 1) / 2] : (v[n / 2] + v[n / 2 + 1]) / 2
}

# Sets likes, and `speed` of them.
function find_likes(way, one,    n, work) {
    likes = 0
    for (n = 0; n < steps[way]; n++) {
        work = tests[way, n] / (tests[one, n] > 0 ? tests[one, n] : 1)
        if (work > 0.97 && work < 1.03) speed[++likes] = took[one, n] / took[way, n]
    }
}

NR == 1 {
    for (i = 1; i <= NF; i++) at[$i] = i
    means = split("step_ms refit_ms low_ms high_ms merge_ms refit_work_ms low_work_ms " \
        "high_work_ms merge_work_ms wait_ms box_tests candidates contacts", mean, " ")
    next
}

{
    way = name("scene") "," name("method") "," name("threads")
    if (!(way in steps)) order[++ways] = way
    tests[way, steps[way] + 0] = name("box_tests")
    took[way, steps[way] + 0] = name("step_ms")
    steps[way]++
    triangles[way] = name("triangles")
    for (i = 1; i <= means; i++) sum[way, mean[i]] += name(mean[i])
    if (name("step_ms") > most[way]) most[way] = name("step_ms")
}

END {
    printf "scene,scheduler,high_level,p,triangles,steps,ms,most_ms,speedup"
    for (i = 2; i <= means; i++) printf ",%s", mean[i]
    print ",like_steps,like_speedup"
    for (w = 1; w <= ways; w++) {
        way = order[w]
        split(way, part, ",")
        one = part[1] "," part[2] ",1"
        printf "%s,%s,%s,%s,%d,%d,%.4f,%.4f,%.3f", part[1], part[2], \
            part[2] == "paper" ? "round-robin" : "none", part[3], triangles[way], steps[way], \
            sum[way, "step_ms"] / steps[way], most[way], \
            sum[one, "step_ms"] / steps[one] * steps[way] / sum[way, "step_ms"]
        for (i = 2; i <= means; i++) printf ",%.4f", sum[way, mean[i]] / steps[way]
        find_likes(way, one)
        printf ",%d,%s\n", likes, (likes > 0 ? sprintf("%.3f", median(speed, likes)) : "")
    }
}
