"""Imports GLB, glTF, OBJ, STL and PLY files as records of the user's own index.

Each file is processed in a process of its own (`containment`): `screening` rejects dangerous files, `reading` loads the
file, `bake` combines its textures, `annotation` (or `vision`) determines category and attributes, `corruption` finds
faults, `placing` transforms the mesh to the asset frame (upright, metres, on the ground, facing +x), and `work` writes
the asset. `run` processes a folder and keeps the journal.
"""
