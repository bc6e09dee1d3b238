"""What a hostile page, name, title or connection can do to ``raceway app``: nothing."""

import asyncio
import http.client
import json
import os
import shlex
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from raceway_app.picture import Curves, at_rest, axes_of, form, result_picture, titles_of
from raceway_app.picture import panel as panel_of
from raceway_app.session import Session, groups
from raceway_app.worker import Job, News, Worker

import raceway as rw
from checks.validation.browser.application import Application, proportional_memory
from checks.validation.command_line import EXAMPLES, PATIENCE_S
from raceway import PointStatus
from raceway.extend import as_given, default_registry, plugin_quantities

SCENE = str(EXAMPLES / "b7206.toml")


@pytest.fixture(scope="module")
def application(tmp_path_factory):
    with Application(tmp_path_factory.mktemp("app") / "files", SCENE) as served:
        yield served


def curves(scene, drawn=None, few=True):
    """Of a scene by axis and panel, with the numbers of its run."""
    result = rw.run(scene)
    parts = scene, form(scene), titles_of(result), axes_of(scene, {})
    panels = (drawn or Curves()).draw(parts, lambda: None, few=few)
    return {(panel["axis"], panel["panel"]): panel for panel in panels}, result


def test_condensed_bodies_have_all_curves_and_the_stiffness_of_their_run():
    rigid, condensed = (curves(rw.load_scene(SCENE, [f"bodies.kind={kind}"])) for kind in ("rigid", "condensed"))
    assert rigid[0].keys() - {("speed", "damping")} <= condensed[0].keys()  # their C is below its error
    for panels, result in (rigid, condensed):
        for axis in ("speed", "load"):
            panel = panels[axis, "stiffness"]
            now = panel["lines"][0]["y"][panel["x"].index(panel["present"])]
            assert 1e6 * now == pytest.approx(result.equivalent_stiffness, rel=1e-6)


@pytest.mark.parametrize("change", [
    "load.axial=700", pytest.param("excitation.unbalance=3e-4", marks=pytest.mark.slow),
    "bearing.contact_angle_deg=18", pytest.param("rotor.mass=3", marks=pytest.mark.slow),
])  # fmt: skip
def test_curves_after_a_change_are_those_of_the_changed_scene(change):
    drawn, changed = Curves(), rw.load_scene(SCENE, [change])
    before = curves(rw.load_scene(SCENE), drawn, few=False)[0]
    for _ in range(2):  # a function is built for the number that has changed, then used again
        (after, _), (fresh, result) = (curves(changed, one, few=False) for one in (drawn, None))
        for key, panel in fresh.items():
            assert after[key]["x"] == panel["x"] and len(panel["missing"]) < 10
            for line, other in zip(panel["lines"], after[key]["lines"], strict=True):
                # Orbits are solved to 1e-11 of the motion: Z is known to that, and C w is 7e-10 of it at the least speed.
                least = fresh["speed", "damping"]["x"][0] * np.pi / 30.0
                within = 1e-11 * result.equivalent_stiffness / least if key[1] == "damping" else 0.0
                np.testing.assert_allclose(
                    np.array(other["y"], float), np.array(line["y"], float), rtol=0.0 if within else 1e-5, atol=within
                )
    assert fresh["speed", "ball load"]["lines"][0]["y"][-1] != pytest.approx(
        before["speed", "ball load"]["lines"][0]["y"][-1], rel=1e-3
    )


def test_the_picture_of_a_run_is_in_the_units_that_it_is_labelled_with():
    scene = rw.load_scene(SCENE, ["bearing.arrangement=DB", "bearing.preload=300", "bearing.row_distance=0.016"])
    panels, result = curves(scene)
    content = result_picture(result, at_rest(result))
    # The path of the last turn [um], and loads of both races by azimuth [deg]
    motion = 1e6 * result.to_xarray()["motion"].values[:, 1:3]
    assert np.ptp(content["orbit"], axis=0) == pytest.approx(np.ptp(motion, axis=0), rel=1e-3)
    balls = result.content["equilibrium"]["balls"]
    assert content["polar"] == [[ball[name] for name in ("azimuth_deg", "load_inner_n", "load_outer_n")] for ball in balls]
    # What the rows of a pair push apart with differs by the load on the shaft.
    first, second = (np.array(line["y"], float) for line in panels["speed", "axial force of rows"]["lines"])
    np.testing.assert_allclose(np.abs(first - second), scene.load.axial, rtol=1e-6)


def test_curves_run_over_the_scene_and_temperatures_are_in_celsius():
    axis = axes_of(rw.load_scene(SCENE), {"load": (100.0, 400.0)})["load"]
    assert axis.low == 100.0 and axis.high >= axis.present == 1000.0 and axis.present in axis.numbers()
    status, quantities = np.array([PointStatus.COMPUTED, PointStatus.FAILED]), plugin_quantities(default_registry())
    answer = {"status": status, "points": status, "reason": ["", "why"], "temperature_inner_k": np.array([300.0, 310.0])}
    panel = panel_of(
        "speed", axis, "temperature", ["temperature_inner_k"], answer, {n: q for n, (_, q) in quantities.items()}
    )
    assert panel["lines"][0]["y"] == [pytest.approx(26.85), None]
    assert (panel["unit"], panel["missing"], panel["why"]) == ("°C", [PointStatus.FAILED], "why")


def status(application, path: str, host: str = "", **headers: str) -> int:
    """Of a GET request."""
    connection = http.client.HTTPConnection("127.0.0.1", application.port, timeout=PATIENCE_S)
    try:
        connection.request("GET", path, headers={"Host": host or f"127.0.0.1:{application.port}", **headers})
        return connection.getresponse().status
    finally:
        connection.close()


def test_only_this_machine_can_connect(application):
    listening = Path("/proc/net/tcp").read_text().splitlines()
    port = f":{application.port:04X}"
    addresses = {line.split()[1] for line in listening if line.split()[1].endswith(port) and line.split()[3] == "0A"}
    assert addresses == {f"0100007F{port}"}


@pytest.mark.parametrize(("host", "headers"), [
    ("", {"Cookie": ""}), ("evil.example", {"token": "right"}), ("127.0.0.1.evil.example:80", {"token": "right"}),
    ("", {"Origin": "http://evil.example", "token": "right"}),
], ids=["no token", "other host", "host with our address in its name", "page of another origin"])  # fmt: skip
@pytest.mark.parametrize("path", ["/", "/index.html", "/raceway/app.js", "/ws"])
def test_others_are_refused(application, host, headers, path):
    token = f"?token={application.token}" if headers.pop("token", "") else ""
    assert status(application, path + token, host, **headers) == 403


def test_the_token_opens_the_page_and_a_wrong_one_does_not(application):
    assert status(application, f"/index.html?token={application.token}") == 200
    assert (
        status(application, f"/index.html?token={application.token[:-1]}{'x' if application.token[-1] == 'y' else 'y'}")
        == 403
    )
    assert len(application.token) >= 32


@pytest.mark.parametrize("path", [
    "/raceway/../../pyproject.toml", "/raceway/%2e%2e/%2e%2e/pyproject.toml", "/raceway//etc/passwd",
    "/..%2f..%2fetc/passwd",
])  # fmt: skip
def test_no_path_leads_out_of_the_served_files(application, path):
    assert status(application, f"{path}?token={application.token}") in (403, 404)


@pytest.mark.parametrize("title", ["../out", "/tmp/out", "a/b", "..", "a\x00b", "a\nb = ../c"])
def test_files_stay_in_the_folder_and_replace_none(tmp_path, title):
    session = Session((as_given(SCENE),), tmp_path / "in")
    session.change([0], "title", json.dumps(title))
    first, second = session.save(0), session.save(0)
    assert first != second and {first.parent, second.parent} == {tmp_path / "in"}
    assert sorted(tmp_path.rglob("*.toml")) == sorted([first, second])


def test_a_saved_scene_and_a_copied_command_are_the_scene(tmp_path):
    session = Session((as_given(SCENE),), tmp_path)
    for key, text in (("load.axial", "1.25 kN"), ("excitation.kind", "unidirectional"), ("load.radial", "[10, 0]")):
        session.change([0], key, text)
    path, scene = session.save(0), session.checked(0)[0]
    assert path.parent == tmp_path
    numbers = scene.to_dict() | {"title": ""}
    assert rw.load_scene(path).to_dict() | {"title": ""} == numbers
    raceway, run, file, *settings = shlex.split(session.command(0))
    assert (raceway, run, settings[::2]) == ("raceway", "run", ["--set"] * len(settings[1::2]))
    assert rw.load_scene(file, settings[1::2]).to_dict() | {"title": ""} == numbers
    session.change([0], "rotor.mass", "")
    assert session.command(0) == ""  # --set takes no key out
    assert Session((as_given(path.read_text()),), tmp_path).command(0) == ""  # no file


def test_another_kind_takes_the_keys_that_it_lacks_with_it(tmp_path):
    session = Session((as_given(SCENE),), tmp_path)
    session.change([0], "excitation.kind", "run_up")
    keys = session.scenes[0].merged()["excitation"]
    assert "reference_speed_rpm" not in keys
    paths = [path for path, _ in session.checked(0)[1]]
    fields = {field["path"] for group in groups(session.scenes[0]) for field in group["fields"]}
    assert set(paths) <= fields


@pytest.mark.slow
def test_a_worker_that_was_killed_is_replaced(tmp_path):
    session, news, ended = Session((as_given(SCENE),), tmp_path), [], threading.Event()

    def hear(report: News) -> None:
        news.append(report)
        if report.kind == "done":
            ended.set()

    worker = Worker([], hear)
    try:
        for _ in range(2):
            ended.clear()
            worker.submit(Job(0, {0: (0, session.scenes[0])}))
            assert ended.wait(PATIENCE_S)
            before = worker.process_id
            os.kill(before, signal.SIGKILL)  # as the system does where memory runs out
            end = time.monotonic() + PATIENCE_S
            while worker.process_id == before:
                assert time.monotonic() < end
                time.sleep(0.02)
        kinds = [report.kind for report in news if report.kind != "progress"]
        assert kinds.count("done") == 2 and set(kinds) == {"picture", "done"}
    finally:
        worker.close()


def test_broken_connections_and_messages_leave_the_server_alive(application):
    import aiohttp

    async def attack() -> None:
        cookies = {f"raceway_{application.port}": application.token}
        address = f"http://127.0.0.1:{application.port}/ws"
        async with aiohttp.ClientSession(cookies=cookies) as session:
            for message in (b"", b"\x00" * 100, b"\xff" * 5000, os.urandom(3000)):
                async with session.ws_connect(address) as socket:
                    await socket.send_bytes(message)
                    await socket.send_str("{not json")
            socket = await session.ws_connect(address)
            socket._response.connection.transport.abort()  # a cable that is pulled

    asyncio.run(attack())
    assert status(application, f"/index.html?token={application.token}") == 200


def flood(application, requests: int) -> None:
    """So many requests without a token, then one with it."""
    connection = http.client.HTTPConnection("127.0.0.1", application.port, timeout=PATIENCE_S)
    for _ in range(requests):
        connection.request("GET", "/index.html?token=guess")
        response = connection.getresponse()
        response.read()
        assert response.status == 403
    connection.close()
    assert status(application, f"/index.html?token={application.token}") == 200


@pytest.mark.parametrize(
    ("first", "count", "bound"),
    [pytest.param(300, 1000, 5e6, marks=pytest.mark.slow), pytest.param(1000, 100_000, 10e6, marks=pytest.mark.night)],
)
def test_many_requests_are_refused_and_cost_no_memory(application, first, count, bound):
    flood(application, first)
    before = proportional_memory(application.process.pid)
    flood(application, count)
    assert proportional_memory(application.process.pid) - before < bound  # a leak of a request's 5 kB would be more
