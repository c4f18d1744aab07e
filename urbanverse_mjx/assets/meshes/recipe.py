"""The register of recipes: leaf category -> function that builds its variants, with the physical priors of the leaf.

A recipe is `f(variant, rng) -> BuiltAsset`. `rng` is seeded from recipe, leaf and variant only, so a record's mesh is
reproducible. Modules under `assets.recipes` are imported when the register is first used.
"""

import dataclasses
import functools
import hashlib
import importlib
import pkgutil
from collections.abc import Callable

import numpy as np

from urbanverse_mjx.datatypes import ValidationError

from ..categories import ontology
from .mesh_builder import BuiltAsset

RecipeFunction = Callable[[int, np.random.Generator], BuiltAsset]


@dataclasses.dataclass(frozen=True)
class Physics:
    """Physical priors of a leaf.

    Attributes:
      materials: dominant materials, in descending order.
      density: kg per m^3 of the mesh's enclosed volume, including air (200-500 for a hollow steel box).
      mass_range: kg, (least, greatest), to which the product of volume and density is clipped.
      friction: sliding friction coefficient of its surface.
      movable: whether one person could move it (False for bolted-down objects, however light).
      reason: source of these values, or the reason why they are plausible.
    """

    materials: tuple[str, ...]
    density: float
    mass_range: tuple[float, float]
    friction: float
    movable: bool
    reason: str


@dataclasses.dataclass(frozen=True)
class Recipe:
    """One registered recipe.

    Attributes:
      name: frozen name, independent of the function's name and module.
      physics: physical priors; None to use the leaf's row of `assets_index/priors.csv`.
      hulls: largest number of hulls of the convex decomposition (None: chosen by size).
      catalogue: whether its variants are base shapes of the catalogue; regional buildings are not.
    """

    name: str
    leaf: str
    variants: int
    physics: Physics | None
    function: RecipeFunction
    hulls: int | None = None
    catalogue: bool = True

    def build(self, variant: int) -> BuiltAsset:
        """Builds one variant, 0 <= variant, deterministically."""
        seed = hashlib.sha256(f"{self.name}/{self.leaf}/{variant}".encode()).digest()
        return self.function(variant, np.random.default_rng(int.from_bytes(seed[:8], "little")))


_REGISTER: dict[tuple[str, str], Recipe] = {}


def recipe(
    leaf: str,
    variants: int,
    physics: Physics | None = None,
    hulls: int | None = None,
    *,
    name: str,
    catalogue: bool = True,
) -> Callable[[RecipeFunction], RecipeFunction]:
    """Decorator: registers the function for an ontology leaf. One function may serve several leaves (stack decorators).

    Args:
      leaf: exact leaf name of the ontology.
      name: part of every variant's uid and seed, so it stays as it is when the function or its file is renamed; unique
        for the leaf.
      variants: number of variants in the index.
      physics: the recipe's physical priors; None to use the leaf's row of `assets_index/priors.csv`.
      hulls: largest number of convex hulls of the decomposition, 1 to 16; None to choose it by size; 1 for the convex
        hull.
      catalogue: see `Recipe`.

    Raises:
      ValidationError: the leaf does not exist, or the recipe is already registered for it.
    """
    ontology.category_of(leaf)

    def register(function: RecipeFunction) -> RecipeFunction:
        if (name, leaf) in _REGISTER:
            raise ValidationError(
                f"recipe {name!r}: found it registered twice for {leaf!r}, needed one; give one another name."
            )
        _REGISTER[name, leaf] = Recipe(name, leaf, variants, physics, function, hulls, catalogue)
        return function

    return register


@functools.cache
def _load_all() -> None:
    package = importlib.import_module("urbanverse_mjx.assets.recipes")
    for module in sorted(m.name for m in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")):
        importlib.import_module(module)


def all_recipes() -> list[Recipe]:
    """Every recipe of the catalogue, by leaf and name."""
    _load_all()
    return [r for r in _sorted() if r.catalogue]


def regional_recipes() -> list[Recipe]:
    """Every recipe outside the catalogue, by leaf and name."""
    _load_all()
    return [r for r in _sorted() if not r.catalogue]


def _sorted() -> list[Recipe]:
    return sorted(_REGISTER.values(), key=lambda r: (r.leaf, r.name))


def get_recipe(name: str, leaf: str) -> Recipe:
    """The recipe of an index record.

    Raises:
      ValidationError: the recipe does not exist in this version of the package.
    """
    _load_all()
    if (name, leaf) not in _REGISTER:
        raise ValidationError(
            f"asset recipe: found {name!r} for {leaf!r} in the index, needed one of this package's recipes; "
            "rebuild the index with `python -m urbanverse_mjx.assets index`."
        )
    return _REGISTER[name, leaf]
