"""Repairs: a certified answer in one exchange."""

import time

import numpy as np
import pytest

import untangled_cloth as untangled

from conftest import DEADLINE


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_repair_of_tangled_sheets_is_certified_and_clean_to_the_bit(sheets, domain, dtype):
    positions = sheets.vertices.astype(dtype)
    with untangled.Session(sheets.triangles, repairs=True, dtype=dtype, domain=domain, timeout=DEADLINE) as session:
        assert session.has_repairs
        repair = session.repair(positions, deadline=DEADLINE)
        assert repair.certified and not repair.truncated and repair.frame == 1 and repair.num_intersections == 0
        assert repair.displacement.dtype == dtype and not repair.displacement.flags.writeable
        clean = repair.repaired(positions)
        assert clean.dtype == dtype and repair.summary["num_moved"] == np.any(clean != positions, axis=1).sum() > 0
        assert untangled.count_intersections(clean, sheets.triangles) == 0
        assert session.exchange(clean, deadline=DEADLINE).num_intersections == 0


def test_repair_comes_beside_corrections_and_is_polled(sheets, domain):
    with untangled.Session(sheets.triangles, repairs=True, domain=domain, timeout=DEADLINE) as session:
        assert session.poll_repair() is None
        session.ask_for_repair()
        correction = session.exchange(sheets.vertices, deadline=DEADLINE)
        assert correction.being_repaired and correction.num_intersections > 0
        repair, end = None, time.monotonic() + DEADLINE
        while repair is None and time.monotonic() < end:
            session.exchange(sheets.vertices, deadline=DEADLINE)
            repair = session.poll_repair()
        assert repair is not None and repair.certified and repair.frame == 1
        session.begin_motion()


def test_session_without_repairs_raises_error(crossed, domain):
    with untangled.Session(crossed.triangles, domain=domain, timeout=DEADLINE) as session:
        assert not session.has_repairs and session.poll_repair() is None
        with pytest.raises(untangled.Error, match="no repairs"):
            session.repair(crossed.vertices)
        assert session.last_frame == 0
    with pytest.raises(untangled.Refused, match="repair"):
        untangled.Session(crossed.triangles, settings={"repair": "auto"}, domain=domain, timeout=DEADLINE)


def test_repair_of_a_frame_that_cannot_be_used_raises_frame_refused(crossed, domain):
    with untangled.Session(crossed.triangles, repairs=True, domain=domain, timeout=DEADLINE) as session:
        positions = crossed.vertices.copy()
        positions[3, 1] = np.nan
        with pytest.raises(untangled.FrameRefused, match="vertex 3"):
            session.repair(positions, deadline=DEADLINE)
        with pytest.raises(ValueError, match="deadline"):
            session.repair(crossed.vertices, deadline=-1.0)
