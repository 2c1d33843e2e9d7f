from spack.package import *


class Tomlplusplus(CMakePackage):
    """Headers that read TOML with the line and column of every value. Spack has no package of them."""

    homepage = "https://marzer.github.io/tomlplusplus/"
    git = "https://github.com/marzer/tomlplusplus.git"

    license("MIT")

    version("3.4.0", tag="v3.4.0")

    depends_on("cxx", type="build")
    depends_on("cmake@3.14:", type="build")
