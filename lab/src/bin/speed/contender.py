"""Times MeshLib's search for self-collisions on one core, for `lab/src/bin/speed`.

Reads a mesh from a file of 64-bit floats and 32-bit indices; then, for each line on its standard input, refits the tree
over all vertices and searches once, and prints the processor's milliseconds and the number of pairs that share no
vertex.
"""

import os
import sys
import time

# Before the library starts its threads: as many as there are cores to run on.
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import numpy
from meshlib import mrmeshnumpy, mrmeshpy

vertices = numpy.fromfile(sys.argv[1], dtype=numpy.float64).reshape(-1, 3)
faces = numpy.fromfile(sys.argv[2], dtype=numpy.uint32).reshape(-1, 3).astype(numpy.int32)
mesh = mrmeshnumpy.meshFromFacesVerts(faces, vertices)
assert mesh.topology.numValidFaces() == len(faces), "some faces were left out"
everything = mesh.topology.getValidVerts()
part = mrmeshpy.MeshPart(mesh)
mesh.getAABBTree()
print("ready", flush=True)
for _ in sys.stdin:
    begin = time.process_time()
    mesh.updateCaches(everything)
    pairs = mrmeshpy.findSelfCollidingTriangles(part)
    spent = time.process_time() - begin
    found = [(pair.aFace.get(), pair.bFace.get()) for pair in pairs]
    apart = sum(not set(faces[a]) & set(faces[b]) for a, b in found)
    print(f"{1e3 * spent:.4f} {apart}", flush=True)
