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
set key left top font ',9'
low = 'v["low_work_ms"] / v["low_ms"]'
high = '(v["high_ms"] > 0 ? v["high_work_ms"] / v["high_ms"] : "")'
refit = 'v["refit_work_ms"] / v["refit_ms"]'
merge = 'v["merge_work_ms"] / v["merge_ms"]'
do for [scene in scenes] {
    set title scene
    set xlabel "threads"
    plot x with lines lc rgb '#999999' dt 3 title 'ideal', \
        rows(model, scene, 'paper', 'round-robin', low) with linespoints lc 1 pt 7 \
            ps 0.4 title 'low-level nodes', \
        rows(model, scene, 'paper', 'round-robin', high) with linespoints lc 2 pt 7 \
            ps 0.4 title 'high-level nodes', \
        rows(model, scene, 'paper', 'round-robin', refit) with linespoints lc 3 pt 7 \
            ps 0.4 title 'refit', \
        rows(model, scene, 'paper', 'round-robin', merge) with linespoints lc 4 pt 7 \
            ps 0.4 title 'merge', \
        rows(measured, scene, 'paper', 'round-robin', low) with points lc 1 pt 6 ps 1.6 \
            lw 2 notitle, \
        rows(measured, scene, 'paper', 'round-robin', high) with points lc 2 pt 6 \
            ps 1.6 lw 2 notitle, \
        rows(measured, scene, 'paper', 'round-robin', refit) with points lc 3 pt 6 \
            ps 1.6 lw 2 notitle, \
        rows(measured, scene, 'paper', 'round-robin', merge) with points lc 4 pt 6 \
            ps 1.6 lw 2 notitle, \
        rows(model, scene, 'steal', 'none', low) with lines lc 1 dt 2 \
            title 'all nodes, stealing', \
        rows(model, scene, 'steal', 'none', refit) with lines lc 3 dt 2 \
            title 'refit, even subtrees'
}
unset multiplot
