# client/lib/local.mk - libpccd, the client library.

include_HEADERS += client/lib/pccd.h
pkgconfig_DATA += client/lib/pccd.pc
