"""Serves the page and a live simulation to the browser, on the loopback interface alone."""

from __future__ import annotations

import json
import math
import os
import pathlib
import re
import secrets
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np

from .errors import Error
from .live import MOST_ROWS, Live, LiveFrame

#: Bytes of a request.
MOST_BYTES = 65_536
#: Seconds that a request waits for something new.
PATIENCE = 10.0
#: Connections at once; browsers open six to one server.
MOST_CONNECTIONS = 64
#: Steps of one press of a key.
MOST_STEPS = 10**9
_TYPES = {".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8",
          ".wasm": "application/wasm", ".json": "application/json"}
_POLICY = ("default-src 'self' data: blob:; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
           "worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'none'")


class _Refusal(Exception):
    """An answer that is an error: its status, what, and a hint."""


class LiveServer(ThreadingHTTPServer):
    """The page at ``address``, which holds a secret: who does not know it sees nothing and changes nothing.

    :param folder: the folder of the page.
    :param port: 0 for a free one.
    :raises Error: for a port that cannot be had.
    """

    daemon_threads = True
    request_queue_size = 64

    def __init__(self, live: Live, folder: str | os.PathLike[str], port: int = 0) -> None:
        self.live = live
        self.secret = secrets.token_urlsafe(16)
        root = pathlib.Path(folder)
        self.files = {path.relative_to(root).as_posix(): path for path in root.rglob("*") if path.is_file() and not path.is_symlink()}
        self.index = root.joinpath("index.html").read_text("utf-8").replace("<head>", '<head><meta name="gridlock-live" content="./live/">', 1)
        self._places = threading.BoundedSemaphore(MOST_CONNECTIONS)
        try:
            super().__init__(("127.0.0.1", port), _Handler)
        except (OSError, OverflowError) as error:
            raise Error(f"port {port} cannot be had: {error}\n  hint: leave port out, and a free one is found") from None
        self.address = f"http://127.0.0.1:{self.server_address[1]}/{self.secret}/"
        self._thread = threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.1}, name="gridlock page", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Answers nobody any more."""
        self.shutdown()
        self.server_close()
        self._thread.join(2.0)

    def process_request(self, request: Any, client_address: Any) -> None:
        if not self._places.acquire(blocking=False):
            self.shutdown_request(request)
            return
        super().process_request(request, client_address)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._places.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A page that is closed breaks its connections: nothing to say."""


class _Handler(BaseHTTPRequestHandler):
    server: LiveServer
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "gridlock", ""
    timeout = 60.0
    wbufsize = 1 << 16
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        self._answer(self._get)

    def do_POST(self) -> None:
        self._answer(self._post)

    def _answer(self, act: Any) -> None:
        try:
            path, query = self._asked()
            status, kind, body = act(path, query)
        except _Refusal as refusal:
            status, kind = refusal.args[0], "application/json"
            body = json.dumps({"error": refusal.args[1], "hint": refusal.args[2]}).encode()
            self.close_connection = True
        self.send_response(status)
        headers = {
            "Content-Type": kind, "Content-Length": str(len(body)), "Cache-Control": "no-store", "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer", "Cross-Origin-Resource-Policy": "same-origin", "Content-Security-Policy": _POLICY,
        }
        for name, value in headers.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(body)

    def _asked(self) -> tuple[str, dict[str, list[str]]]:
        """The path behind the secret, and what is asked for there, of requests that come from the page itself."""
        hosts, origins = self.headers.get_all("Host") or [], self.headers.get_all("Origin") or []
        # Another name for this machine may be that of a foreign page. Any port: a tunnel has its own.
        is_here = len(hosts) == 1 and re.fullmatch(r"(127\.0\.0\.1|localhost|\[::1\])(:\d{1,5})?", hosts[0]) is not None
        if not is_here or any(origin != f"http://{hosts[0]}" for origin in origins):
            raise _Refusal(403, "this request comes from another site or by another name", "open the address that gridlock.show has printed")
        url = urlsplit(self.path)
        _, secret, *rest = url.path.split("/") if url.path.count("/") >= 2 else ("", "")
        if not secrets.compare_digest(secret.encode(), self.server.secret.encode()):
            raise _Refusal(404, "there is nothing at this address", "open the whole address that gridlock.show has printed")
        return "/".join(rest), parse_qs(url.query)

    def _get(self, path: str, query: dict[str, list[str]]) -> tuple[int, str, bytes]:
        if path in ("", "index.html"):
            return 200, _TYPES[".html"], self.server.index.encode()
        if path == "live/about.json":
            return 200, "application/json", json.dumps(_finite(self.server.live.about())).encode()
        if path == "live/frame":
            return self._frame(query)
        file = self.server.files.get(path)
        if file is None:
            raise _Refusal(404, "there is nothing at this address", "reload the page")
        return 200, _TYPES.get(file.suffix, "application/octet-stream"), file.read_bytes()

    def _frame(self, query: dict[str, list[str]]) -> tuple[int, str, bytes]:
        try:
            after, run, rows = (int(query.get(name, ["0"])[0]) for name in ("after", "run", "rows"))
        except ValueError:
            raise _Refusal(400, "after, run and rows are whole numbers", "reload the page") from None
        columns = frozenset(name for name in query.get("columns", [""])[0].split(",") if name)
        try:
            frame = self.server.live.frame(after, columns & set(self.server.live.about()["columns"]), PATIENCE)
        except Error as error:
            raise _Refusal(410, *_parts(error)) from None
        return (204, "text/plain", b"") if frame is None else (200, "application/octet-stream", packed(frame, columns, run, rows))

    def _post(self, path: str, query: dict[str, list[str]]) -> tuple[int, str, bytes]:
        length = self.headers.get("Content-Length", "")
        if not length.isdigit() or int(length) > MOST_BYTES:
            raise _Refusal(413, f"the body of a request has a length, {MOST_BYTES} bytes at most", "reload the page")
        text = self.rfile.read(int(length))
        try:
            wish = json.loads(text)
            act = self._command(path, wish if isinstance(wish, dict) else {})
        except (ValueError, TypeError, RecursionError):
            raise _Refusal(400, "the command cannot be read", "reload the page") from None
        try:
            act()
        except Exception as failure:  # noqa: BLE001: whatever a model raises in its start
            raise _Refusal(422, *_parts(failure)) from None
        return 200, "application/json", b"{}"

    def _command(self, path: str, wish: dict[str, Any]) -> Any:
        """What a command of the page does. Raises ValueError for one that cannot be understood."""
        live = self.server.live
        if path == "live/run":
            speed = wish.get("stepsPerSecond")
            if speed is not None and not (type(speed) in (int, float) and 0.0 < speed < math.inf):
                raise ValueError
            return lambda: live.run(speed)
        if path == "live/step":
            steps = wish.get("steps", 1)
            if type(steps) is not int or not 0 < steps <= MOST_STEPS:
                raise ValueError
            return lambda: live.step(steps)
        if path == "live/set":
            key, text = wish.get("key"), wish.get("value")
            if not isinstance(key, str) or not isinstance(text, str):
                raise ValueError
            return lambda: live.set(key, text)
        found = {"live/pause": live.pause, "live/restart": live.restart}.get(path)
        if found is None:
            raise _Refusal(404, "there is no such command", "reload the page")
        return found

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: the terminal and the notebook are the user's."""


def _parts(failure: Exception) -> tuple[str, str]:
    what, _, hint = (str(failure) or type(failure).__name__).partition("\n  hint: ")
    return what if isinstance(failure, (Error, RuntimeError)) else f"{type(failure).__name__}: {what}", hint


def packed(frame: LiveFrame, columns: frozenset[str], run: int, rows: int) -> bytes:
    """A frame with some of its columns for the page: the length of a JSON text, the text, and the blocks of numbers where it says.

    :param run, rows: the run that the page knows, and as many rows of its series.
    """
    blocks: list[bytes] = []
    end = 0

    def place(array: np.ndarray[Any, Any]) -> int:
        nonlocal end
        start = end
        data = array.tobytes()
        blocks.append(data + b"\0" * (-len(data) % 8))
        end += len(blocks[-1])
        return start

    shown = [name for name in frame.columns if (name in columns or name in ("id", "x", "y")) and len(frame.columns[name]) == frame.head["count"]]
    series = frame.series[rows if run == frame.head["run"] else 0 :]
    stride = -(-len(series) // MOST_ROWS) or 1
    head = {
        **frame.head,
        "columns": [{"name": name, "type": str(frame.columns[name].dtype), "offset": place(frame.columns[name])} for name in shown],
        "fields": [{"name": name, "rows": field.shape[0], "columns": field.shape[1], "offset": place(field)} for name, field in frame.fields.items()],
        "series": {"rows": len(series), "kept": len(series[::stride]), "width": series.shape[1], "offset": place(series[::stride])},
    }
    text = json.dumps(_finite(head)).encode()
    text += b" " * (-(4 + len(text)) % 8)
    return b"".join([len(text).to_bytes(4, "little"), text, *blocks])


def _finite(value: Any) -> Any:
    """JSON knows no infinity and no NaN: null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    return [_finite(one) for one in value] if isinstance(value, (list, tuple)) else value
