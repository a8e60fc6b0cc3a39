EXTRA_DIST += findings/assimp-quantization.sh findings/cmocka-tap-skip.sh findings/libuv-io-uring.sh \
    findings/meshio-obj-negative.sh findings/meshio-vtu-pieces.sh \
    findings/ompl-so3-interpolate.sh findings/openmp-rounding-mode.sh findings/unpack.sh
