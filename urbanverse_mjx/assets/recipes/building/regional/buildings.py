"""Recipes of regional buildings: a recipe per tradition and leaf, a variant per form, size and dressing."""

import dataclasses
import hashlib
from typing import Any

import numpy as np

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.recipe import recipe
from ..facade import BUILDING, BUILDING_DENSITY, Facade, finish
from . import boards, extras, ground_floors, panes, roofs
from .front import Front, Windows
from .styles import DRESSINGS, TRADES, Form, Tradition, traditions

#: Largest number of hulls of a building.
HULLS = 10
#: Ground floors with shops.
SHOPS = ("timber", "shutters", "glass", "lattice", "strip")


def build(tradition: Tradition, form: Form, number: int, seed: str) -> BuiltAsset:
    """Builds a form: `number` counts its sizes, and within each the dressings, which share their geometry."""
    place, dressing = divmod(number, DRESSINGS)
    front = Front(
        builder=MeshBuilder(roughness=0.88),
        form=form,
        size=form.sizes[place],
        dressing=dressing,
        trade=_trade(place, dressing, seed),
        language=boards.shop_language(tradition.language),
        rng=_rng(f"{seed}/{place}"),
        tint=_rng(f"{seed}/{place}/{dressing}"),
    )
    _lay(front)
    low, high = front.builder.bounds
    middle = (low + high) / 2
    # Plane of the front, middle across, width and depth of the block without what stands out, m.
    block = (form.depth / 2 - middle[0], -middle[1], front.width, form.depth)
    description, params = _texts(tradition, form, number, seed, [round(float(x), 4) for x in block])
    return finish(front.builder, description, params, front.width * form.depth * front.height * BUILDING_DENSITY, 0.9)


def _trade(place: int, dressing: int, seed: str) -> str:
    return TRADES[(3 * place + 2 * dressing + len(seed)) % len(TRADES)]


def _texts(tradition: Tradition, form: Form, number: int, seed: str, block: list[float]) -> tuple[str, dict[str, Any]]:
    """Description and params of a variant."""
    place, dressing = divmod(number, DRESSINGS)
    trade = _trade(place, dressing, seed) if form.ground in SHOPS else ""
    what = f"house with shops ({trade})" if trade else "house"
    params = {"tradition": tradition.name, "trade": trade, "block": block}
    return f"A {form.sizes[place][1]}-storey {what} as in {tradition.places[0]}", params


def dressed(name: str, leaf: str, variant: int, built: BuiltAsset) -> BuiltAsset:
    """What `build` makes of a variant, but for its texture, from another dressing of the same size."""
    tradition = traditions()[name.removeprefix("regional.")]
    form, number, seed = _form_of(tradition, leaf, variant)
    description, params = _texts(tradition, form, number, seed, built.params["block"])
    return dataclasses.replace(built, description=description, params=params)


def form_of(name: str, leaf: str, variant: int) -> tuple[Form, int]:
    """The form of a regional recipe's variant, and the number of its dressing."""
    form, number, _ = _form_of(traditions()[name.removeprefix("regional.")], leaf, variant)
    return form, number % DRESSINGS


def _form_of(tradition: Tradition, leaf: str, variant: int) -> tuple[Form, int, str]:
    """The form of a variant, its number within the form, and the form's seed."""
    for place, form in enumerate(f for f in tradition.forms if f.leaf == leaf):
        if variant < form.variants:
            return form, variant, f"regional.{tradition.name}/{leaf}/{place}"
        variant -= form.variants
    raise ValueError(f"{tradition.name}: found no variant of that number for {leaf!r}, needed a smaller one.")


def _rng(text: str) -> np.random.Generator:
    return np.random.default_rng(int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "little"))


def _lay(front: Front) -> None:
    form, g, b = front.form, front.form.ground_height, front.builder
    if not form.arcade:
        f = front.main
        ground_floors.lay(front, f)
        _upper(front, f, g)
        image = panes.cladding(form.wall, (f.width, f.height), front.color, front.tint)
        f.walls(image, front.base, g - 0.05)
        return
    upper = Facade(b, front.width, form.depth, front.height - g, front.trim)
    lower = Facade(b, front.width, form.depth - form.arcade, g, front.trim)
    with b.frame((0, 0, g)):
        _upper(front, upper, 0.0)
        upper.walls(panes.cladding(form.wall, (upper.width, upper.height), front.color, front.tint))
    with b.frame((-form.arcade / 2, 0, 0)):
        ground_floors.lay(front, lower)
        lower.walls(panes.cladding("plaster", (lower.width, g), front.base, front.tint))
    ground_floors.arcade(front, form.arcade)


def _upper(front: Front, f: Facade, base: float) -> None:
    Windows(front, f, base).lay()
    extras.lay(front, f, base)
    roofs.lay(front, f)


def _register(tradition: Tradition, leaf: str) -> None:
    count = sum(form.variants for form in tradition.forms if form.leaf == leaf)

    @recipe(leaf, count, BUILDING, HULLS, name=f"regional.{tradition.name}", catalogue=False)
    def regional(variant: int, rng: np.random.Generator) -> BuiltAsset:
        return build(tradition, *_form_of(tradition, leaf, variant))


for _tradition in traditions().values():
    for _leaf in sorted({form.leaf for form in _tradition.forms}):
        _register(_tradition, _leaf)
