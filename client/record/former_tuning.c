/* former_tuning.c - the numbers by which earlier recordings say how threads share
 * work.
 */
#include "former_tuning.h"

#include <stdio.h>
#include <string.h>

void record_former_tuning(const struct record_frame *frame, char text[PCCD_TUNING_BYTES])
{
    static const char *const words[3][3] = {
        {"", "scheduler=steal", "scheduler=paper"},
        {"", "high-level=round-robin", "high-level=disjoint"},
        {"", "refit=even", "refit=paper"}};

    text[0] = '\0';
    for (size_t i = 0; i < 3; i++) {
        uint32_t number = frame->former_tuning[i];
        size_t used = strlen(text);

        if (number == 1 || number == 2) {
            (void)snprintf(text + used, PCCD_TUNING_BYTES - used, "%s%s",
                           used > 0 ? "," : "", words[i][number]);
        }
    }
}
