# proto/common/local.mk - what every room shares: kinds, records, statuses, limits.
#
# Headers that need the C library alone. AM_CPPFLAGS has the folder, so each room finds them.

include_HEADERS += proto/common/pccd_daemon.h proto/common/pccd_trace.h proto/common/pccd_types.h
noinst_HEADERS += proto/common/clock.h proto/common/coordinates.h \
    proto/common/kinds.h proto/common/last_words.h proto/common/names.h proto/common/openmp.h \
    proto/common/object_attributes.h proto/common/proto_limits.h \
    proto/common/process_status.h proto/common/rounding.h proto/common/numbers.h
