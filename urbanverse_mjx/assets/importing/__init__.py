"""From anyone's GLB, glTF and OBJ files to records of the user's own index.

Each file in a process of its own (`containment`): `screening` refuses what would hurt, `reading` loads it, `bake` gives
it one texture, `annotation` (or `vision`) says what it is, `corruption` finds what is wrong with it, `placing` puts it
upright, in metres, on the ground and facing +x, `work` writes the asset. `run` goes through a folder and keeps the
journal.
"""
