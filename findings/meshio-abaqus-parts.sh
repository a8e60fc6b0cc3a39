#!/bin/sh
# meshio-abaqus-parts.sh - meshio: of an Abaqus file with two parts, the points of the last one stay.
#
# Seen with meshio 5.0.0 (Debian 12). Each *NODE block takes the place of the points before it, and
# cells that were read before keep their numbers: both parts' triangles name the second part's
# points. *INSTANCE, which puts a part elsewhere, is passed over, and so are *ELGEN and *NGEN; all of
# it without an error or a warning. In the same way it reads the first zone of a Tecplot file alone,
# and points of Nastran in a coordinate system of their own (GRID with a CP) as if they had none.

. "$(dirname "$0")/unpack.sh"
unpack python3-meshio=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-rich=13.3.1-1 \
    libblas3=3.11.0-2 liblapack3=3.11.0-2 libgfortran5=12.2.0-14+deb12u1
for z in 0 7; do
    cat <<PART
*Part, name=Part-$z
*Node
1, 0, 0, $z
2, 1, 0, $z
3, 0, 1, $z
*Element, type=S3
1, 1, 2, 3
*End Part
PART
done >"$folder/two.inp"
lib=$folder/root/usr/lib/x86_64-linux-gnu
seen=$(LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack PYTHONPATH=$folder/root/usr/lib/python3/dist-packages \
    /usr/bin/python3 -c '
import meshio, sys
mesh = meshio.read(sys.argv[1])
print(mesh.points[:, 2].tolist(), [cells.data.tolist() for cells in mesh.cells])' "$folder/two.inp")
expect "$seen" '[7.0, 7.0, 7.0] [[[0, 1, 2]], [[0, 1, 2]]]'
