# shares.gp - what the parts take of a step, as the paper's Figure 8: predicted for eight
# threads and measured by as many as are here.
#
# Section 7.2: refit 7 to 13 %, low-level nodes 80 to 90 %, high-level nodes 2 to 10 %,
# the serial rest below 2 %.

load scripts . '/common.gp'
set output folder . '/shares.' . kind

set title "Parts of a step, paper's scheduler"
set style data histograms
set style histogram rowstacked
set style fill solid 0.8 border rgb 'white'
set boxwidth 0.6
set yrange [0:100]
set ylabel "% of the step"
set key outside right top
set rmargin 26
set label 1 "paper, section 7.2:\nrefit 7-13 %\nlow-level 80-90 %\n" . \
    "high-level 2-10 %\nserial rest < 2 %" at graph 1.02, graph 0.6 font ',11'

part(file, scene, p, column) = 100 * \
    at(file, scene, 'paper', 'round-robin', p, 'v["' . column . '"]') / \
    at(file, scene, 'paper', 'round-robin', p, 'v["ms"]')
line(file, scene, p, text) = sprintf("\"%s\" %.2f %.2f %.2f %.2f", text, \
    part(file, scene, p, 'refit_ms'), part(file, scene, p, 'low_ms'), \
    part(file, scene, p, 'high_ms'), 100 - part(file, scene, p, 'refit_ms') - \
    part(file, scene, p, 'low_ms') - part(file, scene, p, 'high_ms'))

$parts << EOD
EOD
bars = 1
set print $parts
do for [scene in scenes] {
    if (is_there(model)) {
        print line(model, scene, 8, scene . ", predicted, 8")
        bars = bars + 1
    }
    if (most > 1 && part(measured, scene, most, 'ms') > 0) {
        print line(measured, scene, most, sprintf("%s, measured, %d", scene, most))
        bars = bars + 1
    }
}
print "\"paper, middle\" 10 83 6 1"
unset print
set xrange [-0.7:bars - 0.3]
set xtics rotate by -20

plot $parts using 2:xtic(1) title 'refit' lc rgb '#4477aa', \
    '' using 3 title 'low-level nodes' lc rgb '#66ccee', \
    '' using 4 title 'high-level nodes' lc rgb '#ee6677', \
    '' using 5 title 'merge, ingest, start' lc rgb '#ccbb44', \
    '' using ($0):(50):(sprintf("%.1f / %.1f / %.1f / %.1f", $2, $3, $4, $5)) \
        with labels rotate by 90 font ',9' notitle
