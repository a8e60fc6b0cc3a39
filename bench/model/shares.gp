# shares.gp - what the parts take of a step at eight threads, as the paper's Figure 8.
#
# Section 7.2: refit 7 to 13 %, low-level nodes 80 to 90 %, high-level nodes 2 to 10 %,
# the serial rest below 2 %.

load scripts . '/common.gp'
set output folder . '/shares.' . kind

set title "Parts of a step, paper's scheduler, 8 threads"
set style data histograms
set style histogram rowstacked
set style fill solid 0.8 border rgb 'white'
set boxwidth 0.6
set yrange [0:100]
set xrange [-0.7:scene_count + 1.3]
set ylabel "% of the step"
set key outside right top
set rmargin 26
set label 1 "paper, section 7.2:\nrefit 7-13 %\nlow-level 80-90 %\n" . \
    "high-level 2-10 %\nserial rest < 2 %" at graph 1.02, graph 0.6 font ',11'

$parts << EOD
EOD
set print $parts
do for [scene in scenes] {
    total = at(scene, 'paper', 'round-robin', 8, 'v["ms"]')
    refit = 100 * at(scene, 'paper', 'round-robin', 8, 'v["refit_ms"]') / total
    low = 100 * at(scene, 'paper', 'round-robin', 8, 'v["low_ms"]') / total
    high = 100 * at(scene, 'paper', 'round-robin', 8, 'v["high_ms"]') / total
    print sprintf("\"%s\" %.2f %.2f %.2f %.2f", scene, refit, low, high, \
        100 - refit - low - high)
}
print "\"paper, middle\" 10 83 6 1"
unset print

plot $parts using 2:xtic(1) title 'refit' lc rgb '#4477aa', \
    '' using 3 title 'low-level nodes' lc rgb '#66ccee', \
    '' using 4 title 'high-level nodes' lc rgb '#ee6677', \
    '' using 5 title 'merge, ingest, start' lc rgb '#ccbb44', \
    '' using ($0):(50):(sprintf("%.1f / %.1f / %.1f / %.1f", $2, $3, $4, $5)) \
        with labels rotate by 90 font ',9' notitle
