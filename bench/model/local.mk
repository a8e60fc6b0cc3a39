# bench/model/local.mk - the scaling model: predictions for more processors than are here.
#
# make bench-model                         CSV and figures in bench/model/results

check_PROGRAMS += bench/model/model

bench_model_model_SOURCES = \
    bench/model/loop.c \
    bench/model/machine.c \
    bench/model/machine.h \
    bench/model/measure.c \
    bench/model/measure.h \
    bench/model/model.c \
    bench/model/record.c \
    bench/model/record.h \
    bench/model/record_merge.c \
    bench/model/record_refit.c \
    bench/model/sim.c \
    bench/model/sim.h \
    bench/model/sim_paper.c \
    bench/model/sim_refit.c \
    bench/model/sim_steal.c \
    bench/model/task.c \
    bench/model/task.h \
    bench/model/walker.c \
    bench/model/walker.h \
    $(bench_engine_sources)
bench_model_model_CPPFLAGS = $(bench_engine_cppflags) -I$(top_srcdir)/bench/model
bench_model_model_LDADD = $(bench_engine_libs)
bench_model_model_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
