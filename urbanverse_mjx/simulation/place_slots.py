"""Slots that an engine needs for all scenes of a folder, of which some are in places at a time.

In:   `PlacedBank`, a reach. Out: numbers of object and prism slots. When: at construction of an engine; counted once
for a folder (6 ms a scene) and kept in the cache.
"""

import hashlib

import numpy as np

from .. import settings, versions
from ..datatypes import PlacedBank, SceneBank, array_file
from ..datatypes.bank_shards import INDEX
from ..datatypes.reach_count import most_objects_in_reach, most_prisms_in_reach

#: Scenes that are read together.
_TOGETHER = 16


def most_in_reach(bank: PlacedBank, reach: float, objects: int, prisms: int) -> tuple[int, int]:
    """The most object hulls (0 if `objects` is) and ground prisms within reach (m) of a point on traversable ground of
    any scene that comes, at least `objects` and `prisms`."""
    folder, rows = bank.folder, np.sort(bank.rows)
    digest = hashlib.sha256((folder.path / INDEX).read_bytes())
    digest.update(repr((versions.of("datatypes"), reach, objects, prisms, rows.tolist())).encode())
    path = settings.cache_dir("place_slots", f"{digest.hexdigest()[:24]}.npz")
    found = array_file.load_cached(path, "numbers of slots", ("slots",))
    if found is None:
        most = [objects, prisms]
        for some in np.split(rows, range(_TOGETHER, len(rows), _TOGETHER)):
            scenes = SceneBank.take(folder, some, looks=False)
            for scene in range(scenes.num_scenes):
                if objects:
                    most[0] = most_objects_in_reach(scenes, scene, reach, most[0])
                most[1] = most_prisms_in_reach(scenes, scene, reach, most[1])
        found = {"slots": np.array(most, np.int64)}
        array_file.save_cached(path, found)
    number, ground = found["slots"].tolist()
    return number, ground
