# growth.gp - time, memory, contacts and clients on logarithmic axes, with the exponents
# that fit.awk found in the two upper decades; time and counted work of one triangle.
#
# Called with: folder   where the CSV files are and the figures go
#              kind     svg or png

if (kind eq 'svg') {
    set terminal svg size 1100,760 font 'Helvetica,13' background 'white' enhanced
} else {
    set terminal pngcairo size 1100,760 background 'white' enhanced
}
set datafile separator ','
set datafile columnheaders
set grid back lc rgb '#dddddd'
set border 3 back
set tics nomirror
set logscale xy
set format x '10^{%T}'
# Names stand at the ends of their curves, in colours that are dark enough for text.
set key textcolor variable
set rmargin 46
set xrange [1e3:1.1e7]
set linetype 3 lc rgb '#1f6fb4'
set linetype 4 lc rgb '#a04a00'
set linetype 5 lc rgb '#7a6200'

# Rows of a method, with the columns' names; the exponent of a quantity.
rows(file, method) = sprintf("< awk -F, 'NR == 1 || $1 == \"%s\"' '%s/%s'", method, folder, file)
slope(quantity, against) = system(sprintf( \
    "awk -F, '$1 == \"%s\" && $2 == \"%s\" { print $3 }' '%s/exponents.csv'", \
    quantity, against, folder))
each(name) = column(name) / column('triangles')
contacts(zero) = column('contacts') > 0 ? column('contacts') : zero

set output folder . '/growth-time.' . kind
set title 'Time against triangles, as many contacts a triangle in each size (one thread)'
set xlabel 'triangles'
set ylabel 'ms'
plot rows('size.csv', 'wide') using 'triangles':'register_ms' with linespoints lw 2 pt 7 \
        title '  register (exponent ' . slope('register_ms', 'triangles') . ')' at end, \
    '' using 'triangles':'step_ms' with linespoints lw 2 pt 7 \
        title '  step (' . slope('step_ms', 'triangles') . ')' at end, \
    '' using 'triangles':'refit_ms' with linespoints lw 2 pt 7 \
        title '  refit (' . slope('refit_ms', 'triangles') . ')' at end, \
    '' using 'triangles':'near_ms' with linespoints lw 2 pt 7 \
        title "\n\n  closest features near (" . slope('near_ms', 'triangles') . ')' at end, \
    rows('size.csv', 'paper') using 'triangles':'step_ms' with linespoints dt 2 pt 6 \
        title '  step, method paper' at end

unset logscale y
set yrange [0:*]
set output folder . '/growth-triangle.' . kind
set title 'Of one triangle: time, and the work that is counted (one thread)'
set ylabel 'ns'
set y2range [0:10]
plot rows('size.csv', 'wide') using 'triangles':(1e6 * each('register_ms')) \
        with linespoints lw 2 pt 7 title '  register' at end, \
    '' using 'triangles':(1e6 * (each('register_ms') - each('register_kernel_ms'))) \
        with linespoints lw 2 pt 6 title '  of it, outside of the kernel' at end, \
    '' using 'triangles':(1e6 * each('step_ms')) with linespoints lw 2 pt 7 title '  step' at end, \
    '' using 'triangles':(each('box_tests')) axes x1y2 with linespoints dt 2 pt 4 lc 8 \
        title '  box tests of a step, 0 to 10 (exponent ' . slope('box_tests', 'triangles') . ')' at end, \
    '' using 'triangles':(each('candidates')) axes x1y2 with linespoints dt 2 pt 8 lc 4 \
        title '  candidates, 0 to 10 (' . slope('candidates', 'triangles') . ')' at end

set output folder . '/growth-memory.' . kind
set title 'Memory of the engine a triangle'
set ylabel 'bytes a triangle'
plot rows('size.csv', 'wide') using 'triangles':(each('registered_bytes')) \
        with linespoints lw 2 pt 7 title '  registered' at end, \
    '' using 'triangles':(each('scene_bytes')) with linespoints lw 2 pt 7 \
        title '  resident after a step (exponent ' . slope('scene_bytes', 'triangles') . ')' at end, \
    '' using 'triangles':(each('scene_bytes') + each('records_bytes')) \
        with linespoints lw 2 pt 7 title '  with the answer and what finds it' at end, \
    rows('size.csv', 'paper') using 'triangles':(each('scene_bytes')) \
        with linespoints dt 2 pt 6 title '  resident, method paper' at end, \
    400 with lines dt 3 lc rgb 'black' title '  400' at end

set logscale y
set yrange [*:*]
set xrange [*:*]
set output folder . '/growth-contacts.' . kind
set title 'A step of 518 400 triangles against its contacts (one thread)'
set xlabel 'contacts (none: 1)'
set ylabel 'ms'
plot rows('contacts.csv', 'wide') using (contacts(1)):'step_ms' with linespoints lw 2 pt 7 \
        title '  step (exponent of what contacts add ' . slope('step_ms', 'contacts') . ')' at end, \
    '' using (contacts(1)):'tests_ms' with linespoints pt 6 title '  tests' at end, \
    '' using (contacts(1)):'merge_ms' with linespoints pt 6 title '  sort and merge' at end

set output folder . '/growth-clients.' . kind
set title 'Clients that together ask for the same number of steps of 1000 triangles'
set xlabel 'clients'
set ylabel 'us'
plot rows('clients.csv', 'load') using 'clients':'request_us' with linespoints lw 2 pt 7 \
        title '  time a request, all clients together (exponent ' . \
        slope('request_us', 'clients') . ')' at end, \
    '' using 'clients':'p50_us' with linespoints lw 2 pt 7 \
        title '  latency, median (' . slope('p50_us', 'clients') . ')' at end, \
    '' using 'clients':'p99_us' with linespoints pt 6 title '  latency, p99' at end
