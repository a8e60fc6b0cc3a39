/* read_mesh.c - reads mesh files as pccdctl does, and tells the time and memory it
 * took. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "meshfile.h"

static double processor_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

/* Return the peak memory of this program alone: ru_maxrss has that of the one that
 * started it, too. */
static long peak_bytes(void)
{
    char line[128];
    long kibibytes = 0;
    FILE *status = fopen("/proc/self/status", "r");
    while (status != NULL && fgets(line, sizeof line, status) != NULL) {
        (void)sscanf(line, "VmHWM: %ld", &kibibytes);
    }
    if (status != NULL) {
        (void)fclose(status);
    }
    return kibibytes * 1024;
}

int main(int argc, char **argv)
{
    int times = argc > 2 ? atoi(argv[1]) : 0;
    long before = peak_bytes();
    for (int i = 2; i < argc; i++) {
        struct ctl_mesh mesh = {0};
        double least = 1e300;
        size_t bytes = 0;
        for (int k = 0; k < times; k++) {
            struct ctl_error error;
            double start = processor_seconds();
            if (ctl_mesh_read(argv[i], &mesh, &error) != PCCD_OK) {
                fprintf(stderr, "%s\n", error.text);
                return 1;
            }
            double seconds = processor_seconds() - start;
            least = seconds < least ? seconds : least;
            bytes = mesh.vertex_count * (mesh.format == PCCD_FORMAT_F32 ? 12ul : 24ul) +
                    mesh.triangles.count * 12ul;
            if (k + 1 == times) {
                printf("%s %u %u %.4f %zu %ld\n", argv[i], mesh.vertex_count,
                       mesh.triangles.count, least, bytes, peak_bytes() - before);
            }
            ctl_mesh_deinit(&mesh);
        }
    }
    return times > 0 ? 0 : 2;
}
