# rates.gp - frame rates over the sequences, as the paper's Figure 6.
#
# A dot is one step. Published are only the means by eight processors: 17.9, 7.7 and 7.3
# frames a second (section 7.1), and that spikes come from reconstruction.

load scripts . '/common.gp'
set output folder . '/rates.' . kind

sequence = folder . '/sequence.csv'
told = first_column(sequence)

# Step, then frames a second.
steps(scene, method, p) = sprintf( \
    "< awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "$at[\"scene\"] == \"%s\" && $at[\"method\"] == \"%s\" && $at[\"threads\"] == %d " . \
    "{ print $at[\"step\"], 1000 / $at[\"step_ms\"] }' '%s'", scene, method, p, sequence)
published(scene) = scene eq 'cloth' ? 17.9 : scene eq 'breaking' ? 7.7 : \
    scene eq 'bodies' ? 7.3 : NaN

set multiplot layout words(told), 1 title "Frames a second, step after step"
set logscale y
set ylabel "frames / s"
# Names stand at the ends of their curves.
set key textcolor variable
set rmargin 36
set yrange [2:500]
do for [scene in told] {
    set title sprintf("%s (dotted: published, 8 threads: %.1f)", scene, published(scene))
    set xlabel scene eq word(told, words(told)) ? "step" : ""
    plot steps(scene, 'wide', most) with lines lc 2 lw 1.2 \
            title sprintf("  method wide, %d threads\n", most) at end, \
        steps(scene, 'wide', 1) with lines lc 2 dt 2 title "\n  method wide, 1 thread" at end, \
        steps(scene, 'paper', most) with lines lc 1 lw 1.2 \
            title sprintf("  method of the paper, %d threads\n", most) at end, \
        steps(scene, 'paper', 1) with lines lc 1 dt 2 \
            title "\n  method of the paper, 1 thread" at end, \
        published(scene) with lines lc rgb 'black' dt 3 notitle
}
unset multiplot
