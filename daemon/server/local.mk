# daemon/server/local.mk - the daemon: loop, sessions, compute thread.
