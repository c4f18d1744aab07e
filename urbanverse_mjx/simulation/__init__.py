"""The engines and the renderer: physics and images of a scene, one env at a time under `jax.vmap`."""

import pathlib

import warp

from .kernel_cache import check_kernels
from .warp_start import start_warp

# Warp, which MJX starts too, prints its devices and modules to standard output. Programs read the last line of a
# command's standard output, so this must run before Warp starts.
warp.config.log_level = warp.LOG_WARNING
start_warp()
if warp.config.kernel_cache_dir is not None:
    check_kernels(pathlib.Path(warp.config.kernel_cache_dir))
