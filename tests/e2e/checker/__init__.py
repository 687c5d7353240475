"""Reopens a job folder and verifies what its job.json promises (docs/JOB_FOLDER).

Nothing here is shared with PackMerger itself: it reads the files with its own readers and measures with
its own geometry (numpy and scipy), so that one mistake cannot hide the other.

    report      what was checked, and the figures
    job         the folder in memory
    contract    keys and types of job.json; which files there are
    meshes      STL, OBJ, PLY, OFF
    triangles   exact distances between points and triangles
    tree        a box tree over triangles: near pairs, closest points
    columns     vertical lines through meshes
    solids      each part: closed, manifold, outward, one piece, volume, inside the build volume
    separation  the gap between parts
    removal     every part can be taken out, in the order given
    assembly    the parts put back together are the model
    figures     box, height, support, cost
    documents   tray files, 3MF, profile, programs
    pictures    PNG and GLB
    estimates   the four estimates
"""
