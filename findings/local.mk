EXTRA_DIST += findings/libuv-io-uring.sh findings/ompl-so3-interpolate.sh \
    findings/openmp-rounding-mode.sh findings/unpack.sh
