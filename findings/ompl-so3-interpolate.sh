#!/bin/sh
# ompl-so3-interpolate.sh - OMPL: SO3StateSpace::interpolate(from, to, 1) is not `to`.
#
# Seen with OMPL 1.5.2 (Debian 12). When two rotations are nearer than about 4.5e-5 in the metric
# of SO3StateSpace (an angle of 8.9e-5 rad between the bodies), interpolate() copies `from` for
# every t, t = 1 included. SE3StateSpace is made of SO3StateSpace and does the same to the rotation
# of a pose, though not to its position. A program that walks along a motion by interpolate(), and
# takes its last state for the goal, never looks at the goal's rotation. Use the state that was
# given as the last one.

. "$(dirname "$0")/unpack.sh"
unpack libompl-dev=1.5.2+ds1-1 libompl16=1.5.2+ds1-1 libboost1.74-dev=1.74.0+ds1-21 \
    libeigen3-dev=3.4.0-4 libboost-serialization1.74.0=1.74.0+ds1-21 \
    libboost-filesystem1.74.0=1.74.0+ds1-21
cat >"$folder/walk.cpp" <<'PROGRAM'
#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/SO3StateSpace.h>

#include <cstdio>
#include <memory>

namespace ob = ompl::base;

int main()
{
    auto space = std::make_shared<ob::SO3StateSpace>();
    ob::ScopedState<ob::SO3StateSpace> from(space), to(space), last(space);
    from->setIdentity();
    for (double turn : {8e-5, 9e-5}) {
        to->setAxisAngle(0, 0, 1, turn);
        space->interpolate(from.get(), to.get(), 1, last.get());
        std::printf("turn by %g rad: interpolate(from, to, 1) is %s\n", turn,
                    last->z == from->z ? "from" : "not from");
    }
}
PROGRAM
root=$folder/root
g++ -std=c++17 -o "$folder/walk" "$folder/walk.cpp" -I"$root/usr/include/ompl-1.5" \
    -I"$root/usr/include/eigen3" -I"$root/usr/include" -L"$root/usr/lib/x86_64-linux-gnu" \
    -Wl,-rpath-link,"$root/usr/lib/x86_64-linux-gnu" -lompl || exit 2
seen=$(LD_LIBRARY_PATH=$root/usr/lib/x86_64-linux-gnu "$folder/walk")
expect "$seen" 'turn by 8e-05 rad: interpolate(from, to, 1) is from
turn by 9e-05 rad: interpolate(from, to, 1) is not from'
