"""The library without a daemon."""

import numpy as np
import pytest

import untangled_cloth as untangled


def test_analyse_of_crossed_triangles_finds_intersections_and_paths(crossed):
    found = untangled.analyse(crossed.vertices, crossed.triangles)
    assert found.num_intersections == 2 and found.face_pairs.tolist() == [[0, 1]]
    assert found.edge_face[:, 2].tolist() == [0, 0] and found.inside.tolist() == [False] * 5 + [True]
    assert found.contour_length > 0
    path = found.paths[0]
    assert (path.type, path.pair_type, path.closed) == ("BB", "BB/II", False)
    assert path.points.shape == (2, 3) and path.faces.tolist() == [[1, 0], [1, 0]]
    assert [path.inside.tolist() for path in found.paths] == [[5], []]


def test_fix_of_crossed_sheets_ends_clean_and_keeps_clean_input(sheets):
    before = untangled.analyse(sheets.vertices, sheets.triangles).num_intersections
    result = untangled.fix(sheets.vertices, sheets.triangles, single_precision=True)
    assert before > 20 and result.clean and result.blocked == [] and result.num_iterations > 0
    after = untangled.analyse(result.vertices.astype(np.float32), sheets.triangles)
    assert after.num_intersections == 0 and not after.inside.any()
    # Clean input comes back bit for bit.
    again = untangled.fix(result.vertices, sheets.triangles)
    assert again.vertices.tobytes() == result.vertices.tobytes()


def test_fix_reports_each_iteration_and_ends_where_asked(sheets):
    states = []
    result = untangled.fix(sheets.vertices, sheets.triangles, progress=states.append)
    assert [state.num_iterations for state in states] == list(range(1, result.num_iterations + 1))
    assert states[-1].num_intersections == 0 and states[0].contour_length >= 0
    assert {state.method for state in states} <= {"rbf", "push", "contour", "straighten", "settle"}

    stopped = untangled.fix(sheets.vertices, sheets.triangles, progress=lambda state: False)
    assert stopped.num_iterations == 1 and len(stopped.vertices) == len(sheets.vertices)
    assert untangled.count_intersections(stopped.vertices, sheets.triangles) == stopped.num_intersections

    def fails(state):
        raise KeyError(state.num_iterations)

    with pytest.raises(KeyError, match="1"):
        untangled.fix(sheets.vertices, sheets.triangles, progress=fails)


def test_results_are_writable_arrays_of_the_caller(crossed):
    found = untangled.analyse(crossed.vertices, crossed.triangles)
    fixed = untangled.fix(crossed.vertices, crossed.triangles)
    arrays = [found.edge_face, found.face_pairs, found.inside, fixed.vertices]
    arrays += [array for path in found.paths for array in (path.points, path.faces, path.inside)]
    for array in arrays:
        array[...] = 0
        assert array.flags.writeable and not array.any()
    assert untangled.analyse(crossed.vertices, crossed.triangles).num_intersections == 2


def test_fix_does_not_move_pins(sheets):
    pins = np.arange(400)
    result = untangled.fix(sheets.vertices, sheets.triangles, pins=pins)
    assert np.array_equal(result.vertices[pins], sheets.vertices[pins])


def box(low, high):
    corners = np.array([[x, y, z] for x in (low, high) for y in (low, high) for z in (low, high)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])


def test_fix_beside_a_body_ends_outside_of_it_with_the_gap():
    corners, faces = box(-0.6, 0.6)
    steps = np.linspace(-0.4, 0.4, 9)
    sheet = np.array([[x, y, 0.55] for x in steps for y in steps])
    squares = [(9 * i + k, 9 * i + k + 1, 9 * i + k + 10, 9 * i + k + 9) for i in range(8) for k in range(8)]
    cloth = np.array([face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))])
    vertices = np.vstack([corners, sheet])
    triangles = np.vstack([faces, cloth + len(corners)])
    body = np.arange(len(corners))
    found = untangled.analyse(vertices, triangles, body=body)
    assert found.inside_body.tolist() == list(range(8, len(vertices))) and found.behind.size == 0
    assert found.num_intersections == 0
    result = untangled.fix(vertices, triangles, body=body, gap=0.01)
    assert result.clean and result.num_inside_body == 0 and result.num_pairs_below == 0 and result.infeasible == []
    assert np.array_equal(result.vertices[body], corners) and result.vertices[8:, 2].min() >= 0.61 - 1e-9
    # Nothing says that it is a body: the sheet is clean in it.
    assert untangled.fix(vertices, triangles).num_iterations == 0
    # All pinned, it stays, and says so.
    held = untangled.fix(vertices, triangles, body=body, pins=np.arange(8, len(vertices)))
    assert not held.clean and held.num_inside_body == len(sheet)
    with pytest.raises(ValueError, match="gap"):
        untangled.fix(vertices, triangles, gap=0)


def test_layers_behind_each_other_are_found_and_put_in_order():
    def sheet(z):
        return np.array([[x, y, z] for x in np.linspace(0, 1, 9) for y in np.linspace(0, 1, 9)])

    squares = [(9 * i + k, 9 * i + k + 9, 9 * i + k + 10, 9 * i + k + 1) for i in range(8) for k in range(8)]
    faces = np.array([face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))])
    vertices, triangles = np.vstack([sheet(0), sheet(-0.02)]), np.vstack([faces, faces + 81])
    layers = np.repeat([0, 1], 81)
    assert len(untangled.analyse(vertices, triangles, layers=layers).behind) > 40
    result = untangled.fix(vertices, triangles, layers=layers)
    assert result.clean and result.num_behind == 0


def test_bad_input_raises_error_naming_the_element(crossed):
    bad = crossed.vertices.copy()
    bad[3, 2] = np.inf
    with pytest.raises(ValueError, match="3"):
        untangled.analyse(bad, crossed.triangles)
    with pytest.raises(ValueError, match="6"):
        untangled.fix(crossed.vertices, [[0, 1, 6]])
    with pytest.raises(ValueError, match="shape"):
        untangled.analyse(crossed.vertices[:, :2], crossed.triangles)
    with pytest.raises(ValueError, match="path_rings"):
        untangled.analyse(crossed.vertices, crossed.triangles, settings={"path_rings": 1000})
    with pytest.raises(ValueError, match="quality"):
        untangled.fix(crossed.vertices, crossed.triangles, quality="best")
    with pytest.raises(ValueError, match="one coordinate for each vertex"):
        untangled.analyse(crossed.vertices, crossed.triangles, uv=np.zeros((3, 2)))
