#!/bin/sh
# meshio-vtu-pieces.sh - meshio: of a VTU file in several pieces, the cells of the last one stay.
#
# Seen with meshio 5.0.0 (Debian 12). A VTU file may hold its grid in any number of <Piece>
# elements; parallel writers make one a process. meshio.read() joins the points of all pieces, and
# keeps the cells of the last piece alone: the other surfaces become points that nothing names,
# without an error or a warning. Compare the number of cells with the NumberOfCells of the pieces.

. "$(dirname "$0")/unpack.sh"
unpack python3-meshio=7.0.0-3 python3-numpy=1:1.24.2-1+deb12u1 python3-rich=13.3.1-1 \
    libblas3=3.11.0-2 liblapack3=3.11.0-2 libgfortran5=12.2.0-14+deb12u1
for z in 0 1; do
    cat <<PIECE
<Piece NumberOfPoints="3" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 $z 1 0 $z 0 1 $z</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">5</DataArray></Cells></Piece>
PIECE
done >"$folder/pieces"
{
    echo '<?xml version="1.0"?>'
    echo '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
    cat "$folder/pieces"
    echo '</UnstructuredGrid></VTKFile>'
} >"$folder/two.vtu"
lib=$folder/root/usr/lib/x86_64-linux-gnu
seen=$(LD_LIBRARY_PATH=$lib:$lib/blas:$lib/lapack PYTHONPATH=$folder/root/usr/lib/python3/dist-packages \
    /usr/bin/python3 -c '
import meshio, sys
mesh = meshio.read(sys.argv[1])
print(len(mesh.points), "points,", [cells.data.tolist() for cells in mesh.cells])' "$folder/two.vtu")
expect "$seen" '6 points, [[[3, 4, 5]]]'
