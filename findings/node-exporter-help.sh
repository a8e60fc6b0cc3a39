#!/bin/sh
# node-exporter-help.sh - node exporter: two files that explain a metric in other words lose one.
#
# Seen with prometheus-node-exporter 1.5.0 (Debian 12). Its textfile collector serves what several
# programs write into files of one folder, and merges families of one name: two files with the same
# HELP give both series. If the HELP of one differs by a word, as that of two releases of a program
# does, the series of the file that comes later are not served. Nothing that is scraped says so:
# node_textfile_scrape_error is 0, node_textfile_mtime_seconds ("textfiles successfully read") names
# both files, and the answer has status 200. Only the exporter's log tells it. A program that may
# run in two versions on one host has to leave the HELP of a metric as it is, or its name.

. "$(dirname "$0")/unpack.sh"
command -v curl >/dev/null || { echo "needs curl"; exit 2; }
unpack prometheus-node-exporter=1.5.0-1+b6
mkdir "$folder/metrics"
for host in a b; do
    printf '%s\n' '# HELP job_steps Steps of a job.' '# TYPE job_steps counter' \
        "job_steps{host=\"$host\"} 1" >"$folder/metrics/$host.prom"
done
port=19111
"$folder/root/usr/bin/prometheus-node-exporter" --web.listen-address=127.0.0.1:$port \
    --collector.disable-defaults --collector.textfile \
    --collector.textfile.directory="$folder/metrics" >"$folder/log" 2>&1 &
exporter=$!
trap 'kill $exporter 2>/dev/null; rm -rf "$folder"' EXIT
scrape() { curl -s --retry 20 --retry-connrefused --retry-delay 1 http://127.0.0.1:$port/metrics; }
tell() {
    echo "$1"
    scrape | sed -n 's/^\(job_steps{\|node_textfile_scrape_error\)/\1/p'
    scrape | grep -c '^node_textfile_mtime_seconds{'
}
seen=$(
    tell 'the same HELP'
    sed -i 's/of a job/of one job/' "$folder/metrics/b.prom"
    tell 'another HELP'
)
expect "$seen" 'the same HELP
job_steps{host="a"} 1
job_steps{host="b"} 1
node_textfile_scrape_error 0
2
another HELP
job_steps{host="a"} 1
node_textfile_scrape_error 0
2'
