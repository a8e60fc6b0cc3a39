/* taken.c - how much memory the kernel has taken for what a test shares with its
 * daemon. */
#include "taken.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cases.h"
#include "daemon.h"

#define AWAIT_MS 10000u

uint64_t test_taken_bytes(void)
{
    DIR *folder = opendir("/proc/self/fd");
    uint64_t bytes = 0;

    assert_non_null(folder);
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        char path[300];
        char target[64] = "";
        struct stat info;

        (void)snprintf(path, sizeof path, "/proc/self/fd/%s", entry->d_name);
        if (readlink(path, target, sizeof target - 1) > 0 &&
            strncmp(target, "/memfd:pccd-", 12) == 0 && stat(path, &info) == 0) {
            bytes += (uint64_t)info.st_blocks * 512;
        }
    }
    (void)closedir(folder);
    return bytes;
}

uint64_t test_taken_await(uint64_t bytes)
{
    uint64_t end_ms = test_now_ms() + AWAIT_MS;
    uint64_t taken = test_taken_bytes();

    while (taken > bytes && test_now_ms() < end_ms) {
        test_sleep_ms(10);
        taken = test_taken_bytes();
    }
    return taken;
}
