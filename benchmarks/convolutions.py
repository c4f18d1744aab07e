"""Times a minibatch update of the paper's two networks with each form of their convolutions.

    python -m benchmarks.convolutions
    python -m benchmarks.convolutions --size 27x48 --transitions 256 --minibatch 64 --dtypes float32    # on a CPU

Random images are shuffled and cut into minibatches as in PPO; the loss is a simple one, because only its gradients cost
time.
Prints a JSON line for each form and type: the median of `--repeats` runs of two epochs, ms an update.
"""

import argparse
import json
import sys
import time
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax

from urbanverse_mjx.training.networks import CONVOLUTIONS, PIXELS, make_networks

#: Transitions of one env in a row, which PPO shuffles together.
UNROLL = 32
EPOCHS = 2


def arguments() -> argparse.Namespace:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("--size", default="135x240", help="height x width, pixels")
    cli.add_argument("--transitions", type=int, default=8192, help="of an epoch")
    cli.add_argument("--minibatch", type=int, default=512, help="transitions")
    cli.add_argument("--dtypes", nargs="+", choices=("bfloat16", "float32"), default=["bfloat16", "float32"])
    cli.add_argument("--repeats", type=int, default=3)
    return cli.parse_args()


def training(networks: Any, optimizer: optax.GradientTransformation, minibatches: int) -> Any:
    """Makes a compiled function of (parameters, optimizer state), data and keys that trains an epoch a key."""

    def loss(params: Any, obs: Any) -> jax.Array:
        action = networks.policy_network.apply(None, params[0], obs)
        value = networks.value_network.apply(None, params[1], obs)
        return (action**2).mean() + (value**2).mean()

    def update(carry: Any, obs: Any) -> Any:
        params, state = carry
        value, gradients = jax.value_and_grad(loss)(params, obs)
        changes, state = optimizer.update(gradients, state, params)
        return (optax.apply_updates(params, changes), state), value

    def epoch(data: Any, carry: Any, key: jax.Array) -> Any:
        rows = jax.random.permutation(key, len(data["goal"]))
        cut = jax.tree.map(lambda x: x[rows].reshape(minibatches, -1, *x.shape[1:]), data)
        return jax.lax.scan(update, carry, cut)

    return jax.jit(lambda carry, data, keys: jax.lax.scan(lambda c, k: epoch(data, c, k), carry, keys))


def measure(form: str, dtype: str, args: argparse.Namespace) -> dict[str, Any]:
    """Returns the ms an update of one form."""
    height, width = (int(n) for n in args.size.split("x"))
    sizes = {PIXELS: (height, width, 3), "goal": (2,), "privileged": (21,)}
    # The paper's layers need 62 pixels; smaller images get those of the preset `cpu`.
    layers = ((16, 8, 4), (32, 4, 2), (64, 4, 2)) if height >= 62 else ((16, 4, 4), (32, 2, 2), (64, 2, 1))
    networks = make_networks(sizes, 2, layers=layers, bfloat16=dtype == "bfloat16", convolution=form)
    keys = jax.random.split(jax.random.key(0), EPOCHS + 2)
    params: Any = networks.policy_network.init(keys[0]), networks.value_network.init(keys[1])
    optimizer = optax.chain(optax.clip_by_global_norm(1.0), optax.adam(1e-4))
    rows = args.transitions // UNROLL
    images = np.random.default_rng(0).integers(0, 256, (rows, UNROLL, height, width, 3), np.uint8)
    data = {name: jnp.ones((rows, UNROLL, *size)) for name, size in sizes.items() if name != PIXELS}
    data[PIXELS] = jnp.asarray(images)
    run = training(networks, optimizer, args.transitions // args.minibatch)
    carry = params, optimizer.init(params)
    jax.block_until_ready(run(carry, data, keys[2:]))
    seconds = []
    for _ in range(args.repeats):
        begin = time.perf_counter()
        jax.block_until_ready(run(carry, data, keys[2:]))
        seconds.append(time.perf_counter() - begin)
    updates = EPOCHS * (args.transitions // args.minibatch)
    each = [round(1e3 * s / updates, 3) for s in sorted(seconds)]
    return {"form": form, "dtype": dtype, "ms_per_update": float(np.median(each)), "all": each}


def main() -> int:
    args = arguments()
    if args.minibatch % UNROLL or args.transitions % args.minibatch:
        raise SystemExit(
            f"error: found {args.transitions} transitions and minibatches of {args.minibatch}, needed minibatches of a "
            f"multiple of {UNROLL} and a whole number of them."
        )
    about = {"device": jax.devices()[0].device_kind, "size": args.size, "minibatch": args.minibatch}
    for dtype in args.dtypes:
        for form in CONVOLUTIONS[1:]:
            print(json.dumps({**about, **measure(form, dtype, args)}), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
