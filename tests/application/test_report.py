"""Draw reports of a small result in every format; refuse what cannot be drawn, without leaving half a file.

usage: python3 test_report.py EQUIMAP [RANKS]
"""
import os
import re
import shutil
import struct
import sys
import xml.dom.minidom
import zlib

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
from program import run_in_folder


def check_png(path, width):
    """The chunks' checksums are right, the size is the wanted one, and the page is not empty."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, kinds, pixels = 8, [], b""
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place : place + 8])
        body = data[place + 8 : place + 8 + length]
        (checksum,) = struct.unpack(">I", data[place + 8 + length : place + 12 + length])
        assert zlib.crc32(kind + body) == checksum
        if kind == b"IDAT":
            pixels += body
        if kind == b"IHDR":
            assert struct.unpack(">I", body[:4])[0] == width
        kinds.append(kind)
        place += 12 + length
    assert kinds[-1] == b"IEND"
    assert len(set(zlib.decompress(pixels))) > 50  # many colours


def rows_of(path):
    """The rows of a report's first table: name to values."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    assert "%%" not in page
    table = page.split("<table>")[1].split("</table>")[0]
    return {name: re.findall("<td>(.*?)</td>", cells) for name, cells in re.findall("<tr><th>(.*?)</th>(.*?)</tr>", table)}


def check_figures(program):
    """Two results on one page, one of them with a cell that is turned over: the figures are those of the files."""
    shutil.copy("hills.h5", "folded.h5")
    with h5py.File("folded.h5", "r+") as file:
        file["/cell/ratio"][7] = -0.25
        file.attrs["folds"] = 1
    program.succeed("report", "hills.h5", "folded.h5", "-o", "both.html", "-width", "400")
    rows = rows_of("both.html")
    with h5py.File("hills.h5", "r") as file:
        worst = numpy.argsort(-numpy.abs(numpy.log(file["/cell/ratio"][...])), kind="stable")[:6].tolist()
        assert rows["worst cells"][0] == ", ".join(map(str, worst)), rows["worst cells"]
        assert rows["worst cells"][1] == ", ".join(map(str, [7] + [cell for cell in worst if cell != 7][:5]))
        assert rows["folds"] == ["0", "1"] and rows["iterations"][0] == str(file.attrs["iterations"])
        deviation = rows["SD of r, by area"][0].replace("×10", "e").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
        assert abs(float(deviation) / file.attrs["ratio_weighted_sd"] - 1) < 1e-3, (deviation, file.attrs["ratio_weighted_sd"])


def check_old(program):
    """A file of the first layout: texts of fixed length, no weighted figures, fewer arrays."""
    shutil.copy("hills.h5", "old.h5")
    with h5py.File("old.h5", "r+") as file:
        for name, value in list(file.attrs.items()):
            if isinstance(value, str):
                del file.attrs[name]
                file.attrs.create(name, numpy.bytes_(value.encode()))
            elif name == "format_version" or "weighted" in name or "outlier" in name:
                del file.attrs[name]
        for path in ("/history/gradient_norm", "/cell/quasi_conformal", "/histogram"):
            del file[path]
    program.succeed("report", "old.h5", "-o", "old.html", "-width", "400")
    assert rows_of("old.html")["SD of r, by area"] == rows_of("both.html")["SD of r, by area"][:1]


def check_kinds(program):
    """Angles, solids and correspondences have pages of their own kind; the camera goes where it is told."""
    program.succeed("generate", "sphere", "-n", "200", "-o", "sphere.obj")
    program.succeed("conformal", "sphere.obj", "-o", "angles.h5", codes=(0, 4))
    program.succeed("report", "angles.h5", "-o", "angles.svg", "-width", "600")
    with open("angles.svg", encoding="utf-8") as file:
        assert file.read().count("<image") >= 4  # the pictures; letters are glyphs
    program.succeed("generate", "ball", "-n", "200", "-o", "ball.vtu")
    program.succeed("ball", "ball.vtu", "-o", "ball.h5", codes=(0, 4))
    program.succeed("report", "ball.h5", "-o", "ball.html", "-width", "600")
    assert "SD of r, by volume" in rows_of("ball.html") and rows_of("ball.html")["angle error, mean / median"] == ["–"]
    program.succeed("generate", "cap", "-n", "300", "-o", "cap.obj")
    with open("pairs.csv", "w", encoding="utf-8") as file:
        file.write("a,b\n40,60\n200,120\n")
    program.succeed("register", "hills.obj", "cap.obj", "-landmarks", "pairs.csv", "-o", "pair.h5", codes=(0, 4, 5))
    with h5py.File("pair.h5", "r") as file:
        assert file["/register/landmarks/vertex"][...].tolist() == [40, 200]
        assert file["/register/landmarks/vertex_b"][...].tolist() == [60, 120]
    program.succeed("report", "pair.h5", "-o", "pair.png", "-width", "600")
    check_png("pair.png", 600)
    pages = []
    for view in (("-view", "0,10"), ("-view", "90,10"), ("-view", "0,10", "-up", "x")):
        program.succeed("report", "hills.h5", "-o", "view.png", "-width", "400", *view)
        with open("view.png", "rb") as file:
            pages.append(file.read())
    assert len(set(pages)) == 3
    for wrong in (("-view", "3"), ("-up", "w")):
        program.succeed("report", "hills.h5", "-o", "wrong.png", *wrong, codes=(2,))


def picture(program, *options):
    program.succeed("report", *options, "-o", "drawn.png", "-width", "500")
    with open("drawn.png", "rb") as file:
        return file.read()


def check_beside(program):
    """A start beside the image, curves of another quantity, lines on the mesh; what does not fit is refused."""
    program.succeed("disk", "hills.obj", "-o", "start.h5", "-max_it", "0", codes=(4,))
    with h5py.File("hills.h5") as file:
        cells = file["/mesh/cells"][...]
        vertices = len(file["/mesh/vertices"])
    for name, rows in (("lines", [(0, cells[0, 0]), (0, cells[0, 1]), (1, cells[9, 0]), (1, cells[9, 2])]),
                       ("single", [(0, cells[0, 0]), (1, cells[9, 0])]), ("wrong", [(0, 0), (0, vertices)])):
        with open(name + ".csv", "w", encoding="utf-8") as file:
            file.write("curve,vertex\n" + "".join(f"{curve},{vertex}\n" for curve, vertex in rows))
    plain = picture(program, "hills.h5")
    assert plain == picture(program, "hills.h5", "-convergence", "energy")
    assert plain == picture(program, "hills.h5", "-lines", "single.csv") == picture(program, "hills.h5", "-sharp", "179")
    others = [picture(program, "hills.h5", *options) for options in (
        ("-start", "start.h5"), ("-lines", "lines.csv"), ("-sharp", "5"), ("-convergence", "excess"), ("-convergence", "gradient"))]
    assert len({plain, *others}) == 6
    assert picture(program, "pair.h5") != picture(program, "pair.h5", "-lines", "lines.csv")  # of check_kinds
    program.succeed("generate", "hills", "-n", "700", "-o", "other.obj")
    program.succeed("disk", "other.obj", "-o", "other.h5", "-max_it", "0", codes=(4,))
    for wrong in (("hills.h5", "-start", "other.h5"), ("hills.h5", "start.h5", "-start", "start.h5"), ("hills.h5", "-lines", "wrong.csv"),
                  ("hills.h5", "-sharp", "-3"), ("hills.h5", "-convergence", "speed")):
        result = program.succeed("report", *wrong, "-o", "wrong.png", codes=(2,))
        assert len(program.messages(result)) == 1, result.stderr
    program.succeed("report", "hills.h5", "-lines", "absent.csv", "-o", "wrong.png", codes=(6,))
    assert not os.path.exists("wrong.png")


def main(program):
    program.succeed("generate", "hills", "-n", "800", "-o", "hills.obj")
    program.succeed("disk", "hills.obj", "-o", "hills.h5", codes=(0, 4))
    program.succeed("report", "hills.h5", "-o", "hills.png", "-width", "900")
    check_png("hills.png", 900)
    program.succeed("report", "hills.h5", "-o", "hills.svg")
    xml.dom.minidom.parse("hills.svg")
    program.succeed("report", "hills.h5", "-o", "hills.pdf")
    with open("hills.pdf", "rb") as file:
        data = file.read()
    assert data.startswith(b"%PDF-") and data.rstrip().endswith(b"%%EOF")
    program.succeed("report", "hills.h5", "-o", "hills.html")
    with open("hills.html", encoding="utf-8") as file:
        page = file.read()
    assert "data:image/png;base64," in page and "hills.obj" in page and page.rstrip().endswith("</html>")

    program.succeed("report", "hills.h5", "-o", "hills.docx", codes=(2,))
    program.succeed("report", "hills.h5", codes=(2,))
    program.succeed("report", "hills.h5", "-o", "new.png", "-nonsense", "3", codes=(2,))
    program.succeed("report", "absent.h5", "-o", "new.png", codes=(6,))
    program.succeed("report", "hills.obj", "-o", "new.png", codes=(6,))
    program.succeed("report", "hills.h5", "-o", "absent/new.png", codes=(6,))
    with open("hills.h5", "rb") as file:
        data = file.read()
    with open("cut.h5", "wb") as file:
        file.write(data[: len(data) // 2])
    program.succeed("report", "cut.h5", "-o", "new.png", codes=(6,))
    assert not [name for name in os.listdir() if name.startswith("new") or "tmp" in name or "docx" in name]
    check_figures(program)
    check_old(program)
    check_kinds(program)
    check_beside(program)
    print("report: png, svg, pdf and html drawn; figures are those of the results; wrong calls refused")


if __name__ == "__main__":
    run_in_folder(main)
