"""What nested dissection of a box of vertices costs: nonzeros and operations of the Cholesky factor, its fronts.

The box is cut across its longest side by one layer of vertices, both halves again, and so on (A. George: Nested dissection
of a regular finite element mesh, SIAM J. Numer. Anal. 10, 1973). A front is a separator and what borders the part that it
cuts: the sides where larger separators stand. For large squares of n vertices this gives George's 31/8 n log2 n nonzeros and,
an operation being a multiplication or an addition, 829/42 n^(3/2) operations. Meshes are not boxes and METIS is not exact: what
a real mesh takes beside this is measured (compare.py).
"""
import functools
import math

BLOCK = 64    # rows of a block in which fronts are dealt to ranks
SMALLEST = 8  # parts of so many vertices are not cut further


def front_cost(pivots, kept):
    """Nonzeros and operations of a dense front of which `pivots` unknowns go out and `kept` stay; as the program counts."""
    def squares(n):
        return n * (n + 1.) * (2. * n + 1.) / 6.

    return pivots * (pivots + 1.) / 2. + pivots * kept, squares(pivots + kept) - squares(kept)


class Cost:
    """Of a part, dissected to the end by one rank."""

    def __init__(self, pivots, kept):
        self.nonzeros, self.operations = front_cost(pivots, kept)
        self.largest = pivots + kept           # front
        self.panels = pivots * (pivots + kept) # entries of the factor as the program stores it, columns of full fronts
        self.update = kept * kept              # entries that go to the front above
        self.stack = self.update               # the most of these that wait at once

    def add(self, first, second):
        """What two halves take before this front."""
        for name in ("nonzeros", "operations", "panels"):
            setattr(self, name, getattr(self, name) + getattr(first, name) + getattr(second, name))
        self.largest = max(self.largest, first.largest, second.largest)
        self.stack = max(first.stack, first.update + second.stack, first.update + second.update + self.update)


@functools.lru_cache(maxsize=None)
def box(lengths, bordered, dofs):
    """The cost of a box; bordered: per direction how many of its two ends touch a separator."""
    vertices = math.prod(lengths)
    border = sum(ends * vertices / length for ends, length in zip(bordered, lengths))
    if vertices <= SMALLEST or max(lengths) < 3.:
        return Cost(dofs * vertices, dofs * border)
    cut = max(range(len(lengths)), key=lambda k: lengths[k])
    cost = Cost(dofs * vertices / lengths[cut], dofs * border)
    half = tuple((length - 1.) / 2. if k == cut else length for k, length in enumerate(lengths))
    # One end of either half is the cut; an outer one that is bordered belongs to the first half, two to both.
    ends = [tuple(1 + (bordered[cut] > side) if k == cut else count for k, count in enumerate(bordered)) for side in (0, 1)]
    cost.add(*(box(half, end, dofs) for end in ends))
    return cost


def dissect(vertices, dimension, dofs):
    """The cost of a square or cube of so many vertices."""
    return box((vertices ** (1. / dimension),) * dimension, (0,) * dimension, dofs)


def grid(front, ranks, shared_front):
    """Rows and columns of the grid of ranks that holds a front, as the program chooses them: one rank a front that is not large."""
    if front <= shared_front:
        return 1, 1
    rows = math.isqrt(ranks)
    return rows, ranks // rows


class Tree:
    """The fronts of a group of ranks: sums over the group, and the worst of one rank."""

    def __init__(self, shared):
        self.shared = shared                  # unknowns that go to the group above
        self.holders = 1                      # ranks that hold what goes there
        self.own_panels = 0.                  # entries of the factor of a rank's own part
        self.own = 0.                         # the same with what waits beside
        self.ghosts = 0.                      # vertices of other ranks beside a rank's own, over all ranks
        self.entries_sent = 0.                # of packed triangles, and of panels within a grid
        self.unknowns_sent = 0.               # of right-hand sides, one way
        self.largest = shared                 # front
        self.largest_message = 0.             # entries
        self.panels = 0.                      # entries of the leading rank's part of the factor
        self.leader_entries = shared * shared # the most that it holds at once
        self.path_operations = 0.             # one after the other
        self.path_entries = 0.                # of the factor, one after the other in a solve
        self.path_blocks = 0.                 # of shared panels, one after the other in a solve


@functools.lru_cache(maxsize=None)
def group(lengths, bordered, dofs, ranks, shared_front):
    """The tree of ranks over a box: halves of the ranks have halves of the box, merged by the lowest rank of the first or, where
    the front is large, by all of them."""
    vertices = math.prod(lengths)
    border = dofs * sum(ends * vertices / length for ends, length in zip(bordered, lengths))
    whole = Tree(border)
    if ranks == 1:
        part = box(lengths, bordered, dofs)
        whole.own_panels, whole.own = part.panels, part.panels + part.stack
        return whole
    cut = max(range(len(lengths)), key=lambda k: lengths[k])
    pivots = dofs * vertices / lengths[cut]
    parts = []
    for side, count in enumerate((ranks // 2, ranks - ranks // 2)):
        part = tuple(length * count / ranks if k == cut else length for k, length in enumerate(lengths))
        parts.append(group(part, tuple(1 + (bordered[cut] > side) if k == cut else ends for k, ends in enumerate(bordered)), dofs, count,
                           shared_front))
    first, second = parts
    rows, columns = grid(pivots + border, ranks, shared_front)
    holders = rows * columns
    packed = [part.shared * (part.shared + 1.) / 2. for part in parts]
    panel, update = pivots * (pivots + border) / holders, border * border / holders
    message = max(triangle / part.holders for triangle, part in zip(packed, parts)) / holders
    _, operations = front_cost(pivots, border)
    whole.holders = holders
    whole.own_panels, whole.own = max(first.own_panels, second.own_panels), max(first.own, second.own)
    whole.ghosts = first.ghosts + second.ghosts + 2. * pivots / dofs
    # Of what a group passes on the holders keep what stays with them; ScaLAPACK sends each panel along rows and columns.
    whole.entries_sent = (first.entries_sent + second.entries_sent + sum(packed) - packed[0] / holders
                          - (packed[1] / holders if holders > 1 else 0.) + pivots * (pivots + border) * (rows + columns - 2.))
    whole.unknowns_sent = first.unknowns_sent + second.unknowns_sent + second.shared
    whole.largest = max(first.largest, second.largest, pivots + border)
    whole.largest_message = max(first.largest_message, second.largest_message, message)
    whole.panels = first.panels + panel
    whole.leader_entries = max(first.leader_entries, second.leader_entries,
                               first.panels + (first.shared ** 2 + packed[0]) / first.holders,
                               whole.panels + update + packed[0] / first.holders + message)
    whole.path_operations = max(first.path_operations, second.path_operations) + operations / holders
    whole.path_entries = max(first.path_entries, second.path_entries) + panel
    whole.path_blocks = max(first.path_blocks, second.path_blocks) + (pivots / BLOCK if holders > 1 else 0.)
    return whole


def tree_of_ranks(vertices, dimension, dofs, ranks, shared_front=math.inf):
    """The tree of fronts of so many ranks over a square or cube of vertices; fronts of more unknowns are shared."""
    return group((vertices ** (1. / dimension),) * dimension, (0,) * dimension, dofs, ranks, shared_front)
