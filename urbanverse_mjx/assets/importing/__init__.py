"""From anyone's GLB, glTF and OBJ files to records of the user's own index.

Each file in a process of its own (`containment`): `screening` refuses dangerous files, `reading` loads it, `bake` gives
it one texture, `annotation` (or `vision`) gives its category and attributes, `corruption` finds faults, `placing` puts
it upright, in metres, on the ground and facing +x, `work` writes the asset. `run` processes a folder and keeps the
journal.
"""
