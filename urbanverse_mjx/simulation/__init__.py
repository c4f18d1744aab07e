"""The physics engines and the renderer, with per-env interfaces for `jax.vmap`."""

import pathlib

import warp

from .kernel_cache import check_kernels
from .warp_start import start_warp

# Warp, which MJX also initialises, prints its devices and modules to standard output, on which commands print their
# results. This must therefore run before Warp is initialised.
warp.config.log_level = warp.LOG_WARNING
start_warp()
if warp.config.kernel_cache_dir is not None:
    check_kernels(pathlib.Path(warp.config.kernel_cache_dir))
