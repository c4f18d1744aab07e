"""Compiles one cousin from its layout to a MuJoCo scene and USD, and checks its stability."""

import pathlib
from typing import Any

from ...assets import AssetIndex
from ...datatypes import AssetRecord, SceneLayout
from ...datatypes import validation as v
from .run_folder import Clock

#: m from start to goal if the ground is too small for the task's 10 to 30 m.
SHORT_ROUTES = (4.0, 30.0)
LAYOUT, ASSETS, SCENE, USD, CHECK = "layout.json", "assets.json", "scene", "usd", "check.json"


def save_layout(folder: pathlib.Path, layout: SceneLayout, index: AssetIndex) -> None:
    """Writes a layout and the asset records that it uses, so that it can be compiled without the catalogue."""
    v.write_json(folder / ASSETS, [record.to_json() for record in index.records])
    layout.save(folder / LAYOUT)


def load_assets(folder: pathlib.Path) -> AssetIndex:
    """Reads the asset records stored with a layout."""
    rows = v.items(v.read_json(folder / ASSETS, "asset list"), ASSETS)
    return AssetIndex(AssetRecord.from_json(row, f"{ASSETS}[{i}]") for i, row in enumerate(rows))


def compile_cousin(folder: pathlib.Path, with_usd: bool) -> dict[str, Any]:
    """Compiles the layout of a folder in that folder and checks the result; returns the contents of `check.json`.

    Objects that do not stay in place for two seconds of C MuJoCo are fixed (`kept_fixed`); all others do stay.

    Raises:
      ValidationError: the layout cannot be compiled.
    """
    import mujoco

    from ...assets.appearances.skies import build_sky
    from ...scene import EpisodeRules, NoRoomError, export_usd
    from ..scenes import compile_layout

    clock = Clock()
    layout = SceneLayout.load(folder / LAYOUT)
    assets = load_assets(folder)
    rules = EpisodeRules()
    try:
        compiled = compile_layout(layout, assets, folder / SCENE, rules, freeze_unstable=True)
    except NoRoomError:
        # The ground of a short clip may be too small for 256 paths of the task's length.
        rules = EpisodeRules(distance=SHORT_ROUTES)
        compiled = compile_layout(layout, assets, folder / SCENE, rules, freeze_unstable=True)
    model = mujoco.MjModel.from_xml_path(str(folder / SCENE / "scene.xml"))
    if with_usd:
        export_usd(compiled.geometry, build_sky(layout.sky), folder / USD)
    fixed = [a.id for a, b in zip(layout.objects, compiled.layout.objects, strict=True) if a.movable != b.movable]
    check = {
        "id": layout.id,
        **compiled.metadata["counts"],
        "geoms": int(model.ngeom),
        "movable": int(compiled.geometry.object_movable.sum()),
        "goals_m": list(rules.distance),
        "usd": with_usd,
        "seconds": round(clock.seconds, 3),
        **clock.resources,
        "kept_fixed": fixed,
    }
    v.write_json(folder / CHECK, check)
    return check
