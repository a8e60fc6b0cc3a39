# growth.gp - time, memory, contacts and clients on logarithmic axes, with the exponents
# that fit.awk found in the two upper decades.
#
# Called with: folder   where the CSV files are and the figures go
#              kind     svg or png

if (kind eq 'svg') {
    set terminal svg size 1100,760 font 'Helvetica,13' background 'white' enhanced
} else {
    set terminal pngcairo size 1100,760 background 'white' enhanced
}
set datafile separator ','
set grid back lc rgb '#dddddd'
set border 3 back
set tics nomirror
set logscale xy
set format x '10^{%T}'
set key left top

# Rows of a method; the exponent of a quantity.
rows(file, method) = sprintf("< awk -F, 'NR > 1 && $1 == \"%s\"' '%s/%s'", method, folder, file)
slope(quantity, against) = system(sprintf( \
    "awk -F, '$1 == \"%s\" && $2 == \"%s\" { print $3 }' '%s/exponents.csv'", \
    quantity, against, folder))

set output folder . '/growth-time.' . kind
set title 'Time against triangles, as many contacts a triangle in each size (one thread)'
set xlabel 'triangles'
set ylabel 'ms'
plot rows('size.csv', 'wide') using 3:6 with linespoints lw 2 pt 7 \
        title 'register (exponent ' . slope('register_ms', 'triangles') . ')', \
    '' using 3:7 with linespoints lw 2 pt 7 \
        title 'step (' . slope('step_ms', 'triangles') . ')', \
    '' using 3:8 with linespoints lw 2 pt 7 \
        title 'refit (' . slope('refit_ms', 'triangles') . ')', \
    rows('size.csv', 'paper') using 3:7 with linespoints dt 2 pt 6 title 'step, method paper'

set output folder . '/growth-memory.' . kind
set title 'Memory of the engine a triangle'
set ylabel 'bytes a triangle'
unset logscale y
set yrange [0:*]
plot rows('size.csv', 'wide') using 3:($12 / $3) with linespoints lw 2 pt 7 \
        title 'registered', \
    '' using 3:($13 / $3) with linespoints lw 2 pt 7 \
        title 'resident after a step (exponent ' . slope('scene_bytes', 'triangles') . ')', \
    '' using 3:(($13 + $14) / $3) with linespoints lw 2 pt 7 \
        title 'with the answer and what finds it', \
    rows('size.csv', 'paper') using 3:($13 / $3) with linespoints dt 2 pt 6 \
        title 'resident, method paper', \
    400 with lines dt 3 lc rgb 'black' title '400'

set logscale y
set yrange [*:*]
set output folder . '/growth-contacts.' . kind
set title 'A step of 518 400 triangles against its contacts (one thread)'
set xlabel 'contacts (none: 1)'
set ylabel 'ms'
plot rows('contacts.csv', 'wide') using ($4 > 0 ? $4 : 1):7 with linespoints lw 2 pt 7 \
        title 'step (exponent of what contacts add ' . slope('step_ms', 'contacts') . ')', \
    '' using ($4 > 0 ? $4 : 1):10 with linespoints pt 6 title 'tests', \
    '' using ($4 > 0 ? $4 : 1):11 with linespoints pt 6 title 'sort and merge'

set output folder . '/growth-clients.' . kind
set title 'Clients that together ask for the same number of steps of 1000 triangles'
set xlabel 'clients'
set ylabel 'us'
plot rows('clients.csv', 'load') using 2:5 with linespoints lw 2 pt 7 \
        title 'time a request, all clients together (exponent ' . \
        slope('request_us', 'clients') . ')', \
    '' using 2:6 with linespoints lw 2 pt 7 \
        title 'latency, median (' . slope('p50_us', 'clients') . ')', \
    '' using 2:7 with linespoints pt 6 title 'latency, p99'
