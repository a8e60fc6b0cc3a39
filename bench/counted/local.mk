# bench/counted/local.mk - regressions, noticed by counted work.
#
# make bench-quick       every scene against the baseline, and instructions; a minute
# make bench-baseline    write the baseline anew: commit it with what has changed it

test_scripts += bench/counted/counted.sh

.PHONY: bench-quick bench-baseline
bench-quick: bench/pccd-bench$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/bench/counted/counted.sh quick
bench-baseline: bench/pccd-bench$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/bench/counted/counted.sh baseline
