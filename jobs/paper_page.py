"""The page of a paper: its tables beside ours, its figures redrawn, as HTML and as PDF. Used by paper.py."""
import base64
import html
import io
import sys

from sweep_table import TableError

TITLES = {
    "000": "Liu and Yueh: Convergent Authalic Energy Minimization for Disk Area-Preserving Parameterizations",
    "001": "Sutti and Yueh: Riemannian gradient descent for spherical area-preserving mappings",
    "002": "Yueh: Theoretical Foundation of the Stretch Energy Minimization for Area-Preserving Mappings",
    "003": "Liu, Huang, Lin and Yueh: Isovolumetric Energy Minimization for Ball-Shaped Volume-Preserving Parameterizations of "
           "3-Manifolds",
    "004": "Huang, Gu, Huang, Lin, Lin and Yau: High performance computing for spherical conformal and Riemann mappings",
}
# Figures of a line by their names in tables, and how they are written.
FIGURES = {
    "energy": ("E", ".3e"), "sd": ("SD", ".3e"), "sd_by_mean": ("SD/mean", ".4f"), "error_mean": ("mean error", ".3e"),
    "error_sd": ("SD of the error", ".3e"), "error_p25": ("25 %", ".3e"), "error_p50": ("50 %", ".3e"),
    "error_p75": ("75 %", ".3e"), "error_p95": ("95 %", ".3e"), "eigenvalue": ("eigenvalue", ".3e"), "noise_error": ("err-E", ".3e"),
    "angle_mean": ("angle, mean", ".3f"), "angle_median": ("angle, median", ".3f"), "folds": ("folds", "d"),
    "seconds": ("seconds", ".1f"),
}
OURS_ALWAYS = ("folds", "seconds")
STYLE = """body { font: 15px/1.5 sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; color: #222 }
table { border-collapse: collapse; font-size: 13px; margin: 1em 0 }
th, td { padding: .2em .7em; text-align: right; white-space: nowrap }
th:first-child, td:first-child, th:nth-child(2), td:nth-child(2) { text-align: left }
thead tr:last-child { border-bottom: 1px solid #222 } tbody tr:nth-child(even) { background: #f4f4f4 }
td.theirs { color: #777 } td.off { color: #b00 } img { max-width: 100% } figcaption { color: #555 }"""


def columns_of(lines):
    """The figures that a table shows: those that the paper gives, and some of ours."""
    given = {figure for _, _, paper in lines for figure in paper}
    ours = {figure for _, figures, _ in lines for figure in figures}
    always = {*OURS_ALWAYS, *(("angle_mean", "angle_median") if "angle_mean" in ours else ("energy",))}
    return [figure for figure in FIGURES if figure in (given | always) & (ours | given)]


def written(value, form):
    if value is None:
        return ""
    return format(int(value) if form == "d" else value, form)


def deviation(ours, theirs, figure):
    """By how many per cent we are off, for figures that another machine would give as well."""
    if ours is None or not theirs or figure in ("seconds", "folds"):
        return ""
    return f"{100. * (ours / theirs - 1.):+.1f} %"


def rows_of(lines):
    """A table's cells as text, (ours, theirs, deviation) for each figure: [(words, [(ours, theirs, off)])]."""
    columns = columns_of(lines)
    table = []
    for fixed, ours, paper in lines:
        after = paper.get("iterations") if fixed["status"] == "on the way" else ours.get("iterations")
        if after and paper.get("iterations", after) != after:
            after = (after, paper["iterations"])
        words = [fixed["name"], fixed["mesh"].rpartition("/")[2], f"{fixed['vertices']:,}", fixed["method"],
                 f"{after[0]:.0f} (theirs {after[1]:.0f})" if isinstance(after, tuple) else written(after, "d")]
        cells = []
        for figure in columns:
            form = FIGURES[figure][1]
            mine, theirs = ours.get(figure), paper.get(figure)
            cells.append((written(mine, form), written(theirs, form), deviation(mine, theirs, figure)))
        table.append((words, cells))
    return [FIGURES[figure][0] for figure in columns], table


def html_table(lines):
    names, table = rows_of(lines)
    text = ["<table><thead><tr>", *(f"<th rowspan=2>{word}</th>" for word in ("row", "mesh", "vertices", "method", "iterations"))]
    text += [f"<th colspan=3>{html.escape(name)}</th>" for name in names] + ["</tr><tr>"]
    text += ["<th>ours</th><th>theirs</th><th></th>" for _ in names] + ["</tr></thead><tbody>"]
    for words, cells in table:
        text.append("<tr>" + "".join(f"<td>{html.escape(word)}</td>" for word in words))
        text += [f"<td>{mine}</td><td class=theirs>{theirs}</td><td class=theirs>{off}</td>" for mine, theirs, off in cells]
        text.append("</tr>")
    return "\n".join([*text, "</tbody></table>"])


def text_table(lines):
    """The same in columns of a fixed width, for the PDF."""
    names, table = rows_of(lines)
    rows = [["row", "vertices", "iterations", *(name + half for name in names for half in ("", " (theirs)"))]]
    rows += [[words[0], words[2], words[4], *(half for cell in cells for half in cell[:2])] for words, cells in table]
    kept = [k for k in range(len(rows[0])) if any(row[k] for row in rows[1:])]
    widths = {k: max(len(row[k]) for row in rows) for k in kept}
    return ["  ".join(row[k].rjust(widths[k]) if k else row[k].ljust(widths[k]) for k in kept) for row in rows]


def parts(papers, others):
    """(heading, what it says, lines, runs) of the page's parts."""
    if papers:
        yield ("On the paper's meshes", "Grey: published, and by how much ours differs. Seconds are of different machines.",
               [line for _, _, lines in papers for line in lines], papers)
    if others:
        yield ("On substitutes", "The paper's meshes are not there: these stand in; the published figures are of other meshes.",
               [line for _, _, lines in others for line in lines], others)


def missing_words(missing):
    groups = {}
    for row, state in missing:
        groups.setdefault(state, []).append(row.name)
    return [f"{state}: {', '.join(names)}" for state, names in groups.items()]


def png_of(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    return base64.b64encode(buffer.getvalue()).decode()


def html_page(paper, contents, missing):
    text = ["<!DOCTYPE html><html lang=en><meta charset=utf-8>", f"<title>{paper}</title><style>{STYLE}</style>",
            f"<h1>{paper}</h1><p>{html.escape(TITLES[paper])}</p>"]
    for heading, words, lines, figures in contents:
        text += [f"<h2>{heading}</h2><p>{html.escape(words)}</p>", html_table(lines)]
        text += [f"<figure><img alt='{html.escape(caption)}' src='data:image/png;base64,{png_of(figure)}'>"
                 f"<figcaption>{html.escape(caption)}</figcaption></figure>" for caption, figure in figures]
    if missing:
        text += ["<h2>Not run</h2>", *(f"<p>{html.escape(line)}</p>" for line in missing_words(missing))]
    return "\n".join([*text, "</html>\n"])


def text_page(pyplot, title, lines):
    """A page of the PDF that holds lines of text, as large as they allow."""
    figure = pyplot.figure(figsize=(11.7, 8.3))
    longest = max(map(len, lines))
    figure.text(.03, .95, title, fontsize=13)
    size = min(9., 1250. / longest, 520. / (1.35 * len(lines)))
    figure.text(.03, .91, "\n".join(lines), family="monospace", va="top", fontsize=size)
    return figure


def pdf_page(pyplot, name, paper, contents, missing):
    from matplotlib.backends.backend_pdf import PdfPages

    with PdfPages(name, metadata={"Title": TITLES[paper]}) as pdf:
        for heading, _, lines, figures in contents:
            table = text_table(lines)
            for begin in range(1, len(table), 45):
                page = text_page(pyplot, f"{paper}: {heading}", [table[0], *table[begin:begin + 45]])
                pdf.savefig(page)
                pyplot.close(page)
            for caption, figure in figures:
                figure.suptitle(caption, fontsize=10)
                pdf.savefig(figure)
        for line in missing_words(missing)[:1] if missing else ():
            page = text_page(pyplot, f"{paper}: not run", [line[k:k + 150] for k in range(0, len(line), 150)])
            pdf.savefig(page)
            pyplot.close(page)


def write(paper, folder, papers, others, missing, program):
    """Write paper.html and paper.pdf, with pictures drawn by `program`, unless that is None; their paths."""
    try:
        import paper_figures
    except ImportError as absent:
        raise TableError(f"{sys.executable} lacks {absent.name} (Debian: python3-matplotlib, python3-numpy, python3-h5py, for "
                         "/usr/bin/python3)") from absent
    from matplotlib import pyplot

    contents = [(heading, words, lines, list(paper_figures.draw(paper, runs, program)))
                for heading, words, lines, runs in parts(papers, others)]
    pages = folder / "paper.html", folder / "paper.pdf"
    pages[0].write_text(html_page(paper, contents, missing), encoding="utf-8")
    pdf_page(pyplot, pages[1], paper, contents, missing)
    pyplot.close("all")
    return pages
