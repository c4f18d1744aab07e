"""The engines and the renderer: what happens in a scene, and what it looks like, one env at a time under `jax.vmap`."""
