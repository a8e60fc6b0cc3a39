# bench/growth/local.mk - time and memory against triangles, contacts and clients.
#
# make bench-growth                     CSV, exponents and figures in bench/growth/results
#                                       of the build; minutes, and 8 GiB of memory
# make bench-growth GROWTH_INTO=FOLDER  somewhere else

check_PROGRAMS += bench/growth/growth

test_scripts += bench/growth/smoke.sh

GROWTH_INTO = bench/growth/results
.PHONY: bench-growth
bench-growth: bench/growth/growth$(EXEEXT) pccdd$(EXEEXT) pccd-load$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/bench/growth/growth.sh $(GROWTH_INTO)

clean-local: clean-bench-growth
clean-bench-growth:
	rm -rf bench/growth/results
.PHONY: clean-bench-growth
