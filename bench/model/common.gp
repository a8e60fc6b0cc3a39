# common.gp - what the figures share.
#
# Called with: folder   where model.csv is and where the figure goes
#              kind     svg or png
#
# A curve is a filter over model.csv; columns are found by name in its first line, so that
# the file may gain some.

csv = folder . '/model.csv'

if (kind eq 'svg') {
    set terminal svg size 1100,760 font 'Helvetica,13' background 'white' enhanced
} else {
    set terminal pngcairo size 1100,760 background 'white' enhanced
}

# Rows of a scene and a scheduler: p, then the value of an awk expression over v["column"].
rows(scene, scheduler, high, value) = sprintf( \
    "< awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "$at[\"scene\"] == \"%s\" && $at[\"scheduler\"] == \"%s\" && " . \
    "$at[\"high_level\"] == \"%s\" { for (name in at) v[name] = $at[name]; " . \
    "if ((%s) != \"\") print v[\"p\"], %s }' '%s'", \
    scene, scheduler, high, value, value, csv)

scenes = system(sprintf("awk -F, 'NR > 1 && !seen[$1]++ { printf \"%%s \", $1 }' '%s'", \
    csv))
scene_count = words(scenes)

# One number: the value at p.
at(scene, scheduler, high, p, value) = real(system(sprintf( \
    "awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "$at[\"scene\"] == \"%s\" && $at[\"scheduler\"] == \"%s\" && " . \
    "$at[\"high_level\"] == \"%s\" && $at[\"p\"] == %d { " . \
    "for (name in at) v[name] = $at[name]; print %s; exit }' '%s'", \
    scene, scheduler, high, p, value, csv)))

set grid back lc rgb '#dddddd'
set border 3 back
set tics nomirror
