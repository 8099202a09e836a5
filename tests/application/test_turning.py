"""The .html report turns a surface and its image in a browser: its numbers are those of the result, large meshes are thinned
out, and, where Chromium is there, a drag turns what is drawn.

usage: python3 test_turning.py EQUIMAP [RANKS]
"""
import base64
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import Program  # noqa: E402

MOST_FACES = 120000
DRAG = """<script>
const canvas = document.querySelector(".turn canvas"), gl = canvas.getContext("webgl2");
function read() {
  const pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let drawn = 0, sum = 0;
  for (let k = 0; k < pixels.length; k += 4) {
    if (pixels[k] + pixels[k + 1] + pixels[k + 2] < 760) drawn++;
    sum = (31 * sum + pixels[k]) % 1000003;
  }
  return [drawn / (pixels.length / 4), sum];
}
const before = read();
canvas.dispatchEvent(new PointerEvent("pointermove", {buttons: 1, movementX: 90, movementY: 20}));
document.body.dataset.seen = JSON.stringify([before, read()]);
</script></body>"""


def numbers(page, name, kind):
    return numpy.frombuffer(base64.b64decode(re.search(f'{name}: "([^"]*)"', page).group(1)), kind)


def check_numbers(page, result, thinned):
    """Corners are near the vertices of the mesh and of its image that they stand for."""
    faces = numbers(page, "faces", "<u4").reshape(-1, 3)
    surface, image = (numbers(page, name, "<f4").reshape(-1, 3) for name in ("surface", "image"))
    assert len(surface) == len(image) == faces.max() + 1 and len(numbers(page, "colours", "u1")) == faces.size
    with h5py.File(result, "r") as file:
        vertices, cells, images = (file[path][...] for path in ("/mesh/vertices", "/mesh/cells", "/map/coordinates"))
    if thinned:
        assert MOST_FACES / 4 < len(faces) <= MOST_FACES < len(cells), (len(faces), len(cells))
        assert (numpy.sort(faces, axis=1)[:, :-1] != numpy.sort(faces, axis=1)[:, 1:]).all()
        known = {tuple(point) for point in vertices.astype("<f4").tolist()}
        assert all(tuple(point) in known for point in surface[::97].tolist())
        return
    assert numpy.array_equal(surface[faces], vertices[cells].astype("<f4"))
    assert numpy.array_equal(image[faces][:, :, :2], images[cells][:, :, :2].astype("<f4")) and not image[:, 2].any()


def keep_picture(chromium, flags, path, picture):
    """What a person would see, beside the program: for people, and to see that it is there."""
    with tempfile.TemporaryDirectory() as home:
        subprocess.run([chromium, *flags, "--user-data-dir=" + home, "--virtual-time-budget=5000", "--window-size=1200,1500",
                        "--screenshot=" + picture, "file://" + path], capture_output=True, timeout=120, check=False)
    with open(picture, "rb") as file:
        assert file.read(4) == b"\x89PNG" and os.path.getsize(picture) > 50000
    print("a picture of the page:", picture)


def check_browser(chromium, path, picture):
    """Something is drawn, and a drag changes it."""
    flags = ["--headless", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    keep_picture(chromium, flags, path, picture)
    with open(path, encoding="utf-8") as file:
        page = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(page.replace("</body>", DRAG))
    with tempfile.TemporaryDirectory() as home:
        done = subprocess.run([chromium, *flags, "--user-data-dir=" + home, "--virtual-time-budget=5000", "--dump-dom", "file://" + path],
                              capture_output=True, text=True, timeout=120, check=False)
    block = re.search('<div id="turn0"[^>]*>', done.stdout).group(0)
    if "hidden" in block:
        print("this Chromium has no WebGL 2: not turned")
        return
    (before, sum_before), (after, sum_after) = json.loads(
        re.search('data-seen="([^"]*)"', done.stdout).group(1).replace("&quot;", '"'))
    assert 'data-drawn="2"' in block and 0.05 < before < 0.95 and 0.05 < after < 0.95, (block, before, after)
    assert sum_before != sum_after
    print(f"turned in {chromium}: {100 * before:.0f} % of the canvas drawn, then {100 * after:.0f} %")


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else 1, folder)
        program.succeed("generate", "hills", "-n", 900, "-o", "hills.obj", ranks=1)
        program.succeed("disk", "hills.obj", "-o", "hills.h5", "-quiet", codes=(0, 4))
        program.succeed("report", "hills.h5", "-o", "hills.html", "-width", 300)
        check_numbers(program.read("hills.html").decode(), program.file("hills.h5"), False)
        chromium = shutil.which("chromium") or shutil.which("chromium-browser")
        if chromium:
            check_browser(chromium, program.file("hills.html"), os.path.join(os.path.dirname(program.path), "turning.png"))
        program.succeed("generate", "hills", "-n", 62000, "-o", "large.obj", ranks=1)
        program.succeed("disk", "large.obj", "-o", "large.h5", "-quiet", "-max_it", 0, codes=(4,))
        program.succeed("report", "large.h5", "-o", "large.html", "-width", 300)
        check_numbers(program.read("large.html").decode(), program.file("large.h5"), True)
    return 0


sys.exit(main())
