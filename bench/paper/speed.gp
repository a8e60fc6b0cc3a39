# speed.gp - README's chart: what pccd takes by one thread, and others in the same run, in
# milliseconds.
#
# A group of bars is of one run, and its longest bar is as long as those of the others: steps.txt
# has pccd by two instruction sets and the method of the paper, peers.csv pccd and the fastest other
# library, allowed.csv (bench-allowed) pccd and ipc-toolkit. Each bar is labelled where it stands.

load scripts . '/common.gp'
set output folder . '/speed.' . kind
if (kind eq 'svg') {
    set terminal svg size 900,560 font 'Helvetica,14' background 'white' enhanced
}

# Rows: where it stands, its part of the group's longest (0: a heading), whether it is pccd, the
# value, the text.
bars = sprintf("< awk -v OFS='\t' '" . \
    "BEGIN { told[\"cloth-ball\"] = \"cloth on a ball, 92 230 triangles\";" . \
    "    told[\"n-body\"] = \"balls, 146 480 triangles\" }" . \
    "function flush(   i) { for (i = 0; i < bars; i++) print y++, time[i] / most, rest[i];" . \
    "    bars = most = 0 }" . \
    "function head(text) { flush(); y += 0.6; print y++, 0, 0, \"\", text }" . \
    "function bar(text, ms, is_ours) { most = ms > most ? ms : most; time[bars] = ms;" . \
    "    rest[bars++] = is_ours OFS sprintf(ms < 10 ? \"%%.1f\" : \"%%.0f\", ms) OFS text }" . \
    "FILENAME ~ /steps/ && /^wide:/ { scene = $2 }" . \
    "FILENAME ~ /steps/ && /^the first/ { best = $3 }" . \
    "FILENAME ~ /steps/ && /^--cpu=avx2/ { avx2 = $2 }" . \
    "FILENAME ~ /steps/ && /^--method=paper/ && scene in told {" . \
    "    head(\"All contacts, beside the PCCD paper: \" told[scene]); bar(\"pccd, AVX-512\", best, 1);" . \
    "    bar(\"pccd, AVX2\", avx2, 1); bar(\"method of the PCCD paper\", $2, 0) }" . \
    "{ n = split($0, v, \",\") }" . \
    "FILENAME ~ /peers/ && v[2] == \"avx2\" && v[1] in told {" . \
    "    head(\"All contacts, beside Embree: \" told[v[1]]); bar(\"pccd, AVX2\", v[3], 1);" . \
    "    bar(\"Embree, exact tests by pccd\", v[4], 0) }" . \
    "FILENAME ~ /allowed/ && v[1] in told {" . \
    "    head(\"Largest safe step: \" told[v[1]]); bar(\"pccd, AVX-512\", v[2], 1);" . \
    "    bar(\"ipc-toolkit, additive CCD\", v[3], 0);" . \
    "    bar(\"ipc-toolkit, Tight-Inclusion\", v[4], 0) }" . \
    "END { flush() }" . \
    "' $(ls -r '%s/steps.txt' '%s/peers.csv' '%s/allowed.csv' 2>/dev/null)", folder, folder, folder)

set datafile separator "\t"
set label 'Milliseconds on one thread (less is better). Each group is one run with its own scale' at screen 0.02, 0.965 font ',16'
set xrange [0:1.1]
set yrange [*:*] reverse
set lmargin at screen 0.25
set rmargin 1
set tmargin 3
set bmargin 1
set border 0
unset xtics
unset ytics
unset grid
unset key
heading(ms) = ms == 0
plot bars using (0):(heading($2) ? NaN : $1):(0):2:($1 - 0.38):($1 + 0.38): \
            ($3 == 1 ? 0x1f6fb4 : 0x9aa3ad) \
        with boxxyerror fill solid 1 noborder lc rgb variable, \
    '' using 2:(heading($2) ? NaN : $1):4 with labels left offset 0.4, 0, \
    '' using (0):(heading($2) ? NaN : $1):5 with labels right offset -1, 0, \
    '' using (0):(heading($2) ? $1 : NaN):5 with labels left
