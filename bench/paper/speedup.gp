# speedup.gp - speed-up over threads, as the paper's Figure 7, for both schedulers and the
# method wide by stealing: curves are predictions, large marks were measured here, over the
# steps in which several threads had the same work as one.
#
# The paper prints its speed-ups for eight threads alone (section 7.1); its curves are
# not numbers, so only those are drawn: 6.4 cloth, 6.7 breaking dragon, 7.3 n-body.

load scripts . '/common.gp'
set output folder . '/speedup.' . kind

set title "Speed-up over one thread: predicted from recorded task costs, and measured"
set logscale xy 2
set xrange [1:72]
set yrange [0.9:72]
set xlabel "threads"
set ylabel "speed-up"
set key off
set rmargin 30
set xtics (1, 2, 4, 8, 16, 32, 64)
set ytics (1, 2, 4, 8, 16, 32, 64)

# The wall: how much of a step the paper's scheduler spends on high-level nodes.
share = '100 * v["high_ms"] / v["ms"]'
work = '(v["high_ms"] > 0 ? v["high_work_ms"] / v["high_ms"] : 1)'
wall = sprintf("high-level nodes (section 5.1), paper's scheduler:\n")
do for [scene in scenes] {
    wall = wall . sprintf("%s: %.0f %% of the step at 8 threads, %.0f %% at 64, " . \
        "where they run %.1fx\n", scene, \
        at(model, scene, 'paper', 'round-robin', 8, share), \
        at(model, scene, 'paper', 'round-robin', 64, share), \
        at(model, scene, 'paper', 'round-robin', 64, work))
}
wall = wall . "p - 1 nodes, one after another: one thread opens 16 p pairs while the\n" . \
    "others wait, then all wait for the largest pair. The nodes grow with p,\n" . \
    "so beyond 16 threads they are the wall; stealing has no such phase."
set label 1 wall at graph 0.42, graph 0.235 font ',10' front

# Names stand at the ends of their curves, as far apart as letters are high: "y scene scheduler".
ends = system(sprintf("awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "{ end[$at[\"scene\"] \" \" $at[\"scheduler\"]] = $at[\"speedup\"] } " . \
    "END { for (of in end) print end[of], of }' '%s' | sort -rn | " . \
    "awk '{ y = NR == 1 || $1 < y / 1.16 ? $1 : y / 1.16; print y, $2, $3 }'", \
    is_there(model) ? model : '/dev/null'))
way(scheduler) = scheduler eq 'steal' ? 'stealing' : \
    scheduler eq 'wide' ? 'method wide' : "paper's scheduler"
do for [i = 1:words(ends):3] {
    do for [k = 1:scene_count] {
        if (word(scenes, k) eq word(ends, i + 1)) {
            set label word(ends, i + 1) . ', ' . way(word(ends, i + 2)) \
                at graph 1.01, first real(word(ends, i)) textcolor lt k
        }
    }
}
set label "curves: predicted; circles: paper's scheduler, squares: method wide, measured" \
    at graph 0.03, 0.96

# Points that were measured, but for the first, which is 1.
seen(scene, scheduler, high) = rows(measured, scene, scheduler, high, \
    '(v["p"] > 1 ? v["like_speedup"] : "")')

plot x with lines lc rgb '#999999' dt 3 notitle, \
    for [i = 1:scene_count] rows(model, word(scenes, i), 'steal', 'none', \
        'v["speedup"]') using 1:2 with linespoints lc i lw 2 pt 7 ps 0.5 notitle, \
    for [i = 1:scene_count] rows(model, word(scenes, i), 'paper', 'round-robin', \
        'v["speedup"]') using 1:2 with linespoints lc i dt 2 lw 1.5 pt 6 ps 0.5 notitle, \
    for [i = 1:scene_count] rows(model, word(scenes, i), 'wide', 'none', \
        'v["speedup"]') using 1:2 with linespoints lc i dt 3 lw 1.5 pt 5 ps 0.4 notitle, \
    for [i = 1:scene_count] seen(word(scenes, i), 'paper', 'round-robin') \
        using 1:2 with points lc i lw 2 pt 6 ps 2 notitle, \
    for [i = 1:scene_count] seen(word(scenes, i), 'wide', 'none') \
        using 1:2 with points lc i lw 2 pt 4 ps 2 notitle, \
    '-' using 1:2:3 with labels point pt 2 ps 1.5 lc rgb 'black' left offset 1,0 \
        font ',9' notitle
8 6.4 ""
8 6.7 "published: n-body 7.3, dragon 6.7, cloth 6.4"
8 7.3 ""
e
