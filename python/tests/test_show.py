"""A simulation that is shown in the browser, asked as the page asks it."""

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import types
import urllib.parse

import numpy as np
import pytest

import gridlock
import gridlock.live
import gridlock.playground
import gridlock.show
from conftest import OBLONG
from gridlock.commands.show import main, model_in
from gridlock.controls import controls

show_module = sys.modules["gridlock.show"]


class Drifters(gridlock.Model):
    """Agents that drift over grass.

    What follows is not shown.
    """

    name = "test_drifters"
    columns = {"health": np.uint32, "mood": np.float64}
    value_names = {"health": ("well", "ill")}
    fields = {"grass": gridlock.Field((3, 5))}
    events = ("hops",)
    charts = {"People": ("ill", "well")}
    count = gridlock.Setting(20, "Agents.", least=1, most=1000)
    length = gridlock.Setting(0.01, "A step.", unit="length", least=0.0)
    way = gridlock.Setting("east", "Where they drift.", choices=("east", "north"))
    breaks = gridlock.Setting(False)

    def start(self, start):
        start.add(positions=start.anywhere(self.count), health=np.arange(self.count) % 2)
        start.grass[...] = np.arange(15).reshape(3, 5)

    def step(self, world):
        if self.breaks and world.clock.step == 3:
            raise ValueError("no grass")
        world.move(np.full((len(world), 2), self.length) * ((1, 0) if self.way == "east" else (0, 1)))
        world.count("hops")

    def observe(self, world):
        return {"well": float((world.health == 0).sum()), "ill": float((world.health == 1).sum()), "mean_x": float(world.x.mean())}


class Page:
    """What a page asks of the server."""

    def __init__(self, url):
        self.url = urllib.parse.urlsplit(url)
        self.connection = http.client.HTTPConnection(self.url.netloc, timeout=20)

    def ask(self, path, method="GET", body=None, **headers):
        self.connection.request(method, path if path.startswith("/") else self.url.path + path, body, headers)
        answer = self.connection.getresponse()
        return answer.status, answer.read(), answer.headers

    def tell(self, command, **wish):
        status, text, _ = self.ask(f"live/{command}", "POST", json.dumps(wish))
        return status, json.loads(text)

    def about(self):
        return json.loads(self.ask("live/about.json")[1])

    def frame(self, after=0, run=0, rows=0, columns="health"):
        status, data, _ = self.ask(f"live/frame?after={after}&run={run}&rows={rows}&columns={columns}")
        assert status == 200
        length = int.from_bytes(data[:4], "little")
        head = json.loads(data[4 : 4 + length])

        def block(offset, kind, count):
            return np.frombuffer(data, kind, count, 4 + length + offset)

        arrays = {one["name"]: block(one["offset"], one["type"], head["count"]) for one in head["columns"]}
        fields = {one["name"]: block(one["offset"], "float32", one["rows"] * one["columns"]).reshape(one["rows"], -1) for one in head["fields"]}
        series = head["series"]
        rows_of_series = block(series["offset"], "float64", series["kept"] * series["width"]).reshape(series["kept"], series["width"])
        return head, arrays, fields, rows_of_series

    def until(self, is_so):
        frame = self.frame()
        while not is_so(frame[0]):
            frame = self.frame(frame[0]["version"])
        return frame


@pytest.fixture
def page_folder(tmp_path, monkeypatch):
    folder = tmp_path / "page"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<html><head></head></html>")
    (folder / "assets" / "page.js").write_text("1")
    monkeypatch.setattr(show_module, "find_folder", lambda: os.fspath(folder))
    return folder


@pytest.fixture
def shown(page_folder):
    one = gridlock.show(Drifters(count=12), box=OBLONG, block=False)
    yield one
    one.close()


def test_the_page_learns_of_columns_charts_and_settings(shown):
    about = Page(shown.url).about()
    assert about["documentation"] == "Agents that drift over grass." and about["valueNames"] == {"health": ["well", "ill"]}
    assert about["columns"] == ["x", "y", "health", "mood"] and about["fields"] == ["grass"]
    assert about["charts"] == [{"title": "People", "names": ["ill", "well"]}, {"title": "mean_x", "names": ["mean_x"]}]
    assert about["values"]["test_drifters.count"] == 12 and about["values"]["box.width"] == OBLONG["width"]
    settings = {one["key"]: one for one in about["settings"]}
    assert settings["test_drifters.length"] == {"key": "test_drifters.length", "kind": "number", "unit": "length", "documentation": "A step.",
                                                "least": 0.0, "most": None, "leastIsAllowed": True, "mostIsAllowed": True, "choices": [],
                                                "restarts": False}
    assert [key for key in ("test_drifters.count", "test_drifters.way", "box.edge", "run.seed") if settings[key]["restarts"]] == [
        "test_drifters.count", "box.edge", "run.seed"]
    assert settings["test_drifters.way"]["choices"] == ["east", "north"] and settings["test_drifters.breaks"]["kind"] == "switch"


def test_a_frame_is_the_state_of_the_simulation(shown):
    page = Page(shown.url)
    assert page.tell("step", steps=3)[0] == 200
    head, arrays, fields, series = page.frame(columns="health,mood")
    frame = shown.simulation.frame
    assert head["step"] == 3 and head["count"] == 12 and not head["isRunning"]
    assert head["box"] == {"width": 1.5, "height": 0.6, "periodic": [True, True], "shift": 0.0}
    assert head["stateHash"] == shown.simulation.state_hash
    assert arrays["id"].tolist() == frame.ids.tolist() and np.array_equal(arrays["x"], frame.x.astype(np.float32))
    assert np.array_equal(arrays["health"], frame.health) and np.array_equal(arrays["mood"], frame.mood)
    assert np.array_equal(fields["grass"], np.arange(15).reshape(3, 5))
    assert series.shape == (4, len(page.about()["quantities"])) and series[:, 0].tolist() == [0, 1, 2, 3]
    # A page that knows three rows gets the fourth.
    assert page.frame(run=head["run"], rows=3)[3][:, 0].tolist() == [3]


def test_a_model_that_is_watched_has_the_bits_of_one_that_is_not(shown):
    page = Page(shown.url)
    page.tell("run", stepsPerSecond=None)
    page.until(lambda head: head["step"] > 50)
    page.tell("pause")
    watched = shown.simulation
    alone = gridlock.Simulation(model=Drifters(count=12), box=OBLONG)
    alone.run(steps=watched.clock.step)
    assert watched.state_hash == alone.state_hash


def test_a_run_keeps_the_speed_that_is_asked_for(shown):
    page = Page(shown.url)
    began = time.monotonic()
    page.tell("run", stepsPerSecond=100)
    page.until(lambda head: head["step"] >= 21)
    assert time.monotonic() - began >= 0.2  # of a machine of any speed


def test_a_changed_setting_begins_anew_and_a_refused_one_leaves_the_run(shown):
    page = Page(shown.url)
    page.tell("step")
    assert page.tell("set", key="test_drifters.count", value="30")[0] == 200
    head = page.frame()[0]
    assert head["count"] == 30 and head["step"] == 0 and head["run"] == 2 and page.about()["run"] == 2
    for key, value, what in [("test_drifters.count", "0", "at least 1"), ("test_drifters.count", "x", "whole number"),
                             ("test_drifters.way", "up", "east"), ("no.such", "1", "no setting"), ("test_drifters.breaks", "perhaps", "true or false")]:
        status, said = page.tell("set", key=key, value=value)
        assert status == 422 and what in said["error"] + said["hint"]
    assert page.frame()[0]["count"] == 30
    assert page.tell("restart")[0] == 200
    assert page.frame()[0]["count"] == 30  # a restart keeps what was changed


def test_a_setting_that_the_start_does_not_read_changes_in_the_run(shown):
    page = Page(shown.url)
    page.tell("step", steps=3)
    assert page.tell("set", key="test_drifters.length", value="0.03")[0] == 200
    head, about = page.frame()[0], page.about()
    assert (head["run"], head["step"], head["changes"]) == (1, 3, 1) and about["values"]["test_drifters.length"] == 0.03
    assert about["changes"] == [{"step": 3, "key": "test_drifters.length", "before": 0.01, "value": 0.03}]
    assert "at least 0" in page.tell("set", key="test_drifters.length", value="-1")[1]["error"]
    page.tell("step", steps=2)
    again = gridlock.Simulation(model=Drifters(count=12), box=OBLONG)
    again.run(steps=3)
    again.change(test_drifters={"length": 0.03})
    again.run(steps=2)
    assert shown.simulation.state_hash == again.state_hash and page.frame()[3].shape[0] == 6
    # What its user changes is seen; a restart begins with the newest values, whoever has chosen them.
    shown.simulation.change({"test_drifters.way": "north"})
    assert page.until(lambda head: head["changes"] == 2)[0]["step"] == 5 and page.about()["values"]["test_drifters.way"] == "north"
    page.tell("restart")
    about = page.about()
    assert about["changes"] == [] and about["values"]["test_drifters.length"] == 0.03 and about["values"]["test_drifters.way"] == "north"


def test_a_model_that_raises_pauses_with_file_and_line_and_can_begin_anew(shown):
    page = Page(shown.url)
    page.tell("set", key="test_drifters.breaks", value="true")
    page.tell("run", stepsPerSecond=None)
    head = page.until(lambda head: head["problem"])[0]
    assert head["step"] == 3 and not head["isRunning"]
    assert "raised ValueError: no grass (test_show.py, line " in head["problem"]
    page.tell("set", key="test_drifters.breaks", value="false")
    page.tell("step", steps=5)
    assert page.frame()[0]["step"] == 5 and page.frame()[0]["problem"] == ""


def test_two_pages_share_one_frame(shown, monkeypatch):
    pages = [Page(shown.url), Page(shown.url)]
    version = pages[0].frame(columns="health,mood")[0]["version"]
    made = []
    make = gridlock.live.LiveFrame
    monkeypatch.setattr(gridlock.live, "LiveFrame", lambda *parts: made.append(make(*parts)) or made[-1])
    found = []
    threads = [threading.Thread(target=lambda page=page: found.append(page.frame(version, columns="mood")[0])) for page in pages]
    for thread in threads:
        thread.start()
    while len(shown._live._wishes) < 2:
        time.sleep(0.005)
    Page(shown.url).tell("step")
    for thread in threads:
        thread.join()
    assert [head["step"] for head in found] == [1, 1] and len(made) == 1


def test_nothing_is_made_where_no_page_asks(shown):
    page = Page(shown.url)
    before = page.frame()[0]["version"]
    page.tell("run", stepsPerSecond=None)
    time.sleep(0.2)
    page.tell("pause")
    assert shown._live._frame.version == before and shown.simulation.clock.step > 0


@pytest.mark.parametrize("speed", [None, 100])
def test_a_run_that_nobody_looks_at_pauses(shown, monkeypatch, speed):
    monkeypatch.setattr(gridlock.live, "PATIENCE", 0.05)
    Page(shown.url).tell("run", stepsPerSecond=speed)
    end = time.monotonic() + 5
    while shown._live._is_running and time.monotonic() < end:
        time.sleep(0.02)
    assert not shown._live._is_running


def test_a_run_of_the_user_is_followed(shown):
    page = Page(shown.url)
    version = page.frame()[0]["version"]
    shown.simulation.run(steps=7)
    assert page.until(lambda head: head["step"] == 7)[0]["version"] > version


def test_other_sites_names_addresses_and_requests_are_refused(shown):
    page = Page(shown.url)
    host = page.url.netloc
    assert page.ask("live/about.json", Host="evil.example")[0] == 403
    assert page.ask("live/about.json", Host=f"evil.example:{page.url.port}")[0] == 403
    assert page.ask("live/pause", "POST", "{}", Host=host, Origin="http://evil.example")[0] == 403
    assert page.ask("live/pause", "POST", "{}", Host=host, Origin=f"http://{host}")[0] == 200
    assert page.ask("/")[0] == 404 and page.ask("/live/about.json")[0] == 404 and page.ask("/wrong/live/about.json")[0] == 404
    assert page.ask("../../../etc/passwd")[0] == 404 and page.ask("nothing")[0] == 404
    assert page.ask("live/about.json", "PUT")[0] == 501
    for command, body in [("run", b'{"stepsPerSecond": 0}'), ("run", b'{"stepsPerSecond": NaN}'), ("step", b'{"steps": -1}'), ("step", b"["),
                          ("set", b'{"key": 1}'), ("set", b"[" * 10_000)]:
        assert page.ask(f"live/{command}", "POST", body)[0] == 400, (command, body)
    assert page.ask("live/step", "POST", b"x" * 70_000)[0] == 413 and page.ask("live/fly", "POST", b"{}")[0] == 404
    assert page.ask("live/frame?after=x")[0] == 400
    assert page.about()["name"] == "test_drifters"


def test_the_page_is_served_with_the_place_of_its_model_and_strict_headers(shown):
    page = Page(shown.url)
    status, text, headers = page.ask("")
    assert status == 200 and b'<meta name="gridlock-live" content="./live/">' in text
    assert headers["Cache-Control"] == "no-store" and headers["Referrer-Policy"] == "no-referrer" and "script-src 'self'" in headers["Content-Security-Policy"]
    assert page.ask("assets/page.js")[:2] == (200, b"1")
    assert page.url.hostname == "127.0.0.1" and len(page.url.path) > 20


def test_a_model_that_was_closed_answers_nobody(shown):
    page = Page(shown.url)
    waiting = []
    version = page.frame()[0]["version"]
    thread = threading.Thread(target=lambda: waiting.append(page.ask(f"live/frame?after={version}")[0]))
    thread.start()
    while not shown._live._wishes:
        time.sleep(0.005)
    shown.close()
    thread.join()
    assert waiting == [410]
    with pytest.raises(gridlock.Error, match="shown no more"):
        shown.simulation  # noqa: B018
    with pytest.raises(OSError):
        Page(shown.url).ask("")
    assert repr(shown) == "<gridlock.Shown closed>"
    shown.close()


def test_a_step_without_end_is_told_and_hangs_nobody(page_folder, monkeypatch):
    monkeypatch.setattr(gridlock.live, "PATIENCE_OF_COMMANDS", 0.05)
    monkeypatch.setattr(gridlock.live, "PATIENCE_OF_CLOSE", 0.05)
    end = threading.Event()

    class Endless(Drifters):
        name = "test_endless"

        def step(self, world):
            end.wait(20)

    one = gridlock.show(Endless, block=False)
    assert "has been at one step" in Page(one.url).tell("step")[1]["error"]
    with pytest.raises(gridlock.Error, match="does not come to the end of its step"):
        one.close()
    end.set()


def test_a_notebook_gets_the_page_in_its_cell_and_a_script_waits(page_folder, monkeypatch):
    cells, waits = [], []
    display = types.SimpleNamespace(IFrame=lambda *parts: parts, display=cells.append)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    monkeypatch.setattr(gridlock.Shown, "wait", lambda self: waits.append(self))
    monkeypatch.setattr(show_module, "_is_in_notebook", lambda: True)
    with gridlock.show(Drifters, height=500) as one:
        assert cells == [(one.url, "100%", 500)] and waits == []
    monkeypatch.setattr(show_module, "_is_in_notebook", lambda: False)
    monkeypatch.setattr(show_module, "_is_at_prompt", lambda: False)
    with gridlock.show(Drifters) as one:
        assert waits == [one] and len(cells) == 1


def test_settings_and_files_are_shown_too(page_folder, tmp_path):
    file = tmp_path / "disks.toml"
    file.write_text("disks.count = 16\ndisks.packing_fraction = 0.2\nobserve.every = 5\n")
    for settings, more, every in [(file, {"disks": {"count": 9}}, 5), ({"model.kind": "flocking", "flocking.count": 9}, {}, 1)]:
        one = gridlock.show(settings, block=False, **more)
        page = Page(one.url)
        page.tell("step", steps=5)
        head, _, _, series = page.frame()
        assert head["count"] == 9 and series[:, 0].tolist() == list(range(0, 6, every))
        one.close()


def test_what_cannot_be_shown_is_refused(page_folder, monkeypatch):
    with pytest.raises(gridlock.Error, match="a int cannot be shown"):
        gridlock.show(3, block=False)
    with pytest.raises(gridlock.Error, match="at least 1"):
        gridlock.show(Drifters(count=0), block=False)
    with pytest.raises(gridlock.Error, match="port 70000 cannot be had"):
        gridlock.show(Drifters, port=70_000, block=False)

    class Lost(Drifters):
        name = "test_lost"
        charts = {"People": ("dead",)}

    with pytest.raises(gridlock.Error, match="the chart 'People' of the model test_lost has a curve 'dead'"):
        gridlock.Simulation(model=Lost)

    class Crowded(Drifters):
        name = "test_crowded"
        charts = {"People": "ill"}

    with pytest.raises(gridlock.Error, match="has the curves 'ill'"):
        gridlock.register_model(Crowded)
    monkeypatch.setattr(show_module, "find_folder", lambda: None)
    with pytest.raises(gridlock.Error, match="./dev build-web"):
        gridlock.show(Drifters, block=False)


def test_every_setting_has_a_control_of_its_kind():
    known = {one.key: one for one in controls()}
    fraction = known["disks.packing_fraction"]
    assert (fraction.kind, fraction.least, fraction.most, fraction.leastIsAllowed, fraction.mostIsAllowed) == ("number", 0.0, 2.0, False, True)
    assert known["disks.count"].kind == "integer" and known["propulsion.speed"].unit == "length / time"
    assert known["thermostat.rate"].unit == "1 / time" and known["box.edge"].choices == ["wall", "periodic"]
    assert (known["test_drifters.breaks"].kind, known["test_drifters.breaks"].documentation) == ("switch", "")
    assert {one.kind for one in known.values()} == {"number", "integer", "switch", "text", "choice"}


def test_the_command_finds_the_model_of_a_file_or_says_in_which_line_it_fails(page_folder, tmp_path, capsys):
    file = tmp_path / "two.py"
    file.write_text("import gridlock\nclass A(gridlock.Model):\n    name = 'a'\nclass B(gridlock.Model):\n    name = 'b'\n"
                    "if __name__ == '__main__':\n    raise SystemExit(3)\n")
    assert model_in(file, "b").name == "b"
    assert main([os.fspath(file)]) == 2 and "has the models a, b" in capsys.readouterr().err
    assert main([os.fspath(file), "--model", "c"]) == 2 and "has no model c" in capsys.readouterr().err
    assert main([os.fspath(tmp_path / "none.py")]) == 2 and "cannot be read" in capsys.readouterr().err
    assert main([os.fspath(file), "--set", "x"]) == 2 and "--set x sets nothing" in capsys.readouterr().err
    for text, words in [("import gridlock\nx = 1 / 0\n", "error: ZeroDivisionError: division by zero (two.py, line 2)\n"),
                        ("def f(:\n", "error: SyntaxError: invalid syntax (two.py, line 1)\n"),
                        ("import gridlock\n\nx = gridlock.Setting(-1)\n", "error: a setting has the default -1 (two.py, line 3)\n  hint: whole"),
                        ("import missing_module\n", "error: ModuleNotFoundError: No module named 'missing_module' (two.py, line 1)\n"),
                        (MODEL.replace("COUNT", "1 // 0"), "error: ZeroDivisionError: integer division or modulo by zero (two.py, line 5)\n")]:
        file.write_text(text)
        assert main([os.fspath(file), "--no-open"]) == 2
        assert capsys.readouterr().err.startswith(words)
    assert main(["a.toml", "b.toml"]) == 2 and "settings follow a file of Python" in capsys.readouterr().err


def test_the_model_of_the_page_runs(root, tmp_path):
    page = (root / "docs/how_to/show.md").read_text()
    file = tmp_path / "epidemic.py"
    file.write_text(re.search(r"```python\n(# epidemic.py.*?)```", page, re.DOTALL)[1])
    simulation = show_module.simulation_of(model_in(file), {"box": OBLONG}, {"contagion.count": 300})
    simulation.run(steps=40)
    people = [simulation.series[name][-1] for name in ("susceptible", "infected", "recovered")]
    assert sum(people) == 300 and people[2] > 0


MODEL = """import gridlock
class Standing(gridlock.Model):
    name = "standing"
    def start(self, start):
        start.add(positions=start.anywhere(COUNT))
    def step(self, world):
        pass
"""


def test_the_command_shows_a_file_reads_it_again_at_a_restart_and_ends_by_ctrl_c(page_folder, tmp_path):
    file = tmp_path / "model.py"
    file.write_text(MODEL.replace("COUNT", "3"))
    start = f"import sys; import gridlock.show; sys.modules['gridlock.show'].find_folder = lambda: {os.fspath(page_folder)!r}; " \
            "from gridlock.commands.show import main; sys.exit(main(sys.argv[1:]))"
    words = [sys.executable, "-c", start, os.fspath(file), "--set", "box.edge=periodic", "--no-open"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "the model is shown at\n"
        page = Page(process.stdout.readline().strip())
        assert page.frame()[0]["count"] == 3 and page.frame()[0]["box"]["periodic"] == [True, True]
        file.write_text(MODEL.replace("COUNT", "30"))
        page.tell("restart")
        assert page.frame()[0]["count"] == 30
        file.write_text("class Standing(\n")
        status, said = page.tell("restart")
        assert status == 422 and "SyntaxError" in said["error"] and page.frame()[0]["count"] == 30
        page.tell("run", stepsPerSecond=None)
        process.send_signal(signal.SIGINT)
        assert process.wait(10) == 0
