"""Settings of all presets of all registered environments and of their trainings: whoever changes one acknowledges it.

Of an environment only what it sets otherwise than its relatives is kept.
"""

from collections.abc import Callable
from typing import Any

import pytest

from tests.support import figures
from urbanverse_mjx.envs import registry

#: Environments of which all presets are compared, and presets of the others, which change the same as theirs.
WHOLE, SOME = ("CocoNav", "Go2Joystick", "Go2Nav"), ("fast",)
#: Those that are registered before a test registers its own.
ALL = registry.all_envs()


def leaves(config: Any, above: str = "") -> dict[str, Any]:
    """Values by dotted name."""
    found: dict[str, Any] = {}
    for name, value in config.items():
        found |= leaves(value, f"{above}{name}.") if hasattr(value, "items") else {above + name: value}
    return found


def told(value: Any) -> str:
    """A value as text, numbers to six digits."""
    if isinstance(value, list | tuple):
        return f"({' '.join(told(x) for x in value)})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


@pytest.mark.parametrize("of", ["default", "ppo"])
def test_figures_of_settings(of: str) -> None:
    get: Callable[..., Any] = registry.get_default_config if of == "default" else registry.get_ppo_config
    known: list[dict[str, str]] = []
    rows: dict[str, dict[str, str]] = {}
    for name in [*WHOLE, *(name for name in sorted(ALL) if name not in WHOLE)]:
        for preset in registry.presets(name) if name in WHOLE else SOME:
            found = {key: told(value) for key, value in leaves(get(name, preset)).items()}
            nearest = min(known, key=lambda other: len(found.items() ^ other.items()), default={})
            changed = {key: value for key, value in found.items() if nearest.get(key) != value}
            gone = dict.fromkeys(nearest.keys() - found.keys(), "gone")
            if rest := {**changed, **dict(sorted(gone.items()))}:
                rows[f"{name}/{preset}"] = rest
                if name in WHOLE:  # the others are compared with these alone, so that a new one changes its own rows
                    known.append(found)
    figures.check(f"settings/{of}", rows)
