# peers.gp - a whole step by one thread, ours by each instruction set beside the fastest other
# library's pairs with our tests: milliseconds, on a logarithmic scale.

load scripts . '/common.gp'
set output folder . '/peers.' . kind

file = folder . '/peers.csv'
sets = is_there(file) ? system(sprintf( \
    "awk -F, 'NR > 1 && !seen[$2]++ { printf \"%%s \", $2 }' '%s'", file)) : ''
of(set, column) = sprintf( \
    "< awk -F, '$2 == \"%s\" { print $1, $%d; n++ } END { if (!n) print \"- nan\" }' '%s'", \
    set, column, is_there(file) ? file : '/dev/null')
first = words(sets) > 0 ? word(sets, 1) : '-'

set title 'A whole step by one thread'
set style data histogram
set style histogram clustered gap 1
set style fill solid 0.8
set boxwidth 0.9
set logscale y
set yrange [0.3:*]
set ylabel 'milliseconds'
set grid ytics
set key outside center top horizontal
set xtics rotate by -20
plot for [i = 1:words(sets)] of(word(sets, i), 3) using 2:xtic(1) \
        title 'pccd, '.word(sets, i), \
    of(first, 4) using 2:xtic(1) lc rgb '#999999' \
        title 'fastest other library, with our tests by '.first
