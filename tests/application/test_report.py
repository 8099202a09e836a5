"""Draw reports of a small result in every format; refuse what cannot be drawn, without leaving half a file.

usage: python3 test_report.py EQUIMAP [RANKS]
"""
import os
import struct
import subprocess
import sys
import tempfile
import xml.dom.minidom
import zlib


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


def main(equimap, ranks):
    mpirun = ["mpirun", "-n", ranks, "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"]

    def run(*arguments, expected=(0,)):
        done = subprocess.run([*mpirun, equimap, *arguments], capture_output=True, text=True)
        assert done.returncode in expected, (arguments, done.returncode, done.stderr[-2000:])
        return done

    run("generate", "hills", "-n", "800", "-o", "hills.obj")
    run("disk", "hills.obj", "-o", "hills.h5", expected=(0, 4))
    run("report", "hills.h5", "-o", "hills.png", "-width", "900")
    check_png("hills.png", 900)
    run("report", "hills.h5", "-o", "hills.svg")
    xml.dom.minidom.parse("hills.svg")
    run("report", "hills.h5", "-o", "hills.pdf")
    with open("hills.pdf", "rb") as file:
        data = file.read()
    assert data.startswith(b"%PDF-") and data.rstrip().endswith(b"%%EOF")
    run("report", "hills.h5", "-o", "hills.html")
    with open("hills.html", encoding="utf-8") as file:
        page = file.read()
    assert "data:image/png;base64," in page and "hills.obj" in page and page.rstrip().endswith("</html>")

    run("report", "hills.h5", "-o", "hills.docx", expected=(2,))
    run("report", "hills.h5", expected=(2,))
    run("report", "hills.h5", "-o", "new.png", "-nonsense", "3", expected=(2,))
    run("report", "absent.h5", "-o", "new.png", expected=(6,))
    run("report", "hills.obj", "-o", "new.png", expected=(6,))
    run("report", "hills.h5", "-o", "absent/new.png", expected=(6,))
    with open("hills.h5", "rb") as file:
        data = file.read()
    with open("cut.h5", "wb") as file:
        file.write(data[: len(data) // 2])
    run("report", "cut.h5", "-o", "new.png", expected=(6,))
    assert not [name for name in os.listdir() if name.startswith("new") or "tmp" in name or "docx" in name]
    print("report: png, svg, pdf and html drawn; seven wrong calls refused")


if __name__ == "__main__":
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        main(program, sys.argv[2] if len(sys.argv) > 2 else "1")
        os.chdir("/")
