"""`python -m urbanverse_mjx.assets.previews.appearance_sheets COMMAND`: sheets of skies and grounds, and single ones.

thumbnails: generates the stored thumbnails again (after a change of their code). sheets: draws contact sheets with
names. ground, sky: writes the maps of one uid.
"""

import pathlib
from typing import Annotated, Literal

import numpy as np
import tyro
from PIL import Image
from rich.console import Console
from rich.progress import track

from urbanverse_mjx.datatypes.validation import write_atomically

from ..appearances import appearance_search
from ..appearances.grounds import ground_records, paint_ground
from ..appearances.sky_maps import paint_sky, sky_records
from ..meshes import paint

_LABEL = 16  # px


def thumbnails(out: pathlib.Path | None = None, only: Literal["ground", "sky"] | None = None) -> None:
    """Generates the thumbnails of all skies and grounds (about three minutes on one core).

    Args:
      out: folder; default: the asset index.
      only: only skies or only grounds.
    """
    for kind in ("ground", "sky") if only is None else (only,):
        path = appearance_search.build_thumbnails(
            f"{kind}_thumbnails.jpg", out, lambda records, kind=kind: track(records, kind)
        )
        Console().print(f"{path.name}: {path.stat().st_size} bytes")


def sheets(out: pathlib.Path = pathlib.Path("docs"), again: bool = False) -> None:
    """Draws contact sheets of all skies, roads and sidewalks with their names.

    Args:
      out: folder to write into.
      again: generate every tile instead of reading the stored thumbnails.
    """
    groups = {
        "skies": ([r.uid for r in sky_records()], appearance_search.sky, appearance_search.sky_thumbnail),
        "roads": ([r.uid for r in ground_records("road")], appearance_search.road, appearance_search.ground_thumbnail),
        "sidewalks": (
            [r.uid for r in ground_records("sidewalk")],
            appearance_search.sidewalk,
            appearance_search.ground_thumbnail,
        ),
    }
    for name, (uids, collection, painted) in groups.items():
        if again:
            tiles = {uid: painted(uid) for uid in track(uids, name)}
        else:
            tiles = collection.load_thumbnails(uids)
        path = _sheet(tiles, out / f"{name}.jpg", 9 if name == "skies" else 14)
        Console().print(f"{path.name}: {len(tiles)} tiles, {path.stat().st_size} bytes")


def _sheet(tiles: dict[str, np.ndarray], path: pathlib.Path, columns: int) -> pathlib.Path:
    height, width = next(iter(tiles.values())).shape[:2]
    rows = -(-len(tiles) // columns)
    sheet, pen = paint.canvas((columns * width, rows * (height + _LABEL)), "white")
    for k, (uid, tile) in enumerate(tiles.items()):
        x, y = k % columns * width, k // columns * (height + _LABEL)
        sheet.paste(Image.fromarray(tile), (x, y))
        paint.text(
            pen, uid.split("/")[-1], (x + 1, y + height + 1, x + width - 1, y + height + _LABEL - 2), "black", limit=11
        )
    return write_atomically(path, lambda p: sheet.save(p, "JPEG", quality=80))


def ground(uid: Annotated[str, tyro.conf.arg(metavar="KIND/NAME")], out: pathlib.Path) -> None:
    """Writes albedo.png, normal.png, roughness.png and picture.png of a ground material.

    Args:
      uid: uid, such as "road/asphalt_old-cracked".
      out: folder to write into.
    """
    maps = paint_ground(uid)
    files = {"albedo": maps.albedo, "normal": maps.normal, "roughness": maps.roughness, "picture": maps.preview}
    for name, values in files.items():
        image = Image.fromarray(values)
        write_atomically(out / f"{name}.png", lambda p, image=image: image.save(p, "PNG"))
    Console().print(f"{out}: {maps.record.description}; {maps.record.tile_size_m} m a tile")


def sky(uid: Annotated[str, tyro.conf.arg(metavar="NAME-NAME")], out: pathlib.Path, height: int = 256) -> None:
    """Writes radiance.npy (linear, without the sun's disc) and picture.png of a sky.

    Args:
      uid: uid, such as "summer_noon-few_cumulus".
      out: folder to write into.
      height: number of rows; there are twice as many columns.
    """
    painted = paint_sky(uid, height)
    image = Image.fromarray(appearance_search.preview(appearance_search.with_disc(painted)))
    write_atomically(out / "picture.png", lambda p: image.save(p, "PNG"))
    write_atomically(out / "radiance.npy", lambda p: _save(p, painted.radiance))
    sun = np.round(painted.sun_irradiance * painted.lux_per_unit, 1).tolist()
    Console().print(f"{out}: {painted.record.description}; the sun gives {sun} lx of red, green and blue")


def _save(path: pathlib.Path, array: np.ndarray) -> None:
    with path.open("wb") as file:
        np.save(file, array)


COMMANDS = {"thumbnails": thumbnails, "sheets": sheets, "ground": ground, "sky": sky}

if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict(COMMANDS)
