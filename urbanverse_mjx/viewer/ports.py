"""Checks the port of a page before anything is loaded for it; imports neither viser nor JAX."""

import socket

from ..datatypes import ValidationError


def free_port(host: str, port: int) -> int:
    """Returns the port, or for 0 a free one.

    Raises:
      ValidationError: the port is in use or not permitted.
    """
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise ValidationError(
                f"--port: found {port} on {host} taken ({error.strerror}), needed a free one; choose another, or 0 for "
                "any."
            ) from error
        return probe.getsockname()[1]
