# Copyright 2026 the equimap authors. SPDX-License-Identifier: BSD-2-Clause
#
# From the repository's folder:
#   spack repo add spack && spack dev-build equimap@main
from spack.package import *


class Equimap(CMakePackage):
    """Area-, volume- and angle-preserving maps of very large triangle and tetrahedral meshes."""

    license("BSD-2-Clause")

    version("main")

    variant("shared", default=False, description="Build a shared library")
    variant("report", default=True, description="Draw pictures and plots of results (cairo)")

    depends_on("c", type="build")
    depends_on("cmake@3.18:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("lapack")
    depends_on("petsc@3.18:+mpi+double~complex+hdf5+mumps+suite-sparse+hypre")
    depends_on("mumps+mpi+double")
    depends_on("metis@5.1:")
    depends_on("suite-sparse")
    depends_on("hdf5@1.10:+mpi")
    depends_on("libxml2")
    depends_on("cjson")
    depends_on("zlib-api")
    depends_on("cairo+pdf+svg+png+fc+ft", when="+report")
    depends_on("py-h5py", type="test")
    depends_on("py-numpy", type="test")

    def cmake_args(self):
        return [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define("EQUIMAP_TESTS", self.run_tests),
            self.define("EQUIMAP_PERF", False),
        ]
