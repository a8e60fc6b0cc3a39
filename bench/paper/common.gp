# common.gp - what the figures share.
#
# Called with: folder   where the CSV files are and where the figure goes
#              kind     svg or png
#              scripts  this folder
#
# A curve is a filter over a CSV file; columns are found by name in its first line, so that
# the file may gain some. model.csv has predictions, measured.csv what was measured on this
# machine, in the same columns (measured.awk); either may be missing.

model = folder . '/model.csv'
measured = folder . '/measured.csv'
is_there(file) = int(system(sprintf("test -s '%s' && echo 1 || echo 0", file)))

if (kind eq 'svg') {
    set terminal svg size 1100,760 font 'Helvetica,13' background 'white' enhanced
} else {
    set terminal pngcairo size 1100,760 background 'white' enhanced
}

# Rows of a scene and a scheduler: p, then the value of an awk expression over v["column"].
# A file that is not there has none.
rows(file, scene, scheduler, high, value) = sprintf( \
    "< awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "$at[\"scene\"] == \"%s\" && $at[\"scheduler\"] == \"%s\" && " . \
    "$at[\"high_level\"] == \"%s\" { for (name in at) v[name] = $at[name]; " . \
    "if ((%s) != \"\") { print v[\"p\"], %s; n++ } } END { if (!n) print \"nan nan\" }' " . \
    "'%s'", scene, scheduler, high, value, value, is_there(file) ? file : '/dev/null')

# One number: the value at p; nan where there is none.
at(file, scene, scheduler, high, p, value) = real(system(sprintf( \
    "awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "$at[\"scene\"] == \"%s\" && $at[\"scheduler\"] == \"%s\" && " . \
    "$at[\"high_level\"] == \"%s\" && $at[\"p\"] == %d { " . \
    "for (name in at) v[name] = $at[name]; print %s; n++; exit } " . \
    "END { if (!n) print \"nan\" }' '%s'", \
    scene, scheduler, high, p, value, is_there(file) ? file : '/dev/null')))

first_column(file) = system(sprintf( \
    "awk -F, 'NR > 1 && !seen[$1]++ { printf \"%%s \", $1 }' '%s'", \
    is_there(file) ? file : '/dev/null'))
scenes = is_there(model) ? first_column(model) : first_column(measured)
scene_count = words(scenes)

# The most threads that were measured.
most = is_there(measured) ? int(system(sprintf( \
    "awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } " . \
    "$at[\"p\"] > p { p = $at[\"p\"] } END { print p + 0 }' '%s'", measured))) : 0

set grid back lc rgb '#dddddd'
set border 3 back
set tics nomirror
