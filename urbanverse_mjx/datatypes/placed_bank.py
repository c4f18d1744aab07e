"""`PlacedBank`: some of a folder's scenes at a time, in places whose scenes change."""

import dataclasses

import numpy as np

from . import validation as v
from .bank_shards import BankShards
from .scene_bank import SCHEMA, SceneBank


@dataclasses.dataclass(frozen=True)
class PlacedBank(SceneBank):
    """A bank of N places with the first scenes that they have, without looks; shapes hold for all scenes of the folder.

    Scenes come in one order, again and again: scene k of it is in place k mod N. The first N are there at the
    beginning, and exchange j (from 1 on) puts scene N + j - 1 in the place of the oldest.

    Attributes:
      shards: the folder.
      order: (K,) rows of the folder, K > N.
    """

    shards: BankShards | None = None
    order: np.ndarray | None = None

    @staticmethod
    def open(shards: BankShards, rows: np.ndarray, places: int, seed: int) -> "PlacedBank":
        """Opens places on some scenes of a folder, in an order drawn from a seed.

        Args:
          rows: of the scenes that come and go.
          places: number of them, fewer than the scenes.

        Raises:
          ValidationError: there are not more scenes than places, or a file is missing or damaged.
        """
        v.integer(places, "config.schedule.places", 1)
        if places >= len(rows):
            raise v.fail(
                "config.schedule.places",
                f"{places} for {len(rows)} scenes of {shards.path}",
                "fewer places than scenes",
                "set it to 0, which keeps all of them on the device",
            )
        order = np.random.default_rng(seed).permutation(rows)
        arrays, meta = shards.take(order[:places], looks=False)
        return PlacedBank(meta={**meta, "schema": SCHEMA}, **arrays, shards=shards, order=order)

    @property
    def folder(self) -> BankShards:
        """The folder that the scenes come from."""
        assert self.shards is not None
        return self.shards

    @property
    def rows(self) -> np.ndarray:
        """(K,) rows of the folder, in the order in which their scenes come."""
        assert self.order is not None
        return self.order

    @property
    def all_ids(self) -> tuple[str, ...]:
        """The ids of all scenes that come and go, in the folder's order."""
        return tuple(self.folder.scene_ids[row] for row in np.sort(self.rows))

    def coming(self, number: int) -> tuple[int, int]:
        """Place and row of the folder of scene `number` of the order."""
        return number % self.num_scenes, int(self.rows[number % len(self.rows)])

    def present(self, exchanges: int) -> list[int]:
        """Of each place the row of the folder of the scene that it has after some exchanges."""
        found = dict(self.coming(exchanges + k) for k in range(self.num_scenes))
        return [found[place] for place in range(self.num_scenes)]
