#!/bin/sh
# libuv-io-uring.sh - libuv: UV_USE_IO_URING=0 does not keep a loop from making an io_uring.
#
# Seen with libuv 1.50.0 (Debian 13); 1.44.2 (Debian 12) makes none. The manual says that
# UV_USE_IO_URING switches the use of io_uring on and off. That is so for file operations, whose
# ring the first of them makes. uv_loop_init() makes another one, for batches of epoll_ctl,
# whatever the variable says, and the loop calls io_uring_enter from then on. A program that
# enters a seccomp filter after it has made its loop must allow that call, or refuse
# io_uring_setup before the loop is made: libuv then falls back to epoll_ctl.
#
# As root: a Debian 13 with libuv is made in the temporary folder.

. "$(dirname "$0")/unpack.sh"
[ "$(id -u)" -eq 0 ] && command -v mmdebstrap >/dev/null || { echo "needs root and mmdebstrap"; exit 2; }
mirror=$(apt-get indextargets --format '$(REPO_URI)' | grep -v security | head -n 1)
root=$folder/root
mmdebstrap --quiet --mode=root --variant=apt --include=gcc,libc6-dev,libuv1-dev=1.50.0-2,strace \
    trixie "$root" "$mirror" 2>"$folder/log" || { cat "$folder/log"; exit 2; }
echo "package: libuv1-dev=1.50.0-2"
cat >"$root/root/loop.c" <<'PROGRAM'
#include <uv.h>

int main(void)
{
    uv_loop_t loop;
    return uv_loop_init(&loop) != 0 || uv_loop_close(&loop) != 0;
}
PROGRAM
chroot "$root" gcc -o /root/loop /root/loop.c -luv || exit 2
for value in 0 1; do
    rm -f "$root/root/trace"
    UV_USE_IO_URING=$value chroot "$root" strace -f -e trace=io_uring_setup -o /root/trace /root/loop
    echo "UV_USE_IO_URING=$value: $(grep -c '^[0-9]* *io_uring_setup(' "$root/root/trace") calls of io_uring_setup"
done >"$folder/seen"
expect "$(cat "$folder/seen")" 'UV_USE_IO_URING=0: 1 calls of io_uring_setup
UV_USE_IO_URING=1: 1 calls of io_uring_setup'
