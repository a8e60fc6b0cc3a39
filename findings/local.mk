EXTRA_DIST += findings/cmocka-tap-skip.sh findings/libuv-io-uring.sh \
    findings/ompl-so3-interpolate.sh findings/openmp-rounding-mode.sh findings/unpack.sh
