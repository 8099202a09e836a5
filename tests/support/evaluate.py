"""The figures of a map, computed anew from coordinates alone with numpy: definitions, no shortcuts, nothing of equimap's."""
import numpy


def triangle_areas(points, cells):
    """Areas of triangles in the plane (signed) or in space."""
    p, q, r = (points[cells[:, k]] for k in range(3))
    if points.shape[1] == 2:
        u, v = q - p, r - p
        return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return 0.5 * numpy.linalg.norm(numpy.cross(q - p, r - p), axis=1)


def corner_angles(points, cells):
    """Angles in degrees, one row per triangle."""
    angles = numpy.empty(cells.shape)
    for k in range(3):
        p = points[cells[:, k]]
        u, v = points[cells[:, (k + 1) % 3]] - p, points[cells[:, (k + 2) % 3]] - p
        cosine = (u * v).sum(1) / (numpy.linalg.norm(u, axis=1) * numpy.linalg.norm(v, axis=1))
        angles[:, k] = numpy.degrees(numpy.arccos(numpy.clip(cosine, -1.0, 1.0)))
    return angles


def singular_values(points, image, cells):
    """Of the linear map of each triangle, the larger first."""
    p, q, r = (points[cells[:, k]] for k in range(3))
    length = numpy.linalg.norm(q - p, axis=1)
    along = (q - p) / length[:, None]
    first = ((r - p) * along).sum(1)
    height = numpy.linalg.norm(r - p - first[:, None] * along, axis=1)
    u = (image[cells[:, 1]] - image[cells[:, 0]]) / length[:, None]
    v = (image[cells[:, 2]] - image[cells[:, 0]] - first[:, None] * u) / height[:, None]
    return numpy.linalg.svd(numpy.stack([u, v], axis=2), compute_uv=False)


def conformal_factor(points, image, cells):
    """Logarithm of the share of the image's area over the share of the surface's, around each vertex."""
    shares = numpy.zeros((2, len(points)))
    for share, places in zip(shares, (image, points)):
        areas = abs(triangle_areas(places, cells))
        for k in range(3):
            numpy.add.at(share, cells[:, k], areas / areas.sum())
    return numpy.log(shares[0] / shares[1])


def dirichlet_energy(points, image, cells):
    """Half the squared singular values, integrated over the surface."""
    return 0.5 * ((singular_values(points, image, cells) ** 2).sum(1) * triangle_areas(points, cells)).sum()


def boundary_edges(cells):
    """Directed edges that no other triangle runs through backwards."""
    edges = numpy.concatenate([cells[:, [k, (k + 1) % 3]] for k in range(3)])
    known = {tuple(edge) for edge in edges.tolist()}
    return [edge for edge in known if edge[::-1] not in known]


def statistics(values):
    p25, p50, p75, p95 = numpy.percentile(values, [25, 50, 75, 95])
    return {"mean": values.mean(), "sd": values.std(), "min": values.min(), "max": values.max(),
            "p25": p25, "p50": p50, "p75": p75, "p95": p95}


def weighted_statistics(ratio, weight):
    """Ratios weighted by measure; a quantile is the smallest ratio up to which that share of the measure lies."""
    order = numpy.argsort(ratio, kind="stable")
    share = numpy.cumsum(weight[order]) / weight.sum()
    found = {f"p{int(100 * level + .5):02}": ratio[order][numpy.searchsorted(share, level)] for level in (.05, .25, .5, .75, .95)}
    found["sd"] = numpy.sqrt((weight * (ratio - 1.0) ** 2).sum() / weight.sum())
    far = numpy.abs(ratio - 1.0) > 10.0 * found["sd"]
    return {**found, "outliers": int(far.sum()), "outlier_share": weight[far].sum() / weight.sum(),
            "cell_sd_without_outliers": ratio[~far].std()}


def evaluate(vertices, cells, image, density=None):
    """Everything that a summary says about a planar map's quality."""
    w = triangle_areas(vertices, cells) * (1.0 if density is None else density)
    a = triangle_areas(image, cells)
    if a.sum() < 0.0:
        a = -a
    ratio = a / w * w.sum() / a.sum()
    angle_error = numpy.abs(corner_angles(image, cells) - corner_angles(vertices, cells))
    vertex_sum, vertex_weight = numpy.zeros(len(vertices)), numpy.zeros(len(vertices))
    for k in range(3):
        numpy.add.at(vertex_sum, cells[:, k], w * ratio)
        numpy.add.at(vertex_weight, cells[:, k], w)
    return {"measure": w.sum(), "energy": a.sum() * (w / w.sum() * (ratio - 1.0) ** 2).sum(), "cell_ratio": ratio,
            "vertex_ratio": vertex_sum / vertex_weight, "ratio": statistics(ratio), "ratio_weighted": weighted_statistics(ratio, w),
            "ratio_error": statistics(numpy.abs(ratio - 1.0)), "angle_error_deg": statistics(angle_error.ravel()),
            "folds": int((a <= 0.0).sum()), "boundary_vertices": len(boundary_edges(cells))}
