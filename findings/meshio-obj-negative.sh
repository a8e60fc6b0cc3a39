#!/bin/sh
# meshio-obj-negative.sh - meshio: negative vertex numbers of OBJ name the vertex before the right one.
#
# Seen with meshio 5.0.0 (Debian 12). In OBJ, -1 is the vertex that was read last. meshio takes one
# away from each number, as it does from those that count from 1 on, so "f -3 -2 -1" comes out as
# [-4, -3, -2]: by Python's own rule for negative indices each corner is the vertex before the one
# that is meant, and the first one is beyond the array where the face names the first vertex.

. "$(dirname "$0")/unpack.sh"
unpack python3-meshio=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-rich=13.3.1-1 \
    libblas3=3.11.0-2 liblapack3=3.11.0-2 libgfortran5=12.2.0-14+deb12u1
printf 'v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n' >"$folder/last.obj"
lib=$folder/root/usr/lib/x86_64-linux-gnu
seen=$(LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack PYTHONPATH=$folder/root/usr/lib/python3/dist-packages \
    /usr/bin/python3 -c '
import meshio, sys
mesh = meshio.read(sys.argv[1])
face = mesh.cells[0].data[0]
print("numbers", face.tolist(), "corners", mesh.points[face].tolist())' "$folder/last.obj")
expect "$seen" 'numbers [-4, -3, -2] corners [[9.0, 9.0, 9.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]'
