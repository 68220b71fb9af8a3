"""Observers of sessions, against a real daemon."""

import os

import numpy as np
import pytest

import untangled_cloth as untangled
from conftest import DEADLINE
from untangled_cloth import observe


def open_session(mesh, domain, **more):
    return untangled.Session(mesh.triangles, domain=domain, timeout=DEADLINE, **more)


def watch(domain, **more):
    return observe.Observer(domain=domain, timeout=DEADLINE, **more)


def test_observers_see_what_the_host_sent_and_got(sheets, domain):
    masses = np.full(len(sheets.vertices), 0.01)
    with open_session(sheets, domain, masses=masses, paths=True, pins=[3]) as session:
        with watch(domain) as observer, watch(domain) as other:
            assert observer.latest() is None
            mesh = observer.mesh
            assert (mesh.num_vertices, mesh.pins.tolist(), mesh.body.tolist(), mesh.layers) == (800, [3], [], None)
            assert mesh.outwards is None
            assert (mesh.triangles == sheets.triangles).all() and mesh.correction == "force" and not mesh.double
            for frame in range(1, 4):
                correction = session.exchange(sheets.vertices + np.float32(frame), dt=0.01, deadline=DEADLINE)
                for seen in (observer.latest(DEADLINE), other.latest(DEADLINE)):
                    assert (seen.frame, seen.num_frames, seen.num_dropped) == (frame, frame, 0)
                    assert (seen.positions == sheets.vertices + np.float32(frame)).all()
                    assert (seen.corrections == correction.force).all() and seen.kind == "force"
                    assert (seen.flags == correction.flags).all() and seen.flags[3] == untangled.PINNED
                    assert (seen.paths.points == correction.paths.points).all() and len(seen.paths) > 0
                    assert (seen.paths.records[:, :7] == correction.paths.records[:, :7]).all()
                    assert {path.state for path in seen.paths} == {"region"}
                    assert {path.state for path in correction.paths} == {"unknown"}
                    assert (np.unique(seen.inside[:, 0]) == np.flatnonzero(seen.flags & untangled.INSIDE)).all()
                    assert len(seen.depths) == seen.paths.records[:, 0].max() + 1 and seen.depths.max() > 0
                    assert seen.refused is None and 0 <= seen.age < DEADLINE
                    header = {name: seen.summary[name] for name in correction.summary}
                    assert header == correction.summary
                    with pytest.raises(ValueError, match="read-only"):
                        seen.positions[0] = 0


def test_frames_that_are_refused_and_missed_are_told(crossed, domain):
    with open_session(crossed, domain) as session, watch(domain) as observer:
        with pytest.raises(untangled.FrameRefused):
            session.exchange(np.full((6, 3), np.nan), deadline=DEADLINE)
        seen = observer.latest(DEADLINE)
        assert "vertex 0" in seen.refused and seen.positions.shape == (0, 3) and len(seen.corrections) == 6
        for _ in range(5):
            session.exchange(crossed.vertices, deadline=DEADLINE)
        num_seen = 0
        while seen.num_frames < 6:
            seen = observer.latest(DEADLINE)
            num_seen += 1 + seen.num_dropped
        assert num_seen == 5 and seen.refused is None


def test_status_and_sessions_name_observers_and_hosts(crossed, domain):
    with open_session(crossed, domain):
        with watch(domain, name="a viewer"):
            (found,) = observe.sessions(domain, DEADLINE)
            assert found["observers"] == [{"pid": os.getpid(), "name": "a viewer"}]
            assert found["host"]["pid"] == os.getpid() and found["num_vertices"] == 6
            assert untangled.status(domain=domain)["sessions"][0]["observers"] == found["observers"]
        with open_session(crossed, domain):
            ids = [session["session"] for session in observe.sessions(domain, DEADLINE)]
            with pytest.raises(untangled.Error, match=f"sessions {ids[0]}, {ids[1]}"):
                watch(domain)
            with watch(domain, session=ids[1]) as observer:
                assert observer.session["session"] == ids[1]
    with pytest.raises(untangled.Refused, match="no session 99"):
        watch(domain, session=99)


def test_an_observer_hears_of_the_end_and_finds_its_session_again(crossed, daemon):
    with open_session(crossed, daemon.domain) as session, watch(daemon.domain) as observer:
        session.exchange(crossed.vertices, deadline=DEADLINE)
        assert observer.latest(DEADLINE).frame == 1
        daemon.stop(kill=True)
        with pytest.raises(observe.SessionEnded, match="went away"):
            observer.latest(DEADLINE)
        daemon.start()
        seen = None
        while session.num_registrations < 2:
            try:
                session.exchange(crossed.vertices, deadline=0.5)
            except untangled.Missed:
                pass
        observer.reopen(DEADLINE)
        while seen is None:
            try:
                session.exchange(crossed.vertices, deadline=0.5)
            except untangled.Missed:
                continue
            seen = observer.latest(0.5)
        assert seen.num_dropped <= 1
        session.close()
        with pytest.raises(observe.SessionEnded, match="has ended"):
            observer.latest(DEADLINE)
    with pytest.raises(untangled.Error, match="closed"):
        observer.latest()
