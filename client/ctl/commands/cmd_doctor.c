/* cmd_doctor.c - pccdctl doctor. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "ctl.h"
#include "doctor.h"
#include "link.h"
#include "output.h"
#include "shown.h"
#include "terminal.h"

const struct option_table ctl_table_doctor = {
    .parts = (const struct option_part[]){{&ctl_query_table, 0}, {0}},
    .text = "Look for mistakes in a set-up: socket, rights, limits, versions, "
            "processors, threads, the daemon itself.",
    .more = "Each line is ok, warn or FAIL, with what to do next. Exit status: 0 "
            "without a FAIL, 1 with one.",
    .examples = "  pccdctl doctor\n"
                "  pccdctl doctor --json --socket /run/pccd/pccd.sock\n",
};

static const char *const verdict_names[] = {
    [DOCTOR_OK] = "ok", [DOCTOR_WARN] = "warn", [DOCTOR_FAIL] = "FAIL"};

static void print(const struct doctor *doctor)
{
    static const enum terminal_colour colours[] = {[DOCTOR_OK] = TERMINAL_GREEN,
                                                   [DOCTOR_WARN] = TERMINAL_YELLOW,
                                                   [DOCTOR_FAIL] = TERMINAL_RED};
    for (uint32_t i = 0; i < doctor->count; i++) {
        const struct doctor_finding *finding = &doctor->findings[i];
        printf("%s%-4s%s  %-10s %s\n", terminal_begin(colours[finding->verdict]),
               verdict_names[finding->verdict], terminal_end(), finding->what,
               tool_shown(finding->text));
        if (finding->advice[0] != '\0') {
            printf("                 -> %s\n", tool_shown(finding->advice));
        }
    }
}

static void print_json(const struct doctor *doctor)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < doctor->count; i++) {
        const struct doctor_finding *finding = &doctor->findings[i];
        json_array_append_new(array, json_pack("{s:s, s:s, s:s, s:s}", "verdict",
                                               verdict_names[finding->verdict], "what",
                                               finding->what, "text", finding->text,
                                               "advice", finding->advice));
    }
    (void)output_json(array, true, stdout);
}

int ctl_cmd_doctor(int argc, char **argv)
{
    struct ctl_query query = {.link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    struct pccd_client *client = NULL;
    if (option_parse(&ctl_table_doctor, argc, argv, &query) != 0) {
        return CTL_USAGE;
    }
    struct doctor *doctor = calloc(1, sizeof *doctor);
    if (doctor == NULL) {
        ctl_link_deinit(&query.link);
        return ctl_complain("out of memory");
    }
    struct pccd_options asked;
    ctl_link_options(&query.link, &asked);
    doctor_look_at_machine(doctor);
    doctor_look_at_socket(doctor, &asked);
    int status = pccd_connect(&asked, &client);
    doctor_look_at_daemon(doctor, client, status);
    if (query.is_json) {
        print_json(doctor);
    } else {
        print(doctor);
    }
    int exit_status = doctor->has_failed ? CTL_NEGATIVE : CTL_DONE;
    free(doctor);
    pccd_close(client);
    ctl_link_deinit(&query.link);
    return exit_status;
}
