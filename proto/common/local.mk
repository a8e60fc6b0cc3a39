# proto/common/local.mk - what every room shares: kinds, records, statuses, limits.
#
# Headers that need the C library alone. PCCD_CPPFLAGS has the folder, so each room finds them.

include_HEADERS += proto/common/pccd_daemon.h proto/common/pccd_trace.h proto/common/pccd_types.h
