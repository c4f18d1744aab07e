"""Small images of a page: assets, ground materials and skies, crops of the recording."""

import dataclasses
import pathlib
from collections.abc import Mapping, Sequence

import mujoco
from PIL import Image

from ....assets.appearances import appearance_search
from ....assets.previews import thumbnails
from ....assets.records.index import build_mesh
from ....datatypes import AssetRecord, ValidationError
from ....datatypes.recording import UNREADABLE
from . import data_urls

#: Thumbnails that are drawn for one page, a second or so each; those in the cache are all shown.
MAX_DRAWN = 80
#: Pixels of the longer side.
ASSET_SIDE, CROP_SIDE, APPEARANCE_SIDE = 96, 110, 96
#: What MuJoCo's renderer raises without a working OpenGL.
_NO_OPENGL = (ImportError, OSError, AttributeError, RuntimeError, mujoco.FatalError)
_BACKGROUND = (232, 230, 224)


@dataclasses.dataclass(frozen=True)
class Thumbnails:
    """uid -> data address; and a sentence for what is missing, "" if nothing is."""

    of: Mapping[str, str]
    missing: str = ""


def of_assets(records: Sequence[AssetRecord]) -> Thumbnails:
    """Images of assets: all that the cache holds, and the first `MAX_DRAWN` others, which are drawn."""
    found: dict[str, str] = {}
    drawn, left, reason = 0, 0, ""
    for record in records:
        mesh = build_mesh(record)
        path = thumbnails.path_of(record, mesh)
        if not path.is_file():
            if reason or drawn >= MAX_DRAWN:
                left += 1
                continue
            try:
                thumbnails.draw(mesh, path)
            except _NO_OPENGL as error:
                left, reason = left + 1, f"MuJoCo found no OpenGL that renders off screen ({_first_line(error)})"
                continue
            drawn += 1
        found[record.uid] = data_urls.jpeg(thumbnails.thumbnail(record), ASSET_SIDE)
    if not left:
        return Thumbnails(found)
    if not reason:
        reason = f"one report draws {MAX_DRAWN}; <code>make thumbnails</code> or the next report draws more"
    return Thumbnails(found, f"{left} of {len(records)} assets have no thumbnail: {reason}.")


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:100]


def of_appearances(uids: Sequence[str]) -> Thumbnails:
    """Images of skies and of grounds of the large collection; the few plain grounds have none."""
    found: dict[str, str] = {}
    for uid in dict.fromkeys(uids):
        for collection in (appearance_search.road, appearance_search.sidewalk, appearance_search.sky):
            if uid in collection.get_uids_all():
                found[uid] = data_urls.jpeg(collection.load_thumbnails([uid])[uid], APPEARANCE_SIDE)
    return Thumbnails(found)


def of_crops(folder: pathlib.Path, names: Sequence[str]) -> Thumbnails:
    """Object id -> its largest view, cut out by its mask."""
    found: dict[str, str] = {}
    damaged = 0
    for name in names:
        path = folder / f"{name}_0.png"
        if not path.is_file():
            continue
        try:
            with Image.open(path) as image:
                cut = image.convert("RGBA")
        except UNREADABLE:
            damaged += 1
            continue
        shown = Image.new("RGBA", cut.size, (*_BACKGROUND, 255))
        shown.alpha_composite(cut)
        found[name] = data_urls.jpeg(shown.convert("RGB"), CROP_SIDE)
    return Thumbnails(found, f"{damaged} crops in {folder} cannot be read." if damaged else "")


def unique_records(cousins: Sequence[Mapping[str, AssetRecord]], uids: Sequence[Sequence[str]]) -> list[AssetRecord]:
    """The records of the assets of all cousins, each once, those of the first cousin first.

    Args:
      cousins: uid -> record, of each cousin.
      uids: of each cousin, in the order of the table.

    Raises:
      ValidationError: an asset is in none of the lists.
    """
    found: dict[str, AssetRecord] = {}
    for records, wanted in zip(cousins, uids, strict=True):
        for uid in wanted:
            if uid not in records:
                raise ValidationError(f"asset {uid!r}: found no record in assets.json, needed one; make the run again.")
            found.setdefault(uid, records[uid])
    return list(found.values())
