"""__init__.py - what pccd.py is made of; its users import pccd.

Room:     client/python; installed beside pccd.py.
Does:     nothing. The modules have the names of their like in client/lib:

    wire      constants and records of proto/*.h       values   errors, settings, infos
    ring      shared memory: slots and pages           answer   what a step found
    frame     a step being written                     launch   daemons that are started
    link      requests and their answers               reach    the way to a daemon
    recover   another connection when one is lost      keep     what a new one is told
    upload    the ring, and meshes through it          restore  how it is told
    observe   what a daemon tells of itself
"""
