#!/bin/bash
# growth.sh - how time and memory grow with triangles, contacts and clients.
#
#   growth.sh FOLDER           CSV, fitted exponents and figures into FOLDER; minutes
#   growth.sh --smoke FOLDER   tiny: does it still run?
#
# By growth (triangles, contacts) and pccd-load (1 to 1000 clients, who together ask for the
# same number of steps).

set -u -o pipefail
: "${top_srcdir:?is set by make}" "${top_builddir:=.}"
smoke=
folder=
for word; do
    case $word in
        --smoke) smoke=--smoke ;;
        *) folder=$word ;;
    esac
done
: "${folder:?is where the results go}"
here=$top_srcdir/bench/growth
mkdir -p "$folder" || exit 1

requests=60000
clients='1 3 10 30 100 300 1000'
[ -n "$smoke" ] && { requests=40; clients='1 4'; }


grow_clients() {
    echo "method,clients,requests,requests_per_s,request_us,p50_us,p99_us"
    for count in $clients; do
        report=$("$top_builddir/pccd-load" --json --daemon "$top_builddir/pccdd" \
            --clients "$count" --requests $((requests / count)) --processes 2 \
            --depth 1 --kinds follow --scene wave --triangles 1k) || {
            echo "$report" >&2
            return 1
        }
        latency=${report#*\"latency_us\":}
        latency=${latency%%\}*}
        rate=$(sed -n 's/.*"rate":\([0-9.]*\).*/\1/p' <<<"$report")
        awk -v c="$count" -v rate="$rate" \
            -v n="$(sed -n 's/.*"count":\([0-9]*\).*/\1/p' <<<"$latency")" \
            -v p50="$(sed -n 's/.*"p50":\([0-9.]*\).*/\1/p' <<<"$latency")" \
            -v p99="$(sed -n 's/.*"p99":\([0-9.]*\).*/\1/p' <<<"$latency")" \
            'BEGIN { printf "load,%d,%d,%.1f,%.3f,%.1f,%.1f\n", c, n, rate, 1e6 / rate, p50, p99 }'
    done
}

fit() {
    awk -F, -f "$here/fit.awk" x="$2" y="$3" only="$4" minus="$5" "$folder/$1.csv"
}

fit_all() {
    echo "quantity,against,exponent,points,factor"
    for quantity in register_ms step_ms refit_ms box_tests candidates scene_bytes near_ms \
        near_bytes; do
        fit size triangles $quantity wide 0 || return
    done
    fit contacts contacts step_ms wide 1 || return
    fit clients clients request_us load 0 || return
    fit clients clients p50_us load 0 || return
}

"$top_builddir/bench/growth/growth" $smoke --into "$folder" || exit 1
grow_clients >"$folder/clients.csv" || exit 1
fit_all >"$folder/exponents.csv" || exit 1
column -s, -t "$folder/exponents.csv" 2>/dev/null || cat "$folder/exponents.csv"
if command -v gnuplot >/dev/null; then
    for kind in svg; do
        gnuplot -e "folder='$folder'; kind='$kind'" "$here/growth.gp" || exit 1
    done
else
    echo "no gnuplot: no figures" >&2
fi
