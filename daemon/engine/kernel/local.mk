# daemon/engine/kernel/local.mk - the inner loops, once for every instruction set.
#
# A library of its own for each: the same files with other flags. Only choose.c, which asks
# the processor, is compiled for the least one.

kernel_sources = \
    daemon/engine/kernel/advance.c \
    daemon/engine/kernel/bounds.c \
    daemon/engine/kernel/make_boxes.c \
    daemon/engine/kernel/bracket.c \
    daemon/engine/kernel/come_before.c \
    daemon/engine/kernel/join_blocks.c \
    daemon/engine/kernel/gaps.c \
    daemon/engine/kernel/marks.c \
    daemon/engine/kernel/measure.c \
    daemon/engine/kernel/make_quantised.c \
    daemon/engine/kernel/reject.c \
    daemon/engine/kernel/reject_axes.c \
    daemon/engine/kernel/sift.c \
    daemon/engine/kernel/sift_near.c \
    daemon/engine/kernel/table.c \
    daemon/engine/kernel/within.c \
    daemon/engine/turning/passage.c \
    daemon/engine/turning/straight.c \
    daemon/engine/turning/sweep.c
kernel_cppflags = $(PCCD_CPPFLAGS) $(ENGINE_CPPFLAGS)
# The loops are short and everything in them is inlined: what -O3 adds is unrolling.
kernel_cflags = $(AM_CFLAGS) -fno-trapping-math -fno-math-errno $(PCCD_KERNEL_CFLAGS)

noinst_LTLIBRARIES += libkernel_scalar.la
kernel_libraries = libkernel_scalar.la

libkernel_scalar_la_SOURCES = $(kernel_sources) daemon/engine/kernel/decide.c
libkernel_scalar_la_CPPFLAGS = $(kernel_cppflags) \
    -DENG_ISA=scalar -DENG_ISA_NUMBER=ENG_ISA_SCALAR -DENG_VECTOR_BYTES=8
libkernel_scalar_la_CFLAGS = $(kernel_cflags)

if X86_64
noinst_LTLIBRARIES += libkernel_sse2.la libkernel_sse4.la libkernel_avx2.la libkernel_avx512.la
kernel_libraries += libkernel_sse2.la libkernel_sse4.la libkernel_avx2.la libkernel_avx512.la

libkernel_sse2_la_SOURCES = $(kernel_sources)
libkernel_sse2_la_CPPFLAGS = $(kernel_cppflags) \
    -DENG_ISA=sse2 -DENG_ISA_NUMBER=ENG_ISA_SSE2 -DENG_VECTOR_BYTES=16
libkernel_sse2_la_CFLAGS = $(kernel_cflags)

libkernel_sse4_la_SOURCES = $(kernel_sources)
libkernel_sse4_la_CPPFLAGS = $(kernel_cppflags) \
    -DENG_ISA=sse4 -DENG_ISA_NUMBER=ENG_ISA_SSE4 -DENG_VECTOR_BYTES=16
libkernel_sse4_la_CFLAGS = $(kernel_cflags) -msse4.2

libkernel_avx2_la_SOURCES = $(kernel_sources)
libkernel_avx2_la_CPPFLAGS = $(kernel_cppflags) \
    -DENG_ISA=avx2 -DENG_ISA_NUMBER=ENG_ISA_AVX2 -DENG_VECTOR_BYTES=32
libkernel_avx2_la_CFLAGS = $(kernel_cflags) -mavx2 -mbmi -mbmi2

libkernel_avx512_la_SOURCES = $(kernel_sources)
libkernel_avx512_la_CPPFLAGS = $(kernel_cppflags) \
    -DENG_ISA=avx512 -DENG_ISA_NUMBER=ENG_ISA_AVX512 -DENG_VECTOR_BYTES=64
libkernel_avx512_la_CFLAGS = $(kernel_cflags) -mavx512f -mavx512vl -mavx512dq -mavx512bw \
    -mbmi -mbmi2 -mprefer-vector-width=512
endif

if AARCH64
noinst_LTLIBRARIES += libkernel_neon.la
kernel_libraries += libkernel_neon.la

libkernel_neon_la_SOURCES = $(kernel_sources)
libkernel_neon_la_CPPFLAGS = $(kernel_cppflags) \
    -DENG_ISA=neon -DENG_ISA_NUMBER=ENG_ISA_NEON -DENG_VECTOR_BYTES=16
libkernel_neon_la_CFLAGS = $(kernel_cflags)
endif

# What the demo takes: of x86-64 the least set and the one that choose.c takes here; in the place
# of each other one, where it is not there yet, absent.c. make builds what is missing.
demo_kernels =
demo-programs:
	$(AM_V_at)has() { for flag; do grep -qw "$$flag" /proc/cpuinfo || return 1; done; } && \
	best=scalar && \
	for set in $(demo_kernels); do \
	    case $$set in \
	    sse2) ;; \
    sse4) has sse4_2 ;; \
	    avx2) has avx2 bmi2 ;; \
	    avx512) has avx512f avx512vl avx512dq avx512bw bmi2 ;; \
	    esac && best=$$set || :; \
	done && \
	all='$(kernel_libraries)' && some= && \
	for library in $$all; do \
	    case $$library in *_scalar.la | *_$$best.la) ;; \
	    *) test '$(demo_kernels)' = '' || test -e $$library || \
	        library=libkernel_no_$${library#libkernel_} ;; \
	    esac; \
	    some="$$some $$library"; \
	done && \
	$(MAKE) $(AM_MAKEFLAGS) pccdd$(EXEEXT) pccdctl$(EXEEXT) kernel_libraries="$$some"
.PHONY: demo-programs

kernel_absent = daemon/engine/kernel/absent.c daemon/engine/turning/sweep_absent.c
if X86_64
demo_kernels += sse2 sse4 avx2 avx512
EXTRA_LTLIBRARIES += libkernel_no_sse2.la libkernel_no_sse4.la libkernel_no_avx2.la \
    libkernel_no_avx512.la
libkernel_no_sse2_la_SOURCES = $(kernel_absent)
libkernel_no_sse2_la_CPPFLAGS = $(kernel_cppflags) -DENG_ISA=sse2
libkernel_no_sse4_la_SOURCES = $(kernel_absent)
libkernel_no_sse4_la_CPPFLAGS = $(kernel_cppflags) -DENG_ISA=sse4
libkernel_no_avx2_la_SOURCES = $(kernel_absent)
libkernel_no_avx2_la_CPPFLAGS = $(kernel_cppflags) -DENG_ISA=avx2
libkernel_no_avx512_la_SOURCES = $(kernel_absent)
libkernel_no_avx512_la_CPPFLAGS = $(kernel_cppflags) -DENG_ISA=avx512
endif
