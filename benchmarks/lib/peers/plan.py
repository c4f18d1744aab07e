"""Cases of the comparison with other engines: what is measured, and in which order."""

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from benchmarks.lib.cases import image_size
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v


class Engine(NamedTuple):
    """A row's engine.

    Attributes:
      title: in the table.
      colour: in the figure.
      uses_jax: on the GPU.
      several: it can have another street in each env.
      images: it has a renderer.
    """

    title: str
    colour: str
    uses_jax: bool
    several: bool
    images: bool


#: Name of a peer -> its engine; the order is that of the table.
PEERS = {
    "warp-fused": Engine("ours, `warp-fused`", "#b5301c", True, True, True),
    "warp": Engine("ours, `warp`", "#e0832c", True, True, True),
    "mujoco-warp": Engine("MuJoCo Warp", "#2860be", False, True, True),
    "mjlab": Engine("mjlab's way", "#38a0c8", False, False, True),
    "mjx": Engine("stock MJX", "#4a8a3c", True, False, False),
    "mjx-cut": Engine("stock MJX, street cut", "#8fbf5a", True, False, False),
    "c-mujoco": Engine("C MuJoCo", "#6b5b95", False, True, True),
}
#: Our environments -> their engine.
OURS = {"warp-fused": "warp-fused", "warp": "warp"}
#: Fields that name a case.
KEY = ("peer", "num_envs", "streets", "pixels")


@dataclasses.dataclass(frozen=True)
class Case:
    """One row of the table.

    Attributes:
      peer: of `PEERS`.
      num_envs: envs at once.
      streets: different streets at once; env i is in street i modulo their number.
      pixels: "HxW", or "none".
    """

    peer: str
    num_envs: int
    streets: int
    pixels: str

    @property
    def size(self) -> tuple[int, int] | None:
        """Height and width of the images; None without.

        Raises:
          ValidationError: it is neither.
        """
        return image_size(self.pixels, "--pixels")

    @property
    def key(self) -> tuple[str, int, int, str]:
        return self.peer, self.num_envs, self.streets, self.pixels

    @property
    def title(self) -> str:
        return f"{self.peer}, {self.num_envs} envs, {self.streets} streets, images {self.pixels}"

    def known(self) -> None:
        """Raises ValidationError if a value is not valid."""
        if self.peer not in PEERS:
            raise ValidationError(f"--peers: found {self.peer!r}, needed some of {', '.join(PEERS)}.")
        v.integer(self.num_envs, "--num-envs", 1)
        v.integer(self.streets, "--streets", 1)
        _ = self.size

    def check(self) -> None:
        """Raises ValidationError if its engine cannot do this; the message is what the table says."""
        self.known()
        engine = PEERS[self.peer]
        if self.streets > 1 and not engine.several:
            raise ValidationError(f"{engine.title}: one model and so one street for all envs")
        if self.size is not None and not engine.images:
            raise ValidationError(f"{engine.title}: has no renderer")
        if self.peer == "mujoco-warp" and self.streets > 1 and self.size is not None:
            raise ValidationError(f"{engine.title}: images of several streets are not built here")

    def to_json(self) -> dict[str, Any]:
        return dataclasses.asdict(self)


def key_of(row: Mapping[str, Any]) -> tuple[str, int, int, str]:
    """Returns the key of a row's case."""
    return str(row["peer"]), int(row["num_envs"]), int(row["streets"]), str(row["pixels"])


def same_process(cases: Iterable[Case]) -> list[list[Case]]:
    """Returns groups of cases that differ in the number of envs alone, the fewest first, in the order of their first
    case."""
    groups: dict[Any, list[Case]] = {}
    for case in cases:
        groups.setdefault((case.peer, case.streets, case.pixels), []).append(case)
    return [sorted(group, key=lambda case: case.num_envs) for group in groups.values()]


def _plan() -> list[Case]:
    large, small, none = "135x240", "36x64", "none"
    rows: list[tuple[str, str, int, tuple[int, ...]]] = [
        ("warp-fused", large, 1, (64, 1024)),
        ("mujoco-warp", large, 1, (64, 1024)),
        ("c-mujoco", large, 1, (64, 1024)),
        ("mjlab", large, 1, (64, 1024)),
        ("warp-fused", none, 1, (64, 1024, 4096)),
        ("mujoco-warp", none, 1, (64, 1024, 4096)),
        ("c-mujoco", none, 1, (64, 1024, 4096)),
        ("warp-fused", none, 12, (1024,)),
        ("mujoco-warp", none, 12, (1024,)),
        ("warp-fused", large, 12, (1024,)),
        ("c-mujoco", none, 12, (1024,)),
        ("mjlab", none, 1, (1024, 4096)),
        ("warp-fused", small, 1, (4096,)),
        ("mujoco-warp", small, 1, (4096,)),
        ("c-mujoco", small, 1, (4096,)),
        ("warp", large, 1, (1024,)),
        ("mjx-cut", none, 1, (1024,)),
    ]
    return [Case(peer, count, streets, pixels) for peer, pixels, streets, counts in rows for count in counts]


#: What is measured, the most telling first; the last one takes the longest to compile.
PLAN = tuple(_plan())
