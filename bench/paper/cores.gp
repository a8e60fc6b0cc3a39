# cores.gp - frame rate of the cloth over the number of processors, as the paper's Figure 1.
#
# Measured: the mean of the sequence, as a rate. Predicted: that of one thread times the
# speed-up of model.csv. Published: 56 ms and 6.4 times as fast by eight as by one.

load scripts . '/common.gp'
set output folder . '/cores.' . kind

scene = word(scenes, 1)
set title "Frames a second, " . scene
set logscale xy 2
set xrange [1:64]
set xlabel "threads"
set ylabel "frames a second"
# Names stand at the ends of their curves. (Where a curve has no point, `at end` ends gnuplot
# 5.4; what may not have been measured has none.)
set label 'marks: measured; dashed: predicted' at graph 0.03, 0.96
set key textcolor variable
set rmargin 36
set xtics (1, 2, 4, 8, 16, 32, 64)

rate = '1000 / v["ms"]'
one(scheduler, high) = at(measured, scene, scheduler, high, 1, rate)
paper = one('paper', 'round-robin')
wide = one('wide', 'none')

plot paper * x with lines lc rgb '#999999' dt 3 title '  ideal' at end, \
    wide * x with lines lc rgb '#999999' dt 3 notitle, \
    rows(model, scene, 'paper', 'round-robin', 'v["speedup"]') using 1:(paper * $2) \
        with lines lc 1 lw 1.5 dt 2 title "  paper's method, predicted" at end, \
    rows(measured, scene, 'paper', 'round-robin', rate) with points lc 1 lw 2 pt 6 ps 2 notitle, \
    rows(model, scene, 'wide', 'none', 'v["speedup"]') using 1:(wide * $2) \
        with lines lc 2 lw 1.5 dt 2 title '  method wide, predicted' at end, \
    rows(measured, scene, 'wide', 'none', rate) with points lc 2 lw 2 pt 4 ps 2 notitle, \
    '-' using 1:2:3 with labels point pt 2 ps 1.5 lc rgb 'black' left offset 1,0 \
        notitle
8 17.9 "published: 17.9 by eight, 2.83 GHz of 2008"
1 2.8 "published: 2.8 by one"
e
