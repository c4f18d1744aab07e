"""The bank of the preset `quick`: the shipped streets and some procedural ones, which are built in minutes."""

from collections.abc import Sequence

from .. import settings
from ..datatypes import SceneBank
from ..datatypes.bank_join import join
from ..scene import library
from ..work_folder import work_folder
from . import banks
from .library.building import graph_of

#: Procedural training scenes of the preset `quick` in addition to the shipped streets, whose number is limited by the
#: time to build them; the preset is evaluated on eight held-out streets.
QUICK_TRAIN = tuple(f"procedural_{k:03d}" for k in range(8))
QUICK_TEST = tuple(f"procedural_{k:03d}" for k in range(144, 150))


def ensure_quick_bank(quiet: bool = False) -> SceneBank:
    """Loads the bank of the preset `quick`; builds it into the cache if it is missing or outdated.

    Raises:
      ValidationError: `URBANVERSE_BANK` names a file that is not a bank.
    """
    if settings.chosen_bank_path() is not None:
        return banks.ensure_default_bank(quiet)
    wanted = QUICK_TRAIN + QUICK_TEST
    known = library.shipped_hashes("procedural")
    path = settings.quick_bank_path({name: known[name]["graph"] for name in wanted})
    return banks.cached_bank(path, lambda: _build_quick_bank(wanted, quiet))


def _build_quick_bank(wanted: Sequence[str], quiet: bool) -> SceneBank:
    scenes = library.scene_set("procedural")
    with work_folder("urbanverse-graphs-") as work:
        graphs = [work / f"{name}.json" for name in wanted]
        for name, path in zip(wanted, graphs, strict=True):
            graph_of(scenes, name).save(path)
        more = banks.build_bank(graphs, ["train" if name in QUICK_TRAIN else "test" for name in wanted], quiet=quiet)
    return join([banks.ensure_default_bank(quiet), more])
