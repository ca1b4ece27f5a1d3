"""Answers of the package: the examples, every form of K and of rows, load steps, states, checks, reports."""

import logging
import pickle
import runpy
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from conftest import chain, chain_at_wall, spring_and_block

import feti_contact as fc

EXAMPLES = Path(__file__).parent.parent / "examples"


@pytest.mark.parametrize("name, lines, says", [
    ("spring", 10, "force 100.000 N, u -0.100 -0.600 -0.625 mm"),
    ("hertz", 40, "force 4.315375 N of 4.315375 N, peak 2.7467 MPa, Hertz 2.7473, within .9 a 0.40 %"),
    ("block", 30, "FETI_LOAD_NOT_HELD, body 0 slides, its foot by 1 along x"),
])  # fmt: skip
def test_an_example_prints_the_known_answer_in_few_lines(name, lines, says):
    path = EXAMPLES / f"{name}.py"
    assert len(path.read_text().splitlines()) <= lines
    assert says in subprocess.check_output([sys.executable, path], text=True)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_the_documents_show_the_first_example(page):
    code = (EXAMPLES / "spring.py").read_text().split('"""\n')[1]
    assert "```python\n" + code in (EXAMPLES.parent.parent / page).read_text()


@pytest.mark.parametrize("form", ["csr", "csc", "coo", "bsr", "lil", "dense", "fortran"])
@pytest.mark.parametrize("storage", ["full", "lower", "upper"])
def test_every_form_and_triangle_of_K_gives_the_answer(form, storage):
    K = chain(7) if storage == "full" else sp.tril(chain(7)) if storage == "lower" else sp.triu(chain(7))
    K = K.toarray() if form == "dense" else np.asfortranarray(K.toarray()) if form == "fortran" else K.asformat(form)
    p, body = chain_at_wall(K, storage)
    assert p.solve()
    np.testing.assert_allclose(body.displacement(), -np.arange(7.0), atol=1e-12)
    np.testing.assert_allclose(p.multipliers(), [1])


def test_unsorted_rows_and_triplets_at_one_place_are_taken_and_a_column_twice_is_refused_by_its_place():
    K = chain(3)
    K.indices[3:5], K.data[3:5] = K.indices[[4, 3]], K.data[[4, 3]]
    p, body = chain_at_wall(K)
    p.solve()
    np.testing.assert_allclose(body.displacement(), [0, -1, -2], atol=1e-12)
    twice = sp.coo_matrix(([0.5, 0.5, -1.0, -1.0, 1.0], ([0, 0, 0, 1, 1], [0, 0, 1, 0, 1])))
    p, body = chain_at_wall(twice)
    p.solve()
    np.testing.assert_allclose(body.displacement(), [0, -1], atol=1e-12)
    with pytest.raises(fc.FetiError, match="row 0") as caught:
        fc.Problem().add_body(sp.csr_matrix((twice.data, [0, 0, 1, 0, 1], [0, 3, 5])))
    assert caught.value.place["row"] == 0 and caught.value.name == "FETI_ARGUMENT"


def test_skyline_elements_and_functions_give_the_answer():
    load = [0, 0, -1.0]
    for how in ("skyline", "elements", "lower", "upper", "operator"):
        p = fc.Problem()
        body = p.add_body(n=3, load=load, null_space=np.ones(3))
        K = chain(3).toarray()
        if how == "skyline":
            body.skyline([0, 1, 3, 5], [1, -1, 2, -1, 1])
        elif how == "operator":
            body.operator(np.diag(K), lambda x: np.linalg.pinv(K) @ x, lambda x: K @ x)
        else:
            body.elements([[0, 1], [1, 2]], [[[1, -1], [-1, 1]]] * 2, storage="full" if how == "elements" else how)
        p.add_contact([[-1, 0, 0]])
        p.solve()
        np.testing.assert_allclose(body.displacement(), [0, -1, -2], atol=1e-9)


def test_an_unsymmetric_triangle_of_an_element_is_the_one_that_is_named():
    given = np.array([[1.0, 9, 9], [-1, 2, 9], [0, -1, 1]])
    for storage, ke in (("lower", given), ("upper", given.T)):
        p = fc.Problem()
        body = p.add_body(n=3, load=[0, 0, -1.0], null_space=np.ones(3))
        body.elements([[0, 1, 2]], [ke], storage=storage)
        p.add_contact([[-1, 0, 0]])
        p.solve()
        np.testing.assert_allclose(body.displacement(), [0, -1, -2], atol=1e-12)


def test_rows_of_the_model_by_numbers_by_bodies_and_by_a_table_are_the_same():
    expected = [-0.1, -0.6, -0.625]
    for how in ("model", "numbers", "table"):
        p = fc.Problem(tolerance=1e-10)
        spring = p.add_body([[1000]], null_space=None)
        block = p.add_body([[4000, -4000], [-4000, 4000]], load=[0, -100], null_space=[1, 1])
        if how == "numbers":
            spring.numbering([4]), block.numbering([1, 0])
            rows, place = sp.csr_matrix(([1.0, -1.0], ([0, 0], [4, 1])), shape=(1, 5)), [4, 1, 0]
        elif how == "table":
            p.dof_table([0, -1, 1, 2], terms=sp.csr_matrix(([1.0], ([1], [2])), shape=(4, 4)), constant=[0, 0.25, 0, 0])
            rows, place = [[1, -1, 0, 0]], [0, 2, 3]
        else:
            rows, place = [[1, -1, 0]], [0, 1, 2]
        p.add_contact(rows, gap=0.25 if how == "table" else 0.5)
        p.solve()
        u = p.displacement()
        np.testing.assert_allclose(u[place], expected)
        if how == "table":
            np.testing.assert_allclose(u[1], -0.6 + 0.25)


def test_answers_are_arrays_of_the_documented_shapes(spring):
    p, spring, block = spring
    info = p.solve()
    assert info and info.name == "FETI_OK" and info.worst <= 1
    np.testing.assert_allclose(p.gaps(), [0], atol=1e-12)
    np.testing.assert_array_equal(p.active(), [1])
    np.testing.assert_allclose(p.reaction(), [-100, 100, 0])
    np.testing.assert_allclose(block.reaction("contact"), [100, 0])
    assert p.multipliers("equality").shape == (0,) and p.multipliers("tangential").shape == (0, 0)
    np.testing.assert_allclose(block.motions() / block.motions()[0], [[1], [1]])
    assert block.amplitudes().shape == (1,)
    assert p.check().passed == 1
    wrong = p.check(u=[0, 0, 0], contact=[100.0])
    assert wrong.passed == 0 and wrong.worst > 1 and "worst=" in repr(wrong)
    assert "null_space=1" in repr(block.info) and "FETI_OK" in repr(info)
    assert sum(seconds for seconds, _ in p.phases().values()) >= 0


def test_supports_compliance_loads_and_states_follow_the_formulas(spring):
    p, spring, block = spring
    p.set_compliance("contact", [1e-3])
    p.solve()
    np.testing.assert_allclose(p.displacement(), [-0.1, -0.7, -0.725])
    state = p.save()
    p.set_rhs("contact", [0.0]), p.set_compliance("contact", [0.0]), block.load([0, -200])
    p.solve()
    np.testing.assert_allclose(p.displacement(), [-0.2, -0.2, -0.25])
    p.restore(state)
    p.solve(start="cold")
    np.testing.assert_allclose(p.displacement(), [-0.1, -0.7, -0.725])
    p.drop(state)
    p.clear("contact")
    p.add_equality({spring: [[1]], block: [[-1, 0]]}, rhs=[0.5], compliance=1e-3)
    p.solve()
    np.testing.assert_allclose(p.displacement(), [-0.1, -0.7, -0.725])
    np.testing.assert_allclose(p.multipliers("equality"), [100])
    block.values(np.array([[8000, -8000], [-8000, 8000.0]]))
    p.solve()
    np.testing.assert_allclose(p.displacement(), [-0.1, -0.7, -0.7125])


def test_a_pair_of_surfaces_has_the_pressure_of_the_load():
    p = fc.Problem()
    K = np.kron(np.diag([1000.0, 1000.0]), np.eye(2))
    body = p.add_body(K, load=[0, -3, 0, -3], null_space=None)
    foot = body.surface([[0, 0], [2, 0]], [[0, 1], [2, 3]], np.array([[0, 1]]))
    pair = p.add_pair(foot, p.add_plane([0, 0], [0, 1]), distance=1, method="node_to_face", friction=0.3)
    p.find_pairs()
    p.solve()
    np.testing.assert_allclose(pair.field("pressure"), [3, 3])
    assert pair.field("shear").shape == (2, 2) and pair.info.closed == 2 and "closed=2" in repr(pair)
    np.testing.assert_allclose(pair.info.force[:2], [0, 6], atol=1e-12)
    foot.move([[0, 1], [2, 1]])
    p.commit_pairs(), p.find_pairs()
    p.solve()
    np.testing.assert_allclose(body.displacement()[1], -0.003)
    assert p.slips().shape == (2, 1) and p.friction_states().shape == (2,)


def test_no_answer_names_the_status_the_body_and_the_motion(spring):
    p, _, block = spring
    block.load([0, 100])
    with pytest.raises(fc.FetiError, match="the load moves the body and no contact force can hold it") as caught:
        p.solve()
    assert caught.value.name == "FETI_LOAD_NOT_HELD" and caught.value.place == {"body": 1, "dof": 0}
    np.testing.assert_allclose(block.escape(), [1, 1])
    assert p.diagnosis().body == 1 and "FETI_LOAD_NOT_HELD" in repr(p.diagnosis())
    copy = pickle.loads(pickle.dumps(caught.value))
    assert (copy.status, str(copy), copy.place) == (caught.value.status, str(caught.value), caught.value.place)
    p.clear("contact")
    p.add_contact([[1, 0, 0], [-1, 0, 0]], gap=[-1, -1]), p.add_equality([[0, 1, 0]])
    with pytest.raises(fc.FetiError) as caught:
        p.solve()
    assert caught.value.name == "FETI_GAPS_CONTRADICT" and list(p.diagnosis_rows()[0]) == [0, 1]


def test_an_incomplete_answer_warns_and_is_false():
    p, *_ = spring_and_block()
    with pytest.warns(fc.FetiWarning, match="FETI_CANCELLED"):
        info = p.solve(progress=lambda now: True)
    assert not info and info.name == "FETI_CANCELLED"
    with warnings.catch_warnings():
        warnings.simplefilter("error", fc.FetiWarning)
        assert p.solve()


def test_options_are_set_by_name_and_refused_by_the_library():
    p = fc.Problem(threads=2, tolerance=1e-9, start="previous")
    assert (p.get("threads"), p.get("tolerance"), p.get("start")) == (2, 1e-9, "previous")
    for option in ({"tolerence": 1}, {"threads": -7}, {"start": "warm"}, {"tolerance": float("nan")}):
        with pytest.raises(fc.FetiError, match=next(iter(option))):
            p.set(**option)
    with pytest.raises(TypeError):
        p.set(threads=2.5)


def test_pickled_problems_solve_to_the_same_bits(spring):
    p, *_ = spring
    block = runpy.run_path(str(EXAMPLES / "block.py"))["p"]
    block.bodies[0].load([20, 0, 0, 0, 0, -50, 0, -50])
    for problem in (p, block):
        copy, body = pickle.loads(pickle.dumps((problem, problem.bodies[0])))
        assert copy.solve() and problem.solve(start="cold")
        assert copy.displacement().tobytes() == problem.displacement().tobytes()
        assert copy.multipliers().tobytes() == problem.multipliers().tobytes()
        assert body.problem is copy and body.n == problem.bodies[0].n


def test_the_log_goes_to_logging(spring, caplog):
    p, *_ = spring
    with caplog.at_level(logging.DEBUG, "feti_contact"):
        p.solve()
    assert {record.levelno for record in caplog.records} == {logging.INFO, logging.DEBUG}
    caplog.clear()
    p.solve()
    assert not caplog.records


def test_outward_turns_faces_and_leaves_mid_nodes_between_their_corners():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0, 0], [1, 0.5, 0], [0.5, 1, 0], [0, 0.5, 0], [0.5, 0.5, 0.0]])
    for face in ([0, 1, 2], [0, 1, 2, 4, 5, 8], [0, 1, 2, 3], [0, 1, 2, 3, 4, 5, 6, 7], list(range(9))):
        same, turned = (fc.outward([face], square, [[0.4, 0.4, z]])[0] for z in (-1, 1))
        corners = 3 if len(face) in (3, 6) else 4
        assert list(same) == face and sorted(turned) == face
        np.testing.assert_array_equal(turned[:corners], face[:corners][::-1])
        for k in range(corners, min(len(face), 2 * corners)):
            a, b = square[turned[k - corners]], square[turned[(k - corners + 1) % corners]]
            np.testing.assert_allclose(square[turned[k]], (a + b) / 2)
    np.testing.assert_array_equal(fc.outward([[0, 1, 2]], np.eye(2)[[0, 1, 0]], [[0.0, 0.0]]), [[0, 1, 2]])


def test_every_constant_function_and_struct_of_the_header_is_reached():
    from feti_contact import _raw
    from feti_contact._library import LIBRARY

    assert all(getattr(LIBRARY, name) for name in _raw.FUNCTIONS)
    for name in ("info", "certificate", "findings", "body_facts", "pair_facts", "option", "phase", "progress", "error_detail"):
        assert hasattr(_raw, "feti_" + name)


def test_points_of_a_mesh_that_faces_of_one_node_name_meet_a_plane():
    p = fc.Problem()
    x = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    body = p.add_body(np.eye(8), null_space=None, load=np.tile([0.0, -1.0], 4))
    feet = body.surface(x, np.arange(8).reshape(4, 2), np.array([[0], [1]]))
    pair = p.add_pair(feet, p.add_plane([0, 0], [0, 1]), distance=1, method="node_to_face")
    p.find_pairs()
    assert p.solve()
    np.testing.assert_allclose(pair.info.force, [0, 2, 0], atol=1e-12)
    np.testing.assert_allclose(body.displacement().reshape(4, 2)[:, 1], [0, 0, -1, -1], atol=1e-12)


def test_a_surface_without_unknowns_is_a_tool_and_a_record_shows_forces_below_0():
    p = fc.Problem()
    body = p.add_body(np.eye(4) * 1000, load=[0, 3, 0, 3], null_space=None)
    head = body.surface([[2, 0], [0, 0]], [[2, 3], [0, 1]], np.array([[0, 1]]))
    pair = p.add_pair(head, p.add_surface([[-9, 0], [9, 0]], faces=np.array([[0, 1]])), distance=1, method="node_to_face")
    p.find_pairs()
    p.solve()
    np.testing.assert_allclose(pair.info.force[:2], [0, -6], atol=1e-12)
    assert pair.info.as_dict()["force"][1] == pytest.approx(-6) and "force=(" in repr(pair.info)
