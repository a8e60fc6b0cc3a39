/* lingering.c - a socket that does not close. */
#include "lingering.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "cases.h"

int test_lingering_new(int seconds, int *peer)
{
    static const char bytes[65536];
    const struct linger linger = {.l_onoff = 1, .l_linger = seconds};
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t length = sizeof address;
    int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

    assert_int_equal(bind(listener, (struct sockaddr *)&address, length), 0);
    assert_int_equal(listen(listener, 1), 0);
    assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &length), 0);
    assert_int_equal(connect(fd, (struct sockaddr *)&address, length), 0);
    *peer = accept(listener, NULL, NULL);
    assert_true(*peer >= 0);
    while (send(fd, bytes, sizeof bytes, MSG_DONTWAIT) > 0) {
    }
    assert_int_equal(setsockopt(fd, SOL_SOCKET, SO_LINGER, &linger, sizeof linger), 0);
    (void)close(listener);
    return fd;
}
