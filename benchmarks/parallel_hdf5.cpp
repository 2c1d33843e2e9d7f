// Frames of disks written by all ranks into one file through the parallel HDF5, as another way than that of Gridlock,
// where ranks hand their rows to one writer. Ids, positions and velocities, in the chunks of Gridlock's trajectories.
// frames_on_ranks.py builds and runs it.
//
//     mpirun -n RANKS parallel_hdf5 FILE DISKS FRAMES COMPRESSION

#include <hdf5.h>
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace {

constexpr hsize_t max_rows_per_chunk = hsize_t{1} << 17;

void require(bool is_good, char const* what) {
  if (is_good) return;
  std::fprintf(stderr, "cannot %s\n", what);
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
}

/// The rows of this rank.
struct Rows {
  hsize_t first;
  hsize_t count;
};

/// One number for each frame, disk and component.
class Dataset {
 public:
  Dataset(hid_t file, char const* name, hid_t type, hsize_t disks, hsize_t components, unsigned compression)
      : type_(type), disks_(disks), components_(components) {
    std::array<hsize_t, 3> const extent{0, disks, components};
    std::array<hsize_t, 3> const most{H5S_UNLIMITED, H5S_UNLIMITED, components};
    std::array<hsize_t, 3> const chunk{1, std::min(disks, max_rows_per_chunk), 1};
    hid_t const space = H5Screate_simple(3, extent.data(), most.data());
    hid_t const list = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(list, 3, chunk.data());
    H5Pset_fill_time(list, H5D_FILL_TIME_NEVER);
    if (compression > 0) {
      H5Pset_shuffle(list);
      H5Pset_deflate(list, compression);
    }
    id_ = H5Dcreate2(file, name, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    require(id_ >= 0, "create a dataset");
    H5Pclose(list);
    H5Sclose(space);
  }
  Dataset(Dataset const&) = delete;
  Dataset& operator=(Dataset const&) = delete;
  ~Dataset() { H5Dclose(id_); }

  void extend(hsize_t frames) {
    std::array<hsize_t, 3> const extent{frames, disks_, components_};
    require(H5Dset_extent(id_, extent.data()) >= 0, "extend a dataset");
  }

  template <class Number>
  void write(hsize_t frame, hsize_t component, Rows const& rows, std::vector<Number> const& values) {
    std::array<hsize_t, 3> const start{frame, rows.first, component};
    std::array<hsize_t, 3> const count{1, rows.count, 1};
    hid_t const in_file = H5Dget_space(id_);
    H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    hid_t const in_memory = H5Screate_simple(3, count.data(), nullptr);
    hid_t const together = H5Pcreate(H5P_DATASET_XFER);
    H5Pset_dxpl_mpio(together, H5FD_MPIO_COLLECTIVE);
    require(H5Dwrite(id_, type_, in_memory, in_file, together, values.data()) >= 0, "write");
    H5Pclose(together);
    H5Sclose(in_memory);
    H5Sclose(in_file);
  }

 private:
  hid_t id_ = -1;
  hid_t type_;
  hsize_t disks_;
  hsize_t components_;
};

void write_frames(hid_t file, hsize_t disks, hsize_t frames, unsigned compression) {
  int rank = 0;
  int ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  auto const first_of = [&](int r) { return disks * static_cast<hsize_t>(r) / static_cast<hsize_t>(ranks); };
  Rows const rows{first_of(rank), first_of(rank + 1) - first_of(rank)};
  std::vector<std::uint64_t> ids(rows.count);
  for (hsize_t k = 0; k < rows.count; ++k) ids[k] = rows.first + k;
  std::mt19937_64 random(static_cast<std::uint64_t>(rank));
  std::uniform_real_distribution<double> numbers(-1.0, 1.0);
  std::vector<double> values(rows.count);
  std::ranges::generate(values, [&] { return numbers(random); });
  Dataset id(file, "id", H5T_NATIVE_UINT64, disks, 1, compression);
  Dataset position(file, "position", H5T_NATIVE_DOUBLE, disks, 2, compression);
  Dataset velocity(file, "velocity", H5T_NATIVE_DOUBLE, disks, 2, compression);
  MPI_Barrier(MPI_COMM_WORLD);
  double const begin = MPI_Wtime();
  for (hsize_t frame = 0; frame < frames; ++frame) {
    id.extend(frame + 1);
    id.write(frame, 0, rows, ids);
    for (Dataset* const vectors : {&position, &velocity}) {
      vectors->extend(frame + 1);
      for (hsize_t component = 0; component < 2; ++component) vectors->write(frame, component, rows, values);
    }
    H5Fflush(file, H5F_SCOPE_GLOBAL);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank == 0) std::printf("%.6f\n", (MPI_Wtime() - begin) / static_cast<double>(frames));
}

}  // namespace

int main(int argument_count, char** arguments) {
  MPI_Init(&argument_count, &arguments);
  require(argument_count == 5, "begin: parallel_hdf5 FILE DISKS FRAMES COMPRESSION");
  hid_t const access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_mpio(access, MPI_COMM_WORLD, MPI_INFO_NULL);
  hid_t const file = H5Fcreate(arguments[1], H5F_ACC_TRUNC, H5P_DEFAULT, access);
  require(file >= 0, "create the file");
  H5Pclose(access);
  write_frames(file, std::strtoull(arguments[2], nullptr, 10), std::strtoull(arguments[3], nullptr, 10),
               static_cast<unsigned>(std::strtoul(arguments[4], nullptr, 10)));
  H5Fclose(file);
  MPI_Finalize();
}
