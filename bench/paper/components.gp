# components.gp - speed-up of each part of a step, as the paper's Figure 9: curves are
# predictions, large marks were measured here.
#
# A part's speed-up is its work, as the sum over the threads, by its wall time. (Which
# nodes are high-level depends on the number of threads, so there is no one-thread time to
# compare with.)

load scripts . '/common.gp'
set output folder . '/components.' . kind

set multiplot layout (scene_count + 1) / 2, 2 \
    title "Parts of a step by the paper's scheduler (stealing: dashed; measured: large)"
set logscale xy 2
set xrange [1:72]
set yrange [0.5:72]
set xtics (1, 2, 4, 8, 16, 32, 64)
set ytics (1, 2, 4, 8, 16, 32, 64)
set key off
set rmargin 20
low = 'v["low_work_ms"] / v["low_ms"]'
high = '(v["high_ms"] > 0 ? v["high_work_ms"] / v["high_ms"] : "")'
refit = 'v["refit_work_ms"] / v["refit_ms"]'
merge = 'v["merge_work_ms"] / v["merge_ms"]'
names = "'low-level nodes' 'high-level nodes' refit merge 'all nodes, stealing' " . \
    "'refit, even subtrees'"
do for [scene in scenes] {
    set title scene
    # Names stand at the ends of their curves, as far apart as letters are high: "y colour name".
    last(scheduler, high_level, value) = at(model, scene, scheduler, high_level, 64, value)
    ends = system(sprintf("printf '%%s\n' '%f 1 1' '%f 2 2' '%f 3 3' '%f 4 4' " . \
        "'%f 1 5' '%f 3 6' | sort -rn | awk '$1 > 0 { y = !n++ || $1 < y / 1.35 ? $1 : y / 1.35; print y, $2, $3 }'", \
        last('paper', 'round-robin', low), last('paper', 'round-robin', high), \
        last('paper', 'round-robin', refit), last('paper', 'round-robin', merge), \
        last('steal', 'none', low), last('steal', 'none', refit)))
    unset label
    do for [i = 1:words(ends):3] {
        set label word(names, int(word(ends, i + 2))) at graph 1.01, first real(word(ends, i)) \
            textcolor lt int(word(ends, i + 1)) font ',9'
    }
    set xlabel "threads"
    plot x with lines lc rgb '#999999' dt 3 notitle, \
        rows(model, scene, 'paper', 'round-robin', low) with linespoints lc 1 pt 7 \
            ps 0.4 notitle, \
        rows(model, scene, 'paper', 'round-robin', high) with linespoints lc 2 pt 7 \
            ps 0.4 notitle, \
        rows(model, scene, 'paper', 'round-robin', refit) with linespoints lc 3 pt 7 \
            ps 0.4 notitle, \
        rows(model, scene, 'paper', 'round-robin', merge) with linespoints lc 4 pt 7 \
            ps 0.4 notitle, \
        rows(measured, scene, 'paper', 'round-robin', low) with points lc 1 pt 6 ps 1.6 \
            lw 2 notitle, \
        rows(measured, scene, 'paper', 'round-robin', high) with points lc 2 pt 6 \
            ps 1.6 lw 2 notitle, \
        rows(measured, scene, 'paper', 'round-robin', refit) with points lc 3 pt 6 \
            ps 1.6 lw 2 notitle, \
        rows(measured, scene, 'paper', 'round-robin', merge) with points lc 4 pt 6 \
            ps 1.6 lw 2 notitle, \
        rows(model, scene, 'steal', 'none', low) with lines lc 1 dt 2 notitle, \
        rows(model, scene, 'steal', 'none', refit) with lines lc 3 dt 2 notitle
}
unset multiplot
