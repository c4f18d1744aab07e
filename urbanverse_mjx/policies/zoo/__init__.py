"""Published navigation models: their contracts, and adapters that drive our robots with their ONNX graphs."""

from .adapters import ZooAgent, zoo_agent
from .contracts import CONTRACTS, ZooContract

__all__ = ["CONTRACTS", "ZooAgent", "ZooContract", "zoo_agent"]
