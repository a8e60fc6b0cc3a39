# pccd-load.gp - draws what pccd-load has written, latency by percentile and by second.
#
#   gnuplot -e "percentiles='p.csv'; csv='s.csv'; png='run.png'" pccd-load.gp
#
# Called with: percentiles   the file of --percentiles
#              csv           the file of --csv
#              png           the picture to write
#              deadline      milliseconds, drawn as a line, if it is set

set terminal pngcairo size 1000,800
set output png
set datafile separator ','
set datafile columnheaders
set multiplot layout 2,1
set grid
set rmargin 4
set ylabel 'ms'
set key left top
set logscale y
set xlabel 'percentile'
set xtics ('0' 0, '90' 1, '99' 2, '99.9' 3, '99.99' 4, '99.999' 5)
if (!exists('deadline')) deadline = NaN
plot percentiles using 'nines':'latency_ms' with lines lw 2 title 'latency', \
    deadline with lines dt 2 title (deadline > 0 ? 'deadline' : '')
set xlabel 'second'
set xtics auto
set xrange [0:*]
plot csv using 'second':'p50_ms' with lines title 'p50', \
    csv using 'second':'p99_ms' with lines title 'p99', \
    csv using 'second':'longest_ms' with points pt 7 ps 0.6 title 'longest'
unset multiplot
