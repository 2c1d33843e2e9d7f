"""Shows a simulation in the browser while it runs: its agents, its fields, its charts, and controls for its settings."""

from __future__ import annotations

import atexit
import contextlib
import os
import sys
import threading
import webbrowser
from collections.abc import Callable, Mapping
from typing import Any

from .controls import flat
from .errors import Error
from .files import settings_in
from .live import Live
from .live_server import LiveServer
from .models import Model
from .playground import find_folder
from .settings import assignments
from .simulation import Simulation

#: What is usual where a simulation is watched: a sample after each step, and nothing that costs more than a step.
WATCHED = {"observe.every": 1, "observe.structure_every": 0}


class Shown:
    """A simulation that is shown; :func:`show` returns it.

    - ``url``: the address of the page. Its long name is a secret: who knows it can run the model.
    - ``simulation``: the :class:`Simulation` of now; to look at it pauses it. A page that restarts makes another one.
    - :meth:`wait`, :meth:`close`.
    """

    def __init__(self, make: Callable[[Mapping[str, Any]], Simulation], folder: str | os.PathLike[str], port: int = 0) -> None:
        self._live = Live(make)
        try:
            self._server = LiveServer(self._live, folder, port)
        except BaseException:
            self._live.close()
            raise
        self._is_closed = threading.Event()
        atexit.register(self.close)

    @property
    def url(self) -> str:
        return self._server.address

    @property
    def simulation(self) -> Simulation:
        return self._live.pause()

    def wait(self) -> None:
        """Waits for :meth:`close` or Ctrl-C, which closes it."""
        try:
            while not self._is_closed.wait(0.5):
                pass
        except KeyboardInterrupt:
            self.close()

    def close(self) -> None:
        """Ends the page and the thread of the model, at the end of its step."""
        if self._is_closed.is_set():
            return
        self._is_closed.set()
        atexit.unregister(self.close)
        has_ended = self._live.close()
        self._server.close()
        if not has_ended:
            raise Error("the model does not come to the end of its step\n  hint: it ends with this process")

    def __enter__(self) -> Shown:
        return self

    def __exit__(self, *parts: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<gridlock.Shown {'closed' if self._is_closed.is_set() else 'at ' + self.url}>"


def show(
    model: type[Model] | Model | Mapping[str, Any] | str | os.PathLike[str],
    *,
    height: int = 720,
    port: int = 0,
    block: bool | None = None,
    **more: Any,
) -> Shown:
    """Shows a simulation in the browser, to be run, paused, stepped and begun anew there, with controls for its settings.

    ::

        gridlock.show(Walkers, box={"edge": "periodic"})

    :param model: a class derived from :class:`Model` or an object of it, or the settings of any :class:`Simulation`.
    :param height: of the page in a notebook, in pixels.
    :param port: of this machine; 0 for a free one.
    :param block: whether to wait for Ctrl-C; None: in scripts, but neither in notebooks nor at a prompt.
    :param more: settings, as for a :class:`Simulation`.
    :raises Error: for settings that cannot be run, and where the page is not built.

    In a notebook the page is in the cell; else its address is printed, and the browser opens it where there is a desktop. The model
    runs on a thread of this process and pauses where no page is open. It is sampled after each step, without ψ6 and g(r), unless
    ``observe`` says otherwise. A setting that the start of a model does not read changes from the next step on, as by
    :meth:`Simulation.change`; another one begins anew.
    """
    shown = start(lambda: (model, more), port)
    if _is_in_notebook():
        from IPython.display import IFrame, display  # type: ignore[import-not-found,import-untyped,unused-ignore]

        display(IFrame(shown.url, "100%", height))  # type: ignore[no-untyped-call,unused-ignore]
    else:
        tell(shown)
    if block if block is not None else not (_is_in_notebook() or _is_at_prompt()):
        shown.wait()
    return shown


def start(read: Callable[[], tuple[Any, Mapping[str, Any]]], port: int = 0) -> Shown:
    """Shows what ``read`` returns, a model or settings and more settings; it is asked anew at each start."""
    folder = find_folder()
    if folder is None:
        raise Error("the page that shows models is not built\n"
                    "  hint: the packages and the wheel that ./dev makes have it; in the sources of Gridlock, ./dev build-web makes it alone")
    return Shown(lambda overrides: simulation_of(*read(), overrides), folder, port)


def simulation_of(model: Any, more: Mapping[str, Any], overrides: Mapping[str, Any]) -> Simulation:
    """The simulation of a model or of settings, with more settings and those that a page has changed."""
    is_file = isinstance(model, (str, os.PathLike))
    is_model = isinstance(model, Model) or (isinstance(model, type) and issubclass(model, Model))
    if not (is_file or is_model or isinstance(model, Mapping)):
        raise Error(f"a {type(model).__name__} cannot be shown\n"
                    "  hint: give a class derived from gridlock.Model, an object of it, settings, or the name of a file of settings")
    given = {key for key, _ in assignments({"model": model, **more} if is_model else more)}
    if is_file:
        # A file that cannot be read is refused where the simulation is made.
        with contextlib.suppress(OSError, ValueError), open(model, encoding="utf-8") as file:
            given |= flat(settings_in(file.read())).keys()
    elif not is_model:
        given |= {key for key, _ in assignments(model)}
    usual = {key: value for key, value in WATCHED.items() if key not in given}
    if is_model:
        return Simulation({"model": model, **more, **usual, **overrides})
    # What is set later counts.
    return Simulation(model, **{**more, **usual, **overrides})


def tell(shown: Shown, *, opens_browser: bool = True) -> None:
    """Prints the address, and opens it where there is a desktop."""
    print(f"the model is shown at\n  {shown.url}\nCtrl-C stops.", flush=True)
    has_desktop = sys.platform == "darwin" or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
    if opens_browser and has_desktop:
        webbrowser.open(shown.url)


def _is_in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")


def _is_at_prompt() -> bool:
    return hasattr(sys, "ps1") or bool(sys.flags.interactive) or "IPython" in sys.modules and sys.modules["IPython"].get_ipython() is not None
