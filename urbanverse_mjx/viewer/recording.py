"""Writes a session as one HTML file that plays without a server, using viser's recording."""

import contextlib
import io
from collections.abc import Collection, Iterator

import viser

from .ports import free_port
from .session import Session
from .stage import LAYERS, Stage, chase_view
from .street import StreetMeshes


def html_recording(
    session: Session, street: StreetMeshes, shown: Collection[str] = tuple(n for n, on in LAYERS.items() if on)
) -> str:
    """Returns the page with all frames in real time.

    Args:
      shown: layers of `LAYERS`.
    """
    with private_server() as server:
        stage = Stage(server, session, street)
        for layer in LAYERS:
            stage.switch(layer, layer in shown, 0)
        set_initial_view(server, session)
        serializer = server.get_scene_serializer()
        for index in range(1, len(session)):
            serializer.insert_sleep(session.machine.env.dt)
            stage.show(index)
        serializer.insert_sleep(1.0)
        return serializer.as_html()


def set_initial_view(server: viser.ViserServer, session: Session) -> None:
    """Lets a page open with the camera behind the first robot of a session."""
    position, target = chase_view(session, 0, 0)
    server.initial_camera.position, server.initial_camera.look_at = tuple(position), tuple(target)


@contextlib.contextmanager
def private_server() -> Iterator[viser.ViserServer]:
    """A viser server on a free local port, for the recording only."""
    server = start_server("127.0.0.1", 0)
    try:
        yield server
    finally:
        stop_server(server)


def start_server(host: str, port: int) -> viser.ViserServer:
    """A viser server; port 0 takes a free one.

    Raises:
      ValidationError: the port is in use or not permitted. (viser itself would use the next one.)
    """
    port = free_port(host, port)
    with contextlib.redirect_stdout(io.StringIO()):
        return viser.ViserServer(host=host, port=port, verbose=False)


def stop_server(server: viser.ViserServer) -> None:
    """Stops a server without viser's message on standard output."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()
