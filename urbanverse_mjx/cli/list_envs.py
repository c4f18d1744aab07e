"""`urbanverse list-envs`: the registered environments, what their robots do, and their presets."""

from collections.abc import Sequence

from ._options import parse


def list_envs() -> None:
    """List the registered environments, what their robots do, and their presets."""
    from ..envs import registry

    for name in registry.all_envs():
        print(f"{name}  {registry.about(name) or '-'}  (presets: {', '.join(registry.presets(name))})")


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse list-envs`."""
    parse(list_envs, argv, "urbanverse list-envs")
    return 0
