"""Sessions against a real daemon."""

import contextlib
import gc
import threading
import time

import numpy as np
import pytest

import untangled_cloth as untangled
from conftest import DEADLINE


def open_session(mesh, domain, **more):
    return untangled.Session(mesh.triangles, domain=domain, timeout=DEADLINE, **more)


def test_exchange_of_crossed_triangles_reports_counts_flags_and_summary(crossed, domain):
    with open_session(crossed, domain, masses=np.full(6, 0.1), paths=True) as session:
        correction = session.exchange(crossed.vertices, dt=0.01, deadline=DEADLINE)
        assert session.num_vertices == 6 and session.correction == "force" and correction.kind == "force"
        assert correction.frame == session.last_frame == 1 and session.num_registrations == 1
        assert correction.num_intersections == 2 and correction.num_inside == 1
        assert correction.inside.tolist() == [False] * 5 + [True]
        assert correction.mask[5] and correction.flags[5] & untangled.INSIDE
        assert correction.force.shape == (6, 3) and correction.force.dtype == np.float32
        assert correction.summary["num_pairs"] == {"BB/II": 1} and correction.summary["stage_ns"]["total"] > 0
        assert "2 intersections" in repr(correction)


def test_vertices_of_a_body_get_no_corrections_and_a_mixed_triangle_is_refused(crossed, domain):
    with open_session(crossed, domain, body=[3, 4, 5]) as session:
        correction = session.exchange(crossed.vertices, deadline=DEADLINE)
        assert correction.num_intersections == 2 and not correction.value[3:].any()
        assert (correction.flags & untangled.PINNED != 0).tolist() == [False] * 3 + [True] * 3
    with pytest.raises(untangled.Refused, match="face 1"):
        open_session(crossed, domain, body=[3, 4])


def test_vertices_in_one_place_at_rest_are_one_where_weld_asks_for_it(domain):
    rest = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], float)
    triangles = [[0, 1, 2], [3, 4, 5]]
    folded = rest.copy()
    folded[4] = 1, 1, 1
    for weld in (False, True):
        session = untangled.Session(triangles, rest_positions=rest, weld=weld, domain=domain, timeout=DEADLINE)
        with session:
            assert session.num_welded_vertices == (2 if weld else 0) and session.num_vertices == 6
            assert not weld or session.exchange(folded, deadline=DEADLINE).num_intersections == 0
            if weld:
                folded[3, 2] = 1
                with pytest.raises(untangled.FrameRefused, match="vertex 3"):
                    session.exchange(folded, deadline=DEADLINE)
    with pytest.raises(untangled.Refused, match="rest positions"):
        untangled.Session(triangles, weld=True, domain=domain, timeout=DEADLINE)


def test_displacements_applied_each_step_end_clean(sheets, domain):
    positions = sheets.vertices.copy()
    with open_session(sheets, domain) as session:
        for _ in range(200):
            correction = session.exchange(positions, deadline=DEADLINE)
            if correction.num_intersections == 0:
                break
            positions += correction.value
        assert untangled.analyse(positions, sheets.triangles).num_intersections == 0


def address(array):
    return array.__array_interface__["data"][0]


def mappings():
    """Address ranges of shared memory in this process."""
    with open("/proc/self/maps") as maps:
        lines = [line.split() for line in maps if "/dev/shm/" in line]
    return [tuple(int(end, 16) for end in line[0].split("-")) for line in lines]


def is_shared(array):
    return any(begin <= address(array) < end for begin, end in mappings())


def test_frame_and_correction_arrays_are_views_of_shared_memory(sheets, domain):
    with open_session(sheets, domain, masses=np.full(800, 0.001), paths=True) as session:
        with session.frame(dt=0.01) as positions:
            assert is_shared(positions) and positions.flags.writeable and positions.dtype == np.float32
            positions[:] = sheets.vertices
        assert not positions.flags.writeable
        correction = session.wait(deadline=DEADLINE)
        paths = correction.paths
        for view in (correction.force, correction.value, correction.flags, paths.points, paths.faces, paths[0].points):
            assert is_shared(view) and not view.flags.owndata and not view.flags.writeable
            with pytest.raises(ValueError):
                view[0] = 0
        # Value and flags lie side by side, sixteen bytes a vertex, as the daemon wrote them.
        assert correction.force is correction.value
        assert address(correction.flags) == address(correction.force) + 12
        assert correction.force.strides == (16, 4) and correction.flags.strides == (16,)


def test_exchange_gives_same_bytes_for_any_strides_and_precision(crossed, domain):
    expected = None
    for dtype in (np.float32, np.float64):
        with open_session(crossed, domain, dtype=dtype) as session:
            wide = np.zeros((6, 7))
            wide[:, 1:6:2] = crossed.vertices
            strided = wide[:, 1:6:2]
            double = crossed.vertices.astype(np.float64)
            for positions in (crossed.vertices, double, np.asfortranarray(strided), strided):
                value = session.exchange(positions, dt=0.01, deadline=DEADLINE).value.copy()
                expected = value if expected is None else expected
                assert value.tobytes() == expected.tobytes()


def test_paths_match_those_of_analyse(crossed, domain):
    with open_session(crossed, domain, paths=True) as session:
        paths = session.exchange(crossed.vertices, deadline=DEADLINE).paths
        assert len(paths) == 2 and [path.type for path in paths] == ["BB", "II"]
        found = untangled.analyse(crossed.vertices, crossed.triangles).paths
        for path, other in zip(paths, found):
            assert (path.type, path.pair_type, path.partner) == (other.type, other.pair_type, other.partner)
            assert path.points.tobytes() == other.points.tobytes() and path.faces.tolist() == other.faces.tolist()
    with open_session(crossed, domain) as session:
        assert session.exchange(crossed.vertices, deadline=DEADLINE).paths is None


def test_views_stay_valid_after_release_close_and_daemon_exit(crossed, daemon):
    session = open_session(crossed, daemon.domain)
    correction = session.exchange(crossed.vertices, deadline=DEADLINE)
    with session.frame() as positions:
        positions[:] = crossed.vertices
    value, expected = correction.value, correction.value.copy()
    correction.release()
    with pytest.raises(untangled.Error, match="released"):
        correction.value
    session.close()
    del session, correction
    gc.collect()
    daemon.stop()
    assert value.tobytes() == expected.tobytes()
    assert np.isfinite(positions).all()
    daemon.start()


def test_exchange_fails_when_too_many_corrections_are_held(crossed, domain):
    with open_session(crossed, domain) as session:
        held = [session.exchange(crossed.vertices, deadline=DEADLINE).value for _ in range(3)]
        copies = []
        del held
        for _ in range(20):
            with session.exchange(crossed.vertices, deadline=DEADLINE) as correction:
                copies.append(correction.value.copy())
        held = []
        with pytest.raises(untangled.Error, match="copy what is to be kept"):
            for _ in range(20):
                held.append(session.exchange(crossed.vertices, deadline=DEADLINE).value)


def test_newest_returns_each_correction_once(crossed, domain):
    with open_session(crossed, domain) as session:
        assert session.newest() is None
        with session.frame(dt=0.01) as positions:
            positions[:] = crossed.vertices
        end = time.monotonic() + DEADLINE
        newest = None
        while newest is None and time.monotonic() < end:
            time.sleep(0.005)
            newest = session.newest()
        assert newest.frame == 1 and session.newest() is None
        assert session.time == pytest.approx(0.01)


def test_frame_block_that_raises_publishes_nothing(crossed, domain):
    with open_session(crossed, domain) as session:
        with pytest.raises(KeyError):
            with session.frame() as positions:
                raise KeyError("solver")
        assert session.last_frame == 0 and not positions.flags.writeable
        with pytest.raises(ValueError, match="shape"):
            session.exchange(crossed.vertices[:5])
        assert session.exchange(crossed.vertices, deadline=DEADLINE).frame == 1


def test_refused_frame_takes_no_time_and_the_next_one_is_served(crossed, domain):
    with open_session(crossed, domain, dt=0.01) as session:
        session.exchange(crossed.vertices, deadline=DEADLINE)
        for step in ({"dt": np.nan}, {"dt": 0.0}, {"dt": np.inf}, {"time": np.nan}):
            with pytest.raises(untangled.FrameRefused, match="dt_s|simulated_s") as refusal:
                session.exchange(crossed.vertices, deadline=DEADLINE, **step)
            assert refusal.value.frame == 2 and session.last_frame == 1 and session.time == 0.01
        bad = crossed.vertices.copy()
        bad[4, 1] = np.nan
        with pytest.raises(untangled.FrameRefused, match="vertex 4 .*NaN") as refusal:
            session.exchange(bad, deadline=DEADLINE)
        assert refusal.value.frame == session.last_frame == 2 and session.time == 0.01
        correction = session.exchange(crossed.vertices, deadline=DEADLINE)
        assert correction.summary["simulated_s"] == 0.01 and session.time == 0.02


def test_frame_ended_at_a_limit_is_missed_and_takes_its_time(sheets, domain):
    with open_session(sheets, domain, settings={"max_face_pairs": 1}, dt=0.01) as session:
        with pytest.raises(untangled.Missed, match="not analysed.*1 pairs"):
            session.exchange(sheets.vertices, deadline=DEADLINE)
        assert session.time == 0.01
        session.update_settings({})
        assert session.exchange(sheets.vertices, deadline=DEADLINE).num_intersections > 0


def test_arguments_that_cannot_be_used_publish_nothing(crossed, domain):
    with open_session(crossed, domain) as session:
        for deadline in (-1.0, np.nan):
            with pytest.raises(ValueError, match="deadline"):
                session.exchange(crossed.vertices, deadline=deadline)
        with pytest.raises(TypeError, match="positions"):
            session.exchange({"a": 1})
        with pytest.raises(TypeError):
            session.exchange(crossed.vertices.astype(complex))
        assert session.last_frame == 0 and session.time == 0.0
        assert session.exchange(crossed.vertices, deadline=np.float32(DEADLINE)).frame == 1


def test_default_deadline_grows_with_the_cloth(crossed, sheets, domain):
    deadlines = []
    for mesh in (crossed, sheets):
        with open_session(mesh, domain) as session:
            # On a machine that is busy enough even this deadline passes.
            with contextlib.suppress(untangled.Missed):
                session.exchange(mesh.vertices)
            deadlines.append(session.default_deadline)
    assert deadlines == pytest.approx([0.2 + 2 * 20e-6, 0.2 + len(sheets.triangles) * 20e-6])


def test_session_that_is_left_is_closed_and_not_lost(crossed, daemon):
    with open_session(crossed, daemon.domain) as session:
        session.exchange(crossed.vertices, deadline=DEADLINE)
        assert len(untangled.status(domain=daemon.domain)["sessions"]) == 1
    assert untangled.status(domain=daemon.domain)["sessions"] == []
    session.close()
    said = daemon.stop()
    assert "session" in said and "host is gone" not in said
    daemon.start()


def test_session_of_killed_daemon_closes_at_once(crossed, daemon):
    session = open_session(crossed, daemon.domain)
    session.exchange(crossed.vertices, deadline=DEADLINE)
    daemon.stop(kill=True)
    begin = time.monotonic()
    session.close(timeout=DEADLINE)
    assert time.monotonic() - begin < DEADLINE / 2
    daemon.start()


def test_bad_registration_frame_or_settings_raise_error_naming_the_fault(crossed, domain):
    with pytest.raises(untangled.Refused, match="9"):
        open_session(crossed, domain, num_vertices=6, pins=[9])
    with pytest.raises(untangled.Refused, match="mass"):
        open_session(crossed, domain, correction="force")
    with pytest.raises(untangled.Refused, match="stifness"):
        open_session(crossed, domain, settings={"stifness": 1})
    with pytest.raises(ValueError, match="5 elements"):
        open_session(crossed, domain, num_vertices=6, masses=[1] * 5)
    with pytest.raises(ValueError, match="correction"):
        open_session(crossed, domain, correction="push")
    with pytest.raises(TypeError, match="integers"):
        untangled.Session([[0.5, 1, 2]], domain=domain)
    with pytest.raises(untangled.NoDaemon, match="nobody-home"):
        untangled.Session([[0, 1, 2]], domain="nobody-home", timeout=0.01)
    with open_session(crossed, domain) as session:
        bad = crossed.vertices.copy()
        bad[4, 1] = np.nan
        with pytest.raises(untangled.FrameRefused, match="4"):
            session.exchange(bad, deadline=DEADLINE)
        with pytest.raises(untangled.Error, match="displacement"):
            session.exchange(crossed.vertices, deadline=DEADLINE).force
        with pytest.raises(untangled.Refused, match="quality"):
            session.update_settings({"quality": "best"})
        session.update_settings({"quality": "fast"})
        assert untangled.status(domain=domain)["schema"] == "untangled.status/1"
    with pytest.raises(untangled.Error, match="closed"):
        session.exchange(crossed.vertices)


def test_wait_keeps_deadline_and_releases_interpreter_lock(crossed, domain):
    with open_session(crossed, domain) as session:
        counted, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(0)

        thread = threading.Thread(target=count)
        thread.start()
        with pytest.raises(untangled.Missed, match="frame 77"):
            session.wait(77, deadline=0.3)
        during = counted[0]
        done.set()
        thread.join()
        # With the lock held the other thread could not have run at all.
        assert during > 10


def test_sessions_in_four_threads_give_same_bytes(crossed, domain):
    values = []

    def work():
        with open_session(crossed, domain) as session:
            values.extend(session.exchange(crossed.vertices, deadline=DEADLINE).value.tobytes() for _ in range(10))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(values) == 40 and len(set(values)) == 1


def test_session_used_by_threads_in_turn_counts_frames(crossed, domain):
    with open_session(crossed, domain) as session:
        frames = []

        def work():
            for _ in range(10):
                frames.append(session.exchange(crossed.vertices, deadline=DEADLINE).frame)

        for _ in range(3):
            thread = threading.Thread(target=work)
            thread.start()
            thread.join()
        assert frames == list(range(1, 31))


def test_killed_daemon_gives_missed_then_session_registers_again(crossed, daemon):
    with open_session(crossed, daemon.domain) as session:
        session.exchange(crossed.vertices, deadline=DEADLINE)
        daemon.stop(kill=True)
        with pytest.raises(untangled.Missed):
            session.exchange(crossed.vertices, deadline=1.0)
        daemon.start()
        end = time.monotonic() + DEADLINE
        while True:
            try:
                correction = session.exchange(crossed.vertices, deadline=0.5)
                break
            except untangled.Missed:
                assert time.monotonic() < end
        assert session.num_registrations == 2 and correction.num_intersections == 2
