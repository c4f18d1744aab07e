"""`urbanverse list-envs`: the registered environments and their presets."""

from collections.abc import Sequence

import tyro


def list_envs() -> None:
    """List the registered environments and their presets, and the robots of docs/robots.md."""
    from ..envs import registry
    from ..robots import catalogue

    robots = {catalogue.environment_name(name): catalogue.row(name) for name in catalogue.NAMES}
    for name in registry.all_envs():
        what = f"  {robots[name].title}: {robots[name].kind}" if name in robots else ""
        print(f"{name}  (presets: {', '.join(registry.presets(name))}){what}")


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse list-envs`."""
    tyro.cli(list_envs, args=list(argv), prog="urbanverse list-envs")
    return 0
