# Copyright 2026 the equimap authors. SPDX-License-Identifier: BSD-2-Clause
#
# From the repository's folder, with Spack 1.0 or later:
#   spack repo add spack/spack_repo/equimap
#   spack install equimap                        the newest commit of this clone's branch main
#   spack dev-build equimap@main                 the folder as it stands
import pathlib

from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Equimap(CMakePackage):
    """Area-, volume- and angle-preserving maps of very large triangle and tetrahedral meshes."""

    # the clone that this file belongs to
    git = pathlib.Path(__file__).resolve().parents[5].as_uri()

    license("BSD-2-Clause")

    version("main", branch="main")

    variant("shared", default=False, description="Build a shared library")
    variant("report", default=True, description="Draw pictures and plots of results (cairo)")
    variant("images", default=True, description="Geometry images (libpng, libtiff)")
    variant(
        "int64",
        default=False,
        description="64-bit indices, for more than some 50 million vertices",
    )
    variant("slepc", default=False, description="Eigenvalues of the energy's Hessian (SLEPc)")
    variant("python", default=False, description="Install the Python package equimap")

    depends_on("c", type="build")
    depends_on("cmake@3.18:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("blas")
    depends_on("lapack")
    depends_on("petsc@3.18:+mpi+double~complex+hdf5+mumps+suite-sparse+hypre")
    depends_on("petsc+int64", when="+int64")
    depends_on("petsc~int64", when="~int64")
    depends_on("slepc@3.18:", when="+slepc")
    depends_on("mumps@5.4:+mpi+double")
    depends_on("scalapack")
    depends_on("metis@5.1:")
    depends_on("suite-sparse@5:")
    depends_on("hdf5@1.10:+mpi")
    depends_on("libxml2")
    depends_on("cjson")
    depends_on("zlib-api")
    depends_on("cairo+pdf+svg+png+fc+ft", when="+report")

    with when("+images"):
        depends_on("libpng")
        depends_on("libtiff")

    # The threads are ours: a BLAS that brings its own makes a rank use all cores, and every small
    # front slow.
    for library in ("openblas", "blis", "amdblis", "intel-oneapi-mkl"):
        requires(
            f"^{library} threads=none",
            when=f"^[virtuals=blas] {library}",
            msg="equimap wants a serial BLAS",
        )

    extends("python@3.7:", when="+python")
    with default_args(type=("build", "run"), when="+python"):
        depends_on("py-numpy")
        depends_on("py-h5py")
    with default_args(type="test"):
        depends_on("python@3.7:")
        depends_on("py-numpy")
        depends_on("py-h5py")

    def cmake_args(self):
        args = [
            self.define_from_variant("BUILD_SHARED_LIBS", "shared"),
            self.define("EQUIMAP_TESTS", self.run_tests),
            self.define("EQUIMAP_PERF", False),
        ]
        if self.spec.satisfies("+python"):
            args.append(self.define("EQUIMAP_PYTHON_DIR", python_purelib))
        return args

    def test_disk(self):
        """map a generated surface to the disk"""
        equimap = which(self.prefix.bin.equimap)
        equimap("generate", "hills", "-n", "1000", "-o", "hills.h5")
        equimap("disk", "hills.h5", "-o", "map.h5")
