"""Training policies with Brax PPO. Submodules load Brax when they are imported, this package does not."""
