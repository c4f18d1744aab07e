"""Training of policies by PPO and imitation. Submodules import Brax, this package does not."""
