/* doctor.h - looks for mistakes in a set-up (`pccdctl doctor`). */
#ifndef CTL_DOCTOR_H
#define CTL_DOCTOR_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#include "last_words.h"
#include "pccd.h"

enum doctor_verdict { DOCTOR_OK, DOCTOR_WARN, DOCTOR_FAIL };

#define DOCTOR_MAX        32u
#define DOCTOR_TEXT_BYTES 256u
#define DOCTOR_PATH_BYTES 256

struct doctor_finding {
    enum doctor_verdict verdict;
    const char *what;               /* one word */
    char text[DOCTOR_TEXT_BYTES];   /* how it is */
    char advice[DOCTOR_TEXT_BYTES]; /* what to do next; "": nothing */
};

/* All zero: nothing was looked at. */
struct doctor {
    uint32_t count;
    bool has_failed;
    bool is_unused; /* nobody named a daemon, and none has been where one would be */
    char last_words[COMMON_LAST_WORDS_BYTES]; /* of a daemon that died; "": none */
    struct doctor_finding findings[DOCTOR_MAX];
};

/* Add a finding, unless there are DOCTOR_MAX; `advice` may be "". */
void doctor_find(struct doctor *doctor, enum doctor_verdict verdict, const char *what,
                 const char *advice, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Look at limits of this process, memory to share, the OpenMP environment. */
void doctor_look_at_machine(struct doctor *doctor);
/* Look at the systemd unit, and at the socket that `options` lead to: its folder, its
 * lock, and the last words in its log. */
void doctor_look_at_socket(struct doctor *doctor, const struct pccd_options *options);
/* Look at the daemon; client NULL: pccd_connect has returned `status`. */
void doctor_look_at_daemon(struct doctor *doctor, struct pccd_client *client, int status);

/* Says what there is of the lock beside a socket, which is held while a daemon lives. */
enum doctor_lock {
    DOCTOR_LOCK_NONE, /* or it is not ours to look at */
    DOCTOR_LOCK_FREE, /* left from a daemon that has crashed */
    DOCTOR_LOCK_HELD
};

/* Find the socket where the library would look. Return false if that is no path, as with
 * another kind of url. */
bool doctor_find_path(const struct pccd_options *options, char path[DOCTOR_PATH_BYTES]);
/* Look at the lock's file. *holder: the process whose number is there; 0: none, or it
 * cannot be read. */
enum doctor_lock doctor_look_at_lock(const char *path, pid_t *holder);

#endif
