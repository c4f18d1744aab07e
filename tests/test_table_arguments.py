"""`table_arguments.jit` computes what `jax.jit` computes, without the tables in the compiled program."""

import jax
import jax.numpy as jnp
import numpy as np

from tests.support.stablehlo import largest_constant
from urbanverse_mjx import table_arguments

TABLE = jnp.asarray(np.random.default_rng(0).normal(size=(300, 200)).astype(np.float32))
OFFSETS = np.arange(40_000.0, dtype=np.float32)
SMALL = jnp.arange(3.0)


def looked_up(place: dict[str, jax.Array], key: jax.Array) -> dict[str, jax.Array]:
    def step(carry: jax.Array, _: None) -> tuple[jax.Array, jax.Array]:
        row = jnp.clip(carry.astype(jnp.int32), 0, 299)
        return carry + TABLE[row, 0] + SMALL[1], jnp.asarray(OFFSETS)[row]

    end, seen = jax.lax.scan(step, place["x"] + jax.random.uniform(key), None, length=5)
    return {"end": end, "seen": seen}


def test_it_equals_jit_for_every_shape_of_its_arguments() -> None:
    ours, theirs = table_arguments.jit(jax.vmap(looked_up)), jax.jit(jax.vmap(looked_up))
    for n in (4, 4, 7):
        keys, place = jax.random.split(jax.random.key(n), n), {"x": 20.0 * jnp.arange(float(n))}
        found, needed = ours(place, keys), theirs(place, keys)
        jax.tree.map(np.testing.assert_array_equal, found, needed)


def test_a_large_table_is_no_part_of_the_program_and_a_later_call_traces_nothing() -> None:
    traced: list[int] = []

    def function(x: jax.Array) -> jax.Array:
        traced.append(1)
        return x + TABLE.sum() + SMALL

    ours = table_arguments.jit(function)
    np.testing.assert_allclose(ours(jnp.ones(3)) - ours(jnp.zeros(3)), 1.0, rtol=1e-5)
    assert len(traced) == 1
    program = ours.lower(jax.ShapeDtypeStruct((3,), jnp.float32))
    assert [x.nbytes for x in program.tables] == [TABLE.nbytes]
    assert largest_constant(program.lowered().as_text()) <= SMALL.size < TABLE.size
    assert largest_constant(jax.jit(function).lower(jnp.ones(3)).as_text()) == TABLE.size
    np.testing.assert_array_equal(program.compile()(jnp.ones(3)), ours(jnp.ones(3)))


def test_donated_arguments_are_gone_and_the_others_stay() -> None:
    ours = table_arguments.jit(lambda a, b: (a + TABLE, b + 1.0), donate_argnums=0)
    for run in (ours, ours.lower(TABLE, SMALL).compile()):
        given, kept = TABLE + 1.0, SMALL + 1.0
        found, _ = run(given, kept)
        np.testing.assert_array_equal(found, (TABLE + 1.0) + TABLE)
        assert given.is_deleted()
        assert not kept.is_deleted()
        assert not TABLE.is_deleted()


class Looked:
    """An object with tables that others replace."""

    def __init__(self) -> None:
        self.large, self.small = TABLE, {"a": SMALL}

    def __call__(self, x: jax.Array) -> jax.Array:
        return x + self.large[0, :3] * self.small["a"]


def test_other_tables_are_read_at_the_next_call_without_a_new_program() -> None:
    traced: list[int] = []
    looked = Looked()

    def function(x: jax.Array) -> jax.Array:
        traced.append(1)
        return looked(x)

    held = table_arguments.Held((looked, "large"), (looked, "small"))
    ours = table_arguments.jit(jax.vmap(function), held=held)
    compiled = ours.lower(jnp.ones((2, 3))).compile()
    x = jnp.ones((2, 3))
    for k in range(3):
        np.testing.assert_array_equal(ours(x), jax.vmap(looked)(x))
        np.testing.assert_array_equal(compiled(x), ours(x))
        other = TABLE + k + 1.0, {"a": SMALL - k}
        before = held.tables
        held.replace(other)
        assert held.tables == other
        # A program that kept them would fail.
        if k:
            jax.tree.map(lambda a: a.delete(), before)
    assert len(traced) == 2, "once for each of the two programs"
    assert isinstance(looked.large, jax.Array), "no tracer is left behind"


def test_held_tables_and_donated_arguments_are_different_ones() -> None:
    looked = Looked()
    held = table_arguments.Held((looked, "large"), (looked, "small"))
    ours = table_arguments.jit(lambda a, b: (a + looked.large, b + 1.0), donate_argnums=0, held=held)
    given, kept = TABLE + 1.0, SMALL + 1.0
    np.testing.assert_array_equal(ours(given, kept)[0], (TABLE + 1.0) + TABLE)
    assert given.is_deleted()
    assert not kept.is_deleted()
    assert not looked.large.is_deleted()
