"""The Spack recipe, loaded with stand-ins for Spack's directives: its variants are those of docs/install.md, its CMake options
exist, and everything that CMake looks for is among its dependencies. Debian has no Spack to build it with.

usage: python3 test_spack.py EQUIMAP
"""
import contextlib
import os
import pathlib
import re
import sys
import types

TOP = pathlib.Path(__file__).resolve().parents[2]
RECIPE = TOP / "spack" / "spack_repo" / "equimap" / "packages" / "equimap" / "package.py"
# What CMake looks for, as far as Spack calls it otherwise.
NAMES = {"libxml-2.0": "libxml2", "libcjson": "cjson", "zlib": "zlib-api", "cholmod": "suite-sparse", "tiff": "libtiff", "png": "libpng", "openmp": None}


class Directives:
    """Takes what the recipe declares."""

    def __init__(self):
        self.variants, self.depends, self.required = {}, [], []

    def names(self):
        def nothing(*_, **__):
            return contextlib.nullcontext()

        return {"license": nothing, "version": nothing, "extends": nothing, "when": nothing, "default_args": nothing,
                "variant": lambda name, **words: self.variants.update({name: words}),
                "depends_on": lambda spec, **_: self.depends.append(re.match(r"[\w-]+", spec)[0]),
                "requires": lambda spec, **_: self.required.append(spec)}


def load():
    """The recipe's class, and what it has declared."""
    directives = Directives()
    spack = types.ModuleType("spack.package")
    spack.__dict__.update(directives.names(), __all__=list(directives.names()))
    cmake = types.ModuleType("spack_repo.builtin.build_systems.cmake")
    cmake.CMakePackage = type("CMakePackage", (), {})
    for name in ("spack", "spack_repo", "spack_repo.builtin", "spack_repo.builtin.build_systems"):
        sys.modules[name] = types.ModuleType(name)
    sys.modules.update({"spack.package": spack, cmake.__name__: cmake})
    scope = {"__file__": str(RECIPE), "__name__": "package"}
    exec(compile(RECIPE.read_text(encoding="utf-8"), RECIPE, "exec"), scope)
    return scope["Equimap"], directives


def cmake_options(recipe):
    """The options that it hands to CMake, with every variant on."""
    package = recipe()
    package.run_tests, package.spec = True, types.SimpleNamespace(satisfies=lambda _: True)
    package.define = package.define_from_variant = lambda option, *_: option
    recipe.cmake_args.__globals__["python_purelib"] = "lib"
    return package.cmake_args()


def looked_for(text):
    """Names of packages that CMake looks for."""
    found = re.findall(r"find_package\((\w+)", text)
    for modules in re.findall(r"pkg_check_modules\(\w+([^)]*)\)", text):
        found += [word for word in modules.split() if not re.match(r"[A-Z_]+$|\$\{", word)]
    found += [name for name in ("mumps", "metis", "cholmod", "petsc", "slepc") if re.search(rf"\(.*\b{name.upper()}\b", text)]
    return {name.lower() for name in found}


def main():
    recipe, directives = load()
    sources = "".join(path.read_text(encoding="utf-8") for path in [TOP / "CMakeLists.txt", *sorted((TOP / "cmake").glob("*.cmake"))])
    page = (TOP / "docs" / "install.md").read_text(encoding="utf-8")
    listed = re.findall(r"`(\w+)`", re.search(r"^Variants: (.*?)\.\s", page, re.M | re.S)[1])
    assert set(listed) == set(directives.variants), (listed, list(directives.variants))
    for option in cmake_options(recipe):
        assert option in sources or option == "BUILD_SHARED_LIBS", f"CMake has no option {option}"
    for name in looked_for(sources):
        name = NAMES.get(name, name)
        assert name is None or name in directives.depends or name in ("doxygen", "python3"), f"{name} is no dependency of the recipe"
    assert recipe.git == TOP.as_uri() and directives.required and os.path.isdir(TOP)
    print(f"spack: {len(directives.variants)} variants, {len(directives.depends)} dependencies")


main()
