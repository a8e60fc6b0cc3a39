# bench/model/local.mk - the scaling model: predictions for more processors than are here.
#
# make bench-model                              all scenes; CSV and figures in
#                                               bench/model/results of the build
# make bench-model MODEL_ARGS=cloth-ball        one scene
# make bench-model MODEL_ARGS=--validate-threads=16   compare with 16 threads

check_PROGRAMS += bench/model/model

bench_model_model_SOURCES = \
    bench/model/measure.c \
    bench/model/model.c \
    bench/model/record.c \
    bench/model/schedule.c

test_scripts += bench/model/smoke.sh

.PHONY: bench-model
bench-model: bench/model/model
	@$(MKDIR_P) bench/model/results
	@$(AM_TESTS_ENVIRONMENT) \
	bench/model/model --into=bench/model/results $(MODEL_ARGS)
	@for figure in speedup components shares; do for kind in svg png; do \
	    gnuplot -e "folder='bench/model/results'; kind='$$kind'" \
	        -e "scripts='$(srcdir)/bench/paper'" \
	        $(srcdir)/bench/paper/$$figure.gp || exit 1; \
	done; done

clean-local: clean-bench-model
clean-bench-model:
	rm -rf bench/model/results
.PHONY: clean-bench-model

# One scene over ranks, where configure was told of an MPI.
#
# make bench-ranks                            all; minutes. Tables, and CSV in
#                                             bench/model/results/ranks of the build
# make bench-ranks RANKS_ARGS='time model'    times anew, on an idle machine; ranks.sh has more
# make bench-ranks RANKS_ARGS=replay          recordings dealt to ranks
if HAVE_MPI
check_PROGRAMS += bench/model/ranks
# By the shared library, as libpccd-mpi is.
bench_model_ranks_LDADD = libbench.la libtests.la libtext.la libpccd-mpi.la libpccd.la $(MPI_LIBS) $(GMP_LIBS) \
    $(LIBM)
endif
.PHONY: bench-ranks
bench-ranks: bench/model/model bench/model/ranks tests/mpi/large libpccd-direct.la pccdctl pccd-mpi
	@$(AM_TESTS_ENVIRONMENT) PCCD_DIRECT=$(abs_builddir)/.libs/libpccd-direct.so.0 \
	    $(BASH) $(top_srcdir)/bench/model/ranks.sh bench/model/results/ranks $(RANKS_ARGS)
