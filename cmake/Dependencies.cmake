# Every library Gridlock is built on, and why; ./dev installs them. The installed package repeats this list, since the
# library is static.
find_package(fmt REQUIRED)            # text with numbers, round-trip exact
find_package(tomlplusplus REQUIRED)   # the configuration, with line and column of every value
find_package(nlohmann_json REQUIRED)  # summary.json
find_package(Threads REQUIRED)        # which a static oneTBB does not look for itself
find_package(TBB REQUIRED)            # sweeps on all cores
find_package(Eigen3 REQUIRED NO_MODULE) # sparse Cholesky factorization and eigenvalues of packings, headers only
find_package(PkgConfig REQUIRED)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo)      # the pictures of movies
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash) # the state hash
include(cmake/Hdf5.cmake)                                    # trajectories in H5MD
pkg_check_modules(LIBDEFLATE REQUIRED IMPORTED_TARGET libdeflate) # their chunks, compressed on all cores
pkg_check_modules(ZLIB REQUIRED IMPORTED_TARGET zlib)        # start files that gzip packed, read piece by piece
find_path(HIGHWAY_INCLUDE_DIR hwy/highway.h REQUIRED)        # kernels for the instructions of every processor, headers only
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED) # counter-based random numbers, headers only
