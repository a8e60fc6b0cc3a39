# tests/style/local.mk - the rules of CONTRIBUTING.md that a script can check.

test_scripts += \
    tests/style/test_style_files.sh \
    tests/style/test_style_rooms.sh \
    tests/style/test_style_size.sh \
    tests/style/test_style_words.sh

# `make size`: what there is to learn, beside the baseline; `make size-baseline` writes that.
.PHONY: size size-baseline
size:
	top_srcdir=$(top_srcdir) $(top_srcdir)/tests/style/size.sh $(abs_top_srcdir)/tests/style/size.txt
size-baseline:
	top_srcdir=$(top_srcdir) $(top_srcdir)/tests/style/size.sh --write $(abs_top_srcdir)/tests/style/size.txt
