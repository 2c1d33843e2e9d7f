from spack_repo.builtin.build_systems.cmake import CMakePackage, generator

from spack.package import *


class Gridlock(CMakePackage):
    """Simulator of many agents that interact only with near neighbours: hard and soft disks, packings and agent
    models in two dimensions, with the same bits on any number of threads."""

    homepage = "https://gridlock.example.org"
    git = "https://gridlock.example.org/gridlock.git"

    license("MIT")

    version("main", branch="main")
    version("0.2.0", tag="v0.2.0")

    variant("mpi", default=False, description="Build gridlock-mpi, which shares runs and sweeps among ranks")
    variant("view", default=True, description="Build gridlock-view, which serves the page of a run")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")

    depends_on("fmt@9:")
    depends_on("tomlplusplus@3:")
    depends_on("nlohmann-json@3.11:")
    depends_on("cli11@2:")
    depends_on("random123", type="build")
    depends_on("xxhash")
    depends_on("tbb")
    depends_on("cairo+png")
    depends_on("hdf5@1.10:~mpi")
    depends_on("libdeflate")
    depends_on("zlib-api")
    depends_on("eigen@3.4:")
    depends_on("highway@1:")
    depends_on("cpp-httplib", when="+view")
    depends_on("mpi", when="+mpi")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("GRIDLOCK_MPI", "mpi"),
            self.define_from_variant("GRIDLOCK_VIEW", "view"),
            self.define("GRIDLOCK_BUILD_TESTS", False),
            self.define("GRIDLOCK_BUILD_BENCHMARKS", False),
            self.define("GRIDLOCK_UNITY_BUILD", "ON"),
        ]

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def check_install(self):
        Executable(self.prefix.bin.gridlock)("--version")
