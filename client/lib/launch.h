/* launch.h - starts a daemon: the user's, or a private one. */
#ifndef CLI_LAUNCH_H
#define CLI_LAUNCH_H

#include "client.h"

/* Start the user's daemon on the socket `path`: in a session of its own, nobody's child,
 * ending by itself after half a minute without clients. `program` NULL: the default.
 * Returns 0 when it listens, PCCD_E_BUSY when another daemon holds the path, which will
 * listen or end, PCCD_E_AGAIN when it ended at once for another reason (or for that, of a
 * release that does not tell), PCCD_E_NODAEMON (no such program), PCCD_E_TIMEOUT or
 * PCCD_E_SYSTEM. */
int cli_launch_user(struct pccd_client *client, const char *program, const char *path,
                    uint64_t deadline_ns);

/* Start a daemon of our own in a folder of its own, and say its socket's path in
 * path[CLI_SOCKET_BYTES], which has that of the daemon before, or "". client->child is
 * set as soon as there is something to stop. */
int cli_launch_private(struct pccd_client *client, const char *program, char *path,
                       uint64_t deadline_ns);

#define CLI_WORDS_BYTES 384u

/* Write what is known of the end of a daemon that was started at that socket: how, if it
 * is a private one of ours, and the last line that it wrote; "" nothing. */
void cli_launch_words(const struct pccd_client *client, const char *socket_path,
                      char words[CLI_WORDS_BYTES]);

/* Tell a private daemon to end, and go on meanwhile; does nothing without one. */
void cli_launch_ask_to_end(struct cli_child *child);

/* Stop a private daemon and remove its folder; does nothing without one. */
void cli_launch_stop(struct cli_child *child);

/* Folders in which what the library needs may lie. */
#define CLI_FOLDER_BYTES 4096
/* Get the folder that the library, or the running program, lies in, without a slash at
 * the end; "": not known, or too long. */
void cli_folder_of_library(char folder[CLI_FOLDER_BYTES]);
void cli_folder_of_program(char folder[CLI_FOLDER_BYTES]);

#endif
