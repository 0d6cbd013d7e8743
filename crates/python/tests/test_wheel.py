"""The installed wheel against the command line: the same bits, the same words. `crates/python/check` runs it."""

import ast
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
from pathlib import Path

import numpy as np

import isophote

ROOT = Path(os.environ["ISOPHOTE_ROOT"])
PART = ROOT / "testdata/step/ball-cut.step"
REVERSED = ROOT / "testdata/step/cylinder-reversed.step"
SIZE = (96, 64)


def command(*words, code=0):
    """What the command line prints; `code` is how it must end."""
    ended = subprocess.run(["isophote", *map(str, words)], capture_output=True, text=True)
    if ended.returncode != code:
        raise AssertionError(f"{words} ended with {ended.returncode}: {ended.stdout}{ended.stderr}")
    return ended.stdout if code != 2 else ended.stderr


class Wheel(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        warnings.simplefilter("error")

    def drawn(self, model, renderer, *words, **options):
        """A part's arrays by both ways; both must be one to the byte."""
        file = self.folder / "command.npz"
        options_words = ["--with", renderer, "--size", "{}x{}".format(*SIZE), "--gbuffer", file, *words]
        command("render", model, *options_words)
        camera = isophote.Camera(view="iso") if "iso" in words else None
        picture = isophote.open(model).render(camera, SIZE, renderer, **options)
        arrays, saved = picture.arrays(), np.load(file)
        self.assertEqual(set(arrays), set(saved.files))
        for name in saved.files:
            own, others = np.asarray(arrays[name]), saved[name]
            self.assertEqual((own.dtype, own.shape), (others.dtype, others.shape), name)
            self.assertEqual(own.tobytes(), others.tobytes(), name)
        picture.write(self.folder / "python.npz")
        self.assertEqual((self.folder / "python.npz").read_bytes(), file.read_bytes())
        self.assertGreater(picture.covered, 1000)
        return picture

    def test_a_step_part_has_the_bytes_of_the_command_line(self):
        for renderer in ["raycast", "raster", "gpu"]:
            with self.subTest(renderer):
                self.drawn(PART, renderer, "--view", "iso")
        self.drawn(REVERSED, "raster", "--technique", "exact", technique="exact")
        picture = self.drawn(PART, "raycast", "--antialias", "trims", edges=True)
        self.assertGreater(np.isfinite(picture.edge).sum(), 0)

    def test_arrays_are_made_once_without_a_copy_and_cannot_be_written_to(self):
        picture = isophote.open("teapot").render(size=SIZE)
        self.assertEqual(picture.pos.shape, (SIZE[1], SIZE[0], 3))
        self.assertIs(picture.pos, picture["pos"])
        self.assertIs(picture.pos, picture.arrays()["pos"])
        # Who has the memory is an object of Rust's.
        self.assertFalse(picture.pos.flags.owndata)
        self.assertNotIsInstance(picture.pos.base, np.ndarray)
        with self.assertRaises(ValueError):
            picture.pos[0, 0, 0] = 1.0
        # An array outlives its picture.
        pos, t = picture.pos, picture.t[picture.hit == 1].copy()
        copy = pos.copy()
        del picture
        self.assertEqual(pos.tobytes(), copy.tobytes())
        self.assertTrue(np.isfinite(t).all())
        picture = isophote.open("teapot").render(size=SIZE)
        for name in ["edge", "colour"]:
            self.assertFalse(hasattr(picture, name))
            with self.assertRaises(KeyError):
                picture[name]

    def test_eval_is_that_of_the_command_line(self):
        for part in [PART, REVERSED, "teapot"]:
            model = isophote.open(part)
            answers = json.loads(command("eval", part))["queries"]
            of_surface = {answer["surface"]: answer["results"] for answer in answers}
            for index, face in enumerate(model.faces):
                results = of_surface[face.surface]
                found = model.eval(index, [(point["u"], point["v"]) for point in results])
                sign = -1.0 if face.reversed else 1.0
                for k, point in enumerate(results):
                    for name in ["S", "Su", "Sv", "Suu", "Suv", "Svv"]:
                        self.assertEqual(found[name][k].tolist(), point[name], name)
                    self.assertEqual(["regular", "limit", "none"][found["status"][k]], point["normal_kind"])
                    if point["normal"] is not None:
                        self.assertEqual((sign * found["normal"][k]).tolist(), point["normal"])
                    k1, k2 = ("k1", "k2") if sign > 0 else ("k2", "k1")
                    pairs = [("K", "K", 1.0), ("H", "H", sign), (k1, "k1", sign), (k2, "k2", sign), ("E", "E", 1.0)]
                    pairs += [("F", "F", 1.0), ("G", "G", 1.0), ("L", "L", sign), ("M", "M", sign), ("N", "N", sign)]
                    for own, name, factor in pairs:
                        known = None if np.isnan(found[own][k]) else factor * found[own][k]
                        self.assertEqual(known, point[name], name)
        self.assertTrue(any(face.reversed for face in isophote.open(REVERSED).faces))

    def test_eval_of_a_picture_s_pixels_has_their_points_and_normals(self):
        model = isophote.open(REVERSED)
        picture = model.render(size=SIZE)
        seen = picture.hit == 1
        found = model.eval(picture.face[seen], np.stack([picture.u[seen], picture.v[seen]], axis=-1))
        np.testing.assert_allclose(found["S"], picture.pos[seen], atol=1e-12 * np.abs(picture.pos[seen]).max())
        np.testing.assert_allclose(found["normal"], picture.normal[seen], atol=1e-12)

    def test_rays_find_every_hit_in_order(self):
        model = isophote.open("teapot")
        picture = model.render(isophote.Camera(view="front", ortho=4.0), SIZE)
        row, column = np.argwhere(picture.hit == 1)[picture.covered // 2]
        seen = picture.pos[row, column]
        forward = np.array([0.0, 2.0, 0.0])  # of any length
        origin = seen - picture.t[row, column] * forward / 2.0
        found = model.rays([origin, origin + [1e3, 0.0, 0.0]], [forward, forward])
        self.assertEqual(set(found["ray"].tolist()), {0})
        self.assertGreaterEqual(len(found["t"]), 2)
        self.assertTrue((np.diff(found["t"]) >= 0.0).all())
        self.assertAlmostEqual(found["t"][0], picture.t[row, column], delta=1e-9)
        self.assertEqual(found["face"][0], picture.face[row, column])
        np.testing.assert_allclose(found["pos"], origin + np.outer(found["t"], forward / 2.0), atol=1e-9)
        self.assertEqual(found["undecided"].tolist(), [0, 0])

    def test_a_right_picture_agrees_and_wrong_ones_differ_for_the_right_cause(self):
        model = isophote.open(PART)
        ours = model.render(size=SIZE, renderer="raster")
        ours.write(self.folder / "ours.npz")
        verdict = model.judge(ours)
        self.assertTrue(verdict.agrees and bool(verdict), verdict.line)
        self.assertEqual((verdict.exit_code, verdict.differ, verdict.cause), (0, 0, None))
        said = command("compare", self.folder / "ours.npz", "--model", PART)
        self.assertEqual(said.splitlines()[-1], verdict.line)
        one = int(np.argmax(ours.hit))
        shifted, moved = ours.pos.copy(), ours.pos.copy()
        shifted.reshape(-1, 3)[one] += 1.0
        moved += 0.01
        faults = {
            "normals are flipped": {"normal": -ours.normal},
            "rows are flipped": {name: array[::-1] for name, array in ours.arrays().items() if name != "meta"},
            "position": {"pos": shifted},
            "": {"pos": moved},
        }
        for cause, arrays in faults.items():
            wrong = isophote.gbuffer({**ours.arrays(), **arrays})
            wrong.write(self.folder / "wrong.npz")
            verdict = model.judge(wrong)
            self.assertFalse(verdict.agrees, cause)
            self.assertEqual(verdict.exit_code, 1)
            self.assertIn(cause.split(" ")[-1], verdict.cause)
            self.assertEqual(verdict.differ, 1 if cause == "position" else verdict.differ)
            self.assertGreater(verdict.differ, 0)
            said = command("compare", self.folder / "wrong.npz", "--model", PART, code=1)
            self.assertEqual(said.splitlines()[-1], verdict.line)
            self.assertEqual(verdict.pairs[0]["verdict"], "differ")
        # Of two, the second is held against the first as well; a built-in model is found by its name.
        pots = [isophote.open("teapot").render(size=SIZE, renderer=renderer) for renderer in ["raycast", "raster"]]
        both = isophote.judge(*pots)
        self.assertEqual((both.agrees, len(both.pairs)), (True, 3))

    def test_errors_have_types_and_the_words_of_the_command_line(self):
        def said(*words):
            return command(*words, code=2).strip().removeprefix("error: ")

        with self.assertRaises(isophote.ReadError) as raised:
            isophote.open("teapto")
        self.assertEqual(str(raised.exception), said("info", "teapto"))
        bad = self.folder / "bad.step"
        bad.write_text("ISO-10303-21;\nHEADER;\n")
        with self.assertRaises(isophote.ReadError) as raised:
            isophote.open(bad)
        self.assertEqual(str(raised.exception), said("info", bad))
        with self.assertRaises(isophote.CameraError) as raised:
            isophote.Camera(fov=200.0)
        self.assertIn("an angle above 0 and below 180 degrees", str(raised.exception))
        for options in [{"eye": (0.0, 0.0, float("nan"))}, {"view": "iso", "azimuth": 3.0}, {"near": -1.0}]:
            with self.assertRaises(isophote.CameraError):
                isophote.Camera(**options)
        model = isophote.open("teapot")
        with self.assertRaises(isophote.CameraError):
            model.render(isophote.Camera(eye=(1.0, 1.0, 1.0), target=(1.0, 1.0, 1.0)))
        for options in [{"size": (0, 4)}, {"error": -1.0}, {"error": float("nan")}]:
            with self.assertRaises(isophote.RenderError):
                model.render(**options)
        for options in [{"renderer": "radiosity"}, {"technique": "voodoo"}]:
            with self.assertRaises(ValueError):
                model.render(**options)
        for face, uv in [(0, [(0.5, 7.0)]), (99, [(0.5, 0.5)]), (-1, [(0.5, 0.5)]), (0, [(float("nan"), 0.0)])]:
            with self.assertRaises(isophote.EvalError):
                model.eval(face, uv)
        for face, uv in [(0, [1.0, 2.0, 3.0]), (np.array([0, 1]), [(0.5, 0.5)]), (np.array([0.5]), [(0.5, 0.5)])]:
            with self.assertRaises((ValueError, TypeError)):
                model.eval(face, uv)
        for rays in [([(0.0, 0.0, 0.0)], [(0.0, 0.0, 0.0)]), ([(0.0, 0.0, 0.0)], [(0.0, 0.0, 1.0)] * 2)]:
            with self.assertRaises(isophote.RenderError):
                model.rays(*rays)
        other = isophote.open(PART).render(size=SIZE)
        with self.assertRaises(isophote.GBufferError) as raised:
            model.judge(other)
        self.assertIn("it shows a model with hash", str(raised.exception))
        with self.assertRaises(isophote.GBufferError):
            model.judge(model.render(size=SIZE), model.render(size=(64, 64)))
        arrays = model.render(size=SIZE).arrays()
        for wrong in [{"nomral": arrays["normal"]}, {"u": arrays["u"][:3]}, {"meta": "{}"}]:
            with self.assertRaises(isophote.GBufferError):
                isophote.gbuffer({**arrays, **wrong})
        self.assertTrue(issubclass(isophote.GBufferError, isophote.IsophoteError))

    def test_what_is_lost_of_a_file_is_a_warning(self):
        lossy = next(
            path for path in sorted((ROOT / "testdata/step").glob("*.step")) if "left out" in command("info", path)
        )
        with self.assertWarns(UserWarning):
            warnings.simplefilter("always")
            model = isophote.open(lossy)
        self.assertTrue(any("left out" in note for note in model.notes))

    def test_info_is_that_of_the_command_line(self):
        self.assertEqual(isophote.open(PART).info, json.loads(command("info", PART, "--format", "json")))

    def test_other_threads_run_while_a_picture_is_drawn_and_ctrl_c_ends_it(self):
        model, counted, ended = isophote.open("teapot"), [0], threading.Event()

        def count():
            while not ended.wait(0.01):
                counted[0] += 1

        # A job in the background of a shell ignores it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        counter = threading.Thread(target=count, daemon=True)
        counter.start()
        began = time.monotonic()
        interrupt = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        interrupt.start()
        with self.assertRaises(KeyboardInterrupt):
            model.render(size=(4096, 4096))
        self.assertLess(time.monotonic() - began, 10.0)
        ended.set()
        counter.join()
        self.assertGreater(counted[0], 5)
        # The work itself has ended, too: no thread takes the processors.
        time.sleep(1.0)
        before = time.process_time()
        time.sleep(1.0)
        self.assertLess(time.process_time() - before, 0.5)

    def test_the_stubs_name_what_is_there(self):
        folder = Path(isophote.__file__).parent
        self.assertTrue((folder / "py.typed").exists())
        tree = ast.parse((folder / "__init__.pyi").read_text())
        named = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(set(named), set(isophote.__all__))
        arrays = isophote.open("teapot").render(size=SIZE, edges=True).keys()
        for name, node in named.items():
            if isinstance(node, ast.FunctionDef):
                continue
            members = {
                member.target.id if isinstance(member, ast.AnnAssign) else member.name
                for member in node.body
                if isinstance(member, (ast.AnnAssign, ast.FunctionDef))
            }
            there = set(vars(getattr(isophote, name))) | (set(arrays) if name == "GBuffer" else set())
            self.assertEqual(members - there, set(), name)
            public = {member for member in vars(getattr(isophote, name)) if not member.startswith("_")}
            self.assertEqual(public - members, set(), name)

    def test_the_document_s_examples_run(self):
        text = (ROOT / "docs/python.md").read_text()
        blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        self.assertGreaterEqual(len(blocks), 3)
        shutil.copy(PART, self.folder / "part.step")
        script = self.folder / "document.py"
        script.write_text("\n".join(blocks))
        ended = subprocess.run([sys.executable, script], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        shown = "".join(re.findall(r"```text\n(.*?)```", text, re.DOTALL))
        self.assertEqual(ended.stdout, shown)


if __name__ == "__main__":
    unittest.main()
