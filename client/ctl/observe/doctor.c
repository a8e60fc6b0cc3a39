/* doctor.c - what is wrong with a daemon. */
#include "doctor.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "counters.h"
#include "printable.h"

#define PINGS        20
#define SLOW_PING_NS 2000000u

void doctor_find(struct doctor *doctor, enum doctor_verdict verdict, const char *what,
                 const char *advice, const char *format, ...)
{
    struct doctor_finding *finding = &doctor->findings[doctor->count];
    va_list arguments;
    if (doctor->count == DOCTOR_MAX) {
        return;
    }
    finding->verdict = verdict;
    finding->what = what;
    va_start(arguments, format);
    vsnprintf(finding->text, sizeof finding->text, format, arguments);
    va_end(arguments);
    snprintf(finding->advice, sizeof finding->advice, "%s", advice);
    doctor->count++;
    doctor->has_failed = doctor->has_failed || verdict == DOCTOR_FAIL;
}

static void look_at_failure(struct doctor *doctor, int status)
{
    const char *advice;
    if (doctor->is_unused && !doctor->has_failed && doctor->last_words[0] == '\0') {
        doctor_find(doctor, DOCTOR_OK, "daemon",
                    "a program that uses pccd starts one (pccdctl load FILE does)",
                    "none runs, and none is needed");
        return;
    }
    switch (status) {
    case PCCD_E_ACCESS:
        advice = "pccdd --allow-uid and --allow-gid say who may; ask who runs it";
        break;
    case PCCD_E_VERSION:
        advice = "install the daemon and the library of one release, and start it anew";
        break;
    case PCCD_E_QUOTA:
        advice = "pccdctl config set clients-max N, or connections-max N, lets more in";
        break;
    case PCCD_E_TIMEOUT:
        advice = "it hangs: gdb -p or kill -ABRT tell where";
        break;
    default:
        advice = "start pccdd, or let a program do it (pccdctl load FILE does), or set "
                 "PCCD_URL";
        break;
    }
    doctor_find(doctor, DOCTOR_FAIL, "daemon", advice, "%s", pccd_error_text(NULL));
    if (doctor->last_words[0] != '\0') {
        doctor_find(doctor, DOCTOR_WARN, "log",
                    "if it was no kill, this says what to mend before another one starts",
                    "the last daemon there has died; it said: %s", doctor->last_words);
    }
}

static void look_at_versions(struct doctor *doctor, const struct pccd_daemon_info *daemon)
{
    const char *release = strchr(daemon->name, ' ');
    bool is_same = release != NULL && strcmp(release + 1, pccd_version()) == 0;
    doctor_find(doctor, is_same ? DOCTOR_OK : DOCTOR_WARN, "versions",
                is_same ? "" : "both work, but what is newer in one cannot be used",
                "%s, process %" PRIu32 "; library %s; protocol %" PRIu32, daemon->name,
                daemon->pid, pccd_version(), daemon->version);
}

static void look_at_threads(struct doctor *doctor, const struct pccd_daemon_info *daemon,
                            const struct counters *counters)
{
    bool is_bound = counters_get(counters, "threads_bound") != 0;
    uint64_t processors = counters_get(counters, "processors"); /* 0: an older one */
    uint64_t allowed = counters_get(counters, "processors_allowed");
    if (processors < allowed) {
        doctor_find(doctor, DOCTOR_WARN, "threads",
                    "what started it was bound to these (by mpirun, OMP_PROC_BIND or "
                    "taskset): end it, and start pccdd elsewhere",
                    "%" PRIu32 " %s of a step, %" PRIu64 " of %" PRIu64 " processors",
                    daemon->threads_max,
                    proto_plural(daemon->threads_max, "thread", "threads"), processors,
                    allowed);
    } else if (processors > 0 && daemon->threads_max > processors) {
        doctor_find(doctor, DOCTOR_WARN, "threads",
                    "more threads than processors wait for each other: pccdctl config "
                    "set threads N",
                    "%" PRIu32 " threads of a step, %" PRIu64 " %s", daemon->threads_max,
                    processors, proto_plural(processors, "processor", "processors"));
    } else if (!is_bound && daemon->threads_max > 1) {
        doctor_find(doctor, DOCTOR_WARN, "threads",
                    "pccdd --pin on, if it is the only daemon that computes here",
                    "%" PRIu32 " threads of a step, not bound to processors: two may "
                    "share one",
                    daemon->threads_max);
    } else {
        doctor_find(doctor, DOCTOR_OK, "threads", "",
                    "%" PRIu32 " %s of a step%s, %" PRIu64 " %s", daemon->threads_max,
                    proto_plural(daemon->threads_max, "thread", "threads"),
                    is_bound ? ", each bound to a processor" : "", processors,
                    proto_plural(processors, "processor", "processors"));
    }
}

static void look_at_cpu(struct doctor *doctor, const struct pccd_daemon_info *daemon)
{
    bool is_slow =
        strcmp(daemon->cpu, "scalar") == 0 || strncmp(daemon->cpu, "sse", 3) == 0;
    doctor_find(doctor, is_slow ? DOCTOR_WARN : DOCTOR_OK, "cpu",
                is_slow ? "is PCCD_CPU set where it was started? otherwise the processor "
                          "has no better one"
                        : "",
                "instruction set %s", daemon->cpu);
}

static void look_at_latency(struct doctor *doctor, struct pccd_client *client)
{
    uint64_t least_ns = UINT64_MAX, ns = 0;
    for (int i = 0; i < PINGS; i++) {
        if (pccd_ping(client, &ns) != PCCD_OK) {
            doctor_find(doctor, DOCTOR_FAIL, "ping", "pccdctl trace tells what it does",
                        "%s", pccd_error_text(client));
            return;
        }
        least_ns = ns < least_ns ? ns : least_ns;
    }
    bool is_slow = least_ns > SLOW_PING_NS;
    doctor_find(doctor, is_slow ? DOCTOR_WARN : DOCTOR_OK, "ping",
                is_slow ? "the machine is overloaded: pccdctl top tells by whom" : "",
                "%.1f us, the best of %d", (double)least_ns / 1e3, PINGS);
}

void doctor_look_at_daemon(struct doctor *doctor, struct pccd_client *client, int status)
{
    struct pccd_daemon_info daemon;
    struct counters counters;
    struct health health;
    if (client == NULL) {
        look_at_failure(doctor, status);
        return;
    }
    if (pccd_daemon(client, &daemon) != PCCD_OK ||
        counters_read(client, &counters) != PCCD_OK) {
        doctor_find(doctor, DOCTOR_FAIL, "daemon", "", "%s", pccd_error_text(client));
        return;
    }
    look_at_versions(doctor, &daemon);
    look_at_cpu(doctor, &daemon);
    look_at_threads(doctor, &daemon, &counters);
    look_at_latency(doctor, client);
    health_judge(&counters, &health);
    for (uint32_t i = 0; i < health.count; i++) {
        doctor_find(doctor, DOCTOR_WARN, "health", "", "%s", health.text[i]);
    }
    if (health.count == 0) {
        doctor_find(doctor, DOCTOR_OK, "health", "", "its counters show nothing unusual");
    }
}
