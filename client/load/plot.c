/* plot.c - a picture of a run. */
#include "series.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>

#include "printable.h"

/* Of the percentiles' axis: 0.9 is one, 0.99 is two. */
#define NINES_STEP 0.05
#define NINES_MAX  5.0

bool load_plot_can(void)
{
    bool can = system("command -v gnuplot >/dev/null 2>&1") == 0;
    if (!can) {
        load_say("--plot needs gnuplot (Debian: apt install gnuplot-nox)");
    }
    return can;
}

/* As far as so many latencies tell. */
static double nines_of(const struct load_hist *latency)
{
    return fmin(ceil(log10((double)latency->count + 1)), NINES_MAX);
}

static void send_percentiles(FILE *pipe, const struct load_hist *latency)
{
    fprintf(pipe, "$percentiles << EOD\n");
    for (double nines = 0; nines <= nines_of(latency); nines += NINES_STEP) {
        double share = 1 - pow(10, -nines);
        fprintf(pipe, "%.3f %.4f\n", nines,
                1e-6 * (double)load_hist_quantile(latency, share));
    }
    fprintf(pipe, "EOD\n");
}

static void send_seconds(FILE *pipe, const struct load_series *series)
{
    fprintf(pipe, "$seconds << EOD\n");
    for (size_t i = 0; i < series->count; i++) {
        const struct load_second *s = &series->seconds[i];
        if (s->measured > 0) {
            fprintf(pipe, "%.3f %.4f %.4f %.4f\n", s->at_s, s->p50_ms, s->p99_ms,
                    s->longest_ms);
        }
    }
    fprintf(pipe, "EOD\n");
}

static void send_commands(FILE *pipe, const struct load *load,
                          const struct load_hist *latency)
{
    const struct load_settings *settings = &load->settings;
    fprintf(pipe, "set terminal pngcairo size 1000,800\n");
    fprintf(pipe,
            "set multiplot layout 2,1 title \"%u %s, %u to %u triangles, %s\"\n"
            "set grid\nset ylabel \"ms\"\nset key left top\nset logscale y\n"
            "set xlabel \"percentile\"\n"
            "set xtics (\"0\" 0, \"90\" 1, \"99\" 2, \"99.9\" 3, \"99.99\" 4, "
            "\"99.999\" 5)\n",
            settings->clients, proto_plural(settings->clients, "client", "clients"),
            settings->sizes.parts[0].low, load_sizes_largest(&settings->sizes),
            settings->hz > 0 ? "open loop" : "closed loop");
    fprintf(pipe,
            "set xrange [0:%g]\nplot $percentiles with lines lw 2 title \"latency\"",
            nines_of(latency));
    if (settings->deadline_ms > 0) {
        fprintf(pipe, ", %g with lines dt 2 title \"deadline\"", settings->deadline_ms);
    }
    fprintf(pipe, "\nset xlabel \"second\"\nset xtics auto\nset xrange [0:*]\n"
                  "plot $seconds using 1:2 with lines title \"p50\", "
                  "$seconds using 1:3 with lines title \"p99\", "
                  "$seconds using 1:4 with points pt 7 ps 0.6 title \"longest\"\n"
                  "unset multiplot\n");
}

bool load_plot(const struct load *load, const struct load_series *series,
               const struct load_hist *latency)
{
    char command[64];
    int fd = load->plot.fd;
    signal(SIGPIPE, SIG_IGN); /* gnuplot may end at the first line */
    /* gnuplot inherits the file, which has no name yet. */
    snprintf(command, sizeof command, "exec gnuplot >/dev/fd/%d", fd);
    FILE *pipe = fcntl(fd, F_SETFD, 0) == 0 ? popen(command, "w") : NULL;
    if (!pipe) {
        load_say("gnuplot cannot be started");
        return false;
    }
    send_percentiles(pipe, latency);
    send_seconds(pipe, series);
    send_commands(pipe, load, latency);
    bool good = pclose(pipe) == 0;
    if (!good) {
        load_say("gnuplot could not write %s", load->settings.plot);
    }
    return good;
}
